//! Turning and milling with a structure around them.

use proptest::prelude::*;
use std::f64::consts::TAU;
use std::sync::Arc;
use toolroom_chatter::{Bar, Cutter, Direction, Engagement, Mode, SpeedModes, Support};
use toolroom_cutting::{
    Milling, MillingInput, MillingState, MillingStructure, Regeneration, Turning, TurningInput, TurningOutput,
    TurningState, TurningStructure,
};
use toolroom_effects::{Effect, Effects};
use toolroom_process::{Process, contract};

const MODE: Mode = Mode { direction: [1.0, 0.0], natural_frequency: 180.0, damping_ratio: 0.03, stiffness: 8e6 };

fn cut() -> toolroom_chatter::Turning {
    toolroom_chatter::Turning::orthogonal(vec![MODE], 2e9, 0.04)
}

fn turning() -> Turning {
    let structure = TurningStructure::new(cut(), None, Regeneration::default()).unwrap();
    Turning { structure: Some(Arc::new(structure)), ..Turning::named("c45_t15k6").unwrap() }
}

/// A slender bar between chuck and tailstock.
fn between_centres() -> Turning {
    let bar = Bar {
        length: 0.6,
        diameter: 0.04,
        youngs_modulus: 2.1e11,
        density: 7850.0,
        damping_ratio: 0.03,
        chuck_stiffness: 1e8,
        support: Support::Tailstock,
    };
    let stiff = toolroom_chatter::Turning::orthogonal(Vec::new(), 2e9, 0.04);
    let structure = TurningStructure::new(stiff, Some((bar, 0.3)), Regeneration::default()).unwrap();
    Turning { structure: Some(Arc::new(structure)), ..turning() }
}

fn turned(depth_of_cut: f64) -> TurningInput {
    TurningInput {
        cutting_speed: 2.5,
        depth_of_cut,
        workpiece_diameter: 0.04,
        feed_per_rev: 0.2e-3,
        ..Default::default()
    }
}

fn milling() -> Milling {
    let modes = vec![
        Mode { direction: [1.0, 0.0], natural_frequency: 1800.0, damping_ratio: 0.03, stiffness: 9e6 },
        Mode { direction: [0.0, 1.0], natural_frequency: 2000.0, damping_ratio: 0.03, stiffness: 9e6 },
    ];
    let structure = MillingStructure::new(modes, 0.0, 0.0, Regeneration::default()).unwrap();
    Milling { structure: Some(Arc::new(structure)), ..Milling::default() }
}

/// The limit of a new edge is that of the stability model at the rounded speed.
#[test]
fn the_limit_is_that_of_the_stability_model() {
    let turning = turning();
    for speed in [1.9, 2.5, 3.1] {
        let u = TurningInput { cutting_speed: speed, ..turned(0.2e-3) };
        let expected = cut().limit(speed / 0.02).unwrap().depth;
        let output = turning.output(&turning.initial(), &u);
        let limit = u.depth_of_cut / (1.0 - output.stability_margin);
        assert!((limit / expected - 1.0).abs() < 0.02, "{limit} {expected}");
    }
    let milling = milling();
    let u = MillingInput { depth_of_cut: 1e-3, ..Default::default() };
    let output = milling.output(&milling.initial(), &u);
    let cut = toolroom_chatter::Milling {
        modes: vec![
            Mode { direction: [1.0, 0.0], natural_frequency: 1800.0, damping_ratio: 0.03, stiffness: 9e6 },
            Mode { direction: [0.0, 1.0], natural_frequency: 2000.0, damping_ratio: 0.03, stiffness: 9e6 },
        ],
        cutter: Cutter::straight(4, 12e-3),
        engagement: Engagement::new(0.25, Direction::Down).unwrap(),
        force: toolroom_chatter::MillingForce::new(2389e6, 965e6),
        feed_per_tooth: 0.05e-3,
        by_speed: None,
        along_path: None,
    };
    let expected = cut.at_speed(output.spindle_speed).unwrap().limit(20e-3).unwrap().depth;
    let limit = u.depth_of_cut / (1.0 - output.stability_margin);
    assert!((limit / expected - 1.0).abs() < 0.02, "{limit} {expected}");
}

/// Chatter wears the edge faster and roughens the surface; the mean force stays.
#[test]
fn chatter_costs_life_and_surface_but_no_mean_force() {
    let (with, without) = (turning(), Turning::named("c45_t15k6").unwrap());
    let u = turned(2e-3);
    let (a, b) = (with.output(&with.initial(), &u), without.output(&without.initial(), &u));
    assert!(a.stable == 0.0 && b.stable == 1.0);
    assert_eq!(a.cutting_force, b.cutting_force);
    assert!(a.roughness_ra > 3.0 * b.roughness_ra, "{} {}", a.roughness_ra, b.roughness_ra);
    assert!(a.mechanical_wear_per_path > 1.5 * b.mechanical_wear_per_path);
    assert!((a.dominant_frequency / 180.0 - 1.0).abs() < 0.15, "{} Hz", a.dominant_frequency);
    assert!(a.chatter_growth_rate > 0.0 && a.force_ripple > 0.5);
    let (with, without) = (milling(), Milling::default());
    let u = MillingInput { depth_of_cut: 12e-3, width_of_cut: 6e-3, ..Default::default() };
    let (a, b) = (with.output(&with.initial(), &u), without.output(&without.initial(), &u));
    assert!(a.stable == 0.0 && a.tool_life < 0.7 * b.tool_life && a.roughness_ra > 3.0 * b.roughness_ra);
    assert_eq!(a.cutting_force, b.cutting_force);
}

/// A stable cut with a structure is bit for bit the cut without.
#[test]
fn a_stable_cut_is_the_cut_without_a_structure() {
    let (with, without) = (turning(), Turning::named("c45_t15k6").unwrap());
    let u = turned(0.1e-3);
    let run = |process: &Turning| {
        let mut x = process.initial();
        let advance = process.advance(&mut x, &u, 300.0).unwrap();
        (x, advance)
    };
    assert_eq!(run(&with), run(&without));
    let output = with.output(&with.initial(), &u);
    assert_eq!(
        TurningOutput { stability_margin: 1.0, ..output },
        without.output(&without.initial(), &u),
        "{}",
        output.stability_margin
    );
}

/// Wear raises the coefficient and the damping by the land, which counts at low speed.
#[test]
fn a_worn_edge_is_steadier_at_low_speed_and_less_so_without_damping_by_its_land() {
    let limit = |indentation_force: f64, speed: f64, flank_wear: f64| {
        let regeneration = Regeneration { indentation_force, ..Default::default() };
        let structure = TurningStructure::new(cut(), None, regeneration).unwrap();
        let turning = Turning { structure: Some(Arc::new(structure)), ..turning() };
        let x = TurningState { flank_wear, ..turning.initial() };
        turning.vibration(&x, &TurningInput { cutting_speed: speed, ..turned(0.2e-3) }).limit
    };
    assert!(limit(4e13, 0.5, 0.5e-3) > 1.5 * limit(4e13, 0.5, 0.0));
    assert!(limit(4e13, 6.6, 0.4e-3) / limit(4e13, 6.6, 0.0) < 1.3);
    // Half the wear limit of 0.8 mm: a tenth more coefficient.
    assert!((limit(0.0, 6.6, 0.4e-3) / limit(0.0, 6.6, 0.0) - 1.0 / 1.1).abs() < 1e-9);
}

#[test]
fn process_damping_steadies_a_slow_cut_and_its_surface() {
    let with = |id: &str, size: f64| {
        let effect = Effect::named(id).unwrap().with_size(size);
        Turning { effects: Effects::new(vec![effect]).unwrap(), ..turning() }
    };
    let slow = TurningInput { cutting_speed: 0.6, ..turned(1.2e-3) };
    let output = |turning: &Turning| turning.output(&turning.initial(), &slow);
    let (bare, damped) = (output(&turning()), output(&with("process_damping", 1.5e6)));
    assert!(bare.stability_margin < 0.0 && damped.stability_margin > 0.0);
    assert!(damped.vibration_rms < bare.vibration_rms && damped.roughness_ra < bare.roughness_ra);
    let effect = Effect::named("process_damping").unwrap().with_size(1e6);
    let cutter = Milling { effects: Effects::new(vec![effect]).unwrap(), ..milling() };
    let deep = MillingInput { depth_of_cut: 6e-3, cutting_speed: 0.5, ..Default::default() };
    let output = |milling: &Milling| milling.output(&milling.initial(), &deep);
    let (bare, damped) = (output(&milling()), output(&cutter));
    assert!(damped.stability_margin > bare.stability_margin);
    assert!(damped.vibration_rms < bare.vibration_rms && damped.roughness_ra < bare.roughness_ra);
}

/// Three jaws at 2/3 of the natural frequency, the principal parametric region.
#[test]
fn a_modulated_chuck_vibrates_at_two_thirds_of_the_natural_frequency() {
    let effect = Effect::named("chuck_stiffness").unwrap().with_size(0.3);
    let turning = Turning { effects: Effects::new(vec![effect]).unwrap(), ..turning() };
    let at = |share: f64| {
        let spindle = share * TAU * 180.0;
        let u = TurningInput { cutting_speed: spindle * 0.02, ..turned(0.1e-3) };
        turning.output(&turning.initial(), &u)
    };
    assert_eq!((at(2.0 / 3.0 * 1.02).stable, at(0.85).stable), (0.0, 1.0));
    // Away from it three lobes are left on the part.
    let forced = at(0.5);
    assert!(forced.stable == 1.0 && forced.vibration_amplitude > 0.0);
    assert!((forced.dominant_frequency / (1.5 * 180.0) - 1.0).abs() < 1e-9);
}

#[test]
fn runout_moves_the_tool_once_a_revolution() {
    let effect = Effect::named("runout").unwrap().with_size(20e-6);
    let turning = Turning { effects: Effects::new(vec![effect]).unwrap(), ..Turning::named("c45_t15k6").unwrap() };
    let u = turned(1e-3);
    let output = turning.output(&turning.initial(), &u);
    let share = 20e-6 / 1e-3 + turning.finish.force_fluctuation;
    let expected = output.passive_force / turning.finish.static_stiffness * share;
    assert!((output.vibration_amplitude / expected - 1.0).abs() < 1e-12);
    assert!((output.dominant_frequency * TAU / output.spindle_speed - 1.0).abs() < 1e-12);
}

#[test]
fn a_bar_is_softest_between_its_supports() {
    let turning = between_centres();
    let limit =
        |position: f64| turning.vibration(&turning.initial(), &TurningInput { position, ..turned(0.2e-3) }).limit;
    assert!(limit(0.35) < limit(0.1) && limit(0.35) < limit(0.55));
    assert_eq!(limit(0.0), limit(0.3));
}

/// Variation of the speed disturbs regeneration, and costs some wear.
#[test]
fn varying_speed_raises_the_limit_and_convex_wear() {
    let turning = turning();
    // On the worst side of a lobe far down.
    let slow = TurningInput { cutting_speed: 1.2, ..turned(0.7e-3) };
    let varied = TurningInput { speed_variation: 0.2, ..slow };
    let limit = |u: &TurningInput| turning.vibration(&turning.initial(), u).limit;
    assert!(limit(&varied) > 1.1 * limit(&slow), "{} {}", limit(&varied), limit(&slow));
    // Wear of a cutter goes with the power 2.7 of speed: its mean over the sinusoid.
    let milling = Milling::default();
    let rate = |u: MillingInput| milling.rates(&milling.initial(), &u).flank_wear;
    let still = MillingInput::default();
    let ripple = rate(MillingInput { speed_variation: 0.3, ..still }) / rate(still);
    let phases = (0..1000).map(|i| f64::from(i) / 1000.0 * TAU);
    let mean = phases.map(|phase| (1.0 + 0.3 * phase.cos()).powf(2.7027)).sum::<f64>() / 1000.0;
    assert!((ripple / mean - 1.0).abs() < 1e-3 && mean > 1.1, "{ripple} {mean}");
}

#[test]
fn the_contract_holds_with_a_structure() {
    let points =
        vec![(turned(0.1e-3), 60.0), (turned(2e-3), 20.0), (TurningInput { engaged: 0.0, ..turned(2e-3) }, 9.0)];
    let turning = turning();
    contract::split_invariance(&turning, &points, 1e-5);
    contract::determinism(&turning, &points);
    contract::finite_outputs(&turning, &points);
    contract::events_stop_the_step(&turning, &points);
    let milling = milling();
    let u = MillingInput { depth_of_cut: 12e-3, width_of_cut: 6e-3, ..Default::default() };
    let points = vec![(MillingInput::default(), 60.0), (u, 200.0), (MillingInput { cutting_speed: 0.0, ..u }, 5.0)];
    contract::split_invariance(&milling, &points, 1e-5);
    contract::determinism(&milling, &points);
    contract::finite_outputs(&milling, &points);
}

#[test]
fn what_is_no_structure_is_refused() {
    let limp = toolroom_chatter::Turning::orthogonal(vec![Mode { stiffness: 0.0, ..MODE }], 2e9, 0.04);
    assert!(TurningStructure::new(limp, None, Regeneration::default()).is_err());
    let modes = vec![Mode { damping_ratio: f64::NAN, ..MODE }];
    assert!(MillingStructure::new(modes, 0.0, 0.0, Regeneration::default()).is_err());
    assert!(MillingStructure::new(Vec::new(), 0.0, 0.0, Regeneration::default()).is_err());
}

/// Along a bar held on both sides a pass chatters in the middle; the time of it is a state, however
/// the pass is split.
#[test]
fn the_middle_of_a_bar_chatters_and_its_time_counts() {
    let turning = between_centres();
    let softest = turning.vibration(&turning.initial(), &TurningInput { position: 0.35, ..turned(0.2e-3) }).limit;
    let u = TurningInput { position: 0.58, ..turned(1.3 * softest) };
    // 0.2 mm a revolution at 2.5 m/s: 0.5 m take 126 s.
    let duration = 0.5 / (u.feed_per_rev * u.cutting_speed / (std::f64::consts::PI * u.workpiece_diameter));
    let run = |parts: u32| {
        let (mut x, mut held) = (turning.initial(), u);
        for _ in 0..parts {
            let step = duration / f64::from(parts);
            turning.advance(&mut x, &held, step).unwrap();
            held = turning.input_after(&held, step);
        }
        (x, held)
    };
    let (whole, end) = run(1);
    assert!((end.position - 0.08).abs() < 1e-9, "{}", end.position);
    assert!(whole.chatter_time > 0.1 * duration && whole.chatter_time < 0.9 * duration, "{}", whole.chatter_time);
    let (parts, _) = run(23);
    assert!((parts.chatter_time - whole.chatter_time).abs() < 0.2, "{} {}", parts.chatter_time, whole.chatter_time);
    assert!((parts.flank_wear / whole.flank_wear - 1.0).abs() < 1e-3);
}

/// A step of the integration that runs away asks with a wear that no edge has; it costs no more than any other.
#[test]
fn an_edge_beyond_all_wear_is_judged_as_the_most_worn_one() {
    let margin = |depth_of_cut: f64, flank_wear: f64| {
        let turning = turning();
        let state = TurningState { flank_wear, ..turning.initial() };
        turning.output(&state, &turned(depth_of_cut)).stability_margin
    };
    for depth_of_cut in [0.2e-3, 1.2e-3] {
        assert!(margin(depth_of_cut, 20e-3).is_finite());
        for flank_wear in [1.0, 1e10, 1e40, 1e150] {
            assert_eq!(margin(depth_of_cut, flank_wear), margin(depth_of_cut, 20e-3), "{flank_wear} m");
        }
    }
}

/// Beyond the limit a shop's cutter vibrates as a simulation of the very same cut does, fresh and worn, at speeds and depths
/// between those at which cycles are kept.
#[test]
fn milling_chatter_is_that_of_a_simulation() {
    let milling = milling();
    let mut judged = 0;
    // Up to three times the limit.
    let points = [(1.31, 1.5e-3), (1.71, 1.9e-3), (2.03, 1.6e-3), (2.47, 1.7e-3), (2.9, 1.4e-3), (3.37, 2.6e-3)];
    for (i, (speed, depth)) in points.into_iter().enumerate() {
        let u = MillingInput { cutting_speed: speed, depth_of_cut: depth, ..Default::default() };
        let x = MillingState { flank_wear: 0.02e-3 * i as f64, ..milling.initial() };
        let output = milling.output(&x, &u);
        if output.stable > 0.5 {
            continue;
        }
        judged += 1;
        let cut = milling.regenerative(&x, &u).unwrap();
        let settled = cut.settled(output.spindle_speed, depth).unwrap();
        let range = settled.simulation.peak_to_peak(0).max(settled.simulation.peak_to_peak(1));
        let vibration = milling.vibration(&x, &u);
        let ratio = 2.0 * (vibration.chatter + vibration.forced) / range;
        assert!((ratio - 1.0).abs() < 0.15, "{speed} m/s, {depth} m: {ratio}");
        assert!(vibration.wear_factor > 1.0 && vibration.force_ripple > 0.0, "{vibration:?}");
        // As often as it is asked.
        assert_eq!(milling.vibration(&x, &u), vibration);
    }
    assert!(judged >= 4, "{judged}");
    // Far beyond its limit a cut leaves chatter marks still: the forced response, which grows with the depth, does not hide them.
    let deep = |depth_of_cut: f64| {
        milling.vibration(&milling.initial(), &MillingInput { depth_of_cut, cutting_speed: 1.31, ..Default::default() })
    };
    let (near, far) = (deep(1.6e-3), deep(60e-3));
    assert!(near.chatter > 0.0 && far.chatter > 0.5 * near.chatter, "{near:?} {far:?}");
}

/// The shop asks with the modes of the speed at which it cuts; where nobody measured, a cut counts as unstable.
#[test]
fn modes_by_speed_count_at_their_speed() {
    let softer = Mode { natural_frequency: 170.0, stiffness: 7e6, ..MODE };
    let table = |second: Mode| SpeedModes::new(vec![(100.0, vec![MODE]), (200.0, vec![second])]).unwrap();
    let with = |second: Mode| {
        let cut = toolroom_chatter::Turning { by_speed: Some(table(second)), ..cut() };
        let structure = TurningStructure::new(cut, None, Regeneration::default()).unwrap();
        assert_eq!(structure.speeds(), Some((100.0, 200.0)));
        Turning { structure: Some(Arc::new(structure)), ..Turning::named("c45_t15k6").unwrap() }
    };
    let (plain, same, drifting) = (turning(), with(MODE), with(softer));
    let margin = |turning: &Turning, speed: f64| {
        let u = TurningInput { cutting_speed: speed, ..turned(0.2e-3) };
        turning.output(&turning.initial(), &u).stability_margin
    };
    for speed in [2.1, 2.9, 3.8] {
        assert_eq!(margin(&plain, speed), margin(&same, speed));
        assert!((margin(&drifting, speed) - margin(&plain, speed)).abs() > 0.005, "{speed}");
    }
    let turning_input = TurningInput { cutting_speed: 4.5, ..turned(0.2e-3) };
    assert_eq!(same.output(&same.initial(), &turning_input).stable, 0.0);
    // A shop that scatters draws one machine for all speeds.
    let factor = |turning: &Turning, natural_frequency_factor: f64| {
        let u = TurningInput { cutting_speed: 2.9, natural_frequency_factor, ..turned(0.2e-3) };
        turning.output(&turning.initial(), &u).stability_margin
    };
    assert_eq!(factor(&plain, 1.03), factor(&same, 1.03));
    let modes = vec![
        Mode { natural_frequency: 1800.0, ..MODE },
        Mode { direction: [0.0, 1.0], natural_frequency: 2000.0, ..MODE },
    ];
    let mill = |by_speed: Option<SpeedModes>| {
        let structure = MillingStructure::new(modes.clone(), 0.0, 0.0, Regeneration::default()).unwrap();
        Milling { structure: Some(Arc::new(structure.by_speed(by_speed))), ..Milling::default() }
    };
    let rows = vec![(100.0, modes.clone()), (1000.0, modes.clone())];
    let (fixed, tabled) = (mill(None), mill(Some(SpeedModes::new(rows).unwrap())));
    let u = MillingInput { depth_of_cut: 1e-3, ..Default::default() };
    assert_eq!(fixed.output(&fixed.initial(), &u), tabled.output(&tabled.initial(), &u));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// The cut is looked at in small steps beside: what they find is found in one step, to their length.
    #[test]
    fn an_unstable_stretch_of_a_pass_counts_however_short_it_is(
        depth in 0.99..1.1f64, position in 0.3..0.59f64, wear in 0.0..0.1e-3f64, ramp in -2e-3..2e-3f64,
    ) {
        let turning = between_centres();
        let softest = turning.vibration(&turning.initial(), &TurningInput { position: 0.35, ..turned(0.2e-3) }).limit;
        let u = TurningInput { position, cutting_acceleration: ramp, ..turned(depth * softest) };
        let start = TurningState { flank_wear: wear, ..turning.initial() };
        let (duration, steps) = (60.0, 1500);
        let step = duration / f64::from(steps);
        let (mut x, mut samples, mut switches, mut before) = (start, 0, 2, None);
        for i in 0..steps {
            let input = |after: f64| turning.input_after(&u, f64::from(i) * step + after);
            let mut middle = x;
            turning.advance(&mut middle, &input(0.0), 0.5 * step).unwrap();
            let unstable = !turning.vibration(&middle, &input(0.5 * step)).stable();
            samples += i32::from(unstable);
            switches += i32::from(before.replace(unstable).is_some_and(|before| before != unstable));
            turning.advance(&mut x, &input(0.0), step).unwrap();
        }
        let mut whole = start;
        turning.advance(&mut whole, &u, duration).unwrap();
        let sampled = f64::from(samples) * step;
        // Wear is as exact as a step says, 1e-7 of its limit, however often what chatter makes of it jumps on the way.
        let exact = 1e-7 * turning.pair.limits.wear_limit;
        let worn = (whole.flank_wear - x.flank_wear).abs();
        prop_assert!(worn < exact, "{worn:e} m");
        // Where it is wear that ends a stretch, that is some time at the slowest rate of the pass.
        let rate = |x: &TurningState, after: f64| turning.rates(x, &turning.input_after(&u, after)).flank_wear;
        let late = exact / rate(&start, 0.0).min(rate(&whole, duration));
        let apart = (whole.chatter_time - x.chatter_time).abs();
        prop_assert!(apart <= f64::from(switches) * late, "{} {} {late:e}", whole.chatter_time, x.chatter_time);
        prop_assert!((whole.chatter_time - sampled).abs() <= f64::from(switches) * step, "{} {sampled}", whole.chatter_time);
    }
}
