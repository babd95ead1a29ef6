//! Frequency responses and modes from simulated hammer tests of which everything is known.

use nalgebra::Complex;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use toolroom_dynamics::{
    Channel, Direction, DynamicsError, Estimator, FitOptions, HammerOptions, Measurement, Motion, Record, Signal,
    TapOptions, fit, measure, responses,
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

/// A data set 58 of double precision as text: function type, first abscissa and step, ordinate types over each other.
fn data_set(kind: u8, abscissa: [f64; 2], types: [u8; 2], complex: bool, values: &[Complex<f64>]) -> String {
    let [first, step] = abscissa;
    let mut text = format!(
        "    -1\n    58\ntap\nNONE\nNONE\nNONE\nNONE\n{kind:5}{:10}{:5}{:10} {:<10}{:10}{:4} {:<10}{:10}{:4}\n\
         {:10}{:10}{:10}{first:13.5E}{step:13.5E}{:13.5E}\n{:10}    0    0    0 NONE                 NONE\n\
         {:10}    0    0    0 NONE                 NONE\n{:10}    0    0    0 NONE                 NONE\n\
         {:10}    0    0    0 NONE                 NONE\n",
        1,
        1,
        0,
        "TIP",
        1,
        1,
        "TIP",
        1,
        1,
        if complex { 6 } else { 4 },
        values.len(),
        1,
        0.0,
        17,
        types[0],
        types[1],
        0
    );
    for value in values {
        let _ = write!(text, "{:20.12E}", value.re);
        if complex {
            let _ = write!(text, "{:20.12E}", value.im);
        }
        text.push('\n');
    }
    text + "    -1\n"
}

/// Data set 164 with SI units.
const SI: &str = "    -1\n   164\n         1SI: Meter (newton)           2\n  1.0000000000000000D+00  \
                  1.0000000000000000D+00  1.0000000000000000D+00\n  2.7314999999999998D+02\n    -1\n";

#[test]
fn a_record_in_a_universal_file_is_that_of_a_table_whether_hits_are_stored_together_or_each_by_itself() {
    let record = record(&TOOL, &series(), 5.2, 0.0, 1);
    let signal = |channel: usize, samples: std::ops::Range<usize>| {
        let values: Vec<Complex<f64>> =
            record.channels[channel].values[samples].iter().map(|value| Complex::from(*value)).collect();
        data_set(1, [0.0, 1.0 / RATE], [[13, 12][channel], 0], false, &values)
    };
    let read = |text: &str| measure("hits.csv", text.as_bytes(), &TapOptions::default());
    let samples = record.channels[0].values.len();
    let table = measured(&record);
    let together = read(&format!("{SI}{}{}", signal(0, 0..samples), signal(1, 0..samples))).unwrap();
    assert_eq!((together.averages, together.functions.len()), (Some(5), 1));
    for (a, b) in table.functions[0].receptance.iter().zip(&together.functions[0].receptance) {
        assert!((a - b).norm() < 1e-6 * a.norm(), "{a} {b}");
    }
    // Every hit in 0.8 s of its own, force and response in turn.
    let hits: Vec<usize> = [0.2, 1.23, 2.17, 3.21, 4.19].iter().map(|time| ((time - 0.03) * RATE) as usize).collect();
    let each = |i: usize| hits[i]..hits[i] + (0.8 * RATE) as usize;
    let apart: String = (0..5).map(|i| signal(0, each(i)) + &signal(1, each(i))).collect();
    let apart = read(&format!("{SI}{apart}")).unwrap();
    assert_eq!(apart.averages, Some(5));
    for (frequency, value) in apart.frequencies.iter().zip(&apart.functions[0].receptance) {
        let truth = receptance(&TOOL, *frequency);
        assert!(*frequency < 200.0 || (value - truth).norm() < 0.01 * truth.norm(), "{frequency}: {value} {truth}");
    }
    let fault = |text: &str| read(text).unwrap_err().to_string();
    let lost = fault(&format!("{SI}{}{}{}", signal(0, each(0)), signal(1, each(0)), signal(0, each(1))));
    assert!(lost.contains("one channel is stored 2 times and another 1 times"), "{lost}");
    let other = fault(&format!("{SI}{}{}", signal(0, each(0)), signal(1, 0..samples)));
    assert!(other.starts_with("hits.csv:") && other.contains("another sampling rate or number of samples"), "{other}");
    let units = fault(&format!("{}{}", signal(0, each(0)), signal(1, each(0))));
    assert!(units.contains("no data set 164"), "{units}");
}

#[test]
fn spectra_in_a_universal_file_make_the_response_and_its_coherence() {
    let lines: Vec<f64> = (0..400).map(|i| 400.0 + 2.0 * f64::from(i)).collect();
    let accelerance = |frequency: f64| -receptance(&TOOL, frequency) * (TAU * frequency).powi(2);
    // The force has a spectrum that falls; a quarter of the power of the response is noise.
    let force: Vec<f64> = lines.iter().map(|frequency| 3.0 - frequency / 1000.0).collect();
    let cross: Vec<Complex<f64>> = lines.iter().zip(&force).map(|(f, power)| accelerance(*f) * power).collect();
    let response: Vec<f64> = cross.iter().zip(&force).map(|(cross, power)| cross.norm_sqr() / power / 0.75).collect();
    let real = |values: &[f64]| values.iter().map(|value| Complex::from(*value)).collect::<Vec<_>>();
    let set =
        |kind: u8, types: [u8; 2], values: &[Complex<f64>]| data_set(kind, [400.0, 2.0], types, kind == 3, values);
    let (force, response) = (set(2, [13, 0], &real(&force)), set(2, [12, 0], &real(&response)));
    let turned: Vec<Complex<f64>> = cross.iter().map(Complex::conj).collect();
    let read = |text: &str, estimator| {
        let options = TapOptions { hammer: HammerOptions { estimator, highest: None }, ..TapOptions::default() };
        measure("tap.uff", text.as_bytes(), &options)
    };
    for cross in [set(3, [12, 13], &cross), set(3, [13, 12], &turned)] {
        let text = format!("{SI}{force}{response}{cross}");
        for (estimator, factor) in
            [(Estimator::H1, 1.0), (Estimator::H2, 1.0 / 0.75), (Estimator::Hv, 0.75f64.powf(-0.5))]
        {
            let found = read(&text, estimator).unwrap();
            let [function] = &found.functions[..] else { panic!("{found:?}") };
            for (i, frequency) in lines.iter().enumerate() {
                let truth = receptance(&TOOL, *frequency) * factor;
                assert!((function.receptance[i] - truth).norm() < 1e-9 * truth.norm(), "{estimator} {frequency}");
                assert!((function.coherence.as_ref().unwrap()[i] - 0.75).abs() < 1e-9);
            }
            assert!(found.notes[0].contains(&format!("made of spectra ({estimator})")), "{:?}", found.notes);
        }
        let alone = read(&format!("{SI}{force}{cross}"), Estimator::H1).unwrap();
        assert_eq!(alone.functions[0].coherence, None);
        let fault = |text: String, estimator| read(&text, estimator).unwrap_err().to_string();
        let no_force = fault(format!("{SI}{response}{cross}"), Estimator::H1);
        assert!(no_force.contains("the auto spectrum of the force"), "{no_force}");
        assert!(read(&format!("{SI}{response}{cross}"), Estimator::H2).is_ok());
        let no_response = fault(format!("{SI}{force}{cross}"), Estimator::Hv);
        assert!(no_response.contains("the auto spectrum of the response"), "{no_response}");
        let twice = fault(format!("{SI}{force}{force}{response}{cross}"), Estimator::H1);
        assert!(twice.contains("a second auto spectrum"), "{twice}");
    }
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

/// Share of the 95 % intervals of frequency, damping ratio and stiffness that hold the truth, over `draws` of noise on the response
/// of one record, relative to its greatest acceleration; and the greatest decay of a window (1/s).
fn coverage(truth: &[Truth], pulses: &[Pulse], duration: f64, noise: f64, draws: u64) -> (f64, f64) {
    let clean = record(truth, pulses, duration, 0.0, 0);
    let (mut held, mut all, mut decay) = (0, 0, 0.0f64);
    for seed in 0..draws {
        let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
        let mut noisy = clean.clone();
        let response = &mut noisy.channels[1].values;
        let sd = noise * response.iter().map(|value| value.abs()).fold(0.0, f64::max);
        for value in response.iter_mut() {
            let draw: f64 = StandardNormal.sample(&mut random);
            *value += sd * draw;
        }
        let measured = measured(&noisy);
        decay = decay.max(measured.window_decay);
        let options = FitOptions { modes: Some(truth.len()), ..FitOptions::default() };
        for (mode, [frequency, zeta, k]) in fit(&measured, &options).unwrap().modes.iter().zip(truth) {
            let told = [mode.natural_frequency, mode.damping_ratio, mode.stiffness];
            for (estimate, value) in told.into_iter().zip([frequency, zeta, k]) {
                all += 1;
                held += i32::from((estimate.value - value).abs() <= 1.96 * estimate.sd);
            }
        }
    }
    (f64::from(held) / f64::from(all), decay)
}

/// Noise that is left at the end of a frame is no vibration that needs a window: it would spread the noise over the lines, and
/// half of the intervals held the truth.
#[test]
fn intervals_of_noisy_records_hold_the_truth() {
    let pulses = series();
    for noise in [0.003, 0.01, 0.03] {
        let (share, decay) = coverage(&TOOL, &pulses, 5.2, noise, 60);
        assert!(decay == 0.0, "{noise}: {decay} 1/s");
        // 360 intervals: 95 % and three standard errors of 1.1 %.
        assert!((0.915..=0.985).contains(&share), "{noise}: {share}");
    }
    // What rings on beyond its frame under as much noise still has its window.
    let ringing = measured(&record(&[[300.0, 0.002, 5e6]], &pulses, 5.2, 0.01, 1));
    assert!(ringing.window_decay > 1.0, "{}", ringing.window_decay);
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
    // A second hit touches the end of the range with one sample.
    let place =
        clipped.channels[0].values[(4.0 * RATE) as usize..].iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    let place = (4.0 * RATE) as usize + place.unwrap().0;
    clipped.channels[0].values[place] = 250.0;
    assert!(measured(&clipped).notes.iter().any(|note| note.contains("4.190 s is left out: a channel is clipped")));
}

#[test]
fn columns_that_are_exchanged_are_told_by_a_force_that_rings() {
    let mut exchanged = record(&TOOL, &series(), 5.2, 0.001, 1);
    let [force, response] = &mut exchanged.channels[..] else { panic!() };
    std::mem::swap(&mut force.values, &mut response.values);
    let text = responses(&exchanged, &HammerOptions::default()).unwrap_err().to_string();
    assert!(text.contains("whether force and response are exchanged") && text.contains("and 2 more"), "{text}");
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
    // Over the square of the frequency the noise of an accelerometer outgrows every response: those lines tell no misfit.
    assert!(one.notes.iter().any(|note| note.contains("there the response is noise")), "{:?}", one.notes);
    let found = fit(&one, &FitOptions::default()).unwrap();
    assert!(found.quality.refusals.is_empty() && found.quality.reduced_chi2.is_none(), "{:?}", found.quality);
    assert_eq!(found.modes.len(), TOOL.len());
    for (mode, [frequency, zeta, k]) in found.modes.iter().zip(TOOL) {
        assert!((mode.natural_frequency.value / frequency - 1.0).abs() < 1e-3, "{mode:?}");
        assert!((mode.damping_ratio.value / zeta - 1.0).abs() < 0.03, "{mode:?}");
        assert!((mode.stiffness.value / k - 1.0).abs() < 0.03, "{mode:?}");
    }
    let mut still = record(&TOOL, &[], 1.0, 0.0, 1);
    let text = responses(&still, &HammerOptions::default()).unwrap_err().to_string();
    assert!(text.contains("no hit"), "{text}");
    still.channels.pop();
    assert!(matches!(responses(&still, &HammerOptions::default()), Err(DynamicsError::Record { .. })));
}
