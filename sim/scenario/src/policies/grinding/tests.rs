use super::*;
use proptest::prelude::*;
use toolroom_infeed::CycleLimits;

fn work() -> CycleWork {
    CycleWork::new(Infeed::default(), Input::default(), CycleLimits::default(), 1.0).unwrap()
}

fn quiet() -> SensorSheet {
    SensorSheet { normal_force: 0.0, ..SensorSheet::default() }
}

/// A wheel of this dulling, ground by a controller with a perfect sensor.
fn grind(controller: &GrindingController, dulling: f64, wheel: &mut WheelEstimate) -> (State, Vec<GrindingPhase>) {
    let infeed = Infeed::default();
    let mut part = State::default();
    let mut all = Vec::new();
    controller.begin_part(wheel);
    for pass in 0..CycleWork::PHASES {
        let mut readings = Vec::new();
        let phases = controller.phase(pass, wheel, |infeed_per_rev| {
            let input = Input { infeed_per_rev, process_stiffness_factor: dulling, ..Input::default() };
            part.commanded_infeed += infeed_per_rev;
            part = infeed.revolution(&part, &input);
            let force = infeed.output(&part, &input).normal_force;
            readings.push(ForceReading { revolution: part.revolutions, infeed_per_rev, force });
            force
        });
        for reading in &readings {
            controller.see(wheel, reading);
        }
        all.extend(phases);
    }
    (part, all)
}

fn rules() -> [GrindingRule; 4] {
    [
        GrindingRule::Fixed { dulling: 1.0 },
        GrindingRule::ForceAdaptive { dulling: 1.0, rough_force: None },
        GrindingRule::TimeConstantAdaptive { dulling: 1.0, redesign: false },
        GrindingRule::TimeConstantAdaptive { dulling: 1.0, redesign: true },
    ]
}

fn controller(rule: GrindingRule) -> GrindingController {
    // Dressing by dulling makes the fixed cycle look at the force too.
    GrindingController::designed(&work(), rule, DressingRule::Dulling { ratio: 9.0 }, &quiet()).unwrap()
}

#[test]
fn on_a_dressed_wheel_every_rule_keeps_the_size() {
    for rule in rules() {
        let (part, _) = grind(&controller(rule), 1.0, &mut WheelEstimate::default());
        let left = part.commanded_infeed - part.stock_removed;
        assert!(left <= 0.5e-6 * (1.0 + 1e-9), "{rule:?} leaves {left}");
        assert!((part.commanded_infeed - 100e-6).abs() < 1e-12, "{rule:?}");
    }
}

#[test]
fn without_anything_to_adapt_to_the_phases_are_those_of_the_fixed_cycle() {
    let (_, fixed) = grind(&controller(rules()[0]), 1.0, &mut WheelEstimate::default());
    // A threshold that is never reached, and the spark-out that the design has.
    let high = GrindingRule::ForceAdaptive { dulling: 1.0, rough_force: Some(1e9) };
    let (_, forced) = grind(&controller(high), 1.0, &mut WheelEstimate::default());
    assert_eq!(forced[..2], fixed[..2]);
    let (_, timed) = grind(&controller(rules()[2]), 1.0, &mut WheelEstimate::default());
    assert_eq!(timed, fixed);
}

#[test]
fn the_force_tells_lag_and_dulling() {
    for dulling in [0.7, 1.0, 1.6] {
        let controller = controller(rules()[0]);
        let mut wheel = WheelEstimate::default();
        grind(&controller, dulling, &mut wheel);
        let measured = controller.measured_dulling(&wheel).unwrap();
        assert!((measured / dulling - 1.0).abs() < 1e-9, "{measured} for {dulling}");
    }
    // K = 0.553 of the paper.
    let mut wheel = WheelEstimate::default();
    grind(&controller(rules()[0]), 1.0, &mut wheel);
    assert!((wheel.lag().unwrap() - 0.553).abs() < 1e-4);
}

#[test]
fn on_a_dull_wheel_only_adaptive_cycles_keep_the_size() {
    let size = |rule: GrindingRule| {
        let (part, phases) = grind(&controller(rule), 1.8, &mut WheelEstimate::default());
        let revolutions: u32 = phases.iter().map(|phase| phase.revolutions).sum();
        (part.commanded_infeed - part.stock_removed, revolutions)
    };
    let [fixed, force, time, _] = rules().map(size);
    assert!(fixed.0 > 0.8e-6, "{fixed:?}");
    assert!(force.0 <= 0.5e-6 && time.0 <= 0.5e-6, "{force:?} {time:?}");
    assert!(force.1 > fixed.1 && time.1 > fixed.1);
}

#[test]
fn a_threshold_holds_the_force() {
    let limit = 150.0;
    let controller = controller(GrindingRule::ForceAdaptive { dulling: 1.0, rough_force: Some(limit) });
    let mut peak: f64 = 0.0;
    let infeed = Infeed::default();
    let mut part = State::default();
    controller.phase(0, &WheelEstimate::default(), |infeed_per_rev| {
        let input = Input { infeed_per_rev, ..Input::default() };
        part.commanded_infeed += infeed_per_rev;
        part = infeed.revolution(&part, &input);
        let force = infeed.output(&part, &input).normal_force;
        peak = peak.max(force);
        force
    });
    // One revolution at the rough infeed beyond it at most: J K S.
    assert!(peak > limit && peak < limit + 31.019e6 * 0.553 * 4.93e-6, "{peak}");
}

#[test]
fn cycles_designed_anew_stay_cool_on_a_dull_wheel() {
    let heat = |rule: GrindingRule| {
        let (controller, mut wheel) = (controller(rule), WheelEstimate::default());
        grind(&controller, 1.5, &mut wheel); // the part from which it learns
        let (part, phases) = grind(&controller, 1.5, &mut wheel);
        (part.peak_temperature_rise, phases)
    };
    let (hot, _) = heat(rules()[2]);
    let (cool, phases) = heat(rules()[3]);
    assert!(hot > 800.0 && cool <= 650.0, "{hot} {cool}");
    // Reference design for a process stiffness of 1.5 times: 34 rough revolutions of 2.71 um.
    assert!((phases[0].infeed_per_rev / 2.71471e-6 - 1.0).abs() < 0.05, "{phases:?}");
}

#[test]
fn dressing_follows_its_rule() {
    let due = |dressing, parts, wheel: &WheelEstimate| {
        let controller = GrindingController::designed(&work(), rules()[0], dressing, &quiet()).unwrap();
        controller.dressing_due(parts, wheel)
    };
    let mut wheel = WheelEstimate::default();
    assert_eq!(due(DressingRule::Limit, 99, &wheel), None);
    assert_eq!(due(DressingRule::PartCount { parts: 3 }, 2, &wheel), Some(false));
    assert_eq!(due(DressingRule::PartCount { parts: 3 }, 3, &wheel), Some(true));
    assert_eq!(due(DressingRule::Dulling { ratio: 1.3 }, 9, &wheel), Some(false), "nothing seen yet");
    grind(&controller(rules()[0]), 1.4, &mut wheel);
    assert_eq!(due(DressingRule::Dulling { ratio: 1.3 }, 1, &wheel), Some(true));
    assert_eq!(due(DressingRule::Dulling { ratio: 1.5 }, 1, &wheel), Some(false));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Whatever the sensor shows, commands stay within the limits of the machine and end.
    #[test]
    fn no_reading_drives_a_cycle_out_of_the_limits_of_the_machine(
        rule in 0..4usize,
        readings in proptest::collection::vec(
            prop_oneof![-1e4..1e6f64, Just(f64::NAN), Just(f64::INFINITY), Just(0.0)], 1..200),
    ) {
        let work = work();
        let controller = controller(rules()[rule]);
        let mut wheel = WheelEstimate::default();
        let mut source = readings.iter().cycle();
        for _ in 0..2 {
            controller.begin_part(&mut wheel);
            let mut stock = 0.0;
            for pass in 0..CycleWork::PHASES {
                let mut seen = Vec::new();
                let phases = controller.phase(pass, &wheel, |infeed_per_rev| {
                    let force = *source.next().unwrap();
                    seen.push(ForceReading { revolution: 0.0, infeed_per_rev, force });
                    force
                });
                for phase in &phases {
                    prop_assert!((0.0..=work.limits.greatest_infeed).contains(&phase.infeed_per_rev));
                    prop_assert!(phase.revolutions < 1000);
                    stock += phase.infeed_per_rev * f64::from(phase.revolutions);
                }
                seen.iter().for_each(|reading| controller.see(&mut wheel, reading));
            }
            prop_assert!((stock - work.limits.stock).abs() < 1e-9, "{stock}");
        }
    }
}
