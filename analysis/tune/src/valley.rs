//! Tests of the search on a made-up shop whose costs and lost edges are known.

use super::axis::{Axis, Reference};
use super::field::Field;
use super::trial::{Asked, Run, Search};
use std::collections::BTreeMap;
use std::path::Path;
use toolroom_scenario::{PolicyRule, TuneRequest};
use toolroom_scenario_file::read;

/// Edges that end in a replication, about those of two shifts of three lathes.
const EDGES: u32 = 70;
/// Deviation of a replication, for all settings together and for each alone, as of a shop of rings.
const NOISE: (f64, f64) = (1.2, 1.3);

/// Numbers that look random, the same on every machine.
struct Mixed(u64);

impl Mixed {
    fn of(words: impl IntoIterator<Item = u64>) -> Self {
        Self(words.into_iter().fold(0x9E37_79B9_7F4A_7C15, |state, word| {
            let mixed = (state ^ word).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            (mixed ^ (mixed >> 29)).wrapping_mul(0x94D0_49BB_1331_11EB) ^ (mixed >> 32)
        }))
    }

    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Cost and share of lost edges over positions in steps of the first grid.
struct Valley {
    cost: fn(&[f64]) -> f64,
    lost: fn(&[f64]) -> f64,
    guard: Option<f64>,
}

/// What one search found: by how much of itself the least cost within the guard is exceeded, and the true share of lost edges.
struct Found {
    loss: f64,
    lost: f64,
}

impl Valley {
    /// The settings found with this seed.
    fn searched(&self, seed: u64, budget: u32) -> Found {
        let rule = PolicyRule::default();
        let axes = Axis::all(&rule, Reference { speed: 40.0 / 60.0, wear_limit: 0.6e-3, life: None });
        let scenario = read(Path::new("../../scenarios/demo.toml"), &[]).expect("a scenario").scenario;
        let request = TuneRequest { budget, failure: self.guard, ..TuneRequest::default() };
        // Positions on the grid that the search begins with, whatever it is extended by.
        let scale = axes.clone();
        let at = |values: &[f64]| -> Vec<f64> {
            scale.iter().zip(values).map(|(axis, value)| axis.position(*value)).collect()
        };
        let simulate = |asked: &Asked<'_>| {
            let place = at(&asked.point.values);
            let replication = u64::from(asked.replication);
            let shared = NOISE.0 * Mixed::of([seed, replication]).normal();
            let own = asked.point.values.iter().map(|value| value.to_bits());
            let mut own = Mixed::of([seed, replication].into_iter().chain(own));
            let objective = (self.cost)(&place) + shared + NOISE.1 * own.normal();
            let share = (self.lost)(&place);
            let failed = (0..EDGES).filter(|_| own.uniform() < share).count() as u32;
            Ok(Some(Run { objective, edges: EDGES, collapsed: 0, failed }))
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        let search = Search {
            scenario: &scenario,
            request: &request,
            simulate: &simulate,
            sign: 1.0,
            scale: 1.0,
            pool: &pool,
            progress: &|_| (),
            known: BTreeMap::new(),
            journal: None,
        };
        let mut field = Field::new(&search, rule, axes, budget);
        field.tune().expect("settings");
        let best = &field.points[field.known()[0]];
        let place = at(&best.values);
        let (least, lost) = (self.least(), (self.lost)(&place));
        Found { loss: (self.cost)(&place) / least - 1.0, lost }
    }

    /// Least cost that the guard allows.
    fn least(&self) -> f64 {
        let places = (-100..=400).flat_map(|i| (-100..=300).map(move |j| [f64::from(i) / 50.0, f64::from(j) / 50.0]));
        let allowed = places.filter(|at| (self.lost)(at) <= self.guard.unwrap_or(1.0));
        allowed.map(|at| (self.cost)(&at)).fold(f64::INFINITY, f64::min)
    }

    /// Searches with different seeds.
    fn all(&self, searches: u64, budget: u32) -> Vec<Found> {
        (0..searches).map(|seed| self.searched(seed, budget)).collect()
    }
}

/// A valley of a quarter and a third of a EUR a squared step around the middle of the grid.
fn valley(at: &[f64]) -> f64 {
    let (x, y) = (at[0] - 2.6, at[1] - 2.1);
    34.0 + 0.25 * x * x + 0.35 * y * y + 0.2 * x * y
}

/// A valley whose floor is flat along one setting, and near an end of the grid: the whole grid of it costs no more than 2 %, as the
/// shadow price of the shop of rings does.
fn flat(at: &[f64]) -> f64 {
    let (x, y) = (at[0] - 0.6, at[1] - 1.6);
    33.7 + if x > 0.0 { 0.033 } else { 0.1 } * x * x + 0.25 * y * y + 0.05 * x * y
}

/// A valley that is flat along one setting, in the middle of the grid.
fn even(at: &[f64]) -> f64 {
    let (x, y) = (at[0] - 2.6, at[1] - 2.1);
    34.0 + 0.03 * x * x + 0.3 * y * y + 0.08 * x * y
}

/// A valley with one wall steeper than the other.
fn skewed(at: &[f64]) -> f64 {
    let (x, y) = (at[0] - 2.0, at[1] - 1.6);
    34.0 + 3.6 * ((0.25 * x).exp() - 1.0 - 0.25 * x) + 0.3 * y * y + 0.1 * x * y
}

/// A valley with kinks of 0.125 EUR along the setting of the change, as edges that are changed between passes make them.
fn kinked(at: &[f64]) -> f64 {
    let (x, y) = (at[0] - 2.6, at[1] - 2.1);
    34.0 + 0.12 * x * x + 0.3 * y * y + 0.15 * x * y + 0.25 * ((1.7 * at[1]).rem_euclid(1.0) - 0.5).abs()
}

/// Shares of lost edges that grow along both settings.
fn lost(at: &[f64]) -> f64 {
    (0.27 + 0.03 * at[0] + 0.04 * (at[1] - 2.1)).sin().powi(2)
}

#[test]
fn a_guard_that_excludes_the_floor_of_the_valley_leaves_the_search_at_its_edge() {
    assert!(lost(&[2.6, 2.1]) > 0.115, "the floor is excluded");
    let found = Valley { cost: valley, lost, guard: Some(0.1) }.all(20, 600);
    // One standard deviation on the safe side alone costs a quarter of a per cent here. Where each setting stood by its own
    // count and the finer grid lay around the floor, 25 of 100 searches ended within 1 %, 1.7 % above the least on average.
    let within = found.iter().filter(|found| found.loss <= 0.01).count();
    let mean = found.iter().map(|found| found.loss).sum::<f64>() / found.len() as f64;
    assert!(within >= 18 && mean < 0.006, "{within} of 20 within 1 %, {mean} on average");
    // The guard is a promise of the estimate, not of every search: chance may have it a little wrong.
    assert!(found.iter().all(|found| found.lost < 0.105));
}

#[test]
fn without_a_guard_the_search_ends_at_the_floor_of_the_valley() {
    let found = Valley { cost: valley, lost, guard: None }.all(20, 600);
    let within = found.iter().filter(|found| found.loss <= 0.003).count();
    assert!(within >= 17, "{within} of 20 within 0.3 %");
}

#[test]
fn a_flat_floor_is_found_by_points_far_off() {
    let found = Valley { cost: flat, lost, guard: None }.all(40, 600);
    // Where the surface reached 2.6 steps around the best point and one of the points had to be chosen, 27 of 40 searches ended
    // within 0.3 %, 0.23 % above the least on average. Of 40 searches of which four in five end there
    // 30 are one standard deviation less than are to be expected.
    let within = |share: f64| found.iter().filter(|found| found.loss <= share).count();
    let mean = found.iter().map(|found| found.loss).sum::<f64>() / found.len() as f64;
    assert!(within(0.003) >= 30 && within(0.01) >= 39 && mean < 0.002, "{} {} {mean}", within(0.003), within(0.01));
}

/// `cargo test -p toolroom-tune --lib -- --ignored --nocapture valleys`
#[test]
#[ignore = "three hundred searches"]
#[expect(clippy::print_stdout, reason = "the numbers of a study are read")]
fn searches_on_made_up_valleys() {
    type Cost = fn(&[f64]) -> f64;
    let valleys: [(&str, Cost); 5] =
        [("even walls", valley), ("flat, at an end", flat), ("flat", even), ("skewed", skewed), ("kinked", kinked)];
    for (name, cost) in valleys {
        let found = Valley { cost, lost, guard: None }.all(60, 600);
        let within = |share: f64| found.iter().filter(|found| found.loss <= share).count();
        let mean = found.iter().map(|found| found.loss).sum::<f64>() / found.len() as f64;
        println!(
            "{name}: {:.2} % on average, {} and {} of 60 within 0.3 and 1 %",
            100.0 * mean,
            within(0.003),
            within(0.01)
        );
        assert!(within(0.01) >= 57, "{name}: {} of 60", within(0.01));
    }
}
