//! A power law of the recorded conditions, for data without a physical parameter set.
//!
//! Of each channel, with conditions c, level a and exponents b,
//! `ln y = a + Σ b ln c + curvature + level of the group`; flank wear grows besides with the age t of
//! its edge, `y ∝ t` or `t^p`. Each channel is a model of its own.

use super::empirical_catalogue::EMPIRICAL_EFFECTS;
use super::empirical_effects::{self, Action, LAND};
use super::features::{self, standardised};
use super::search;
use super::settings::Settings;
use super::{
    Channel, ChannelId, Covariate, EffectRefusal, Forward, Frame, Local, Measured, Parameter, Point, Role, Transform,
    WrittenEffect,
};
use toolroom_innovations::Chain;
use toolroom_records::{ColumnKind, RecordColumn, Records};
use toolroom_statistics::median;

/// Conditions in which a response is a power law, where they are recorded.
const CONDITIONS: [&str; 6] =
    ["cutting_speed", "spindle_speed", "feed_per_rev", "feed_per_tooth", "depth_of_cut", "width_of_cut"];
/// Channels that depend on the time in cut of the operation.
const TIMED: [ChannelId; 4] = [ChannelId::CycleTime, ChannelId::Temperature, ChannelId::ThermoEmf, ChannelId::StopTime];
/// Prior standard deviation of a response per spread of a condition: all but free.
const FREE: f64 = 1.0;
/// Prior standard deviation of the level of a response: free.
const LEVEL: f64 = 5.0;
/// Curvature of the logarithm of a response (assumption).
const CURVED: f64 = 0.05;
/// What the exponent of wear over time may differ from a constant rate (assumption).
const GROWN: f64 = 0.1;
/// What the course of a channel over the life of an edge may differ from its nominal form by,
/// relative: wear, feed and passive force, anything else (assumptions).
const COURSE: [f64; 3] = [0.15, 0.10, 0.05];
/// Share of a median life over which an edge is young.
const YOUNG: f64 = 0.1;
/// Age below which it counts as this, relative to the median.
const YOUNGEST: f64 = 1e-3;

/// Power law of one channel over [`Records`].
pub struct Empirical {
    frame: Frame,
    level: f64,
    /// Logarithm of the age over its median, for wear.
    growth: Vec<f64>,
    /// What differs from group to group beside the level: along the land, or along the life.
    course: Vec<f64>,
    /// Feature of each parameter.
    laws: Vec<Vec<f64>>,
    actions: Vec<Action>,
}

/// Channels of `records` that an empirical model can answer for, in the order of their columns.
pub fn channels(records: &Records, settings: &Settings) -> Vec<(ChannelId, &'static RecordColumn)> {
    let columns = records.kind.columns().iter().filter(|column| column.kind == ColumnKind::Channel);
    let columns = columns.filter_map(|column| Some((ChannelId::from_record_column(column)?, column)));
    let wanted = |name: &str| settings.channels.is_empty() || settings.channels.iter().any(|own| own == name);
    let measured = columns.filter(|(_, column)| {
        wanted(column.name)
            && records.numbers(column.name).is_some_and(|values| values.iter().any(|value| *value > 0.0))
    });
    let mut channels: Vec<(ChannelId, &'static RecordColumn)> = measured.collect();
    if channels.is_empty() {
        // Nothing is measured: a model without observations says so.
        let wear = ChannelId::FlankWear;
        channels.extend(records.kind.column(wear.word()).map(|column| (wear, column)));
    }
    channels
}

impl Empirical {
    /// The model of one channel of `records`, whose groups and their part in the fit are given.
    pub fn new(
        records: &Records,
        (id, column): (ChannelId, &'static RecordColumn),
        groups: (Vec<String>, Vec<usize>, Vec<bool>),
        settings: &Settings,
    ) -> Self {
        let (names, group_of_row, fitted) = groups;
        let values = records.numbers(column.name).map_or_else(|| vec![f64::NAN; records.len()], <[f64]>::to_vec);
        let channel = Channel {
            id,
            display: column.display,
            unit: column.unit,
            transform: Transform::Log,
            sensor: settings.sensor(column.name),
        };
        let level = median(&mut values.iter().copied().filter(|value| *value > 0.0).collect::<Vec<f64>>());
        let is_wear = id == ChannelId::FlankWear;
        let wear = records.numbers("flank_wear").filter(|_| !is_wear);
        let age = age(records, &group_of_row);
        // Edges differ in level and in the course of their life: what all of them have in common counts.
        let local = |name| Local { name, deviation: settings.edge_wear, estimated: true, scatter: false };
        let locals = vec![local("level of the group"), local("course of the group")];
        let course = match wear {
            Some(land) => land.iter().map(|land| if land.is_finite() { land / LAND } else { 0.0 }).collect(),
            None => course(&age, &group_of_row),
        };
        let measured = Measured::new(vec![(channel, values)], names, group_of_row, fitted);
        let mut model = Self {
            frame: Frame { locals, ..Frame::new(measured) },
            level,
            growth: vec![0.0; records.len()],
            course,
            laws: Vec::new(),
            actions: Vec::new(),
        };
        let known = known(id, settings);
        if is_wear {
            model.grow(&age, settings.constant_rate);
        }
        model.laws(records, id, &known);
        model.course_of_life(id, &age);
        model.covariates(records, &known, wear, &age);
        let seen = empirical_effects::Seen {
            records,
            channel: id,
            groups: &model.frame.measured.group_of_row,
            age: &age,
            known: &known,
        };
        (model.frame.candidates, model.actions) = empirical_effects::candidates(&seen).into_iter().unzip();
        model.frame.untried = search::missing(EMPIRICAL_EFFECTS, &model.frame.candidates);
        model
    }

    fn law(&mut self, name: String, feature: Vec<f64>, deviation: f64, role: Role) {
        self.frame.parameters.push(Parameter { name, deviation, role });
        self.laws.push(feature);
    }

    /// Wear in proportion to the age of the edge, or to a power of it.
    fn grow(&mut self, age: &[f64], constant_rate: bool) {
        let typical = median(&mut age.iter().copied().filter(|age| *age > 0.0).collect::<Vec<f64>>());
        self.growth = age.iter().map(|age| (age / typical).max(YOUNGEST).ln()).collect();
        let (deviation, role) = if constant_rate { (GROWN, Role::Allowance) } else { (FREE, Role::Constant) };
        self.course.clone_from(&self.growth);
        self.law("flank_wear, ln age".to_owned(), self.growth.clone(), deviation, role);
    }

    fn laws(&mut self, records: &Records, channel: ChannelId, known: &[String]) {
        self.law(format!("{channel}, level"), vec![1.0; records.len()], LEVEL, Role::Constant);
        let conditions: Vec<&str> = known.iter().map(String::as_str).collect();
        for (term, feature, linear) in features::surface(records, &conditions) {
            let (deviation, role) = if linear { (FREE, Role::Constant) } else { (CURVED, Role::Allowance) };
            self.law(format!("{channel}, {term}"), feature, deviation, role);
        }
        for (column, level, rows) in features::indicators(records, &conditions) {
            self.law(format!("{channel}, {column}={level}"), rows, FREE, Role::Constant);
        }
        if !conditions.contains(&"machine") {
            for (_, machine, rows) in features::indicators(records, &["machine"]) {
                let name = format!("gain of {channel}, machine {machine}");
                self.law(name, rows, super::settings::MACHINE_GAIN, Role::MachineGain(machine));
            }
        }
    }

    /// What all edges may have in common over their life without that an effect is missing.
    fn course_of_life(&mut self, channel: ChannelId, age: &[f64]) {
        let life = empirical_effects::life(age, &self.frame.measured.group_of_row);
        let deviation = if channel == ChannelId::FlankWear {
            COURSE[0]
        } else if empirical_effects::presses(channel) {
            COURSE[1]
        } else {
            COURSE[2]
        };
        let passed = |shape: fn(f64) -> f64| age.iter().map(|age| shape(age / life)).collect::<Vec<f64>>();
        self.law(format!("{channel}, young edge"), passed(|share| (-share / YOUNG).exp()), deviation, Role::Allowance);
        self.law(format!("{channel}, course of life"), passed(|share| share), deviation, Role::Allowance);
        self.law(format!("{channel}, end of life"), passed(|share| share * share), deviation, Role::Allowance);
    }

    fn covariates(&mut self, records: &Records, known: &[String], wear: Option<&[f64]>, age: &[f64]) {
        let conditions: Vec<&str> = known.iter().map(String::as_str).collect();
        let mut covariates = features::covariates(records, &self.frame.measured.group_of_row, &conditions, wear);
        if records.numbers("cutting_time").is_none()
            && let Some(values) = standardised(age)
        {
            covariates.push(Covariate { name: "operations of the edge".to_owned(), values });
        }
        self.frame.covariates = covariates;
    }
}

/// Conditions that the nominal response of a channel knows: those of the file, or all.
fn known(channel: ChannelId, settings: &Settings) -> Vec<String> {
    let timed = TIMED.contains(&channel).then(|| "cutting_time".to_owned());
    let conditions = settings.conditions.clone();
    conditions.unwrap_or_else(|| CONDITIONS.iter().map(|name| (*name).to_owned()).chain(timed).collect())
}

/// Time in cut of each edge at the end of a row, s; its operations, where no times are recorded.
fn age(records: &Records, groups: &[usize]) -> Vec<f64> {
    let times = records.numbers("cutting_time").filter(|times| times.iter().any(|time| *time > 0.0));
    let ones = vec![1.0; records.len()];
    features::age(groups, times.unwrap_or(&ones))
}

/// Share of the median life that has passed.
fn course(age: &[f64], groups: &[usize]) -> Vec<f64> {
    let life = empirical_effects::life(age, groups);
    age.iter().map(|age| age / life).collect()
}

impl Forward for Empirical {
    fn frame(&self) -> &Frame {
        &self.frame
    }

    fn written(&self, _candidate: usize) -> WrittenEffect {
        WrittenEffect::default()
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

    fn simulate(&self, point: &Point) -> Vec<f64> {
        let measured = &self.frame.measured;
        let mut value: Vec<f64> = self.growth.clone();
        let deviations = self.frame.parameters.iter().map(|parameter| parameter.deviation);
        for ((feature, x), deviation) in self.laws.iter().zip(&point.parameters).zip(deviations) {
            if *x != 0.0 {
                value.iter_mut().zip(feature).for_each(|(value, feature)| *value += deviation * x * feature);
            }
        }
        value.iter_mut().for_each(|value| *value = self.level * value.exp());
        for (action, size) in self.actions.iter().zip(&point.effects).filter(|(_, size)| **size != 0.0) {
            action.act(*size, &mut value);
        }
        // Last, so that what differs from edge to edge bends no effect.
        let locals = &self.frame.locals;
        for ((value, course), group) in value.iter_mut().zip(&self.course).zip(&measured.group_of_row) {
            let [level, slope] = [0, 1].map(|kind| locals[kind].deviation * point.locals[kind][*group]);
            *value *= (level + slope * course).exp();
        }
        measured.observations.iter().map(|observation| value[observation.row]).collect()
    }
}
