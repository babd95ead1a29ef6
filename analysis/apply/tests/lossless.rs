//! What a diagnosis has found stands in the scenario without loss: the file that was written predicts every row as
//! the applied point did.

use serde_json::{Value, json};
use std::path::Path;
use toolroom_apply::{Applied, Process, Request, applied_to, apply, document, model_hash, point_json, predictions};
use toolroom_gap::{Basis, Forward, Method, NominalModel, WEAR_RATE};
use toolroom_records::{Records, parse_csv};
use toolroom_scenario::{Calibration, CalibrationShift};
use toolroom_truth::Case;

const TURNING: &str = include_str!("../../../scenarios/gap/turning.toml");
const MILLING: &str = include_str!("../../../scenarios/gap/milling.toml");
const GRINDING: &str = include_str!("../../../scenarios/gap/grinding.toml");

fn model(text: &str) -> NominalModel {
    NominalModel::parse("model.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn records(process: &'static str, text: &str) -> Records {
    let csv = Case::null(process, 3).records();
    parse_csv("truth", csv.as_bytes(), model(text).kind()).expect("records").0
}

fn over(text: &str, records: &Records) -> Box<dyn Forward> {
    model(text).over(records, None, |_, _| false).0
}

/// The document of a diagnosis that names the candidates `active`.
fn diagnosed(text: &str, records: &Records, active: &[usize]) -> (Value, Applied) {
    let forward = over(text, records);
    let basis = Basis::of_sheet(forward.as_ref(), Method::default());
    let applied = applied_to(forward.as_ref(), forward.as_ref(), &[], &basis, active, None);
    let nominal = model(text);
    let (name, target) = (nominal.kind().name(), nominal.target());
    let hash = model_hash(text, &[]).expect("TOML");
    let parts = [applied];
    let process = Process { name, path: Path::new("model.toml"), hash, target, parts: &parts };
    let document = document(json!({ "effects": [] }), &[process], ("d".to_owned(), records.len(), None));
    let [applied] = parts;
    (document, applied)
}

fn written(text: &str, diagnosis: &Value) -> String {
    let process = model(text).kind().name();
    let request = Request { text, overrides: &[], diagnosis, process, only: &[], calibration: true, empirical: false };
    apply(request).expect("applicable").text
}

/// Greatest relative difference of the predictions of a file from those of an applied point.
fn difference(text: &str, records: &Records, applied: &Applied) -> f64 {
    let forward = over(text, records);
    let predicted = predictions(forward.as_ref());
    let wanted = &applied.predictions[2];
    assert_eq!(predicted.len(), wanted.len());
    let far = |(a, b): (&toolroom_apply::Prediction, &toolroom_apply::Prediction)| {
        (a.value - b.value).abs() / b.value.abs().max(1e-30)
    };
    predicted.iter().zip(wanted).map(far).fold(0.0, f64::max)
}

/// One candidate of each effect that has a shape, and one of each that has none.
fn sample(forward: &dyn Forward) -> Vec<usize> {
    let candidates = &forward.frame().candidates;
    let first = |i: &usize| {
        let same = |own: &&toolroom_gap::Candidate| own.id == candidates[*i].id;
        candidates[..*i].iter().filter(same).count() == usize::from(candidates.iter().filter(same).count() > 1)
    };
    (0..candidates.len()).filter(first).collect()
}

fn every_effect_is_kept(process: &'static str, text: &str) {
    let records = records(process, text);
    let forward = over(text, &records);
    for index in sample(forward.as_ref()) {
        let id = forward.frame().candidates[index].id;
        // What no scenario has a word for is refused, not lost.
        let unwritable = forward.written(index).shape.iter().any(|(name, ..)| *name == "positioned_since_dressing");
        let (diagnosis, applied) = diagnosed(text, &records, &[index]);
        if unwritable {
            let process = model(text).kind().name();
            let request = Request {
                text,
                overrides: &[],
                diagnosis: &diagnosis,
                process,
                only: &[],
                calibration: true,
                empirical: false,
            };
            assert!(apply(request).is_err());
            continue;
        }
        let better = written(text, &diagnosis);
        let far = difference(&better, &records, &applied);
        assert!(far <= 1e-9, "{process}, {id} {}: {far:e}\n{better}", forward.frame().candidates[index].shape);
    }
}

#[test]
fn turning_loses_nothing() {
    every_effect_is_kept("turning", TURNING);
}

#[test]
fn milling_loses_nothing() {
    every_effect_is_kept("milling", MILLING);
}

#[test]
fn grinding_loses_nothing() {
    every_effect_is_kept("grinding", GRINDING);
}

#[test]
fn effects_with_a_scope_are_kept_and_replaced_by_their_total() {
    let records = records("turning", TURNING);
    let machine = records.texts("machine").expect("machines")[0].clone();
    let (named, mut kept) = (TURNING, 0);
    for (effect, size) in [
        ("id = \"wear_force\", shape = { feed_force_ratio = 4.1, reference_wear = \"0.2 mm\" }", "0.3"),
        ("id = \"built_up_edge\", shape = { centre = \"151 m/min\", width = 0.15 }", "0.2"),
        ("id = \"temperature_lag\", shape = { time_constant = \"45 s\" }", "\"20 K\""),
    ] {
        for scope in [format!("machine = \"{machine}\""), "until = \"1000 day\", tool = \"insert\"".to_owned()] {
            let entry = format!("effects = [{{ {effect}, size = {size}, scope = {{ {scope} }} }}] # mine");
            let text = named.replacen("scatter = \"lab\"", &format!("scatter = \"lab\"\n{entry}"), 1);
            let forward = over(&text, &records);
            let (index, _) = *forward.frame().words.effects.first().expect("the entry of the file");
            let (diagnosis, applied) = diagnosed(&text, &records, &[index]);
            let better = written(&text, &diagnosis);
            // The records hold none of them: where a total of nothing is left, the entry goes.
            let there = applied.effects[0].size.abs() > 1e-12;
            kept += usize::from(there);
            let like = if there { &text } else { named };
            assert_eq!(better.matches("scope").count(), like.matches("scope").count(), "{better}");
            assert!(!there || better.contains("# mine"), "{better}");
            let far = difference(&better, &records, &applied);
            assert!(far <= 1e-9, "{effect}, {scope}: {far:e}\n{better}");
        }
    }
    assert!((1..6).contains(&kept), "{kept} of 6 entries were kept");
}

#[test]
fn two_diagnoses_one_after_the_other_are_their_total_at_once() {
    let records = records("turning", TURNING);
    let forward = over(TURNING, &records);
    let active = sample(forward.as_ref())[0];
    let (first, _) = diagnosed(TURNING, &records, &[active]);
    let once = written(TURNING, &first);
    let (second, applied) = diagnosed(&once, &records, &[active]);
    let twice = written(&once, &second);
    assert!(difference(&twice, &records, &applied) <= 1e-9);
    for word in ["[[calibration]]\n", "[[tool]]", "effects"] {
        assert_eq!(once.matches(word).count(), twice.matches(word).count(), "{twice}");
    }
}

#[test]
fn another_model_another_schema_and_nothing_are_refused() {
    let records = records("grinding", GRINDING);
    let (mut diagnosis, _) = diagnosed(GRINDING, &records, &[]);
    let chosen = |text: &str, diagnosis: &Value, only: &[String]| {
        let (process, overrides) = ("grinding", &[][..]);
        let request = Request { text, overrides, diagnosis, process, only, calibration: false, empirical: false };
        apply(request).expect_err("refused").to_string()
    };
    let refused = |text: &str, diagnosis: &Value| chosen(text, diagnosis, &[]);
    assert!(refused(&GRINDING.replace("stiffness = 0.10", "stiffness = 0.2"), &diagnosis).starts_with("apply-model"));
    assert!(refused(GRINDING, &diagnosis).contains("neither"));
    let unknown = chosen(GRINDING, &diagnosis, &["wheel_dulling".to_owned()]);
    assert!(unknown.contains("found no `wheel_dulling`; it has no effect"), "{unknown}");
    diagnosis["schema"] = json!(1);
    assert!(refused(GRINDING, &diagnosis).starts_with("apply-schema"));
}

#[test]
fn everything_else_stays_byte_for_byte() {
    let records = records("turning", TURNING);
    let (diagnosis, _) = diagnosed(TURNING, &records, &[0]);
    let better = written(TURNING, &diagnosis);
    let mut rest = better.lines();
    let kept = TURNING.lines().filter(|line| rest.any(|own| own == *line)).count();
    assert_eq!(kept, TURNING.lines().count(), "{better}");
}

const CRATER: &str = r#"
[[effect]]
id = "my.crater"
process = ["turning"]
size = { unit = "1", ordinary = 0.1, range = [0.0, 2.0] }
shape = { reference_speed = { value = "200 m/min", range = ["60 m/min", "400 m/min"], fit = true } }
changes = [
    { term = "cutting_force", factor = "1 + size * (flank_wear / 0.3 mm) * (cutting_speed / reference_speed)^1.5" },
    { term = "wear_rate", factor = "1 + size * exp(-cutting_time / 4 min)" },
]
"#;

#[test]
fn an_effect_of_a_user_beside_the_model_is_written_into_it_with_its_definition() {
    let records = records("turning", TURNING);
    let defined = toolroom_effects::parse_definitions("mine.toml", CRATER).expect("a definition");
    let nominal = model(TURNING).with_effects(Path::new("model.toml"), &defined).expect("one of its id");
    let forward = nominal.over(&records, None, |_, _| false).0;
    let is_crater = |candidate: &toolroom_gap::Candidate| candidate.id.word() == "my.crater";
    let all: Vec<usize> =
        (0..forward.frame().candidates.len()).filter(|i| is_crater(&forward.frame().candidates[*i])).collect();
    assert_eq!(all.len(), 4, "its own speed and three over the range");
    let basis = Basis::of_sheet(forward.as_ref(), Method::default());
    let mut applied = applied_to(forward.as_ref(), forward.as_ref(), &[], &basis, &[all[1]], None);
    let hash = model_hash(TURNING, &[]).expect("TOML");
    let one = |applied: Applied| {
        let parts = [applied];
        let process = Process {
            name: "turning",
            path: Path::new("m"),
            hash: hash.clone(),
            target: nominal.target(),
            parts: &parts,
        };
        let document = document(json!({ "effects": [] }), &[process], ("d".to_owned(), records.len(), None));
        let [applied] = parts;
        (document, applied)
    };
    // A size of its own, so that the file holds it whatever the records say.
    applied.effects[0].size = applied.effects[0].size.max(0.05);
    let (diagnosis, applied) = one(applied);
    let better = written(TURNING, &diagnosis);
    assert_eq!((better.matches("[[effect]]").count(), better.matches("my.crater").count()), (1, 2), "{better}");
    let read = model(&better);
    assert_eq!(read.stated.defined, defined);
    let effects = read.stated.effects.first().expect("the effect of the tool");
    assert!((effects.effect.size() - applied.effects[0].size).abs() <= 1e-12 * effects.effect.size());
    assert_eq!(
        effects.effect.parameters().value(1),
        applied.effects[0].written_effect.shape.first().map(|parameter| parameter.1)
    );
    // In the file already, it is found there and written once.
    every_effect_is_kept("turning", &format!("{TURNING}{CRATER}"));
    // A model that defines it otherwise is refused beside the file.
    let other = format!("{TURNING}{}", CRATER.replace("4 min", "5 min"));
    assert!(model(&other).with_effects(Path::new("model.toml"), &defined).is_err());
}

#[test]
fn proposed_terms_are_written_where_they_are_accepted_and_with_the_calibration_beside_them() {
    const TERM: &str = "
[[effect]]
id = \"proposed.temperature.speed\"
kind = \"empirical\"
process = [\"turning\"]
size = { ordinary = 0.1, range = [-2, 2] }
changes = [{ term = \"temperature_rise\", factor = \"exp(size * (min(cutting_speed, 400 m/min) / 200 m/min - 1))\" }]
";
    let records = records("turning", TURNING);
    let (mut diagnosis, plain) = diagnosed(TURNING, &records, &[]);
    let defined = toolroom_effects::parse_definitions("proposed.toml", TERM).expect("a definition");
    let nominal = model(TURNING).with_effects(Path::new("model.toml"), &defined).expect("one of its id");
    let forward = nominal.over(&records, None, |_, _| false).0;
    let candidates = &forward.frame().candidates;
    let term = candidates.iter().position(|own| own.id == defined[0].into()).expect("a candidate");
    let basis = Basis::of_sheet(forward.as_ref(), Method::default());
    let described = applied_to(forward.as_ref(), forward.as_ref(), &[], &basis, &[term], None);
    let hash = model_hash(TURNING, &[]).expect("TOML");
    let (target, path) = (nominal.target(), Path::new("m"));
    let point = point_json(&described, &Process { name: "turning", path, hash, target, parts: &[] });
    assert_eq!(point["effects"][0]["kind"], "empirical");
    diagnosis["proposals"] = json!([{ "kind": "empirical", "process": "turning", "applied": point }]);
    let without = written(TURNING, &diagnosis);
    assert!(!without.contains("proposed.") && difference(&without, &records, &plain) <= 1e-9, "{without}");
    let request = Request {
        text: TURNING,
        overrides: &[],
        diagnosis: &diagnosis,
        process: "turning",
        only: &[],
        calibration: true,
        empirical: true,
    };
    let text = apply(request).expect("applicable").text;
    assert!(text.contains("kind = \"empirical\"") && difference(&text, &records, &described) <= 1e-9, "{text}");
}

#[test]
fn a_rate_of_wear_of_a_part_is_written_as_the_constant_that_it_is_and_counted_from() {
    let records = records("turning", TURNING);
    let split = |text: &str, column: &str| {
        let places = vec![(column.to_owned(), String::new())];
        model(text).splitting(Vec::new(), places).over(&records, None, |_, _| false).0
    };
    let forward = split(TURNING, "start_time");
    let frame = forward.frame();
    let index = (0..frame.candidates.len())
        .find(|own| frame.candidates[*own].id.is_wear_rate() && forward.written(*own).scope.from.is_some())
        .expect("a date");
    let basis = Basis::of_sheet(forward.as_ref(), Method::default());
    let named = applied_to(forward.as_ref(), forward.as_ref(), &[], &basis, &[index], None);
    let size = named.effects[0].size;
    assert!(size.abs() > 1e-4, "{size}");
    let text_of = |text: &str, applied: &Applied, only: &[String]| {
        let hash = model_hash(text, &[]).expect("TOML");
        let (target, path) = (model(text).target(), Path::new("m"));
        let process = Process { name: "turning", path, hash, target, parts: std::slice::from_ref(applied) };
        let entry = json!({ "id": WEAR_RATE, "process": "turning", "size": size, "ci90": [0.0, 0.0], "unit": "1" });
        let diagnosis = document(json!({ "effects": [entry] }), &[process], ("d".to_owned(), records.len(), None));
        assert_eq!(diagnosis["effects"][0]["kind"], "constant", "{:#}", diagnosis["effects"]);
        let request = Request {
            text,
            overrides: &[],
            diagnosis: &diagnosis,
            process: "turning",
            only,
            calibration: true,
            empirical: false,
        };
        apply(request).expect("applicable").text
    };
    let rates = |text: &str| -> Vec<Calibration> {
        let all = model(text).stated.calibrations;
        all.into_iter().filter(|own| own.parameter == "wear_rate" && !own.scope.is_everywhere()).collect()
    };
    let better = text_of(TURNING, &named, &[]);
    assert!(!better.contains("[[effect]]") && !better.contains("effects ="), "{better}");
    let [rate] = &rates(&better)[..] else { panic!("{better}") };
    assert_eq!(
        (rate.moved, rate.scope.from),
        (CalibrationShift::Factor(1.0 + size), forward.written(index).scope.from)
    );
    assert!(difference(&better, &records, &named) <= 1e-9, "{better}");
    // Chosen by its name.
    assert_eq!(rates(&text_of(TURNING, &named, &[WEAR_RATE.to_owned()])).len(), 1);
    // Records that it has seen count from it: nothing is left to be named a second time.
    let (aside, set_aside) = model(&better).set_aside();
    assert!(aside.stated.calibrations.contains(rate) && !set_aside.is_empty());
    // A second diagnosis states the rate relative to the model that it read: factors multiply.
    let again = over(&better, &records);
    let basis = Basis::of_sheet(again.as_ref(), Method::default());
    let second = applied_to(again.as_ref(), again.as_ref(), &[], &basis, &[], None);
    let path = Path::new("m");
    let hash = model_hash(&better, &[]).expect("TOML");
    let target = model(&better).target();
    let process = Process { name: "turning", path, hash, target, parts: std::slice::from_ref(&second) };
    let diagnosis = document(json!({ "effects": [] }), &[process], ("e".to_owned(), records.len(), None));
    let best = written(&better, &diagnosis);
    assert_eq!(rates(&best).len(), 1, "{best}");
    assert!(difference(&best, &records, &second) <= 1e-9, "{best}");
}
