//! Loads of a revolution and cycles within limits of power, force, removal rate, burn and roughness, against the
//! reference tables and against brute force.

use crate::paper::close;
use proptest::prelude::*;
use toolroom_infeed::{
    Cycle, CycleError, CycleFile, CycleLimits, CyclePhase, DressingPlan, Infeed, Input, State, Surface, fastest_cycle,
    fastest_cycle_while_dulling, grind_cycle, stiffness_from_k,
};
use toolroom_process::Process;

/// The paper's machine, whose tangential force is 0.4706 of the normal one.
fn paper() -> Infeed {
    let mut grinding = crate::paper::paper();
    grinding.parameters.friction = 0.4706;
    grinding
}

/// Force 50 N at 1 um, growing with the power 0.8 of the depth.
fn bent() -> Infeed {
    let mut grinding = paper();
    (grinding.parameters.process_stiffness, grinding.parameters.force_exponent) = (50e6, 0.8);
    grinding
}

fn designed(grinding: &Infeed, limits: &CycleLimits) -> Result<Cycle, CycleError> {
    fastest_cycle_while_dulling(grinding, &State::default(), &Input::default(), limits, None)
}

fn phases(cycle: &Cycle) -> Vec<(u32, f64)> {
    cycle.phases.iter().map(|phase| (phase.revolutions, phase.infeed_per_rev * 1e6)).collect()
}

#[test]
fn forces_power_energy_and_heat_are_the_reference() {
    let mut rubbing = paper();
    rubbing.parameters.threshold_force = 20.0;
    let mut bore = paper();
    (bore.parameters.internal, bore.parameters.wheel_diameter) = (1.0, 0.04);
    // Depth, um; force, N; power, W; removal rate, mm2/s; specific energy, J/mm3; temperature rise, K.
    for (grinding, depth, force, power, removal, energy, rise) in [
        (paper(), 4.43, 170.0, 2800.1, 3.38653, 41.341, 585.55),
        (rubbing, 1.0, 58.3747, 961.49, 0.764454, 62.887, 309.37),
        (bent(), 2.0, 87.055, 1433.9, 1.52891, 46.892, 373.46),
        (bore, 2.0, 76.749, 1264.1, 1.52891, 41.341, 221.43),
    ] {
        let cut = State { depth_of_cut: depth * 1e-6, ..State::default() };
        let load = grinding.load(&cut, &Input::default());
        close(load.normal_force, force, 1e-5);
        close(load.tangential_force, force * 0.4706, 1e-5);
        close(load.power, power, 5e-5);
        close(load.removal_rate, removal * 1e-6, 1e-5);
        close(load.specific_energy, energy * 1e9, 5e-5);
        close(load.temperature_rise, rise, 2e-5);
        close(load.equivalent_chip_thickness, removal * 1e-6 / 35.0, 1e-5);
    }
}

#[test]
fn burn_by_energy_is_the_reference() {
    for (depth, energy) in [(4.43, 45.208), (2.0, 77.0165), (1.0, 125.292), (8.0, 31.2439)] {
        let cut = State { depth_of_cut: depth * 1e-6, ..State::default() };
        let load = paper().load(&cut, &Input::default());
        close(load.burn_energy.expect("cuts"), energy * 1e9, 1e-5);
        // Both are one limit: the surface burns by the one where it burns by the other.
        assert_eq!(load.burn_margin > 0.0, load.energy_margin().expect("cuts") > 0.0);
    }
    let cut = State { depth_of_cut: 4.43e-6, ..State::default() };
    let load = paper().load(&cut, &Input::default());
    close(load.burn_margin, 1.0 - 585.55 / 650.0, 1e-4);
    close(load.least_margin(), 1.0 - 41.341 / 45.208, 2e-4);
}

#[test]
fn a_force_that_is_no_straight_line_of_the_depth_follows_the_reference() {
    let mut grinding = bent();
    (grinding.parameters.threshold_force, grinding.parameters.system_stiffness) = (10.0, 31.0186e6);
    let input = Input { infeed_per_rev: 4e-6, ..Input::default() };
    let phases = [CyclePhase { infeed_per_rev: 4e-6, revolutions: 12 }];
    let (_, course) = grind_cycle(&grinding, &State::default(), &input, &phases).expect("inside the domain");
    for (revolution, depth, force) in [
        (1, 1.476287, 78.282),
        (2, 2.667555, 119.613),
        (4, 3.660258, 151.182),
        (8, 3.979475, 160.949),
        (12, 3.998774, 161.535),
    ] {
        close(course[revolution].depth_of_cut, depth * 1e-6, 1e-6);
        close(course[revolution].load.normal_force, force, 1e-5);
    }
    // The balance of each revolution.
    let p = &grinding.parameters;
    for point in &course[1..] {
        let deflection = point.commanded_infeed - point.stock_removed;
        close(p.system_stiffness * deflection, point.load.normal_force, 1e-12);
    }
}

#[test]
fn an_exponent_of_one_is_the_recursion_bit_for_bit() {
    let (straight, mut nearly) = (paper(), paper());
    nearly.parameters.force_exponent = 1.0 - 1e-12;
    let input = Input::default();
    let after = |grinding: &Infeed| {
        let mut part = grinding.initial();
        grinding.advance(&mut part, &input, 16.0 * 60.0 / 292.0).expect("inside the domain");
        part
    };
    let p = &straight.parameters;
    let (mut stock, mut depth) = (0.0, 0.0);
    for revolution in 1..=16 {
        let commanded = f64::from(revolution) * 4.43e-6;
        depth = (commanded - stock) / (p.process_stiffness / p.system_stiffness + 0.0 + 1.0);
        stock += depth;
    }
    close(after(&straight).depth_of_cut, depth, 1e-12);
    close(after(&nearly).stock_removed, after(&straight).stock_removed, 1e-10);
}

#[test]
fn cycles_within_limits_are_the_reference() {
    let as_published = designed(&paper(), &CycleLimits::default()).expect("feasible");
    assert_eq!(as_published.revolutions, 27);
    close(as_published.peak_power, 3110.0, 2e-4);
    let limits = CycleLimits { power: 2000.0, ..CycleLimits::default() };
    let cycle = designed(&paper(), &limits).expect("feasible");
    let found = phases(&cycle);
    assert_eq!([found[0].0, found[1].0, found[2].0], [29, 6, 3]);
    close(found[0].1, 3.1586, 2e-5);
    close(found[1].1, 1.4, 1e-9);
    close(cycle.peak_power, 1996.5, 3e-5);
    assert!(cycle.course.iter().all(|point| point.load.power <= 2000.0));
}

#[test]
fn a_wheel_that_dulls_within_the_part_keeps_its_limits() {
    let mut grinding = paper();
    grinding.parameters.dulling_rate = 1.0 / 300e-6;
    let limits = CycleLimits::default();
    let blind = fastest_cycle(&grinding, &State::default(), &Input::default(), &limits).expect("feasible");
    assert_eq!(blind.revolutions, 27);
    close(blind.peak_temperature_rise, 664.1, 1e-4);
    let cycle = designed(&grinding, &limits).expect("feasible");
    let found = phases(&cycle);
    assert_eq!([found[0].0, found[1].0, found[2].0], [20, 5, 3]);
    close(found[0].1, 4.675, 1e-9);
    close(found[1].1, 1.3, 1e-9);
    close(cycle.peak_temperature_rise, 639.3, 1e-4);
    // Without dulling both searches are one.
    let sharp = designed(&paper(), &limits).expect("feasible");
    assert_eq!(sharp, fastest_cycle(&paper(), &State::default(), &Input::default(), &limits).expect("feasible"));
}

#[test]
fn a_soft_process_is_ground_in_as_many_revolutions_as_the_wheel_takes() {
    let mut soft = paper();
    soft.parameters.process_stiffness = 3e6;
    let limits = CycleLimits { power: 2000.0, material_removal: 1e-2, ..CycleLimits::default() };
    let cycle = designed(&soft, &limits).expect("feasible");
    let found = phases(&cycle);
    assert_eq!([found[0].0, found[1].0, found[2].0], [3, 3, 1]);
    close(found[0].1, 30.23, 2e-4);
    close(found[1].1, 3.1, 1e-9);
    soft.parameters.process_stiffness = 8e6;
    let cycle = designed(&soft, &CycleLimits::default()).expect("feasible");
    assert!(cycle.peak_removal_rate <= 6e-6 * (1.0 + 1e-9), "{}", cycle.peak_removal_rate);
    assert!(cycle.phases[0].revolutions >= 10, "{:?}", cycle.phases);
    let slow = CycleLimits { infeed_speed: 1.2e-3 / 60.0, ..CycleLimits::default() };
    let cycle = designed(&soft, &slow).expect("feasible");
    let speed = cycle.phases[0].infeed_per_rev * 292.0 / 60.0;
    assert!(speed <= slow.infeed_speed * (1.0 + 1e-9) && cycle.phases[0].revolutions > 18, "{speed}");
}

/// A wheel on which none of the closed forms holds.
fn hard_case(exponent: f64, dulling: f64, threshold: f64, wear: f64) -> Infeed {
    let mut grinding = paper();
    let p = &mut grinding.parameters;
    (p.force_exponent, p.dulling_rate, p.threshold_force, p.wheel_wear_ratio) = (exponent, dulling, threshold, wear);
    grinding
}

/// Whether the process keeps all limits in a cycle.
fn keeps(grinding: &Infeed, limits: &CycleLimits, phases: &[CyclePhase; 3]) -> bool {
    let Ok((part, course)) = grind_cycle(grinding, &State::default(), &Input::default(), phases) else { return false };
    let (last, roughed) = (&course[course.len() - 1], &course[phases[0].revolutions as usize]);
    let infed = State {
        removed_volume: course[(phases[0].revolutions + phases[1].revolutions) as usize].removed_volume,
        ..part
    };
    let p = &grinding.parameters;
    let wear = p.wheel_wear_ratio * p.work_diameter / p.wheel_diameter;
    let tends = State { depth_of_cut: phases[1].infeed_per_rev / (1.0 + wear), ..infed };
    let finish = grinding.load(&tends, &Input::default()).temperature_rise;
    let slack = 1.0 + 1e-9;
    course.iter().all(|point| {
        point.load.temperature_rise <= limits.rough_temperature_rise * slack
            && point.load.power <= limits.power * slack
            && point.load.normal_force <= limits.normal_force * slack
            && point.load.removal_rate <= limits.material_removal * slack
            && point.load.least_margin() >= limits.burn_margin - 1e-9
    }) && (phases[1].revolutions == 0 || finish <= limits.finish_temperature_rise * slack)
        && phases[1].infeed_per_rev <= phases[0].infeed_per_rev
        && phases[0].infeed_per_rev <= limits.greatest_infeed * slack
        && last.stock_removed - roughed.stock_removed >= limits.finish_stock / slack
        && last.depth_of_cut <= limits.last_depth.min(limits.roundness_error) * slack
        && last.size_error <= limits.size_error * slack
}

/// Fewest revolutions of any cycle, by trying all of them.
fn brute_force(grinding: &Infeed, limits: &CycleLimits, most: u32) -> Option<u32> {
    (1..=most).find(|total| {
        (1..=*total).any(|rough| {
            (0..=total - rough).any(|finish| {
                (1..=12).any(|setting| {
                    let finish_infeed = f64::from(setting) * limits.infeed_step;
                    let rough_stock = limits.stock - f64::from(finish) * finish_infeed;
                    let phases = [
                        CyclePhase { infeed_per_rev: rough_stock / f64::from(rough), revolutions: rough },
                        CyclePhase { infeed_per_rev: finish_infeed, revolutions: finish },
                        CyclePhase { infeed_per_rev: 0.0, revolutions: total - rough - finish },
                    ];
                    rough_stock > 0.0 && keeps(grinding, limits, &phases)
                })
            })
        })
    })
}

#[test]
fn no_cycle_is_faster_where_the_wheel_dulls_or_the_force_is_bent() {
    let limits = CycleLimits { stock: 30e-6, finish_stock: 6e-6, infeed_step: 0.3e-6, ..CycleLimits::default() };
    let wide = CycleLimits { size_error: 0.8e-6, ..limits };
    let cases = [
        (hard_case(1.0, 1.0 / 60e-6, 0.0, 0.0), limits),
        (hard_case(0.8, 0.0, 0.0, 0.0), CycleLimits { power: 2500.0, ..limits }),
        (hard_case(0.7, 1.0 / 200e-6, 6.0, 1.0 / 60.0), wide),
        (hard_case(1.0, 1.0 / 100e-6, 6.0, 1.0 / 60.0), CycleLimits { normal_force: 140.0, ..wide }),
        (hard_case(0.9, 1.0 / 300e-6, 0.0, 0.0), CycleLimits { burn_margin: 0.2, ..limits }),
    ];
    for (grinding, limits) in cases {
        let cycle = designed(&grinding, &limits).expect("feasible");
        let fewest = brute_force(&grinding, &limits, cycle.revolutions + 1);
        assert_eq!(Some(cycle.revolutions), fewest, "{limits:?} {:?}", cycle.phases);
    }
}

#[test]
fn limits_that_no_depth_keeps_are_named() {
    let mut rubbing = paper();
    rubbing.parameters.threshold_force = 150.0;
    let wide = CycleLimits { size_error: 20e-6, ..CycleLimits::default() };
    for (limits, key) in [
        (CycleLimits { normal_force: 100.0, ..wide }, "normal_force"),
        (CycleLimits { power: 1000.0, ..wide }, "power"),
    ] {
        let error = designed(&rubbing, &limits).expect_err("the wheel rubs");
        assert_eq!(error.limits(), [key], "{error}");
    }
    let error = designed(&paper(), &CycleLimits { power: 10.0, ..wide }).expect_err("a depth of 16 nm");
    assert_eq!(error.limits(), ["power", "infeed_step"], "{error}");
    assert!(
        error.to_string().starts_with("power and infeed_step conflict: the finish infeed must stay below 0.0158 um"),
        "{error}"
    );
    let error = designed(&paper(), &CycleLimits { roughness: 0.3e-6, ..wide }).expect_err("nothing measured");
    assert_eq!(error, CycleError::NoRoughness);
}

#[test]
fn a_burn_margin_is_kept_by_both_measures() {
    let limits = CycleLimits { burn_margin: 0.3, ..CycleLimits::default() };
    let cycle = designed(&paper(), &limits).expect("feasible");
    assert!(cycle.revolutions > 27);
    assert!(cycle.least_burn_margin >= 0.3 && cycle.least_energy_margin.expect("cuts") >= 0.3 - 1e-9);
    // The specific energy binds: with the margin by temperature alone there would be room.
    assert!(cycle.least_energy_margin.expect("cuts") < cycle.least_burn_margin);
}

/// Ra 0.5 um at 3.3865 mm2/s, dressed with a lead of 0.1 mm and a depth of 20 um.
fn surface() -> Surface {
    Surface { measured: 0.5e-6, removal_rate: 3.3865e-6, ..Surface::default() }
}

#[test]
fn roughness_follows_dressing_and_removal_rate() {
    let dressing = DressingPlan::default();
    close(dressing.overlap(), 5.0, 1e-12);
    assert_eq!(dressing.warning(), None);
    let thread = DressingPlan { lead: 0.4e-3, ..dressing };
    assert!(thread.warning().expect("a thread").contains("smaller lead"));
    let blunt = DressingPlan { lead: 0.02e-3, ..dressing };
    assert!(blunt.warning().expect("blunt").contains("greater lead"));
    // Ra/R2 = 0.059015 with mm and um.
    close(0.5 / surface().constant(35.0), 0.059015, 2e-5);
    let at = |removal: f64, dressing: &DressingPlan| surface().under_infeed(removal, 35.0, 35.0, dressing);
    close(at(3.3865e-6, &dressing), 0.5e-6, 1e-12);
    close(at(3.3865e-6, &thread), 1e-6, 1e-12);
    close(at(2.0 * 3.3865e-6, &dressing), 0.5e-6 * 2f64.powf(0.3), 1e-12);
    close(at(3.3865e-6, &DressingPlan { depth: 320e-6, ..dressing }), 1e-6, 1e-12);
}

#[test]
fn a_limit_of_roughness_is_kept_by_finer_finishing_and_spark_out() {
    let (dressing, surface) = (DressingPlan::default(), surface());
    let known = Some((&surface, &dressing, 35.0));
    let (wheel, input) = (State::default(), Input::default());
    let mut grinding = paper();
    for dulling in [0.0, 1.0 / 300e-6] {
        grinding.parameters.dulling_rate = dulling;
        let revolutions = |roughness: f64| {
            let limits = CycleLimits { roughness, ..CycleLimits::default() };
            fastest_cycle_while_dulling(&grinding, &wheel, &input, &limits, known)
        };
        let free = revolutions(1e-3).expect("feasible");
        let rough = free.roughness.expect("measured");
        // 1.3 um/rev and 3 revolutions of spark-out towards one half.
        let infed = free.course.len() - 1 - free.phases[2].revolutions as usize;
        let left: f64 = free.course[infed + 1..].iter().map(|point| point.decay).product();
        let expected = surface.under_infeed(free.course[infed].load.removal_rate, 35.0, 35.0, &dressing);
        close(rough, expected * (0.5 + 0.5 * left), 1e-12);
        let fine = revolutions(0.95 * rough).expect("feasible");
        assert!(fine.roughness.expect("measured") <= 0.95 * rough * (1.0 + 1e-9));
        assert!(fine.revolutions > free.revolutions, "{}", fine.revolutions);
        let error = revolutions(0.02e-6).expect_err("too fine");
        assert!(matches!(error, CycleError::TooRough { .. }), "{error}");
    }
}

#[test]
fn a_wheel_lasts_as_many_dressings_as_its_radius_allows() {
    let dressing = DressingPlan { least_wheel_diameter: 0.3, passes: 2.0, ..DressingPlan::default() };
    let life = dressing.wheel_life(&paper(), 44, 100e-6).expect("asked for");
    close(life.lost, 40e-6, 1e-12);
    assert_eq!((life.dressings, life.parts), (1250.0, 55_000.0));
    close(life.diameter, 0.3, 1e-9);
    close(life.wheel_speed, 35.0 * 0.75, 1e-9);
    assert_eq!(DressingPlan::default().wheel_life(&paper(), 44, 100e-6), None);
}

#[test]
fn a_cycle_file_is_designed_for_the_wheel_that_it_names() {
    let text = "schema = 1\n[parameters]\ndulling_rate = \"0.00066667 mm/mm3\"\n";
    let read = |set: &[&str]| {
        let set: Vec<String> = set.iter().map(|&change| change.to_owned()).collect();
        CycleFile::parse("cycle.toml", text, &set)
    };
    let cycle = |set: &[&str]| read(set).expect("a cycle file").content;
    let volume = std::f64::consts::PI * 0.05 * 100e-6;
    // The 46th part is begun at 706.9 mm3/mm, below the dressing limit of 720.
    close(cycle(&[]).wheel_before(None).removed_volume, 45.0 * volume, 1e-9);
    assert_eq!(cycle(&["wheel=dressed"]).wheel_before(None).removed_volume, 0.0);
    close(cycle(&["wheel=300 mm3/mm"]).wheel_before(None).removed_volume, 300e-6, 1e-12);
    let revolutions = |set: &[&str]| cycle(set).fastest_cycle().expect("feasible").revolutions;
    let (worst, middle, dressed) =
        (revolutions(&[]), revolutions(&["wheel=300 mm3/mm"]), revolutions(&["wheel=dressed"]));
    assert!(dressed == 27 && dressed < middle && middle < worst, "{dressed} {middle} {worst}");
    for bad in ["wheel=blunt", "wheel=300 mm", "wheel=-3 mm3/mm"] {
        let error = read(&[bad]).expect_err("no wheel");
        assert!(error.to_string().contains("300 mm3/mm"), "{error}");
    }
    let error = read(&["roughness.lead=0.2 mm"]).expect_err("nothing measured");
    assert!(error.to_string().contains("measured"), "{error}");
    let rough = cycle(&["roughness.measured=0.4 um", "roughness.removal_rate=3 mm2/s", "dressing.lead=0.2 mm"]);
    assert_eq!(rough.surface.expect("given").lead, 0.2e-3);
    assert!(rough.fastest_cycle().expect("feasible").roughness.is_some());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    /// Whatever is found keeps the limits when the process itself grinds it.
    #[test]
    fn a_cycle_that_is_found_keeps_its_limits(
        lag in 0.2..0.75f64, stock in 15e-6..120e-6f64, exponent in 0.5..1.0f64, dulling in 0.0..3000.0f64,
        power in 500.0..6000.0f64, threshold in 0.0..8.0f64,
    ) {
        let mut grinding = hard_case(exponent, dulling, threshold, 0.01);
        grinding.parameters.system_stiffness = stiffness_from_k(grinding.parameters.process_stiffness, lag);
        let limits = CycleLimits { stock, power, size_error: 2e-6, ..CycleLimits::default() };
        if let Ok(cycle) = designed(&grinding, &limits) {
            let slack = 1.0 + 1e-9;
            prop_assert!(cycle.course.iter().all(|point| point.load.power <= power * slack));
            prop_assert!(cycle.peak_removal_rate <= 6e-6 * slack);
            prop_assert!(cycle.peak_temperature_rise <= 650.0 * slack);
            prop_assert!(cycle.finish_stock >= 12e-6 / slack && cycle.last_depth <= 0.3e-6 * slack);
            prop_assert!(cycle.size_error <= 2e-6 * slack);
        }
    }
}
