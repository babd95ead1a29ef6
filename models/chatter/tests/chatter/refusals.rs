//! Bad input meets typed errors.

use std::f64::consts::TAU;
use toolroom_chatter::paper::{FiveDegrees, Preset, Reduced};
use toolroom_chatter::{
    Axis, Bar, ChatterError, Cutter, Direction, Engagement, Milling, MillingForce, Mode, SimulationSettings,
    SpeedVariation, Support, Turning,
};

fn mode() -> Mode {
    Mode { direction: [1.0, 0.0], natural_frequency: 900.0, damping_ratio: 0.02, stiffness: 1e7 }
}

fn milling() -> Milling {
    Milling {
        modes: vec![mode()],
        cutter: Cutter::straight(2, 0.02),
        engagement: Engagement::new(0.5, Direction::Down).unwrap(),
        force: MillingForce::new(6e8, 2e8),
        feed_per_tooth: 0.1e-3,
        by_speed: None,
        along_path: None,
    }
}

#[test]
fn structures_that_are_none() {
    for stiffness in [0.0, -1e6] {
        let cut = Milling { modes: vec![Mode { stiffness, ..mode() }], ..milling() };
        let expected = ChatterError::NotPositive { quantity: "stiffness", value: stiffness };
        assert_eq!(cut.verdict(800.0, 1e-3), Err(expected));
        let turning = Turning::orthogonal(cut.modes, 1e9, 0.05);
        assert_eq!(turning.verdict(100.0, 1e-3), Err(expected));
        assert_eq!(turning.limit(100.0), Err(expected));
    }
    let unstable = Milling { modes: vec![Mode { damping_ratio: -0.01, ..mode() }], ..milling() };
    assert_eq!(unstable.verdict(800.0, 1e-3), Err(ChatterError::UnstableStructure { damping_ratio: -0.01 }));
    assert_eq!(Milling { modes: Vec::new(), ..milling() }.verdict(800.0, 1e-3), Err(ChatterError::NoModes));
    // A mode along the cutting speed does not change an orthogonal chip.
    let across = Turning::orthogonal(vec![Mode { direction: [0.0, 1.0], ..mode() }], 1e9, 0.05);
    assert_eq!(across.limit(100.0), Err(ChatterError::NoModes));
    let chuck = Reduced { stiffness: 0.0, ..Reduced::from_preset(Preset::default(), 0.0) };
    assert!(matches!(chuck.verdict(0.1, 1.0), Err(ChatterError::NotPositive { quantity: "stiffness", .. })));
    let mut lathe = FiveDegrees::from_preset(Preset::default(), 0.0, 1e-4);
    lathe.tool_stiffness[1][1] = -1.0;
    assert!(matches!(lathe.verdict(100.0), Err(ChatterError::NotPositive { quantity: "tool_stiffness", .. })));
}

#[test]
fn engagements_that_are_none() {
    assert!(matches!(Engagement::new(1.2, Direction::Up), Err(ChatterError::OutOfRange { quantity: "immersion", .. })));
    assert_eq!(Engagement::new(0.0, Direction::Up), Err(ChatterError::NoTeethInCut));
    assert_eq!(
        Milling { cutter: Cutter::straight(0, 0.02), ..milling() }.verdict(800.0, 1e-3),
        Err(ChatterError::NoTeethInCut)
    );
    let backwards = Milling { engagement: Engagement { entry: 1.0, exit: 0.5 }, ..milling() };
    assert_eq!(backwards.verdict(800.0, 1e-3), Err(ChatterError::NoTeethInCut));
    let mut pitched = milling();
    pitched.cutter.pitch = vec![1.0, 2.0];
    assert!(matches!(pitched.verdict(800.0, 1e-3), Err(ChatterError::OutOfRange { quantity: "sum of pitch", .. })));
    let mut eccentric = Milling { feed_per_tooth: 0.0, ..milling() };
    eccentric.cutter.runout = 1e-5;
    assert!(matches!(
        eccentric.verdict(800.0, 1e-3),
        Err(ChatterError::NotPositive { quantity: "feed_per_tooth", .. })
    ));
}

#[test]
fn numbers_that_are_none() {
    let cut = milling();
    for value in [f64::NAN, f64::INFINITY] {
        assert!(matches!(cut.verdict(value, 1e-3), Err(ChatterError::NotFinite { quantity: "spindle_speed", .. })));
        assert!(matches!(cut.verdict(800.0, value), Err(ChatterError::NotFinite { quantity: "depth", .. })));
        assert!(matches!(Engagement::new(value, Direction::Up), Err(ChatterError::NotFinite { .. })));
        let soft = Milling { modes: vec![Mode { stiffness: value, ..mode() }], ..milling() };
        assert!(matches!(soft.verdict(800.0, 1e-3), Err(ChatterError::NotFinite { quantity: "stiffness", .. })));
    }
    assert!(matches!(cut.verdict(0.0, 1e-3), Err(ChatterError::NotPositive { .. })));
    assert!(matches!(cut.verdict(800.0, -1e-3), Err(ChatterError::OutOfRange { quantity: "depth", .. })));
}

#[test]
fn ranges_that_are_none() {
    let cut = milling();
    let good = Axis { start: 500.0, end: 900.0, points: 3 };
    let one = Axis { points: 1, ..good };
    assert_eq!(one.values("depth"), Err(ChatterError::TooFewPoints { quantity: "depth", points: 1 }));
    let few = ChatterError::TooFewPoints { quantity: "speed", points: 1 };
    assert_eq!(cut.boundary(&one, 1e-3), Err(few));
    let point = Axis { end: 500.0, ..good };
    assert!(matches!(cut.boundary(&point, 1e-3), Err(ChatterError::EmptyRange { quantity: "speed", .. })));
    let nan = Axis { start: f64::NAN, ..good };
    assert!(matches!(nan.values("speed"), Err(ChatterError::NotFinite { .. })));
    assert!(matches!(cut.lobes(&[f64::NAN], &[1e-3]), Err(ChatterError::NotFinite { .. })));
}

#[test]
fn settings_that_are_none() {
    let turning = Turning::orthogonal(vec![mode()], 1e9, 0.05);
    let settings = SimulationSettings { observed: 900, ..SimulationSettings::default() };
    assert!(turning.simulate(100.0, 1e-3, 1e-4, &settings).is_err());
    let fast = SpeedVariation { amplitude: 0.1, revolutions: 1, phase: None };
    assert!(matches!(
        turning.verdict_at_varying_speed(TAU * 20.0, fast, 1e-3),
        Err(ChatterError::OutOfRange { quantity: "revolutions", .. })
    ));
    let bar = Bar {
        length: 0.2,
        diameter: 0.03,
        youngs_modulus: 2.1e11,
        density: 7850.0,
        damping_ratio: 0.02,
        chuck_stiffness: 1e9,
        support: Support::Tailstock,
    };
    assert_eq!(bar.mode_at(0.0), Err(ChatterError::NoModes));
    assert!(matches!(bar.mode_at(0.3), Err(ChatterError::OutOfRange { quantity: "position", .. })));
}

/// A period of the variation that holds thousands of oscillations would take minutes; what is refused says which speed is not.
#[test]
fn a_varying_speed_with_too_many_oscillations_is_refused() {
    let variation = SpeedVariation { amplitude: 0.1, revolutions: 5, phase: None };
    let mode = Mode { direction: [1.0, 0.0], natural_frequency: 540.9, damping_ratio: 0.038, stiffness: 6.48e6 };
    let turning = Turning::orthogonal(vec![mode], 1384e6, 0.035);
    let milling = milling();
    let rpm = |speed: f64| speed / 60.0 * TAU;
    let refused = [
        turning.verdict_at_varying_speed(rpm(37.0), variation, 1e-3).unwrap_err(),
        turning.limit_at_varying_speed(rpm(37.0), variation, 3e-3, 10).unwrap_err(),
        milling.at_varying_speed(rpm(37.0), variation).err().unwrap(),
    ];
    for error in refused {
        let ChatterError::TooManyOscillations { least_rpm, .. } = error else { panic!("{error:?}") };
        assert!(error.is_failed_search() && least_rpm > 100.0 && least_rpm < 1000.0, "{error}");
    }
    assert!(turning.verdict_at_varying_speed(rpm(170.0), variation, 1e-4).unwrap().stable);
    // One phase is answered at half the speed down to which the worst of all is looked for.
    let fastest = milling.modes.iter().map(|mode| mode.natural_frequency).fold(0.0, f64::max);
    let between = rpm(fastest * 60.0 * 5.0 / 700.0);
    assert!(milling.at_varying_speed(between, variation).is_err());
    assert!(milling.at_varying_speed(between, SpeedVariation { phase: Some(0.0), ..variation }).is_ok());
}
