//! Turning and milling as nominal models of recorded operations.

use super::cutting_effects::{self, Action};
use super::features::{self, standardised};
use super::settings::Settings;
use super::{Channel, Forward, Frame, Local, Measured, Parameter, Point, Sensor, Surface, Transform, broken};
use crate::records::Records;
use rayon::prelude::*;
use toolroom_cutting::{Milling, Turning};
use toolroom_effects::{Effect, Effects};
use toolroom_process::{Process, Record};

/// A process whose constants and effects can be replaced.
pub trait Nominal: Process + Clone {
    /// Conditions that a row must give, by the name of column and input.
    const CONDITIONS: &'static [&'static str];
    /// Output, and component of the state, that lags with a time constant: the tool body.
    const LAGGED: Option<&'static str>;
    /// How much less than in turning the form of wear over the land is believed (assumption).
    const WEAR_CURVE: f64;
    /// Prior standard deviation of the logarithm of roughness over that of ideal edges (assumption).
    const ROUGHNESS: f64;
    /// Channels whose sign depends on the cut: climb milling pulls the table along.
    const SIGNED: &'static [&'static str];
    /// The same process with other effects.
    #[must_use]
    fn with_effects(&self, effects: Effects) -> Self;
    /// Time constant of the lagged component, s.
    fn lag(&self) -> f64;
}

impl Nominal for Turning {
    const CONDITIONS: &'static [&'static str] = &["cutting_speed", "feed_per_rev", "depth_of_cut"];
    const LAGGED: Option<&'static str> = Some("tool_body_temperature_rise");
    const WEAR_CURVE: f64 = 1.0;
    const ROUGHNESS: f64 = 0.3;
    const SIGNED: &'static [&'static str] = &[];
    fn with_effects(&self, effects: Effects) -> Self {
        Self { effects, ..self.clone() }
    }
    fn lag(&self) -> f64 {
        self.pair.temperature.body_time_constant
    }
}

impl Nominal for Milling {
    const CONDITIONS: &'static [&'static str] = &["cutting_speed", "feed_per_tooth", "depth_of_cut", "width_of_cut"];
    const LAGGED: Option<&'static str> = None;
    // The three stages of the wear curve are an assumption of the model.
    const WEAR_CURVE: f64 = 2.5;
    // A micrometre of runout makes a wall many times as rough as ideal teeth would.
    const ROUGHNESS: f64 = 1.0;
    const SIGNED: &'static [&'static str] = &["feed_force"];
    fn with_effects(&self, effects: Effects) -> Self {
        Self { effects, ..self.clone() }
    }
    fn lag(&self) -> f64 {
        f64::INFINITY
    }
}

/// What a parameter of the fit does to the simulation.
enum Change {
    /// Multiplies a constant of the process.
    Constant { group: &'static str, name: &'static str },
    /// Multiplies the wear rate of all rows.
    Wear,
    /// Multiplies the wear rate by a feature of the row.
    WearFeature(Vec<f64>),
    /// Multiplies the wear rate by a function of the land.
    WearOfLand(fn(f64) -> f64),
}

/// Weight and function of the land, in the logarithm of the wear rate.
type OfLand = (f64, fn(f64) -> f64);

/// Inputs by index.
struct Ports {
    wear: usize,
    force: usize,
    lot: usize,
    pass_time: Option<usize>,
}

/// A cutting process over the rows of [`Records`].
pub struct Cutting<P: Nominal> {
    process: P,
    frame: Frame,
    /// Nominal input of each row.
    inputs: Vec<P::Input>,
    durations: Vec<f64>,
    /// Rows of each group in sequence.
    rows: Vec<Vec<usize>>,
    /// Ends of the steps of each row, s.
    nodes: Vec<Vec<f64>>,
    /// Output of each channel; wear and cycle time have none.
    outputs: Vec<Source>,
    /// Sign in which a channel is recorded, against that of the model.
    signs: Vec<f64>,
    changes: Vec<Change>,
    actions: Vec<Action>,
    ports: Ports,
}

/// Where a channel's prediction comes from.
#[derive(Clone, Copy)]
enum Source {
    /// Wear at the end of the operation.
    Wear,
    /// Mean of an output over the cut.
    Output(usize),
    /// Programmed time of the operation.
    Duration,
}

/// The start of a cut that force, power and temperature means leave out, s.
const LEFT_OUT: f64 = 20.0;
/// Longest step, s.
const LONGEST_STEP: f64 = 90.0;
/// Greatest growth of the land in a step, relative to itself and a small land.
const GROWTH: f64 = 0.35;
const SMALL_LAND: f64 = 0.03e-3;
/// Land beyond which no edge is followed, m.
const GREATEST_LAND: f64 = 1.2e-3;
/// Prior standard deviation of the form error of one part type: fixtures give way (assumption).
const FIXTURE: f64 = 0.05;
/// Prior standard deviation of an edge force: a linear law differs from a power law most at the
/// thinnest chips (assumption).
const EDGE_FORCE: f64 = 0.3;
/// Land to which features of wear refer, m.
const LAND: f64 = 0.3e-3;

impl<P: Nominal> Cutting<P> {
    /// The model over `records`, whose groups and their part in the fit are given.
    pub fn new(
        process: P,
        records: &Records,
        groups: (Vec<String>, Vec<usize>, Vec<bool>),
        settings: &Settings,
    ) -> Self {
        let (names, group_of_row, fitted) = groups;
        let mut rows = vec![Vec::new(); names.len()];
        group_of_row.iter().enumerate().for_each(|(row, group)| rows[*group].push(row));
        let durations: Vec<f64> = records.numbers("cutting_time").map_or_else(Vec::new, <[f64]>::to_vec);
        let inputs = inputs::<P>(records);
        let index = |name: &str| P::Input::index_of(name).unwrap_or(usize::MAX);
        let ports = Ports {
            wear: index("wear_rate_factor"),
            force: index("force_factor"),
            lot: index("lot_deviation"),
            pass_time: P::Input::index_of("pass_time"),
        };
        let mut channels = channels::<P>(records, settings);
        let broken = broken::take_out(&mut channels, &group_of_row);
        let mut measured = Measured::new(channels, names, group_of_row, fitted);
        broken::widen(&mut measured);
        let measured_channels = measured.channels.len();
        let outputs = measured.channels.iter().map(|channel| source::<P>(channel.name)).collect();
        let locals = vec![
            Local { name: "wear of the edge", deviation: settings.edge_wear, estimated: true, scatter: true },
            Local { name: "force of the edge", deviation: settings.edge_force, estimated: false, scatter: true },
        ];
        let mut model = Self {
            process,
            frame: Frame { locals, ..Frame::new(measured) },
            inputs,
            durations,
            rows,
            nodes: Vec::new(),
            signs: vec![1.0; measured_channels],
            outputs,
            changes: Vec::new(),
            actions: Vec::new(),
            ports,
        };
        model.calibration(records, settings);
        let wear = model.schedule();
        model.allowance(records, &wear);
        let groups = &model.frame.measured.group_of_row;
        model.frame.covariates = features::covariates(records, groups, P::CONDITIONS, Some(&wear));
        let context = cutting_effects::Seen {
            records,
            groups,
            durations: &model.durations,
            channels: &model.frame.measured.channels,
        };
        let (candidates, actions) = cutting_effects::candidates(P::NAME, &context).into_iter().unzip();
        model.frame.candidates = candidates;
        model.actions = actions;
        model.orient();
        if broken > 0 {
            model.frame.notes.push(format!("{broken} operations of edges that broke are not compared"));
        }
        if P::Input::index_of(CURVATURE).is_some() && !recorded(records, CURVATURE) {
            let note = "no path_curvature: the size of servo_lag is that on a radius of 25 mm throughout";
            model.frame.notes.push(note.to_owned());
        }
        model
    }

    /// Takes signed channels in the sign in which they are recorded.
    fn orient(&mut self) {
        let signed: Vec<usize> = (0..self.signs.len())
            .filter(|channel| P::SIGNED.contains(&self.frame.measured.channels[*channel].name))
            .collect();
        if signed.is_empty() {
            return;
        }
        let raw = self.simulate(&Point::nominal(self));
        for channel in signed {
            let observations = self.frame.measured.observations.iter().zip(&raw);
            let own = observations.filter(|(observation, _)| observation.channel == channel);
            if own.map(|(observation, raw)| observation.value * raw).sum::<f64>() < 0.0 {
                self.signs[channel] = -1.0;
                let name = self.frame.measured.channels[channel].name;
                self.frame.notes.push(format!("{name} has the opposite sign to the model's: compared so"));
            }
        }
    }

    fn parameter(&mut self, name: impl Into<String>, deviation: f64, allowance: bool, change: Change) {
        self.frame.parameters.push(Parameter { name: name.into(), deviation, allowance });
        self.changes.push(change);
    }

    fn calibration(&mut self, records: &Records, settings: &Settings) {
        let mut process = self.process.clone();
        let known: Vec<(&'static str, &'static str)> = process
            .parameters_mut()
            .into_iter()
            .flat_map(|(group, record)| record.fields().iter().map(move |field| (group, field.name)))
            .collect();
        for (group, name, deviation) in cutting_effects::CONSTANTS {
            if known.contains(&(group, name)) {
                let deviation = match *deviation {
                    cutting_effects::Prior::Force => settings.force,
                    cutting_effects::Prior::Edge => EDGE_FORCE,
                    cutting_effects::Prior::Temperature => settings.temperature,
                    cutting_effects::Prior::Wear => settings.wear_level,
                };
                self.parameter(format!("{group}.{name}"), deviation, false, Change::Constant { group, name });
            }
        }
        self.parameter("wear rate level", settings.wear_level, false, Change::Wear);
        for (name, feature, linear) in features::surface(records, P::CONDITIONS) {
            let deviation = if linear { settings.form_wear } else { 0.5 * settings.form_wear };
            self.parameter(format!("wear rate, {name}"), deviation, true, Change::WearFeature(feature));
        }
        let of_land = P::WEAR_CURVE * settings.form_land_wear;
        self.parameter("wear rate, land", of_land, true, Change::WearOfLand(|land| land / LAND));
        let early: fn(f64) -> f64 = |land| (-land / 0.05e-3).exp();
        self.parameter("wear rate, narrow land", of_land, true, Change::WearOfLand(early));
    }

    /// Fixes the steps of every row by a nominal run; wear at the end of each row.
    fn schedule(&mut self) -> Vec<f64> {
        let mut nodes = vec![Vec::new(); self.inputs.len()];
        let mut wear = vec![0.0; self.inputs.len()];
        let land = P::State::index_of("flank_wear").unwrap_or(0);
        for rows in &self.rows {
            let mut x = self.process.initial();
            for row in rows {
                let (u, duration) = (&self.inputs[*row], self.durations[*row]);
                let mut at = 0.0;
                while at < duration {
                    let rate = self.process.derivative(&x, u).and_then(|d| d.get(land)).unwrap_or(0.0);
                    let here = x.get(land).unwrap_or(0.0);
                    let allowed = GROWTH * (here + SMALL_LAND) / rate.max(f64::MIN_POSITIVE);
                    let mut end = at + allowed.clamp(2.0, LONGEST_STEP);
                    if at < LEFT_OUT && end > LEFT_OUT && duration > LEFT_OUT {
                        end = LEFT_OUT;
                    }
                    // No slivers at the end.
                    if end > duration - 1.0 {
                        end = duration;
                    }
                    nodes[*row].push(end);
                    self.step(&self.process, &mut x, u, end - at, 1.0, &[]);
                    at = end;
                }
                wear[*row] = x.get(land).unwrap_or(0.0);
            }
        }
        self.nodes = nodes;
        wear
    }

    /// Midpoint step; the body follows its exponential. Returns the state halfway.
    fn step(&self, process: &P, x: &mut P::State, u: &P::Input, dt: f64, factor: f64, of_land: &[OfLand]) -> P::State {
        let land = P::State::index_of("flank_wear").unwrap_or(0);
        let rates = |x: &P::State| {
            let mut input = *u;
            let here = x.get(land).unwrap_or(0.0);
            let bent: f64 = of_land.iter().map(|(weight, function)| weight * function(here)).sum();
            input.set(self.ports.wear, factor * bent.exp());
            process.derivative(x, &input).unwrap_or(*x)
        };
        let lagged = P::LAGGED.and_then(P::State::index_of);
        let damage = P::State::index_of("thermal_damage");
        let start = *x;
        // Damage of a hot edge comes and goes within seconds; its equation is linear.
        let first = rates(&start);
        let damaging = damage.filter(|i| first.get(*i).unwrap_or(0.0) != 0.0);
        let moved = |rate: &P::State, dt: f64| {
            let mut next = start;
            for i in 0..P::State::LEN {
                let slope = rate.get(i).unwrap_or(0.0);
                let stretch = if Some(i) == lagged {
                    process.lag() * -(-dt / process.lag()).exp_m1()
                } else if Some(i) == damaging {
                    let here = start.get(i).unwrap_or(0.0);
                    let mut healed = start;
                    healed.set(i, 0.0);
                    let fresh = rates(&healed).get(i).unwrap_or(0.0);
                    let decay = if here > 1e-6 { (fresh - slope) / here } else { fresh };
                    if decay > 0.0 { -(-decay * dt).exp_m1() / decay } else { dt }
                } else {
                    dt
                };
                let value = start.get(i).unwrap_or(0.0) + slope * stretch;
                // An edge whose model runs away has broken long before: numbers stay numbers.
                let value = if value.is_finite() { value } else { start.get(i).unwrap_or(0.0) };
                next.set(i, if i == land { value.min(GREATEST_LAND) } else { value });
            }
            next
        };
        let middle = moved(&first, 0.5 * dt);
        let end = moved(&rates(&middle), dt);
        *x = end;
        middle
    }

    fn allowance(&mut self, records: &Records, wear: &[f64]) {
        let find = |names: &[&str]| -> Vec<usize> {
            let channels = self.frame.measured.channels.iter().enumerate();
            channels.filter(|(_, channel)| names.contains(&channel.name)).map(|(i, _)| i).collect()
        };
        let mut surfaces = Vec::new();
        let mut add = |name: String,
                       channels: &[usize],
                       feature: Vec<f64>,
                       deviation: f64,
                       allowance: bool,
                       absolute: bool| {
            if !channels.is_empty() {
                surfaces.push(Surface { name, channels: channels.to_vec(), feature, deviation, allowance, absolute });
            }
        };
        let ones = || vec![1.0; records.len()];
        // Relative to the absolute temperature, of which the rise is about three quarters.
        let classes = [
            ("force", find(&["cutting_force", "spindle_power"]), 0.04, 0.02, 0.03),
            ("feed force", find(&["feed_force"]), 0.04, 0.02, 0.05),
            ("temperature", find(&["temperature"]), 0.015, 0.0075, 0.0075),
            ("thermo-EMF", find(&["thermo_emf"]), 0.02, 0.01, 0.01),
            ("form error", find(&["form_error"]), 0.04, 0.02, 0.03),
            ("roughness", find(&["roughness_ra"]), 0.15, 0.08, 0.1),
        ];
        let land: Vec<f64> = wear.iter().map(|wear| wear / LAND).collect();
        for (class, channels, linear, square, by_land) in &classes {
            for (name, feature, is_linear) in features::surface(records, P::CONDITIONS) {
                let deviation = if is_linear { *linear } else { *square };
                add(format!("{class}, {name}"), channels, feature, deviation, true, false);
            }
            add(format!("{class}, land"), channels, land.clone(), *by_land, true, false);
        }
        add("feed force level".to_owned(), &find(&["feed_force"]), ones(), 0.08, false, false);
        add("thermo-EMF level".to_owned(), &find(&["thermo_emf"]), ones(), 0.05, false, false);
        add("roughness level".to_owned(), &find(&["roughness_ra"]), ones(), P::ROUGHNESS, false, false);
        add("form error level".to_owned(), &find(&["form_error"]), ones(), 0.1, false, false);
        for (_, part, feature) in features::indicators(records, &["part_type"]) {
            add(format!("form error, fixture of {part}"), &find(&["form_error"]), feature, FIXTURE, false, false);
        }
        let cycle = find(&["cycle_time"]);
        add("handling time".to_owned(), &cycle, ones(), 120.0, false, true);
        add("programmed time".to_owned(), &cycle, self.durations.clone(), 0.05, true, true);
        for (_, machine, feature) in features::indicators(records, &["machine"]) {
            let Some(feature) = standardised(&feature).map(|_| feature) else { continue };
            for (i, channel) in self.frame.measured.channels.iter().enumerate() {
                if matches!(channel.transform, Transform::Log) || channel.name == "temperature" {
                    let name = format!("gain of {}, machine {machine}", channel.name);
                    add(name, &[i], feature.clone(), super::settings::MACHINE_GAIN, false, false);
                }
            }
        }
        self.frame.surfaces = surfaces;
    }

    /// The process of a point: constants and effects of all rows.
    fn process_at(&self, at: &Point) -> P {
        let mut process = self.process.clone();
        let mut effects: Vec<Effect> = Vec::new();
        for ((action, size), candidate) in self.actions.iter().zip(&at.effects).zip(&self.frame.candidates) {
            if *size == 0.0 {
                continue;
            }
            match action {
                Action::Effect(effect) => {
                    // Shapes of one effect are never on together; the first stands.
                    if effects.iter().all(|other| other.entry().id != candidate.id) {
                        effects.push(effect.with_size(*size));
                    }
                }
                Action::Lot(_) => {
                    if effects.iter().all(|other| other.entry().id != candidate.id) {
                        effects.extend(Effect::named("lot_hardness").map(|effect| effect.with_size(1.0)));
                    }
                }
                Action::Reading { .. } => {}
            }
        }
        if !effects.is_empty() {
            // What the file switched on stays on.
            let mut probe = process.clone();
            let own: Vec<&'static str> = probe.parameters_mut().into_iter().map(|(group, _)| group).collect();
            effects.retain(|effect| !own.contains(&effect.entry().id));
            if let Ok(effects) = Effects::new(effects) {
                process = process.with_effects(effects);
            }
        }
        for ((change, x), parameter) in self.changes.iter().zip(&at.parameters).zip(&self.frame.parameters) {
            let Change::Constant { group, name } = change else { continue };
            if *x == 0.0 {
                continue;
            }
            for (own, record) in process.parameters_mut() {
                if own == *group
                    && let Some(i) = record.fields().iter().position(|field| field.name == *name)
                    && let Some(value) = record.value(i)
                {
                    record.set_value(i, value * (parameter.deviation * x).exp());
                }
            }
        }
        process
    }

    /// Values of all channels of a group's rows.
    fn simulate_group(&self, process: &P, at: &Point, group: usize, raw: &mut [Vec<f64>]) {
        let of_land: Vec<OfLand> = self
            .changes
            .iter()
            .zip(&at.parameters)
            .zip(&self.frame.parameters)
            .filter_map(|((change, x), parameter)| match change {
                Change::WearOfLand(function) if *x != 0.0 => Some((parameter.deviation * x, *function)),
                _ => None,
            })
            .collect();
        let land = P::State::index_of("flank_wear").unwrap_or(0);
        let local = |kind: usize| at.locals[kind][group] * self.frame.locals[kind].deviation;
        let mut x = process.initial();
        let mut y = vec![0.0; P::Output::LEN];
        let lagged = P::LAGGED.and_then(P::State::index_of);
        for (place, row) in self.rows[group].iter().enumerate() {
            let mut u = self.inputs[*row];
            u.set(self.ports.force, local(1).exp());
            let mut lot = 0.0;
            for (action, size) in self.actions.iter().zip(&at.effects) {
                if let Action::Lot(rows) = action {
                    lot += size * rows[*row];
                }
            }
            if lot != 0.0 {
                u.set(self.ports.lot, lot);
            }
            if let Some(port) = self.ports.pass_time {
                u.set(port, self.durations[*row]);
            }
            let mut wear = local(0);
            for ((change, x), parameter) in self.changes.iter().zip(&at.parameters).zip(&self.frame.parameters) {
                wear += parameter.deviation
                    * x
                    * match change {
                        Change::Wear => 1.0,
                        Change::WearFeature(feature) => feature[*row],
                        _ => continue,
                    };
            }
            let factor = wear.exp();
            // Edges cool between operations.
            if let Some(body) = lagged {
                x.set(body, 0.0);
            }
            let (mut from, mut seen) = (0.0, 0.0);
            let mut sums = vec![0.0; self.outputs.len()];
            let short = self.durations[*row] <= LEFT_OUT;
            for end in &self.nodes[*row] {
                let middle = self.step(process, &mut x, &u, end - from, factor, &of_land);
                if from >= LEFT_OUT || short {
                    let weight = end - from;
                    output(process.output(&middle, &u), &mut y);
                    for (sum, source) in sums.iter_mut().zip(&self.outputs) {
                        if let Source::Output(i) = source {
                            *sum += weight * y[*i];
                        }
                    }
                    seen += weight;
                }
                from = *end;
            }
            for (((values, sum), source), sign) in raw.iter_mut().zip(&sums).zip(&self.outputs).zip(&self.signs) {
                values[place] = sign
                    * match source {
                        Source::Wear => x.get(land).unwrap_or(0.0),
                        Source::Output(_) => sum / seen,
                        Source::Duration => self.durations[*row],
                    };
            }
        }
    }
}

fn output<R: Record>(record: R, to: &mut [f64]) {
    record.write_to(to);
}

fn source<P: Nominal>(channel: &str) -> Source {
    match channel {
        "flank_wear" => Source::Wear,
        "cycle_time" => Source::Duration,
        name => Source::Output(P::Output::index_of(name).unwrap_or(0)),
    }
}

/// Channels that the process predicts and the records hold.
fn channels<P: Nominal>(records: &Records, settings: &Settings) -> Vec<(Channel, Vec<f64>)> {
    let columns = records.kind.columns().iter();
    let known = columns.filter(|column| {
        P::Output::index_of(column.name).is_some() || column.name == "cycle_time" || column.name == "flank_wear"
    });
    let measured = known.filter(|column| column.kind == crate::records::ColumnKind::Channel);
    let with_values = measured.filter_map(|column| {
        let values = records.numbers(column.name)?;
        values.iter().any(|value| value.is_finite()).then(|| (column, values.to_vec()))
    });
    with_values
        .map(|(column, values)| {
            let linear = matches!(column.name, "flank_wear" | "temperature" | "cycle_time" | "form_error");
            let signed = P::SIGNED.contains(&column.name);
            let transform = if linear || signed { Transform::Linear } else { Transform::Log };
            let mut sensor: Sensor = settings.sensor(column.name);
            if signed {
                // Relative errors vanish where the sign turns; those of the sensor do not.
                let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).filter(|v| v.is_finite()).collect();
                sensor.absolute += sensor.relative * super::noise::median(&mut sizes);
            }
            (Channel { name: column.name, display: column.display, unit: column.unit, transform, sensor }, values)
        })
        .collect()
}

/// A condition of which servo lag needs to know.
const CURVATURE: &str = "path_curvature";
/// Curvature where it is not recorded, 1/m (assumption).
const USUAL_CURVATURE: f64 = 40.0;

fn recorded(records: &Records, name: &str) -> bool {
    records.numbers(name).is_some_and(|values| values.iter().any(|value| value.is_finite()))
}

/// Input of every row; what is not recorded is nominal.
fn inputs<P: Nominal>(records: &Records) -> Vec<P::Input> {
    let elapsed = features::elapsed(records);
    let curved = recorded(records, CURVATURE);
    let columns: Vec<(usize, Vec<f64>)> = P::Input::FIELDS
        .iter()
        .filter_map(|field| {
            let values = match field.name {
                "sensor_time" => elapsed.clone()?,
                name => records.numbers(name)?.to_vec(),
            };
            Some((P::Input::index_of(field.name)?, values))
        })
        .collect();
    (0..records.len())
        .map(|row| {
            let mut input = P::Input::default();
            if let (Some(index), false) = (P::Input::index_of(CURVATURE), curved) {
                input.set(index, USUAL_CURVATURE);
            }
            for (index, values) in &columns {
                if values[row].is_finite() {
                    input.set(*index, values[row]);
                }
            }
            input
        })
        .collect()
}

impl<P: Nominal> Forward for Cutting<P> {
    fn frame(&self) -> &Frame {
        &self.frame
    }
    fn simulate(&self, at: &Point) -> Vec<f64> {
        let process = self.process_at(at);
        let channels = self.frame.measured.channels.len();
        let of_group = |group: usize| {
            let mut raw = vec![vec![0.0; self.rows[group].len()]; channels];
            self.simulate_group(&process, at, group, &mut raw);
            let place: std::collections::BTreeMap<usize, usize> =
                self.rows[group].iter().enumerate().map(|(place, row)| (*row, place)).collect();
            let span = &self.frame.measured.observations[self.frame.measured.spans[group].clone()];
            span.iter().map(|observation| raw[observation.channel][place[&observation.row]]).collect::<Vec<f64>>()
        };
        let parts: Vec<Vec<f64>> = (0..self.rows.len()).into_par_iter().map(of_group).collect();
        let mut raw = parts.concat();
        for (action, size) in self.actions.iter().zip(&at.effects) {
            if let Action::Reading { channel, column } = action
                && *size != 0.0
            {
                for (raw, observation) in raw.iter_mut().zip(&self.frame.measured.observations) {
                    if observation.channel == *channel {
                        *raw += size * column[observation.row];
                    }
                }
            }
        }
        raw
    }
}
