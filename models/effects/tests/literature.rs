//! Each effect against one number that was published or follows from its source.

use toolroom_effects::{Context, Effect, Effects, Terms};

fn terms(effect: Effect, context: Context) -> Terms {
    Effects::new(vec![effect]).expect("one effect").terms(&context)
}

fn named(id: &str, size: f64) -> Effect {
    Effect::named(id).expect("in the catalogue").with_size(size)
}

fn close(value: f64, expected: f64, relative: f64) {
    assert!((value / expected - 1.0).abs() <= relative, "{value} computed, {expected} published");
}

/// Vicomtech turning set, 13 tools: F_c = 510 + 446 VB, F_f = 243 + 1507 VB (N, mm).
#[test]
fn wear_force_is_the_vicomtech_regression() {
    let mut effect = named("wear_force", 446.0 * 0.3 / 510.0);
    effect.parameters_mut().set_value(2, (1507.0 / 243.0) / (446.0 / 510.0));
    let worn = terms(effect, Context { flank_wear: 0.5e-3, ..Context::neutral() });
    close(510.0 * worn.cutting_force, 733.0, 1e-12);
    close(243.0 * worn.feed_force, 996.5, 1e-12);
}

/// NASA/UC Berkeley milling wear data: a three-stage fit gives ln(rate(0.5 mm)/rate(0.25 mm)) =
/// 0.25 · 1.8 for the median of seven edges, which is size 0.336.
#[test]
fn wear_acceleration_spans_the_nasa_milling_edges() {
    let rate = |size: f64, wear: f64| {
        terms(named("wear_acceleration", size), Context { flank_wear: wear, ..Context::neutral() }).wear_rate
    };
    close(rate(0.336, 0.5e-3) / rate(0.336, 0.25e-3), (0.25 * 1.8f64).exp(), 1e-3);
    // The steepest edges (13 per mm) lie outside: a square cannot rise by more than four.
    assert!(rate(50.0, 0.5e-3) / rate(50.0, 0.25e-3) < (0.25 * 13.0f64).exp());
}

/// PHM 2010 cutter c1, largest flute: 48.9, 89.8, 94.6, 101.2 um after 1, 50, 100, 150 cuts. The
/// steady rate of cuts 100 to 150 and a run-in of size 25, 12 cuts long, give the first 50.
#[test]
fn run_in_explains_the_first_cuts_of_phm_2010() {
    let steady = (101.2 - 94.6) / 50.0;
    let mut effect = named("run_in", 25.0);
    effect.parameters_mut().set_value(1, 12.0);
    let worn: f64 = (1..50)
        .map(|cut| steady * terms(effect, Context { cutting_time: f64::from(cut), ..Context::neutral() }).wear_rate)
        .sum();
    close(worn, 89.8 - 48.9, 0.1);
}

/// ISCAR: k_c1.1 = 1350 N/mm² for VDI 3323 group 1 (125 HB), 1675 for group 3 (250 HB).
#[test]
fn lot_hardness_spans_the_unalloyed_steels() {
    let hard = terms(named("lot_hardness", 0.2407), Context { lot_deviation: 1.0, ..Context::neutral() });
    close(1350.0 * hard.specific_cutting_force, 1675.0, 1e-3);
    let nominal = terms(named("lot_hardness", 0.2407), Context::neutral());
    assert_eq!(nominal, Terms::neutral());
}

/// A total indicator reading of 0.0005 in is an offset of 0.00025 in; with two teeth chips of
/// 0.002 in become 0.0025 and 0.0015 in (shop rule f_z ± TIR).
#[test]
fn runout_is_half_the_dial_gauge_reading() {
    let inch = 0.0254;
    let offset = terms(named("runout", 0.00025 * inch), Context::neutral()).runout;
    let extra = 2.0 * offset * (std::f64::consts::PI / 2.0).sin();
    close(0.002 * inch + extra, 0.0025 * inch, 1e-12);
}

/// Of these no published size was found; the numbers are those of their stated form.
#[test]
fn the_assumed_forms_give_their_numbers() {
    let hot = Context { flank_wear: 0.15e-3, coolant_age: 72.0 * 3600.0, ..Context::neutral() };
    close(terms(named("wear_temperature", 0.1), hot).temperature_rise, 1.05, 1e-12);
    close(terms(named("coolant_ageing", 0.001 / 3600.0), hot).temperature_rise, 1.072, 1e-12);
    close(terms(named("thermal_heredity", 2.0), hot).thermal_damage_coupling, 2.0, 1e-12);
    close(terms(named("threshold_force", 20.0), hot).threshold_force, 20.0, 1e-12);
    // Nine parts of 15.708 mm3/mm before the tenth: 1.09425.
    let tenth = Context { removed_volume: 9.0 * 15.708e-6, coolant_changed: 1.0, ..Context::neutral() };
    close(terms(named("wheel_dulling", 1.0), tenth).process_stiffness, 1.09425, 1e-5);
    close(terms(named("coolant_change", 0.25), tenth).process_stiffness, 0.75, 1e-12);
}

/// Altintas, Eynian and Onozuka 2008: 6.11e5 N/m in carbon steel. Zakovorotny et al., eq. (1): a
/// modulation of 0.3 makes the clamping 1.3/0.7 times as stiff over a jaw as between two.
#[test]
fn damping_and_modulation_pass_on_what_was_measured() {
    close(terms(named("process_damping", 6.11e5), Context::neutral()).process_damping, 6.11e5, 1e-12);
    let mu = terms(named("chuck_stiffness", 0.3), Context::neutral()).chuck_modulation;
    close((1.0 + mu) / (1.0 - mu), 13.0 / 7.0, 1e-12);
}

/// A change either way is a factor on all modes; nothing else of a cut moves.
#[test]
fn modes_change_either_way() {
    for (id, size) in [("mode_frequency", -0.05), ("mode_damping", 0.4), ("mode_stiffness", -0.3)] {
        let changed = terms(named(id, size), Context::neutral());
        let factors = [changed.mode_frequency, changed.mode_damping, changed.mode_stiffness];
        let expected =
            ["mode_frequency", "mode_damping", "mode_stiffness"].map(|own| if own == id { 1.0 + size } else { 1.0 });
        assert_eq!(factors, expected, "{id}");
        let rest = Terms { mode_frequency: 1.0, mode_damping: 1.0, mode_stiffness: 1.0, ..changed };
        assert_eq!(rest, Terms::neutral(), "{id}");
    }
}
