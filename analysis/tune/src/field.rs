//! The settings of one rule that are tried, and how the budget is spent on them.

use super::axis::Axis;
use super::trial::{Asked, Point, Run, Search};
use super::{TriedRun, TuneError};
use rayon::prelude::*;
use std::sync::Arc;
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_scenario::{PolicyRule, Scenario};

/// Replications of every setting of the first grid, as a share of the budget: 8 of 600. With 24 settings the grid takes a
/// third of the budget.
const FIRST: u32 = 75;
/// Share of the budget that extending the grid may reach: half is left for choosing among the better settings.
const EXTENDED: f64 = 0.5;
/// Settings among which a share of one is kept after the first grid.
const KEPT: usize = 3;
/// Settings that get half of what is left at the end, and those of them that get the rest.
const FINALISTS: [usize; 2] = [6, 3];

/// Steps of the finer grid, in those of the first; the second is taken where the guard excludes the best settings.
const STEPS: [f64; 2] = [0.5, 0.25];
/// Settings of a rule that share it.
const SHARING: usize = 3;

/// All settings of one rule that are tried, with one rule of tool change.
pub(super) struct Field<'a> {
    pub search: &'a Search<'a>,
    pub rule: PolicyRule,
    pub axes: Vec<Axis>,
    pub points: Vec<Point>,
    /// Replications that it may take.
    pub budget: u32,
    pub runs_spent: u32,
}

impl<'a> Field<'a> {
    pub fn new(search: &'a Search<'a>, rule: PolicyRule, axes: Vec<Axis>, budget: u32) -> Self {
        Self { search, rule, axes, points: Vec::new(), budget, runs_spent: 0 }
    }

    /// Replications of every setting of the first grid.
    pub fn first(&self) -> usize {
        (self.budget / FIRST).max(2) as usize
    }

    /// Estimated objective of the best settings; infinite where the guard lets none stand.
    pub fn least(&self) -> f64 {
        let best = self.known().first().copied();
        best.map_or(f64::INFINITY, |best| self.outlook().estimates.means[best])
    }

    /// Admissible points that are known well enough to be chosen, the best first.
    pub fn known(&self) -> Vec<usize> {
        // Those of the first grid that were not kept are known too little.
        let by_count = [2 * self.first(), 1].into_iter().map(|count| self.best(count));
        by_count.into_iter().find(|best| !best.is_empty()).unwrap_or_default()
    }

    /// More replications of the best settings after [`tune`](Self::tune).
    pub fn go_on(&mut self, more: u32) -> Result<(), TuneError> {
        let best: Vec<usize> = self.known().into_iter().take(SHARING).collect();
        let Some(&first) = best.first() else { return Ok(()) };
        // The replications of the first grid stay those of the share that it was laid with.
        let total = self.runs_spent + more;
        let each = more as usize / best.len();
        for point in best {
            let count = self.points[point].runs.len() + each;
            self.run_within(&[point], count, total)?;
        }
        let count = self.points[first].runs.len() + (total - self.runs_spent) as usize;
        self.run_within(&[first], count, total)
    }

    pub fn tune(&mut self) -> Result<(), TuneError> {
        let budget = self.budget;
        let first = self.first();
        self.add(&self.grid())?;
        self.run_to(&(0..self.points.len()).collect::<Vec<_>>(), first)?;
        self.extend(first)?;
        let kept = self.best(first).into_iter().take(self.points.len().div_ceil(KEPT)).collect::<Vec<_>>();
        let Some(&incumbent) = kept.first() else { return Ok(()) };
        self.run_to(&kept, 2 * first)?;
        for step in STEPS {
            let before = self.points.len();
            let (settings, at_guard) = self.outlook().next(self, incumbent, step);
            self.add(&settings)?;
            self.run_to(&(before..self.points.len()).collect::<Vec<_>>(), 2 * first)?;
            // The edge of the guard is known better once settings beside it were tried.
            if !at_guard {
                break;
            }
        }
        let mut looked = 2 * first;
        for (round, count) in FINALISTS.into_iter().enumerate() {
            let last = round + 1 == FINALISTS.len();
            if last {
                self.add_floor(looked)?;
            }
            let finalists: Vec<usize> = self.best(looked).into_iter().take(count).collect();
            let left = (budget - self.runs_spent) as usize;
            // What the last replications tell of the floor is looked at once more.
            let share = if last { left.saturating_sub(2 * first) } else { left / 2 };
            looked += share / finalists.len().max(1);
            self.run_to(&finalists, looked)?;
        }
        self.add_floor(2 * first)?;
        if let Some(&best) = self.best(2 * first).first() {
            let count = self.points[best].runs.len() + (budget - self.runs_spent) as usize;
            self.run_to(&[best], count)?;
        }
        Ok(())
    }

    /// Tries the settings at the least of the surface, which rests on all replications, while that of the points tried so far is partly
    /// luck.
    fn add_floor(&mut self, count: usize) -> Result<(), TuneError> {
        let Some(settings) = self.outlook().floor(self) else { return Ok(()) };
        let before = self.points.len();
        self.add(&[settings])?;
        self.run_to(&(before..self.points.len()).collect::<Vec<_>>(), count)
    }

    /// All combinations of the values of the axes.
    fn grid(&self) -> Vec<Vec<f64>> {
        self.axes.iter().fold(vec![Vec::new()], |combinations, axis| {
            let with = |before: &Vec<f64>| {
                axis.values.iter().map(|value| [before.as_slice(), &[*value]].concat()).collect::<Vec<_>>()
            };
            combinations.iter().flat_map(with).collect()
        })
    }

    /// Adds settings that are not there yet.
    fn add(&mut self, settings: &[Vec<f64>]) -> Result<(), TuneError> {
        for values in settings {
            if self.points.iter().any(|point| point.values == *values) {
                continue;
            }
            let scenario = Scenario { policies: vec![self.rule_at(values)], ..self.search.scenario.clone() };
            let policy = Arc::new(ResolvedPolicy::from_scenario(&scenario, 0)?);
            self.points.push(Point { values: values.clone(), policy, runs: Vec::new() });
        }
        Ok(())
    }

    fn rule_at(&self, values: &[f64]) -> PolicyRule {
        self.axes.iter().zip(values).fold(self.rule.clone(), |rule, (axis, value)| rule.with(axis.setting, *value))
    }

    /// Simulates the first `count` replications of the points called by index, as far as the budget goes.
    fn run_to(&mut self, points: &[usize], count: usize) -> Result<(), TuneError> {
        self.run_within(points, count, self.budget)
    }

    /// The same until the field has spent `total` replications.
    fn run_within(&mut self, points: &[usize], count: usize, total: u32) -> Result<(), TuneError> {
        let left = total.saturating_sub(self.runs_spent) as usize;
        let missing =
            points.iter().flat_map(|&point| (self.points[point].runs.len()..count).map(move |run| (point, run)));
        // One replication of all points after the other, so that a budget that runs short leaves them alike.
        let mut tasks: Vec<(usize, usize)> = missing.collect();
        tasks.sort_by_key(|(_, run)| *run);
        tasks.truncate(left);
        let search = self.search;
        let done = search.pool.install(|| {
            let run = |&(point, run): &(usize, usize)| self.run(point, run as u32);
            tasks.par_iter().map(run).collect::<Vec<_>>()
        });
        for ((point, _), run) in tasks.iter().zip(done) {
            self.points[*point].runs.push(run?);
        }
        self.runs_spent += tasks.len() as u32;
        Ok(())
    }

    /// One replication of a point, simulated where no earlier search did.
    fn run(&self, point: usize, replication: u32) -> Result<Run, TuneError> {
        let point = &self.points[point];
        let values = &point.values;
        let settings = values.iter().map(|value| value.to_bits()).collect();
        let trial = (self.rule.name.clone(), self.rule.tool_change.word().to_owned(), settings, replication);
        let run = match self.search.known.get(&trial) {
            Some(known) => *known,
            None => {
                let asked = Asked { point, replication };
                let refuse = |source| TuneError::Shop {
                    policy: self.rule.name.clone(),
                    settings: self.shown(values),
                    source: Box::new(source),
                };
                let run = (self.search.simulate)(&asked).map_err(refuse)?.ok_or(TuneError::Stopped)?;
                if let Some(journal) = self.search.journal {
                    journal.add(&TriedRun::from_change(trial, run));
                }
                run
            }
        };
        (self.search.progress)(1);
        Ok(run)
    }

    /// Extends the grid while its best point lies at its end.
    fn extend(&mut self, count: usize) -> Result<(), TuneError> {
        loop {
            let Some(&best) = self.best(count).first() else { return Ok(()) };
            let values = self.points[best].values.clone();
            let next = self.axes.iter().zip(&values).enumerate().find_map(|(number, (axis, value))| {
                let ends = [(false, axis.values.first()), (true, axis.values.last())];
                let end = ends.into_iter().find(|(up, end)| *end == Some(value) && axis.beyond(*up).is_some());
                end.and_then(|(up, _)| Some((number, up, axis.beyond(up)?)))
            });
            let Some((number, up, value)) = next else { return Ok(()) };
            let others: usize =
                self.axes.iter().map(|axis| axis.values.len()).product::<usize>() / self.axes[number].values.len();
            let cost = self.runs_spent as usize + others * count;
            if cost as f64 > EXTENDED * f64::from(self.budget) {
                return Ok(());
            }
            let list = &mut self.axes[number].values;
            if up {
                list.push(value)
            } else {
                list.insert(0, value)
            }
            let before = self.points.len();
            self.add(&self.grid())?;
            self.run_to(&(before..self.points.len()).collect::<Vec<_>>(), count)?;
        }
    }

    pub fn shown(&self, values: &[f64]) -> String {
        let steps = self
            .axes
            .iter()
            .zip(values)
            .map(|(axis, value)| format!("{} {}", axis.setting.key(), axis.setting.shown(*value)));
        steps.collect::<Vec<_>>().join(", ")
    }
}
