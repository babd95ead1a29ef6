//! What is worked out of a finished study: a law for every cell, the regression over its conditions, sensitivities.

use super::RefusedCell;
use crate::analysis::{Analysis, Request, analyse};
use crate::regression::{Regression, regress};
use crate::replacement::{Costs, Cycles};
use crate::sample::{Observation, Sample};
use crate::study::edge::{Draws, level_share};
use crate::study::run::{Tally, lives};
use crate::study::sensitivity::{Effect, SobolIndex, morris, sobol};
use crate::study::shard::{failures, sample};
use crate::study::{Cell, End, FailureKind, Study, Tilt};
use std::sync::Arc;

/// Refits behind the bands of simulated lives.
const REFITS: u32 = 100;
/// Draws behind the interval of the edge of median level (assumption: its ends then have an error of a tenth of its width).
const DRAWN: usize = 400;
/// Lives of each cell behind the regression.
const REGRESSED: u64 = 300;

/// One cell worked out.
pub(super) struct Worked<'a> {
    pub(super) cell: &'a Cell,
    pub(super) tally: &'a Tally,
    pub(super) sample: Sample,
    pub(super) analysis: Result<Analysis, String>,
    /// Best wear at which to replace, m, and its cost rate (per min).
    pub(super) by_wear: Option<(f64, f64)>,
    /// 5 %, 50 % and 95 % points over the draws of the life of an edge of median level, min; none without draws.
    pub(super) median_edge: Option<[f64; 3]>,
}

pub(super) fn work<'a>(
    cell: &'a Cell,
    tally: &'a Tally,
    study: &Study,
    request: &Request,
) -> Result<Worked<'a>, RefusedCell> {
    let sample = sample(tally).map_err(|source| RefusedCell { cell: name(cell), source })?;
    let failures = match study.ends.failure {
        // Where a life only ends by failing, both are the same sample.
        FailureKind::Limit => None,
        FailureKind::Cut => {
            Some(failures(tally, FailureKind::Cut).map_err(|source| RefusedCell { cell: name(cell), source })?)
        }
    };
    // Simulated lives in thousands are no draw from any law: a test would only count them.
    let request = Request { goodness: 0, bootstrap: request.bootstrap.min(REFITS), failures, ..request.clone() };
    let analysis = analyse(&sample, &request).map_err(|error| error.to_string());
    let (by_wear, median_edge) = (by_wear(tally, study, &request.costs), median_edge(study, cell));
    Ok(Worked { cell, tally, sample, analysis, by_wear, median_edge })
}

/// Life of the edge of median level without noise under some of the draws: what the parameters leave open, apart from how
/// edges differ.
fn median_edge(study: &Study, cell: &Cell) -> Option<[f64; 3]> {
    let mut lives: Vec<f64> = study.worlds.iter().take(DRAWN).map(|world| quiet_life(world, cell, None)).collect();
    lives.sort_by(f64::total_cmp);
    let last = lives.len().checked_sub(1)?;
    Some([0.05, 0.5, 0.95].map(|share| lives[(share * last as f64).round() as usize]))
}

/// Life in min of the edge at the median of every input, or with one input at another quantile, without noise within it.
fn quiet_life(study: &Study, cell: &Cell, input: Option<(usize, f64)>) -> f64 {
    let quiet = Study { scatter: toolroom_wear::Scatter { life_noise: 0.0, ..study.scatter }, ..study.clone() };
    let mut point = vec![0.5; study.dimensions()];
    if let Some((place, u)) = input {
        point[place] = u;
    }
    quiet.live(cell, 0, &point, &mut Draws::of(study.seed, 0)).life / 60.0
}

/// The level of wear at which replacing costs least per time.
pub(super) fn by_wear(tally: &Tally, study: &Study, costs: &Costs) -> Option<(f64, f64)> {
    let limit = study.pair.limits.wear_limit.min(study.ends.wear).min(study.ends.rough_wear);
    let rates = tally.cycles.iter().enumerate().map(|(level, cycles)| {
        let cycles = Cycles { failed: cycles.failed.mean(), length: cycles.length.mean() / 60.0 };
        (limit * level_share(level), cycles.cost_rate(costs))
    });
    rates.filter(|(_, rate)| rate.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1))
}

pub(super) fn name(cell: &Cell) -> String {
    match (cell.condition.as_str(), cell.policy.as_str()) {
        ("", policy) => policy.to_owned(),
        (condition, policy) => format!("{condition} · {policy}"),
    }
}

pub(super) fn chipped(tally: &Tally) -> f64 {
    let total: f64 = tally.ends.iter().map(|sketch| sketch.weight()).sum();
    let chipping = End::ALL.iter().position(|end| *end == End::Chipping).unwrap_or(1);
    tally.ends[chipping].weight() / total
}

/// Share of edges that were still good when the study stopped.
pub(super) fn outlived(tally: &Tally) -> f64 {
    let weight = |censored: bool| {
        let ends = End::ALL.iter().zip(&tally.ends).filter(|(end, _)| !censored || end.censored());
        ends.map(|(_, sketch)| sketch.weight()).sum::<f64>()
    };
    weight(true) / weight(false)
}

/// Probability of a failure before the early age, with its standard error.
pub(super) fn early(tally: &Tally) -> (f64, f64) {
    (tally.early.mean(), tally.early.standard_error())
}

/// The extended Taylor law over the grid of conditions at programmed speed, every condition with
/// edges of its own; none where nothing varies.
pub(super) fn regression(study: &Study) -> Option<(Regression, Vec<(f64, f64)>)> {
    let cells: Vec<&Cell> =
        study.cells.iter().filter(|cell| cell.speed.constant() == Some(cell.cut.cutting_speed)).collect();
    type Read = fn(&Cell) -> f64;
    let columns: [(&str, Read); 3] = [
        ("ln(cutting_speed)", |cell| (cell.cut.cutting_speed * 60.0).ln()),
        ("ln(feed_per_rev)", |cell| (cell.cut.feed_per_rev * 1e3).ln()),
        ("ln(depth_of_cut)", |cell| (cell.cut.depth_of_cut * 1e3).ln()),
    ];
    let varies = |read: &Read| cells.iter().any(|cell| (read(cell) - read(cells[0])).abs() > 1e-9);
    let columns: Vec<&(&str, Read)> = columns.iter().filter(|(_, read)| varies(read)).collect();
    if columns.is_empty() {
        return None;
    }
    let (mut rows, mut observations, mut points) = (Vec::new(), Vec::new(), Vec::new());
    for (i, cell) in cells.iter().enumerate() {
        let from = REGRESSED * i as u64;
        for outcome in lives(study, cell, from, from + REGRESSED, true).1 {
            let minutes = outcome.life / 60.0;
            rows.push(columns.iter().map(|(_, read)| read(cell)).collect::<Vec<f64>>());
            observations.push(if outcome.end.censored() {
                Observation::Censored(minutes)
            } else {
                Observation::Failed(minutes)
            });
            points.push((cell.cut.cutting_speed * 60.0, minutes));
        }
    }
    let sample = Sample::new(observations).ok()?;
    let regression = regress(columns.iter().map(|(name, _)| *name), &rows, &sample).ok()?;
    Some((regression, points))
}

/// Sobol indices, Morris effects and swings of the life under the first cell, min.
pub(super) struct Sensitivity {
    pub(super) indices: Vec<SobolIndex>,
    pub(super) effects: Vec<Effect>,
    /// Life at the median of every input, and with one input at its 10 and 90 % quantile.
    pub(super) middle: f64,
    pub(super) swings: Vec<(f64, f64)>,
}

pub(super) fn sensitivity(study: &Study, samples: u64, paths: u64) -> Sensitivity {
    // Inputs are varied one by one: correlation, tilt and draws would mix them.
    let study = Study { copula: None, tilt: Tilt::default(), worlds: Arc::default(), ..study.clone() };
    let cell = &study.cells[0];
    let life = |point: &[f64], row: u64| study.live(cell, row, point, &mut Draws::of(study.seed, row)).life / 60.0;
    let dimensions = study.dimensions();
    let life_with = |input: Option<(usize, f64)>| quiet_life(&study, cell, input);
    Sensitivity {
        indices: sobol(life, dimensions, samples, 0.9, study.seed),
        effects: morris(life, dimensions, paths, study.seed),
        middle: life_with(None),
        swings: (0..dimensions).map(|j| (life_with(Some((j, 0.1))), life_with(Some((j, 0.9))))).collect(),
    }
}
