//! Procedures of output analysis on series that were computed independently.

use std::convert::Infallible;
use toolroom_process::Claim;
use toolroom_statistics::{Batched, MSER_BATCH, Selection, batch_means, mser, paired};

/// The golden ratio less one.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

fn fraction(value: f64) -> f64 {
    value - value.floor()
}

/// A start that decays, a lattice and a slow wave.
fn value(i: u32) -> f64 {
    let i = f64::from(i);
    10.0 + 6.0 * (-i / 60.0).exp() + 4.0 * (fraction(i * GOLDEN) - 0.5) + 1.5 * (i / 37.0).sin()
}

/// System `i` from 0 in replication `r` from 0.
fn system(i: usize, r: u32) -> f64 {
    let (mean, r, i) = ([10.0, 10.4, 10.9, 11.6, 12.0][i], f64::from(r + 1), (i + 1) as f64);
    let own = fraction(std::f64::consts::E.fract() * r * i + 0.1 * i) - 0.5;
    mean + 8.0 * (fraction(r * GOLDEN) - 0.5) + 2.0 * own
}

fn batched(size: u64, values: std::ops::Range<u32>) -> Batched {
    let mut batched = Batched::by(size);
    values.for_each(|i| batched.push(value(i), f64::from(i)));
    batched
}

/// What the procedures give.
pub(crate) fn claims() -> Vec<Claim> {
    let mut claims = Vec::new();
    // Published with seven digits and more.
    let mut add = |claim: &str, source: &str, published, computed| {
        let (claim, source) = (claim.to_owned(), source.to_owned());
        claims.push(Claim { claim, source, published, computed, tolerance: 2e-7 });
    };
    let white = "White, Simulation 69 (1997) 323; the series computed independently";
    if let Some(found) = mser(&[batched(MSER_BATCH, 0..2000)]) {
        add("MSER-5: values that are left out of 2000", white, 100.0, found.values() as f64);
        add("MSER-5: the statistic there", white, 0.003_052_304_394, found.statistic);
        add("MSER-5: mean of the rest", white, 10.034_778_75, found.mean);
    }
    let law = "Law, Simulation Modeling and Analysis (2015), 9.5.3; the series computed independently";
    if let Some(found) = batch_means(&batched(1, 300..2000), 0.95) {
        add("mean of 20 batches", law, 10.020_252_8, found.interval.mean);
        add("half-width of its 95 % interval", law, 0.398_121_141_1, found.interval.half_width);
        add("lag-1 correlation of the batches", law, -0.643_926_460_7, found.correlation);
    }
    let kim = "Kim and Nelson, ACM TOMACS 11 (2001) 251; the values computed independently";
    let five = Selection { systems: 5, indifference: 0.3, confidence: 0.95, least: true, most: 1000 };
    let Ok(found) = five.select(|i, r| Ok::<_, Infallible>(Some(system(i, r))));
    add("selection of the best of five: the constant h²", kim, 11.429_410_77, found.h2);
    add("replications until the best is known", kim, 59.0, found.replications.iter().sum::<u32>().into());
    let sample = |i: usize| (0..20).map(|r| system(i, r)).collect::<Vec<f64>>();
    let bonferroni = "Bonferroni's inequality and Student's t; the values computed independently";
    // Four comparisons with the first together.
    let second = paired(&sample(1), &sample(0), 1.0 - 0.05 / 4.0).difference;
    let fifth = paired(&sample(4), &sample(0), 1.0 - 0.05 / 4.0).difference;
    add("four paired differences together: mean of the first", bonferroni, 0.383_918_4, second.mean);
    add("its half-width", bonferroni, 0.373_275_6, second.half_width);
    add("mean of the fourth", bonferroni, 1.935_673_6, fifth.mean);
    add("its half-width", bonferroni, 0.438_321_6, fifth.half_width);
    claims
}
