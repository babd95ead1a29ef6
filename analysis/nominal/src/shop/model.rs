//! The nominal shop over blocks of recorded operations.

use super::super::features::standardised;
use super::super::{
    Channel, Covariate, Declarations, Direction, EffectRefusal, Family, Forward, Frame, Local, Measured, Observation,
    Point, Role, Settings, Surface, WrittenEffect,
};
use super::action::Action;
use super::block::{Block, Blocks};
use super::constant::{Constant, Label};
use super::expected::{breakdown_scores, expected, life_slope};
use super::figure::{Figure, Figures};
use super::logs::groups;
use super::nominal::Shop;
use super::shapes::{Shapes, Stopped};
use super::stops::Shape;
use super::visit::{Visits, visits};
use rayon::prelude::*;
use toolroom_innovations::Chain;
use toolroom_records::{Records, Sensor};
use toolroom_scenario::Scope;
use toolroom_statistics::median;

/// Prior standard deviations of logarithms (assumptions): programmed times as planners know them, gains of
/// machines, handling times, change times, scatter of single operations.
const PROGRAM: f64 = 0.05;
const MACHINE: f64 = 0.03;
const HANDLING: f64 = 0.10;
const CHANGE: f64 = 0.05;
const SCATTER: f64 = 0.5;
/// Form allowance: what shifts differ by without anybody doing anything else (assumption).
const SHIFT_CUTTING: f64 = 0.003;
const SHIFT_HANDLING: f64 = 0.01;
/// And by how much their handling scatters: a constant delay makes the relative scatter smaller, one that
/// varies makes it larger (assumption).
const SHIFT_SCATTER: f64 = 0.2;
/// Level of a program that the nominal shop does not know.
const UNKNOWN: f64 = 1.0;
/// Skewness that single operations may have by themselves: excess of the mean, in scatters, and of
/// the tails, relative.
const SKEW: f64 = 0.1;
const TAILS: f64 = 0.4;
/// Scale of the scatter of levels from day to day.
const DAILY: f64 = 0.01;

/// The nominal shop over [`Records`] of events.
pub struct ShopModel {
    pub(super) frame: Frame,
    pub(super) blocks: Blocks,
    /// Nominal value of each block by channel.
    pub(super) nominal: Vec<Figures>,
    /// Growth of the life of edges with the wear limit, 1/m, by block.
    life_slope: Vec<f64>,
    pub(super) actions: Vec<Action>,
    /// Operations on which each of them acts.
    pub(super) scopes: Vec<Scope>,
    /// What stops that nobody books do to blocks.
    pub(super) stopped: Stopped,
    /// Figure of the blocks by channel of the frame.
    figures: Vec<Figure>,
}

impl ShopModel {
    /// The model over recorded events; blocks are grouped by machine and day, or by the column
    /// `group` of them (`machine`, `day`, `shift`). Notes say what was found while reading.
    pub fn new(
        shop: &Shop,
        records: &Records,
        group: Option<&str>,
        held: &dyn Fn(usize, &str) -> bool,
        settings: &Settings,
        stated: &Declarations,
    ) -> (Self, Vec<String>) {
        let seen = visits(records);
        let mut notes = seen.notes.clone();
        let mut blocks = Blocks::of(shop, &seen);
        if let Some(note) = unit_slip(shop, &seen) {
            notes.push(note);
            blocks.list.clear();
        }
        let strangers: Vec<&str> = seen
            .programs
            .iter()
            .zip(&blocks.known)
            .filter(|(_, known)| !**known)
            .map(|(name, _)| name.as_str())
            .collect();
        if !strangers.is_empty() {
            notes.push(format!("not in the nominal model, compared with their own median: {}", strangers.join(", ")));
        }
        let (names, of_row) = groups(&blocks, &seen, group);
        let fitted = names.iter().enumerate().map(|(index, name)| !held(index, name)).collect();
        let mut model = Self {
            frame: Frame::new(Measured::new(Vec::new(), Vec::new(), Vec::new(), Vec::new())),
            nominal: expected(shop, &seen, &blocks),
            life_slope: blocks.list.iter().map(|block| life_slope(shop, &seen, block)).collect(),
            blocks,
            actions: Vec::new(),
            scopes: Vec::new(),
            stopped: Stopped::default(),
            figures: Vec::new(),
        };
        model.measure((names, of_row, fitted), settings);
        model.calibration(shop, &seen);
        model.catalogue(shop, &seen);
        model.covariates(&seen);
        model.state(&seen, &mut stated.clone());
        notes.extend(std::mem::take(&mut model.frame.notes));
        (model, notes)
    }

    fn measure(&mut self, groups: (Vec<String>, Vec<usize>, Vec<bool>), settings: &Settings) {
        let blocks = &self.blocks.list;
        let mut channels = Vec::new();
        for figure in Figure::ALL {
            let usable = |row: usize| blocks[row].values[figure].is_finite() && self.nominal[row][figure].is_finite();
            let values: Vec<f64> =
                (0..blocks.len()).map(|row| if usable(row) { blocks[row].values[figure] } else { f64::NAN }).collect();
            if values.iter().all(|value| value.is_nan()) {
                continue;
            }
            self.figures.push(figure);
            let (id, unit, transform) = (figure.channel(), figure.unit(), figure.transform());
            let sensor = settings.sensors.iter().find(|(name, _)| name == id.word()).map(|(_, sensor)| *sensor);
            let sensor = sensor.unwrap_or(Sensor { absolute: 0.0, relative: 0.0, resolution: 0.0 });
            channels.push((Channel { id, display: unit, unit, transform, sensor }, values));
        }
        let mut measured = Measured::new(channels, groups.0, groups.1, groups.2);
        measured.rare = self.figures.iter().map(|figure| figure.is_rare()).collect();
        for observation in &mut measured.observations {
            let scatter = blocks[observation.row].deviations[self.figures[observation.channel]];
            observation.deviation = observation.deviation.hypot(scatter);
        }
        measured.exact = measured.observations.iter().map(|own| self.is_exact(own)).collect();
        let count = |own: &Observation| blocks[own.row].counts[self.figures[own.channel]];
        self.frame.stands_for = measured.observations.iter().map(count).collect();
        self.frame.measured = measured;
    }

    /// Whether a value is of times in cut that do not scatter.
    fn is_exact(&self, observation: &Observation) -> bool {
        match self.figures[observation.channel] {
            Figure::CuttingTime | Figure::CuttingTail | Figure::CuttingExcess | Figure::CuttingSpread => {
                self.blocks.list[observation.row].program.is_some_and(|program| self.blocks.exact[program])
            }
            Figure::HandlingTime
            | Figure::HandlingSpread
            | Figure::ToolChangeTime
            | Figure::FeedHoldTime
            | Figure::StopCount
            | Figure::EdgeLife
            | Figure::FailureInterval => false,
        }
    }

    /// The channel of a figure, where it was measured.
    pub(super) fn place(&self, figure: Figure) -> Vec<usize> {
        self.figures.iter().position(|own| *own == figure).into_iter().collect()
    }

    fn shifts(&self) -> Vec<String> {
        let mut shifts: Vec<String> = self.blocks.list.iter().map(|block| block.shift.clone()).collect();
        shifts.sort();
        shifts.dedup();
        shifts.retain(|shift| !shift.is_empty());
        shifts
    }

    fn calibration(&mut self, shop: &Shop, visits: &Visits) {
        let rows = self.blocks.list.len();
        let blocks = &self.blocks.list;
        let (mut surfaces, mut movable) = (Vec::new(), Vec::new());
        let mut add = |label: Label<'_>, channels: Vec<usize>, feature: Vec<f64>, deviation: f64, absolute: bool| {
            if !channels.is_empty() && feature.iter().any(|value| *value != 0.0) {
                let name = label.to_string();
                movable.extend(label.movable(shop).map(|movable| (name.clone(), movable)));
                surfaces.push(Surface { name, channels, feature, deviation, role: Role::Constant, absolute });
            }
        };
        let on = |test: &dyn Fn(&Block) -> bool| -> Vec<f64> {
            blocks.iter().map(|block| f64::from(u8::from(test(block)))).collect()
        };
        let ones = || vec![1.0; rows];
        let (time, handling, change) =
            (self.place(Figure::CuttingTime), self.place(Figure::HandlingTime), self.place(Figure::ToolChangeTime));
        add(Constant::ProgrammedTimes.into(), time.clone(), ones(), PROGRAM, false);
        add(Constant::Handling.into(), handling.clone(), ones(), HANDLING, false);
        add(Constant::Change.into(), change.clone(), ones(), CHANGE, false);
        let scatter = |block: &Block| block.program.map_or(0.0, |program| self.blocks.scatter[program]);
        let scatters: Vec<f64> = blocks.iter().map(scatter).collect();
        for (program, name) in visits.programs.iter().enumerate() {
            let of_program = on(&|block| block.program == Some(program));
            let level = if self.blocks.known[program] { PROGRAM } else { UNKNOWN };
            add(Constant::ProgrammedTime(name).into(), time.clone(), of_program.clone(), level, false);
            add(Constant::HandlingOfProgram(name).into(), handling.clone(), of_program.clone(), 0.5 * HANDLING, false);
            add(
                format!("scatter of {name}").into(),
                self.place(Figure::CuttingSpread),
                of_program.clone(),
                SCATTER,
                false,
            );
            // What adds to every handling makes its relative scatter smaller.
            add(
                format!("scatter of handling for {name}").into(),
                self.place(Figure::HandlingSpread),
                of_program.clone(),
                0.5 * SCATTER,
                false,
            );
            let skew: Vec<f64> = of_program.iter().map(|share| share * self.blocks.scatter[program]).collect();
            add(format!("skewness of {name}").into(), self.place(Figure::CuttingExcess), skew, SKEW, true);
            add(format!("tails of {name}").into(), self.place(Figure::CuttingTail), of_program, TAILS, false);
        }
        add("scatter of handling".to_owned().into(), self.place(Figure::HandlingSpread), ones(), SCATTER, false);
        add("tails of all".to_owned().into(), self.place(Figure::CuttingTail), ones(), 2.0 * TAILS, false);
        add("skewness of all".to_owned().into(), self.place(Figure::CuttingExcess), scatters, 2.0 * SKEW, true);
        add(Constant::Lives.into(), self.place(Figure::EdgeLife), ones(), 0.15, false);
        add("rate of booked stops".to_owned().into(), self.place(Figure::StopCount), ones(), SCATTER, false);
        add("scores of breakdowns".to_owned().into(), self.place(Figure::FailureInterval), ones(), 0.02, false);
        for (machine, name) in visits.machines.iter().enumerate() {
            let of_machine = on(&|block| block.machine == machine);
            add(Constant::MachineGain(name).into(), time.clone(), of_machine.clone(), MACHINE, false);
            let stranger = shop.station(name).is_none();
            let level = |known: f64| if stranger { UNKNOWN } else { known };
            add(
                Constant::HandlingAtMachine(name).into(),
                handling.clone(),
                of_machine.clone(),
                level(0.5 * HANDLING),
                false,
            );
            add(Constant::ChangeAtMachine(name).into(), change.clone(), of_machine.clone(), level(CHANGE), false);
            add(
                format!("scatter of handling at {name}").into(),
                self.place(Figure::HandlingSpread),
                of_machine.clone(),
                0.5 * SCATTER,
                false,
            );
            add(
                format!("scatter at {name}").into(),
                self.place(Figure::CuttingSpread),
                of_machine.clone(),
                0.5 * SCATTER,
                false,
            );
            add(Constant::LivesAtMachine(name).into(), self.place(Figure::EdgeLife), of_machine, 0.1, false);
        }
        let spread = self.place(Figure::HandlingSpread);
        for shift in self.shifts() {
            for (name, channels, deviation) in [
                ("cutting time", &time, SHIFT_CUTTING),
                ("handling time", &handling, SHIFT_HANDLING),
                ("scatter of handling", &spread, SHIFT_SCATTER),
            ] {
                let (feature, channels) = (on(&|block| block.shift == shift), channels.clone());
                let name = format!("{name}, shift {shift}");
                surfaces.push(Surface { name, channels, feature, deviation, role: Role::Allowance, absolute: false });
            }
        }
        surfaces.retain(|surface| !surface.channels.is_empty());
        // By the last group that they move, those of all machines are at the end: most of a factor of their normal equations is
        // zero then.
        let groups = &self.frame.measured.group_of_row;
        surfaces.sort_by_cached_key(|surface| {
            surface.feature.iter().zip(groups).filter(|(x, _)| **x != 0.0).map(|own| own.1).max()
        });
        self.frame.families = families(
            &surfaces,
            &[
                (Figure::CuttingTime, "times in cut"),
                (Figure::HandlingTime, "handling times"),
                (Figure::ToolChangeTime, "change times"),
            ]
            .map(|(figure, name)| (self.place(figure), name)),
        );
        self.frame.surfaces = surfaces;
        self.frame.words.movable = movable;
        self.frame.locals = vec![
            Local { name: "cutting time of the day", deviation: DAILY, estimated: true, scatter: false },
            Local { name: "handling time of the day", deviation: 3.0 * DAILY, estimated: true, scatter: false },
        ];
    }

    fn covariates(&mut self, visits: &Visits) {
        let blocks = &self.blocks.list;
        let mut covariates = Vec::new();
        let mut add = |name: String, values: Vec<f64>| {
            if let Some(values) = standardised(&values) {
                covariates.push(Covariate { name, values });
            }
        };
        let by_block = |value: &dyn Fn(&Block) -> f64| blocks.iter().map(value).collect::<Vec<f64>>();
        let turn = std::f64::consts::TAU / 86400.0;
        add("ln programmed time".to_owned(), by_block(&|b| b.program.map_or(f64::NAN, |p| self.blocks.times[p].ln())));
        add("calendar".to_owned(), by_block(&|block| block.time));
        if let Some(z) = standardised(&by_block(&|block| block.time)) {
            add("calendar²".to_owned(), z.iter().map(|z| z * z).collect());
        }
        add("time of day (sin)".to_owned(), by_block(&|block| (turn * block.time).sin()));
        add("time of day (cos)".to_owned(), by_block(&|block| (turn * block.time).cos()));
        add("feed_override".to_owned(), by_block(&Block::mean_excess));
        add("first operation of an edge".to_owned(), by_block(&|block| block.new_edges));
        // Levels stay zero where they are not: in most of the columns of a shop nearly everything is.
        let mut add_level = |name: String, test: &dyn Fn(&Block) -> bool| {
            let values = by_block(&|block| f64::from(u8::from(test(block))));
            if values.contains(&0.0) && values.contains(&1.0) {
                covariates.push(Covariate { name, values });
            }
        };
        for shift in self.shifts() {
            add_level(format!("shift={shift}"), &|block| block.shift == shift);
        }
        for (machine, name) in visits.machines.iter().enumerate() {
            add_level(format!("machine={name}"), &|block| block.machine == machine);
        }
        for (program, name) in visits.programs.iter().enumerate() {
            add_level(format!("program={name}"), &|block| block.program == Some(program));
        }
        self.frame.covariates = covariates;
    }
}

impl ShopModel {
    /// Raw values of every observation, given the shapes of [`ShopModel::shapes`] at the rates of `point`.
    fn simulated(&self, point: &Point, shapes: &Shapes) -> Vec<f64> {
        let rates = self.rates(point);
        let of_program = self.of_programs(&rates, shapes);
        let of = |wanted: &dyn Fn(&Action) -> bool| -> f64 {
            self.actions.iter().zip(&point.effects).filter(|(action, _)| wanted(action)).map(|(_, size)| *size).sum()
        };
        let booked = of(&|action| matches!(action, Action::Booked));
        let hold = of(&|action| matches!(action, Action::Hold(_)));
        let policy = of(&|action| matches!(action, Action::Policy));
        let regular = breakdown_scores(of(&|action| matches!(action, Action::Breakdowns)));
        let measured = &self.frame.measured;
        let value = |observation: &Observation| {
            let (row, figure) = (observation.row, self.figures[observation.channel]);
            let block = &self.blocks.list[row];
            let nominal = self.nominal[row][figure];
            let known = block.program.and_then(|program| of_program[program]?.get(&rates[row].to_bits()));
            let shape = known.and_then(|classes| classes.get(block.class)).copied().unwrap_or_default();
            let group = measured.group_of_row[row];
            let local = |kind: usize| (self.frame.locals[kind].deviation * point.locals[kind][group]).exp();
            // Two overrides that act together multiply, as they do in a run.
            let (mut slower, mut delay, mut change, mut blocks, mut overridden) = (1.0, 0.0, 0.0, 0.0, 0.0);
            for (action, size) in self.actions.iter().zip(&point.effects) {
                match action {
                    Action::Slower(weights) => slower *= 1.0 + size * weights[row],
                    Action::Overridden(_) => overridden += size,
                    Action::Delay(weights) => delay += size * weights[row],
                    Action::Change(weights) => change += size * weights[row],
                    Action::Acceleration(speeds) => blocks += size * speeds[row],
                    Action::Stops(_) | Action::Booked | Action::Hold(_) | Action::Policy | Action::Breakdowns => {} // acts on the channel that logs it
                }
            }
            // A middle goes where its times go, and with it the shape of those that are skewed by themselves.
            let longer = |nominal: f64| ((nominal * slower * block.slowed(overridden) + blocks) / nominal).ln();
            let scale = block.program.and_then(|program| self.blocks.scales[program].as_deref());
            let moved = || {
                scale.map_or(Shape::default(), |scale| scale.shifted(longer(self.nominal[row][Figure::CuttingTime])))
            };
            match figure {
                Figure::CuttingTime => {
                    let longer = longer(nominal);
                    nominal * (scale.map_or(longer, |own| own.scale.normal(longer)) + shape.location).exp() * local(0)
                }
                Figure::CuttingTail => nominal + shape.tail + moved().tail,
                Figure::CuttingExcess => nominal * (shape.excess + moved().excess).exp(),
                Figure::CuttingSpread => nominal * (shape.spread + moved().spread).exp(),
                Figure::HandlingTime => (nominal + delay) * local(1),
                Figure::HandlingSpread => nominal,
                Figure::ToolChangeTime => nominal + change,
                Figure::FeedHoldTime => nominal + hold,
                Figure::StopCount => nominal + booked * block.cutting,
                Figure::EdgeLife => nominal * (1.0 + self.life_slope[row] * policy),
                Figure::FailureInterval => regular,
            }
        };
        measured.observations.iter().map(value).collect()
    }
}

impl Forward for ShopModel {
    fn frame(&self) -> &Frame {
        &self.frame
    }

    fn simulate(&self, point: &Point) -> Vec<f64> {
        self.simulated(point, &self.shapes(&[point]))
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
        self.written_effect(candidate)
    }

    fn slopes(&self, at: &Point, raw: &[f64], along: &[Direction]) -> Vec<Vec<f64>> {
        // Over a twentieth of an ordinary rate a handful of replications would decide: one rate less and one more.
        let around = |index: usize| -> [Point; 2] {
            let (typical, size) = (self.frame.candidates[index].typical, at.effects[index]);
            [(size - typical).max(0.0), size + typical].map(|size| {
                let mut point = at.clone();
                point.effects[index] = size;
                point
            })
        };
        let stops = |direction: &Direction| match direction {
            Direction::Effect(index) if matches!(self.actions[*index], Action::Stops(_)) => Some(*index),
            Direction::Effect(_) | Direction::Parameter(_) | Direction::Local(_) => None,
        };
        let ends: Vec<Point> = along.iter().filter_map(stops).flat_map(around).collect();
        let shapes = self.shapes(&ends.iter().chain([at]).collect::<Vec<_>>());
        let difference = |(from, to): (&[f64], Vec<f64>), step: f64| -> Vec<f64> {
            to.iter().zip(from).map(|(to, from)| (to - from) / step).collect()
        };
        let slope = |direction: &Direction| match direction {
            Direction::Effect(index) if matches!(self.actions[*index], Action::Stops(_)) => {
                let [low, high] = around(*index);
                let [from, to] = [&low, &high].map(|point| self.simulated(point, &shapes));
                let reach = high.effects[*index] - low.effects[*index];
                difference((&from, to), reach / self.frame.candidates[*index].typical)
            }
            Direction::Parameter(_) | Direction::Effect(_) | Direction::Local(_) => {
                let (ahead, step) = direction.ahead(&self.frame, at);
                difference((raw, self.simulated(&ahead, &shapes)), step)
            }
        };
        along.par_iter().map(slope).collect()
    }
}

/// The constants of each kind of time, whose spread a shop with many of them shows.
fn families(surfaces: &[Surface], times: &[(Vec<usize>, &'static str)]) -> Vec<Family> {
    let family = |(channels, name): &(Vec<usize>, &'static str)| {
        let own = surfaces.iter().filter(|surface| !surface.role.is_allowance() && surface.deviation < UNKNOWN);
        let own = own.filter(|surface| surface.channels == *channels);
        Family { name, surfaces: own.map(|surface| surface.name.clone()).collect() }
    };
    times.iter().filter(|(channels, _)| !channels.is_empty()).map(family).collect()
}

/// Ratios of measured to nominal times that slips of units leave.
const SLIPS: [(f64, &str); 3] =
    [(60.0, "minutes given as seconds, or seconds as minutes"), (3600.0, "hours"), (1000.0, "milliseconds")];

/// What to say where all times are an impossible multiple of the nominal ones.
fn unit_slip(shop: &Shop, visits: &Visits) -> Option<String> {
    let ratio = |visit: &super::Visit| {
        let program = shop.programs.get(&visits.programs[visit.program])?;
        let pieces = visit.times(program.pieces);
        Some(visit.cutting / (pieces * program.pace_on(&visits.machines[visit.machine]) * program.time))
    };
    let mut ratios: Vec<f64> = visits.list.iter().filter_map(ratio).collect();
    let ratio = median(&mut ratios);
    if ratio.is_nan() || (0.3..3.3).contains(&ratio) {
        return None;
    }
    let near = |factor: f64| (ratio.ln().abs() - factor.ln()).abs() < 0.5;
    let slip =
        SLIPS.iter().find(|(factor, _)| near(*factor)).map_or_else(String::new, |(_, what)| format!(" ({what}?)"));
    Some(format!(
        "times in cut are {ratio:.3} times the programmed ones: nothing is compared, check the unit of `time`{slip}, \
         and `quantity` where jobs have several pieces"
    ))
}
