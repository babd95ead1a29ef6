//! Part programs as a nominal model of the times that runs of them took.
//!
//! ```text
//!  G-code ─► Program ─► times by drives and changer ─┐
//!  medians of undisturbed runs, where there is none ─┴─► time of a stretch ─► + effects ─► Forward
//! ```
//!
//! The same stretch is timed in every run, and what the model has wrong of it is wrong in all of
//! them. Observations of a group are therefore sorted by stretch, so that this error is the memory of
//! the noise and no run counts for another; and groups are the sections of one tool, so that an
//! effect must help to predict tools which the fit has not seen.

mod file;
mod rows;

pub use file::CODES;
pub(super) use file::{FORM, section};

use super::features::{self, standardised};
use super::search;
use super::settings::Settings;
use super::{
    Candidate, Channel, ChannelId, Covariate, EffectId, EffectRefusal, Forward, Frame, Measured, Movable, Parameter,
    Point, Role, Surface, Transform, WrittenEffect,
};
use rows::{Rows, rows};
use toolroom_drives::{Drives, times};
use toolroom_form::significant as rounded;
use toolroom_innovations::Chain;
use toolroom_program::{Action as Happens, Program};
use toolroom_records::{Records, Sensor};
use toolroom_scenario::Target;
use toolroom_scenario::effects::{PROGRAM_EFFECTS, SHOP_EFFECTS, ShopDeviations};

/// What is known of a machine and its programs before any measurement.
#[derive(Clone, Debug, Default)]
pub struct ProgramModel {
    /// Part programs by the name under which runs are recorded.
    pub programs: Vec<(String, Program)>,
    /// Drives and tool changer.
    pub drives: Drives,
    /// Effects that are switched on.
    pub effects: ShopDeviations,
    /// Time of every hold, however long it was logged, s.
    pub hold_each: f64,
}

impl ProgramModel {
    /// The greatest speed of the spindle that the programs command, rad/s.
    fn greatest_speed(&self) -> Option<f64> {
        let blocks = self.programs.iter().flat_map(|(_, program)| &program.blocks);
        let speeds = blocks.flat_map(|block| &block.actions).filter_map(|(_, action)| match action {
            Happens::Spindle(speed, _) => Some(speed * std::f64::consts::TAU / 60.0),
            Happens::Coolant(_) | Happens::Stop | Happens::Change(_) | Happens::Home(_) | Happens::End => None,
        });
        speeds.filter(|speed| *speed > 0.0).max_by(f64::total_cmp)
    }
}

/// Prior standard deviation of the logarithm of the rapid speed (assumption).
const RAPID: f64 = 0.10;
/// Of the time factor of a program (assumption, as for shops).
const FACTOR: f64 = 0.05;
/// Of times with the feed of a stretch, per standard deviation of its logarithm (assumption).
const FEED_FORM: f64 = 0.02;
/// Errors of a stretch's time: ends are known to the sampling of the log, and block times to a share
/// (assumptions). Whole runs of unknown programs scatter by a share alone.
const STRETCH: Sensor = Sensor { absolute: 0.1, relative: 0.02, resolution: 0.0 };
const WHOLE: Sensor = Sensor { absolute: 0.5, relative: 0.05, resolution: 0.0 };
/// Scatter that a tool change, a hole and a hold bring of themselves, s and share of the logged hold
/// (assumptions): no constant per event holds better.
const CHANGE_SCATTER: f64 = 2.0;
const HOLE_SCATTER: f64 = 0.2;
const HOLD_SCATTER: f64 = 0.3;
/// Corner deviations, um, and jerk times, ms, with which an acceleration is tried (assumptions). The least
/// deviations are those of controllers that nearly stop at every corner.
const CORNERS: [f64; 5] = [0.01, 0.1, 1.0, 10.0, 100.0];
const JERKS: [f64; 3] = [0.0, 10.0, 30.0];

/// Base speeds of a spindle over its greatest speed, with which a ramp is tried: from constant power throughout to constant
/// torque throughout (assumptions).
const BASES: [f64; 5] = [0.0, 0.15, 0.3, 0.5, 1.0];
/// Settling behind a rapid motion over that behind a motion at feed (assumptions).
const BEHIND_RAPID: [f64; 3] = [0.0, 0.15, 1.0];

/// How a candidate acts.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Action {
    /// Time on every row, s per size.
    Feature(usize),
    /// Acceleration with this corner deviation, m, and jerk time, s.
    Acceleration(f64, f64),
    /// Ramp of the spindle with this base speed and that at which the size is stated, rad/s.
    Spindle { base: f64, reference: f64 },
    /// Settling, behind a rapid motion this share of it.
    Settling(f64),
}

impl Action {
    /// Drives on which it acts with a size.
    fn change(self, size: f64, drives: &mut Drives) {
        match self {
            Self::Feature(_) => {}
            Self::Acceleration(corner, jerk) => {
                drives.inverse_acceleration += size;
                drives.corner_deviation = corner;
                drives.jerk_time = jerk;
            }
            Self::Spindle { base, reference } => {
                drives.spindle_constant += spindle_constant(size, base, reference);
                drives.spindle_base_speed = base;
            }
            Self::Settling(rapid) => {
                drives.feed_settling += size;
                drives.rapid_settling += size * rapid;
            }
        }
    }
}

/// Constant k of a spindle that takes `time`, s, from rest to `reference`, at constant torque up to `base`, both rad/s.
fn spindle_constant(time: f64, base: f64, reference: f64) -> f64 {
    time / (reference * reference + base * base)
}

/// Part programs over timed stretches.
pub struct Stretches {
    model: ProgramModel,
    frame: Frame,
    rows: Rows,
    actions: Vec<Action>,
    features: Vec<Vec<f64>>,
}

impl Stretches {
    /// The model over `records`, whose groups and their part in the fit are given.
    pub fn new(
        model: ProgramModel,
        records: &Records,
        groups: (Vec<String>, Vec<usize>, Vec<bool>),
        settings: &Settings,
    ) -> Self {
        let (names, group_of_row, fitted) = groups;
        let order = rows::order(records, &group_of_row);
        let records = records.select(&order);
        let group_of_row: Vec<usize> = order.iter().map(|row| group_of_row[*row]).collect();
        let inside: Vec<bool> = group_of_row.iter().map(|group| fitted[*group]).collect();
        let rows = rows(&model, &records, &inside);
        let whole = rows.of_program.iter().all(Option::is_none);
        let sensor =
            settings.sensors.iter().find(|(name, _)| name == ChannelId::CycleTime.word()).map(|(_, sensor)| *sensor);
        let channel = Channel {
            id: ChannelId::CycleTime,
            display: "s",
            unit: "s",
            transform: if whole { Transform::Log } else { Transform::Linear },
            sensor: sensor.unwrap_or(if whole { WHOLE } else { STRETCH }),
        };
        let times =
            records.numbers(ChannelId::CycleTime.word()).map_or_else(|| vec![f64::NAN; records.len()], <[f64]>::to_vec);
        // A row without nominal time says nothing.
        let times = times.iter().zip(&rows.known).map(|(time, known)| if *known { *time } else { f64::NAN }).collect();
        let mut frame = Frame::new(Measured::new(vec![(channel, times)], names, group_of_row, fitted));
        for observation in frame.measured.observations.iter_mut().filter(|_| !whole) {
            let row = observation.row;
            let scatter = [
                CHANGE_SCATTER * rows.changes[row].sqrt(),
                HOLE_SCATTER * rows.holes[row].sqrt(),
                HOLD_SCATTER * rows.hold_time[row],
            ];
            observation.deviation = scatter.iter().fold(observation.deviation, |sum, part| sum.hypot(*part));
        }
        // Motions, holes and tool changes are off by times of their own order.
        let kind = |row: usize| usize::from(rows.holes[row] > 0.0) + 2 * usize::from(rows.changes[row] > 0.0);
        frame.kinds = (0..records.len()).map(kind).collect();
        // What a model has wrong of a stretch it has wrong of it in every piece.
        let blocks: usize = model.programs.iter().map(|(_, program)| program.blocks.len()).max().unwrap_or(0);
        frame.repeats = rows.of_program.iter().map(|place| place.map(|(at, first, _)| at * blocks + first)).collect();
        frame.order = order;
        let mut stretches = Self { model, frame, rows, actions: Vec::new(), features: Vec::new() };
        stretches.allowance(&records);
        stretches.catalogue(whole);
        stretches.frame.covariates = stretches.covariates(&records);
        stretches
    }

    fn allowance(&mut self, records: &Records) {
        if self.rows.of_program.iter().any(Option::is_some) {
            self.frame.parameters =
                vec![Parameter { name: "rapid speed".to_owned(), deviation: RAPID, role: Role::Constant }];
            let movable = Movable::factor("drives.rapid_speed", Target::Shop);
            self.frame.words.movable = vec![("rapid speed".to_owned(), movable)];
        }
        let mut surface = |name: String, feature: Vec<f64>, deviation: f64| {
            let channels = vec![0];
            self.frame.surfaces.push(Surface {
                name,
                channels,
                feature,
                deviation,
                role: Role::Allowance,
                absolute: false,
            });
        };
        let programs = features::indicators(records, &["program"]);
        if programs.is_empty() {
            surface("time factor".to_owned(), vec![1.0; records.len()], FACTOR);
        }
        for (_, name, feature) in programs {
            surface(format!("time factor of {name}"), feature, FACTOR);
        }
        if let Some(feature) = standardised(&self.rows.ln_feed) {
            surface("time, ln feed".to_owned(), feature, FEED_FORM);
        }
    }

    fn catalogue(&mut self, whole: bool) {
        let mut add = |id: EffectId, shape: String, typical: f64, action: Action| {
            let greatest = id.entry().size.max;
            self.frame.candidates.push(Candidate { id, shape, typical, greatest, least: 0.0 });
            self.actions.push(action);
        };
        let rows = &self.rows;
        let known = [
            (EffectId::FEED_OVERRIDE, "as logged", 1.0, rows.overridden.clone()),
            (EffectId::TOOL_CHANGE_DELAY, "", 5.0, rows.changes.clone()),
            (EffectId::CANNED_CYCLE_DWELL, "", 1.0, rows.holes.clone()),
            (EffectId::FEED_HOLD, "each alike", 10.0, rows.holds.clone()),
            (EffectId::FEED_HOLD, "as long as logged", 10.0, rows.hold_share.clone()),
        ];
        for (id, shape, typical, feature) in known {
            if feature.iter().any(|value| *value != 0.0) {
                add(id, shape.to_owned(), typical, Action::Feature(self.features.len()));
                self.features.push(feature);
            }
        }
        if !whole {
            let identified = (self.model.drives.corner_deviation, self.model.drives.jerk_time);
            let all =
                || CORNERS.into_iter().flat_map(|corner| JERKS.map(|jerk| (1e-6 * corner, 1e-3 * jerk))).collect();
            // An acceleration that is on already only grows: its corners are known.
            let on = self.model.effects.axis_acceleration > 0.0;
            let shapes: Vec<(f64, f64)> = if on { vec![identified] } else { all() };
            for (corner, jerk) in shapes {
                let mut shape = format!("corners within {} um", rounded(corner * 1e6));
                if jerk > 0.0 {
                    shape += &format!(", jerk time {} ms", rounded(jerk * 1e3));
                }
                add(EffectId::AXIS_ACCELERATION, shape, 0.5, Action::Acceleration(corner, jerk));
            }
            let drives = &self.model.drives;
            if let Some(reference) = self.model.greatest_speed() {
                // A spindle that ramps already only gets slower: its base speed is known.
                let known = (drives.spindle_constant > 0.0).then_some(drives.spindle_base_speed);
                let all = || BASES.map(|share| share * reference).to_vec();
                for base in known.map_or_else(all, |base| vec![base.min(reference)]) {
                    let rpm = |speed: f64| rounded(speed * 60.0 / std::f64::consts::TAU);
                    let shape = format!("from rest to {} rpm, base speed {} rpm", rpm(reference), rpm(base));
                    add(EffectId::SPINDLE_RAMP, shape, 3.0, Action::Spindle { base, reference });
                }
            }
            for share in BEHIND_RAPID {
                let shape = format!("{} of it behind rapid motions", rounded(share));
                add(EffectId::STOP_SETTLING, shape, 0.2, Action::Settling(share));
            }
        }
        let mut untried = search::missing(SHOP_EFFECTS, &self.frame.candidates);
        untried.extend(search::missing(PROGRAM_EFFECTS, &self.frame.candidates));
        self.frame.untried = untried;
    }

    fn covariates(&self, records: &Records) -> Vec<Covariate> {
        let mut list: Vec<Covariate> = Vec::new();
        let mut add = |name: &str, values: &[f64]| {
            if let Some(values) = standardised(values) {
                list.push(Covariate { name: name.to_owned(), values });
            }
        };
        let rows = &self.rows;
        add("tool changes", &rows.changes);
        add("auxiliary functions", &rows.auxiliary);
        add("holes", &rows.holes);
        add("share of rapid motions", &rows.rapid_share);
        add("motions per second", &rows.density);
        add("blocks per second", &rows.block_density);
        add("ln feed", &rows.ln_feed);
        add("feed override", &rows.overridden);
        add("holds", &rows.holds);
        if let Some(elapsed) = features::elapsed(records) {
            add("calendar", &elapsed);
        }
        for (column, name, values) in features::indicators(records, &["program", "section", "machine"]) {
            add(&format!("{column}={name}"), &values);
        }
        list
    }

    /// Time of every row without effects that are only candidates, or with one of a size that acts on the drives, s.
    fn nominal(&self, rapid: f64, candidate: Option<(Action, f64)>) -> Vec<f64> {
        let effects = &self.model.effects;
        let mut drives = self.model.drives;
        drives.rapid_speed *= rapid;
        drives.inverse_acceleration += effects.axis_acceleration;
        if let Some((action, size)) = candidate {
            action.change(size, &mut drives);
        }
        let clocks: Vec<Vec<f64>> = self.model.programs.iter().map(|(_, program)| clock(program, &drives)).collect();
        let rows = &self.rows;
        let time = |row: usize| {
            let base = match rows.of_program[row] {
                Some((program, first, end)) => clocks[program][end] - clocks[program][first],
                None => rows.median[row],
            };
            base + effects.feed_override * rows.overridden[row]
                + effects.tool_change_delay * rows.changes[row]
                + effects.canned_cycle_dwell * rows.holes[row]
                + effects.feed_hold * rows.hold_share[row]
                + self.model.hold_each * rows.holds[row]
        };
        (0..rows.of_program.len()).map(time).collect()
    }

    /// The stretches that differ most from the nominal model in the mean of their runs, in words.
    pub fn places(&self, most: usize) -> Vec<String> {
        rows::places(&self.model, &self.rows, &self.frame.measured, &self.simulate(&Point::nominal(self)), most)
    }

    /// Measured and nominal time of a run of each program, in words; of runs kept out of the fit, where
    /// there are any.
    pub fn totals(&self) -> Vec<String> {
        rows::totals(&self.model, &self.rows, &self.frame.measured, &self.simulate(&Point::nominal(self)))
    }
}

/// Time at which each block of a program begins, and the end.
fn clock(program: &Program, drives: &Drives) -> Vec<f64> {
    let mut sum = 0.0;
    let mut clock = vec![0.0];
    clock.extend(times(program, drives).iter().map(|time| {
        sum += time;
        sum
    }));
    clock
}

impl Forward for Stretches {
    fn frame(&self) -> &Frame {
        &self.frame
    }

    fn refusal(&self, _at: &Point) -> Option<EffectRefusal> {
        None // no effect of a user acts here
    }

    fn scatter_is_known(&self, _channel: usize) -> bool {
        false
    }

    fn chains(&self, _at: &Point) -> Vec<Chain> {
        Vec::new()
    }

    fn written(&self, candidate: usize) -> WrittenEffect {
        let shape = match self.actions[candidate] {
            Action::Acceleration(corner, jerk) => {
                vec![("corner_deviation", corner, "m", "um"), ("jerk_time", jerk, "s", "ms")]
            }
            Action::Spindle { base, reference } => {
                vec![("base_speed", base, "rad/s", "rpm"), ("reference_speed", reference, "rad/s", "rpm")]
            }
            Action::Settling(rapid) => vec![("rapid", rapid, "1", "1")],
            Action::Feature(_) if self.frame.candidates[candidate].shape == "each alike" => {
                vec![("each_alike", 1.0, "1", "1")]
            }
            Action::Feature(_) => Vec::new(),
        };
        WrittenEffect { shape, ..WrittenEffect::default() }
    }

    fn simulate(&self, point: &Point) -> Vec<f64> {
        let rapid = point.parameters.first().map_or(1.0, |x| (RAPID * x).exp());
        let mut times = self.nominal(rapid, None);
        let mut before: Option<Vec<f64>> = None;
        for (action, size) in self.actions.iter().zip(&point.effects).filter(|(_, size)| **size != 0.0) {
            match action {
                Action::Feature(index) => {
                    times.iter_mut().zip(&self.features[*index]).for_each(|(time, feature)| *time += size * feature);
                }
                Action::Acceleration(..) | Action::Spindle { .. } | Action::Settling(_) => {
                    let before = before.get_or_insert_with(|| self.nominal(rapid, None));
                    let with = self.nominal(rapid, Some((*action, *size)));
                    times
                        .iter_mut()
                        .zip(with.iter().zip(before))
                        .for_each(|(time, (with, without))| *time += with - *without);
                }
            }
        }
        self.frame.measured.observations.iter().map(|observation| times[observation.row]).collect()
    }
}
