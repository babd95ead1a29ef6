//! Identification against the reference tables, on fresh trials, and on bad ones.

use crate::paper::{SIX_DIGITS, close};
use proptest::prelude::*;
use toolroom_infeed::{
    Advice, Basis, CyclePhase, ForceSample, Identification, IdentifyError, IdentifyOptions, Infeed, Input,
    MeasurementErrors, Scatter, State, TableNote, TableReason, Trial, TrialFault, fit_force_trace, grind_cycle,
    identify, lag, lag_from_stock, lag_sd, paper_trials, read_force_traces, read_trials, revolutions_of_least_error,
    stiffness_from_k, stock_after,
};
use toolroom_process::Process;

fn paper() -> Identification {
    identify(&paper_trials(), &IdentifyOptions::default()).expect("possible trials")
}

#[test]
fn each_trial_has_the_reference_lag_and_stiffnesses() {
    let rows = [
        (0.524176, 16, 38.3747, 34.8349, 0.470588),
        (0.603305, 16, 37.3303, 24.546, 0.472727),
        (0.542099, 18, 38.3408, 32.3858, 0.479532),
        (0.55243, 17, 38.5135, 31.2031, 0.467836),
        (0.542561, 17, 36.0465, 30.3912, 0.464516),
    ];
    let found = paper();
    for (trial, (lag, n, cp, j, ratio)) in found.trials.iter().zip(rows) {
        close(trial.lag.value, lag, SIX_DIGITS);
        // The reference takes the force for that of the end, which it has not come to.
        let reached = 1.0 - trial.lag.value.powi(n);
        close(trial.process_stiffness.expect("a force") * reached, cp * 1e6, SIX_DIGITS);
        close(trial.system_stiffness.expect("a force") * reached, j * 1e6, SIX_DIGITS);
        close(trial.force_ratio.expect("both forces"), ratio, SIX_DIGITS);
    }
    close(found.lag.mean, 0.552914, SIX_DIGITS);
    close(found.lag.sd.expect("scatter"), 0.0299565, SIX_DIGITS);
}

#[test]
fn the_pooled_estimate_is_the_reference() {
    let pooled = paper().pooled.expect("all have stock");
    close(pooled.lag, 0.554672, SIX_DIGITS);
    close(pooled.sd_stock.expect("five trials"), 0.71172e-6, SIX_DIGITS);
    let residuals = [0.637286e-6, -1.21517e-6, 0.274957e-6, 0.0499377e-6, 0.25557e-6];
    for (residual, expected) in pooled.residuals.iter().zip(residuals) {
        close(*residual, expected, SIX_DIGITS);
    }
    close(pooled.residuals.iter().map(|each| each * each).sum(), 2.02618e-12, SIX_DIGITS);
}

#[test]
fn the_intervals_are_the_reference() {
    let found = paper();
    let interval = |interval: Option<[f64; 2]>, [low, high]: [f64; 2]| {
        let [a, b] = interval.expect("five trials");
        close(a, low, SIX_DIGITS);
        close(b, high, SIX_DIGITS);
    };
    interval(found.lag.ci95, [0.515718, 0.59011]);
    interval(found.lag.prediction95, [0.461803, 0.644025]);
    let bootstrap = found.bootstrap.expect("five trials");
    assert_eq!((bootstrap.resamples, bootstrap.exact), (3125, true));
    interval(Some(bootstrap.ci95), [0.533503, 0.579008]);
    close(bootstrap.median, 0.552822, SIX_DIGITS);
    for (mean, expected) in found.jackknife.iter().zip([0.560099, 0.540316, 0.555618, 0.553035, 0.555502]) {
        close(*mean, expected, SIX_DIGITS);
    }
    close(found.lag.median, 0.542561, SIX_DIGITS);
    let cp = found.process_stiffness.expect("forces");
    // With the force that the trials have come to, 1 − K^n of its end, computed apart from this crate.
    close(cp.mean, 37.7244e6, SIX_DIGITS);
    close(cp.sd.expect("scatter"), 1.04743e6, SIX_DIGITS);
    let j = found.system_stiffness.expect("forces");
    close(j.mean, 30.6745e6, SIX_DIGITS);
    close(j.sd.expect("scatter"), 3.81036e6, SIX_DIGITS);
    interval(j.ci95, [25.9433e6, 35.4057e6]);
}

#[test]
fn half_a_revolution_moves_the_lag_more_than_the_scatter() {
    let rows = [
        (-0.5, 0.423412, 0.0487853, 52.2874),
        (0.5, 0.634894, 0.0203249, 21.7589),
        (-0.25, 0.496381, 0.0376499, 38.6289),
        (-0.75, 0.325549, 0.0657635, 81.6362),
        (0.0, 0.552914, 0.0299565, 30.6745),
    ];
    for (revolutions, lag, sd, j) in rows {
        let shifted = Identification::shifted(&paper_trials(), revolutions).expect("still possible");
        close(shifted.lag.mean, lag, SIX_DIGITS);
        close(shifted.lag.sd.expect("scatter"), sd, SIX_DIGITS);
        close(shifted.system_stiffness.expect("forces").mean, j * 1e6, SIX_DIGITS);
    }
    let found = paper();
    let [less, more] = found.half_revolution_range().expect("by stock");
    close(less, 0.423412, SIX_DIGITS);
    close(more, 0.634894, SIX_DIGITS);
    let one = identify(&paper_trials()[..1], &IdentifyOptions::default()).expect("possible");
    for found in [found, one] {
        assert!(found.advice.iter().any(|advice| matches!(advice, Advice::HalfRevolution { .. })));
    }
}

#[test]
fn the_error_of_the_lag_against_revolutions_is_the_reference() {
    let errors = MeasurementErrors::default();
    let rows = [
        (2.0, 0.0629304),
        (3.0, 0.0463788),
        (4.0, 0.0391655),
        (5.0, 0.0354336),
        (8.0, 0.0314273),
        (12.0, 0.0306676),
        (16.0, 0.0308753),
        (30.0, 0.0328043),
        (40.0, 0.0348352),
    ];
    for (revolutions, sd) in rows {
        close(lag_sd(0.553, 4.43e-6, revolutions, 0.0, &errors), sd, SIX_DIGITS);
    }
    for (feed, revolutions, sd) in
        [(0.002, 17, 0.030174), (0.01, 12, 0.0306676), (0.03, 9, 0.0326438), (0.1, 5, 0.0409988)]
    {
        let errors = MeasurementErrors { infeed_per_rev: feed * 1e-6, ..errors };
        let best = revolutions_of_least_error(0.553, 4.43e-6, &errors);
        assert_eq!(best.revolutions, revolutions);
        close(best.lag_sd, sd, SIX_DIGITS);
    }
    for (lag, revolutions, sd) in [(0.3, 7, 0.0743347), (0.7, 18, 0.0140771), (0.85, 31, 0.00375801)] {
        let best = revolutions_of_least_error(lag, 4.43e-6, &errors);
        assert_eq!(best.revolutions, revolutions);
        close(best.lag_sd, sd, SIX_DIGITS);
    }
    assert_eq!(paper().best.revolutions, 12);
}

#[test]
fn one_micrometre_of_stock_is_a_twentieth_of_the_lag() {
    close(lag_from_stock(4.43e-6, 16.0, 0.0, 67e-6).expect("possible"), 0.466909, SIX_DIGITS);
    close(lag_from_stock(4.43e-6, 16.5, 0.0, 66e-6).expect("possible"), 0.615697, SIX_DIGITS);
    close(lag_from_stock(4.43e-6, 15.5, 0.0, 66e-6).expect("possible"), 0.375617, SIX_DIGITS);
}

/// A trial on a machine with a lag of 0.7, by the process itself.
fn fresh(revolutions: u32, spark_out: u32) -> Trial {
    let mut grinding = Infeed::default();
    grinding.parameters.process_stiffness = 50e6;
    grinding.parameters.system_stiffness = stiffness_from_k(50e6, 0.7);
    let revolution = 60.0 / 292.0;
    let mut part = grinding.initial();
    let mut force_trace = Vec::new();
    let mut normal_force = None;
    for i in 0..revolutions + spark_out {
        let infeed_per_rev = if i < revolutions { 3e-6 } else { 0.0 };
        let input = Input { infeed_per_rev, ..Input::default() };
        grinding.advance(&mut part, &input, revolution).expect("inside the domain");
        let force = grinding.output(&part, &input).normal_force;
        force_trace.push(ForceSample { revolution: f64::from(i + 1), force });
        if i + 1 == revolutions {
            normal_force = Some(force);
        }
    }
    Trial {
        trial_id: format!("{revolutions}+{spark_out}"),
        infeed_per_rev: 3e-6,
        revolutions: revolutions.into(),
        spark_out_revolutions: spark_out.into(),
        stock_removed: Some(part.stock_removed),
        force_after_spark_out: (spark_out > 0).then(|| force_trace.last().map_or(0.0, |sample| sample.force)),
        normal_force,
        force_trace,
        ..Trial::default()
    }
}

#[test]
fn a_fresh_machine_is_found_again_from_stock_force_or_both() {
    let trials = [fresh(8, 4), fresh(20, 0), fresh(40, 6), fresh(30, 0)];
    for basis in [Basis::Stock, Basis::Force, Basis::Both] {
        let found = identify(&trials, &IdentifyOptions { basis, ..IdentifyOptions::default() }).expect("possible");
        close(found.lag.mean, 0.7, 1e-6);
        assert_eq!(found.pooled.is_some(), basis != Basis::Force);
    }
    // However short a trial is: three revolutions at a lag of 0.7 come to two thirds of the force.
    for few in [&trials[..], &[fresh(3, 0)], &[fresh(4, 2), fresh(5, 0)]] {
        let found = identify(few, &IdentifyOptions::default()).expect("possible");
        close(found.process_stiffness.expect("forces").mean, 50e6, 1e-6);
        close(found.system_stiffness.expect("forces").mean, stiffness_from_k(50e6, 0.7), 1e-6);
    }
}

#[test]
fn the_force_of_few_revolutions_is_that_of_an_end_not_come_to() {
    // Revolutions, lag, how far the force over the infeed is off the stiffness.
    for (revolutions, lag, off) in [(4.0, 0.553, -0.0935), (3.0, 0.8, -0.512)] {
        let (infeed, stiffness) = (4.43e-6, 38.3747e6);
        let force = stiffness * infeed * (1.0 - f64::powf(lag, revolutions));
        if revolutions == 4.0 {
            close(force, 154.1017, SIX_DIGITS);
            close(force / infeed, 34.786e6, 2e-5);
        }
        assert!((force / infeed / stiffness - 1.0 - off).abs() < 5e-5, "{revolutions}");
        let trial = Trial {
            trial_id: "few".to_owned(),
            infeed_per_rev: infeed,
            revolutions,
            stock_removed: Some(stock_after(infeed, revolutions, lag)),
            normal_force: Some(force),
            ..Trial::default()
        };
        let found = identify(&[trial], &IdentifyOptions::default()).expect("possible");
        close(found.lag.mean, lag, 1e-9);
        close(found.process_stiffness.expect("a force").mean, stiffness, 1e-9);
    }
}

#[test]
fn rise_and_spark_out_alone_give_the_lag() {
    let whole = fresh(40, 6);
    let spark_out = Trial { stock_removed: None, force_trace: Vec::new(), ..whole.clone() };
    let rise_revolutions = Some(0.05f64.ln() / 0.7f64.ln());
    let rise = Trial { rise_revolutions, force_after_spark_out: None, ..spark_out.clone() };
    for trial in [spark_out, rise] {
        let found = identify(&[trial], &IdentifyOptions::default()).expect("possible");
        close(found.lag.mean, 0.7, 1e-5);
        assert!(found.advice.contains(&Advice::SingleTrial));
        assert!(found.bootstrap.is_none() && found.lag.ci95.is_none());
    }
}

#[test]
fn a_threshold_force_and_a_late_start_stay_out_of_the_fitted_lag() {
    let samples = |late: f64, floor: f64| -> Vec<ForceSample> {
        let at = |i: i32| {
            let k = |n: i32| 0.7f64.powi(n);
            let force = if i <= 20 { 150.0 * (1.0 - k(i)) } else { 150.0 * (1.0 - k(20)) * k(i - 20) };
            ForceSample { revolution: f64::from(i) + if i <= 20 { late } else { 0.0 }, force: force + floor }
        };
        (1..30).map(at).collect()
    };
    let fit = fit_force_trace(&samples(0.0, 40.0), 20.0, 1.0).expect("a fit");
    close(fit.lag.value, 0.7, 1e-6);
    close(fit.floor.expect("spark-out"), 40.0, 1e-6);
    close(fit.steady_force.expect("rise"), 190.0, 1e-6);
    let flat: Vec<ForceSample> = (1..20).map(|i| ForceSample { revolution: f64::from(i), force: 100.0 }).collect();
    assert_eq!(fit_force_trace(&flat, 20.0, 1.0), None);
}

#[test]
fn stock_and_force_that_contradict_each_other_are_told() {
    // The wheel touched a revolution late.
    let late = |n, m| {
        let trial = fresh(n, m);
        Trial { stock_removed: trial.stock_removed.map(|stock| stock - 3e-6), ..trial }
    };
    let found = identify(&[late(20, 6), late(40, 6)], &IdentifyOptions::default()).expect("possible");
    assert!(found.advice.iter().any(|advice| matches!(advice, Advice::StockAgainstForce { .. })), "{:?}", found.advice);
}

#[test]
fn trials_that_cannot_tell_the_lag_say_so() {
    let stiff = |stock: f64| Trial {
        trial_id: stock.to_string(),
        infeed_per_rev: 1e-6,
        revolutions: 10.0,
        stock_removed: Some(stock * 1e-6),
        ..Trial::default()
    };
    let found = identify(&[stiff(9.5), stiff(9.9), stiff(8.0)], &IdentifyOptions::default()).expect("possible");
    let has = |wanted: fn(&Advice) -> bool| found.advice.iter().any(wanted);
    assert!(has(|advice| matches!(advice, Advice::NotIdentified { .. })));
    assert!(has(|advice| matches!(advice, Advice::OneLength { .. })));
    assert!(has(|advice| matches!(advice, Advice::NoForce)));
    assert!(!paper().advice.iter().any(|advice| matches!(advice, Advice::NotIdentified { .. })));
}

#[test]
fn impossible_trials_are_refused_by_name_all_at_once() {
    let good = || paper_trials()[0].clone();
    let trials = [
        Trial { trial_id: "three seconds".into(), revolutions: 14.6, ..good() },
        Trial { trial_id: "one turn".into(), revolutions: 1.0, stock_removed: Some(2e-6), ..good() },
        Trial { trial_id: "nan".into(), stock_removed: Some(f64::NAN), ..good() },
        Trial { trial_id: "negative".into(), infeed_per_rev: -4e-6, ..good() },
        Trial { trial_id: "empty".into(), stock_removed: None, ..good() },
        Trial { trial_id: "endless".into(), spark_out_revolutions: f64::INFINITY, ..good() },
        good(),
    ];
    let kept = identify(&trials, &IdentifyOptions::default()).expect("one trial is possible");
    assert_eq!((kept.trials.len(), kept.left_out.len()), (1, 6));
    assert_eq!(
        kept,
        Identification {
            left_out: kept.left_out.clone(),
            ..identify(&[good()], &IdentifyOptions::default()).expect("possible")
        }
    );
    let strict = IdentifyOptions { strict: true, ..IdentifyOptions::default() };
    let Err(IdentifyError::Impossible { trials: refused }) = identify(&trials, &strict) else {
        panic!("accepted");
    };
    assert!(identify(&trials[..6], &IdentifyOptions::default()).is_err(), "nothing is left");
    let names: Vec<&str> = refused.iter().map(|trial| trial.trial_id.as_str()).collect();
    assert_eq!(names, ["three seconds", "one turn", "nan", "negative", "empty", "endless"]);
    assert!(matches!(refused[0].fault, TrialFault::StockNotBelowInfeed { .. }));
    assert!(matches!(refused[1].fault, TrialFault::TooFewRevolutions { .. }));
    assert!(refused[0].to_string().contains("14.6 rev x 4.43 um/rev = 64.678 um"), "{}", refused[0]);
    assert_eq!(identify(&[], &IdentifyOptions::default()), Err(IdentifyError::NoTrials));
}

const SHIPPED: &[u8] = include_bytes!("../../../../scenarios/data/zb153u_trials.csv");

#[test]
fn the_shipped_trials_are_those_of_the_paper() {
    let table = read_trials("zb153u_trials.csv", SHIPPED).expect("a good table");
    assert!(table.notes.is_empty(), "{:?}", table.notes);
    let shipped = table.trials.into_iter().map(|trial| Trial { line: None, ..trial });
    for (shipped, paper) in shipped.zip(paper_trials()) {
        close(shipped.infeed_per_rev, paper.infeed_per_rev, 1e-15);
        close(shipped.stock_removed.expect("stock"), paper.stock_removed.expect("stock"), 1e-15);
        close(shipped.work_rotation_speed.expect("speed"), paper.work_rotation_speed.expect("speed"), 1e-14);
        assert_eq!((shipped.normal_force, shipped.revolutions), (paper.normal_force, paper.revolutions));
        assert_eq!((shipped.tangential_force, shipped.trial_id), (paper.tangential_force, paper.trial_id));
    }
}

#[test]
fn any_column_order_unit_delimiter_and_decimal_sign_is_read() {
    let csv = "stock_removed [mm];Revolutions;operator;normal_force (kN);trial_id;infeed_per_rev [mm/rev]\r\n\
               0,066;16;Петров;0,17;A;0,00443\r\n;16;;;B;0,0044\r\n";
    let check = |bytes: &[u8], encoding: bool| {
        let table = read_trials("t.csv", bytes).expect("a good table");
        close(table.trials[0].infeed_per_rev, 4.43e-6, 1e-12);
        close(table.trials[0].stock_removed.expect("stock"), 66e-6, 1e-12);
        assert_eq!(table.trials[0].normal_force, Some(170.0));
        assert_eq!(table.trials[1].stock_removed, None);
        assert!(table.notes.contains(&TableNote::DecimalComma));
        assert!(table.notes.contains(&TableNote::Unused { name: "operator".into() }));
        assert_eq!(table.notes.iter().any(|note| matches!(note, TableNote::Encoding { .. })), encoding);
    };
    check(csv.as_bytes(), false);
    check(format!("\u{feff}{csv}").as_bytes(), false);
    let utf_16: Vec<u8> = std::iter::once(0xFEFF).chain(csv.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    check(&utf_16, true);
    let windows = |c: char| if c.is_ascii() { c as u8 } else { (c as u32 - 0x410 + 0xC0) as u8 };
    check(&csv.chars().map(windows).collect::<Vec<u8>>(), true);
}

#[test]
fn every_fault_of_a_table_has_its_place() {
    let reasons = |csv: &str| {
        let error = read_trials("t.csv", csv.as_bytes()).expect_err("a bad table");
        error.faults.into_iter().map(|fault| (fault.line, fault.column, fault.reason)).collect::<Vec<_>>()
    };
    let faults = reasons("trial_id,infeed_per_rev,revolutions\n1,4.4,x\n2,NaN,16\n3,4.4\n");
    assert!(matches!(faults[0], (1, 2, TableReason::Unit { name: "infeed_per_rev", .. })));
    assert!(matches!(faults[1], (2, 3, TableReason::NotANumber { name: "revolutions", .. })));
    assert!(matches!(faults[2], (3, 2, TableReason::NotANumber { name: "infeed_per_rev", .. })));
    assert!(matches!(faults[3], (4, 2, TableReason::CellCount { found: 2, expected: 3 })));
    let one = |csv: &str| reasons(csv).remove(0).2;
    assert_eq!(one(""), TableReason::NoRows);
    assert!(matches!(one("trial_id,infeed_per_rev [um],revolutions\n"), TableReason::NoRows));
    assert!(matches!(
        one("infeed_per_rev [um],revolutions\n4,5\n"),
        TableReason::MissingColumn { name: "trial_id", .. }
    ));
    let misspelt = one("trial_id,infeed_per_rev [um],revolution\n1,4.4,16\n");
    assert!(matches!(misspelt, TableReason::Misspelt { nearest: "revolutions", .. }));
    assert!(matches!(one("trial_id,infeed_per_rev [N],revolutions\n1,4.4,16\n"), TableReason::Unit { .. }));
    assert!(matches!(one("trial_id,infeed_per_rev [um],revolutions\n1,,16\n"), TableReason::Empty { .. }));
    let comma = "trial_id;infeed_per_rev [um];revolutions\n1;4,430;16\n";
    assert!(matches!(one(comma), TableReason::AmbiguousComma { .. }));
    let mixed = "trial_id;infeed_per_rev [um];revolutions\n1;4,43;16\n2;4.4;16\n";
    assert!(matches!(one(mixed), TableReason::AmbiguousComma { .. }));
    let twice = "trial_id,infeed_per_rev [um],revolutions\n1,4.4,16\n1,4.4,17\n";
    assert!(matches!(one(twice), TableReason::TwoRecords { first: 2, .. }));
    let text = read_trials("t.csv", twice.as_bytes()).expect_err("a bad table").to_string();
    assert_eq!(text, "t.csv:3:1: `1` stands twice, first in line 2");
}

#[test]
fn recorded_forces_find_their_trials_by_time_or_revolution() {
    let mut trials = paper_trials();
    let mut csv = String::from("normal_force [N],time [s],trial_id\n");
    for i in 1..=16 {
        let force = 170.0 * (1.0 - 0.553f64.powi(i));
        csv += &format!("{force},{},1\n", f64::from(i) * 60.0 / 292.0);
    }
    read_force_traces("f.csv", csv.as_bytes(), &mut trials).expect("a good table");
    let by_force = IdentifyOptions { basis: Basis::Force, ..IdentifyOptions::default() };
    let found = identify(&trials[..1], &by_force).expect("a force");
    close(found.lag.mean, 0.553, 1e-6);
    let stray = read_force_traces("f.csv", b"trial_id,time [s],normal_force [N]\n9,1,2\n", &mut trials);
    assert!(matches!(stray.expect_err("no trial 9").faults[0].reason, TableReason::NoSuchTrial { .. }));
}

#[test]
fn resampling_tends_to_the_enumeration_and_keeps_its_seed() {
    let trials: Vec<Trial> = paper_trials().into_iter().chain(paper_trials()).collect();
    let with_seed =
        |seed| identify(&trials, &IdentifyOptions { seed, ..IdentifyOptions::default() }).expect("possible");
    let (one, again, other) = (with_seed(1), with_seed(1), with_seed(2));
    assert_eq!(one, again);
    let bootstrap = one.bootstrap.expect("ten trials");
    assert_eq!((bootstrap.resamples, bootstrap.exact), (10_000, false));
    assert_ne!(Some(bootstrap), other.bootstrap);
    // Twice the trials: the interval of the mean shrinks by √2.
    let five = paper().bootstrap.expect("five trials");
    let width = |[low, high]: [f64; 2]| high - low;
    close(width(bootstrap.ci95) * 2f64.sqrt(), width(five.ci95), 0.05);
}

proptest! {
    #[test]
    fn the_lag_of_the_stiffness_of_the_lag_is_the_lag(k in 0.001..0.999f64, cp in 1e5..1e9f64) {
        prop_assert!((lag(cp, stiffness_from_k(cp, k)) - k).abs() < 1e-12);
    }

    #[test]
    fn the_lag_of_the_stock_of_the_lag_is_the_lag(k in 0.05..0.95f64, infeed in 0.1e-6..50e-6f64, n in 2..60u32) {
        let found = lag_from_stock(infeed, n.into(), 0.0, stock_after(infeed, n.into(), k))
            .map_err(|error| TestCaseError::fail(error.to_string()))?;
        prop_assert!((found - k).abs() < 1e-9, "{found} from {k}");
    }

    #[test]
    fn other_units_of_length_and_force_give_the_same_lag(scale in 1e-3..1e3f64) {
        let rescaled: Vec<Trial> = paper_trials().into_iter().map(|trial| Trial {
            infeed_per_rev: trial.infeed_per_rev * scale,
            stock_removed: trial.stock_removed.map(|stock| stock * scale),
            normal_force: trial.normal_force.map(|force| force * 3.0),
            ..trial
        }).collect();
        let found = identify(&rescaled, &IdentifyOptions::default()).map_err(|error| TestCaseError::fail(error.to_string()))?;
        let nominal = paper();
        prop_assert!((found.lag.mean - nominal.lag.mean).abs() < 1e-12);
        let (a, b) = (found.process_stiffness.map(|cp| cp.mean), nominal.process_stiffness.map(|cp| cp.mean * 3.0 / scale));
        prop_assert!(a.zip(b).is_some_and(|(a, b)| (a / b - 1.0).abs() < 1e-12));
    }

    #[test]
    fn any_numbers_are_identified_or_refused(rows in prop::collection::vec(
        (any::<f64>(), any::<f64>(), any::<f64>(), any::<f64>(), any::<f64>(), any::<f64>()), 1..4)) {
        let trials: Vec<Trial> = rows.into_iter().map(|(infeed_per_rev, revolutions, stock, force, after, rise)| Trial {
            infeed_per_rev, revolutions, stock_removed: Some(stock), normal_force: Some(force),
            spark_out_revolutions: 3.0, force_after_spark_out: Some(after), rise_revolutions: Some(rise),
            ..Trial::default()
        }).collect();
        let _ = identify(&trials, &IdentifyOptions::default());
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = read_trials("t.csv", &bytes);
    }

    #[test]
    fn any_text_of_a_table_is_read_or_refused(
        cells in prop::collection::vec("[0-9a-zA-Z ,;.\\[\\]_\"µ-]{0,12}", 1..40), newline in "\r?\n",
    ) {
        let text = format!("trial_id,infeed_per_rev [um],revolutions,{}", cells.join(&newline));
        let _ = read_trials("t.csv", text.as_bytes());
        let _ = read_force_traces("t.csv", text.as_bytes(), &mut paper_trials());
    }
}

/// Readings of trials ground by the process itself, with a spark-out.
fn ground(grinding: &Infeed, infeeds: &[f64], revolutions: &[u32]) -> Vec<Trial> {
    let phase = |infeed_per_rev: f64, revolutions| CyclePhase { infeed_per_rev, revolutions };
    let cases = infeeds.iter().flat_map(|infeed| revolutions.iter().map(move |revolutions| (*infeed, *revolutions)));
    cases
        .enumerate()
        .map(|(index, (infeed, revolutions))| {
            let phases = [phase(infeed * 1e-6, revolutions), phase(0.0, 3)];
            let input = Input::default();
            let (_, course) = grind_cycle(grinding, &State::default(), &input, &phases).expect("inside the domain");
            let (steady, end) = (&course[revolutions as usize], &course[course.len() - 1]);
            Trial {
                trial_id: index.to_string(),
                infeed_per_rev: infeed * 1e-6,
                revolutions: f64::from(revolutions),
                spark_out_revolutions: 3.0,
                stock_removed: Some(end.stock_removed),
                normal_force: Some(steady.load.normal_force),
                force_after_spark_out: Some(end.load.normal_force),
                ..Trial::default()
            }
        })
        .collect()
}

#[test]
fn a_joint_fit_tells_threshold_force_and_exponent_where_the_trials_do() {
    let close = |found: Option<f64>, expected: f64| {
        let found = found.expect("told");
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} instead of {expected}");
    };
    for (threshold_force, force_exponent) in [(0.0, 1.0), (18.0, 1.0), (0.0, 0.8), (15.0, 0.85)] {
        let mut grinding = Infeed::default();
        (grinding.parameters.threshold_force, grinding.parameters.force_exponent) = (threshold_force, force_exponent);
        let trials = ground(&grinding, &[1.5, 3.0, 6.0], &[6, 16]);
        let joint = identify(&trials, &IdentifyOptions::default()).expect("possible").joint.expect("told");
        close(Some(joint.process_stiffness.value), grinding.parameters.process_stiffness);
        close(Some(joint.system_stiffness.value), grinding.parameters.system_stiffness);
        assert_eq!(joint.threshold_force.is_some(), threshold_force > 0.0, "{joint:?}");
        assert_eq!(joint.force_exponent.is_some(), force_exponent < 1.0, "{joint:?}");
        if threshold_force > 0.0 {
            close(joint.threshold_force.map(|force| force.value), threshold_force);
        }
        if force_exponent < 1.0 {
            close(joint.force_exponent.map(|exponent| exponent.value), force_exponent);
        }
        assert!(joint.misfit < 1e-3 && joint.readings == 18);
    }
}

#[test]
fn a_joint_fit_of_the_paper_is_one_of_two_stiffnesses() {
    let joint = identify(&paper_trials(), &IdentifyOptions::default()).expect("possible").joint.expect("told");
    assert_eq!((joint.threshold_force, joint.force_exponent, joint.readings), (None, None, 10));
    let [process, system] = [joint.process_stiffness, joint.system_stiffness].map(|each| each.value * 1e-6);
    assert!((36.0..39.0).contains(&process) && (27.0..34.0).contains(&system), "{process} {system}");
}

#[test]
fn one_stray_trial_moves_the_robust_means_little() {
    let scatter = Scatter::of(&[0.55, 0.56, 0.54, 0.555, 0.9]);
    assert!(scatter.mean > 0.62 && scatter.median == 0.555 && (scatter.huber - 0.556).abs() < 0.012, "{scatter:?}");
    let even = Scatter::of(&[1.0, 2.0, 3.0]);
    assert!((even.huber - 2.0).abs() < 1e-12);
}

/// Stock, force at the end of the rough stage and force after spark-out, by the recursion h = (1 − K) S + K h.
fn two_stages(k: f64, process: f64, [rough, finish]: [(f64, u32); 2], spark_out: u32) -> (f64, f64, f64) {
    let (mut depth, mut stock, mut force) = (0.0, 0.0, 0.0);
    for (stage, (infeed, revolutions)) in [rough, finish, (0.0, spark_out)].into_iter().enumerate() {
        for _ in 0..revolutions {
            depth = (1.0 - k) * infeed + k * depth;
            stock += depth;
        }
        if stage == 0 {
            force = process * depth;
        }
    }
    (stock, force, process * depth)
}

#[test]
fn trials_of_a_rough_and_a_finish_stage_tell_the_lag_and_the_stiffnesses() {
    let (k, process) = (0.553, 38.3747e6);
    let trials: Vec<Trial> = [(4.43e-6, 12, 1.0e-6, 8, 4), (3.0e-6, 9, 1.5e-6, 5, 2), (5.0e-6, 6, 0.8e-6, 3, 0)]
        .into_iter()
        .enumerate()
        .map(|(i, (rough, n, finish, m, spark_out))| {
            let (stock, force, after) = two_stages(k, process, [(rough, n), (finish, m)], spark_out);
            Trial {
                trial_id: format!("{i}"),
                infeed_per_rev: rough,
                revolutions: n.into(),
                finish_infeed_per_rev: finish,
                finish_revolutions: m.into(),
                spark_out_revolutions: spark_out.into(),
                stock_removed: Some(stock),
                normal_force: Some(force),
                force_after_spark_out: (spark_out > 0).then_some(after),
                ..Trial::default()
            }
        })
        .collect();
    // 12 and 8 revolutions of the published cycle: 59.8858 um without spark-out, 61.0408 with four revolutions of it.
    close(trials[0].stock_removed.expect("stock"), 61.0408e-6, SIX_DIGITS);
    let found = identify(&trials, &IdentifyOptions::default()).expect("possible trials");
    for trial in &found.trials {
        close(trial.from_stock.expect("a lag").value, k, SIX_DIGITS);
        close(trial.lag.value, k, SIX_DIGITS);
        close(trial.process_stiffness.expect("a stiffness"), process, SIX_DIGITS);
    }
    let joint = found.joint.expect("a joint fit");
    close(joint.system_stiffness.value, stiffness_from_k(process, k), 1e-5);
    close(joint.process_stiffness.value, process, 1e-5);
    // Read as one stage, the finish infeed would pass for a stiffer machine.
    let blind = lag_from_stock(4.43e-6, 12.0, 4.0, trials[0].stock_removed.expect("stock"));
    assert!(blind.is_err(), "{blind:?}");
    let table = "trial_id,infeed_per_rev [um],revolutions,finish_infeed_per_rev [um],finish_revolutions,spark_out_revolutions,stock_removed [um]\n\
                 1,4.43,12,1,8,4,61.0408\n";
    let read = read_trials("trials.csv", table.as_bytes()).expect("a table").trials;
    assert_eq!((read[0].finish_revolutions, read[0].commanded_infeed()), (8.0, trials[0].commanded_infeed()));
    let mut wrong = trials[0].clone();
    wrong.finish_revolutions = -1.0;
    assert!(
        wrong.faults().iter().any(|fault| fault.to_string().contains("finish_revolutions")),
        "{:?}",
        wrong.faults()
    );
}
