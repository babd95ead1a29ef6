//! Parts of machine time that are withheld from a model of part programs: each is named with its size from timed stretches, is
//! written where the machine file has it, and is not named again.

use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use toolroom_apply::{Process, Request, applied_to, apply, document, model_hash, predictions};
use toolroom_drives::{Deviation, Drives, Machine, times};
use toolroom_gap::{Basis, Diagnosis, Forward, GapVerdict, Method, NominalModel, diagnose};
use toolroom_program::{Control, Program};
use toolroom_records::{RecordKind, Records, parse_csv};

/// Drives as a data sheet and a trial cut give them, by the names of a machine file.
const DRIVES: &str = r#"
rapid_speed = "30 m/min"
acceleration = "2 m/s2"
feed_acceleration = "1.25 m/s2"
jerk = "80 m/s3"
corner = { rule = "deviation", value = "10 um" }
settling = { feed = "0.05 s", rapid = "0.02 s" }

[drives.spindle]
constant = "3e-8 s/rpm2"
base_speed = "3000 rpm"

[drives.changer]
kind = "arm"
change_time = "4 s"
"#;

const NAMES: [&str; 3] = ["A", "B", "C"];
/// Tools of the programs in the order of their calls, and the speeds of the spindle.
const TOOLS: [[(u32, u32); 5]; 3] = [
    [(1, 3000), (2, 6000), (9, 800), (4, 12_000), (5, 4500)],
    [(3, 8000), (14, 2000), (6, 12_000), (20, 500), (7, 6000)],
    [(8, 12_000), (1, 3000), (16, 9000), (2, 1200), (11, 5000)],
];
/// Runs of each program.
const RUNS: usize = 4;
/// Programmed time behind which a stretch is cut, s.
const CUT: f64 = 4.0;

/// A program: facing, a polygon of chords, a line of short blocks, a meander and holes, more or less of each by tool.
fn program(which: usize) -> String {
    let mut text = String::from("G21 G17 G90 G94 G40 G49 G80\n");
    let mut line = |words: String| {
        let _ = writeln!(text, "{words}");
    };
    for (place, (tool, speed)) in TOOLS[which].into_iter().enumerate() {
        line(format!("T{tool} M6"));
        line(format!("G54 G0 X0. Y0. S{speed} M3"));
        line("Z5. M8".to_owned());
        let mix = (which + 2 * place) % 5;
        for pass in 0..3 + mix {
            line(format!("G0 X0. Y{}.\nZ1.\nG1 Z-1. F600\nX{}. F1200\nG0 Z5.", 10 * pass, 80 + 20 * mix));
        }
        line("G0 X30. Y0.\nG1 Z-1. F600".to_owned());
        for chord in 1..=60 * (1 + (mix + 1) % 3) {
            let angle = f64::from(chord as u32) * 6.0_f64.to_radians();
            line(format!("G1 X{:.4} Y{:.4} F2400", 30.0 * angle.cos(), 30.0 * angle.sin()));
        }
        line("G0 Z5.\nX0. Y0.\nG1 Z-1. F600".to_owned());
        for block in 1..=120 * (1 + (mix + 2) % 3) {
            line(format!("G1 X{:.3} F3000", 0.2 * f64::from(block as u32)));
        }
        line("G0 Z5.\nX0. Y0.\nG1 Z-1. F600".to_owned());
        for turn in 0..12 * (1 + (mix + 3) % 4) {
            let x = 8 * (turn / 2 + turn % 2);
            line(format!("G1 X{x}. Y{}. F1800", 6 * ((turn / 2) % 2)));
        }
        line("G0 Z5.".to_owned());
        for hole in 0..4 + 6 * (mix % 3) {
            line(format!("G0 X{}. Y{}.\nZ1.\nG1 Z-4. F400\nG0 Z5.", 15 * hole, 20 * (hole % 4)));
        }
        line("G0 Z50. M9\nM5\nG91 G28 Z0.\nG90".to_owned());
    }
    line("M30".to_owned());
    text
}

/// Numbers that look normal, the same on every machine.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        std::iter::repeat_with(uniform).take(12).sum::<f64>() - 6.0
    }
}

/// Timed stretches of runs on a machine with these drives.
fn stretches(drives: &Drives) -> Records {
    let mut csv = String::from(
        "operation_id,machine,program,sequence,tool_id,section,first_block,last_block,start_time [s],tool_changes,cycle_time [s]\n",
    );
    let (mut noise, mut clock) = (Noise(5), 0.0);
    for (which, name) in NAMES.into_iter().enumerate() {
        let program = Program::read(&program(which), &Control::default()).expect("a program");
        let (own, ideal) = (times(&program, drives), times(&program, &Drives::default()));
        // First and last block, time, programmed time, section, whether the tool is changed.
        let mut cuts: Vec<(usize, usize, f64, f64, usize, bool)> = Vec::new();
        let mut section = 0;
        for (i, block) in program.blocks.iter().enumerate() {
            section += usize::from(block.tool_change);
            match cuts.last_mut().filter(|last| last.3 < CUT && last.4 == section && !last.5) {
                Some(last) if !block.tool_change => {
                    *last = (last.0, block.line, last.2 + own[i], last.3 + ideal[i], section, false);
                }
                _ => cuts.push((block.line, block.line, own[i], ideal[i], section, block.tool_change)),
            }
        }
        // What forms and calibration of one machine leave of a stretch is the same in every run.
        let forms: Vec<f64> = cuts.iter().map(|_| 1.0 + 0.003 * noise.next()).collect();
        for run in 0..RUNS {
            for (i, ((first, last, time, _, section, change), form)) in cuts.iter().zip(&forms).enumerate() {
                let time = time * form + 0.05 * noise.next() + if *change { 0.2 * noise.next() } else { 0.0 };
                let _ = writeln!(
                    csv,
                    "{name}-{run},M,{name},{},T{section},{name} {section},{first},{last},{clock:.1},{},{:.3}",
                    i + 1,
                    u8::from(*change),
                    time.max(0.01)
                );
                clock += time;
            }
            clock += 60.0;
        }
    }
    parse_csv("stretches", csv.as_bytes(), RecordKind::Program).expect("stretches").0
}

fn model_text(drives: &str) -> String {
    let mut text = format!("schema = 1\n[gap]\nprocess = \"program\"\n[drives]{drives}");
    for name in NAMES {
        let _ = write!(text, "\n[[program]]\nname = \"{name}\"\nfile = \"{name}.nc\"\n");
    }
    text
}

/// A folder with the programs, the model in it, and the drives that it states.
struct Bench {
    folder: tempfile::TempDir,
    text: String,
    drives: Drives,
}

impl Bench {
    fn new(drives: &str) -> Self {
        let folder = tempfile::TempDir::new().expect("a folder");
        for (which, name) in NAMES.into_iter().enumerate() {
            std::fs::write(folder.path().join(format!("{name}.nc")), program(which)).expect("a file");
        }
        let of = Machine::of("drives", &format!("[drives]{drives}"), &[]).expect("drives").content.drives;
        Self { folder, text: model_text(drives), drives: of }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("model.toml")
    }

    fn over(&self, text: &str, records: &Records) -> Box<dyn Forward> {
        std::fs::write(self.path(), text).expect("a file");
        NominalModel::read(&self.path(), &[])
            .unwrap_or_else(|error| panic!("{error}\n{text}"))
            .over(records, None, |_, _| false)
            .0
    }

    /// The model with the effects `active`, fitted and written, and what the applied point predicts.
    fn applied(&self, text: &str, records: &Records, active: &[usize]) -> (String, Vec<f64>) {
        let forward = self.over(text, records);
        let basis = Basis::of_sheet(forward.as_ref(), Method::default());
        let applied = applied_to(forward.as_ref(), forward.as_ref(), &[], &basis, active, None);
        let nominal = NominalModel::read(&self.path(), &[]).expect("a model");
        let hash = model_hash(text, &[]).expect("TOML");
        let parts = [applied];
        let process =
            Process { name: "program", path: Path::new("model.toml"), hash, target: nominal.target(), parts: &parts };
        let diagnosis: Value = document(json!({ "effects": [] }), &[process], ("d".to_owned(), records.len(), None));
        let request = Request {
            text,
            overrides: &[],
            diagnosis: &diagnosis,
            process: "program",
            only: &[],
            calibration: true,
            empirical: false,
        };
        let written = apply(request).expect("applicable").text;
        let predicted = parts[0].predictions[2].iter().map(|own| own.value).collect();
        (written, predicted)
    }

    fn diagnosed(&self, text: &str, records: &Records) -> Diagnosis {
        diagnose(self.over(text, records).as_ref(), 1).diagnosis
    }

    /// Candidates of the effects that a diagnosis names.
    fn named(&self, diagnosis: &Diagnosis, text: &str, records: &Records) -> Vec<usize> {
        let forward = self.over(text, records);
        let candidates = &forward.frame().candidates;
        let place = |effect: &toolroom_gap::NamedEffect| {
            candidates.iter().position(|own| own.id == effect.id && own.shape == effect.shape).expect("a candidate")
        };
        diagnosis.effects.iter().map(place).collect()
    }
}

/// What is withheld, its word and its size in SI.
const WITHHELD: [(&str, Deviation, f64); 7] = [
    ("rapid_acceleration", Deviation::RapidAcceleration, 1.0),
    ("jerk", Deviation::Jerk, 0.05),
    ("corner_slowing", Deviation::CornerSlowing, 9.9e6),
    ("block_time", Deviation::BlockTime, 0.012),
    ("program_end", Deviation::ProgramEnd, 6.0),
    ("magazine_distance", Deviation::MagazineDistance, 0.4),
    ("spindle_ramp", Deviation::SpindleRamp { base_speed: 314.159_265, reference_speed: 1_256.637_061 }, 2.0),
];

fn withheld(word: &str) {
    let bench = Bench::new(DRIVES);
    let (_, deviation, size) = WITHHELD.into_iter().find(|(known, ..)| *known == word).expect("it is listed");
    let records = stretches(&deviation.added(size, &bench.drives));
    let diagnosis = bench.diagnosed(&bench.text, &records);
    assert_eq!(diagnosis.verdict, GapVerdict::Effect, "{}", diagnosis.terminal());
    let [effect] = diagnosis.effects.as_slice() else { panic!("{}", diagnosis.terminal()) };
    assert_eq!(effect.id.word(), word, "{}", diagnosis.terminal());
    let factor = effect.id.entry().size.to_display(1.0);
    let wide = |end: f64| end / factor;
    let (low, high) = (wide(effect.ci90[0]), wide(effect.ci90[1]));
    assert!(0.85 * low <= size && size <= 1.15 * high, "{word}: {low} … {high} for {size}");
    let active = bench.named(&diagnosis, &bench.text, &records);
    let (better, _) = bench.applied(&bench.text, &records, &active);
    let again = bench.diagnosed(&better, &records);
    assert!(again.effects.iter().all(|effect| effect.id.word() != word), "{}\n{better}", again.terminal());
    assert!(matches!(again.verdict, GapVerdict::NoGap | GapVerdict::Small), "{}\n{better}", again.terminal());
}

#[test]
fn rapid_motions_that_accelerate_slowly_are_named() {
    withheld("rapid_acceleration");
}

#[test]
fn a_jerk_that_the_file_does_not_know_is_named() {
    withheld("jerk");
}

#[test]
fn corners_that_are_passed_slowly_are_named() {
    withheld("corner_slowing");
}

#[test]
fn a_control_that_prepares_blocks_slowly_is_named() {
    withheld("block_time");
}

#[test]
fn an_end_of_programs_that_takes_time_is_named() {
    withheld("program_end");
}

#[test]
fn a_magazine_that_turns_is_named() {
    withheld("magazine_distance");
}

#[test]
fn a_spindle_slower_than_its_sheet_is_named() {
    withheld("spindle_ramp");
}

#[test]
fn a_machine_that_is_as_its_file_says_hides_nothing() {
    let bench = Bench::new(DRIVES);
    let diagnosis = bench.diagnosed(&bench.text, &stretches(&bench.drives));
    assert!(diagnosis.effects.is_empty(), "{}", diagnosis.terminal());
}

#[test]
fn jerk_and_corners_wait_for_an_acceleration_and_one_distance_of_a_magazine_is_none() {
    let bench = Bench::new("\nrapid_speed = \"30 m/min\"\n");
    let mut records = stretches(&bench.drives);
    let untried = |records: &Records| -> Vec<(String, String)> {
        let forward = bench.over(&bench.text, records);
        forward.frame().untried.iter().map(|own| (own.id.to_string(), own.reason.clone())).collect()
    };
    let why = |list: &[(String, String)], id: &str| {
        list.iter().find(|(own, _)| own == id).map(|(_, reason)| reason.clone()).unwrap_or_default()
    };
    let list = untried(&records);
    assert!(why(&list, "jerk").contains("no acceleration") && why(&list, "corner_slowing").contains("no acceleration"));
    assert_eq!(why(&list, "magazine_distance"), "");
    // Of one tool change alone its distance is no other cause than its constant.
    let sections = records.texts("section").expect("sections").to_vec();
    let one: Vec<usize> = (0..records.len()).filter(|row| ["A 1", "A 2"].contains(&sections[*row].as_str())).collect();
    records = records.select(&one[..one.len() / RUNS]);
    let list = untried(&records);
    assert_ne!(why(&list, "magazine_distance"), "", "{list:?}");
}

/// Values of a machine file stand under several names, in a preset or in tables: each is found and changed where it stands.
#[test]
fn what_is_written_predicts_as_the_applied_point_whatever_the_file_calls_it() {
    let flat = r#"
rapid_speed = { X = "30 m/min", Y = "30 m/min", Z = "24 m/min" }
inverse_acceleration = "0.8 s2/m"
corner_deviation = "10 um"
jerk_time = "15 ms"
spindle = { constant = "3e-8 s/rpm2", base_speed = "3000 rpm", braking = { constant = "4e-8 s/rpm2", base_speed = "3500 rpm" } }
"#;
    // A jerk is one by the acceleration of the file, whatever an effect adds to that.
    let standing = "\n[effects]\naxis_acceleration = \"0.3 s2/m\"\n";
    for (drives, effects) in [
        (DRIVES, ""),
        (flat, ""),
        (DRIVES, standing),
        ("\npreset = \"hurco-winmax\"\n", ""),
        ("\nrapid_speed = \"20 m/min\"\n", ""),
    ] {
        let stated = Bench::new(drives);
        let bench = Bench { text: stated.text.clone() + effects, ..stated };
        let forward = bench.over(&bench.text, &stretches(&bench.drives));
        let count = forward.frame().candidates.len();
        let mut seen = Vec::new();
        for index in 0..count {
            let candidate = forward.frame().candidates[index].clone();
            // One shape each.
            if seen.contains(&candidate.id) {
                continue;
            }
            seen.push(candidate.id);
            let deviation = WITHHELD.iter().find(|(word, ..)| *word == candidate.id.word());
            let slower = deviation.map_or(bench.drives, |(_, deviation, size)| deviation.added(*size, &bench.drives));
            let records = stretches(&slower);
            let (better, wanted) = bench.applied(&bench.text, &records, &[index]);
            let predicted = predictions(bench.over(&better, &records).as_ref());
            let far = predicted.iter().zip(&wanted).map(|(own, wanted)| (own.value - wanted).abs() / wanted.abs());
            let far = far.fold(0.0, f64::max);
            assert!(far < 1e-6, "{}: {far:e}\n{better}", candidate.id);
        }
        assert!(seen.len() >= 6, "{seen:?}");
    }
}
