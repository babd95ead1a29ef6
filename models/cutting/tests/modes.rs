//! Effects of a structure that is not the one that was tapped.

use std::sync::Arc;
use toolroom_chatter::Mode;
use toolroom_cutting::{
    Milling, MillingInput, MillingStructure, Regeneration, Turning, TurningInput, TurningStructure,
};
use toolroom_effects::{Effect, Effects};
use toolroom_process::Process;

const MODE: Mode = Mode { direction: [1.0, 0.0], natural_frequency: 180.0, damping_ratio: 0.03, stiffness: 8e6 };

fn turning() -> Turning {
    let cut = toolroom_chatter::Turning::orthogonal(vec![MODE], 2e9, 0.04);
    let structure = TurningStructure::new(cut, None, Regeneration::default()).unwrap();
    Turning { structure: Some(Arc::new(structure)), ..Turning::named("c45_t15k6").unwrap() }
}

fn turned(depth_of_cut: f64) -> TurningInput {
    TurningInput { depth_of_cut, workpiece_diameter: 0.04, feed_per_rev: 0.2e-3, ..Default::default() }
}

/// Frequency moves lobes along the speed, stiffness their depths, damping the least depth; size zero is the cut without them to
/// the last bit, and static stiffness at other frequencies is what a machine with other masses has.
#[test]
fn effects_of_the_modes_move_lobes_and_depths() {
    let with = |list: &[(&str, f64)]| {
        let sized = |(id, size): &(&str, f64)| Effect::named(id).unwrap().with_size(*size);
        Turning { effects: Effects::new(list.iter().map(sized).collect()).unwrap(), ..turning() }
    };
    let limit = |turning: &Turning, speed: f64, factor: f64| {
        let u = TurningInput { cutting_speed: speed, natural_frequency_factor: factor, ..turned(0.2e-3) };
        turning.stability_limit(&turning.initial(), &u).unwrap()
    };
    let plain = turning();
    let none = with(&[("mode_frequency", 0.0), ("mode_damping", 0.0), ("mode_stiffness", 0.0)]);
    for speed in [1.9, 2.5, 3.1] {
        assert_eq!(limit(&none, speed, 1.0), limit(&plain, speed, 1.0));
        // The step of rounded speeds moves a limit by up to a percent on the flank of a lobe.
        let (depth, frequency) = limit(&plain, speed, 1.0);
        let (moved, faster) = limit(&with(&[("mode_frequency", 0.1)]), 1.1 * speed, 1.0);
        assert!((moved / depth - 1.0).abs() < 0.02 && (faster / frequency - 1.1).abs() < 2e-3, "{moved} {depth}");
        let (stiffer, same) = limit(&with(&[("mode_stiffness", 0.5)]), speed, 1.0);
        assert!((stiffer / depth - 1.5).abs() < 1e-12 && same == frequency);
        // Another frequency at the same stiffness is one at the same mass and a stiffness that makes up for it.
        let made_up = limit(&with(&[("mode_stiffness", 1.0 / 1.21 - 1.0)]), speed, 1.1);
        let (at_stiffness, _) = limit(&with(&[("mode_frequency", 0.1)]), speed, 1.0);
        assert!((made_up.0 / at_stiffness - 1.0).abs() < 1e-12, "{made_up:?} {at_stiffness}");
    }
    // Between lobes the least limit is 2 k zeta (1 + zeta)/K.
    let least = |turning: &Turning| {
        (0..400).map(|i| limit(turning, 1.5 + 0.005 * f64::from(i), 1.0).0).fold(f64::INFINITY, f64::min)
    };
    let damped = least(&with(&[("mode_damping", -0.5)])) / least(&plain);
    assert!((damped - 0.5 * 1.015 / 1.03).abs() < 2e-3, "{damped}");
}

/// In milling, too: the limit goes with the stiffness, straight teeth and helical ones, and lobes with the frequency.
#[test]
fn effects_of_the_modes_act_in_milling() {
    let modes = || {
        let x = Mode { direction: [1.0, 0.0], natural_frequency: 1800.0, damping_ratio: 0.03, stiffness: 9e6 };
        vec![x, Mode { direction: [0.0, 1.0], natural_frequency: 2000.0, ..x }]
    };
    for helix in [0.0, 0.5] {
        let structure = Arc::new(MillingStructure::new(modes(), helix, 1e4, Regeneration::default()).unwrap());
        let limit = |effect: Option<(&str, f64)>, speed: f64| {
            let effects: Vec<Effect> =
                effect.iter().map(|(id, size)| Effect::named(id).unwrap().with_size(*size)).collect();
            let effects = Effects::new(effects).unwrap();
            let milling = Milling { structure: Some(structure.clone()), effects, ..Milling::default() };
            let u = MillingInput { depth_of_cut: 1e-3, cutting_speed: speed, ..Default::default() };
            milling.stability_limit(&milling.initial(), &u).unwrap()
        };
        let (depth, frequency) = limit(None, 3.0);
        assert_eq!(limit(Some(("mode_stiffness", 0.0)), 3.0), (depth, frequency));
        // Process damping over the force stays, and the lag of a helix over the depth changes a little.
        let (softer, _) = limit(Some(("mode_stiffness", -0.2)), 3.0);
        let wide = if helix > 0.0 { 0.1 } else { 1e-9 };
        assert!((softer / depth - 0.8).abs() < wide, "{softer} {depth}");
        let (moved, faster) = limit(Some(("mode_frequency", 0.05)), 3.0 * 1.05);
        assert!((moved / depth - 1.0).abs() < 0.05 && (faster / frequency - 1.05).abs() < 5e-3, "{moved} {depth}");
    }
}
