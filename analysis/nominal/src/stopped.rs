//! Time lost in short stops, as the shape of recorded cycle times tells it.
//!
//! In the mean short stops that nobody books cannot be told from loading that takes longer or from a program that runs
//! slower: each lengthens cycles, and calibration takes what is lost. Their shape tells them: most cycles are as long as the
//! program and loading say, and some are longer by a stop or two, the more the longer they cut. So the cycle times of operations
//! that should be alike are held against a normal core with stops (a compound Poisson sum, [`Stopped`](crate::compound::Stopped)) and, as rivals,
//! against a core alone that is normal, that has heavy tails or that is skew. Where stops lead clearly, what each operation
//! lost in them is its expectation given how long it took.
//!
//! Not told: stops that come in so many to an operation that their sum has no core left, and stops among fewer than
//! [`FEWEST`] operations. Time that some operations lose for another reason, once in a while and without any order, is taken for stops.

use crate::compound::{FOREIGN, Stopped, normal};
use crate::constants::MAD;
use crate::features::first_of_group;
use std::collections::BTreeMap;
use toolroom_records::Records;
use toolroom_scenario::MICRO_STOP;
use toolroom_statistics::median;

/// Operations that are looked at, at least (count). Source: about thirty cycles give a sharp mode.
const FEWEST: usize = 30;
/// Operations of a pool, at least (count). Assumption: the place of fewer takes all that they say.
const POOL: usize = 4;
/// Operations by which shapes are chosen, at most (count): as many tell them apart for certain. Assumption.
const MOST: usize = 600;
/// Log likelihood by which stops have to lead over every rival (1): that of a further effect (the row "lead" of the rules of
/// the diagnosis), since a rate and a length were fitted for it.
const LEAD: f64 = 8.0;
/// Stops that have to be expected in the operations, at least (count). Assumption: fewer say nothing of a rate.
const STOPS: f64 = 5.0;
/// Standard deviations by which the lost times of neighbours may be alike (1): stops come in no order. Source: one of a thousand
/// orders is beyond it.
const ORDERED: f64 = 3.1;
/// Degrees of freedom of a core with heavy tails (count). Assumption.
const HEAVY: f64 = 4.0;
/// Prior standard deviation of the share by which all programs take longer (1). Assumption: as of every programmed time.
const SLOWER: f64 = 0.05;
/// Prior standard deviation of the logarithm of the mean length of a stop over 20 s (1). Assumption: half to twice as long.
const LENGTH: f64 = std::f64::consts::LN_2;
/// Rounds of the search, at most (count), and the share of its first steps at which it ends (1).
const SEARCH: (usize, f64) = (60, 0.02);

/// Columns of which every level has cycles of its own.
const POOLED: [&str; 5] = ["machine", "part_type", "material", "shift", "operator"];

/// What stops took of every operation.
#[derive(Clone, Debug)]
pub(crate) struct StopTimes {
    /// Expected time in stops of each row, s; not a number where the row was not looked at.
    pub times: Vec<f64>,
    /// Standard deviation about what the rate of stops gives, s.
    pub deviation: f64,
    /// Cycles by which shapes are chosen, and their pools.
    sample: (Vec<Cycle>, usize),
    /// Stops at their best, everywhere.
    stops: Fitted,
    /// Log likelihood of the best core without stops.
    rival: f64,
}

/// An operation: its pool, how much longer it took than its program, the time in cut and that in which stops may come, s.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cycle {
    row: usize,
    pool: usize,
    excess: f64,
    cut: f64,
    exposed: f64,
}

impl StopTimes {
    /// Log likelihood by which stops on the rows for which `on` holds lead over every core without any, beyond what normal
    /// readings of the times in stops say of their rate; zero where they do not lead.
    pub fn lead(&self, on: impl Fn(usize) -> bool) -> f64 {
        let exposed = |cycle: &Cycle| Cycle { exposed: if on(cycle.row) { cycle.cut } else { 0.0 }, ..*cycle };
        let cycles: Vec<Cycle> = self.sample.0.iter().map(exposed).collect();
        let whole: f64 = cycles.iter().map(|cycle| cycle.cut).sum();
        let part: f64 = cycles.iter().map(|cycle| cycle.exposed).sum();
        if part <= 0.0 {
            return 0.0;
        }
        let search = Search::new(&cycles, self.sample.1);
        let mut stops = self.stops.clone();
        if part < whole {
            stops.shape[1] += (whole / part).ln();
            stops = search.searched(stops);
        }
        let explained = |cycle: &Cycle| {
            let (_, mean) = stops.expected(cycle, &search);
            mean * (2.0 * self.times[cycle.row] - mean)
        };
        let by_means = 0.5 * cycles.iter().map(explained).sum::<f64>() / self.deviation.powi(2);
        (stops.density - self.rival - by_means).max(0.0)
    }
}

/// What stops took of the operations of `records`, of which `durations` are the times in cut, s, and `groups` the edges; `None` where
/// their cycle times do not tell of stops.
pub(crate) fn stop_times(records: &Records, groups: &[usize], durations: &[f64]) -> Option<StopTimes> {
    let cycles = cycles(records, groups, durations)?;
    let pools = 1 + cycles.iter().map(|cycle| cycle.pool).max()?;
    let every = cycles.len().div_ceil(MOST);
    let sample: Vec<Cycle> = cycles.iter().copied().step_by(every).collect();
    let search = Search::new(&sample, pools);
    if !search.is_skew() {
        return None;
    }
    let stops = search.best(Core::Stops);
    let mean_cut = search.mean_cut;
    let rivals = [Core::Normal, Core::Heavy, Core::Skew].map(|core| search.best(core).density);
    let rate = stops.shape[1].exp() / mean_cut;
    let rival = rivals.into_iter().fold(f64::NEG_INFINITY, f64::max);
    if stops.density <= rival + LEAD || rate * cycles.iter().map(|cycle| cycle.cut).sum::<f64>() < STOPS {
        return None;
    }
    let mut times = vec![f64::NAN; durations.len()];
    let (mut squares, mut lost) = (0.0, Vec::with_capacity(cycles.len()));
    // A pool of which nothing was looked at has no place.
    for cycle in cycles.iter().filter(|cycle| !search.pools[cycle.pool].is_empty()) {
        let (time, mean) = stops.expected(cycle, &search);
        times[cycle.row] = time;
        squares += (time - mean).powi(2);
        lost.push((cycle.pool, time - mean));
    }
    let deviation = (squares / lost.len() as f64).sqrt();
    (!is_ordered(&lost, deviation)).then(|| StopTimes {
        times,
        deviation,
        sample: (sample.clone(), pools),
        stops,
        rival,
    })
}

/// Operations that should be alike but for stops: by the order of time, without those that begin an edge, that were held or that ran
/// with another override, in pools of [`POOL`] at least.
fn cycles(records: &Records, groups: &[usize], durations: &[f64]) -> Option<Vec<Cycle>> {
    let whole = records.numbers("cycle_time")?;
    let first = first_of_group(groups);
    let is = |column: &str, row: usize, usual: f64| {
        records.numbers(column).is_none_or(|values| !values[row].is_finite() || values[row] == usual)
    };
    let levels: Vec<Vec<usize>> = POOLED.iter().filter_map(|column| Some(records.levels(column)?.1)).collect();
    let mut pools: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    for (row, (cycle, cut)) in whole.iter().zip(durations).enumerate() {
        let alike = first[row] == 0.0 && is("stop_count", row, 0.0) && is("feed_override", row, 1.0);
        if alike && cycle.is_finite() && *cut > 0.0 {
            pools.entry(levels.iter().map(|of_row| of_row[row]).collect()).or_default().push(row);
        }
    }
    let starts = records.numbers("start_time");
    let of_pool = |(pool, mut rows): (usize, Vec<usize>)| {
        if let Some(starts) = starts {
            rows.sort_by(|a, b| starts[*a].total_cmp(&starts[*b]));
        }
        let cycle = move |row: usize| {
            let cut = durations[row];
            Cycle { row, pool, excess: whole[row] - cut, cut, exposed: cut }
        };
        rows.into_iter().map(cycle)
    };
    let kept = pools.into_values().filter(|rows| rows.len() >= POOL).enumerate();
    let cycles: Vec<Cycle> = kept.flat_map(of_pool).collect();
    (cycles.len() >= FEWEST).then_some(cycles)
}

/// Whether neighbours of a pool have lost alike.
fn is_ordered(lost: &[(usize, f64)], deviation: f64) -> bool {
    let pairs = lost.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    let (sum, count) = pairs.fold((0.0, 0.0_f64), |(sum, count), pair| (sum + pair[0].1 * pair[1].1, count + 1.0));
    sum > ORDERED * count.sqrt() * deviation * deviation
}

/// What cycles look like beside their place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Core {
    /// A normal core.
    Normal,
    /// A core with heavy tails: Student's distribution.
    Heavy,
    /// A skew core: a shifted lognormal distribution.
    Skew,
    /// A normal core with stops.
    Stops,
}

/// A core at its best.
#[derive(Clone, Debug)]
struct Fitted {
    core: Core,
    /// Place of each pool, s.
    places: Vec<f64>,
    /// Share by which programs take longer, over [`SLOWER`].
    slower: f64,
    /// Logarithm of the spread, s; logarithms of the mean number of stops of an operation and of their length over 20 s,
    /// or the logarithm of the deviation of the lognormal core.
    shape: [f64; 3],
    /// Greatest log likelihood with priors.
    density: f64,
}

impl Fitted {
    /// Density of an excess `x` beyond the place of its pool, 1/s, of an operation in which stops may come for `exposed` times
    /// the mean time in cut.
    fn density_of(&self, x: f64, exposed: f64) -> f64 {
        let spread = self.shape[0].exp();
        match self.core {
            Core::Normal => normal(x, spread),
            Core::Heavy => {
                // Γ(5/2)/(√(4π) Γ(2)) = 3/8.
                0.375 / spread * (1.0 + (x / spread).powi(2) / HEAVY).powf(-0.5 * (HEAVY + 1.0))
            }
            Core::Skew => {
                // The median lies at the place, the core begins below it.
                let deviation = self.shape[1].exp();
                let beyond = 1.0 + x * deviation / spread;
                if beyond > 0.0 { normal(beyond.ln(), deviation) * deviation / (spread * beyond) } else { 0.0 }
            }
            Core::Stops => Stopped::new(x, exposed * self.shape[1].exp(), self.length(), spread).density,
        }
    }

    fn length(&self) -> f64 {
        MICRO_STOP * self.shape[2].exp()
    }

    /// Log density of a cycle, which something else may have lengthened.
    fn of_cycle(&self, cycle: &Cycle, search: &Search<'_>) -> f64 {
        let x = cycle.excess - self.places[cycle.pool] - SLOWER * self.slower * cycle.cut;
        let own = self.density_of(x, cycle.exposed / search.mean_cut);
        ((1.0 - FOREIGN) * own + FOREIGN * normal(x, search.furthest)).ln()
    }

    /// Expected time in stops of a cycle, and their mean beforehand, s.
    fn expected(&self, cycle: &Cycle, search: &Search<'_>) -> (f64, f64) {
        let x = cycle.excess - self.places[cycle.pool] - SLOWER * self.slower * cycle.cut;
        let count = cycle.exposed / search.mean_cut * self.shape[1].exp();
        (Stopped::new(x, count, self.length(), self.shape[0].exp()).time, count * self.length())
    }

    fn prior(&self) -> f64 {
        let length = if self.core == Core::Stops { self.shape[2] / LENGTH } else { 0.0 };
        -0.5 * (self.slower.powi(2) + length.powi(2))
    }
}

/// Cycles for which the best core of each kind is sought, one number of it after the other.
struct Search<'a> {
    cycles: &'a [Cycle],
    /// Cycles of each pool.
    pools: Vec<std::ops::Range<usize>>,
    middles: Vec<f64>,
    mean_cut: f64,
    /// Scatter by the half below the middles, s.
    below: f64,
    /// Distance of the furthest cycle from the middle of its pool, s.
    furthest: f64,
}

impl<'a> Search<'a> {
    /// Of cycles by their pools; a pool without any has no place.
    fn new(cycles: &'a [Cycle], pools: usize) -> Self {
        let range = |pool: usize| {
            let from = cycles.partition_point(|cycle| cycle.pool < pool);
            from..cycles.partition_point(|cycle| cycle.pool <= pool)
        };
        let pools: Vec<_> = (0..pools).map(range).collect();
        let middle = |range: &std::ops::Range<usize>| {
            let mut all: Vec<f64> = cycles[range.clone()].iter().map(|cycle| cycle.excess).collect();
            if all.is_empty() { 0.0 } else { median(&mut all) }
        };
        let middles: Vec<f64> = pools.iter().map(middle).collect();
        let from_middle = |cycle: &Cycle| cycle.excess - middles[cycle.pool];
        let mut below: Vec<f64> = cycles.iter().map(from_middle).filter(|x| *x < 0.0).map(f64::abs).collect();
        let furthest = cycles.iter().map(|cycle| from_middle(cycle).abs()).fold(0.0, f64::max);
        let least = 1e-3 * furthest.max(1e-3);
        let below = if below.is_empty() { least } else { (MAD * median(&mut below)).max(least) };
        let mean_cut = cycles.iter().map(|cycle| cycle.cut).sum::<f64>() / cycles.len() as f64;
        Self { cycles, pools, middles, mean_cut, below, furthest: furthest.max(below) }
    }

    /// Whether more cycles are far above the middle of their pool than far below it: without that there are no stops.
    fn is_skew(&self) -> bool {
        let far = |sign: f64| {
            let beyond = |cycle: &&Cycle| sign * (cycle.excess - self.middles[cycle.pool]) > 2.0 * self.below;
            self.cycles.iter().filter(beyond).count() as f64
        };
        let [above, below] = [far(1.0), far(-1.0)];
        above > below + (above + below).sqrt()
    }

    /// The best core of a kind, from few stops and from many.
    fn best(&self, core: Core) -> Fitted {
        let start = |spread: f64, number: f64, lower: f64| {
            let places = self.middles.iter().map(|middle| middle - lower).collect();
            self.searched(Fitted {
                core,
                places,
                slower: 0.0,
                shape: [spread.ln(), number.ln(), 0.0],
                density: f64::NEG_INFINITY,
            })
        };
        match core {
            Core::Normal | Core::Heavy => start(self.below, 1.0, 0.0),
            Core::Skew => start(self.below, 0.5, 0.0),
            Core::Stops => {
                let few = start(self.below, 0.2, 0.0);
                let many = start(0.7 * self.below, 1.0, self.below);
                if few.density >= many.density { few } else { many }
            }
        }
    }

    /// A search along one number after the other, with steps that grow where they help and are halved where none does.
    fn searched(&self, start: Fitted) -> Fitted {
        let mut best = start;
        let of_pool = |fitted: &Fitted, pool: usize| {
            self.cycles[self.pools[pool].clone()].iter().map(|cycle| fitted.of_cycle(cycle, self)).sum::<f64>()
        };
        let of_all = |fitted: &Fitted| (0..self.pools.len()).map(|pool| of_pool(fitted, pool)).collect::<Vec<f64>>();
        let mut by_pool = of_all(&best);
        let mut place_steps = vec![0.5 * self.below; self.pools.len()];
        let numbers = match best.core {
            Core::Normal | Core::Heavy => 2,
            Core::Skew => 3,
            Core::Stops => 4,
        };
        let mut steps = [0.5, 0.4, 0.5, 0.4];
        for _ in 0..SEARCH.0 {
            for (pool, step) in place_steps.iter_mut().enumerate() {
                let kept = best.places[pool];
                let tried = [*step, -*step].into_iter().find_map(|own| {
                    best.places[pool] = kept + own;
                    let density = of_pool(&best, pool);
                    (density > by_pool[pool]).then_some((kept + own, density))
                });
                best.places[pool] = kept;
                *step *= if tried.is_some() { 1.4 } else { 0.5 };
                if let Some((place, density)) = tried {
                    (best.places[pool], by_pool[pool]) = (place, density);
                }
            }
            for (number, step) in steps.iter_mut().take(numbers).enumerate() {
                let here = by_pool.iter().sum::<f64>() + best.prior();
                let tried = [*step, -*step].into_iter().find_map(|own| {
                    let mut fitted = best.clone();
                    match number {
                        0 => fitted.slower += own,
                        _ => fitted.shape[number - 1] += own,
                    }
                    let densities = of_all(&fitted);
                    (densities.iter().sum::<f64>() + fitted.prior() > here).then_some((fitted, densities))
                });
                *step *= if tried.is_some() { 1.4 } else { 0.5 };
                if let Some(found) = tried {
                    (best, by_pool) = found;
                }
            }
            let still = steps.iter().take(numbers).all(|step| *step < SEARCH.1)
                && place_steps.iter().all(|step| *step < SEARCH.1 * self.below);
            if still {
                break;
            }
        }
        best.density = by_pool.iter().sum::<f64>() + best.prior();
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Exp, LogNormal, Normal, Poisson, StudentT};
    use toolroom_records::RecordKind;

    /// `count` operations of two machines and two parts in edges of fourteen, with `hourly` stops in an hour of cutting and
    /// `rest` beside; and the stops that came, s.
    fn table(
        count: usize,
        hourly: f64,
        rest: impl Fn(&mut ChaCha8Rng, usize) -> f64,
        seed: u64,
    ) -> (Records, Vec<usize>, Vec<f64>, Vec<f64>) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (mut cuts, mut cycles, mut stops) = (Vec::new(), Vec::new(), Vec::new());
        let (mut machines, mut parts) = (Vec::new(), Vec::new());
        for row in 0..count {
            let part = random.random_range(0..2_usize);
            let cut = (90.0 + 60.0 * part as f64) * (0.9 + 0.2 * random.random::<f64>());
            let number: f64 = if hourly > 0.0 {
                Poisson::new(hourly / 3600.0 * cut).expect("positive").sample(&mut random)
            } else {
                0.0
            };
            let length = Exp::new(1.0 / MICRO_STOP).expect("positive");
            let stopped: f64 = (0..number as usize).map(|_| length.sample(&mut random)).sum();
            cycles.push(cut * 1.03 + 45.0 + stopped + rest(&mut random, row));
            cuts.push(cut);
            stops.push(stopped);
            machines.push(format!("L{}", 1 + row / 14 % 2));
            parts.push(format!("P{part}"));
        }
        let mut records = Records::new(RecordKind::Turning, count);
        records.set_numbers("cycle_time", cycles);
        records.set_texts("machine", machines);
        records.set_texts("part_type", parts);
        (records, (0..count).map(|row| row / 14).collect(), cuts, stops)
    }

    fn normal_rest(random: &mut ChaCha8Rng, _: usize) -> f64 {
        Normal::new(0.0, 2.0).expect("finite").sample(random)
    }

    #[test]
    fn stops_are_told_with_their_time_from_two_hundred_operations() {
        for (seed, hourly) in [(1, 6.0), (2, 6.0), (3, 12.0), (4, 30.0), (5, 4.0)] {
            let (records, groups, cuts, stops) = table(200, hourly, normal_rest, seed);
            let told = stop_times(&records, &groups, &cuts).unwrap_or_else(|| panic!("{hourly} 1/h, seed {seed}"));
            let known: Vec<usize> = (0..200).filter(|row| told.times[*row].is_finite()).collect();
            assert!(known.iter().all(|row| groups[..*row].last() == groups.get(*row)), "no first operation of an edge");
            let mean = |of: &[f64]| known.iter().map(|row| of[*row]).sum::<f64>() / known.len() as f64;
            let (there, here) = (mean(&stops), mean(&told.times));
            assert!((here / there - 1.0).abs() < 0.15, "{hourly} 1/h, seed {seed}: {here} for {there} s");
        }
    }

    #[test]
    fn nothing_is_told_where_nothing_stops_whatever_the_scatter() {
        type Rest = fn(&mut ChaCha8Rng, usize) -> f64;
        let rests: [(&str, Rest); 6] = [
            ("normal", normal_rest),
            ("heavy", |random, _| 3.0 * StudentT::new(4.0).expect("positive").sample(random)),
            ("skew", |random, _| LogNormal::new(2.7, 0.3).expect("finite").sample(random)),
            ("very skew", |random, _| LogNormal::new(2.5, 0.7).expect("finite").sample(random)),
            ("steps", |random, row| normal_rest(random, row).round()),
            ("later", |random, row| normal_rest(random, row) + if row > 110 { 25.0 } else { 0.0 }),
        ];
        for (name, rest) in rests {
            for seed in 0..8 {
                let (records, groups, cuts, _) = table(200, 0.0, rest, seed);
                let told = stop_times(&records, &groups, &cuts);
                assert!(told.is_none(), "{name}, seed {seed}");
            }
        }
    }

    #[test]
    fn of_thousands_of_operations_no_pool_is_taken_for_stopped() {
        let (mut records, groups, cuts, stops) = table(4000, 6.0, normal_rest, 3);
        // Three operators, and four who have hardly more operations than a pool needs.
        let name =
            |row: usize| if row.is_multiple_of(50) { format!("R{}", row / 50 % 4) } else { format!("O{}", row % 3) };
        let operators = (0..4000).map(name).collect();
        records.set_texts("operator", operators);
        let told = stop_times(&records, &groups, &cuts).expect("stops");
        let known: Vec<usize> = (0..4000).filter(|row| told.times[*row].is_finite()).collect();
        let mean = |of: &[f64]| known.iter().map(|row| of[*row]).sum::<f64>() / known.len() as f64;
        assert!((mean(&told.times) / mean(&stops) - 1.0).abs() < 0.1, "{} {}", mean(&told.times), mean(&stops));
    }

    #[test]
    fn one_delay_an_edge_is_no_stop_and_few_operations_tell_nothing() {
        let first = |random: &mut ChaCha8Rng, row: usize| {
            normal_rest(random, row) + if row.is_multiple_of(14) { 60.0 } else { 0.0 }
        };
        let (records, groups, cuts, _) = table(200, 0.0, first, 1);
        assert!(stop_times(&records, &groups, &cuts).is_none());
        let (records, groups, cuts, _) = table(28, 12.0, normal_rest, 1);
        assert!(stop_times(&records, &groups, &cuts).is_none());
    }
}
