//! How long each block takes.

mod joints;
mod ramp;

use crate::record::Drives;
use crate::spindle::Spindle;
use joints::{joints, smooth};
use ramp::Ramp;
use toolroom_program::{Action, Block, Motion, Path, Program, Purpose};

/// Time that a machine spends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spent {
    /// Key of the block that takes it.
    pub key: usize,
    /// s.
    pub seconds: f64,
    /// On what.
    pub part: Part,
}

/// What a machine spends time on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// Motions at feed.
    Feed,
    /// Rapid motions, the ways to the reference point and from it.
    Rapid,
    /// Axes that settle behind a motion.
    Settling,
    /// Programmed dwells.
    Dwell,
    /// Auxiliary functions, coolant, holes beside their motions, start and end of the program.
    Auxiliary,
    /// The tool changer.
    Change,
    /// Waiting for the spindle.
    Spindle,
}

impl Part {
    /// All of them, in order.
    pub const ALL: [Self; 7] =
        [Self::Feed, Self::Rapid, Self::Settling, Self::Dwell, Self::Auxiliary, Self::Change, Self::Spindle];

    /// A word for tables and for programs.
    pub fn word(self) -> &'static str {
        match self {
            Self::Feed => "feed",
            Self::Rapid => "rapid",
            Self::Settling => "settling",
            Self::Dwell => "dwell",
            Self::Auxiliary => "auxiliary",
            Self::Change => "change",
            Self::Spindle => "spindle",
        }
    }
}

/// A motion at feed whose speed at its ends is not settled.
#[derive(Clone, Copy, Debug)]
struct Step {
    key: usize,
    /// m.
    way: f64,
    /// m/s.
    top: f64,
    start: [f64; 3],
    end: [f64; 3],
    part: Part,
}

/// Motions that are looked at together: a control looks ahead over some hundred blocks, and a machine that slows over
/// more than this many motions stops at the end of what it sees (assumption).
const WINDOW: usize = 8192;

/// Times blocks one after the other, in bounded memory.
///
/// `t = length/(feed·override)`, rapid `longest axis/rapid_speed`, without acceleration. With it the speed follows
/// trapezoids between the speeds at the ends of motions: rest before and behind rapid motions, dwells, tool changes,
/// auxiliary functions and exact stops, else at most `v² = a·corner_deviation·s/(1 − s)`, `s = cos(half the turn)`, or
/// `corner_step` over the greatest change of the direction's parts, or the slower speed times the cosine of the turn, and at most `v² = a·radius` on arcs. With a jerk time a
/// change of speed by `Δv` takes `Δv/a + jerk_time`, and where it is too small to need the whole acceleration
/// `2 √(Δv·jerk_time/a)`; motions of one feed that follow each other smoothly are one motion to it. Rotary axes alone need
/// no acceleration.
///
/// The spindle ramps beside the axes ([`Drives::spindle_ramp`]). The first motion at feed behind its command waits for
/// it, or the block that switches coolant on before, or its own block; stops, tool changes and the end of the program wait
/// until it stands, and tool change and end brake it where the program does not. The first rapid motion behind a tool change
/// takes `approach_time`, the first from the reference point `from_home_time`, where those are given.
///
/// # Source
/// Trapezoidal speed with look-ahead; corner speed of Jeon, "Improving Grbl: cornering algorithm" (2011). Ramps of
/// limited jerk: Biagiotti & Melchiorri, "Trajectory Planning for Automatic Machines and Robots" (2008), double S; the
/// look-ahead does without jerk. That rapid motions start and end at rest (but with `rapid_blend`), and that one acceleration holds for all
/// directions at feed, are assumptions, as is that blended rapid motions accelerate as those at feed do. What waits for the spindle was seen in the logs of the NIST box.
pub struct Timer {
    drives: Drives,
    steps: Vec<Step>,
    /// Speed at which the first step begins, m/s.
    entry: f64,
    last: Option<Last>,
    /// Time since the start, s, of what is settled.
    elapsed: f64,
    spindle: Spindle,
    /// Tool in the spindle.
    tool: Option<u32>,
    place: Place,
    started: bool,
    ended: bool,
}

/// Where the axes stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// Where the program says.
    Work,
    /// At the reference point, in some axes.
    Home,
    /// Where tools are changed.
    Changer,
}

/// The motion that ended last, where the axes still have to settle.
#[derive(Clone, Copy, Debug)]
struct Last {
    key: usize,
    rapid: bool,
}

impl Timer {
    /// Begins at rest, with a spindle that stands.
    pub fn new(drives: &Drives) -> Self {
        Self {
            drives: *drives,
            steps: Vec::new(),
            entry: 0.0,
            last: None,
            elapsed: 0.0,
            spindle: Spindle::default(),
            tool: None,
            place: Place::Work,
            started: false,
            ended: false,
        }
    }

    fn spend(&mut self, key: usize, seconds: f64, part: Part, done: &mut Vec<Spent>) {
        self.elapsed += seconds;
        done.push(Spent { key, seconds, part });
    }

    /// As [`spend`](Self::spend), but for nothing where the time is 0.
    fn perhaps(&mut self, key: usize, seconds: f64, part: Part, done: &mut Vec<Spent>) {
        if seconds > 0.0 {
            self.spend(key, seconds, part, done);
        }
    }

    /// Takes the next block; `done` gets the times that are settled, each with the key of its block.
    pub fn block(&mut self, key: usize, block: &Block, done: &mut Vec<Spent>) {
        if !self.started {
            self.started = true;
            self.perhaps(key, self.drives.program_start, Part::Auxiliary, done);
        }
        self.perhaps(key, block.dwell, Part::Dwell, done);
        let holes = f64::from(block.holes) * self.drives.hole_dwell;
        self.perhaps(key, block.auxiliary_time + holes, Part::Auxiliary, done);
        // Auxiliary functions act before the motion of their block or behind it; either way the axes rest.
        let rests = block.dwell > 0.0 || block.tool_change || block.auxiliary;
        if rests {
            self.rest(done);
        }
        let mut actions = block.actions.iter().peekable();
        for (count, motion) in block.motions.iter().enumerate() {
            while let Some((_, action)) = actions.next_if(|(before, _)| *before <= count) {
                self.act(key, *action, block.holes > 0, done);
            }
            // The way to the reference point has a time of its own.
            if !matches!(actions.peek(), Some((before, Action::Home(_))) if *before == count + 1) {
                self.motion(key, motion, done);
            }
            if block.holes > 0 {
                self.rest(done);
            }
        }
        for (_, action) in actions {
            self.act(key, *action, block.holes > 0, done);
        }
        if rests || block.exact_stop {
            self.rest(done);
        }
        if self.spindle.pending && self.drives.spindle_block_wait >= 0.5 {
            self.wait(key, done);
        }
    }

    /// The axes wait for the spindle.
    fn wait(&mut self, key: usize, done: &mut Vec<Spent>) {
        self.rest(done);
        let wait = self.spindle.wait(self.elapsed);
        self.perhaps(key, wait, Part::Spindle, done);
    }

    fn act(&mut self, key: usize, action: Action, tapping: bool, done: &mut Vec<Spent>) {
        let drives = self.drives;
        match action {
            Action::Spindle(speed, sense) => {
                self.rest(done);
                let reversal = self.spindle.command(&drives, (speed, sense), self.elapsed, tapping);
                self.perhaps(key, reversal, Part::Spindle, done);
            }
            Action::Coolant(on) => {
                if on && drives.coolant_wait >= 0.5 {
                    self.wait(key, done);
                }
                if drives.coolant_time > 0.0 {
                    self.rest(done);
                    self.spend(key, drives.coolant_time, Part::Auxiliary, done);
                }
            }
            Action::Stop => {
                if self.spindle.stands() && drives.stop_wait >= 0.5 {
                    self.wait(key, done);
                }
            }
            Action::Change(tool) => {
                self.rest(done);
                self.spindle.brake(&drives, self.elapsed);
                self.wait(key, done);
                let pockets = tool.zip(self.tool).map_or(0, |(new, old)| new.abs_diff(old));
                let changer = drives.orient_time + drives.tool_change_time + f64::from(pockets) * drives.index_time;
                self.perhaps(key, changer, Part::Change, done);
                self.tool = tool.or(self.tool);
                self.place = Place::Changer;
            }
            Action::Home(_) => {
                self.perhaps(key, drives.home_time, Part::Rapid, done);
                self.place = Place::Home;
            }
            Action::End => self.close(key, done),
        }
    }

    /// The program ends: the spindle comes to rest.
    fn close(&mut self, key: usize, done: &mut Vec<Spent>) {
        self.rest(done);
        if self.ended {
            return;
        }
        self.ended = true;
        self.spindle.brake(&self.drives, self.elapsed);
        self.wait(key, done);
        self.perhaps(key, self.drives.program_end, Part::Auxiliary, done);
    }

    /// A motion from the place of the tool change or from the reference point, which the program does not know.
    fn leaves_machine_place(&mut self, key: usize, motion: &Motion, done: &mut Vec<Spent>) -> bool {
        let drives = self.drives;
        let time = match self.place {
            Place::Work => 0.0,
            Place::Changer => drives.approach_time,
            Place::Home if motion.unknown => drives.from_home_time,
            Place::Home => 0.0,
        };
        // Behind a change the axis of the tool comes from its own reference point.
        self.place = match self.place {
            Place::Changer => Place::Home,
            Place::Home if motion.unknown => Place::Work,
            Place::Home | Place::Work => self.place,
        };
        if time > 0.0 {
            self.rest(done);
            self.spend(key, time, Part::Rapid, done);
        }
        time > 0.0
    }

    fn motion(&mut self, key: usize, motion: &Motion, done: &mut Vec<Spent>) {
        let drives = self.drives;
        if motion.rapid {
            if self.leaves_machine_place(key, motion, done) {
                return;
            }
            let ways = drives.rapid_ways(motion);
            let rotary = drives.rotary(motion);
            if ways.is_empty() && rotary == 0.0 {
                return;
            }
            let straight = ways.iter().map(|(way, speed, acceleration)| {
                if *acceleration > 0.0 {
                    Ramp { acceleration: *acceleration, jerk_time: drives.jerk_time }.time_of(*way, *speed, 0.0, 0.0)
                } else {
                    way / speed
                }
            });
            let time = straight.fold(rotary, f64::max);
            let way = 1e-3 * motion.length;
            if drives.rapid_blend >= 0.5 && drives.inverse_acceleration > 0.0 && way > 0.0 && rotary == 0.0 {
                let ways = drives.rapid_ways(motion);
                let top = way / ways.iter().map(|(way, speed, _)| way / speed).fold(f64::MIN_POSITIVE, f64::max);
                let (start, end) = motion.directions();
                self.push(Step { key, way, top, start, end, part: Part::Rapid }, done);
                return;
            }
            self.rest(done);
            self.spend(key, time, Part::Rapid, done);
            self.last = Some(Last { key, rapid: true });
            return;
        }
        if self.spindle.pending {
            self.wait(key, done);
        }
        self.place = Place::Work;
        if self.last.is_some_and(|last| last.rapid) && drives.rapid_blend < 0.5 {
            self.settle(done);
        }
        self.last = Some(Last { key, rapid: false });
        let time = if motion.purpose == Purpose::Thread { motion.time } else { motion.time / drives.feed_override };
        if drives.inverse_acceleration <= 0.0 || motion.is_rotary() || motion.length <= 0.0 || time <= 0.0 {
            self.spend(key, time.max(drives.block_time), Part::Feed, done);
            return;
        }
        let (start, end) = motion.directions();
        let way = 1e-3 * motion.length;
        let feed = way / time.max(drives.block_time);
        // On an arc part of the acceleration turns the path.
        let top = match motion.path {
            Path::Line => feed,
            Path::Arc(arc) => feed.min((1e-3 * arc.radius / drives.inverse_acceleration).sqrt()),
        };
        self.push(Step { key, way, top, start, end, part: Part::Feed }, done);
    }

    fn push(&mut self, step: Step, done: &mut Vec<Spent>) {
        self.last = Some(Last { key: step.key, rapid: step.part == Part::Rapid });
        self.steps.push(step);
        if self.steps.len() >= WINDOW {
            self.commit(WINDOW / 2, done);
        }
    }

    /// The axes come to rest.
    fn rest(&mut self, done: &mut Vec<Spent>) {
        self.commit(self.steps.len(), done);
        self.settle(done);
        self.entry = 0.0;
    }

    fn settle(&mut self, done: &mut Vec<Spent>) {
        if let Some(last) = self.last.take() {
            let time = if last.rapid { self.drives.rapid_settling } else { self.drives.feed_settling };
            self.perhaps(last.key, time, Part::Settling, done);
        }
    }

    /// Times the first `count` steps, as if the axes rested behind the last that is known.
    fn commit(&mut self, count: usize, done: &mut Vec<Spent>) {
        if self.steps.is_empty() {
            return;
        }
        let drives = self.drives;
        let ramp = Ramp { acceleration: 1.0 / drives.inverse_acceleration, jerk_time: drives.jerk_time };
        let (joints, short_sighted) = joints(&self.steps, self.entry, &drives);
        let steps: Vec<Step> = self.steps.drain(..count).collect();
        let mut first = 0;
        while first < count {
            let mut end = first + 1;
            let goes_on = |end: usize| !short_sighted[end] && smooth(&steps[end - 1], &steps[end], &drives);
            while drives.jerk_time > 0.0 && end < count && goes_on(end) {
                end += 1;
            }
            let run = &steps[first..end];
            let way = run.iter().map(|step| step.way).sum();
            let whole = ramp.time_of(way, run[0].top, joints[first], joints[end]);
            if let [step] = run {
                self.spend(step.key, whole, step.part, done);
            } else {
                // Without jerk each of them takes its share; the jerk is shared out alike.
                let plain = Ramp { jerk_time: 0.0, ..ramp };
                let plain_time = |i: usize| plain.time_of(steps[i].way, steps[i].top, joints[i], joints[i + 1]);
                let sum: f64 = (first..end).map(plain_time).sum();
                for i in first..end {
                    self.spend(steps[i].key, plain_time(i) * whole / sum, steps[i].part, done);
                }
            }
            first = end;
        }
        self.entry = joints[count];
    }

    /// The program ends: everything that is left comes to rest; `done` gets its times as in [`block`](Self::block), those of
    /// the end under `key`.
    pub fn finish(&mut self, key: usize, done: &mut Vec<Spent>) {
        self.close(key, done);
    }
}

/// Time of each block of a program with `drives`, s; see [`Timer`].
///
/// ```
/// use toolroom_drives::{Drives, times};
/// use toolroom_program::{Control, Program};
/// let text = "T1 M6\nG21 G90 G0 X0 Y0 Z5\nG1 Z-1 F60\nX120 F1200\nG4 P500\nM30";
/// let program = Program::read(text, &Control::default()).unwrap();
/// let times = times(&program, &Drives { tool_change_time: 4.0, ..Drives::default() });
/// assert_eq!((times[0], times[2], times[3], times[4]), (4.0, 6.0, 6.0, 0.5));
/// ```
pub fn times(program: &Program, drives: &Drives) -> Vec<f64> {
    let mut times = vec![0.0; program.blocks.len()];
    let mut timer = Timer::new(drives);
    let mut done = Vec::new();
    for (index, block) in program.blocks.iter().enumerate() {
        timer.block(index, block, &mut done);
    }
    timer.finish(program.blocks.len().saturating_sub(1), &mut done);
    for spent in done {
        times[spent.key] += spent.seconds;
    }
    times
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use toolroom_program::{Control, Dialect, Units};

    fn control() -> Control {
        Control { units: Some(Units::Millimetre), ..Control::of(Dialect::LinuxCnc) }
    }

    fn time(text: &str, drives: &Drives) -> f64 {
        times(&Program::read(text, &control()).expect("a program"), drives).iter().sum()
    }

    fn with(inverse_acceleration: f64) -> Drives {
        Drives { inverse_acceleration, ..Drives::default() }
    }

    #[test]
    fn a_short_way_is_a_triangle_and_a_long_one_a_trapezoid() {
        // 100 mm at 6 m/min = 0.1 m/s with 1 m/s²: 1 s and one ramp's 0.1 s more.
        assert!((time("G0 X0 Y0 Z0\nG1 X100 F6000", &with(1.0)) - 1.1).abs() < 1e-12);
        // 4 mm: 2·√(way/a).
        assert!((time("G0 X0 Y0 Z0\nG1 X4 F6000", &with(1.0)) - 2.0 * 4e-3_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_straight_path_in_pieces_takes_the_time_of_one() {
        let pieces: String = (1..=100).map(|i| format!("X{i}\n")).collect();
        let whole = time("G0 X0 Y0 Z0\nG1 X100 F6000", &with(0.5));
        assert!((time(&format!("G0 X0 Y0 Z0\nG1 F6000\n{pieces}"), &with(0.5)) - whole).abs() < 1e-9);
        let stopped = time(&format!("G61 G0 X0 Y0 Z0\nG1 F6000\n{pieces}"), &with(0.5));
        assert!(stopped > 1.5 * whole, "{stopped}");
    }

    #[test]
    fn a_ramp_of_limited_jerk_takes_longer_by_its_mean_speed() {
        let with = |jerk_time| Drives { inverse_acceleration: 1.0, jerk_time, ..Drives::default() };
        let time = |x: f64, jerk_time| time(&format!("G0 X0 Y0 Z0\nG1 X{x} F6000"), &with(jerk_time));
        // 0.1 m/s at 1 m/s² in 0.1 s; with 0.05 s of jerk in 0.15 s, half of it lost at each end.
        assert!((time(100.0, 0.05) - 1.15).abs() < 1e-9, "{}", time(100.0, 0.05));
        // With 0.4 s the whole acceleration is never reached: 2·√(0.1·0.4) s a ramp.
        assert!((time(100.0, 0.4) - 1.4).abs() < 1e-9, "{}", time(100.0, 0.4));
        // Two triangles of jerk and way 4 mm: both ramps to v in 2·√(v·0.4), way v·2·√(v·0.4).
        let peak = (4e-3 / (2.0 * 0.4_f64.sqrt())).powf(2.0 / 3.0);
        assert!((time(4.0, 0.4) - 4.0 * (peak * 0.4).sqrt()).abs() < 1e-4, "{}", time(4.0, 0.4));
        // The same with 1 m/s² and 20 m/s³, whose closed form is 0.185 663 553 s.
        assert!((time(4.0, 0.05) - 0.185_663_553).abs() < 1e-8, "{}", time(4.0, 0.05));
        assert_eq!(time(4.0, 0.0), self::time("G0 X0 Y0 Z0\nG1 X4 F6000", &self::with(1.0)));
    }

    #[test]
    fn corners_cost_time_by_their_angle() {
        let corner = |y: f64| time(&format!("G0 X0 Y0 Z0\nG1 X50 F6000\nX100 Y{y}"), &with(0.5)) - (1.0 + 0.05);
        let flat = (50.0_f64.hypot(1.0) - 50.0) / 100.0;
        assert!((corner(0.0)).abs() < 1e-12 && corner(1.0) - flat < 1e-3 && corner(50.0) > 0.2);
    }

    proptest! {
        #[test]
        fn no_acceleration_is_the_limit_of_great_acceleration(x in 1.0..50.0_f64, y in -50.0..50.0_f64) {
            let text = format!("G0 X0 Y0 Z0\nG1 X{x:.3} Y{y:.3} F1000\nG2 X{:.3} I5 J0\nG0 Z9\nG81 Z-3 R1 X3", x + 10.0);
            let (none, much) = (time(&text, &with(0.0)), time(&text, &with(1e-9)));
            prop_assert!((none - much).abs() < 1e-6 * none, "{none} {much}");
            prop_assert!(time(&text, &with(1.0)) > none);
        }
    }
}
