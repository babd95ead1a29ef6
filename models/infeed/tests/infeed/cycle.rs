//! Cycle design against the reference table, against brute force, and on limits that conflict.

use crate::paper::{SIX_DIGITS, close};
use proptest::prelude::*;
use toolroom_form::{Fault, ReadError};
use toolroom_infeed::{
    Cycle, CycleError, CycleFile, CycleLimits, CyclePhase, DressingPlan, Infeed, Input, State, cycle_time_estimate,
    depth_at_temperature, dressing_interval, fastest_cycle, grind_cycle, stiffness_from_k,
};

/// The paper's machine, whose tangential force is 80 of 170 N.
fn paper() -> Infeed {
    let mut grinding = crate::paper::paper();
    grinding.parameters.friction = 80.0 / 170.0;
    grinding
}

fn designed(grinding: &Infeed, input: &Input, limits: &CycleLimits) -> Result<Cycle, CycleError> {
    fastest_cycle(grinding, &State::default(), input, limits)
}

#[test]
fn the_fastest_cycles_are_those_of_the_reference() {
    // Factor of Cp; depth limits in um; rough infeed, finish infeed in um; revolutions of the
    // three phases; time in s; last depth, size error and finish stock in um.
    let rows = [
        (1.00, 5.09197, 1.42426, 4.92105, 1.3, [19, 5, 3], 5.54795, 0.251515, 0.311158, 12.2768),
        (0.75, 8.10285, 2.26642, 7.90833, 1.7, [12, 3, 3], 3.69863, 0.266671, 0.247432, 12.1892),
        (1.25, 3.61039, 1.00985, 3.57692, 1.0, [26, 7, 3], 7.39726, 0.241554, 0.373543, 12.1579),
        (1.50, 2.74754, 0.768505, 2.71471, 0.7, [34, 11, 3], 9.86301, 0.196905, 0.365397, 12.3723),
    ];
    for (coolant_factor, rough_limit, finish_limit, rough, finish, revolutions, time, last, size, finish_stock) in rows
    {
        let input = Input { coolant_factor, ..Input::default() };
        // The reference knows no limit of the removal rate.
        let limits = CycleLimits { material_removal: 1e-2, ..CycleLimits::default() };
        let cycle = designed(&paper(), &input, &limits).expect("feasible");
        close(cycle.rough_depth_limit, rough_limit * 1e-6, SIX_DIGITS);
        close(cycle.finish_depth_limit, finish_limit * 1e-6, SIX_DIGITS);
        assert_eq!(cycle.phases.iter().map(|phase| phase.revolutions).collect::<Vec<_>>(), revolutions);
        assert_eq!(cycle.revolutions, revolutions.iter().sum::<u32>());
        close(cycle.phases[0].infeed_per_rev, rough * 1e-6, SIX_DIGITS);
        close(cycle.phases[1].infeed_per_rev, finish * 1e-6, SIX_DIGITS);
        close(cycle.time, time, SIX_DIGITS);
        close(cycle.last_depth, last * 1e-6, SIX_DIGITS);
        close(cycle.size_error, size * 1e-6, SIX_DIGITS);
        close(cycle.finish_stock, finish_stock * 1e-6, SIX_DIGITS);
        assert_eq!(cycle.course.len(), 1 + cycle.revolutions as usize);
        assert!(cycle.peak_temperature_rise <= 650.0);
    }
}

#[test]
fn the_dressing_interval_is_the_reference() {
    let mut grinding = paper();
    grinding.parameters.dulling_rate = 1.0 / 1.5e-3;
    let (input, limits) = (Input::default(), CycleLimits::default());
    let volume = std::f64::consts::PI * 0.05 * 100e-6;
    close(volume, 15.708e-6, SIX_DIGITS);
    let wheel = |removed_volume| State { removed_volume, ..State::default() };
    let time = |volume| cycle_time_estimate(&grinding, &wheel(volume), &input, &limits, 1e-6);
    let interval = dressing_interval(time, volume, 90.0, 160).expect("feasible");
    for (parts, cycle, mean) in [
        (1, 6.43448, 96.4345),
        (10, 6.99873, 15.7152),
        (20, 7.64676, 11.5343),
        (40, 9.38275, 10.0158),
        (80, 13.4417, 10.724),
        (160, 22.5299, 14.3346),
    ] {
        close(interval.cycle_times[parts - 1], cycle, SIX_DIGITS);
        close(interval.course[parts - 1], mean, SIX_DIGITS);
    }
    assert_eq!(interval.parts, 46);
    close(interval.time_per_part, 9.97766, SIX_DIGITS);
}

/// Whether a cycle, ground by the process itself, keeps every limit.
fn keeps(grinding: &Infeed, input: &Input, limits: &CycleLimits, phases: &[CyclePhase; 3], finish_depth: f64) -> bool {
    let Ok((part, course)) = grind_cycle(grinding, &State::default(), input, phases) else { return false };
    let last = course[course.len() - 1];
    let rough_end = course[phases[0].revolutions as usize];
    let rough = &course[..=phases[0].revolutions as usize];
    let wear =
        grinding.parameters.wheel_wear_ratio * grinding.parameters.work_diameter / grinding.parameters.wheel_diameter;
    let slack = 1.0 + 1e-9;
    rough.iter().all(|point| point.load.temperature_rise <= limits.rough_temperature_rise * slack)
        && phases[1].infeed_per_rev <= finish_depth * (1.0 + wear) * slack
        && phases[1].infeed_per_rev <= phases[0].infeed_per_rev
        && phases[0].infeed_per_rev <= limits.greatest_infeed * slack
        && last.stock_removed - rough_end.stock_removed >= limits.finish_stock / slack
        && last.depth_of_cut <= limits.last_depth.min(limits.roundness_error) * slack
        && last.size_error <= limits.size_error * slack
        && part.stock_removed > 0.0
}

/// Fewest revolutions of any cycle, by trying all of them.
fn brute_force(
    grinding: &Infeed,
    input: &Input,
    limits: &CycleLimits,
    mut lengths: std::ops::RangeInclusive<u32>,
) -> Option<u32> {
    let start = State::default();
    let finish_depth =
        depth_at_temperature(grinding, &start, input, limits.finish_temperature_rise, limits.greatest_infeed).ok()?;
    let settings = (finish_depth / limits.infeed_step * 1.1) as u32;
    lengths.find(|total| {
        (1..=*total).any(|rough| {
            (0..=total - rough).any(|finish| {
                (1..=settings.max(1)).any(|setting| {
                    let finish_infeed = f64::from(setting) * limits.infeed_step;
                    let rough_stock = limits.stock - f64::from(finish) * finish_infeed;
                    let phases = [
                        CyclePhase { infeed_per_rev: rough_stock / f64::from(rough), revolutions: rough },
                        CyclePhase { infeed_per_rev: finish_infeed, revolutions: finish },
                        CyclePhase { infeed_per_rev: 0.0, revolutions: total - rough - finish },
                    ];
                    rough_stock > 0.0 && keeps(grinding, input, limits, &phases, finish_depth)
                })
            })
        })
    })
}

#[test]
fn no_cycle_is_faster_than_the_one_found() {
    let limits = CycleLimits { stock: 30e-6, finish_stock: 6e-6, infeed_step: 0.3e-6, ..CycleLimits::default() };
    let nominal = paper();
    let mut worn = paper();
    worn.parameters.wheel_wear_ratio = 1.0 / 60.0;
    worn.parameters.threshold_force = 6.0;
    let cases = [
        (nominal.clone(), limits),
        (nominal.clone(), CycleLimits { finish_stock: 0.0, ..limits }),
        (nominal.clone(), CycleLimits { size_error: 0.08e-6, ..limits }),
        (nominal, CycleLimits { greatest_infeed: 2.5e-6, rough_temperature_rise: 3000.0, ..limits }),
        (worn, CycleLimits { size_error: 0.6e-6, ..limits }),
    ];
    for (grinding, limits) in cases {
        let cycle = designed(&grinding, &Input::default(), &limits).expect("feasible");
        let fewest = brute_force(&grinding, &Input::default(), &limits, 1..=cycle.revolutions + 1);
        assert_eq!(Some(cycle.revolutions), fewest, "{limits:?}");
    }
}

/// A longer spark-out keeps every limit that a shorter one keeps, so one length below is enough.
#[test]
fn a_long_cycle_cannot_be_a_revolution_shorter() {
    let limits = CycleLimits { stock: 250e-6, infeed_step: 0.4e-6, size_error: 2e-6, ..CycleLimits::default() };
    let mut rubbing = paper();
    rubbing.parameters.system_stiffness = stiffness_from_k(rubbing.parameters.process_stiffness, 0.8);
    let plain = rubbing.clone();
    rubbing.parameters.threshold_force = 8.0;
    for grinding in [plain, rubbing] {
        let cycle = designed(&grinding, &Input::default(), &limits).expect("feasible");
        assert!(cycle.phases[0].revolutions > 32);
        let lengths = cycle.revolutions - 1..=cycle.revolutions;
        assert_eq!(brute_force(&grinding, &Input::default(), &limits, lengths), Some(cycle.revolutions));
    }
}

#[test]
fn limits_that_conflict_are_named() {
    let grinding = paper();
    let (input, limits) = (Input::default(), CycleLimits::default());
    let conflict =
        |grinding: &Infeed, limits: CycleLimits| designed(grinding, &input, &limits).expect_err("a conflict");
    let error = conflict(&grinding, CycleLimits { finish_temperature_rise: 20.0, ..limits });
    assert!(matches!(error, CycleError::FinishBelowStep { .. }), "{error}");
    let error = conflict(&grinding, CycleLimits { stock: 10e-6, ..limits });
    assert!(matches!(error, CycleError::FinishStockBeyondStock { .. }), "{error}");
    assert!(error.to_string().contains("finish_stock = 12 um and stock = 10 um conflict"), "{error}");
    let mut rubbing = grinding.clone();
    rubbing.parameters.threshold_force = 20.0;
    let error = conflict(&rubbing, limits);
    assert!(
        matches!(error, CycleError::SizeBeyondReach { threshold, .. } if (threshold - 0.6448).abs() < 1e-3),
        "{error}"
    );
    rubbing.parameters.threshold_force = 200.0;
    let error = conflict(&rubbing, CycleLimits { rough_temperature_rise: 3000.0, ..limits });
    assert!(matches!(error, CycleError::TooHotAtAnyDepth { limit: "finish_temperature_rise", .. }), "{error}");
    let mut soft = grinding.clone();
    soft.parameters.system_stiffness = 1e4;
    soft.parameters.process_stiffness = 1e10;
    soft.parameters.friction = 0.01;
    let error = conflict(&soft, CycleLimits { rough_temperature_rise: 3000.0, infeed_step: 1e-9, ..limits });
    assert!(matches!(error, CycleError::TooLong { .. }), "{error}");
    let error = conflict(&grinding, CycleLimits { stock: f64::NAN, ..limits });
    assert!(matches!(error, CycleError::Model(_)), "{error}");
    let still = Input { work_rotation_speed: 0.0, ..input };
    assert!(designed(&grinding, &still, &limits).is_err());
}

#[test]
fn an_out_of_round_blank_takes_longer() {
    let limits = CycleLimits { finish_stock: 0.0, stock: 20e-6, ..CycleLimits::default() };
    let round = designed(&paper(), &Input::default(), &limits).expect("feasible");
    let blank = CycleLimits { blank_roundness_error: 2e-3, ..limits };
    let lobed = designed(&paper(), &Input::default(), &blank).expect("feasible");
    assert!(lobed.revolutions > round.revolutions);
    assert!(lobed.roundness_error <= limits.roundness_error);
    // One revolution less would leave 2 mm x 0.553^(n-1) too much.
    let short = f64::from(lobed.revolutions) - 1.0;
    assert!(2e-3 * 0.553f64.powf(short) + lobed.last_depth / 0.553 > limits.roundness_error);
}

const FILE: &str = include_str!("../../../../scenarios/grinding/cycle.toml");

#[test]
fn the_shipped_cycle_file_gives_cycle_and_dressing_interval() {
    let file = CycleFile::parse("cycle.toml", FILE, &[]).expect("a good file").content;
    let cycle = file.fastest_cycle().expect("feasible");
    assert_eq!(cycle.revolutions, 27);
    let [estimate, exact] = file.dressing_intervals().expect("feasible").expect("asked for");
    assert_eq!(estimate.parts, 46);
    // Whole revolutions and the finish infeed above 1 um move the optimum a little.
    assert!((35..60).contains(&exact.parts), "{}", exact.parts);
    assert!((exact.cycle_times[0] - cycle.time).abs() < 1e-12);
    assert!(exact.course.iter().all(|mean| *mean >= exact.time_per_part));
}

#[test]
fn every_fault_of_a_cycle_file_has_its_place() {
    let text = "schema = 2\nparameter_set = \"zb153\"\n[limits]\nstock = \"100 N\"\nstok = 3\nlast_depth = \"5 m\"\n\
                [dressing]\ndressing_time = 90\n";
    let Err(ReadError::Faults(list)) = CycleFile::parse("c.toml", text, &[]) else { panic!("a bad file") };
    let places: Vec<_> = list.problems.iter().map(|problem| list.place(problem)).collect();
    assert_eq!(places.iter().map(|place| place.line).collect::<Vec<_>>(), [1, 2, 4, 5, 6, 8]);
    assert_eq!((places[2].line, places[2].column), (4, 14));
    assert!(matches!(list.problems[3].fault, Fault::UnknownKey { nearest: Some("stock"), .. }));
    assert!(list.to_string().starts_with("c.toml:1:10: schema = 2 is not known"), "{list}");
    assert!(CycleFile::parse("c.toml", "schema = 1\nlimit = 3\n", &[]).is_err());
    let plain = CycleFile::parse("c.toml", "schema = 1\n[dressing]\n", &[]).expect("a good file").content;
    assert_eq!(plain.dressing, Some(DressingPlan::default()));
}

#[test]
fn single_values_and_effects_are_replaced() {
    let set = ["limits.stock=50 um", "dressing.most_parts=7", "effects.threshold_force=20 N"].map(str::to_owned);
    let file = CycleFile::parse("c.toml", "schema = 1\n", &set).expect("a good file").content;
    assert!((file.limits.stock - 50e-6).abs() < 1e-15);
    assert_eq!(file.dressing.expect("asked for").most_parts, 7.0);
    let sizes: Vec<f64> = file.grinding.effects.iter().map(|effect| effect.size()).collect();
    assert_eq!(sizes, [20.0]);
    let text = "schema = 1\neffects = [{ id = \"threshold_force\", size = \"5 N\" }]\n";
    assert_eq!(CycleFile::parse("c.toml", text, &set).expect("a good file").content, file);
    for bad in ["effects.runout=1 um", "effects.threshold_forse=1 N", "effects.threshold_force=1 m", "limits.stok=1 um"]
    {
        let Err(ReadError::Faults(list)) = CycleFile::parse("c.toml", text, &[bad.to_owned()]) else { panic!("{bad}") };
        assert_eq!(list.problems.len(), 1, "{bad}: {list}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// Whatever is found keeps the limits when the process itself grinds it.
    #[test]
    fn a_cycle_that_is_found_keeps_its_limits(
        lag in 0.1..0.9f64, stock in 15e-6..300e-6f64, finish_stock in 0.0..20e-6f64, last in 0.05e-6..1e-6f64,
        size in 0.1e-6..3e-6f64, threshold_force in 0.0..10.0f64, wheel_wear_ratio in 0.0..0.03f64,
    ) {
        let mut grinding = paper();
        grinding.parameters.system_stiffness = stiffness_from_k(grinding.parameters.process_stiffness, lag);
        grinding.parameters.threshold_force = threshold_force;
        grinding.parameters.wheel_wear_ratio = wheel_wear_ratio;
        let limits = CycleLimits { stock, finish_stock, last_depth: last, size_error: size, ..CycleLimits::default() };
        if let Ok(cycle) = designed(&grinding, &Input::default(), &limits) {
            let slack = 1.0 + 1e-9;
            prop_assert!(cycle.last_depth <= last * slack);
            prop_assert!(cycle.size_error <= size * slack);
            prop_assert!(cycle.finish_stock >= finish_stock / slack);
            let rough = cycle.phases[0].revolutions as usize;
            let burnt = cycle.course[..=rough].iter().any(|point| point.load.temperature_rise > 650.0 * slack && point.depth_of_cut > 1e-7);
            prop_assert!(!burnt);
            let commanded = cycle.course[cycle.course.len() - 1].commanded_infeed;
            prop_assert!((commanded / stock - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn any_text_is_read_as_a_cycle_or_refused(text in "\\PC{0,80}") {
        let _ = CycleFile::parse("c.toml", &format!("schema = 1\n[limits]\n{text}"), &[]);
    }
}
