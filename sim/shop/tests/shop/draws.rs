//! Tools whose parameters come from a posterior.

use std::sync::Arc;
use toolroom_scenario::{DrawTable, Posterior, Scenario};
use toolroom_shop::run;

const WEAR: &str = "energy_balance.thermal_wear_rate [um/min]";

/// The shipped steel shop over a short time, its turning tool with draws of one wear rate.
fn shop(rates: &[f64]) -> (Scenario, Scenario) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/steel-shafts.toml");
    let plain =
        toolroom_scenario_file::read(file.as_ref(), &["shop.horizon=30 h".to_owned()]).expect("shipped").scenario;
    let mut drawn = plain.clone();
    let tool = drawn.tools.iter_mut().find(|tool| tool.process.pair().is_some()).expect("a turning tool");
    let rows = rates.iter().map(|rate| vec![format!("{rate:?}")]).collect();
    let table = DrawTable { header: vec![WEAR.to_owned()], rows };
    tool.posterior = Some(Arc::new(Posterior::of(&table, &tool.process, false).expect("draws")));
    (plain, drawn)
}

/// The wear rate of the set, um/min.
fn of_set(plain: &Scenario) -> f64 {
    let pair = plain.tools.iter().find_map(|tool| tool.process.pair()).expect("a turning tool");
    let toolroom_wear::WearLaw::EnergyBalance(law) = pair.law else { panic!("an energy balance") };
    toolroom_process::unit::convert(law.thermal_wear_rate, "m/s", "um/min")
}

#[test]
fn draws_that_are_all_the_set_give_the_run_of_the_set() {
    let rate = of_set(&shop(&[1.0]).0);
    let (plain, drawn) = shop(&[rate; 7]);
    for policy in 0..plain.policies.len() {
        let (a, b) = (run(&plain, policy, 3).expect("a run"), run(&drawn, policy, 3).expect("a run"));
        assert_eq!(a.digest, b.digest, "policy {policy}");
        assert_eq!(format!("{:?}", a.passes), format!("{:?}", b.passes), "policy {policy}");
    }
}

#[test]
fn a_draw_changes_the_true_wear_and_not_what_controllers_believe() {
    let rate = of_set(&shop(&[1.0]).0);
    let (plain, drawn) = shop(&[3.0 * rate]);
    let (a, b) = (run(&plain, 0, 0).expect("a run"), run(&drawn, 0, 0).expect("a run"));
    let first = |log: &toolroom_shop::RunLog| log.passes.first().map(|pass| (pass.speed_start, pass.flank_wear_end));
    let (a, b) = (first(&a).expect("a pass"), first(&b).expect("a pass"));
    assert_eq!(a.0.to_bits(), b.0.to_bits(), "the same speed is chosen");
    assert!(b.1 > a.1, "{b:?} against {a:?}");
}

#[test]
fn replications_of_one_draw_share_it_under_every_policy() {
    let rate = of_set(&shop(&[1.0]).0);
    let rates: Vec<f64> = (1..=16).map(|i| rate * f64::from(i) / 8.0).collect();
    let (_, drawn) = shop(&rates);
    assert!(drawn.policies.len() > 1 && drawn.replications_per_draw() == 4);
    let wear = |replication| of_set(&drawn.drawn(replication).expect("a draw"));
    assert!((0..4).all(|replication| wear(replication).to_bits() == wear(0).to_bits()));
    let mut met: Vec<u64> = (0..16).map(|draw| wear(4 * draw).to_bits()).collect();
    met.sort_unstable();
    met.dedup();
    assert_eq!(met.len(), 16, "every draw once");
}
