//! When channels were read: at the end of operations, or all through them.

use nalgebra::DVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::fmt::Write as _;
use toolroom_calibrate::{Calibration, Edge, Law, Measured, Model, Request, Stretch, WearModel, When};
use toolroom_records::{RecordKind, parse_csv};
use toolroom_wear::{Cut, Pair};

const HEADER: &str = "operation_id,machine,tool_id,sequence,cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],\
                      cutting_time [min],flank_wear [mm],cutting_force [N]\n";
/// Points of every operation at which the land is known.
const POINTS: usize = 16;
/// Stress on the land over that of the set.
const STRESS: f64 = 1.5;

/// Records of six edges with eight operations each, by Taylor's law, with the force at the end of an operation or its mean.
fn table(base: &Pair, when: When) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut rows = HEADER.to_owned();
    for (index, speed) in [180.0, 180.0, 220.0, 220.0, 300.0, 300.0_f64].into_iter().enumerate() {
        let (time, cut) = (4.0 * (220.0 / speed).powi(5), Cut::nominal(speed / 60.0, 0.3e-3, 1.5e-3));
        let stretches = vec![Stretch::read(0, time / POINTS as f64, 0.0); 8 * POINTS];
        let edge = Edge { name: format!("E{index}"), stretches, life: None, begun: None };
        let model = WearModel::new(Law::ExtendedTaylor, base, vec![cut], vec![edge], 0.3);
        let truth = model.parameters().iter().map(|parameter| match parameter.name.as_str() {
            "extended_taylor.reference_life" => 60f64.ln(),
            "edge_scatter" => 0.15f64.ln(),
            "reading_noise" => 1e-5f64.ln(),
            _ => parameter.prior.mean,
        });
        let truth = DVector::from_iterator(model.parameters().len(), truth);
        let wear = model.replicate(truth.as_slice(), 0, &mut random);
        for (operation, lands) in wear.chunks(POINTS).enumerate() {
            let land = match when {
                When::End => lands[POINTS - 1],
                When::OverCut => lands.iter().sum::<f64>() / POINTS as f64,
            };
            let load = base.force.load(&cut);
            let error = 1.0 + [0.004, -0.002, 0.0, 0.002, -0.004][(index + operation) % 5];
            let force = (load.sharp + STRESS * load.shear_per_wear * land * 1e-3) * error;
            let (sequence, read) = (operation + 1, lands[POINTS - 1]);
            let _ = writeln!(
                rows,
                "O{index}{operation},L1,E{index},{sequence},{speed},0.3,1.5,{time},{read:.4},{force:.2}"
            );
        }
    }
    rows
}

#[test]
fn the_data_say_whether_a_force_is_that_of_the_end_or_the_mean_of_the_cut() {
    let base = Pair::named("c45_t15k6").expect("shipped");
    for when in [When::End, When::OverCut] {
        let records = parse_csv("wear.csv", table(&base, when).as_bytes(), RecordKind::Turning).expect("records").0;
        let request = Request {
            candidates: vec![Law::ExtendedTaylor.into()],
            limit: 0.3,
            draws: 1000,
            seed: 3,
            ..Request::default()
        };
        let measured = Measured::of(&records, 0.3).expect("edges");
        let calibration = Calibration::new(measured, &base, request).expect("a calibration");
        let force = calibration.channels.first().expect("forces");
        assert!(force.when == when && force.lead > 2.0, "{when:?}: {:?} by {}", force.when, force.lead);
        let names = force.model.parameters();
        let place = names.iter().position(|parameter| parameter.name == "force.flank_shear_stress").expect("named");
        let [low, high] = [0.01, 0.99].map(|share| force.posterior.quantile(place, share).exp());
        let stress = STRESS * base.force.flank_shear_stress * 1e-6;
        assert!(low < stress && stress < high, "{when:?}: {low} … {high} against {stress}");
    }
}
