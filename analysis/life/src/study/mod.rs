//! Monte Carlo studies of tool life.
//!
//! ```text
//!  study file ─► Study ─► cells: condition × policy ─┐
//!                  │                                 ▼
//!     points: plain, antithetic, Latin, Sobol ─► edge: one life ─► tally: sums, sketch, digest
//!                                                    │                       │
//!                                          part-K.parquet               part-K.json ─► merge ─► report
//! ```
//!
//! The same edge (the same number) meets the same draws under every condition and policy: common
//! random numbers. What is kept of the lives is merged as integers, so that the result does not
//! depend on threads or shards.
//!
//! | module | what it does |
//! |---|---|
//! | [`spread`] | distributions of inputs, Gaussian copula |
//! | [`points`] | points of the unit cube: plain, antithetic, Latin hypercube, scrambled Sobol |
//! | [`policy`] | speed rules: constant, schedule, minimum wear with an observer, oracle |
//! | [`edge`] | one life: quadrature where nothing changes in it, else passes |
//! | [`tally`] | exact sums, quantile sketch, digest |
//! | [`run`] | lives by the block, in parallel |
//! | [`shard`] | plan, parts with sidecars, merging |
//! | [`sensitivity`] | Sobol indices, Morris screening |
//! | [`report`] | results of a finished study: text, summary, table, report |

pub mod edge;
pub mod points;
pub mod policy;
pub mod report;
pub mod run;
pub mod sensitivity;
pub mod shard;
pub mod spread;
pub mod tally;

use points::Sampling;
use policy::{Policy, Reading, Rule};
use spread::{Copula, Spread};
use std::sync::Arc;
use toolroom_process::Record;
use toolroom_scenario::SensorSheet;
use toolroom_wear::{Cut, Pair, Scatter};

/// What ends an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum End {
    /// Flank wear at the limit.
    WearLimit,
    /// Chipped.
    Chipping,
    /// Surface rougher than allowed.
    Roughness,
    /// Cutting force above what is allowed.
    Force,
    /// Too hot.
    Collapse,
    /// Path of the study cut: the life is censored.
    Path,
    /// Time of the study over: the life is censored.
    Time,
}

impl End {
    /// Every end, in the order of reports.
    pub const ALL: [Self; 7] =
        [Self::WearLimit, Self::Chipping, Self::Roughness, Self::Force, Self::Collapse, Self::Path, Self::Time];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::WearLimit => "wear_limit",
            Self::Chipping => "chipping",
            Self::Roughness => "roughness",
            Self::Force => "force",
            Self::Collapse => "collapse",
            Self::Path => "path",
            Self::Time => "time",
        }
    }

    /// Whether the edge was still good.
    pub fn censored(self) -> bool {
        matches!(self, Self::Path | Self::Time)
    }
}

/// Criteria that end an edge besides the wear limit of its pair, chipping and collapse; infinite
/// where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// Flank wear, m.
    pub wear: f64,
    /// Flank wear at which the surface is too rough, m.
    pub rough_wear: f64,
    /// Cutting force, N.
    pub force: f64,
    /// Cutting path, m.
    pub path: f64,
    /// Time in cut, s.
    pub time: f64,
    /// Which ends cost a failure.
    pub failure: FailureKind,
}

/// Which ends of an edge are failures, at the cost that `[replacement]` states for them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FailureKind {
    /// Those in the cut: chipping and collapse. A limit is seen, and the edge replaced there as planned.
    #[default]
    Cut,
    /// Reaching a limit as well: nobody sees it.
    Limit,
}

impl FailureKind {
    /// Whether this end is a failure.
    pub fn is_failure(self, end: End) -> bool {
        match end {
            End::Chipping | End::Collapse => true,
            End::WearLimit | End::Roughness | End::Force => self == Self::Limit,
            End::Path | End::Time => false,
        }
    }
}

impl Default for Ends {
    fn default() -> Self {
        Self {
            wear: f64::INFINITY,
            rough_wear: f64::INFINITY,
            force: f64::INFINITY,
            path: f64::INFINITY,
            time: f64::INFINITY,
            failure: FailureKind::default(),
        }
    }
}

/// Passes into which a life is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passes {
    /// Path of a pass, m.
    pub path: f64,
    /// Pause after it, s.
    pub pause: f64,
}

/// Importance sampling of early failures: half of the edges are drawn so that they fail early, by
/// wear or by chipping, and weigh less.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilt {
    /// Shift of the common wear factor, in its standard deviations.
    pub wear_shift: f64,
    /// Rate of the exponential resistance to chipping; 1 leaves it as it is.
    pub chipping_rate: f64,
}

impl Default for Tilt {
    fn default() -> Self {
        Self { wear_shift: 0.0, chipping_rate: 1.0 }
    }
}

impl Tilt {
    /// Shares of the edges with shifted wear and of those with less resistance: half of all edges
    /// together, for an edge hardly ever fails early for both reasons.
    fn shares(&self) -> [f64; 2] {
        match (self.wear_shift != 0.0, self.chipping_rate != 1.0) {
            (true, true) => [0.25, 0.25],
            (true, false) => [0.5, 0.0],
            (false, true) => [0.0, 0.5],
            (false, false) => [0.0, 0.0],
        }
    }
}

/// A number of the model that varies from edge to edge.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// `group.name` as in files.
    pub name: String,
    /// Group of the pair's parameters; none for the cut.
    pub group: Option<&'static str>,
    /// Index in its record.
    pub index: usize,
    /// Its distribution, SI.
    pub spread: Spread,
}

/// One condition under one policy.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Name of the condition, empty where there is one only.
    pub condition: String,
    /// Name of the policy.
    pub policy: String,
    /// Nominal cut.
    pub cut: Cut,
    /// The policy at it.
    pub speed: Policy,
}

/// A study, ready to run.
#[derive(Clone, Debug)]
pub struct Study {
    /// Short name.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Seed of every random number.
    pub seed: u64,
    /// Lives a cell.
    pub lives: u64,
    /// Nominal pair.
    pub pair: Pair,
    /// The same study with the pair and scatter of each draw of a posterior, but without cells; none without draws. Edge `i` is
    /// one of study `i`, beginning again after the last.
    pub worlds: Arc<[Self]>,
    /// Scatter of edges, work pieces and wear.
    pub scatter: Scatter,
    /// Further numbers that vary.
    pub fields: Vec<Field>,
    /// Correlation of all coordinates of a point; none where they are independent.
    pub copula: Option<Copula>,
    /// Conditions times policies.
    pub cells: Vec<Cell>,
    /// End criteria.
    pub ends: Ends,
    /// Passes.
    pub passes: Passes,
    /// Whether the body of the tool warms with a lag, or follows at once.
    pub lagged: bool,
    /// How points are chosen.
    pub sampling: Sampling,
    /// Importance sampling.
    pub tilt: Tilt,
    /// Age before which a failure is early, s; 0 where that is of no interest.
    pub early: f64,
}

impl Study {
    /// A study of one life a cell, seed 0, with nothing else requested: no further fields, the usual end
    /// criteria, plain points, no age before which a failure is early.
    ///
    /// # Examples
    /// ```
    /// use toolroom_life::study::{Passes, Study};
    /// use toolroom_wear::{Pair, Scatter};
    /// let passes = Passes { path: 37.7, pause: 0.0 };
    /// let study = Study { lives: 1000, ..Study::plain(Pair::default(), Scatter::none(), Vec::new(), (passes, false)) };
    /// assert_eq!((study.lives, study.seed), (1000, 0));
    /// ```
    pub fn plain(pair: Pair, scatter: Scatter, cells: Vec<Cell>, (passes, lagged): (Passes, bool)) -> Self {
        Self {
            name: String::new(),
            title: String::new(),
            seed: 0,
            lives: 1,
            pair,
            worlds: Arc::default(),
            scatter,
            fields: Vec::new(),
            copula: None,
            cells,
            ends: Ends::default(),
            passes,
            lagged,
            sampling: Sampling::Plain,
            tilt: Tilt::default(),
            early: 0.0,
        }
    }

    /// Coordinates of a point.
    pub fn dimensions(&self) -> usize {
        edge::COORDINATES.len() + self.fields.len()
    }

    /// Name of a coordinate.
    pub fn coordinate(&self, index: usize) -> &str {
        let built_in = edge::COORDINATES.get(index).copied();
        built_in.unwrap_or_else(|| &self.fields[index - edge::COORDINATES.len()].name)
    }

    /// Whether the cut changes from pass to pass.
    fn varies(&self) -> bool {
        self.scatter.allowance > 0.0 || self.scatter.piece_hardness > 0.0
    }

    /// Whether nothing but wear changes during a life at constant speed.
    fn steady(&self) -> bool {
        !self.varies() && !self.lagged && self.ends.force.is_infinite()
    }

    /// Flank wear at which an edge is spent, m.
    fn wear_at_end(&self, pair: &Pair) -> f64 {
        pair.limits.wear_limit.min(self.ends.wear).min(self.ends.rough_wear)
    }

    fn limit_kind(&self, pair: &Pair) -> End {
        if self.ends.rough_wear < pair.limits.wear_limit.min(self.ends.wear) { End::Roughness } else { End::WearLimit }
    }

    /// The study with tool, work material and scatter of each of some draws; policies know what they knew before.
    #[must_use]
    pub fn among(self, draws: Vec<(Pair, Scatter)>) -> Self {
        let bare = Self { cells: Vec::new(), ..self.clone() };
        let world = |(pair, scatter)| Self { pair, scatter, ..bare.clone() };
        Self { worlds: draws.into_iter().map(world).collect(), ..self }
    }

    /// Lives edge number `index` in a cell at a point.
    pub fn live(&self, cell: &Cell, index: u64, point: &[f64], draws: &mut edge::Draws) -> edge::Outcome {
        let count = self.worlds.len() as u64;
        if count > 0 {
            return self.worlds[(index % count) as usize].live(cell, index, point, draws);
        }
        if self.fields.is_empty() {
            return edge::live(self, &self.pair, &cell.cut, &cell.speed, point, draws);
        }
        let (mut pair, mut cut) = (self.pair.clone(), cell.cut);
        for (field, u) in self.fields.iter().zip(&point[edge::COORDINATES.len()..]) {
            let value = field.spread.quantile(*u);
            match field.group {
                None => {
                    cut.set(field.index, value);
                }
                Some(group) => {
                    let record = pair.parameters_mut().into_iter().find(|(name, _)| *name == group);
                    if let Some((_, record)) = record {
                        record.set_value(field.index, value);
                    }
                }
            }
        }
        edge::live(self, &pair, &cut, &cell.speed, point, draws)
    }
}

/// A condition and a rule become a cell; `course` says in what passes edges live, and whether their
/// body follows with its lag.
pub fn cell(
    (condition, cut): (&str, Cut),
    (name, rule, reading): (&str, Rule, Reading),
    pair: &Pair,
    scatter: &Scatter,
    sensors: SensorSheet,
    course: (Passes, bool),
) -> Cell {
    let speed = Policy::new(rule, (pair, &cut), course, scatter.allowance, (sensors, reading));
    Cell { condition: condition.to_owned(), policy: name.to_owned(), cut, speed }
}
