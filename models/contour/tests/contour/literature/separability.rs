//! What measurements of a milled contour can tell apart.

use super::fixture::{decimals, mc1, setting, six};
use toolroom_contour::{Models, Parameters, Pass, Planner};

/// Power, wall error and time of every section at two feeds, each over its noise: 3 % of the
/// power, 2 µm, 0.5 % of the time.
fn measured(parameters: &Parameters, pass: &Pass, extra_time: f64, offset: f64) -> Vec<[f64; 3]> {
    let (contour, models) = (mc1(), Models::default());
    let planner = Planner::new(&contour, parameters, pass, &models).unwrap();
    let at = |feed: f64| {
        let plan = planner.plan(&vec![setting(1250.0, feed); contour.sections.len()]).unwrap();
        let row = |section: &toolroom_contour::PlannedSection| {
            [section.evaluation.power, section.evaluation.wall_error() + offset, section.time + extra_time]
        };
        plan.sections.iter().map(row).collect::<Vec<_>>()
    };
    [at(0.04), at(0.10)].concat()
}

#[test]
fn m13_what_looks_alike() {
    let (nominal, pass) = (Parameters::default(), Pass::default());
    let with = |change: fn(&mut Parameters)| {
        let mut parameters = nominal.clone();
        change(&mut parameters);
        measured(&parameters, &pass, 0.0, 0.0)
    };
    let base = measured(&nominal, &pass, 0.0, 0.0);
    let effects = [
        with(|p| {
            p.force.tangential_cutting *= 1.05;
            p.force.radial_cutting *= 1.05;
        }),
        with(|p| {
            p.force.tangential_edge *= 1.1;
            p.force.radial_edge *= 1.1;
        }),
        measured(&nominal, &Pass { allowance: 0.55e-3, ..pass }, 0.0, 0.0),
        with(|p| p.cutter.holder_stiffness *= 0.8),
        with(|p| p.machine.position_gain *= 0.8),
        measured(&nominal, &pass, 0.1, 0.0),
        measured(&nominal, &pass, 0.0, 5e-6),
    ];
    let whitened: Vec<Vec<f64>> = (effects.iter())
        .map(|effect| {
            let pairs = effect.iter().zip(&base);
            pairs
                .flat_map(|(e, b)| {
                    [(e[0] - b[0]) / (0.03 * b[0]), (e[1] - b[1]) / 2e-6, (e[2] - b[2]) / (0.005 * b[2])]
                })
                .collect()
        })
        .collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let norms = [4.34504, 7.33907, 12.138, 5.99843, 8.37168, 42.5167, 11.1803];
    for (effect, norm) in whitened.iter().zip(norms) {
        six("norm", dot(effect, effect).sqrt(), norm);
    }
    // Ktc, Kte, allowance, holder, position gain, acceleration, offset.
    #[rustfmt::skip]
    let table = [
        [1.000, 0.762, 0.976, 0.073, 0.060, 0.000, 0.036],
        [0.762, 1.000, 0.874, 0.071, 0.024, 0.000, 0.067],
        [0.976, 0.874, 1.000, 0.103, 0.070, 0.000, 0.061],
        [0.073, 0.071, 0.103, 1.000, 0.579, 0.000, 0.679],
        [0.060, 0.024, 0.070, 0.579, 1.000, 0.000, 0.094],
        [0.000, 0.000, 0.000, 0.000, 0.000, 1.000, 0.000],
        [0.036, 0.067, 0.061, 0.679, 0.094, 0.000, 1.000],
    ];
    for (a, row) in whitened.iter().zip(table) {
        for (b, share) in whitened.iter().zip(row) {
            decimals("cos^2", dot(a, b).powi(2) / (dot(a, a) * dot(b, b)), share, 3);
        }
    }
}
