//! Frequency responses and modes from simulated hammer tests of which everything is known.

use nalgebra::Complex;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use std::f64::consts::{PI, TAU};
use toolroom_dynamics::{
    Channel, Direction, DynamicsError, Estimator, FitOptions, HammerOptions, Measurement, Motion, Record, Signal, fit,
    responses,
};

/// Natural frequency (Hz), damping ratio, stiffness (N/m).
type Truth = [f64; 3];
const TOOL: [Truth; 2] = [[612.0, 0.03, 20e6], [1180.0, 0.015, 9e6]];
/// It rings for seconds.
const BAR: [Truth; 1] = [[300.0, 0.002, 5e6]];

const RATE: f64 = 32_000.0;
/// Steps of the integration in a sample.
const STEPS: usize = 8;

/// A squared half sine of force, which has little beyond half the sampling rate: when (s), how long (s), how much (N).
#[derive(Clone, Copy)]
struct Pulse(f64, f64, f64);

impl Pulse {
    fn at(self, time: f64) -> f64 {
        let share = (time - self.0) / self.1;
        if (0.0..=1.0).contains(&share) { self.2 * (PI * share).sin().powi(2) } else { 0.0 }
    }
}

/// The record of some pulses on a structure; `noise` is relative to the greatest acceleration, a tenth of it to the force.
fn record(truth: &[Truth], pulses: &[Pulse], duration: f64, noise: f64, seed: u64) -> Record {
    let count = (duration * RATE) as usize;
    let h = 1.0 / (RATE * STEPS as f64);
    let force = |time: f64| pulses.iter().map(|pulse| pulse.at(time)).sum::<f64>();
    let mut acceleration = vec![0.0; count];
    for [frequency, zeta, k] in truth {
        let w = TAU * frequency;
        // Runge's and Kutta's method of fourth order; a step turns the mode by a few hundredths.
        let slope = |time: f64, [x, v]: [f64; 2]| [v, w * w / k * force(time) - 2.0 * zeta * w * v - w * w * x];
        let ahead = |[x, v]: [f64; 2], [a, b]: [f64; 2], h: f64| [x + h * a, v + h * b];
        let mut state = [0.0; 2];
        for (i, sum) in acceleration.iter_mut().enumerate() {
            *sum += slope(i as f64 / RATE, state)[1];
            for n in 0..STEPS {
                let time = i as f64 / RATE + n as f64 * h;
                let a = slope(time, state);
                let b = slope(time + h / 2.0, ahead(state, a, h / 2.0));
                let c = slope(time + h / 2.0, ahead(state, b, h / 2.0));
                let d = slope(time + h, ahead(state, c, h));
                let mean = [0, 1].map(|j| (a[j] + 2.0 * b[j] + 2.0 * c[j] + d[j]) / 6.0);
                state = ahead(state, mean, h);
            }
        }
    }
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut noisy = |values: Vec<f64>, share: f64| -> Vec<f64> {
        let sd = share * values.iter().map(|value| value.abs()).fold(0.0, f64::max);
        let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
        values.into_iter().map(|value| value + sd * draw()).collect()
    };
    let force: Vec<f64> = (0..count).map(|i| force(i as f64 / RATE)).collect();
    let channel = |signal, values| Channel { signal, direction: Direction::X, values };
    let channels = vec![
        channel(Signal::Force, noisy(force, 0.1 * noise)),
        channel(Signal::Response(Motion::Acceleration), noisy(acceleration, noise)),
    ];
    Record { source: "hits.csv".to_owned(), rate: RATE, channels }
}

/// Five hits, one a second, that last half a millisecond.
fn series() -> Vec<Pulse> {
    [0.2, 1.23, 2.17, 3.21, 4.19]
        .iter()
        .zip([200.0, 260.0, 180.0, 220.0, 240.0])
        .map(|(time, peak)| Pulse(*time, 5e-4, peak))
        .collect()
}

fn receptance(truth: &[Truth], frequency: f64) -> Complex<f64> {
    let receptance = |[f, zeta, k]: &Truth| {
        let r = frequency / f;
        1.0 / k / Complex::new(1.0 - r * r, 2.0 * zeta * r)
    };
    truth.iter().map(receptance).sum()
}

fn measured(record: &Record) -> Measurement {
    responses(record, &HammerOptions::default()).unwrap()
}

#[test]
fn the_response_of_a_noiseless_record_is_that_of_the_structure() {
    let found = measured(&record(&TOOL, &series(), 5.2, 0.0, 1));
    assert_eq!((found.averages, found.window_decay), (Some(5), 0.0));
    let lines = found.frequencies.iter().zip(&found.functions[0].receptance);
    for (frequency, value) in lines.filter(|(frequency, _)| **frequency > 200.0) {
        let truth = receptance(&TOOL, *frequency);
        // What is left of the response at the end of a frame and what folds back from beyond half the sampling rate.
        assert!((value - truth).norm() < 0.01 * truth.norm(), "{frequency}: {value} {truth}");
    }
}

#[test]
fn modes_of_a_noisy_record_are_those_of_the_structure() {
    for seed in 0..5 {
        let measured = measured(&record(&TOOL, &series(), 5.2, 0.003, seed));
        let found = fit(&measured, &FitOptions::default()).unwrap();
        assert_eq!(found.modes.len(), 2, "{seed}: {:?}", found.modes);
        assert!(found.quality.refusals.is_empty(), "{seed}: {:?}", found.quality.refusals);
        for (mode, [frequency, zeta, k]) in found.modes.iter().zip(TOOL) {
            assert!((mode.natural_frequency.value / frequency - 1.0).abs() < 1e-3, "{seed}: {mode:?}");
            assert!((mode.damping_ratio.value / zeta - 1.0).abs() < 0.03, "{seed}: {mode:?}");
            assert!((mode.stiffness.value / k - 1.0).abs() < 0.03, "{seed}: {mode:?}");
        }
    }
}

#[test]
fn the_damping_of_the_window_is_taken_out_again() {
    // Two seconds apart, so that one hit finds nothing of the one before.
    let apart: Vec<Pulse> = series().iter().map(|pulse| Pulse(2.0 * pulse.0, pulse.1, pulse.2)).collect();
    let measured = measured(&record(&BAR, &apart, 10.4, 0.001, 3));
    assert!(measured.window_decay > 0.5, "{}", measured.window_decay);
    let found = fit(&measured, &FitOptions { modes: Some(1), ..FitOptions::default() }).unwrap();
    let [frequency, zeta, k] = BAR[0];
    let mode = found.modes[0];
    assert!((mode.natural_frequency.value / frequency - 1.0).abs() < 1e-4, "{mode:?}");
    assert!((mode.damping_ratio.value / zeta - 1.0).abs() < 0.03, "{mode:?}");
    assert!((mode.stiffness.value / k - 1.0).abs() < 0.02, "{mode:?}");
    // Left in, the damping would be a quarter more at least.
    assert!(measured.window_decay / (TAU * frequency) > 0.25 * zeta);
}

#[test]
fn hits_that_must_not_be_used_are_left_out_with_the_reason() {
    let noted = |record: &Record, words: &str| {
        let found = measured(record);
        assert_eq!(found.averages, Some(4), "{:?}", found.notes);
        assert!(found.notes.iter().any(|note| note.contains(words)), "{words}: {:?}", found.notes);
    };
    let mut rebound = series();
    rebound.push(Pulse(2.178, 5e-4, 20.0));
    noted(&record(&TOOL, &rebound, 5.2, 0.001, 1), "2.170 s is left out: a second pulse of 11 %");
    let mut early = series();
    early[0].0 = 0.0002;
    noted(&record(&TOOL, &early, 5.2, 0.001, 1), "the record begins too late");
    noted(&record(&TOOL, &series(), 4.4, 0.001, 1), "4.190 s is left out: the record ends too early");
    let mut hard = series();
    hard[1].2 = 400.0;
    let mut clipped = record(&TOOL, &hard, 5.2, 0.001, 1);
    clipped.channels[0].values.iter_mut().for_each(|value| *value = value.min(250.0));
    noted(&clipped, "1.230 s is left out: a channel is clipped");
}

#[test]
fn a_soft_hammer_does_not_reach_far() {
    let soft: Vec<Pulse> = series().iter().map(|pulse| Pulse(pulse.0, 2e-3, pulse.2)).collect();
    let soft = record(&TOOL, &soft, 5.2, 0.001, 1);
    // Its spectrum sin(x)/x/(1 − (f T)²) with x = pi f T has lost 20 dB at f T = 1.65.
    let last = *measured(&soft).frequencies.last().unwrap();
    assert!((last - 825.0).abs() < 10.0, "{last}");
    let refused = responses(&soft, &HammerOptions { highest: Some(2000.0), ..HammerOptions::default() });
    let text = refused.unwrap_err().to_string();
    assert!(text.contains("none of 5 hits") && text.contains("20 dB down"), "{text}");
    let hard = record(&TOOL, &series(), 5.2, 0.001, 1);
    let enough = responses(&hard, &HammerOptions { highest: Some(2000.0), ..HammerOptions::default() }).unwrap();
    assert!((enough.frequencies.last().unwrap() - 2000.0).abs() < 3.0);
}

#[test]
fn estimators_lie_on_either_side_of_their_mean() {
    let noisy = record(&TOOL, &series(), 5.2, 0.01, 4);
    let response_by =
        |estimator| responses(&noisy, &HammerOptions { estimator, highest: None }).unwrap().functions[0].clone();
    let (h1, h2, hv) = (response_by(Estimator::H1), response_by(Estimator::H2), response_by(Estimator::Hv));
    for ((a, b), v) in h1.receptance.iter().zip(&h2.receptance).zip(&hv.receptance) {
        assert!(
            a.norm() <= b.norm() * (1.0 + 1e-12) && (v.norm() - (a.norm() * b.norm()).sqrt()).abs() < 1e-12 * v.norm()
        );
    }
    assert_eq!(Estimator::named("hv"), Some(Estimator::Hv));
    assert_eq!(Estimator::named("h3"), None);
}

#[test]
fn one_hit_has_no_coherence_and_a_record_without_hits_no_response() {
    let one = measured(&record(&TOOL, &series()[..1], 1.2, 0.001, 1));
    assert_eq!((one.averages, one.functions[0].coherence.is_none()), (None, true));
    let mut still = record(&TOOL, &[], 1.0, 0.0, 1);
    let text = responses(&still, &HammerOptions::default()).unwrap_err().to_string();
    assert!(text.contains("no hit"), "{text}");
    still.channels.pop();
    assert!(matches!(responses(&still, &HammerOptions::default()), Err(DynamicsError::Record { .. })));
}
