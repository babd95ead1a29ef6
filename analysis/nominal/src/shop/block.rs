//! Operations gathered in blocks, and what is measured of a block.

use super::booked::{short_repairs, usual};
use super::figure::{Figure, Figures};
use super::nominal::{Program, Shop};
use super::scaled::Scaled;
use super::stops::{FAR, Pool, SIZES, Shape, Timed, class, lower_deviation};
use super::visit::{Visit, Visits};
use statrs::distribution::{ContinuousCDF, Normal};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use toolroom_scenario::PieceTimes;
use toolroom_statistics::median;

/// Share of outliers to which the difference of both tails is added, so that it has a size to which
/// deviations can refer.
pub const TAIL: f64 = 0.05;
/// Fewest operations that have a shape.
const SHAPED: usize = 8;
/// Fewest operations about whose middle scatter is measured.
const POOLED: usize = 3;
/// Length of a part of the day in which times are pooled, s.
const PART: f64 = 4.0 * 3600.0;
pub(super) const DAY: f64 = 86400.0;
/// Error of a time read from a control, s (the sheet of cycle times).
const CLOCK: f64 = 0.5;
/// Mean and standard deviation of the root of the magnitude of a standard normal number, whose
/// distribution is all but symmetric: `2^(1/4) Γ(3/4)/√π` and `√(√(2/π) − mean²)`.
pub const ROOT_SCORE: (f64, f64) = (0.822_179, 0.349_1);
/// Scatter of a logarithm where too few operations show it and the file says nothing (assumption).
const UNSEEN: f64 = 0.02;
/// Least scatter of a logarithm that is believed (assumption).
const LEAST: f64 = 0.002;

/// Part of a day of one machine and program.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Machine and day.
    pub group: usize,
    /// Machine.
    pub machine: usize,
    /// Program; `None` where the block is of the machine as a whole.
    pub program: Option<usize>,
    /// Shift.
    pub shift: String,
    /// Middle, s.
    pub time: f64,
    /// Measured values, NaN where there are none.
    pub values: Figures,
    /// Their standard deviations by the scatter of single operations, of the logarithm where the
    /// channel is compared so.
    pub deviations: Figures,
    /// Number of single values that each of them stands for; 0 of what is no middle of times.
    pub counts: Figures,
    /// Programmed over actual feed of each operation, less one, ascending; empty where nothing was
    /// overridden.
    pub excesses: Vec<f64>,
    /// Time in cut, s.
    pub cutting: f64,
    /// Short repairs that the file lets expect among its stops (count).
    pub short_repairs: f64,
    /// Class of its number of operations.
    pub class: usize,
    /// Operations about whose middle scatter is measured; 0 of blocks that are no such pool.
    pub pooled: usize,
    /// Share of operations that began with a new edge.
    pub new_edges: f64,
}

/// All blocks, and the scatter of single operations by program.
#[derive(Clone, Debug, Default)]
pub struct Blocks {
    /// Blocks by group and time.
    pub list: Vec<Block>,
    /// Rate of booked short stops that no breakdown explains and that is usual, 1/s of time in cut.
    pub usual_stops: f64,
    /// Names of the groups, `machine day`.
    pub groups: Vec<String>,
    /// Scatter of the logarithm of the time in cut, by program.
    pub scatter: Vec<f64>,
    /// Pools about whose middles that was taken, by program: their block of the list, and how many operations.
    pub pools: Vec<Vec<(usize, usize)>>,
    /// Programmed time, s, by program: the nominal shop's, or the shop's own median.
    pub times: Vec<f64>,
    /// Whether the nominal shop knows the program.
    pub known: Vec<bool>,
    /// Whether times in cut are exact, as in a simulation without scatter, by program.
    pub exact: Vec<bool>,
    /// Where times are normal, by program; `None` where they are taken as they are.
    pub scales: Vec<Option<Arc<Scaled>>>,
    /// Logarithms of single changes of edges, of a block each.
    changes: Vec<Vec<f64>>,
    /// Logarithms of single lives of edges, of a block each.
    lives: Vec<Vec<f64>>,
}

/// Scatter of single values, of which `blocks` are one block each: beside the middle of its block, and where a block is a single value,
/// beside the middle of all. What differs from block to block, which may be a gap, is no scatter of single ones.
fn single(blocks: &[Vec<f64>], scatter: impl Fn(Vec<f64>) -> f64) -> f64 {
    let mean = |block: &Vec<f64>| block.iter().sum::<f64>() / block.len() as f64;
    let middle = median(&mut blocks.iter().map(mean).collect::<Vec<f64>>());
    let beside = |block: &Vec<f64>| -> Vec<f64> {
        let count = block.len() as f64;
        // The mean of a block follows its values: what is left of them is smaller by this.
        let (middle, factor) =
            if block.len() < 2 { (middle, 1.0) } else { (mean(block), (count / (count - 1.0)).sqrt()) };
        block.iter().map(|value| factor * (value - middle)).collect()
    };
    scatter(blocks.iter().flat_map(beside).collect())
}

/// The operations whose times are compared. Pieces of an order that move one by one have one time if that is drawn for the
/// order: they say no more than the first of them. Of several pieces with times of their own only a sum was seen.
fn compared<'a>(shop: &Shop, seen: &'a Visits) -> Vec<&'a Visit> {
    let mut known: BTreeSet<(&str, usize, usize)> = BTreeSet::new();
    let mut compared = Vec::new();
    for visit in &seen.list {
        let plain = shop.programs.get(&seen.programs[visit.program]).filter(|program| program.law.is_some());
        let says_something = match plain.map(|program| program.pieces) {
            None | Some(PieceTimes::OfBatch) => true,
            Some(PieceTimes::Own) => visit.pieces <= 1.0,
            Some(PieceTimes::Alike | PieceTimes::Together) => {
                visit.order.is_empty() || known.insert((&visit.order, visit.program, visit.machine))
            }
        };
        compared.extend(says_something.then_some(visit));
    }
    compared
}

/// How pieces share the time of a program; of one that the file does not know they are taken as alike.
fn pieces_of(program: Option<&Program>) -> PieceTimes {
    program.map_or(PieceTimes::Alike, |program| program.pieces)
}

/// Time in cut of a piece, s, at full feed where asked, so that what is left of its scatter is not the override's: where the
/// file gives the times of the program a distribution, on the scale on which they are normal.
fn piece_time(shop: &Shop, seen: &Visits, visit: &Visit, full_feed: bool) -> f64 {
    let program = shop.programs.get(&seen.programs[visit.program]);
    let slower = if full_feed { 1.0 + visit.override_excess } else { 1.0 };
    let time = visit.cutting / slower / visit.times(pieces_of(program));
    program.map_or(time, |program| program.normal_time(&seen.machines[visit.machine], time))
}

/// Standard deviation of a median of `count` values over that of one.
fn of_median(count: usize) -> f64 {
    (if count < 3 { 1.0 } else { 1.25 }) / (count as f64).sqrt()
}

/// Splits by a key, in its order.
fn by<K: Ord>(visits: &[&Visit], key: impl Fn(&Visit) -> K) -> BTreeMap<K, Vec<usize>> {
    let mut split: BTreeMap<K, Vec<usize>> = BTreeMap::new();
    visits.iter().enumerate().for_each(|(at, visit)| split.entry(key(visit)).or_default().push(at));
    split
}

impl Block {
    /// Factor on the median time in cut if operations are slower by `share` times their override.
    pub fn slowed(&self, share: f64) -> f64 {
        if self.excesses.is_empty() {
            return 1.0;
        }
        median(&mut self.excesses.iter().map(|excess| 1.0 + share * excess).collect::<Vec<f64>>())
    }

    /// Mean of the excesses.
    pub fn mean_excess(&self) -> f64 {
        self.excesses.iter().sum::<f64>() / self.excesses.len().max(1) as f64
    }
}

impl Blocks {
    /// Blocks of everything that was seen.
    pub fn of(shop: &Shop, seen: &Visits) -> Self {
        let visits = compared(shop, seen);
        let day = |time: f64| (time / DAY).floor() as i64;
        let shift = |visit: &Visit| shop.shift(&seen.machines[visit.machine], visit.start);
        let mut blocks = Self::default();
        for (program, name) in seen.programs.iter().enumerate() {
            let runs = || visits.iter().filter(|visit| visit.program == program);
            let nominal = shop.programs.get(name).map(|nominal| nominal.time);
            blocks.known.push(nominal.is_some());
            let measured = median(&mut runs().map(|visit| visit.cutting / visit.pieces).collect::<Vec<f64>>());
            blocks.times.push(nominal.unwrap_or(measured));
            blocks.scales.push(shop.programs.get(name).and_then(|nominal| nominal.scale.clone()));
        }
        let mut index: BTreeMap<(usize, i64), usize> = BTreeMap::new();
        for visit in &visits {
            index.entry((visit.machine, day(visit.start))).or_default();
        }
        for (group, ((machine, day), place)) in index.iter_mut().enumerate() {
            *place = group;
            blocks.groups.push(format!("{} day {}", seen.machines[*machine], day + 1));
        }
        let group = |machine: usize, time: f64| index.get(&(machine, day(time))).copied();
        let pooled = by(&visits, |visit| (visit.machine, day(visit.start), visit.program, shift(visit)));
        // Distances to the middle of the pool, both below and above.
        let mut below: Vec<Vec<f64>> = vec![Vec::new(); seen.programs.len()];
        let mut handled: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        let logarithms = |at: &[usize], time: &dyn Fn(&Visit) -> f64| -> Vec<f64> {
            at.iter().map(|at| time(visits[*at])).filter(|time| *time > 0.0).map(f64::ln).collect()
        };
        let in_cut = |visit: &Visit| piece_time(shop, seen, visit, false);
        let at_full_feed = |visit: &Visit| piece_time(shop, seen, visit, true);
        let handled_in = |visit: &Visit| visit.handling / visit.pieces;
        for ((machine, _, program, _), at) in &pooled {
            let cut = logarithms(at, &at_full_feed);
            let middle = median(&mut cut.clone());
            if cut.len() >= POOLED {
                below[*program].extend(cut.iter().map(|y| middle - y).filter(|d| *d > 0.0));
            }
            let handling = logarithms(at, &handled_in);
            let middle = median(&mut handling.clone());
            handled.entry(*machine).or_default().extend(handling.iter().map(|y| (y - middle).abs()));
        }
        for (program, below) in below.iter_mut().enumerate() {
            let least = LEAST.max(0.5 * CLOCK / blocks.times[program]);
            let count = visits.iter().filter(|visit| visit.program == program).count();
            let pooled = pooled.iter().filter(|((_, _, own, _), at)| *own == program && at.len() >= POOLED);
            let seen_together: usize = pooled.map(|(_, at)| at.len()).sum();
            let scatter = match &blocks.scales[program] {
                // Too few lie beside one another to tell how they scatter: the file does.
                Some(own) if seen_together < SHAPED => own.scale.deviation(),
                None if count < SHAPED => UNSEEN,
                Some(_) | None if below.len() < count / 10 => 0.0, // hardly any two differ
                Some(_) | None => lower_deviation(below),
            };
            blocks.exact.push(scatter < 0.1 * least);
            blocks.scatter.push(scatter.max(least));
        }
        let outliers = outliers(&pooled, &blocks.scatter, &|at| logarithms(at, &at_full_feed));
        let handling_scatter: BTreeMap<usize, f64> =
            handled.iter_mut().map(|(machine, far)| (*machine, (1.4826 * median(far)).max(0.01))).collect();
        let empty = |machine: usize, program: Option<usize>, shift: String, time: f64, group: usize| Block {
            group,
            machine,
            program,
            shift,
            time,
            values: Figures::all(f64::NAN),
            deviations: Figures::all(1.0),
            counts: Figures::all(0.0),
            excesses: Vec::new(),
            cutting: 0.0,
            short_repairs: 0.0,
            class: 0,
            pooled: 0,
            new_edges: 0.0,
        };
        // Where times lie, by parts of the day.
        let part = |visit: &Visit| ((visit.start - 6.0 * 3600.0) / PART).floor() as i64;
        for ((machine, day, _, program), at) in
            by(&visits, |visit| (visit.machine, day(visit.start), part(visit), visit.program))
        {
            let Some(group) = index.get(&(machine, day)).copied() else { continue };
            let pooled_visits: Vec<&Visit> = at.iter().map(|at| visits[*at]).collect();
            let mean = |value: &dyn Fn(&Visit) -> f64| {
                pooled_visits.iter().map(|v| value(v)).sum::<f64>() / pooled_visits.len() as f64
            };
            let mut block = empty(machine, Some(program), shift(pooled_visits[0]), mean(&|v| v.start), group);
            let clock = CLOCK / blocks.times[program];
            block.class = class(pooled_visits.len());
            let mut cut = logarithms(&at, &in_cut);
            block.values[Figure::CuttingTime] = median(&mut cut).exp();
            block.counts[Figure::CuttingTime] = cut.len() as f64;
            block.deviations[Figure::CuttingTime] = of_median(cut.len()) * blocks.scatter[program].hypot(0.3 * clock);
            let mut handling = logarithms(&at, &handled_in);
            if !handling.is_empty() {
                block.values[Figure::HandlingTime] = median(&mut handling).exp();
                block.counts[Figure::HandlingTime] = handling.len() as f64;
                block.deviations[Figure::HandlingTime] = of_median(handling.len()) * handling_scatter[&machine];
            }
            if pooled_visits.iter().any(|visit| visit.override_excess > 0.0) {
                block.excesses = pooled_visits.iter().map(|visit| visit.override_excess).collect();
                block.excesses.sort_by(f64::total_cmp);
            }
            block.new_edges = mean(&|v| f64::from(u8::from(v.new_edge)));
            blocks.list.push(block);
        }
        // How times scatter, by shifts.
        for ((machine, day, program, shift), at) in &pooled {
            let Some(group) = index.get(&(*machine, *day)).copied() else { continue };
            let pooled_visits: Vec<&Visit> = at.iter().map(|at| visits[*at]).collect();
            let time = pooled_visits.iter().map(|visit| visit.start).sum::<f64>() / pooled_visits.len() as f64;
            let mut block = empty(*machine, Some(*program), shift.clone(), time, group);
            let count = pooled_visits.len() as f64;
            block.class = class(pooled_visits.len());
            block.cutting = pooled_visits.iter().map(|visit| visit.cutting).sum();
            block.short_repairs = short_repairs(shop.station(&seen.machines[*machine]), &pooled_visits);
            block.pooled = pooled_visits.len();
            block.new_edges = pooled_visits.iter().filter(|visit| visit.new_edge).count() as f64 / count;
            if pooled_visits.len() >= SHAPED {
                let scatter = blocks.scatter[*program];
                let shape = Shape::of(&mut logarithms(at, &at_full_feed), scatter);
                block.values[Figure::CuttingTail] = TAIL + shape.tail;
                block.deviations[Figure::CuttingTail] = (outliers[*program].0 / count).sqrt();
                block.values[Figure::CuttingExcess] = shape.excess.exp();
                block.deviations[Figure::CuttingExcess] = outliers[*program].1 / count.sqrt();
                if !blocks.exact[*program] {
                    block.values[Figure::CuttingSpread] = shape.spread;
                }
                block.deviations[Figure::CuttingSpread] = (2.0 * (count - 1.0)).sqrt().recip();
                let handling = logarithms(at, &handled_in);
                if let Some(spread) = shop
                    .station(&seen.machines[*machine])
                    .and_then(|station| normal_spread(&station.handling, &handling))
                {
                    block.values[Figure::HandlingSpread] = spread;
                    block.deviations[Figure::HandlingSpread] = (2.0 * (count - 1.0)).sqrt().recip();
                }
            }
            let stops: usize = pooled_visits.iter().map(|visit| visit.stops.len()).sum();
            block.values[Figure::StopCount] = stops as f64;
            blocks.list.push(block);
        }
        // What belongs to a machine and day as a whole, or to a shift of it.
        for ((machine, day, shift), at) in by(&visits, |visit| (visit.machine, day(visit.start), shift(visit))) {
            let Some(group) = index.get(&(machine, day)).copied() else { continue };
            let pooled_visits: Vec<&Visit> = at.iter().map(|at| visits[*at]).collect();
            let time = pooled_visits.iter().map(|visit| visit.start).sum::<f64>() / pooled_visits.len() as f64;
            let mut block = empty(machine, None, shift, time, group);
            let changes: Vec<f64> = pooled_visits.iter().flat_map(|visit| visit.changes.iter().copied()).collect();
            if !changes.is_empty() {
                blocks.changes.push(changes.iter().map(|change| change.max(CLOCK).ln()).collect());
                block.values[Figure::ToolChangeTime] = median(&mut changes.clone());
                block.counts[Figure::ToolChangeTime] = changes.len() as f64;
                block.deviations[Figure::ToolChangeTime] = of_median(changes.len());
            }
            let holds: Vec<f64> = pooled_visits.iter().flat_map(|visit| visit.holds.iter().copied()).collect();
            if !holds.is_empty() {
                block.counts[Figure::FeedHoldTime] = holds.len() as f64;
                block.values[Figure::FeedHoldTime] = holds.iter().sum::<f64>() / holds.len() as f64;
                block.deviations[Figure::FeedHoldTime] = (holds.len() as f64).sqrt().recip();
            }
            blocks.list.push(block);
        }
        blocks.rare(seen, &group, &empty);
        blocks.scales();
        blocks.usual_stops = usual(
            blocks.list.iter().map(|block| [block.values[Figure::StopCount], block.short_repairs, block.cutting]),
        );
        blocks.list.sort_by(|a, b| a.group.cmp(&b.group).then(a.time.total_cmp(&b.time)));
        blocks.pools = vec![Vec::new(); seen.programs.len()];
        for (row, block) in blocks.list.iter().enumerate() {
            if let (Some(program), true) = (block.program, block.pooled >= POOLED) {
                blocks.pools[program].push((row, block.pooled));
            }
        }
        blocks
    }

    /// Classes of the blocks of a program.
    pub(super) fn classes(&self, program: usize) -> [bool; SIZES] {
        let mut classes = [false; SIZES];
        let of_program = self.list.iter().filter(|block| block.program == Some(program));
        of_program.for_each(|block| classes[block.class] = true);
        classes
    }

    /// A program as its operations were timed, where stops come to its pools like this.
    pub(super) fn timed<'a>(&'a self, program: usize, pools: &'a [Pool]) -> Timed<'a> {
        Timed {
            time: self.times[program],
            deviation: self.scatter[program],
            exact: self.exact[program],
            pools,
            scale: self.scales[program].as_deref().map(|own| &own.scale),
        }
    }

    /// Lives of edges and times between breakdowns, by machine and day of their end.
    fn rare(
        &mut self,
        visits: &Visits,
        group: &dyn Fn(usize, f64) -> Option<usize>,
        empty: &dyn Fn(usize, Option<usize>, String, f64, usize) -> Block,
    ) {
        let mut split: BTreeMap<usize, (usize, f64, Vec<f64>, Vec<f64>)> = BTreeMap::new();
        for (machine, time, life) in &visits.edge_lives {
            if let Some(group) = group(*machine, *time) {
                split.entry(group).or_insert((*machine, *time, Vec::new(), Vec::new())).2.push(life.ln());
            }
        }
        let mut used: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        visits.failure_gaps.iter().for_each(|(machine, _, used_for)| used.entry(*machine).or_default().push(*used_for));
        for (machine, time, used_for) in &visits.failure_gaps {
            let days = &used[machine];
            let mean = days.iter().sum::<f64>() / days.len() as f64;
            if let (Some(group), true) = (group(*machine, *time), days.len() >= 4) {
                // How far from the middle under an exponential distribution of the same mean.
                let score = normal_score(-(-used_for / mean).exp_m1()).abs().sqrt();
                split.entry(group).or_insert((*machine, *time, Vec::new(), Vec::new())).3.push(score);
            }
        }
        for (group, (machine, time, lives, scores)) in split {
            let mut block = empty(machine, None, String::new(), time, group);
            let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
            if !lives.is_empty() {
                block.values[Figure::EdgeLife] = mean(&lives).exp();
                block.deviations[Figure::EdgeLife] = (lives.len() as f64).sqrt().recip();
                self.lives.push(lives);
            }
            if !scores.is_empty() {
                block.values[Figure::FailureInterval] = mean(&scores);
                block.deviations[Figure::FailureInterval] = ROOT_SCORE.1 / (scores.len() as f64).sqrt();
            }
            self.list.push(block);
        }
    }

    /// Scatter of single changes, edges and counts, which only all blocks together show.
    fn scales(&mut self) {
        // The middle of changes is their median, which the far ones do not move; that of lives their mean, which they do.
        let of_changes = single(&self.changes, |left| {
            1.4826 * median(&mut left.iter().map(|value| value.abs()).collect::<Vec<f64>>())
        });
        let of_lives = single(&self.lives, |left| {
            (left.iter().map(|value| value * value).sum::<f64>() / left.len() as f64).sqrt()
        });
        for (figure, scatter, least) in [(Figure::ToolChangeTime, of_changes, 0.01), (Figure::EdgeLife, of_lives, 0.05)]
        {
            let scatter = if scatter.is_finite() { scatter.max(least) } else { least };
            self.list.iter_mut().for_each(|block| block.deviations[figure] *= scatter);
        }
        // Holds last exponentially (assumption), so that one scatters by the mean of all. The mean of the block itself
        // would weigh short blocks most: of n holds the weighted mean would be (n − 2)/n of the true one.
        let held = self.list.iter().filter(|block| block.values[Figure::FeedHoldTime].is_finite());
        let (sum, count) = held.fold((0.0, 0.0), |(sum, count), block| {
            let holds = block.deviations[Figure::FeedHoldTime].powi(-2);
            (sum + holds * block.values[Figure::FeedHoldTime], count + holds)
        });
        let hold = if count > 0.0 { (sum / count).max(CLOCK) } else { CLOCK };
        self.list.iter_mut().for_each(|block| block.deviations[Figure::FeedHoldTime] *= hold);
        let counted = || self.list.iter().filter(|block| block.values[Figure::StopCount].is_finite());
        let (stops, time) =
            counted().fold((0.0, 0.0), |(n, t), block| (n + block.values[Figure::StopCount], t + block.cutting));
        let rate = if time > 0.0 { stops / time } else { 0.0 };
        for block in self.list.iter_mut().filter(|block| block.values[Figure::StopCount].is_finite()) {
            if stops > 0.0 {
                block.deviations[Figure::StopCount] = (rate * block.cutting).max(0.25).sqrt();
            } else {
                // A log that books no stops at all says nothing about them.
                block.values[Figure::StopCount] = f64::NAN;
            }
        }
    }
}

/// Operations of one machine, day, program and shift.
type Pools = BTreeMap<(usize, i64, usize, String), Vec<usize>>;

/// Share of outliers in both tails and root mean square of the excess of single operations over
/// their median, by program; at least those of a normal distribution.
fn outliers(pools: &Pools, scatter: &[f64], logarithms: &dyn Fn(&[usize]) -> Vec<f64>) -> Vec<(f64, f64)> {
    let mut sums = vec![(0.0, 0.0, 0.0); scatter.len()];
    for ((_, _, program, _), at) in pools {
        let cut = logarithms(at);
        let middle = median(&mut cut.clone());
        let (far, squares, count) = &mut sums[*program];
        *far += cut.iter().filter(|y| (*y - middle).abs() > FAR * scatter[*program]).count() as f64;
        *squares += cut.iter().map(|y| (y - middle).exp_m1().powi(2)).sum::<f64>();
        *count += cut.len() as f64;
    }
    let of = |((far, squares, count), scatter): (&(f64, f64, f64), &f64)| {
        let share = if *count > 0.0 { far / count } else { 0.0 };
        let excess = if *count > 0.0 { (squares / count).sqrt() } else { 0.0 };
        // Of a normal distribution the mean less the median scatters by 0.76.
        (share.max(2.0 * TAIL), excess.max(0.76 * scatter))
    };
    sums.iter().zip(scatter).map(of).collect()
}

/// Normal score of a probability, bounded.
pub fn normal_score(probability: f64) -> f64 {
    let normal = Normal::standard();
    normal.inverse_cdf(probability.clamp(1e-5, 1.0 - 1e-5))
}

/// Standard deviation of normal scores of measured times under replicated ones, whose median is
/// brought to that of the measured.
fn normal_spread(replicated: &[f64], measured: &[f64]) -> Option<f64> {
    let middle = replicated.get(replicated.len() / 2)?.ln();
    let constant = replicated.first() == replicated.last();
    if measured.len() < SHAPED || constant {
        return None;
    }
    let level = median(&mut measured.to_vec());
    let count = replicated.len() as f64;
    let score = |y: &f64| {
        let time = (y - level + middle).exp();
        let below = replicated.partition_point(|other| *other < time);
        normal_score((below as f64 + 0.5) / (count + 1.0))
    };
    let scores: Vec<f64> = measured.iter().map(score).collect();
    let mean = scores.iter().sum::<f64>() / scores.len() as f64;
    let variance = scores.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / (scores.len() as f64 - 1.0);
    Some(variance.sqrt().max(0.05))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn the_scatter_of_single_values_is_found_however_many_a_block_has_and_whatever_its_level() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let mut normal = || normal_score(random.random::<f64>());
        let deviation =
            |left: Vec<f64>| (left.iter().map(|value| value * value).sum::<f64>() / left.len() as f64).sqrt();
        for (blocks, count) in [(10, 40), (100, 4), (400, 1)] {
            let mut level = 0.0;
            let days: Vec<Vec<f64>> = (0..blocks)
                .map(|_| {
                    // Where blocks are single values, their levels cannot be told from their scatter.
                    level += if count > 1 { 0.5 } else { 0.0 };
                    (0..count).map(|_| level + 0.3 * normal()).collect()
                })
                .collect();
            let found = single(&days, deviation);
            assert!((found / 0.3 - 1.0).abs() < 0.12, "{blocks} blocks of {count}: {found}");
        }
    }
}
