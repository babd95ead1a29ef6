//! The state of the machine that all languages drive: position, frame, feed, spindle; out come events.

use crate::control::Control;
use crate::error::Fault;
use crate::frame::Frame;
use crate::joint::{Joint, PendingMotion};
use crate::lathe::surface_time;
use crate::motion::{
    AXES, Arc, Axes, Event, EventKind, Motion, Offset, PLANES, Path, Purpose, Sense, arc_tolerance, centre_by_radius,
    sweep,
};
use crate::offset::Offsetting;
use std::collections::VecDeque;

/// What F counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedMode {
    /// mm or degrees a minute.
    Minute,
    /// mm a revolution.
    Revolution,
    /// Blocks a minute.
    Inverse,
}

/// Axes of a block: values in mm or degrees, absolute or by steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Target {
    pub absolute: [Option<f64>; 9],
    pub step: [Option<f64>; 9],
}

impl Target {
    pub fn is_empty(&self) -> bool {
        self.absolute.iter().chain(&self.step).all(Option::is_none)
    }

    pub fn names(&self, axis: usize) -> bool {
        self.absolute[axis].is_some() || self.step[axis].is_some()
    }

    /// Where an axis goes from `start`, mm or degrees.
    pub fn end(&self, axis: usize, start: &Axes) -> f64 {
        self.absolute[axis].unwrap_or(start[axis] + self.step[axis].unwrap_or(0.0))
    }

    /// One axis at a place.
    pub fn one(axis: usize, place: f64) -> Self {
        let mut modes = Self::default();
        modes.absolute[axis] = Some(place);
        modes
    }
}

/// Where the centre of an arc stands, program coordinates in the plane, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Round {
    Centre([f64; 2]),
    Radius(f64),
}

/// Greatest coordinate that is followed, mm: beyond it differences of positions lose the last digits.
pub(crate) const FARTHEST: f64 = 1e7;
/// Greatest number of full turns of one helix: a bound against programs without end (assumption).
const TURNS: f64 = 1e5;

pub(crate) struct Kernel {
    pub control: Control,
    /// Workpiece coordinates, mm and degrees; 0 where not known.
    pub at: Axes,
    pub referenced: [bool; 9],
    pub frame: Frame,
    pub plane: [usize; 3],
    /// mm of a unit; `None` until a code says it.
    pub scale: Option<f64>,
    pub absolute: bool,
    /// F as it counts, in mm or degrees.
    pub feed: Option<f64>,
    /// mm of the unit that F was written in: rotary axes alone take F as written.
    pub feed_scale: f64,
    pub feed_mode: FeedMode,
    /// rpm.
    pub speed: f64,
    pub sense: Sense,
    /// Constant surface speed, mm/min.
    pub surface: Option<f64>,
    /// Greatest speed at constant surface speed, rpm.
    pub clamp: f64,
    pub lathe: bool,
    pub tool: Option<u32>,
    pub exact: bool,
    pub offset: Option<Offsetting>,
    /// Side of the path on which the cutter was last told to run; true is left.
    pub side: Option<bool>,
    pub out: VecDeque<Event>,
    pub line: usize,
    pub main_line: usize,
    pub depth: usize,
    pub notes: Vec<(usize, String)>,
    /// Why there is no feed, where a word F was ignored.
    pub vacant_feed: Option<String>,
    pub purpose: Option<Purpose>,
    pub moved: bool,
    /// The chamfer or rounding of the block, and the motion that waits for the one behind its own.
    pub joint: Option<Joint>,
    pub waiting: Option<PendingMotion>,
    /// Something that is no motion stands between two motions that a joint would join.
    pub torn: bool,
    /// Line of the last jump back; 0 before the first.
    pub loop_line: usize,
    /// Line of the first step of an axis from a place that only the machine knows.
    pub blind_step: Option<usize>,
    /// Pitch of the last thread, mm, where its cycle names one.
    pub pitch: Option<f64>,
    /// Number of the work offset in which places count, as of [`Offset::Work`]: 0 for all of which it is known how they lie to G54.
    work: u32,
    /// That of the first motion at feed.
    fed: Option<u32>,
    /// Line of a change to a work offset of which only some axes are known to the one before.
    pub partly_known: Option<usize>,
}

impl Kernel {
    pub fn new(control: Control, lathe: bool) -> Self {
        let scale = control.units.map(|units| units.scale());
        let mut kernel = Self {
            at: control.start.map(|place| place.unwrap_or(0.0)),
            referenced: control.start.map(|place| place.is_some()),
            feed: control.feed,
            control,
            frame: Frame::IDENTITY,
            plane: if lathe { PLANES[1] } else { PLANES[0] },
            scale,
            absolute: true,
            feed_scale: 1.0,
            feed_mode: if lathe { FeedMode::Revolution } else { FeedMode::Minute },
            speed: 0.0,
            sense: Sense::Still,
            surface: None,
            clamp: f64::INFINITY,
            lathe,
            tool: None,
            exact: false,
            offset: None,
            side: None,
            out: VecDeque::new(),
            line: 0,
            main_line: 0,
            depth: 0,
            notes: Vec::new(),
            vacant_feed: None,
            purpose: None,
            moved: false,
            joint: None,
            waiting: None,
            torn: false,
            loop_line: 0,
            blind_step: None,
            pitch: None,
            work: 0,
            fed: None,
            partly_known: None,
        };
        // X of a lathe is a diameter in the program and a radius here.
        if lathe {
            kernel.at[0] *= 0.5;
        }
        kernel
    }

    pub fn push(&mut self, kind: EventKind) {
        let ends = !matches!(kind, EventKind::Block | EventKind::Coolant(_));
        self.torn |= self.waiting.is_some() && ends && !matches!(kind, EventKind::Motion(_));
        if ends && self.offset.as_ref().is_some_and(Offsetting::is_waiting) && !matches!(kind, EventKind::Motion(_)) {
            // What stands between two blocks of a contour happens behind the first of them.
            if let Some(offset) = &mut self.offset {
                offset.hold(kind);
            }
            return;
        }
        self.out.push_back(Event { line: self.line, main_line: self.main_line, depth: self.depth, kind });
    }

    pub fn note(&mut self, text: impl Into<String>) {
        let text = text.into();
        if self.notes.len() < 1000 && self.notes.iter().all(|(_, known)| *known != text) {
            self.notes.push((self.line, text));
        }
    }

    /// mm of a unit of the program.
    pub fn unit(&self) -> Result<f64, Fault> {
        self.scale.ok_or_else(|| {
            Fault::new(
                "nothing says whether lengths are millimetres or inches: write the code of the unit before (G21 or G20, \
                 on a Siemens control G71 or G70), or give --units mm or --units inch",
            )
        })
    }

    /// A length in mm; zero is the same in every unit.
    pub fn length(&self, value: f64) -> Result<f64, Fault> {
        if value == 0.0 { Ok(0.0) } else { Ok(value * self.unit()?) }
    }

    /// Position in coordinates of the program; an axis that is not known counts as 0.
    pub fn program_at(&self) -> Axes {
        self.frame.program(self.at)
    }

    /// Start and end of a motion in program coordinates.
    fn ends(&self, target: &Target) -> Result<(Axes, Axes), Fault> {
        let from = self.program_at();
        let mut to = from;
        for axis in 0..9 {
            if let Some(place) = target.absolute[axis] {
                to[axis] = place;
            }
            if let Some(step) = target.step[axis] {
                to[axis] += step;
            }
            if to[axis].is_nan() || to[axis].abs() > FARTHEST {
                return Err(Fault::new(format!("{} is farther than any machine reaches", to[axis])));
            }
        }
        Ok((from, to))
    }

    /// Ends in workpiece coordinates, and whether an axis is not known; the axes are there afterwards.
    fn arrive(&mut self, target: &Target, from: Axes, to: Axes) -> (Axes, Axes, bool) {
        let (mut start, end) = (self.frame.base(from), self.frame.base(to));
        let mut unknown = false;
        for axis in 0..9 {
            if !self.referenced[axis] && target.step[axis].is_some_and(|step| step != 0.0) && self.blind_step.is_none()
            {
                self.blind_step = Some(self.line);
            }
            if !self.referenced[axis] && target.absolute[axis].is_some() {
                // It comes from nowhere known and counts as standing.
                start[axis] = end[axis];
                self.referenced[axis] = true;
                unknown = true;
            }
        }
        self.at = end;
        (start, end, unknown)
    }

    pub fn straight(&mut self, target: &Target, rapid: bool) -> Result<(), Fault> {
        let (from, to) = self.ends(target)?;
        let feed_needed = !rapid && !target.is_empty();
        if feed_needed {
            if self.feed.is_none() {
                return Err(self.no_feed());
            }
            self.feeds()?;
        }
        let (mut start, end, unknown) = self.arrive(target, from, to);
        // A block that names the end of the contour beside which the cutter stands leads it there.
        if start == end && self.plane[..2].iter().any(|axis| target.names(*axis)) {
            start = self.offset.as_ref().and_then(|offset| offset.standing(start)).unwrap_or(start);
        }
        self.emit_straight(start, end, rapid, unknown)
    }

    fn emit_straight(&mut self, start: Axes, end: Axes, rapid: bool, unknown: bool) -> Result<(), Fault> {
        if start == end {
            // A block that goes nowhere takes a time of its own only where F says so.
            if unknown {
                self.emit(Motion {
                    rapid: true,
                    path: Path::Line,
                    start,
                    end,
                    time: 0.0,
                    length: 0.0,
                    unknown,
                    purpose: Purpose::Approach,
                })?;
            }
            return Ok(());
        }
        let square = |axes: [usize; 3]| axes.iter().map(|i| (end[*i] - start[*i]).powi(2)).sum::<f64>();
        let (main, rotary, second) = (square([0, 1, 2]), square([3, 4, 5]), square([6, 7, 8]));
        let length = if main > 0.0 {
            main
        } else if second > 0.0 {
            second
        } else {
            rotary
        };
        let length = length.sqrt();
        let only_rotary = main == 0.0 && second == 0.0;
        let longest_rotary = (3..6).map(|i| (end[i] - start[i]).abs()).fold(0.0, f64::max);
        let counted = if only_rotary {
            longest_rotary
        } else if self.control.rotary_feed_all_axes {
            (main + second + rotary).sqrt()
        } else {
            length
        };
        let time = if rapid { 0.0 } else { self.time(counted, only_rotary, &start, &end, None)? };
        let along_w = (0..9).all(|i| i == 2 || start[i] == end[i]);
        let purpose = self.purpose.unwrap_or(match (rapid, along_w) {
            (true, true) if end[2] > start[2] => Purpose::Retract,
            (true, _) => Purpose::Approach,
            (false, true) if end[2] < start[2] => Purpose::Plunge,
            (false, _) => Purpose::Cut,
        });
        let length = if only_rotary { longest_rotary } else { length };
        self.emit(Motion { rapid, path: Path::Line, start, end, time, length, unknown, purpose })
    }

    /// A circular motion; `turns` full turns beside the arc itself.
    pub fn round(&mut self, target: &Target, round: Round, left: bool, turns: f64) -> Result<(), Fault> {
        if self.feed.is_none() {
            return Err(self.no_feed());
        }
        self.feeds()?;
        if !(0.0..=TURNS).contains(&turns) || turns.fract() != 0.0 {
            return Err(Fault::new(format!("{turns} turns: write a whole number up to {TURNS}")));
        }
        let [u, v, w] = self.plane;
        let (from, to) = self.ends(target)?;
        if (3..9).any(|axis| from[axis] != to[axis]) {
            return Err(Fault::new("axes beside X, Y and Z move in an arc; write the arc without them"));
        }
        let (start, end) = ([from[u], from[v]], [to[u], to[v]]);
        let centre = match round {
            Round::Centre(centre) => centre,
            Round::Radius(radius) => centre_by_radius(start, end, radius, left).ok_or_else(|| {
                Fault::new(
                    "no arc of this radius joins the two points: they are the same or farther apart than twice the \
                     radius; check the end and the radius",
                )
            })?,
        };
        let reach = |point: [f64; 2]| (point[0] - centre[0]).hypot(point[1] - centre[1]);
        let radius = reach(start);
        let gap = (radius - reach(end)).abs();
        if gap.is_nan() || gap > arc_tolerance(radius) {
            return Err(Fault::new(format!(
                "the arc misses its end by {gap:.4} mm; check the centre (its form, too: increments or absolute)"
            )));
        }
        if radius < 1e-9 {
            return Err(Fault::new("the arc has no radius; check its centre"));
        }
        let (factor, mirrored) = self.frame.plane(self.plane).ok_or_else(|| {
            Fault::new("scaling by axis or a turn out of the plane makes no circle of this arc; write it in lines")
        })?;
        let angle = sweep(start, end, centre, left) + std::f64::consts::TAU * turns;
        let mut middle = from;
        (middle[u], middle[v]) = (centre[0], centre[1]);
        let middle = self.frame.base(middle);
        // A full circle and an arc by steps are the same wherever they begin.
        if let Some(axis) = [u, v].into_iter().find(|axis| !self.referenced[*axis] && target.absolute[*axis].is_some())
        {
            return Err(Fault::new(format!(
                "the arc begins at a place of {0} that only the machine knows, so it has no length: name {0} before it, or give --start",
                AXES[axis]
            )));
        }
        let lost = !self.referenced[u] || !self.referenced[v];
        let (from, to, mut unknown) = self.arrive(target, from, to);
        unknown |= lost;
        let radius = radius * factor;
        let arc = Arc { centre: [middle[u], middle[v]], plane: self.plane, left: left != mirrored, angle, radius };
        let length = (radius * angle).hypot(to[w] - from[w]);
        let time = self.time(length, false, &from, &to, Some(&arc))?;
        let purpose = self.purpose.unwrap_or(Purpose::Cut);
        self.emit(Motion { rapid: false, path: Path::Arc(arc), start: from, end: to, time, length, unknown, purpose })
    }

    /// A motion at feed begins: what is cut lies in one place, so that all work offsets in which something is cut have to be known.
    fn feeds(&mut self) -> Result<(), Fault> {
        let first = *self.fed.get_or_insert(self.work);
        if self.control.one_place && first != self.work {
            return Err(Fault::new(
                "this is another work offset than that of the first motion at feed, and how they lie to each other is not known: give \
                 [offsets] in the setup, such as G55 = [\"100 mm\", \"0 mm\", \"0 mm\"], or --set control.offset.G55=\"100,0,0 mm\"; where the \
                 offset is a datum of Klartext or one beyond G59, divide the program there",
            ));
        }
        Ok(())
    }

    pub fn no_feed(&self) -> Fault {
        Fault::new(self.vacant_feed.clone().unwrap_or_else(|| {
            "no feed: the motion needs a word F before it, in the unit of G93, G94 or G95".to_owned()
        }))
    }

    /// Time of a motion at feed, s.
    fn time(&self, length: f64, rotary: bool, start: &Axes, end: &Axes, arc: Option<&Arc>) -> Result<f64, Fault> {
        let feed = self.feed.ok_or_else(|| self.no_feed())?;
        let feed = if rotary { feed / self.feed_scale } else { feed };
        if feed <= 0.0 {
            return Err(Fault::new("no feed: F is zero; write a feed above zero"));
        }
        Ok(match self.feed_mode {
            FeedMode::Minute => 60.0 * length / feed,
            FeedMode::Inverse => 60.0 / feed,
            FeedMode::Revolution => {
                if let Some(surface) = self.surface {
                    return surface_time(start, end, arc, length, feed, surface, self.clamp);
                }
                if self.speed <= 0.0 {
                    return Err(Fault::new("a feed per revolution, but no spindle speed: write S before it"));
                }
                60.0 * length / (feed * self.speed)
            }
        })
    }

    pub fn hand_on(&mut self, motion: Motion) -> Result<(), Fault> {
        match &mut self.offset {
            Some(offset) => {
                let place =
                    Event { line: self.line, main_line: self.main_line, depth: self.depth, kind: EventKind::Block };
                let flat = self.plane[..2].iter().all(|axis| motion.start[*axis] == motion.end[*axis]);
                let leaves = offset.leaves_by(flat);
                let done = offset.take(motion, place)?;
                self.out.extend(done);
                if leaves {
                    self.offset = None;
                }
            }
            None => self.push(EventKind::Motion(motion)),
        }
        Ok(())
    }

    /// Takes up a compensation of the radius, on the other side where the contour is mirrored.
    pub fn compensate(&mut self, offset: Offsetting) {
        let mirrored = self.frame.mirrors(self.plane);
        self.offset = Some(offset.fed(self.control.feed_at_contour).led(self.control.startup_b).mirrored(mirrored));
    }

    /// Ends the compensation of the radius with the motions that wait; the next motion leads away from the contour.
    pub fn finish_offset(&mut self) -> Result<(), Fault> {
        self.close_joint()?;
        if let Some(offset) = &mut self.offset {
            let done = offset.finish()?;
            self.out.extend(done);
            if !offset.is_leaving() {
                self.offset = None;
            }
        }
        Ok(())
    }

    /// The program ends.
    pub fn end(&mut self) -> Result<(), Fault> {
        self.close_joint()?;
        self.finish_offset()?;
        self.push(EventKind::End);
        Ok(())
    }

    pub fn dwell(&mut self, seconds: f64) -> Result<(), Fault> {
        if !(0.0..=1e6).contains(&seconds) {
            return Err(Fault::new(format!("a dwell of {seconds} s: write a time from 0 to 1 000 000 s")));
        }
        if seconds > 0.0 {
            self.push(EventKind::Dwell(seconds));
        }
        Ok(())
    }

    pub fn spindle(&mut self, sense: Sense) {
        self.sense = sense;
        self.push(EventKind::Spindle { speed: if sense.stands() { 0.0 } else { self.speed }, sense });
    }

    /// A function of the machine, with its time where the control has been told one.
    pub fn auxiliary(&mut self, code: u32) {
        let time = self.control.m.get(&code).copied();
        if time.is_none() {
            self.note(format!(
                "M{code} is a function of the machine whose time is not known; it counts 0 s: give --set control.m.{code}=\"1 s\""
            ));
        }
        self.push(EventKind::Auxiliary(code, time.unwrap_or(0.0)));
    }

    /// Direction of X Y Z at the end of the newest motion that has not been handed on.
    pub fn direction(&self) -> Option<[f64; 3]> {
        self.out.iter().rev().find_map(|event| {
            if let EventKind::Motion(motion) = event.kind { Some(motion.directions().1) } else { None }
        })
    }

    pub fn set_speed(&mut self, speed: f64) -> Result<(), Fault> {
        if !(0.0..=1e6).contains(&speed) {
            return Err(Fault::new(format!("S{speed}: write a speed from 0 to 1 000 000 rpm")));
        }
        let changes = !self.sense.stands() && speed != self.speed;
        self.speed = speed;
        if changes {
            self.push(EventKind::Spindle { speed, sense: self.sense });
        }
        Ok(())
    }

    pub fn set_feed(&mut self, value: f64, scale: f64) -> Result<(), Fault> {
        if !(0.0..=1e9).contains(&value) {
            return Err(Fault::new(format!("F{value}: write a feed from 0 to 1e9")));
        }
        (self.feed, self.feed_scale) = (Some(value * scale), scale);
        self.vacant_feed = None;
        Ok(())
    }

    /// Places count in another work offset by its number, as of [`Offset::Work`]: `known` tells of X, Y and Z whether it is known how it
    /// lies to the first one. Where that is known of all, places are worked out in the first one, and nothing happens to the program.
    pub fn work_offset(&mut self, number: u32, known: [bool; 3]) {
        if known != [true; 3] && known != [false; 3] {
            self.partly_known.get_or_insert(self.line);
        }
        let number = if known == [true; 3] { 0 } else { number };
        if number != self.work {
            self.work = number;
            self.work_offset_again();
        }
    }

    /// Whether places count in the first work offset, or in one of which it is known how it lies to that.
    pub fn counts_in_first(&self) -> bool {
        self.work == 0
    }

    /// The work offset in force is named again.
    pub fn work_offset_again(&mut self) {
        self.offset_by(Offset::Work(self.work));
    }

    /// A table of the control adds to programmed positions, which shifts the program as a whole.
    pub fn offset_by(&mut self, offset: Offset) {
        self.push(EventKind::Offset(offset));
    }

    pub fn change_tool(&mut self, number: Option<u32>) {
        self.tool = number;
        self.push(EventKind::ToolChange(number));
    }

    /// Axes are somewhere that only the machine knows.
    pub fn forget(&mut self, axes: impl Iterator<Item = usize>) {
        for axis in axes {
            self.referenced[axis] = false;
            self.at[axis] = 0.0;
        }
    }

    /// A motion in machine coordinates: its axes go where only the machine knows.
    pub fn machine_motion(&mut self, axes: &[usize]) -> Result<(), Fault> {
        if axes.is_empty() {
            return Ok(());
        }
        let position = self.at;
        self.emit(Motion {
            rapid: true,
            path: Path::Line,
            start: position,
            end: position,
            time: 0.0,
            length: 0.0,
            unknown: true,
            purpose: Purpose::Approach,
        })?;
        self.forget(axes.iter().copied());
        self.push(EventKind::Home(std::array::from_fn(|axis| axes.contains(&axis))));
        Ok(())
    }
}
