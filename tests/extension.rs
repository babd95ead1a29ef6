//! Nothing that is added to the program is left out in silence.

use std::collections::BTreeSet;
use std::path::Path;
use toolroom_effects::Effects;
use toolroom_gap::NominalModel;
use toolroom_records::Records;

/// Records of four operations with some numbers.
fn recorded(model: &NominalModel, columns: &[(&str, [f64; 4])]) -> Records {
    let mut records = Records::new(model.kind(), 4);
    columns.iter().for_each(|(name, values)| records.set_numbers(name, values.to_vec()));
    records
}

const CUTS: &[(&str, [f64; 4])] = &[
    ("cutting_speed", [1.5, 2.0, 2.5, 3.0]),
    ("feed_per_rev", [0.1e-3, 0.2e-3, 0.1e-3, 0.2e-3]),
    ("feed_per_tooth", [0.1e-3, 0.05e-3, 0.1e-3, 0.05e-3]),
    ("depth_of_cut", [1e-3; 4]),
    ("width_of_cut", [2e-3; 4]),
    ("cutting_time", [60.0; 4]),
    ("cutting_force", [200.0, 300.0, 210.0, 310.0]),
    ("flank_wear", [0.05e-3, 0.06e-3, 0.07e-3, 0.08e-3]),
];
const TRIALS: &[(&str, [f64; 4])] = &[
    ("infeed_per_rev", [4e-6, 5e-6, 4e-6, 5e-6]),
    ("work_rotation_speed", [10.0; 4]),
    ("revolutions", [20.0; 4]),
    ("spark_out_revolutions", [5.0; 4]),
    ("normal_force", [100.0, 120.0, 105.0, 125.0]),
];

#[test]
fn every_effect_of_a_process_is_tried_or_said_not_to_be_and_why() {
    let mut most = 0;
    for (process, text, columns) in [
        ("turning", include_str!("../scenarios/gap/turning.toml"), CUTS),
        ("milling", include_str!("../scenarios/gap/milling.toml"), CUTS),
        ("infeed", include_str!("../scenarios/gap/grinding.toml"), TRIALS),
    ] {
        let model = NominalModel::parse(process, text, &[]).expect(process);
        let known: Vec<&(&str, [f64; 4])> =
            columns.iter().filter(|(name, _)| model.kind().column(name).is_some()).collect();
        let columns: Vec<(&str, [f64; 4])> = known.into_iter().copied().collect();
        let (forward, _) = model.over(&recorded(&model, &columns), None, |_, _| false);
        let frame = forward.frame();
        let tried: BTreeSet<&str> = frame.candidates.iter().map(|candidate| candidate.id.word()).collect();
        let untried: BTreeSet<&str> = frame.untried.iter().map(|untried| untried.id.word()).collect();
        assert!(tried.is_disjoint(&untried), "{process}");
        for effect in Effects::every(process).iter() {
            let id = effect.entry().id;
            assert!(tried.contains(id) || untried.contains(id), "{id} in {process}");
        }
        assert!(frame.untried.iter().all(|untried| !untried.reason.is_empty()));
        most = most.max(tried.len());
    }
    assert!(most > 5, "hardly anything is tried");
}

#[test]
fn what_a_cut_cannot_read_is_never_tried() {
    let model = NominalModel::parse("turning", include_str!("../scenarios/gap/turning.toml"), &[]);
    let model = model.expect("a shipped model");
    let columns: Vec<_> = CUTS.iter().copied().filter(|(name, _)| model.kind().column(name).is_some()).collect();
    let (forward, _) = model.over(&recorded(&model, &columns), None, |_, _| false);
    let reason =
        |id: &str| forward.frame().untried.iter().find(|untried| untried.id.word() == id).map(|own| &own.reason);
    for id in ["chipping", "process_damping", "chuck_stiffness"] {
        assert!(reason(id).is_some(), "{id}");
    }
    let lots = reason("lot_hardness").expect("no lot is recorded");
    assert!(lots.contains("lot"), "{lots}");
}

/// `python3 tests/recipes.py` follows the recipes and runs what they add; here only what a move of code breaks most.
#[test]
fn every_line_that_a_recipe_names_stands_in_its_file_once() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("CONTRIBUTING.md")).expect("the recipes");
    let mut count = 0;
    for step in text.lines().filter(|line| line.starts_with("In `") && line.ends_with("`:")) {
        let [_, path, how, line] = step.splitn(4, '`').collect::<Vec<_>>()[..] else { panic!("{step}") };
        assert!([", after ", ", before ", ", replacing "].contains(&how), "{step}");
        let line = line.trim_end_matches("`:");
        let file = std::fs::read_to_string(root.join(path)).unwrap_or_else(|error| panic!("{path}: {error}"));
        assert_eq!(file.lines().filter(|own| own.trim() == line).count(), 1, "{path}: `{line}`");
        count += 1;
    }
    assert!(count > 10, "{count} steps");
    for path in text.lines().filter_map(|line| line.strip_prefix("New file `")?.strip_suffix("`:")) {
        assert!(!root.join(path).exists(), "{path} is an example and stands in no commit");
    }
}
