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

mod action;
mod catalogue;
mod file;
mod rows;

pub use file::CODES;
pub(super) use file::{FORM, section};

use super::features::{self, standardised};
use super::settings::Settings;
use super::{
    Channel, ChannelId, Covariate, EffectRefusal, Forward, Frame, Measured, Movable, Parameter, Point, Role, Surface,
    Transform, WrittenEffect,
};
use action::{Action, EACH_ALIKE};
use rows::{Rows, rows};
use toolroom_drives::{Deviation, Drives, times};
use toolroom_innovations::Chain;
use toolroom_program::Program;
use toolroom_records::{Records, Sensor};
use toolroom_scenario::Target;
use toolroom_scenario::effects::ShopDeviations;

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
    /// Drives with the acceleration that is switched on as an effect.
    fn accelerated(&self, drives: &Drives) -> Drives {
        Drives { inverse_acceleration: drives.inverse_acceleration + self.effects.axis_acceleration, ..*drives }
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

    /// The drives with the effects that are switched on, rapid motions by a factor `rapid` faster.
    fn drives(&self, rapid: f64) -> Drives {
        let drives = self.model.drives;
        Drives { rapid_speed: drives.rapid_speed * rapid, ..self.model.accelerated(&drives) }
    }

    /// Time of every row with `drives` and the effects that are switched on beside them, s.
    fn times(&self, drives: &Drives) -> Vec<f64> {
        let effects = &self.model.effects;
        let clocks: Vec<Vec<f64>> = self.model.programs.iter().map(|(_, program)| clock(program, drives)).collect();
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
        let alike = self.frame.candidates[candidate].shape == EACH_ALIKE;
        let shape = self.actions[candidate].written(alike);
        WrittenEffect { shape, ..WrittenEffect::default() }
    }

    fn simulate(&self, point: &Point) -> Vec<f64> {
        let rapid = point.parameters.first().map_or(1.0, |x| (RAPID * x).exp());
        let active = self.actions.iter().zip(&point.effects).filter(|(_, size)| **size != 0.0);
        let mut deviations: Vec<(Deviation, f64)> = Vec::new();
        let mut added = vec![0.0; self.rows.of_program.len()];
        for (action, size) in active {
            match action {
                Action::Feature(index) => {
                    added.iter_mut().zip(&self.features[*index]).for_each(|(time, feature)| *time += size * feature);
                }
                Action::Drives(deviation) => deviations.push((*deviation, *size)),
            }
        }
        // Of two shapes of an acceleration the greater one says what happens at corners.
        deviations.sort_by(|a, b| b.1.total_cmp(&a.1));
        let (first, others): (Vec<_>, Vec<_>) =
            deviations.into_iter().partition(|(deviation, _)| matches!(deviation, Deviation::Acceleration { .. }));
        let changed = |drives: Drives, (deviation, size): (Deviation, f64)| deviation.added(size, &drives);
        let drives = first.into_iter().chain(others).fold(self.drives(rapid), changed);
        let mut times = self.times(&drives);
        times.iter_mut().zip(added).for_each(|(time, added)| *time += added);
        self.frame.measured.observations.iter().map(|observation| times[observation.row]).collect()
    }
}
