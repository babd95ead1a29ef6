//! Plunge grinding as a nominal model of recorded trials.
//!
//! ```text
//!  Records ─► dressings (groups) ─► conditions of each trial
//!                                        │ wheel from part to part: volume, wear
//!                                        ▼
//!                                   plunge ─► stock, forces, rise, spark-out
//! ```

mod catalogue;
mod conditions;
mod plunge;
mod scattered;
mod words;

pub use conditions::dressings;

use super::features;
use super::settings::{MACHINE_GAIN, Settings};
use super::stated::Declarations;
use super::{
    Channel, ChannelId, EffectRefusal, Forward, Frame, Local, Measured, Parameter, Point, Role, Surface, Transform,
    WrittenEffect,
};
use crate::forward::{RowByRow, first_refusal};
use catalogue::Action;
use conditions::Conditions;
use plunge::{Plunge, Stage, plunge};
use rayon::prelude::*;
use scattered::Scattered;
use toolroom_effects::{Effect, Effects};
use toolroom_infeed::{Infeed, Input};
use toolroom_innovations::Chain;
use toolroom_process::Process;
use toolroom_records::{ColumnKind, Records};

/// What a parameter of the fit does to the simulation.
enum Change {
    ProcessStiffness,
    SystemStiffness,
    /// System stiffness of one machine, on its rows.
    Machine(String, Vec<f64>),
    /// Infeed against what is commanded.
    Scale,
    /// Exponent of force in depth, less one.
    Exponent,
    /// Share of a revolution's depth that mean stock lacks beside the half of even infeed.
    Ramp,
}

/// A grinding process over the trials of [`Records`].
pub struct Grinding {
    process: Infeed,
    frame: Frame,
    conditions: Conditions,
    /// Rows of each dressing in sequence.
    rows: Vec<Vec<usize>>,
    changes: Vec<Change>,
    actions: Vec<Action>,
    /// How workpieces scatter; `None` where no scenario stands behind the trials.
    scattered: Option<Scattered>,
}

/// Mean radius lags behind the radius at the wheel by half a revolution's depth where infeed is
/// even; its prior standard deviation is an assumption, the ramp at the start of infeed.
const RAMP: [f64; 2] = [0.5, 0.15];
/// Prior standard deviation of the infeed's scale: 0.01 um of 4.43 um per revolution (assumption).
const SCALE: f64 = 0.002;
/// Prior standard deviation of the exponent of force in depth (assumption).
const EXPONENT: f64 = 0.03;
/// Scale of the half-normal prior of the scatter of Cp from dressing to dressing (assumption;
/// five trials of the ZB153U scatter by 2.8 %).
const DRESSING: f64 = 0.06;

impl Grinding {
    /// The model over `records`, whose groups and their part in the fit are given.
    pub fn new(
        process: Infeed,
        records: &Records,
        groups: (Vec<String>, Vec<usize>, Vec<bool>),
        settings: &Settings,
        stated: &Declarations,
    ) -> Self {
        let (names, group_of_row, fitted) = groups;
        let mut rows = vec![Vec::new(); names.len()];
        group_of_row.iter().enumerate().for_each(|(row, group)| rows[*group].push(row));
        let measured = Measured::new(channels(records, settings), names, group_of_row, fitted);
        let (conditions, notes) = Conditions::new(records);
        let frame = Frame {
            locals: vec![Local {
                name: "process stiffness of the dressing",
                deviation: DRESSING,
                estimated: true,
                scatter: false,
            }],
            notes,
            ..Frame::new(measured)
        };
        let scattered = stated.tool.is_some().then(|| Scattered::new(records, settings));
        let mut model = Self { process, frame, conditions, rows, changes: Vec::new(), actions: Vec::new(), scattered };
        model.calibration(records, settings);
        model.allowance(records);
        model.catalogue(records, &stated.defined);
        model.split(records, stated);
        model.state(records, &mut stated.clone());
        let groups = &model.frame.measured.group_of_row;
        let conditions = ["infeed_per_rev", "revolutions", "work_rotation_speed"];
        model.frame.covariates = features::covariates(records, groups, &conditions, None);
        model
    }

    fn calibration(&mut self, records: &Records, settings: &Settings) {
        let mut add = |name: String, deviation: f64, role: Role, change: Change| {
            self.frame.parameters.push(Parameter { name, deviation, role });
            self.changes.push(change);
        };
        add("process stiffness Cp".to_owned(), settings.stiffness, Role::Constant, Change::ProcessStiffness);
        add("system stiffness J".to_owned(), settings.stiffness, Role::Constant, Change::SystemStiffness);
        add("infeed scale".to_owned(), SCALE, Role::Constant, Change::Scale);
        for (_, machine, rows) in features::indicators(records, &["machine"]) {
            let name = format!("system stiffness, machine {machine}");
            add(name, MACHINE_GAIN, Role::Constant, Change::Machine(machine, rows));
        }
        add("exponent of force in depth".to_owned(), EXPONENT, Role::Allowance, Change::Exponent);
        add("stock lost by continuous infeed".to_owned(), RAMP[1], Role::Allowance, Change::Ramp);
    }

    fn allowance(&mut self, records: &Records) {
        let find = |id: ChannelId| self.frame.measured.channels.iter().position(|channel| channel.id == id);
        let mut surfaces = Vec::new();
        let mut add = |name: String,
                       channel: ChannelId,
                       feature: Option<Vec<f64>>,
                       deviation: f64,
                       role: Role,
                       absolute: bool| {
            if let (Some(channel), Some(feature)) = (find(channel), feature) {
                surfaces.push(Surface { name, channels: vec![channel], feature, deviation, role, absolute });
            }
        };
        let ones = || Some(vec![1.0; records.len()]);
        add("friction".to_owned(), ChannelId::TangentialForce, ones(), 0.08, Role::Constant, false);
        add("start of the rise".to_owned(), ChannelId::RiseRevolutions, ones(), 1.0, Role::Allowance, true);
        add("rise, level".to_owned(), ChannelId::RiseRevolutions, ones(), 0.05, Role::Allowance, false);
        add(
            "force after spark-out, level".to_owned(),
            ChannelId::ForceAfterSparkOut,
            ones(),
            0.10,
            Role::Allowance,
            false,
        );
        for channel in [ChannelId::NormalForce, ChannelId::TangentialForce, ChannelId::ForceAfterSparkOut] {
            for condition in ["infeed_per_rev", "work_rotation_speed", "revolutions"] {
                let feature = features::logarithm(records, condition);
                add(format!("{channel}, ln {condition}"), channel, feature, 0.03, Role::Allowance, false);
            }
        }
        let infeed = features::logarithm(records, "infeed_per_rev");
        add("rise, ln infeed_per_rev".to_owned(), ChannelId::RiseRevolutions, infeed, 0.05, Role::Allowance, false);
        self.frame.surfaces = surfaces;
    }

    /// Sum of the fitted changes that `of` finds in a kind of change, as a logarithm or share.
    fn moved(&self, point: &Point, of: impl Fn(&Change) -> f64) -> f64 {
        let moves = self.changes.iter().zip(&point.parameters).zip(&self.frame.parameters);
        moves.map(|((change, x), parameter)| of(change) * parameter.deviation * x).sum()
    }

    /// The process at a point, with the effects that act on all trials.
    fn process_at(&self, point: &Point) -> Infeed {
        let mut process = self.process.clone();
        let stiffness = self.moved(point, |change| f64::from(u8::from(matches!(change, Change::ProcessStiffness))));
        let system = self.moved(point, |change| f64::from(u8::from(matches!(change, Change::SystemStiffness))));
        process.parameters.process_stiffness *= stiffness.exp();
        process.parameters.system_stiffness *= system.exp();
        let mut effects: Vec<Effect> = self.process.effects.iter().copied().collect();
        for (action, size) in self.actions.iter().zip(&point.effects) {
            if let Action::Effect { effect, .. } = action
                && *size != 0.0
            {
                effects.push(effect.with_size(*size));
            }
        }
        process.effects = Effects::overlaid(effects);
        process
    }

    /// The process on one trial, where an effect acts on a part of them.
    fn process_on(&self, process: &Infeed, point: &Point, row: usize) -> Option<Infeed> {
        let acting = |(action, size): (&Action, &f64)| match action {
            Action::Scoped { effect, rows, .. } if *size != 0.0 && rows[row] != 0.0 => Some(effect.with_size(*size)),
            Action::Scoped { .. } | Action::Effect { .. } | Action::Coolant(_) => None,
        };
        let more: Vec<Effect> = self.actions.iter().zip(&point.effects).filter_map(acting).collect();
        (!more.is_empty()).then(|| {
            let effects = Effects::overlaid(process.effects.iter().copied().chain(more).collect());
            Infeed { effects, ..process.clone() }
        })
    }

    /// Readings of all trials after one dressing, each of a workpiece that is harder by the share `harder` than those
    /// before it.
    fn dressing(&self, process: &Infeed, point: &Point, group: usize, harder: f64) -> Vec<Plunge> {
        self.dressing_by_row(process, point, (group, harder), &mut |_, work| work())
    }

    /// The same, `each` of whose rows is handed the work on it.
    fn dressing_by_row(
        &self,
        process: &Infeed,
        point: &Point,
        (group, harder): (usize, f64),
        each: &mut RowByRow<'_>,
    ) -> Vec<Plunge> {
        let c = &self.conditions;
        let mut process = process.clone();
        if let Some(row) = self.rows[group].first() {
            let machine =
                self.moved(point, |change| if let Change::Machine(_, rows) = change { rows[*row] } else { 0.0 });
            process.parameters.system_stiffness *= machine.exp();
        }
        let share = |kind: fn(&Change) -> bool| self.moved(point, |change| f64::from(u8::from(kind(change))));
        let scale = share(|change| matches!(change, Change::Scale)).exp();
        let exponent = share(|change| matches!(change, Change::Exponent));
        let ramp = RAMP[0] + share(|change| matches!(change, Change::Ramp));
        let factor = (self.frame.locals[0].deviation * point.locals[0][group]).exp();
        let by_command =
            self.actions.iter().zip(&point.effects).any(|(action, size)| *size != 0.0 && action.is_by_command());
        let p = &process.parameters;
        let mut wheel = process.initial();
        let mut readings = Vec::with_capacity(self.rows[group].len());
        let mut follow = |row: &usize| {
            let scoped = self.process_on(&process, point, *row);
            let process = scoped.as_ref().unwrap_or(&process);
            let worn = process.effects.iter().filter(|effect| matches!(effect, Effect::WheelWear(_))).map(Effect::size);
            let wear = (p.wheel_wear_ratio + worn.sum::<f64>()) * p.work_diameter / p.wheel_diameter;
            // Parts that were ground between recorded ones took an ordinary stock.
            let stock = c.between[*row] * c.ordinary_stock;
            wheel.removed_volume += p.work_diameter * stock * std::f64::consts::PI;
            wheel.wheel_wear += wear * stock;
            let changed: f64 = self
                .actions
                .iter()
                .zip(&point.effects)
                .map(|(action, size)| if let Action::Coolant(rows) = action { size * rows[*row] } else { 0.0 })
                .sum();
            let u = Input {
                infeed_per_rev: c.inputs[*row].infeed_per_rev * scale,
                process_stiffness_factor: factor,
                coolant_factor: 1.0 - changed,
                ..c.inputs[*row]
            };
            let mut part = process.new_part(&wheel);
            if !by_command {
                // Each trial finds its own contact: what the wheel has worn is not missing.
                part.commanded_infeed = part.wheel_wear;
            }
            let Stage { infeed_per_rev, revolutions } = c.finish[*row];
            let finish = Stage { infeed_per_rev: infeed_per_rev * scale, revolutions };
            let turns = [c.revolutions[*row], c.spark_out[*row]];
            let ground = |u: &Input| plunge(process, part, u, turns, finish, exponent, ramp);
            let (read, end) = ground(&u);
            wheel = end;
            readings.push(if harder == 0.0 {
                read
            } else {
                ground(&Input { process_stiffness_factor: factor * (1.0 + harder), ..u }).0
            });
        };
        for row in &self.rows[group] {
            each(*row, &mut || follow(row));
        }
        readings
    }
}

fn channels(records: &Records, settings: &Settings) -> Vec<(Channel, Vec<f64>)> {
    let columns = records.kind.columns().iter().filter(|column| column.kind == ColumnKind::Channel);
    let with_values = columns.filter_map(|column| {
        let (id, values) = (ChannelId::from_record_column(column)?, records.numbers(column.name)?.to_vec());
        values.iter().any(|value| value.is_finite()).then_some((id, column, values))
    });
    with_values
        .map(|(id, column, values)| {
            let steady = matches!(id, ChannelId::NormalForce | ChannelId::TangentialForce);
            let transform = if steady { Transform::Log } else { Transform::Linear };
            let sensor = settings.sensor(column.name);
            (Channel { id, display: column.display, unit: column.unit, transform, sensor }, values)
        })
        .collect()
}

impl Forward for Grinding {
    fn frame(&self) -> &Frame {
        &self.frame
    }
    fn written(&self, candidate: usize) -> WrittenEffect {
        self.written_effect(candidate)
    }
    fn scatter_is_known(&self, _channel: usize) -> bool {
        self.scattered.is_some()
    }
    fn refusal(&self, point: &Point) -> Option<EffectRefusal> {
        let process = self.process_at(point);
        let candidates = self.actions.iter().zip(&point.effects);
        let mut scoped = candidates.filter_map(|(action, size)| match action {
            Action::Scoped { effect, .. } if *size != 0.0 => Some(effect),
            Action::Scoped { .. } | Action::Effect { .. } | Action::Coolant(_) => None,
        });
        if !(process.effects.has_defined() || scoped.any(|effect| effect.definition().is_some())) {
            return None;
        }
        first_refusal(self.rows.len(), |group, each| {
            self.dressing_by_row(&process, point, (group, 0.0), each);
        })
    }
    fn chains(&self, point: &Point) -> Vec<Chain> {
        self.chains_at(point)
    }
    fn simulate(&self, point: &Point) -> Vec<f64> {
        let process = self.process_at(point);
        let measured = &self.frame.measured;
        let of_group = |group: usize| {
            let readings = self.dressing(&process, point, group, 0.0);
            let place: std::collections::BTreeMap<usize, usize> =
                self.rows[group].iter().enumerate().map(|(place, row)| (*row, place)).collect();
            let span = &measured.observations[measured.spans[group].clone()];
            let value = |observation: &super::Observation| {
                readings[place[&observation.row]].channel(measured.channels[observation.channel].id)
            };
            span.iter().map(value).collect::<Vec<f64>>()
        };
        let parts: Vec<Vec<f64>> = (0..self.rows.len()).into_par_iter().map(of_group).collect();
        parts.concat()
    }
}
