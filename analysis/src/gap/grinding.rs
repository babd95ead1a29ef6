//! Plunge grinding as a nominal model of recorded trials.

use super::features::{self, standardised};
use super::settings::Settings;
use super::{Candidate, Channel, Forward, Frame, Local, Measured, Parameter, Point, Surface, Transform};
use crate::records::{ColumnKind, Records};
use rayon::prelude::*;
use toolroom_effects::{Effect, Effects};
use toolroom_infeed::{Infeed, Input, Output, State};
use toolroom_process::Process;

/// How a candidate acts.
enum Action {
    /// By the process.
    Effect(Effect),
    /// By the process, on the rows of one coolant.
    Coolant(Vec<f64>),
}

/// A grinding process over the trials of [`Records`].
pub struct Grinding {
    process: Infeed,
    frame: Frame,
    inputs: Vec<Input>,
    revolutions: Vec<f64>,
    spark_out: Vec<f64>,
    rows: Vec<Vec<usize>>,
    part: Vec<f64>,
    actions: Vec<Action>,
}

/// Prior standard deviation of the share of a revolution's infeed that stock lacks because infeed
/// is continuous and contact finds its own start (assumption).
const RAMP: f64 = 0.5;

impl Grinding {
    /// The model over `records`, whose groups and their part in the fit are given.
    pub fn new(
        process: Infeed,
        records: &Records,
        groups: (Vec<String>, Vec<usize>, Vec<bool>),
        settings: &Settings,
    ) -> Self {
        let (names, group_of_row, fitted) = groups;
        let mut rows = vec![Vec::new(); names.len()];
        group_of_row.iter().enumerate().for_each(|(row, group)| rows[*group].push(row));
        let column = |name: &str| {
            records.numbers(name).map_or_else(
                || vec![0.0; records.len()],
                |v| v.iter().map(|x| if x.is_finite() { *x } else { 0.0 }).collect(),
            )
        };
        let (infeed, rotation) = (column("infeed_per_rev"), column("work_rotation_speed"));
        let (age, wait) = (column("coolant_age"), column("wait_time"));
        let time = features::elapsed(records).unwrap_or_else(|| vec![0.0; records.len()]);
        let inputs = (0..records.len())
            .map(|row| Input {
                infeed_per_rev: infeed[row],
                work_rotation_speed: rotation[row],
                coolant_age: age[row],
                wait_time: wait[row],
                machine_time: if time[row].is_finite() { time[row] } else { 0.0 },
                ..Input::default()
            })
            .collect();
        let channels: Vec<(Channel, Vec<f64>)> = records
            .kind
            .columns()
            .iter()
            .filter(|column| column.kind == ColumnKind::Channel)
            .filter_map(|column| {
                let values = records.numbers(column.name)?.to_vec();
                let force = column.name.contains("force");
                let transform = if force { Transform::Log } else { Transform::Linear };
                let sensor = settings.sensor(column.name);
                values.iter().any(|value| value.is_finite()).then_some((
                    Channel { name: column.name, display: column.display, unit: column.unit, transform, sensor },
                    values,
                ))
            })
            .collect();
        let measured = Measured::new(channels, names, group_of_row, fitted);
        let parameter =
            |name: &str| Parameter { name: name.to_owned(), deviation: settings.stiffness, allowance: false };
        let frame = Frame {
            parameters: vec![parameter("process stiffness Cp"), parameter("system stiffness J")],
            locals: vec![Local { name: "process stiffness of the dressing", deviation: 0.06, estimated: true }],
            ..Frame::new(measured)
        };
        let mut model = Self {
            process,
            frame,
            inputs,
            revolutions: column("revolutions"),
            spark_out: column("spark_out_revolutions"),
            rows,
            part: column("part_in_cycle"),
            actions: Vec::new(),
        };
        model.allowance(records, &infeed);
        model.catalogue(records, &wait);
        let groups = &model.frame.measured.group_of_row;
        model.frame.covariates =
            features::covariates(records, groups, &["infeed_per_rev", "revolutions", "work_rotation_speed"], None);
        model
    }

    fn allowance(&mut self, records: &Records, infeed: &[f64]) {
        let find = |name: &str| self.frame.measured.channels.iter().position(|channel| channel.name == name);
        let mut surfaces = Vec::new();
        let mut add = |name: &str,
                       channel: Option<usize>,
                       feature: Option<Vec<f64>>,
                       deviation: f64,
                       allowance: bool,
                       absolute: bool| {
            if let (Some(channel), Some(feature)) = (channel, feature) {
                surfaces.push(Surface {
                    name: name.to_owned(),
                    channels: vec![channel],
                    feature,
                    deviation,
                    allowance,
                    absolute,
                });
            }
        };
        let ones = || Some(vec![1.0; records.len()]);
        add("stock lost by continuous infeed", find("stock_removed"), Some(infeed.to_vec()), RAMP, true, true);
        add("friction", find("tangential_force"), ones(), 0.08, false, false);
        add("start of the rise", find("rise_revolutions"), ones(), 1.0, true, true);
        add("rise, level", find("rise_revolutions"), ones(), 0.05, true, false);
        add("force after spark-out, level", find("force_after_spark_out"), ones(), 0.10, true, false);
        for channel in ["normal_force", "tangential_force", "force_after_spark_out"] {
            for condition in ["infeed_per_rev", "work_rotation_speed", "revolutions"] {
                add(
                    &format!("{channel}, ln {condition}"),
                    find(channel),
                    features::logarithm(records, condition),
                    0.03,
                    true,
                    false,
                );
            }
        }
        add(
            "rise, ln infeed",
            find("rise_revolutions"),
            features::logarithm(records, "infeed_per_rev"),
            0.05,
            true,
            false,
        );
        self.frame.surfaces = surfaces;
    }

    fn catalogue(&mut self, records: &Records, wait: &[f64]) {
        let latest = features::elapsed(records)
            .map(|times| times.into_iter().filter(|time| time.is_finite()).fold(0.0, f64::max));
        let mut add = |effect: Effect, shape: String, typical: f64, action: Action| {
            let entry = effect.entry();
            self.frame.candidates.push(Candidate { id: entry.id, shape, typical, greatest: entry.size.max });
            self.actions.push(action);
        };
        for effect in Effects::every(Infeed::NAME).iter().copied() {
            match effect.entry().id {
                "wheel_dulling" => add(effect, String::new(), 0.3, Action::Effect(effect)),
                "wheel_wear" => add(effect, String::new(), 0.1, Action::Effect(effect)),
                "threshold_force" => add(effect, String::new(), 15.0, Action::Effect(effect)),
                "start_offset" => add(effect, String::new(), 3e-6, Action::Effect(effect)),
                "thermal_growth" => {
                    let times: &[f64] = if standardised(wait).is_some() { &[15.0, 60.0, 240.0] } else { &[60.0] };
                    for time in times {
                        let mut shaped = effect;
                        shaped.parameters_mut().set_value(1, *time);
                        add(effect, format!("{time} s"), 5e-10, Action::Effect(shaped));
                    }
                }
                "stiffness_drift" => {
                    if let Some(latest) = latest {
                        add(effect, String::new(), 0.1 / latest, Action::Effect(effect));
                    }
                }
                "coolant_change" => {
                    for (_, coolant, rows) in features::indicators(records, &["coolant_id"]) {
                        add(effect, format!("coolant {coolant}"), 0.1, Action::Coolant(rows));
                    }
                }
                _ => {}
            }
        }
    }

    fn process_at(&self, at: &Point) -> Infeed {
        let mut process = self.process.clone();
        process.parameters.process_stiffness *= (self.frame.parameters[0].deviation * at.parameters[0]).exp();
        process.parameters.system_stiffness *= (self.frame.parameters[1].deviation * at.parameters[1]).exp();
        let mut effects: Vec<Effect> = self.process.effects.iter().copied().collect();
        for (action, size) in self.actions.iter().zip(&at.effects) {
            if let Action::Effect(effect) = action
                && *size != 0.0
                && effects.iter().all(|own| own.entry().id != effect.entry().id)
            {
                effects.push(effect.with_size(*size));
            }
        }
        if let Ok(effects) = Effects::new(effects) {
            process.effects = effects;
        }
        process
    }

    /// Readings of a trial on a wheel in the state `wheel`, which it leaves changed.
    fn trial(&self, process: &Infeed, u: &Input, row: usize, wheel: &mut State) -> [f64; 5] {
        let mut part = process.new_part(wheel);
        // Each trial finds its own contact: what the wheel has worn is not missing from its infeed.
        part.commanded_infeed = part.wheel_wear;
        let turn = |part: &mut State, infeed: f64, revolutions: f64| {
            let whole = revolutions.floor().max(0.0);
            for _ in 0..whole as u32 {
                part.commanded_infeed += infeed;
                *part = process.revolution(part, u);
            }
            let rest = revolutions - whole;
            if rest > 1e-6 {
                let mut next = *part;
                next.commanded_infeed += infeed;
                let next = process.revolution(&next, u);
                part.stock_removed += rest * (next.stock_removed - part.stock_removed);
                part.depth_of_cut += rest * (next.depth_of_cut - part.depth_of_cut);
                part.commanded_infeed += rest * infeed;
            }
        };
        turn(&mut part, u.infeed_per_rev, self.revolutions[row]);
        let steady = process.output(&part, u);
        let resting = Input { infeed_per_rev: 0.0, ..*u };
        turn(&mut part, 0.0, self.spark_out[row]);
        let end: Output = process.output(&part, &resting);
        *wheel = part;
        [end.stock_removed, steady.normal_force, steady.tangential_force, steady.rise_revolutions, end.normal_force]
    }

    fn group(&self, process: &Infeed, at: &Point, group: usize) -> Vec<[f64; 5]> {
        let mut wheel = process.initial();
        let mut seen = 0.0;
        let factor = (self.frame.locals[0].deviation * at.locals[0][group]).exp();
        let mut readings = Vec::with_capacity(self.rows[group].len());
        for row in &self.rows[group] {
            let mut u = self.inputs[*row];
            u.process_stiffness_factor = factor;
            let changed: f64 = self
                .actions
                .iter()
                .zip(&at.effects)
                .map(|(action, size)| match action {
                    Action::Coolant(rows) => size * rows[*row],
                    Action::Effect(_) => 0.0,
                })
                .sum();
            u.coolant_factor = 1.0 - changed;
            // Parts that were ground between recorded ones dulled the wheel as this one does.
            let between = (self.part[*row] - seen - 1.0).clamp(0.0, 1e3) as u32;
            for _ in 0..between {
                self.trial(process, &u, *row, &mut wheel);
            }
            readings.push(self.trial(process, &u, *row, &mut wheel));
            seen = self.part[*row].max(seen + 1.0);
        }
        readings
    }
}

fn reading(channel: &str) -> usize {
    match channel {
        "stock_removed" => 0,
        "normal_force" => 1,
        "tangential_force" => 2,
        "rise_revolutions" => 3,
        _ => 4,
    }
}

impl Forward for Grinding {
    fn frame(&self) -> &Frame {
        &self.frame
    }
    fn simulate(&self, at: &Point) -> Vec<f64> {
        let process = self.process_at(at);
        let of_group = |group: usize| {
            let readings = self.group(&process, at, group);
            let place = |row: usize| self.rows[group].iter().position(|own| *own == row).unwrap_or(0);
            let span = &self.frame.measured.observations[self.frame.measured.spans[group].clone()];
            let value = |observation: &super::Observation| {
                readings[place(observation.row)][reading(self.frame.measured.channels[observation.channel].name)]
            };
            span.iter().map(value).collect::<Vec<f64>>()
        };
        let parts: Vec<Vec<f64>> = (0..self.rows.len()).into_par_iter().map(of_group).collect();
        parts.concat()
    }
}
