use super::*;
use crate::{Settings, StructureChange};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use toolroom_facts::Quantity;
use toolroom_recording::simulated;
use toolroom_records::RecordKind;
use toolroom_scenario::{Scenario, StructureScatter};

const SHOP: &str = include_str!("../../../../scenarios/chatter-policies.toml");

fn lobes(name: &str) -> String {
    format!("{}/../../scenarios/chatter/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

fn structures(mill: &str) -> [String; 2] {
    [format!("tool.insert.structure={}", lobes("shaft")), format!("tool.\"end mill\".structure={mill}")]
}

fn model(process: &str) -> NominalModel {
    let text = format!("{SHOP}\n[gap]\nprocess = \"{process}\"\n");
    NominalModel::parse("chatter.toml", &text, &structures(&lobes("endmill"))).expect("a model")
}

/// What differs on a machine: factors on frequencies, damping and the depth of the limit.
type Truth = [f64; 3];

/// Turned cuts of a machine whose structure has these factors, at speeds and depths about the limit of the file.
fn turned(model: &NominalModel, truth: Truth, cuts: usize, seed: u64) -> Records {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let speeds: Vec<f64> = (0..cuts).map(|i| (110.0 + 12.0 * (i % 16) as f64) / 60.0).collect();
    let mut records = Records::new(RecordKind::Turning, cuts);
    let texts = |value: &dyn Fn(usize) -> String| (0..cuts).map(value).collect::<Vec<String>>();
    records.set_texts("operation_id", texts(&|i| format!("J{i}/turn")));
    records.set_texts("machine", texts(&|_| "L1".to_owned()));
    records.set_texts("tool_id", texts(&|_| "E1".to_owned()));
    records.set_texts("part_type", texts(&|_| "shaft".to_owned()));
    records.set_numbers("start_time", (0..cuts).map(|i| 300.0 * i as f64).collect());
    records.set_numbers("cutting_speed", speeds.clone());
    records.set_numbers("spindle_speed", speeds.iter().map(|speed| 2.0 * speed / 0.04).collect());
    records.set_numbers("feed_per_rev", vec![0.2e-3; cuts]);
    records.set_numbers("flank_wear", vec![0.05e-3; cuts]);
    records.set_numbers("cutting_time", vec![60.0; cuts]);
    records.set_numbers("depth_of_cut", vec![1e-3; cuts]);
    records.set_numbers("chatter", vec![0.0; cuts]);
    let exponent = model.structure_prior().hardness[1] / 0.02;
    let (mut depths, mut chatter, mut frequencies) = (Vec::new(), Vec::new(), Vec::new());
    let heard = model.heard_cuts(&records);
    for cut in &heard {
        let nominal = model.stability_limit(cut, 1.0, 1.0).0;
        let depth = nominal * (0.35 + 1.15 * random.random::<f64>());
        let (limit, frequency) = model.stability_limit(cut, truth[0], truth[1]);
        let z: f64 = StandardNormal.sample(&mut random);
        let chatters = depth > limit * truth[2] * (0.02 * exponent * z).exp();
        depths.push(depth);
        chatter.push(f64::from(u8::from(chatters)));
        frequencies.push(if chatters { frequency.round() } else { f64::NAN });
    }
    records.set_numbers("depth_of_cut", depths);
    records.set_numbers("chatter", chatter);
    records.set_numbers("chatter_frequency", frequencies);
    records
}

fn said(model: &NominalModel, records: &Records, seed: u64) -> Diagnosis {
    let mut diagnosis = Diagnosis::cannot_tell(String::new());
    diagnosis.verdict = GapVerdict::NoGap;
    add_dynamics(model, records, &mut diagnosis, seed);
    diagnosis
}

#[test]
fn structures_that_scatter_as_the_file_says_have_not_drifted() {
    let model = model("turning");
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let mut named = 0;
    for seed in 0..16 {
        let mut factor = |deviation: f64| -> f64 {
            let z: f64 = StandardNormal.sample(&mut random);
            (deviation * z).exp()
        };
        let truth = [factor(0.02), factor(0.2), factor(0.08)];
        let diagnosis = said(&model, &turned(&model, truth, 40, seed), seed);
        assert_eq!(diagnosis.dynamics.len(), 1);
        named += usize::from(diagnosis.dynamics[0].drift);
        assert_eq!(diagnosis.dynamics[0].drift, diagnosis.verdict == GapVerdict::Constant);
    }
    // At a level of 1 % two of sixteen are as rare as one in a hundred.
    assert!(named <= 1, "{named}");
}

#[test]
fn a_drift_is_named_by_what_moved() {
    let model = model("turning");
    for (truth, quantity, factor, margin) in [
        ([0.92, 1.0, 1.0], Quantity::NaturalFrequency, 0.92, 0.02),
        ([1.08, 1.0, 1.0], Quantity::NaturalFrequency, 1.08, 0.02),
        // Within what is known of damping and coefficient a limit lower by a third would be no drift.
        ([1.0, 1.0, 0.45], Quantity::StabilityLimit, 0.45, 0.1),
    ] {
        let diagnosis = said(&model, &turned(&model, truth, 60, 3), 1);
        let drift = &diagnosis.dynamics[0];
        assert!(drift.drift && diagnosis.verdict == GapVerdict::Constant, "{truth:?} {drift:?}");
        assert_eq!(diagnosis.facts[0].quantity, quantity, "{truth:?} {drift:?}");
        let best = drift.explanations[0];
        assert!((best.factor - factor).abs() < margin, "{truth:?} {best:?}");
        assert!(best.ci90[0] < factor && factor < best.ci90[1], "{truth:?} {best:?}");
        assert!(diagnosis.notes.iter().any(|note| note.starts_with("dynamics_drift on L1")), "{:?}", diagnosis.notes);
        let json = drift.json();
        assert_eq!(
            json["class"][0],
            if quantity == Quantity::StabilityLimit { "mode_stiffness" } else { "mode_frequency" }
        );
    }
}

#[test]
fn without_a_word_on_chatter_it_is_said_what_records_lack() {
    let model = model("turning");
    let mut records = turned(&model, [1.0; 3], 10, 1);
    records.remove("chatter");
    let diagnosis = said(&model, &records, 1);
    assert!(diagnosis.dynamics.is_empty() && diagnosis.verdict == GapVerdict::NoGap);
    assert!(diagnosis.notes.iter().any(|note| note.contains("`chatter`")), "{:?}", diagnosis.notes);
    let few = turned(&model, [1.0; 3], 5, 1);
    assert!(said(&model, &few, 1).notes.iter().any(|note| note.contains("5 cuts")));
}

/// Milled cuts of a run, whose end mill has the frequencies of its file times a factor.
fn milled(factor: f64) -> Records {
    let text = std::fs::read_to_string(lobes("endmill")).expect("a lobes file");
    let hertz = |text: String, value: f64| text.replacen(&format!("{value} Hz"), &format!("{} Hz", value * factor), 1);
    let mut moved = hertz(hertz(text, 1150.0), 1240.0);
    // At the same masses.
    for stiffness in ["11", "9.6"] {
        let value: f64 = stiffness.parse().expect("a number");
        moved = moved.replacen(&format!("{stiffness} N/um"), &format!("{} N/um", value * factor * factor), 1);
    }
    let path = std::env::temp_dir().join(format!("toolroom-drift-{}-{factor}.toml", std::process::id()));
    std::fs::write(&path, moved).expect("a file");
    let read = toolroom_scenario_file::parse("chatter.toml", SHOP, &structures(&path.display().to_string()));
    let mut scenario: Scenario = read.expect("a scenario").scenario;
    std::fs::remove_file(&path).expect("it was there");
    for tool in &mut scenario.tools {
        tool.structure_scatter = StructureScatter::default();
    }
    let log = toolroom_shop::run(&scenario, 0, 0).expect("it runs");
    let all = simulated(&scenario, &log, &|_, channel| Settings::default().sensor(channel)).expect("records");
    all.into_iter().find(|records| records.kind == RecordKind::Milling).expect("cuts")
}

#[test]
fn a_run_whose_end_mill_is_mounted_otherwise_is_found_by_its_chatter() {
    let model = model("milling");
    let same = said(&model, &milled(1.0), 1);
    assert!(same.dynamics.len() == 2 && same.findings.is_empty(), "{:?}", same.dynamics);
    let drifted = said(&model, &milled(0.93), 1);
    assert!(drifted.dynamics.iter().all(|own| own.drift), "{:?}", drifted.dynamics);
    for drift in &drifted.dynamics {
        let [best, _] = drift.explanations;
        assert_eq!(best.change, StructureChange::ModeFrequency, "{drift:?}");
        if drift.chattered < drift.cuts {
            assert!((best.factor - 0.93).abs() < 0.03, "{drift:?}");
        } else {
            // Where every cut chatters they only say how far the frequency has gone at least.
            let [low, high] = best.ci90;
            assert!(low < 0.93 && 0.93 < high && high < 1.0 && high - low < 0.12, "{drift:?}");
        }
    }
    let fact = &drifted.facts[0];
    assert!(fact.quantity == Quantity::NaturalFrequency && fact.words().contains("Hz recorded"), "{}", fact.words());
}
