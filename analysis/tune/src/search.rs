//! The search for the best settings of one rule.

use super::axis::{Axis, Reference};
use super::{Objective, TriedRun, TuneError, TunedPolicy, given};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use toolroom_kpi::{Counting, unless_stopped};
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_scenario::{PolicyRule, Scenario, TuneRequest};
use toolroom_shards::Journal;
use toolroom_shop::Shop;
use toolroom_shop::runlog::ChangeReason;
use toolroom_surface::{Estimates, Trial as Tried};

/// Replications of every setting of the first grid, as a share of the budget: 8 of 600. With 24 settings the grid takes a
/// third of the budget.
const FIRST: u32 = 75;
/// Share of the budget that extending the grid may reach: half is left for choosing among the better settings.
const EXTENDED: f64 = 0.5;
/// Settings among which a share of one is kept after the first grid.
const KEPT: usize = 3;
/// Settings that get half of what is left at the end, and those of them that get the rest.
const FINALISTS: [usize; 2] = [6, 3];

/// Rules of tool change that get what is left of the budget: the best one half of it, the next one the rest.
const LEFT: [u32; 2] = [2, 1];
/// Settings of a rule that share it.
const SHARING: usize = 3;

/// What all rules have in common.
pub(super) struct Search<'a> {
    /// The scenario with the seed of the tuning.
    pub scenario: Scenario,
    pub request: &'a TuneRequest,
    pub objective: Objective,
    /// From SI to the unit of files.
    pub scale: f64,
    pub pool: &'a rayon::ThreadPool,
    /// Told how many more runs are done.
    pub progress: &'a (dyn Fn(u32) + Sync),
    pub stop: &'a AtomicBool,
    /// Replications that an earlier search simulated.
    pub known: BTreeMap<Trial, Run>,
    /// Where finished replications are written.
    pub journal: Option<&'a Journal<TriedRun>>,
}

/// What a replication is of: name of the policy, word of its rule of tool change, bits of its settings, number of the
/// replication.
type Trial = (String, String, Vec<u64>, u32);

/// One replication.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// Less is better; infinite where it is not defined.
    pub objective: f64,
    edges: u32,
    pub collapsed: u32,
    pub failed: u32,
}

/// Settings that are tried.
pub(super) struct Point {
    /// One value an axis, SI.
    pub values: Vec<f64>,
    policy: Arc<ResolvedPolicy>,
    pub runs: Vec<Run>,
}

/// All settings of one rule that are tried, with one rule of tool change.
pub(super) struct Field<'a> {
    pub search: &'a Search<'a>,
    pub rule: PolicyRule,
    pub axes: Vec<Axis>,
    pub points: Vec<Point>,
    /// Replications that it may take.
    budget: u32,
    pub runs_spent: u32,
}

impl TriedRun {
    pub(super) fn known(self) -> (Trial, Run) {
        let Self { policy, change, settings, replication, objective, edges, collapsed, failed } = self;
        (
            (policy, change, settings, replication),
            Run { objective: f64::from_bits(objective), edges, collapsed, failed },
        )
    }

    fn from_change((policy, change, settings, replication): Trial, run: Run) -> Self {
        let Run { objective, edges, collapsed, failed } = run;
        Self { policy, change, settings, replication, objective: objective.to_bits(), edges, collapsed, failed }
    }
}

impl Search<'_> {
    /// Equal shares of the budget of a policy: one where it keeps its rule of tool change, else one for each rule that it may
    /// have and one for the better ones.
    pub fn shares(rule: &PolicyRule) -> u32 {
        // A rule by time in cut may fall away where no life is known; the budget is reckoned with it all the same.
        let rules = rule.change_rules(Some(1.0)).len() as u32;
        if rules == 1 { 1 } else { rules + 1 }
    }

    /// The best settings of policy number `policy`.
    pub fn policy(&self, policy: usize) -> Result<TunedPolicy, TuneError> {
        let rule = self.scenario.policies[policy].clone();
        let Some(reference) = Reference::of(&self.scenario) else {
            return Ok(given(&rule.name, "no turning operation follows a commanded speed".to_owned()));
        };
        let budget = self.request.budget / Self::shares(&rule);
        let field = |tool_change| {
            let rule = PolicyRule { tool_change, ..rule.clone() };
            let axes = Axis::all(&rule, reference);
            Field { search: self, rule, axes, points: Vec::new(), budget, runs_spent: 0 }
        };
        let mut fields: Vec<Field<'_>> = rule.change_rules(reference.life).into_iter().map(field).collect();
        if let [only] = fields.as_mut_slice() {
            only.budget = self.request.budget;
            only.tune()?;
            return Ok(only.told());
        }
        for field in &mut fields {
            field.tune()?;
        }
        let left =
            |fields: &[Field<'_>]| self.request.budget - fields.iter().map(|field| field.runs_spent).sum::<u32>();
        let ranked = |fields: &mut [Field<'_>]| fields.sort_by(|a, b| a.least().total_cmp(&b.least()));
        // The better rules get what is left, the best of them the most.
        ranked(&mut fields);
        for (place, share) in LEFT.into_iter().enumerate() {
            let more = if place + 1 < LEFT.len() { left(&fields) / share } else { left(&fields) };
            fields[place].go_on(more)?;
        }
        ranked(&mut fields);
        let evaluations = fields.iter().map(|field| field.runs_spent).sum();
        let tool_changes = fields.iter().map(Field::tried).collect();
        Ok(TunedPolicy { evaluations, tool_changes, ..fields[0].told() })
    }
}

impl Point {
    /// Share of edges lost in a way, and its standard deviation.
    pub fn share(&self, lost: fn(&Run) -> u32) -> (f64, f64) {
        let sum = |of: fn(&Run) -> u32| self.runs.iter().map(|run| f64::from(of(run))).sum::<f64>();
        let edges = sum(|run| run.edges);
        if edges == 0.0 {
            return (0.0, 0.0);
        }
        let share = sum(lost) / edges;
        (share, (share * (1.0 - share) / edges).sqrt())
    }

    /// Whether the guard lets these settings stand, one standard deviation on the safe side.
    pub fn is_admissible(&self, request: &TuneRequest) -> bool {
        let within = |lost: fn(&Run) -> u32, limit: f64| {
            let (share, deviation) = self.share(lost);
            share + deviation <= limit
        };
        within(|run| run.collapsed, request.collapse)
            && request.failure.is_none_or(|limit| within(|run| run.failed, limit))
    }
}

impl Field<'_> {
    /// Replications of every setting of the first grid.
    pub fn first(&self) -> usize {
        (self.budget / FIRST).max(2) as usize
    }

    /// Estimated objective of the best settings; infinite where the guard lets none stand.
    fn least(&self) -> f64 {
        let best = self.known().first().copied();
        best.map_or(f64::INFINITY, |best| self.estimates().means[best])
    }

    /// Admissible points that are known well enough to be chosen, the best first.
    pub fn known(&self) -> Vec<usize> {
        // Those of the first grid that were not kept are known too little.
        let by_count = [2 * self.first(), 1].into_iter().map(|count| self.best(count));
        by_count.into_iter().find(|best| !best.is_empty()).unwrap_or_default()
    }

    /// More replications of the best settings after [`tune`](Self::tune).
    fn go_on(&mut self, more: u32) -> Result<(), TuneError> {
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

    fn tune(&mut self) -> Result<(), TuneError> {
        let budget = self.budget;
        let first = self.first();
        self.add(&self.grid())?;
        self.run_to(&(0..self.points.len()).collect::<Vec<_>>(), first)?;
        self.extend(first)?;
        let kept = self.best(first).into_iter().take(self.points.len().div_ceil(KEPT)).collect::<Vec<_>>();
        let Some(&incumbent) = kept.first() else { return Ok(()) };
        self.run_to(&kept, 2 * first)?;
        let before = self.points.len();
        self.add(&self.finer(incumbent))?;
        self.run_to(&(before..self.points.len()).collect::<Vec<_>>(), 2 * first)?;
        let mut looked = 2 * first;
        for (round, count) in FINALISTS.into_iter().enumerate() {
            let finalists: Vec<usize> = self.best(looked).into_iter().take(count).collect();
            let left = (budget - self.runs_spent) as usize;
            let share = if round + 1 < FINALISTS.len() { left / 2 } else { left };
            looked += share / finalists.len().max(1);
            self.run_to(&finalists, looked)?;
        }
        if let Some(&best) = self.best(looked).first() {
            let count = self.points[best].runs.len() + (budget - self.runs_spent) as usize;
            self.run_to(&[best], count)?;
        }
        Ok(())
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
        let settings = self.points[point].values.iter().map(|value| value.to_bits()).collect();
        let trial = (self.rule.name.clone(), self.rule.tool_change.word().to_owned(), settings, replication);
        let run = match self.search.known.get(&trial) {
            Some(known) => *known,
            None => {
                let run = self.simulate(point, replication)?;
                if let Some(journal) = self.search.journal {
                    journal.add(&TriedRun::from_change(trial, run));
                }
                run
            }
        };
        (self.search.progress)(1);
        Ok(run)
    }

    fn simulate(&self, point: usize, replication: u32) -> Result<Run, TuneError> {
        let Search { scenario, objective, stop, .. } = self.search;
        let Point { policy, values, .. } = &self.points[point];
        let refuse = |source| TuneError::Shop {
            policy: self.rule.name.clone(),
            settings: self.shown(values),
            source: Box::new(source),
        };
        if stop.load(Ordering::Relaxed) {
            return Err(TuneError::Stopped);
        }
        let world = scenario.drawn(replication).map_err(|source| refuse(source.into()))?;
        let counting = Counting::new(scenario);
        let shop = Shop::with_recorder(&world, Arc::clone(policy), replication, counting).map_err(refuse)?;
        let counting = unless_stopped(shop, stop).map_err(refuse)?.ok_or(TuneError::Stopped)?;
        let value = objective.sign * counting.values()[objective.index];
        let mut run =
            Run { objective: if value.is_finite() { value } else { f64::INFINITY }, edges: 0, collapsed: 0, failed: 0 };
        for edge in counting.lives() {
            let collapsed = edge.reason == ChangeReason::ThermalCollapse;
            run.edges += 1;
            run.collapsed += u32::from(collapsed);
            run.failed += u32::from(collapsed || edge.reason == ChangeReason::Chipping);
        }
        Ok(run)
    }

    /// What all points that were tried say together.
    pub fn estimates(&self) -> Estimates {
        let tried = |point: &Point| Tried {
            at: self.axes.iter().zip(&point.values).map(|(axis, value)| axis.position(*value)).collect(),
            values: point.runs.iter().map(|run| run.objective).collect(),
        };
        Estimates::from_trials(&self.points.iter().map(tried).collect::<Vec<_>>())
    }

    /// Admissible points with so many replications, the best first.
    pub fn best(&self, count: usize) -> Vec<usize> {
        let estimated = self.estimates().means;
        let known = |point: &Point| point.runs.len() >= count && point.is_admissible(self.search.request);
        let mut points: Vec<usize> = (0..self.points.len()).filter(|&point| known(&self.points[point])).collect();
        points.sort_by(|&a, &b| estimated[a].total_cmp(&estimated[b]));
        points
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

    /// A grid of half the step around the least of the surface through all points, around the best where there is none.
    fn finer(&self, best: usize) -> Vec<Vec<f64>> {
        let home =
            || self.axes.iter().zip(&self.points[best].values).map(|(axis, value)| axis.position(*value)).collect();
        let centre: Vec<f64> = self.estimates().least.unwrap_or_else(home);
        let steps: &[f64] = if self.axes.len() == 1 { &[-0.5, -0.25, 0.0, 0.25, 0.5] } else { &[-0.5, 0.0, 0.5] };
        let lists = self.axes.iter().zip(centre);
        let lists =
            lists.map(|(axis, centre)| steps.iter().map(|step| axis.value(centre + step)).collect::<Vec<f64>>());
        lists.fold(vec![Vec::new()], |combinations, list| {
            let with = |before: &Vec<f64>| {
                list.iter().map(|value| [before.as_slice(), &[*value]].concat()).collect::<Vec<_>>()
            };
            combinations.iter().flat_map(with).collect()
        })
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
