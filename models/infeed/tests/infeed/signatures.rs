//! Signatures of hidden effects against the reference tables.

use crate::paper::{K, SIX_DIGITS, close, paper};
use proptest::prelude::*;
use toolroom_infeed::{
    CyclePhase, Input, PlungeDesign, PlungeDeviations, PlungeShape, Separability, State, separability, stock_after,
};
use toolroom_process::Process;

const GAUGED: [usize; 5] = [6, 10, 16, 24, 30];

/// Stock after five lengths, and the force of 30 revolutions and 6 of spark-out.
fn trials(deviations: PlungeDeviations) -> (Vec<(f64, f64)>, Vec<f64>) {
    let phases =
        [CyclePhase { infeed_per_rev: 4.43e-6, revolutions: 30 }, CyclePhase { infeed_per_rev: 0.0, revolutions: 6 }];
    let readings = paper().plunge(&Input::default(), &phases, &deviations);
    let stock = GAUGED.map(|n| (n as f64, readings[n - 1].stock_removed)).to_vec();
    (stock, readings.iter().map(|reading| reading.normal_force).collect())
}

/// K_P, K_F, residual and its trend in um, F30/F10, F_end/F30.
#[track_caller]
fn shape_is((stock, force): (Vec<(f64, f64)>, Vec<f64>), expected: [f64; 6]) {
    let shape = PlungeShape::from_stock(&stock, 4.43e-6, &force, 30).expect("a shape");
    close(shape.stock_lag, expected[0], SIX_DIGITS);
    close(shape.force_lag, expected[1], SIX_DIGITS);
    close(shape.stock_residual, expected[2] * 1e-6, SIX_DIGITS);
    close(shape.residual_per_revolution, expected[3] * 1e-6, SIX_DIGITS);
    close(shape.late_rise, expected[4], SIX_DIGITS);
    close(shape.floor, expected[5], SIX_DIGITS);
}

#[test]
fn every_hidden_effect_has_the_reference_shape() {
    let none = PlungeDeviations::default();
    shape_is(
        trials(PlungeDeviations { wheel_wear_ratio: 1.0 / 20.0, ..none }),
        [0.571396, 0.551459, 0.228392, -0.0258335, 1.00261, 0.0281243],
    );
    shape_is(
        trials(PlungeDeviations { threshold_force: 40.0, ..none }),
        [0.605537, 0.553, 0.0548745, 0.00458431, 1.00268, 0.213628],
    );
    shape_is(
        trials(PlungeDeviations { infeed_error: -0.01, ..none }),
        [0.584152, 0.553, 0.366007, -0.0413808, 1.00268, 0.028599],
    );
    shape_is(
        trials(PlungeDeviations { unseen_depth: 0.5, ..none }),
        [0.636552, 0.553, 0.114526, 0.00973034, 1.00268, 0.028599],
    );
    shape_is(
        trials(PlungeDeviations { dulling_per_revolution: 0.02, ..none }),
        [0.622078, 0.783129, 0.879046, -0.0992788, 1.33798, 0.0935532],
    );
    // The reference counts half a revolution less in the closed form, the force being as before.
    let (_, force) = trials(none);
    let late = GAUGED.map(|n| (n as f64, stock_after(4.43e-6, n as f64 - 0.5, K))).to_vec();
    shape_is((late, force), [0.636606, 0.553, 0.118312, 0.0100276, 1.00268, 0.028599]);
    let (stock, force) = trials(none);
    let shape = PlungeShape::from_stock(&stock, 4.43e-6, &force, 30).expect("a shape");
    close(shape.stock_lag, K, 1e-7);
    close(shape.force_lag, K, 1e-7);
    assert!(shape.stock_residual < 1e-12);
}

/// The seven effects of the reference, in its order.
fn signatures() -> Vec<Vec<f64>> {
    let none = PlungeDeviations::default();
    [
        PlungeDeviations { wheel_wear_ratio: 1.0 / 20.0, ..none },
        PlungeDeviations { threshold_force: 5.0, ..none },
        PlungeDeviations { infeed_error: -0.01, ..none },
        PlungeDeviations { late_start: 0.1, ..none },
        PlungeDeviations { dulling_per_revolution: 0.005, ..none },
        PlungeDeviations { thermal_growth: 2e-6, ..none },
        PlungeDeviations { force_exponent_loss: 0.1, ..none },
    ]
    .iter()
    .map(|deviations| PlungeDesign::default().signature(&paper(), &Input::default(), deviations))
    .collect()
}

const AFTER_REFIT: [f64; 7] = [1.56492, 6.90755, 2.5194, 3.50612, 4.58481, 2.62158, 7.57349];

#[rustfmt::skip]
const COS2: [[f64; 7]; 7] = [
    [1.000, 0.000, 1.000, 0.106, 0.026, 0.029, 0.000],
    [0.000, 1.000, 0.000, 0.128, 0.021, 0.328, 0.615],
    [1.000, 0.000, 1.000, 0.106, 0.026, 0.029, 0.000],
    [0.106, 0.128, 0.106, 1.000, 0.188, 0.067, 0.323],
    [0.026, 0.021, 0.026, 0.188, 1.000, 0.257, 0.043],
    [0.029, 0.328, 0.029, 0.067, 0.257, 1.000, 0.478],
    [0.000, 0.615, 0.000, 0.323, 0.043, 0.478, 1.000],
];

fn cos2_within(separability: &Separability, tolerance: f64) {
    for (row, expected) in separability.cos2.iter().zip(COS2) {
        for (cos2, expected) in row.iter().zip(expected) {
            assert!((cos2 - expected).abs() <= tolerance, "{cos2} computed, {expected} expected");
        }
    }
}

/// The reference takes the derivatives of its baseline from one step of a thousandth.
#[test]
fn the_reference_table_of_separability_is_met() {
    let (design, grinding, input) = (PlungeDesign::default(), paper(), Input::default());
    let mut stepped = [grinding.clone(), grinding.clone()];
    stepped[0].parameters.process_stiffness *= 1.001;
    stepped[1].parameters.system_stiffness *= 1.001;
    let none = PlungeDeviations::default();
    let nominal = design.whitened(&grinding, &input, &none);
    let baseline = stepped.map(|other| {
        design.whitened(&other, &input, &none).iter().zip(&nominal).map(|(a, b)| a - b).collect::<Vec<f64>>()
    });
    let told = separability(&baseline, &signatures());
    for (size, expected) in told.size.iter().zip([2.51449, 13.2363, 4.16675, 4.88787, 17.7248, 8.06218, 8.58111]) {
        close(*size, expected, SIX_DIGITS);
    }
    for (size, expected) in told.size_after_refit.iter().zip(AFTER_REFIT) {
        close(*size, expected, SIX_DIGITS);
    }
    cos2_within(&told, 0.0006);
}

#[test]
fn with_exact_derivatives_it_differs_by_less_than_the_step_of_the_reference() {
    let design = PlungeDesign::default();
    let told = separability(&design.baseline(&paper(), &Input::default()), &signatures());
    for (size, expected) in told.size_after_refit.iter().zip(AFTER_REFIT) {
        close(*size, expected, 2e-4);
    }
    cos2_within(&told, 0.0015);
    assert_eq!(told.confusion_set(0, 0.9), [0, 2]);
    assert_eq!(told.confusion_set(1, 0.9), [1]);
}

#[test]
fn without_deviations_a_plunge_is_the_process() {
    let grinding = paper();
    let phases = PlungeDesign::default().phases;
    let readings = grinding.plunge(&Input::default(), &phases, &PlungeDeviations::default());
    let mut part = State::default();
    let mut reading = 0;
    for phase in &phases {
        let input = Input { infeed_per_rev: phase.infeed_per_rev, ..Input::default() };
        for _ in 0..phase.revolutions {
            part.commanded_infeed += phase.infeed_per_rev;
            part = grinding.revolution(&part, &input);
            close(readings[reading].stock_removed, part.stock_removed, 1e-13);
            close(readings[reading].normal_force, grinding.output(&part, &input).normal_force, 1e-11);
            reading += 1;
        }
    }
}

#[test]
fn a_shape_needs_stock_and_a_rise() {
    let (stock, force) = trials(PlungeDeviations::default());
    assert!(PlungeShape::from_stock(&stock[..1], 4.43e-6, &force, 30).is_none());
    assert!(PlungeShape::from_stock(&stock, 4.43e-6, &force[..2], 2).is_none());
    assert!(PlungeShape::from_stock(&stock, 4.43e-6, &force, 99).is_none());
}

proptest! {
    #[test]
    fn a_bent_force_law_still_shares_out_the_whole_engagement(
        loss in 0.0..0.8f64, threshold_force in 0.0..60.0f64, ratio in 0.0..0.1f64,
    ) {
        let grinding = paper();
        let deviations = PlungeDeviations {
            force_exponent_loss: loss, threshold_force, wheel_wear_ratio: ratio, ..PlungeDeviations::default()
        };
        let phases = [CyclePhase { infeed_per_rev: 4.43e-6, revolutions: 12 }];
        let readings = grinding.plunge(&Input::default(), &phases, &deviations);
        let wear = 1.0 + ratio * 50.0 / 400.0;
        for (i, reading) in (1..).zip(&readings) {
            // What is commanded is cut, worn off the wheel, or deflection.
            let deflection = reading.normal_force / grinding.parameters.system_stiffness;
            let commanded = 4.43e-6 * f64::from(i);
            let rubs = threshold_force / grinding.parameters.system_stiffness > commanded;
            prop_assert!(rubs || (reading.stock_removed * wear + deflection - commanded).abs() < 1e-15, "{reading:?}");
        }
    }

    #[test]
    fn any_vectors_have_a_separability(
        baseline in prop::collection::vec(prop::collection::vec(-1e3..1e3f64, 6), 0..4),
        signatures in prop::collection::vec(prop::collection::vec(-1e3..1e3f64, 6), 1..5),
    ) {
        let told = separability(&baseline, &signatures);
        for (i, row) in told.cos2.iter().enumerate() {
            prop_assert!(told.size_after_refit[i] <= told.size[i] * (1.0 + 1e-9));
            for cos2 in row {
                prop_assert!((0.0..=1.0 + 1e-9).contains(cos2));
            }
        }
    }
}
