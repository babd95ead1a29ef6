//! What one line of a part program did: motions, modes, variables, and where its time goes.

use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use toolroom_drives::{Drives, Part, Timer};
use toolroom_form::significant;
use toolroom_program::{
    AXES, Blocks, Control, EventKind, FeedMode, ModalState, Motion, ProgramError, Purpose, Run, Sense, Source,
};

/// Runs of a line that are told one by one; of the others only the number and the time (assumption).
const TOLD: usize = 5;
/// Motions of a run that are told one by one (assumption).
const MOTIONS: usize = 12;

/// What a line did in every run of it.
#[derive(Clone, Debug)]
pub struct Explanation {
    line: usize,
    /// How often it ran.
    count: usize,
    runs: Vec<LineRun>,
    /// Time of all runs, in the order of [`Part::ALL`], s.
    spent: [f64; 7],
    /// Factor from each axis of a motion to what the program writes.
    factors: [f64; 9],
}

/// One run of the line.
#[derive(Clone, Debug)]
struct LineRun {
    modes: ModalState,
    variables: Vec<(String, f64)>,
    position: [Option<f64>; 9],
    motions: Vec<Motion>,
    spent: [f64; 7],
}

impl Explanation {
    /// Follows a program and tells what `line`, from 1, of its file did, each time with the time that it takes on a machine
    /// with `drives`. Lines of subprograms in the same file are lines like others.
    ///
    /// # Errors
    /// [`ProgramError`]: the program is refused.
    pub fn new(text: &Source, control: &Control, drives: &Drives, line: usize) -> Result<Self, ProgramError> {
        let mut runs = Vec::new();
        let mut count = 0;
        let mut run = Run::new(text.clone(), control)?;
        while let Some(event) = run.next() {
            let event = event?;
            if event.line == line && matches!(event.kind, EventKind::Block) {
                count += 1;
                if runs.len() < TOLD {
                    runs.push(LineRun {
                        modes: run.modes(),
                        variables: run.variables(),
                        position: run.position(),
                        motions: Vec::new(),
                        spent: [0.0; 7],
                    });
                }
            }
        }
        let mut explanation = Self { line, count, runs, spent: [0.0; 7], factors: run.factors() };
        let (mut timer, mut done, mut seen) = (Timer::new(drives), Vec::new(), 0);
        for block in Blocks::new(text.clone(), control)? {
            let block = block?;
            // Key 0 is everything else.
            let mut key = 0;
            if block.own_line == line {
                seen += 1;
                key = seen;
                if let Some(run) = explanation.runs.get_mut(seen - 1) {
                    run.motions.clone_from(&block.motions);
                }
            }
            timer.block(key, &block, &mut done);
            explanation.take(&mut done);
        }
        timer.finish(0, &mut done);
        explanation.take(&mut done);
        Ok(explanation)
    }

    fn take(&mut self, done: &mut Vec<toolroom_drives::Spent>) {
        for spent in done.drain(..).filter(|spent| spent.key > 0) {
            self.spent[spent.part as usize] += spent.seconds;
            if let Some(run) = self.runs.get_mut(spent.key - 1) {
                run.spent[spent.part as usize] += spent.seconds;
            }
        }
    }

    /// In words.
    pub fn text(&self) -> String {
        let mut text = format!("line {}: ", self.line);
        match self.count {
            0 => text.push_str("no block of it ran: the line is empty, a comment, a definition, or never reached"),
            1 => text.push_str("runs once"),
            count => {
                let _ = write!(text, "runs {count} times, {}", parts(&self.spent));
            }
        }
        for (index, run) in self.runs.iter().enumerate() {
            if self.count > 1 {
                let _ = write!(text, "\nrun {}", index + 1);
            }
            for motion in run.motions.iter().take(MOTIONS) {
                let _ = write!(text, "\n  {}", told(motion, &self.factors));
            }
            if run.motions.len() > MOTIONS {
                let _ = write!(text, "\n  and {} motions more", run.motions.len() - MOTIONS);
            }
            let _ = write!(text, "\n  behind it: {}", places(|axis| run.position[axis]));
            let _ = write!(text, "\n  modes: {}", modes(&run.modes));
            if !run.variables.is_empty() {
                let list: Vec<String> =
                    run.variables.iter().map(|(name, value)| format!("{name} = {}", significant(*value))).collect();
                let _ = write!(text, "\n  variables: {}", list.join(", "));
            }
            let _ = write!(text, "\n  time: {}", parts(&run.spent));
        }
        if self.count > self.runs.len() {
            let _ = write!(text, "\nand {} runs more", self.count - self.runs.len());
        }
        text
    }

    /// For programs. Places are mm and degrees as the program writes them, X of a lathe as a diameter; `null` where only the
    /// machine knows them.
    pub fn json(&self) -> Value {
        let spent = |spent: &[f64; 7]| -> Map<String, Value> {
            Part::ALL.iter().map(|part| (format!("{} [s]", part.word()), json!(spent[*part as usize]))).collect()
        };
        let written = |place: &[f64; 9]| -> Vec<f64> { place.iter().zip(self.factors).map(|(at, f)| at * f).collect() };
        let motion = |motion: &Motion| {
            json!({
                "purpose": purpose(motion), "rapid": motion.rapid,
                "start": written(&motion.start), "end": written(&motion.end),
                "length [mm]": motion.length, "programmed_time [s]": motion.time,
            })
        };
        let runs = self.runs.iter().map(|run| {
            json!({
                "position": run.position,
                "motions": run.motions.iter().take(MOTIONS).map(motion).collect::<Vec<_>>(),
                "motion_count": run.motions.len(),
                "modes": modes(&run.modes),
                "variables": run.variables.iter().cloned().collect::<BTreeMap<_, _>>(),
                "spent": spent(&run.spent),
            })
        });
        json!({ "line": self.line, "runs": self.count, "spent": spent(&self.spent), "first_runs": runs.collect::<Vec<_>>() })
    }
}

/// Times above zero, in words.
fn parts(spent: &[f64; 7]) -> String {
    let list: Vec<String> = (Part::ALL.iter())
        .filter(|part| spent[**part as usize] > 0.0)
        .map(|part| format!("{} {:.3} s", part.word(), spent[*part as usize]))
        .collect();
    let sum: f64 = spent.iter().sum();
    if list.is_empty() { "none".to_owned() } else { format!("{sum:.3} s ({})", list.join(", ")) }
}

/// Places of the axes that are known.
fn places(place: impl Fn(usize) -> Option<f64>) -> String {
    let list: Vec<String> = (AXES.iter().enumerate())
        .filter_map(|(axis, letter)| place(axis).map(|place| format!("{letter}{}", significant(place))))
        .collect();
    if list.is_empty() { "at a place that only the machine knows".to_owned() } else { list.join(" ") }
}

pub(crate) fn purpose(motion: &Motion) -> &'static str {
    match motion.purpose {
        Purpose::Approach => "approach",
        Purpose::Retract => "retract",
        Purpose::Cut => "cut",
        Purpose::Plunge => "plunge",
        Purpose::Cycle => "cycle",
        Purpose::Thread => "thread",
    }
}

/// A motion in words, with the axes that it moves, as the program writes them.
fn told(motion: &Motion, factors: &[f64; 9]) -> String {
    let moves = |axis: usize| motion.start[axis] != motion.end[axis];
    let from = places(|axis| moves(axis).then_some(factors[axis] * motion.start[axis]));
    let to = places(|axis| moves(axis).then_some(factors[axis] * motion.end[axis]));
    let way = if (0..9).any(moves) { format!("from {from} to {to}") } else { "on the spot or once around".to_owned() };
    if motion.rapid {
        return format!("{}: rapid {way}", purpose(motion));
    }
    let feed = if motion.time > 0.0 { 60.0 * motion.length / motion.time } else { 0.0 };
    format!(
        "{}: {way}, {} mm at {} mm/min, {:.3} s programmed",
        purpose(motion),
        significant(motion.length),
        significant(feed),
        motion.time
    )
}

/// Modes in the words of G codes.
fn modes(modes: &ModalState) -> String {
    let mut list = vec![format!("G{}", modes.plane), if modes.absolute { "G90" } else { "G91" }.to_owned()];
    if let Some(feed) = modes.feed {
        let unit = match modes.feed_mode {
            FeedMode::Minute => "a minute",
            FeedMode::Revolution => "a revolution",
            FeedMode::Inverse => "blocks a minute",
        };
        list.push(format!("F {} {unit}", significant(feed)));
    }
    let turns = match modes.sense {
        Sense::Clockwise => "to the right",
        Sense::Counterclockwise => "to the left",
        Sense::Still => "standing",
        Sense::Oriented => "standing at its angle",
    };
    list.push(format!("spindle {} rpm, {turns}", significant(modes.speed)));
    if let Some(surface) = modes.surface {
        list.push(format!("constant surface speed {} m/min", significant(1e-3 * surface)));
    }
    if modes.exact_stop {
        list.push("exact stop".to_owned());
    }
    list.extend(modes.tool.map(|tool| format!("tool {tool}")));
    list.join(", ")
}
