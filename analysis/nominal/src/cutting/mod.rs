//! Turning and milling as nominal models of recorded operations.

mod chains;
mod channels;
mod heat;
mod nominal;
mod run;
mod scattered;
mod slopes;
mod split;
mod words;

pub use nominal::Nominal;

use super::cutting_effects::{self, Action};
use super::features::{self, standardised};
use super::settings::Settings;
use super::stated::Declarations;
use super::stopped::stop_times;
use super::{
    Channel, ChannelId, Discrepancy, Discrepant, Forward, Frame, Local, Measured, On, Parameter, Point, Role, Surface,
    broken,
};
use channels::{Source, channels, source, stop_channel};
use run::Step;
use scattered::Scattered;
use toolroom_process::Record;
use toolroom_records::Records;
use toolroom_scenario::CalibrationShift;

/// What a parameter of the fit does to the simulation.
enum Change {
    /// Multiplies a constant of the process.
    Constant { group: &'static str, name: &'static str },
    /// Multiplies the wear rate of all rows.
    Wear,
    /// Multiplies the wear rate by a feature of the row.
    WearFeature(Vec<f64>),
    /// Multiplies the wear rate by a function of the land, weighted by a feature of the row if it has one.
    WearOfLand(Option<Vec<f64>>, LandForm),
    /// Moves the land of a new edge.
    Start,
}

/// Forms that the rate of wear may have along the land.
#[derive(Clone, Copy)]
enum LandForm {
    /// In proportion to the land.
    Level,
    /// The same around half the land that features of wear refer to.
    Bent,
    /// While an edge runs in.
    Narrow,
}

/// Inputs by index.
struct Ports {
    force: usize,
    lot: usize,
    pass_time: Option<usize>,
    hardness: usize,
    mechanical: Option<usize>,
    thermal: Option<usize>,
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
    /// Place of each row in its group.
    places: Vec<usize>,
    /// Steps of each row.
    steps: Vec<Vec<Step>>,
    /// Land of a new edge beside that of the process, m.
    start: f64,
    /// Output of each channel; wear and cycle time have none.
    outputs: Vec<Source>,
    /// Channels that are means over the cut, each with its output.
    means: Vec<(usize, usize)>,
    /// Whether all of them are among [`Nominal::READINGS`].
    readings: bool,
    /// Sign in which a channel is recorded, against that of the model.
    signs: Vec<f64>,
    changes: Vec<Change>,
    actions: Vec<Action>,
    /// Constants that the file moves and no parameter of the fit does.
    fixed: Vec<Fixed>,
    /// Which of those with rows of their own act in each row: index into `masks`.
    variant_of_row: Vec<usize>,
    /// Sets of entries with rows of their own that occur, a bit each: actions first, then constants.
    masks: Vec<u128>,
    /// Nominal handling time of each row, s.
    handling: Vec<f64>,
    /// Share of its heat that the body of the tool keeps until each row begins.
    warm: Vec<f64>,
    ports: Ports,
    /// How the scenario scatters; `None` where it says nothing of it.
    scattered: Option<Scattered>,
}

/// A constant of the process that the file moves.
struct Fixed {
    group: String,
    field: String,
    moved: CalibrationShift,
    /// Rows on which it is moved, 1 or 0 each; all, if none.
    rows: Option<Vec<f64>>,
}

/// The same process without the hazard of chipping: it costs a power in every rate, and no reading tells of it.
fn unbroken<P: Nominal>(mut process: P) -> P {
    for (_, record) in process.parameters_mut().into_iter().filter(|(group, _)| *group == "chipping") {
        if let Some(rate) = record.fields().iter().position(|field| field.name == "rate") {
            record.set_value(rate, 0.0);
        }
    }
    process
}

/// Prior standard deviation of the form error of one part type: fixtures give way (assumption).
const FIXTURE: f64 = 0.05;
/// Prior standard deviation of an edge force: a linear law differs from a power law most at the
/// thinnest chips (assumption).
const EDGE_FORCE: f64 = 0.3;
/// Prior standard deviation of the handling time over what the file states of it (1). Assumption: files state loading by a few
/// times taken by hand, or by rule of thumb.
const HANDLING: f64 = 0.3;
/// Prior standard deviation of a handling time of which no file states anything, s. Assumption: minutes.
const UNSTATED_HANDLING: f64 = 120.0;
/// Scale of the prior of the amplitude of a discrepancy over the prior standard deviation of a linear form error of the
/// same channels (assumption).
const DISCREPANT: f64 = 1.0;
/// Scale of the prior of the amplitude of a discrepancy of the wear rate (assumption).
const WEAR_DISCREPANT: f64 = 0.15;
/// Land to which features of wear refer, m.
const LAND: f64 = 0.3e-3;
/// Land within which an edge runs in, m (assumption).
const NARROW: f64 = 0.05e-3;

impl<P: Nominal> Cutting<P> {
    /// The model over `records`, whose groups and their part in the fit are given.
    pub fn new(
        process: P,
        records: &Records,
        groups: (Vec<String>, Vec<usize>, Vec<bool>),
        settings: &Settings,
        stated: &Declarations,
    ) -> Self {
        let mut stated = stated.clone();
        let process = unbroken(process);
        let (names, group_of_row, fitted) = groups;
        let mut rows = vec![Vec::new(); names.len()];
        let mut places = Vec::with_capacity(group_of_row.len());
        for (row, group) in group_of_row.iter().enumerate() {
            places.push(rows[*group].len());
            rows[*group].push(row);
        }
        let durations: Vec<f64> = records.numbers("cutting_time").map_or_else(Vec::new, <[f64]>::to_vec);
        let inputs = inputs::<P>(records);
        let index = |name: &str| P::Input::index_of(name).unwrap_or(usize::MAX);
        let ports = Ports {
            force: index("force_factor"),
            lot: index("lot_deviation"),
            pass_time: P::Input::index_of("pass_time"),
            hardness: index("hardness_ratio"),
            mechanical: P::Input::index_of("mechanical_wear_factor"),
            thermal: P::Input::index_of("thermal_wear_factor"),
        };
        let scattered = settings.scatter.map(|scatter| Scattered::new(scatter, records, &settings.lots, &ports));
        let mut channels = channels::<P>(records, settings);
        let stops = stop_times(records, &group_of_row, &durations);
        channels.extend(stops.as_ref().map(stop_channel));
        let broken = broken::take_out(&mut channels, &group_of_row);
        let mut measured = Measured::new(channels, names, group_of_row, fitted);
        measured.unstated = measured.channels.iter().map(|own| settings.leaves_unstated(own.id)).collect();
        // Long cycles are what is asked for then, no outliers.
        let is_stopped = |own: &Channel| matches!(own.id, ChannelId::CycleTime | ChannelId::StopTime);
        measured.rare = measured.channels.iter().map(|own| stops.is_some() && is_stopped(own)).collect();
        if settings.scatter.is_none() {
            broken::widen(&mut measured);
        }
        let measured_channels = measured.channels.len();
        let outputs: Vec<Source> = measured.channels.iter().map(|channel| source::<P>(channel.id)).collect();
        let mean = |(channel, source): (usize, &Source)| match source {
            Source::Output(output) => Some((channel, *output)),
            Source::Wear | Source::Duration | Source::Stops => None,
        };
        let known = |id: ChannelId| P::READINGS.contains(&id.word()) || !matches!(source::<P>(id), Source::Output(_));
        let readings = measured.channels.iter().all(|channel| known(channel.id));
        let mut locals = vec![
            Local { name: "wear of the edge", deviation: settings.edge_wear, estimated: true, scatter: true },
            Local { name: "force of the edge", deviation: settings.edge_force, estimated: false, scatter: true },
        ];
        if let Some(scattered) = &scattered {
            scattered.set_locals(&mut locals);
        }
        let mut model = Self {
            process,
            frame: Frame { locals, ..Frame::new(measured) },
            inputs,
            durations,
            rows,
            places,
            steps: Vec::new(),
            start: 0.0,
            signs: vec![1.0; measured_channels],
            means: outputs.iter().enumerate().filter_map(mean).collect(),
            outputs,
            readings,
            changes: Vec::new(),
            actions: Vec::new(),
            fixed: Vec::new(),
            variant_of_row: vec![0; records.len()],
            masks: vec![0],
            handling: stated.handling_of(records),
            warm: Vec::new(),
            ports,
            scattered,
        };
        model.warm = model.kept_heat(records);
        model.calibration(records, settings);
        let wear = model.schedule();
        model.allowance(records, &wear);
        let groups = &model.frame.measured.group_of_row;
        model.frame.covariates = features::covariates(records, groups, P::CONDITIONS, Some(&wear));
        model.frame.defined.clone_from(&stated.defined);
        let context = cutting_effects::Seen {
            defined: &stated.defined,
            records,
            groups,
            durations: &model.durations,
            channels: &model.frame.measured.channels,
        };
        let (candidates, untried) = cutting_effects::candidates(P::NAME, &context);
        model.frame.untried = untried;
        (model.frame.candidates, model.actions) = candidates.into_iter().unzip();
        model.split(records, &stated);
        model.state(records, &mut stated);
        model.frame.shape_leads = stops.map_or_else(Vec::new, |stops| model.shape_leads(&stops));
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
            .filter(|channel| P::SIGNED.contains(&self.frame.measured.channels[*channel].id))
            .collect();
        if signed.is_empty() {
            return;
        }
        let raw = self.simulate(&Point::nominal(self));
        for channel in signed {
            let observations = self.frame.measured.observations.iter().zip(&raw);
            let of_channel = observations.filter(|(observation, _)| observation.channel == channel);
            if of_channel.map(|(observation, raw)| observation.value * raw).sum::<f64>() < 0.0 {
                self.signs[channel] = -1.0;
                let name = self.frame.measured.channels[channel].id;
                self.frame.notes.push(format!("{name} has the opposite sign to the model's: compared so"));
            }
        }
    }

    fn parameter(&mut self, name: impl Into<String>, deviation: f64, role: Role, change: Change) {
        self.frame.parameters.push(Parameter { name: name.into(), deviation, role });
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
                let name_in_file = format!("{group}.{name}");
                let deviation = settings.spread(&name_in_file, deviation);
                self.parameter(name_in_file, deviation, Role::Constant, Change::Constant { group, name });
            }
        }
        self.parameter("wear rate level", settings.spread_of_wear(), Role::Constant, Change::Wear);
        if let Some(land) = self.scattered.as_ref().map(|own| own.land).filter(|land| *land > 0.0) {
            self.start = land;
            self.parameter("land of a new edge", scattered::NEW_LAND, Role::Constant, Change::Start);
        }
        for (name, feature, linear) in features::surface(records, P::CONDITIONS) {
            let deviation = if linear { settings.form_wear } else { 0.5 * settings.form_wear };
            self.parameter(format!("wear rate, {name}"), deviation, Role::Allowance, Change::WearFeature(feature));
        }
        let of_land = P::WEAR_CURVE * settings.form_land_wear;
        self.parameter("wear rate, land", of_land, Role::Allowance, Change::WearOfLand(None, LandForm::Level));
        self.parameter("wear rate, narrow land", of_land, Role::Allowance, Change::WearOfLand(None, LandForm::Narrow));
        // Terms that share the wear rate share it otherwise at another speed.
        let of_both = P::WEAR_CURVE * settings.form_land_conditions_wear;
        for (name, feature, _) in features::surface(records, P::CONDITIONS).into_iter().filter(|(.., linear)| *linear) {
            for (shape, form) in [("land", LandForm::Bent), ("narrow land", LandForm::Narrow)] {
                let change = Change::WearOfLand(Some(feature.clone()), form);
                self.parameter(format!("wear rate, {name} × {shape}"), of_both, Role::Allowance, change);
            }
        }
    }

    /// Force in the plane of feed at the wear `wear` of each row, N. A component that turns its sign is the
    /// small difference of great ones: what its form may be off by goes with them, not with what is left.
    fn in_plane(&self, wear: &[f64]) -> Vec<f64> {
        let places = ["feed_force", "normal_force"].map(P::Output::index_of);
        let land = P::State::index_of("flank_wear").unwrap_or(0);
        let force = |(input, wear): (&P::Input, &f64)| {
            let mut state = self.process.initial();
            state.set(land, *wear);
            let output = P::observe(&self.process.held(input), &state);
            let part = |place: Option<usize>| place.and_then(|place| output.get(place)).unwrap_or(0.0);
            part(places[0]).hypot(part(places[1]))
        };
        self.inputs.iter().zip(wear).map(force).collect()
    }

    fn allowance(&mut self, records: &Records, wear: &[f64]) {
        let find = |wanted: &[ChannelId]| -> Vec<usize> {
            let channels = self.frame.measured.channels.iter().enumerate();
            channels.filter(|(_, channel)| wanted.contains(&channel.id)).map(|(i, _)| i).collect()
        };
        let mut surfaces = Vec::new();
        let mut add =
            |name: String, channels: &[usize], feature: Vec<f64>, deviation: f64, role: Role, absolute: bool| {
                if !channels.is_empty() {
                    surfaces.push(Surface { name, channels: channels.to_vec(), feature, deviation, role, absolute });
                }
            };
        let ones = || vec![1.0; records.len()];
        // Relative to the absolute temperature, of which the rise is about three quarters.
        let classes = [
            (
                "force",
                find(&[ChannelId::CuttingForce, ChannelId::SpindlePower]),
                0.04 * P::FORCE_FORM,
                0.02 * P::FORCE_FORM,
                0.03,
            ),
            ("feed force", find(&[ChannelId::FeedForce]), 0.04 * P::FORCE_FORM, 0.02 * P::FORCE_FORM, 0.05),
            ("temperature", find(&[ChannelId::Temperature]), 0.015, 0.0075, 0.0075),
            ("thermo-EMF", find(&[ChannelId::ThermoEmf]), 0.02, 0.01, 0.01),
            ("form error", find(&[ChannelId::FormError]), 0.04 * P::FORCE_FORM, 0.02 * P::FORCE_FORM, 0.03),
            ("roughness", find(&[ChannelId::RoughnessRa]), 0.15, 0.08, 0.1),
        ];
        let land: Vec<f64> = wear.iter().map(|wear| wear / LAND).collect();
        let signed = find(P::SIGNED);
        let in_plane = if signed.is_empty() { Vec::new() } else { self.in_plane(wear) };
        let mut discrepant: Vec<Discrepant> = Vec::new();
        for (class, channels, linear, square, by_land) in &classes {
            let of_force = !channels.is_empty() && channels.iter().all(|channel| signed.contains(channel));
            let on = if of_force { On::Quantity(in_plane.clone()) } else { On::Value };
            if !channels.is_empty() {
                discrepant.push(Discrepant { name: class, channels: channels.clone(), scale: DISCREPANT * linear, on });
            }
            let mut allow = |name: &str, mut feature: Vec<f64>, deviation: f64| {
                if of_force {
                    feature.iter_mut().zip(&in_plane).for_each(|(feature, force)| *feature *= force);
                }
                add(format!("{class}, {name}"), channels, feature, deviation, Role::Allowance, of_force);
            };
            for (name, feature, is_linear) in features::surface(records, P::CONDITIONS) {
                allow(&name, feature, if is_linear { *linear } else { *square });
            }
            allow("land", land.clone(), *by_land);
        }
        add("feed force level".to_owned(), &find(&[ChannelId::FeedForce]), ones(), 0.08, Role::Constant, false);
        add("thermo-EMF level".to_owned(), &find(&[ChannelId::ThermoEmf]), ones(), 0.05, Role::Constant, false);
        add(
            "roughness level".to_owned(),
            &find(&[ChannelId::RoughnessRa]),
            ones(),
            P::ROUGHNESS,
            Role::Constant,
            false,
        );
        add("form error level".to_owned(), &find(&[ChannelId::FormError]), ones(), 0.1, Role::Constant, false);
        for (_, part, feature) in features::indicators(records, &["part_type"]) {
            add(
                format!("form error, fixture of {part}"),
                &find(&[ChannelId::FormError]),
                feature,
                FIXTURE,
                Role::Fixture(part),
                false,
            );
        }
        let cycle = find(&[ChannelId::CycleTime]);
        let stated = self.handling.iter().sum::<f64>() / self.handling.len().max(1) as f64;
        let spread = if stated > 0.0 { HANDLING * stated } else { UNSTATED_HANDLING };
        add("handling time".to_owned(), &cycle, ones(), spread, Role::HandlingTime, true);
        add("programmed time".to_owned(), &cycle, self.durations.clone(), 0.05, Role::Allowance, true);
        for (_, machine, feature) in features::indicators(records, &["machine"]) {
            let Some(feature) = standardised(&feature).map(|_| feature) else { continue };
            for (i, channel) in self.frame.measured.channels.iter().enumerate() {
                // A caliper is no part of the machine, its clock does not gain.
                if !matches!(channel.id, ChannelId::FlankWear | ChannelId::CycleTime | ChannelId::StopTime) {
                    let name = format!("gain of {}, machine {machine}", channel.id);
                    let role = Role::MachineGain(machine.clone());
                    add(name, &[i], feature.clone(), super::settings::MACHINE_GAIN, role, false);
                }
            }
        }
        self.frame.surfaces = surfaces;
        let readings = self.frame.measured.channels.iter().position(|channel| channel.id == ChannelId::FlankWear);
        discrepant.extend(readings.map(|channel| Discrepant {
            name: "wear rate",
            channels: vec![channel],
            scale: WEAR_DISCREPANT,
            on: On::Growth(self.growth(wear)),
        }));
        self.frame.discrepancy = self.discrepancy(records, wear, discrepant);
    }

    /// What every row adds to the land in the nominal model, m.
    fn growth(&self, wear: &[f64]) -> Vec<f64> {
        let mut growth = wear.to_vec();
        for rows in &self.rows {
            for pair in rows.windows(2) {
                growth[pair[1]] = wear[pair[1]] - wear[pair[0]];
            }
        }
        growth
    }

    /// A discrepancy over the logarithms of the conditions, the land and the logarithm of the age of the edge.
    fn discrepancy(&self, records: &Records, wear: &[f64], classes: Vec<Discrepant>) -> Option<Discrepancy> {
        let ages = features::age(&self.frame.measured.group_of_row, &self.durations);
        let logarithms: Vec<f64> = ages.iter().map(|age| age.max(1.0).ln()).collect();
        let conditions = P::CONDITIONS.iter().filter_map(|name| features::logarithm(records, name));
        let columns: Vec<Vec<f64>> = conditions.chain(standardised(wear)).chain(standardised(&logarithms)).collect();
        let points = (0..records.len()).map(|row| columns.iter().map(|column| column[row]).collect()).collect();
        (!columns.is_empty()).then_some(Discrepancy { points, classes })
    }
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
