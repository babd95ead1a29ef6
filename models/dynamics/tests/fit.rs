//! Fits of synthetic tap tests whose truth is known: accelerometers of white noise, five averages.

use nalgebra::Complex;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::{PI, TAU};
use toolroom_dynamics::{Direction, Fit, FitOptions, ForceTest, Frf, Measurement, Motion, TestedCut, fit};

/// Frequency (Hz), damping ratio, stiffness (N/m), angle of the direction (deg).
type Truth = [f64; 4];

const AVERAGES: u32 = 5;

/// Receptance of a structure in direction `p` over force in direction `q`.
fn receptance(truth: &[Truth], upper: f64, p: usize, q: usize, frequency: f64) -> Complex<f64> {
    let receptance = |[f, zeta, k, angle]: &Truth| {
        let r = frequency / f;
        let (sine, cosine) = angle.to_radians().sin_cos();
        let shape = [cosine, sine];
        shape[p] * shape[q] / k / Complex::new(1.0 - r * r, 2.0 * zeta * r)
    };
    truth.iter().map(receptance).sum::<Complex<f64>>() + if p == q { upper } else { 0.0 }
}

/// A tap test; `noise` is that of the accelerometer over its greatest signal.
fn tap(truth: &[Truth], plane: bool, range: [f64; 2], step: f64, noise: f64, seed: u64) -> Measurement {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let frequencies: Vec<f64> = (0..).map(|i| range[0] + step * f64::from(i)).take_while(|f| *f <= range[1]).collect();
    let upper = 0.02 / truth[0][2];
    let directions = [Direction::X, Direction::Y];
    let pairs = if plane { vec![(0, 0), (0, 1), (1, 0), (1, 1)] } else { vec![(0, 0)] };
    let functions = pairs.into_iter().map(|(p, q)| {
        let clean: Vec<Complex<f64>> = frequencies.iter().map(|f| receptance(truth, upper, p, q, *f)).collect();
        let acceleration = |i: usize| clean[i].norm() * (TAU * frequencies[i]).powi(2);
        let loudest = (0..clean.len()).map(acceleration).fold(0.0, f64::max);
        let ratio = |i: usize| (noise * loudest / acceleration(i)).powi(2);
        let receptance = clean.iter().enumerate().map(|(i, h)| {
            let sd = h.norm() * (ratio(i) / (2.0 * f64::from(AVERAGES))).sqrt();
            let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
            h + Complex::new(sd * draw(), sd * draw())
        });
        Frf {
            response: directions[p],
            force: directions[q],
            motion: Motion::Acceleration,
            receptance: receptance.collect(),
            coherence: Some((0..clean.len()).map(|i| 1.0 / (1.0 + ratio(i))).collect()),
            noise: None,
        }
    });
    Measurement {
        source: "tap".to_owned(),
        functions: functions.collect(),
        frequencies,
        averages: Some(AVERAGES),
        coherence_digit: 1e-9,
        window_decay: 0.0,
        notes: Vec::new(),
    }
}

const TOOL: [Truth; 3] = [[540.0, 0.035, 18e6, 0.0], [1210.0, 0.017, 8.5e6, 0.0], [2240.0, 0.022, 27e6, 0.0]];
const CLOSE: [Truth; 2] = [[902.0, 0.012, 31e6, 0.0], [921.0, 0.014, 19e6, 0.0]];
const SPINDLE: [Truth; 4] =
    [[460.0, 0.04, 35e6, 20.0], [760.0, 0.028, 16e6, 97.0], [1580.0, 0.016, 9.5e6, -11.0], [1660.0, 0.015, 12e6, 80.0]];

#[test]
fn the_modes_of_the_truth_are_found_and_no_others() {
    for seed in 0..4 {
        for (truth, plane, range, step) in [
            (&TOOL[..], false, [100.0, 3200.0], 2.0),
            (&CLOSE[..], false, [300.0, 1600.0], 1.0),
            (&SPINDLE[..], true, [80.0, 3200.0], 4.0),
        ] {
            let found = fit(&tap(truth, plane, range, step, 0.01, seed), &FitOptions::default()).unwrap();
            assert_eq!(found.modes.len(), truth.len(), "{seed} {:?}", found.modes);
            assert!(found.quality.refusals.is_empty(), "{:?}", found.quality.refusals);
            assert!((0.85..1.15).contains(&found.quality.reduced_chi2.unwrap()), "{:?}", found.quality);
            for (mode, [f, zeta, k, angle]) in found.modes.iter().zip(truth) {
                let away =
                    |estimate: toolroom_dynamics::Estimate, truth: f64| (estimate.value - truth).abs() / estimate.sd;
                assert!(away(mode.natural_frequency, *f) < 5.0 && away(mode.damping_ratio, *zeta) < 5.0, "{mode:?}");
                assert!(away(mode.stiffness, *k) < 5.0, "{mode:?}");
                let turned = mode.direction[1].atan2(mode.direction[0]).to_degrees() - angle;
                let turned = (turned / 180.0 - (turned / 180.0).round()).abs() * 180.0;
                assert!(turned <= 5.0 * mode.direction_sd.unwrap_or(0.0).to_degrees() + 1e-9, "{mode:?}");
            }
        }
    }
}

/// In these records noise has hidden one of the two columns of stable poles.
#[test]
fn close_modes_that_share_one_column_are_divided() {
    for seed in [713, 736, 782] {
        let found = fit(&tap(&CLOSE, false, [300.0, 1600.0], 1.0, 0.01, seed), &FitOptions::default()).unwrap();
        assert_eq!(found.modes.len(), 2, "{seed} {:?}", found.modes);
        assert!((0.85..1.15).contains(&found.quality.reduced_chi2.unwrap()), "{seed} {:?}", found.quality);
    }
}

#[test]
fn intervals_cover_the_truth_as_often_as_they_say() {
    let (mut inside, mut all) = (0.0, 0.0);
    for seed in 0..60 {
        let measured = tap(&TOOL, false, [100.0, 3200.0], 4.0, 0.02, 100 + seed);
        let found = fit(&measured, &FitOptions { modes: Some(3), ..FitOptions::default() }).unwrap();
        for (mode, [f, zeta, k, _]) in found.modes.iter().zip(TOOL) {
            for (estimate, truth) in [(mode.natural_frequency, f), (mode.damping_ratio, zeta), (mode.stiffness, k)] {
                inside += f64::from(u8::from((estimate.value - truth).abs() < 1.96 * estimate.sd));
                all += 1.0;
            }
        }
    }
    // 540 intervals of 95 %, nine and nine correlated: the standard error is about one percent.
    assert!((0.92..=0.98).contains(&(inside / all)), "{}", inside / all);
}

#[test]
fn bad_measurements_are_refused_with_their_reason() {
    let code = |measured: &Measurement| {
        let found = fit(measured, &FitOptions::default()).unwrap();
        found.quality.refusals.first().map(|refusal| refusal.code())
    };
    let good = tap(&TOOL, false, [100.0, 3200.0], 2.0, 0.01, 7);
    assert_eq!(code(&good), None);
    let noisy = tap(&TOOL, false, [100.0, 3200.0], 2.0, 2.0, 7);
    assert!(
        fit(&noisy, &FitOptions { modes: Some(2), ..FitOptions::default() }).map_or(true, |found| found
            .quality
            .refusals[0]
            .code()
            == "low-coherence")
    );
    // No line of it is clear, and what the fit leaves is told all the same.
    let of_noise = fit(&noisy, &FitOptions { modes: Some(1), ..FitOptions::default() }).unwrap().quality;
    assert_eq!(of_noise.refusals[0].code(), "low-coherence");
    assert!(of_noise.residuals[0].1 > 0.5, "{:?}", of_noise.residuals);
    assert_eq!(code(&tap(&TOOL, false, [100.0, 1195.0], 2.0, 0.01, 7)), Some("edge-of-range"));
    assert_eq!(code(&tap(&CLOSE, false, [300.0, 1600.0], 8.0, 0.01, 7)), Some("coarse-frequency"));
    let mut turned = good;
    turned.functions[0].receptance.iter_mut().for_each(|value| *value = -*value);
    assert_eq!(code(&turned), Some("sensor-sign"));
}

#[test]
fn responses_across_that_are_noise_alone_do_not_rule_the_fit() {
    // One mode along x and one along y, a fifth of a degree off: what is read across is the noise of the sensors, which
    // is the same for all functions.
    let truth = [[700.0, 0.02, 30e6, 0.2], [900.0, 0.02, 20e6, 90.1]];
    let mut measured = tap(&truth, true, [100.0, 4000.0], 2.0, 0.0, 3);
    let mut random = ChaCha8Rng::seed_from_u64(5);
    for (function, (p, q)) in measured.functions.iter_mut().zip([(0, 0), (0, 1), (1, 0), (1, 1)]) {
        let clean = measured.frequencies.iter().map(|f| receptance(&truth, if p == q { 2e-9 } else { 0.0 }, p, q, *f));
        let share = |(f, h): (&f64, Complex<f64>)| (0.1 / (h.norm() * (TAU * f).powi(2))).powi(2);
        let ratios: Vec<f64> = measured.frequencies.iter().zip(clean.clone()).map(share).collect();
        let noisy = clean.zip(&ratios).map(|(h, ratio)| {
            let sd = h.norm() * (ratio / (2.0 * f64::from(AVERAGES))).sqrt();
            let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
            h + Complex::new(sd * draw(), sd * draw())
        });
        function.receptance = noisy.collect();
        // Of averages, the coherence that is read is hardly below one over their number.
        let read = |ratio: &f64| (1.0 / (1.0 + ratio)).max(0.3 / f64::from(AVERAGES));
        function.coherence = Some(ratios.iter().map(read).collect());
    }
    let found = fit(&measured, &FitOptions::default()).unwrap();
    let frequencies: Vec<f64> = found.modes.iter().map(|mode| mode.natural_frequency.value).collect();
    assert_eq!(frequencies.len(), 2, "{frequencies:?}");
    assert!((frequencies[0] - 700.0).abs() < 1.0 && (frequencies[1] - 900.0).abs() < 1.0, "{frequencies:?}");
    assert!(found.quality.refusals.is_empty(), "{:?}", found.quality);
}

#[test]
fn columns_of_the_wrong_name_are_told() {
    for (written, code, words) in [
        ((|h| Complex::new(h.im, h.re)) as fn(Complex<f64>) -> Complex<f64>, "poor-fit", "part exchanged"),
        (|h| h.conj(), "sensor-sign", "of the other sign"),
    ] {
        let mut measured = tap(&TOOL, false, [100.0, 3200.0], 2.0, 0.01, 1);
        measured.functions[0].receptance.iter_mut().for_each(|value| *value = written(*value));
        match fit(&measured, &FitOptions::default()) {
            Ok(Fit { quality, .. }) => {
                assert_eq!(
                    quality.refusals.first().map(|refusal| refusal.code()),
                    Some(code),
                    "{:?}",
                    quality.refusals
                );
                assert!(quality.warnings()[0].contains(words), "{:?}", quality.warnings());
            }
            // Where no mode is found at all, the mistake is the answer.
            Err(error) => assert!(error.to_string().contains(words), "{error}"),
        }
    }
    let clean = || tap(&TOOL, false, [100.0, 3200.0], 2.0, 0.01, 1);
    let good = fit(&clean(), &FitOptions::default()).unwrap();
    assert!(good.quality.mistaken.is_none() && good.quality.unusual.is_none());
    // Accelerance that is called receptance, 612 Hz and a tenth of the noise: what stands for modes is off in damping and stiffness.
    let mut raw = tap(&TOOL, false, [100.0, 3200.0], 2.0, 0.001, 1);
    for (value, frequency) in raw.functions[0].receptance.iter_mut().zip(&raw.frequencies) {
        *value *= -(TAU * frequency).powi(2);
    }
    let quality = fit(&raw, &FitOptions::default()).unwrap().quality;
    assert!(!quality.refusals.is_empty() && quality.warnings()[0].contains("acceleration over force"), "{quality:?}");
    // Two modes over noise of 0.2 % of their peak: with the columns exchanged no mode at all is found.
    let two = [[612.0, 0.03, 22e6, 0.0], [1180.0, 0.02, 9.6e6, 0.0]];
    let mut exchanged = tap(&two, false, [300.0, 1700.0], 4.0, 1e-4, 5);
    exchanged.functions[0].coherence = None;
    for value in &mut exchanged.functions[0].receptance {
        *value = Complex::new(value.im, value.re);
    }
    match fit(&exchanged, &FitOptions::default()) {
        Ok(found) => assert!(found.quality.warnings()[0].contains("part exchanged"), "{:?}", found.quality),
        Err(error) => assert!(error.to_string().contains("part exchanged"), "{error}"),
    }
    // um/N for mm/N.
    let mut soft = clean();
    soft.functions[0].receptance.iter_mut().for_each(|value| *value *= 1e3);
    let quality = fit(&soft, &FitOptions::default()).unwrap().quality;
    assert!(quality.warnings()[0].contains("is the unit of the response right?"), "{:?}", quality.warnings());
    assert_eq!(quality.verdict(), "usable");
}

#[test]
fn units_of_length_and_force_do_not_matter() {
    let measured = tap(&CLOSE, false, [300.0, 1600.0], 1.0, 0.01, 3);
    let mut scaled = measured.clone();
    scaled.functions[0].receptance.iter_mut().for_each(|value| *value *= 1e6);
    let (one, other) = (fit(&measured, &FitOptions::default()).unwrap(), fit(&scaled, &FitOptions::default()).unwrap());
    for (a, b) in one.modes.iter().zip(&other.modes) {
        assert!((a.natural_frequency.value / b.natural_frequency.value - 1.0).abs() < 1e-8);
        assert!((a.stiffness.value / b.stiffness.value * 1e-6 - 1.0).abs() < 1e-6);
        assert!((a.damping_ratio.sd / b.damping_ratio.sd - 1.0).abs() < 1e-4);
    }
}

/// Nobody knows whether a mode at one frequency in x and y moves along +x +y, along +x −y, or is two: it is one along each.
#[test]
fn taps_in_two_directions_without_a_response_across_are_fitted_along_each() {
    let truth = [[1150.0, 0.03, 11e6, 0.0], [1240.0, 0.03, 9.6e6, 90.0], [1900.0, 0.02, 30e6, 30.0]];
    let apparent = [
        [1150.0, 0.03, 11e6, 0.0],
        [1240.0, 0.03, 9.6e6, 90.0],
        [1900.0, 0.02, 30e6 / 0.75, 0.0],
        [1900.0, 0.02, 30e6 / 0.25, 90.0],
    ];
    for seed in 0..4 {
        let mut measured = tap(&truth, true, [200.0, 3200.0], 2.0, 0.01, seed);
        measured.functions.retain(|function| function.response == function.force);
        let found = fit(&measured, &FitOptions::default()).unwrap();
        assert!(found.quality.refusals.is_empty() && found.quality.unsigned, "{:?}", found.quality);
        assert!((0.85..1.15).contains(&found.quality.reduced_chi2.unwrap()), "{:?}", found.quality);
        agrees(&found, &apparent, &format!("seed {seed}"));
    }
}

/// The modes are those of `truth`, each value within five standard deviations, whatever the order of equal frequencies.
fn agrees(found: &Fit, truth: &[Truth], label: &str) {
    assert_eq!(found.modes.len(), truth.len(), "{label} {:?}", found.modes);
    for [f, zeta, k, angle] in truth {
        let turned = |mode: &toolroom_dynamics::FittedMode| {
            let turned = mode.direction[1].atan2(mode.direction[0]).to_degrees() - angle;
            (turned - 180.0 * (turned / 180.0).round()).abs()
        };
        let away = |estimate: toolroom_dynamics::Estimate, truth: f64| (estimate.value - truth).abs() / estimate.sd;
        let agrees = |mode: &&toolroom_dynamics::FittedMode| {
            away(mode.natural_frequency, *f) < 5.0
                && away(mode.damping_ratio, *zeta) < 5.0
                && away(mode.stiffness, *k) < 5.0
                && turned(mode) <= 5.0 * mode.direction_sd.unwrap_or(0.0).to_degrees() + 1e-9
        };
        assert_eq!(found.modes.iter().filter(agrees).count(), 1, "{label} {f} {angle}: {:?}", found.modes);
    }
}

/// A symmetric spindle has each bending mode twice, in x and y; the response across is noise. Any two directions at right
/// angles would do for equal modes: what counts is the compliance of all directions, which must not be that of one mode at 45
/// degrees.
#[test]
fn equal_modes_in_both_directions_are_two_and_not_one_at_an_angle() {
    let truth = [[900.0, 0.02, 12e6, 0.0], [900.0, 0.02, 12e6, 90.0], [1700.0, 0.03, 25e6, 40.0]];
    for (crossed, seed) in [(true, 1), (true, 2), (true, 3), (false, 1), (false, 2)] {
        let mut measured = tap(&truth, true, [200.0, 2800.0], 2.0, 0.01, seed);
        measured.functions.retain(|function| crossed || function.response == function.force);
        let found = fit(&measured, &FitOptions::default()).unwrap();
        assert!(found.quality.refusals.is_empty(), "{:?}", found.quality);
        let at = 900.0;
        let static_compliance = |p: usize, q: usize| -> f64 {
            let near = found.modes.iter().filter(|mode| (mode.natural_frequency.value / at - 1.0).abs() < 0.05);
            near.map(|mode| mode.direction[p] * mode.direction[q] / mode.stiffness.value).sum()
        };
        let [xx, yy, xy] = [static_compliance(0, 0), static_compliance(1, 1), static_compliance(0, 1)];
        assert!((xx * 12e6 - 1.0).abs() < 0.02 && (yy * 12e6 - 1.0).abs() < 0.02, "{seed} {:?}", found.modes);
        assert!((xy * 12e6).abs() < 0.02, "{crossed} {seed} {:?}", found.modes);
    }
}

/// Close modes in a plane that any single column of poles hides: two references at right angles tell them apart.
#[test]
fn close_modes_in_a_plane_are_told_apart_by_two_references() {
    let truth = [[900.0, 0.02, 12e6, 20.0], [901.5, 0.021, 11e6, 105.0], [1500.0, 0.015, 20e6, -50.0]];
    for seed in 0..3 {
        let measured = tap(&truth, true, [200.0, 2400.0], 2.0, 0.01, 40 + seed);
        let found = fit(&measured, &FitOptions::default()).unwrap();
        assert!((0.85..1.15).contains(&found.quality.reduced_chi2.unwrap()), "{:?}", found.quality);
        agrees(&found, &truth, &format!("seed {seed}"));
    }
}

/// A structure drawn at random with the range and step in which it is measured well: a range from a quarter of the first to one and a
/// half of the last frequency, eight lines and more in the narrowest half-power band.
fn drawn(random: &mut ChaCha8Rng, plane: bool) -> (Vec<Truth>, [f64; 2], f64) {
    let mut uniform = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let count = uniform(1.0, 4.99) as usize;
    let mut frequency = uniform(300.0, 900.0);
    let mut truth = Vec::new();
    for _ in 0..count {
        let angle = if plane { uniform(-90.0, 90.0) } else { 0.0 };
        let zeta = uniform(0.01, 0.045);
        truth.push([frequency, zeta, uniform(5e6, 40e6), angle]);
        // Neighbours are apart by one and a half of their half-power bands at least.
        frequency *= 1.0 + uniform(0.14, 0.8);
    }
    let narrowest = truth.iter().map(|[f, zeta, ..]| 2.0 * zeta * f).fold(f64::INFINITY, f64::min);
    let range = [0.25 * truth[0][0], 1.5 * truth[count - 1][0]];
    (truth, range, (narrowest / 8.0).min(4.0))
}

#[test]
fn a_mode_that_hardly_moves_across_is_found_over_noise() {
    let truth = [[850.0, 0.025, 15e6, 10.0]];
    let at = |noise: f64| tap(&truth, true, [200.0, 2000.0], 2.0, noise, 77).functions;
    let mut measured = tap(&truth, true, [200.0, 2000.0], 2.0, 0.01, 77);
    // The same noise in every response; what they measure goes with the cosine and the sine.
    let sine = 10f64.to_radians().tan();
    for (place, share) in [(1, sine), (2, sine), (3, sine * sine)] {
        measured.functions[place] = at(0.01 / share).swap_remove(place);
    }
    let found = fit(&measured, &FitOptions::default()).unwrap();
    // Noise alone is a great part of what was measured along y.
    let left = found.quality.residuals.iter().find(|(name, _)| name == "yy").unwrap().1;
    assert!(found.quality.refusals.is_empty() && left > 0.15, "{:?} {left}", found.quality.refusals);
    let [x, y] = found.modes[0].direction;
    assert!(found.modes.len() == 1 && (y.atan2(x).to_degrees() - 10.0).abs() < 1.0, "{:?}", found.modes);
}

/// Run as `cargo test -p toolroom-dynamics --test fit -- --ignored --nocapture`; some minutes.
#[test]
#[ignore = "a study of some minutes"]
#[expect(clippy::print_stdout, reason = "the numbers of a study are read")]
fn of_a_hundred_bad_taps_all_are_refused_and_of_a_hundred_good_ones_none() {
    let mut random = ChaCha8Rng::seed_from_u64(20);
    let (mut right, mut refused_good, mut accepted_bad) = (0, Vec::new(), Vec::new());
    let (mut inside, mut all) = (0.0, 0.0);
    for i in 0..100 {
        let plane = i % 4 == 3;
        let (truth, range, step) = drawn(&mut random, plane);
        let noise = 0.002 + 0.018 * random.random::<f64>();
        let measured = tap(&truth, plane, range, step, noise, 5000 + i);
        let found = fit(&measured, &FitOptions::default()).unwrap();
        right += u32::from(found.modes.len() == truth.len());
        if let Some(refusal) = found.quality.refusals.first() {
            refused_good.push((i, refusal.code(), truth.clone()));
        }
        if found.modes.len() == truth.len() {
            for (mode, [f, zeta, k, _]) in found.modes.iter().zip(&truth) {
                let estimates = [(mode.natural_frequency, f), (mode.damping_ratio, zeta), (mode.stiffness, k)];
                for (estimate, truth) in estimates {
                    inside += f64::from(u8::from((estimate.value - truth).abs() < 1.96 * estimate.sd));
                    all += 1.0;
                }
            }
        }
    }
    for i in 0..100 {
        let plane = i % 8 == 7;
        let (truth, range, step) = drawn(&mut random, plane);
        // The mode that limits the cut: the one of the highest peak.
        let soft = |a: &&Truth, b: &&Truth| (a[1] * a[2]).total_cmp(&(b[1] * b[2]));
        let [f, zeta, ..] = *truth.iter().min_by(soft).unwrap();
        let (kind, measured) = match i % 5 {
            0 => ("noise", tap(&truth, plane, range, step, 2.5, 9000 + i)),
            1 => (
                "range",
                tap(&truth, plane, [range[0], f * (1.0 + zeta * (random.random::<f64>() - 0.5))], step, 0.01, 9000 + i),
            ),
            2 => (
                "step",
                tap(&truth, plane, range, 2.0 * zeta * f / (2.0 + 2.0 * random.random::<f64>()), 0.01, 9000 + i),
            ),
            3 => {
                let mut turned = tap(&truth, plane, range, step, 0.01, 9000 + i);
                turned.functions[0].receptance.iter_mut().for_each(|value| *value = -*value);
                ("sign", turned)
            }
            _ => {
                // A part that rattles: the response is not that of a linear structure, and its coherence does not say so.
                let mut rattles = tap(&truth, plane, range, step, 0.01, 9000 + i);
                let phase = 6.3 * random.random::<f64>();
                for function in &mut rattles.functions {
                    for (value, at) in function.receptance.iter_mut().zip(&measured_frequencies(range, step)) {
                        *value *= 1.0 + 0.5 * (TAU * at / (0.37 * zeta * f) + phase).sin();
                    }
                }
                ("rattle", rattles)
            }
        };
        match fit(&measured, &FitOptions::default()) {
            Ok(found) if found.quality.refusals.is_empty() => accepted_bad.push((i, kind, truth.clone())),
            Ok(_) | Err(_) => {}
        }
    }
    println!("modes right in {right} of 100; intervals of 95 % cover {:.3} of {all}", inside / all);
    println!("good ones refused: {refused_good:?}\nbad ones accepted: {accepted_bad:?}");
    assert!(refused_good.is_empty() && accepted_bad.is_empty());
    assert!(right >= 98 && (0.92..=0.98).contains(&(inside / all)), "{right} {}", inside / all);
}

fn measured_frequencies(range: [f64; 2], step: f64) -> Vec<f64> {
    (0..).map(|i| range[0] + step * f64::from(i)).take_while(|f| *f <= range[1]).collect()
}

/// Run as above: 200 taps each of three structures.
#[test]
#[ignore = "a study of some minutes"]
#[expect(clippy::print_stdout, reason = "the numbers of a study are read")]
fn intervals_of_six_hundred_taps_cover_the_truth() {
    for (name, truth, plane, range, step, noise) in [
        ("tool", &TOOL[..], false, [100.0, 3200.0], 4.0, 0.02),
        ("close modes", &CLOSE[..], false, [300.0, 1600.0], 1.0, 0.01),
        ("spindle", &SPINDLE[..], true, [80.0, 3200.0], 4.0, 0.01),
    ] {
        let (mut inside, mut all) = ([0.0; 3], 0.0);
        for seed in 0..200 {
            let found = fit(&tap(truth, plane, range, step, noise, 700 + seed), &FitOptions::default()).unwrap();
            if found.modes.len() != truth.len() {
                println!("{name} {seed}: {} modes", found.modes.len());
                continue;
            }
            for (mode, [f, zeta, k, _]) in found.modes.iter().zip(truth) {
                let estimates = [(mode.natural_frequency, f), (mode.damping_ratio, zeta), (mode.stiffness, k)];
                for (sum, (estimate, truth)) in inside.iter_mut().zip(estimates) {
                    *sum += f64::from(u8::from((estimate.value - truth).abs() < 1.96 * estimate.sd));
                }
                all += 1.0;
            }
        }
        let shares = inside.map(|sum| sum / all);
        println!("{name}: f, zeta, k cover {shares:.3?} of {all}");
        let mean = shares.iter().sum::<f64>() / 3.0;
        assert!((0.92..=0.98).contains(&mean), "{name} {mean}");
    }
}

#[test]
fn intervals_of_force_coefficients_cover_the_truth() {
    // Slots and side cuts of which the mean forces are known: 95 % intervals of six coefficients of 400 tests.
    let mut random = ChaCha8Rng::seed_from_u64(31);
    let (mut inside, mut all) = ([0.0; 6], 0.0);
    for number in 0..400u32 {
        let immersed = [PI, 1.2, 2.0, 0.8][number as usize % 4];
        let cut = TestedCut { teeth: 2 + number % 3, depth: 2e-3, entry: PI - immersed, exit: PI };
        let chip = [600e6 + 3e6 * f64::from(number), 250e6, 120e6];
        let edge = [25e3, 32e3, 2e3];
        let feeds: Vec<f64> = (0..12).map(|i| 0.04e-3 + 0.03e-3 * f64::from(i / 3)).collect();
        let mut forces: [Vec<f64>; 3] = Default::default();
        for feed in &feeds {
            let mean = mean_force(&cut, *feed, chip, edge);
            for (column, mean) in forces.iter_mut().zip(mean) {
                let noise: f64 = StandardNormal.sample(&mut random);
                column.push(mean + 2.0 * noise);
            }
        }
        let test = ForceTest { source: "test".to_owned(), feeds, forces: forces.map(Some) };
        let found = test.identify(&cut).expect("a test of four feeds");
        for (share, (found, truth)) in
            inside.iter_mut().zip(found.chip.iter().chain(&found.edge).zip(chip.iter().chain(&edge)))
        {
            let found = found.expect("a coefficient");
            let quantile = 2.228; // of Student's t with ten degrees of freedom, from a table
            *share += f64::from(u8::from((found.value - truth).abs() <= quantile * found.sd));
        }
        all += 1.0;
    }
    let shares = inside.map(|inside| inside / all);
    // Of 400 intervals of 95 % a share of 92 to 98 % holds the truth with all but one in a hundred seeds.
    assert!(shares.iter().all(|share| (0.92..=0.98).contains(share)), "{shares:?}");
}

/// Mean forces on the tool along feed, normal and axis by quadrature of the forces of a tooth over its arc.
fn mean_force(cut: &TestedCut, feed: f64, [t, r, a]: [f64; 3], [te, re, ae]: [f64; 3]) -> [f64; 3] {
    const STEPS: u32 = 2000;
    let width = (cut.exit - cut.entry) / f64::from(STEPS);
    let mut sum = [0.0; 3];
    for i in 0..STEPS {
        let (s, c) = (cut.entry + width * (f64::from(i) + 0.5)).sin_cos();
        let (tangential, radial, axial) = (t * feed * s + te, r * feed * s + re, a * feed * s + ae);
        let part = [-tangential * c - radial * s, tangential * s - radial * c, axial];
        sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
    }
    sum.map(|sum| sum * width * f64::from(cut.teeth) * cut.depth / (2.0 * PI))
}
