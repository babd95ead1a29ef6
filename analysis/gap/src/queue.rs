//! Waiting times of jobs before their operations, scored by trace-driven replications.
//!
//! A queue follows from everything else and names no cause; it shows whether what was named is
//! enough. Jobs come to a pool of machines when the log says, breakdowns and nights are those of the
//! log, edges are changed and feeds held where they were; how long each operation occupies its machine
//! is drawn from the calibrated model, with common random numbers without and with the named effects.
//! A recorded wait is then a probability among the replicated ones, ties drawn at random, and a normal
//! score of it.
//!
//! # Source
//! Randomised probability integral transform: Dunn & Smyth 1996, Brockwell 2007. Trace-driven
//! comparison of queues: Balci & Sargent 1982. First come, first served, on any machine of the pool:
//! assumption.

use super::{Diagnosis, EffectId, NamedEffect};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, BTreeSet};
use toolroom_nominal::shop::{Constant, Shop, Visit, Visits, normal_score};
use toolroom_nominal::{Declarations, WrittenEffect};
use toolroom_scenario::{Deviation, MICRO_STOP, Occasion, Scope, ShopConstant, ShopEffect, calibrated};
use toolroom_statistics::Moments;

/// Replications of a log (count). Assumption: a wait among forty others has a probability to a fortieth, and days are many.
const REPLICATIONS: usize = 40;
/// Fewest scored days of a pool (count). Assumption: two days say nothing about the scatter between days.
const DAYS: usize = 3;
/// Fewest scored waits of a pool (count). Assumption: a day has some ten.
const WAITS: usize = 30;
/// A day, s.
const DAY: f64 = 86400.0;
/// Time to which a control knows when something began, s. Assumption: stamps are rounded to the second.
const CLOCK: f64 = 0.5;

/// Waits before a pool of machines.
#[derive(Clone, Debug, PartialEq)]
pub struct QueueScore {
    /// Machines of the pool.
    pub machines: Vec<String>,
    /// Waits that were scored.
    pub waits: usize,
    /// Mean wait as recorded, s.
    pub recorded: f64,
    /// What the calibrated model says without the named effects, and with them.
    pub without: QueueFit,
    /// With the named effects.
    pub with: QueueFit,
}

/// How recorded waits lie among replicated ones.
#[derive(Clone, Debug, PartialEq)]
pub struct QueueFit {
    /// Mean wait of the replications, s.
    pub mean: f64,
    /// Mean normal score over days, over its standard error: about standard normal for the true shop.
    pub score: f64,
    /// Area between the distribution of the probabilities and the uniform one; 0 for the true shop.
    pub area: f64,
    /// Sum of the recorded waits of each day, s, with the mean of that of the replications, s.
    pub days: Vec<(f64, f64)>,
    /// The score of each replication among the others.
    pub scores: Vec<f64>,
}

/// One operation before a pool.
struct Call<'a> {
    visit: &'a Visit,
    /// When the job was ready, s; its own start where nobody knows.
    ready: f64,
    known: bool,
}

/// When jobs came to the shop and when their first operation began, s, by their names.
pub type Came<'a> = BTreeMap<&'a str, (f64, f64)>;

/// Scores the waits before every pool of machines of jobs that come from another machine, or of which the data say when they
/// `came` to the shop. What the file states of the shop, effects and calibration, acts with and without the named effects.
pub fn queues(
    shop: &Shop,
    visits: &Visits,
    stated: &Declarations,
    diagnosis: &Diagnosis,
    came: &Came<'_>,
    seed: u64,
) -> Vec<QueueScore> {
    let calls = calls(visits, came);
    let model = Occupation::new(shop, visits, stated, diagnosis);
    let one = |pool: &Vec<usize>| {
        let replicated =
            |machine: &usize| shop.station(&visits.machines[*machine]).is_none_or(|station| station.queueing.is_none());
        if !pool.iter().all(replicated) {
            return None;
        }
        let mut in_pool: Vec<&Call<'_>> = calls.iter().filter(|call| pool.contains(&call.visit.machine)).collect();
        in_pool.sort_by(|a, b| a.ready.total_cmp(&b.ready));
        let scored: Vec<usize> = (0..in_pool.len()).filter(|at| in_pool[*at].known).collect();
        let days: BTreeSet<i64> = scored.iter().map(|at| (in_pool[*at].ready / DAY).floor() as i64).collect();
        if scored.len() < WAITS || days.len() < DAYS {
            return None;
        }
        let wait = |at: &usize| (in_pool[*at].visit.start - in_pool[*at].ready).max(0.0);
        let [without, with] = [false, true].map(|effects| fit(visits, pool, &in_pool, &scored, &model, effects, seed));
        Some(QueueScore {
            machines: pool.iter().map(|machine| visits.machines[*machine].clone()).collect(),
            waits: scored.len(),
            recorded: scored.iter().map(wait).sum::<f64>() / scored.len() as f64,
            without,
            with,
        })
    };
    pools(visits).iter().filter_map(one).collect()
}

impl QueueScore {
    /// The fit of the model with the named effects, if there are any.
    pub fn fit(&self, named: bool) -> &QueueFit {
        if named { &self.with } else { &self.without }
    }

    /// In words.
    pub fn words(&self, named: bool) -> String {
        let machines = self.machines.join(", ");
        let fit = |fit: &QueueFit| format!("{:.0} s, score {:.1}, area {:.2}", fit.mean, fit.score, fit.area);
        let with = if named { format!("; with the effects {}", fit(&self.with)) } else { String::new() };
        format!(
            "queue before {machines}: {} waits of {:.0} s in the mean; the model says {}{with}",
            self.waits,
            self.recorded,
            fit(&self.without)
        )
    }
}

/// Waits between two operations of a job before the machines that `of_pool` holds for: when the job was ready, and for how
/// long it waited, s.
pub fn recorded_waits(visits: &Visits, of_pool: impl Fn(&str) -> bool) -> Vec<(f64, f64)> {
    let calls = calls(visits, &Came::new());
    let known = calls.iter().filter(|call| call.known && of_pool(&visits.machines[call.visit.machine]));
    known.map(|call| (call.ready, (call.visit.start - call.ready).max(0.0))).collect()
}

/// Names of the machines of each pool: those that run the same programs.
pub fn pools_of(visits: &Visits) -> Vec<Vec<String>> {
    let names = |pool: &Vec<usize>| pool.iter().map(|machine| visits.machines[*machine].clone()).collect();
    pools(visits).iter().map(names).collect()
}

/// Machines that run the same programs.
fn pools(visits: &Visits) -> Vec<Vec<usize>> {
    let mut pools: Vec<(BTreeSet<usize>, BTreeSet<usize>)> = Vec::new();
    for machine in 0..visits.machines.len() {
        let of_machine = visits.list.iter().filter(|visit| visit.machine == machine);
        let mut merged =
            (BTreeSet::from([machine]), of_machine.map(|visit| visit.program).collect::<BTreeSet<usize>>());
        let (same, other) = pools.into_iter().partition(|(_, programs)| !programs.is_disjoint(&merged.1));
        pools = other;
        for (machines, programs) in same {
            merged.0.extend(machines);
            merged.1.extend(programs);
        }
        pools.push(merged);
    }
    pools.into_iter().map(|(machines, _)| machines.into_iter().collect()).collect()
}

/// Operations with the time at which their job was ready: the end of the one before, or when it came.
fn calls<'a>(seen: &'a Visits, came: &Came<'_>) -> Vec<Call<'a>> {
    let mut jobs: BTreeMap<&str, Vec<&Visit>> = BTreeMap::new();
    seen.list.iter().for_each(|visit| jobs.entry(&visit.job).or_default().push(visit));
    let mut calls = Vec::with_capacity(seen.list.len());
    for visits in jobs.values_mut() {
        visits.sort_by(|a, b| a.start.total_cmp(&b.start));
        for (index, visit) in visits.iter().enumerate() {
            let before =
                index.checked_sub(1).map(|before| visits[before]).filter(|before| before.program != visit.program);
            // A log may have begun in the middle of a job: that came long before what is seen of it first.
            let first =
                || came.get(visit.job.as_str()).filter(|(_, start)| index == 0 && (visit.start - start).abs() <= CLOCK);
            let ready = before.map(|before| before.end).or_else(|| first().map(|(arrival, _)| *arrival));
            let since = ready.unwrap_or(visit.start).min(visit.start);
            calls.push(Call { visit, ready: since, known: ready.is_some() });
        }
    }
    calls
}

/// An operation of a log as scopes see it. A log has no tools, lots and people: what is scoped by them holds nowhere.
pub(super) fn occasion<'a>(shop: &Shop, visits: &'a Visits, visit: &Visit) -> Occasion<'a> {
    let (program, machine) = (&visits.programs[visit.program], &visits.machines[visit.machine]);
    let mut place = Occasion::at(visit.start);
    place.set("machine", machine.as_str());
    place.set("shift", shop.shift(machine, visit.start));
    if let Some((part, operation)) = program.split_once('/') {
        place.set("part", part);
        place.set("operation", operation);
    }
    place
}

/// How long operations occupy a machine.
struct Occupation<'a> {
    shop: &'a Shop,
    seen: &'a Visits,
    /// The file, whose calibration the factors are counted from.
    file: &'a Declarations,
    /// Calibration factors by the name of the parameter.
    factors: BTreeMap<&'a str, f64>,
    stated: Vec<ActingEffect>,
    named: Vec<ActingEffect>,
}

/// An effect as it acts on the time of an operation.
struct ActingEffect {
    id: EffectId,
    /// Whether it follows the recorded overrides.
    as_recorded: bool,
    scope: Scope,
    /// In the display unit of the catalogue.
    size: f64,
}

impl ActingEffect {
    fn named(effect: &NamedEffect) -> Self {
        let WrittenEffect { scope, recorded, .. } = effect.written.clone();
        Self { id: effect.id, as_recorded: recorded.is_some(), scope, size: effect.size }
    }

    fn stated(deviation: &Deviation) -> Self {
        let size = deviation.effect.entry().size.to_display(deviation.size);
        Self {
            id: deviation.effect.into(),
            as_recorded: deviation.recorded.is_some(),
            scope: deviation.scope.clone(),
            size,
        }
    }
}

impl<'a> Occupation<'a> {
    fn new(shop: &'a Shop, visits: &'a Visits, file: &'a Declarations, diagnosis: &'a Diagnosis) -> Self {
        let factors = diagnosis.calibration.iter().map(|own| (own.parameter.as_str(), own.value)).collect();
        let named = diagnosis.effects.iter().map(ActingEffect::named).collect();
        let stated = file.deviations.iter().map(ActingEffect::stated).collect();
        Self { shop, seen: visits, file, factors, stated, named }
    }

    /// Product of the calibrated factors; a constant that the records did not move stays at 1.
    fn factor(&self, constants: &[Constant<'_>]) -> f64 {
        constants.iter().filter_map(|constant| self.factors.get(constant.to_string().as_str())).product()
    }

    /// Time of one operation, s; the same random numbers are drawn with and without effects.
    fn draw(&self, visit: &Visit, with_effects: bool, random: &mut impl Rng) -> f64 {
        let (u, mut stop): (f64, f64) = (random.random(), random.random());
        let (program, machine) = (&self.seen.programs[visit.program], &self.seen.machines[visit.machine]);
        let (Some(nominal), Some(station)) = (self.shop.programs.get(program), self.shop.station(machine)) else {
            // What the nominal shop does not know takes as long as it took.
            return visit.cutting
                + visit.handling
                + visit.setup
                + visit.changes.iter().chain(&visit.holds).sum::<f64>();
        };
        use Constant::{
            Change, ChangeAtMachine, Handling, HandlingAtMachine, HandlingOfProgram, MachineGain, ProgrammedTime,
            ProgrammedTimes,
        };
        let place = occasion(self.shop, self.seen, visit);
        let stated = |constant, value: f64| calibrated(&self.file.calibrations, constant, &place, value);
        let planned = nominal.law.as_ref().map_or(nominal.time, |law| law.quantile(random.random()));
        let time = stated(ShopConstant::ProgrammedTime, planned);
        let time = time * self.factor(&[ProgrammedTimes, ProgrammedTime(program), MachineGain(machine)]);
        let handling = station.handling[(u * station.handling.len() as f64) as usize];
        let handling = stated(ShopConstant::HandlingTime, handling);
        let handling = handling * self.factor(&[Handling, HandlingOfProgram(program), HandlingAtMachine(machine)]);
        let change = stated(ShopConstant::ToolChangeTime, station.tool_change);
        let change = change * self.factor(&[Change, ChangeAtMachine(machine)]);
        let [changes, holds] = [visit.changes.len() as f64, visit.holds.len() as f64];
        let mut all = time + handling + visit.setup + changes * change;
        for effect in self.stated.iter().chain(self.named.iter().filter(|_| with_effects)) {
            if !effect.scope.holds(&place) {
                continue;
            }
            all += match effect.id.shop() {
                Some(ShopEffect::FeedOverride) if effect.as_recorded => time * effect.size * visit.override_excess,
                Some(ShopEffect::FeedOverride) => time * effect.size,
                Some(ShopEffect::OperatorDelay) => effect.size,
                Some(ShopEffect::ToolChangeDelay) => changes * effect.size,
                Some(ShopEffect::FeedHold) => holds * effect.size,
                None if effect.id == EffectId::AXIS_ACCELERATION => nominal.feed_speeds * effect.size,
                Some(ShopEffect::MicroStops) => {
                    // Poisson by inversion, sizes in the display unit 1/h.
                    let mean = effect.size / 3600.0 * time;
                    let (mut probability, mut stopped) = ((-mean).exp(), 0.0);
                    let mut count = 1.0;
                    while stop > probability && count < 20.0 {
                        stop -= probability;
                        probability *= mean / count;
                        count += 1.0;
                        stopped -= MICRO_STOP * (1.0 - random.random::<f64>()).ln();
                    }
                    stopped
                }
                // Neither occupies a machine longer: lives of edges and breakdowns are those of the log.
                Some(ShopEffect::ToolChangePolicy | ShopEffect::BreakdownShape) => 0.0,
                None => unreachable!("{} is no effect of a shop's log", effect.id),
            };
        }
        all
    }
}

fn fit(
    visits: &Visits,
    pool: &[usize],
    calls: &[&Call<'_>],
    scored: &[usize],
    model: &Occupation<'_>,
    with_effects: bool,
    seed: u64,
) -> QueueFit {
    let mut waits: Vec<Vec<f64>> = vec![Vec::with_capacity(REPLICATIONS); calls.len()];
    for replication in 0..REPLICATIONS {
        let mut free = vec![f64::NEG_INFINITY; pool.len()];
        for (index, call) in calls.iter().enumerate() {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream((replication * calls.len() + index) as u64);
            let start = |server: usize| visits.working(pool[server], call.ready.max(free[server]));
            let server = (0..pool.len()).min_by(|a, b| start(*a).total_cmp(&start(*b))).unwrap_or(0);
            let begun = start(server);
            free[server] = visits.worked(pool[server], begun, model.draw(call.visit, with_effects, &mut random));
            waits[index].push(begun - call.ready);
        }
    }
    let mut random = ChaCha8Rng::seed_from_u64(seed.wrapping_add(1));
    let mut days = Days::default();
    let mut others = vec![Days::default(); REPLICATIONS];
    let mut sums: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
    let mut probabilities = Vec::with_capacity(scored.len());
    for place in scored {
        let (call, replicated) = (calls[*place], &waits[*place]);
        let day = (call.ready / DAY).floor() as i64;
        let recorded = call.visit.start - call.ready;
        let u = rank(recorded, replicated, 0.0, random.random());
        days.add(day, u);
        let mean = replicated.iter().sum::<f64>() / REPLICATIONS as f64;
        let of_day = sums.entry(day).or_default();
        *of_day = (of_day.0 + recorded.max(0.0), of_day.1 + mean);
        probabilities.push(u);
        for (replication, wait) in replicated.iter().enumerate() {
            // Among the others: itself is one of those that are equal.
            others[replication].add(day, rank(*wait, replicated, 1.0, random.random()));
        }
    }
    probabilities.sort_by(f64::total_cmp);
    let all = probabilities.len() as f64;
    let area = probabilities.iter().enumerate().map(|(i, u)| ((i as f64 + 0.5) / all - u).abs()).sum::<f64>() / all;
    QueueFit {
        mean: sums.values().map(|own| own.1).sum::<f64>() / scored.len() as f64,
        score: days.score(),
        area,
        days: sums.into_values().collect(),
        scores: others.iter().map(Days::score).collect(),
    }
}

/// Probability of a wait among replicated ones, of which `own` are the wait itself; `chance` (0 to 1) decides
/// among equals. The control knows times to half a second.
fn rank(wait: f64, replicated: &[f64], own: f64, chance: f64) -> f64 {
    let below = replicated.iter().filter(|other| **other < wait - CLOCK).count() as f64;
    let same = replicated.iter().filter(|other| (**other - wait).abs() <= CLOCK).count() as f64 - own;
    (below + chance * (same + 1.0)) / (replicated.len() as f64 - own + 1.0)
}

/// Sums and numbers of normal scores by day.
#[derive(Clone, Debug, Default)]
struct Days(BTreeMap<i64, (f64, f64)>);

impl Days {
    fn add(&mut self, day: i64, probability: f64) {
        let sums = self.0.entry(day).or_default();
        *sums = (sums.0 + normal_score(probability), sums.1 + 1.0);
    }

    /// Mean over the days over its standard error.
    fn score(&self) -> f64 {
        let means: Moments = self.0.values().map(|(sum, count)| sum / count).collect();
        means.mean() / means.standard_error()
    }
}
