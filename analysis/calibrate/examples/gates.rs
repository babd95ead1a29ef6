//! How often intervals cover the truth and choices of a law are right, on sets that the laws themselves made.
//!
//! ```text
//! cargo run --release -p toolroom-calibrate --example gates -- coverage extended_taylor 12 200
//! cargo run --release -p toolroom-calibrate --example gates -- coverage extended_taylor 12 200 wandering
//! cargo run --release -p toolroom-calibrate --example gates -- coverage extended_taylor 12 200 spread=1
//! cargo run --release -p toolroom-calibrate --example gates -- choice 12
//! ```
//! Truths lie 0.8 standard deviations of the prior around its mean. With `spread=1` they are drawn from the prior itself, and
//! intervals of a right inference hold 90 % of them whatever the data tell (simulation-based calibration: S. Talts and others,
//! arXiv 1804.06788); with less they hold more of what the data do not tell.
#![allow(clippy::print_stdout)] // it prints its table

use nalgebra::DVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::collections::BTreeMap;
use toolroom_calibrate::{Choice, Edge, Law, Model, Stretch, Verdict, WearModel, leave_edges_out, maximise, sample};
use toolroom_wear::{Cut, Pair};

/// Wear in mm that stands for readings to come: wear curves are tabulated up to it, since beyond their table they go on at
/// the last rate, which the laws with temperature do not.
const UNREAD: f64 = 1.0;
/// Readings of an edge.
const READINGS: u32 = 10;
/// Correlation time in min of a rate that wanders within lives.
const CORRELATION: f64 = 5.0;
/// Standard deviation of truths around the prior mean, in those of the prior.
const SPREAD: f64 = 0.8;
/// Flank wear in mm at which an edge is worn out and read no more.
const LIMIT: f64 = 0.3;

fn base() -> Pair {
    Pair::named("c45_t15k6").expect("shipped")
}

/// The design: edges over speeds and feeds, not yet read.
fn design(edges: usize, speeds: &[f64]) -> (Vec<Cut>, Vec<Edge>) {
    let feeds = [0.2e-3, 0.3e-3];
    let cut = |index: usize| {
        let speed = speeds[index * speeds.len() / edges];
        Cut::nominal(speed / 60.0, feeds[index % 2], 1.5e-3)
    };
    let conditions: Vec<Cut> = (0..edges).map(cut).collect();
    let edge = |index: usize| {
        let stretches = vec![Stretch::read(index, 1.0, UNREAD); READINGS as usize];
        Edge { name: format!("E{index}"), stretches, life: None, begun: None }
    };
    (conditions, (0..edges).map(edge).collect())
}

/// A truth around the prior mean and the readings that it gives; lives of half a minute to two thousand.
fn made(
    law: Law,
    edges: usize,
    speeds: &[f64],
    spread: f64,
    scatter: Option<(f64, f64)>,
    wanders: bool,
    random: &mut ChaCha8Rng,
) -> (WearModel, DVector<f64>) {
    let (conditions, blank) = design(edges, speeds);
    let model = |edges: Vec<Edge>| {
        let model = WearModel::new(law, &base(), conditions.clone(), edges, LIMIT);
        if wanders { model.with_life_noise(CORRELATION) } else { model }
    };
    loop {
        let empty = model(blank.clone());
        let parameters = empty.parameters();
        let mut truth = DVector::from_iterator(
            parameters.len(),
            parameters.iter().map(|parameter| {
                let z: f64 = StandardNormal.sample(&mut *random);
                parameter.prior.mean + spread * parameter.prior.deviation * z
            }),
        );
        if let Some((edge, reading)) = scatter {
            let last = truth.len() - 1;
            (truth[last - 1], truth[last]) = (edge.ln(), reading.ln());
        }
        let life = |speed: f64| empty.life(truth.as_slice(), Cut::nominal(speed / 60.0, 0.3e-3, 1.5e-3));
        if ![180.0, 320.0].iter().all(|speed| (0.5..2000.0).contains(&life(*speed))) {
            continue;
        }
        // Readings are spread over a life of median level, at most an hour.
        let mut planned = blank.clone();
        for (edge, cut) in planned.iter_mut().zip(&conditions) {
            let total = (1.05 * empty.life(truth.as_slice(), *cut)).min(60.0);
            edge.stretches.iter_mut().for_each(|stretch| stretch.time = total / f64::from(READINGS));
        }
        let planned_model = model(planned.clone());
        for (index, edge) in planned.iter_mut().enumerate() {
            let read = planned_model.replicate(truth.as_slice(), index, random);
            let last = read.iter().position(|wear| *wear >= LIMIT).map_or(read.len(), |place| place + 1);
            edge.stretches.truncate(last);
            edge.stretches.iter_mut().zip(read).for_each(|(stretch, wear)| stretch.wear = Some(wear));
            // Of an edge that has collapsed nothing is left to read.
            if edge.stretches[last - 1].wear.is_some_and(|wear| wear > UNREAD) {
                edge.stretches.truncate(last - 1);
            }
        }
        return (model(planned), truth);
    }
}

fn coverage(law: Law, edges: usize, sets: usize, wanders: bool, spread: f64) {
    let mut random = ChaCha8Rng::seed_from_u64(2026);
    let mut held: BTreeMap<String, usize> = BTreeMap::new();
    let mut fitted = 0;
    for set in 0..sets {
        let (model, truth) = made(law, edges, &[180.0, 220.0, 260.0, 320.0], spread, None, wanders, &mut random);
        let every: Vec<usize> = (0..edges).collect();
        let Some(posterior) = sample(&model, &every, 1000, set as u64) else { continue };
        fitted += 1;
        for (index, parameter) in model.parameters().iter().enumerate() {
            let inside = (posterior.quantile(index, 0.05)..=posterior.quantile(index, 0.95)).contains(&truth[index]);
            *held.entry(parameter.name.clone()).or_default() += usize::from(inside);
        }
    }
    let share = |count: usize, of: usize| 100.0 * count as f64 / of as f64;
    let all: usize = held.values().sum();
    println!(
        "{} {edges} edges, {fitted} of {sets} sets: {:.1} % of 90 % intervals hold the truth",
        law.group(),
        share(all, fitted * held.len())
    );
    held.iter().for_each(|(name, count)| println!("  {name}: {:.1} %", share(*count, fitted)));
}

fn choice(sets: usize) {
    let mut random = ChaCha8Rng::seed_from_u64(2027);
    for speeds in [&[180.0, 220.0, 260.0, 320.0][..], &[220.0]] {
        let (mut right, mut wrong, mut open) = (0, 0, 0);
        for set in 0..sets {
            let truth = Law::ALL[set % Law::ALL.len()];
            let (made, _) = made(truth, 12, speeds, 0.5, Some((0.15, 0.010)), false, &mut random);
            let every: Vec<usize> = (0..12).collect();
            let (conditions, _) = design(12, speeds);
            let candidates: Vec<_> = Law::ALL
                .into_iter()
                .filter_map(|law| {
                    let model = WearModel::new(law, &base(), conditions.clone(), made.measured().to_vec(), LIMIT);
                    let mean = model.parameters().iter().map(|parameter| parameter.prior.mean);
                    let start = DVector::from_iterator(model.parameters().len(), mean);
                    let full = maximise(&model, &every, &start, None)?;
                    Some((law, leave_edges_out(&model, &full, set as u64, &|| ())))
                })
                .collect();
            let choice = Choice::of(&candidates, speeds);
            match (choice.verdict, choice.carried.law == truth) {
                (Verdict::Chosen, true) => right += 1,
                (Verdict::Chosen, false) => wrong += 1,
                (Verdict::CannotTell | Verdict::Given, _) => open += 1,
            }
        }
        println!("{} speed(s), {sets} sets: {right} right, {wrong} wrong, {open} cannot tell", speeds.len());
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, usual: usize| words.get(index).and_then(|word| word.parse().ok()).unwrap_or(usual);
    match words.first().map(String::as_str) {
        Some("choice") => choice(number(1, 12)),
        Some("coverage") => {
            let law = words.get(1).and_then(|word| Law::of_group(word)).unwrap_or(Law::ExtendedTaylor);
            let wanders = words.iter().any(|word| word == "wandering");
            let spread = words.iter().find_map(|word| word.strip_prefix("spread=")?.parse().ok());
            coverage(law, number(2, 12), number(3, 40), wanders, spread.unwrap_or(SPREAD));
        }
        _ => println!("coverage LAW EDGES SETS [wandering] [spread=0.8], or choice SETS"),
    }
}
