//! Runs of programs, timed stretch by stretch.

use super::figures::{Figures, figures};
use super::plateau::{changes, plateau};
use super::runs::Run;
use crate::{RecordKind, Records};
use toolroom_program::{Block, Program, Stretch};

/// Feed override below which the feed counts as held.
const HELD: f64 = 0.01;

/// A run that was not timed, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Untimed {
    /// Run.
    pub run: String,
    /// Why.
    pub reason: String,
}

/// One stretch of one run as it was measured.
struct Timed {
    start: f64,
    end: f64,
    feed_override: f64,
    /// Whether the override was read off the plateau of the reported feed.
    plateau: bool,
    holds: f64,
    hold_time: f64,
    tool_changes: f64,
    tool: String,
}

/// Times of the stretches of `program` (of at least `least` seconds) in complete `runs` of it, one
/// row a run and stretch. A run that ends in another block than the program, or has another tool in
/// the spindle, is one of another version and left out.
pub fn stretches(runs: &[&Run], program: &Program, least: f64, rapid_speed: f64) -> (Records, Vec<Untimed>) {
    let parts = program.stretches(least, rapid_speed);
    let mut untimed = Vec::new();
    let mut rows: Vec<(&Run, usize, Timed)> = Vec::new();
    for run in runs {
        match timed(run, program, &parts, rapid_speed) {
            Ok(list) => rows.extend(list.into_iter().enumerate().map(|(i, timed)| (*run, i, timed))),
            Err(reason) => untimed.push(Untimed { run: run.id.clone(), reason }),
        }
    }
    let line = |index: usize| program.blocks.get(index).map_or(f64::NAN, |block| block.line as f64);
    let mut records = table(&rows);
    let names = sections(program, &parts);
    let section = |(run, i, _): &(&Run, usize, Timed)| format!("{} {}", run.program, names[*i]);
    records.set_texts("section", rows.iter().map(section).collect());
    let blocks = |of: &dyn Fn(&Stretch) -> usize| rows.iter().map(|(_, i, _)| line(of(&parts[*i]))).collect();
    records.set_numbers("first_block", blocks(&|part| part.blocks.start));
    records.set_numbers("last_block", blocks(&|part| part.blocks.end - 1));
    let of_parts = figures(program, &parts);
    let mut number = |name: &str, of: fn(&Figures) -> f64| {
        records.set_numbers(name, rows.iter().map(|(_, i, _)| of(&of_parts[*i])).collect());
    };
    number("spindle_from", |figures| figures.spindle[0]);
    number("spindle_to", |figures| figures.spindle[1]);
    number("stops", |figures| figures.stops);
    number("rapid_length", |figures| figures.rapid_length);
    number("corner_sum", |figures| figures.corner_sum);
    number("shortest_block", |figures| figures.shortest_block);
    number("waits", |figures| figures.waits);
    (records, untimed)
}

/// Tool of each stretch, `T3`, or `T3 (2)` where it comes again: a change belongs to the tool that it
/// brings.
fn sections(program: &Program, parts: &[Stretch]) -> Vec<String> {
    let mut changes = 0;
    let mut seen: Vec<(Option<u32>, usize)> = Vec::new();
    let name = |part: &Stretch| {
        let blocks = &program.blocks[part.blocks.clone()];
        changes += blocks.iter().filter(|block| block.tool_change).count();
        let tool = blocks.last().and_then(|block| block.tool);
        if seen.iter().all(|known| *known != (tool, changes)) {
            seen.push((tool, changes));
        }
        let before = seen.iter().filter(|(known, change)| *known == tool && *change < changes).count();
        let word = tool.map_or("no tool".to_owned(), |tool| format!("T{tool}"));
        if before == 0 { word } else { format!("{word} ({})", before + 1) }
    };
    parts.iter().map(name).collect()
}

/// Complete `runs` as a whole, one row each.
pub fn whole(runs: &[Run]) -> Records {
    let complete = runs.iter().filter(|run| run.complete);
    let rows: Vec<(&Run, usize, Timed)> = complete.map(|run| (run, 0, held(run, run.start, run.end))).collect();
    table(&rows)
}

fn table(rows: &[(&Run, usize, Timed)]) -> Records {
    let origin = rows.iter().map(|(run, ..)| run.start).fold(f64::INFINITY, f64::min);
    let mut records = Records::new(RecordKind::Program, rows.len());
    type Row<'r> = (&'r Run, usize, Timed);
    let mut texts =
        |name: &str, of: &dyn Fn(&Row<'_>) -> String| records.set_texts(name, rows.iter().map(of).collect());
    texts("operation_id", &|(run, ..)| run.id.clone());
    texts("machine", &|(run, ..)| run.machine.clone());
    texts("program", &|(run, ..)| run.program.clone());
    texts("tool_id", &|(_, _, timed)| timed.tool.clone());
    let source = |timed: &Timed| match (timed.plateau, timed.feed_override.is_finite()) {
        (true, _) => "plateau",
        (false, true) => "event",
        (false, false) => "assumed",
    };
    texts("override_source", &|(_, _, timed)| source(timed).to_owned());
    let mut numbers =
        |name: &str, of: &dyn Fn(&Row<'_>) -> f64| records.set_numbers(name, rows.iter().map(of).collect());
    numbers("sequence", &|(_, i, _)| *i as f64 + 1.0);
    numbers("start_time", &|(_, _, timed)| timed.start - origin);
    numbers("feed_override", &|(_, _, timed)| timed.feed_override);
    numbers("tool_changes", &|(_, _, timed)| timed.tool_changes);
    numbers("hold_count", &|(_, _, timed)| timed.holds);
    numbers("hold_time", &|(_, _, timed)| timed.hold_time);
    numbers("cycle_time", &|(_, _, timed)| timed.end - timed.start);
    records
}

fn timed(run: &Run, program: &Program, parts: &[Stretch], rapid_speed: f64) -> Result<Vec<Timed>, String> {
    if !run.complete {
        return Err("the program was not completed".to_owned());
    }
    let last = program.blocks.last().map_or(0, |block| block.line);
    // A block left over from before the start is none of this run's.
    let begin = run.states.iter().position(|state| state.block != run.states[0].block).unwrap_or(0);
    let mut samples: Vec<(f64, f64)> = vec![(run.start, 0.0)];
    for state in &run.states[begin..] {
        if state.block > samples.last().map_or(0.0, |sample| sample.1) {
            samples.push((state.time, state.block));
        }
    }
    let end = samples.last().map_or(0.0, |sample| sample.1);
    if end != last as f64 {
        return Err(format!("it ends in block {end:.0}, the program in {last}: another version"));
    }
    samples.push((run.end, last as f64 + 1.0));
    let ends = entries(&samples, program, parts, rapid_speed);
    let mut list: Vec<Timed> = ends.windows(2).map(|pair| held(run, pair[0], pair[1])).collect();
    // The log says when an override changes, and not where it stands.
    if !changes(run)
        && let Some(in_force) = plateau(run, program)
    {
        for timed in &mut list {
            (timed.feed_override, timed.plateau) = (in_force, true);
        }
    }
    for (part, timed) in parts.iter().zip(&list) {
        let tool = program.blocks[part.blocks.end - 1].tool.map(|tool| tool.to_string());
        if let Some(tool) = tool.filter(|tool| !timed.tool.is_empty() && *tool != timed.tool) {
            let line = program.blocks[part.blocks.start].line;
            return Err(format!("tool {} is in the spindle at block {line}, where the program has {tool}", timed.tool));
        }
    }
    Ok(list)
}

/// Time that a block takes beside its motions, where two samples must be parted between several, s
/// (assumption).
fn idle(block: &Block) -> f64 {
    match (block.tool_change, block.auxiliary) {
        (true, _) => 5.0,
        (false, true) => 1.0,
        // A block without motion passes at once, but it passes.
        (false, false) => 1e-6,
    }
}

/// Times at which the first block of each stretch was entered, and the end. Between two samples
/// blocks pass as their nominal times say.
fn entries(samples: &[(f64, f64)], program: &Program, parts: &[Stretch], rapid_speed: f64) -> Vec<f64> {
    let mut clock = vec![0.0; samples.last().map_or(0, |sample| sample.1 as usize) + 2];
    for block in &program.blocks {
        clock[block.line + 1] += block.nominal(rapid_speed) + idle(block);
    }
    for i in 1..clock.len() {
        clock[i] += clock[i - 1];
    }
    let time_at = |line: f64| clock[(line as usize).min(clock.len() - 1)];
    let entry = |part: &Stretch| {
        let line = program.blocks[part.blocks.start].line as f64;
        let after = samples.partition_point(|sample| sample.1 < line).clamp(1, samples.len() - 1);
        let ((t0, b0), (t1, b1)) = (samples[after - 1], samples[after]);
        let share = (time_at(line) - time_at(b0)) / (time_at(b1) - time_at(b0));
        t0 + (t1 - t0) * if share.is_finite() { share.clamp(0.0, 1.0) } else { 1.0 }
    };
    let mut ends: Vec<f64> = parts.iter().map(entry).collect();
    if let Some(first) = ends.first_mut() {
        *first = samples[0].0;
    }
    ends.push(samples[samples.len() - 1].0);
    ends
}

/// What the machine did from `start` to `end`.
fn held(run: &Run, start: f64, end: f64) -> Timed {
    let mut timed = Timed {
        start,
        end,
        feed_override: f64::NAN,
        plateau: false,
        holds: 0.0,
        hold_time: 0.0,
        tool_changes: 0.0,
        tool: String::new(),
    };
    let (mut moving, mut distance) = (0.0, 0.0);
    let mut was_held = false;
    for (i, state) in run.states.iter().enumerate() {
        let until = run.states.get(i + 1).map_or(run.end, |next| next.time).min(end);
        let from = state.time.max(start);
        let holds = state.execution != "ACTIVE" || state.feed_override < HELD;
        if until > from {
            if holds {
                timed.hold_time += until - from;
                timed.holds += f64::from(u8::from(!was_held));
            } else if state.feed_override.is_finite() {
                moving += until - from;
                distance += (until - from) * state.feed_override;
            }
            let changed = !timed.tool.is_empty() && timed.tool != state.tool;
            timed.tool_changes += f64::from(u8::from(changed));
            timed.tool.clone_from(&state.tool);
        }
        was_held = holds && until > from;
    }
    if moving > 0.0 {
        timed.feed_override = distance / moving;
    }
    timed
}

#[cfg(test)]
mod tests {
    use super::super::{parse_shdr, runs, sessions};
    use super::*;

    /// Two tools, a hole, 60 mm at 600 mm/min twice.
    const PROGRAM: &str =
        "T1 M6\nG21 G90 G0 X0 Y0 Z1\nG1 Z0 F60\nX60 F600\nG0 Z50\nT2 M6\nG0 X0 Z1\nG1 X60 F600\nM30\n";

    fn log(end: usize) -> String {
        format!(
            "1|exec|READY|tool|1|Fovr|100\n10|exec|ACTIVE|line|1\n14|line|2\n14.5|line|4\n18|Fovr|50\n20|Fovr|0\n\
             22|Fovr|100\n27|line|5\n28|line|6\n30|tool|2\n32|line|7\n33|line|8\n39|line|{end}\n40|exec|PROGRAM_COMPLETED\n"
        )
    }

    fn timed(log: &str) -> (Records, Vec<Untimed>) {
        let program = Program::read(PROGRAM, &toolroom_program::Control::default()).expect("a program");
        let found: Vec<Run> =
            sessions("mill", &parse_shdr(log), &[]).iter().flat_map(|found| runs(found, Some("P"))).collect();
        stretches(&found.iter().collect::<Vec<_>>(), &program, 5.0, 0.5)
    }

    #[test]
    fn stretches_have_their_times_tools_overrides_and_holds() {
        let (records, untimed) = timed(&log(9));
        assert!(untimed.is_empty(), "{untimed:?}");
        assert_eq!(records.numbers("first_block"), Some(&[1.0, 3.0, 5.0, 6.0, 7.0, 9.0][..]));
        let times = records.numbers("cycle_time").expect("a column");
        let expected = [4.0, 13.0, 1.0, 4.0, 7.0, 1.0];
        assert!(times.iter().zip(expected).all(|(time, expected)| (time - expected).abs() < 1e-5), "{times:?}");
        assert_eq!(records.texts("tool_id").expect("a column")[4], "2");
        assert_eq!(records.numbers("hold_count").expect("a column")[1], 1.0);
        assert_eq!(records.numbers("hold_time").expect("a column")[1], 2.0);
        let share = records.numbers("feed_override").expect("a column")[1];
        assert!((share - (9.0 + 1.0) / 11.0).abs() < 1e-6, "{share}");
    }

    #[test]
    fn another_version_of_the_program_is_left_out_with_its_reason() {
        let (records, untimed) = timed(&log(8));
        assert!(records.is_empty() && untimed[0].reason.contains("another version"), "{untimed:?}");
        let (_, untimed) = timed(&log(9).replace("tool|2", "tool|7"));
        assert!(untimed[0].reason.contains("tool 7"), "{untimed:?}");
    }
}
