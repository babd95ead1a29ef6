//! Chatter in the shop: where it sets in, what it spoils, what the rules make of it.

use toolroom_form::ReadError;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::read;
use toolroom_shop::run;
use toolroom_shop::runlog::{JobOutcome, LogEvent, RunLog};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/chatter-policies.toml");

/// The shipped scenario for an hour, every structure the nominal one.
fn scenario(overrides: &[&str]) -> Scenario {
    let nominal = [
        "tool.insert.structure_scatter.natural_frequency=0",
        "tool.insert.structure_scatter.damping_ratio=0",
        "shop.horizon=\"1.2 h\"",
        "shop.warm_up=\"0 h\"",
    ];
    let all: Vec<String> = nominal.iter().chain(overrides).map(|each| (*each).to_owned()).collect();
    read(FILE.as_ref(), &all).unwrap().scenario
}

fn log(scenario: &Scenario, policy: &str) -> RunLog {
    let index = scenario.policies.iter().position(|each| each.name == policy).unwrap();
    run(scenario, index, 0).unwrap()
}

fn chatter_share(log: &RunLog, operation: u32) -> f64 {
    let passes = || log.passes.iter().filter(|row| row.operation == operation);
    passes().map(|row| row.chatter_time).sum::<f64>() / passes().map(|row| row.cutting_time).sum::<f64>()
}

#[test]
fn chatter_is_logged_where_it_sets_in_and_scraps_rough_parts() {
    let scenario = scenario(&[]);
    let log = log(&scenario, "constant");
    assert!(chatter_share(&log, 0) > 0.02, "{}", chatter_share(&log, 0));
    let onsets: Vec<f64> =
        log.events.iter().filter(|row| row.event == LogEvent::ChatterOnset).map(|row| row.time).collect();
    assert!(!onsets.is_empty());
    for onset in &onsets {
        // It grows within a pass in which some time chatters.
        let inside =
            |row: &&toolroom_shop::runlog::PassRow| row.start < *onset && *onset < row.end && row.chatter_time > 0.0;
        assert!(log.passes.iter().any(|row| inside(&row)), "{onset}");
    }
    agrees(&log);
    assert!(log.jobs.iter().any(|job| job.outcome == JobOutcome::Chatter));
    let tolerant = scenario_without_limits();
    assert!(run(&tolerant, 0, 0).unwrap().jobs.iter().all(|job| job.outcome != JobOutcome::Chatter));
}

/// Margin, time in chatter, marks and onsets tell of the same stretches.
fn agrees(log: &RunLog) {
    let quiet =
        |operation: u32| log.passes.iter().filter(move |row| row.operation == operation && row.chatter_time == 0.0);
    // Where every pass chatters some time, that of an ideal edge is not known.
    let quiet_roughness = [0, 1].map(|operation| quiet(operation).map(|row| row.roughness).fold(2e-6, f64::max));
    for row in log.passes.iter().filter(|row| !row.stability_margin.is_nan()) {
        let onsets = log.events.iter().filter(|event| {
            event.event == LogEvent::ChatterOnset
                && event.machine == Some(row.machine)
                && (row.start..=row.end).contains(&event.time)
        });
        let first = onsets.map(|event| event.time).reduce(f64::min);
        assert_eq!(row.stability_margin < 0.0, row.chatter_time > 0.0, "{row:?}");
        let quiet = quiet_roughness[row.operation as usize];
        assert_eq!(first.is_some(), row.roughness > quiet, "{first:?} {quiet} {row:?}");
        assert!(first.is_none() || row.vibration_amplitude > 20e-6, "{first:?} {row:?}");
        assert!(first.is_none() || row.chatter_time > 0.0 && row.chatter_frequency > 0.0, "{first:?} {row:?}");
        // It has to grow: the onset comes after some of the time in chatter.
        assert!(first.is_none_or(|time| time > row.start), "{first:?} {row:?}");
        assert!(row.chatter_time <= row.cutting_time * (1.0 + 1e-9));
    }
}

#[test]
fn onset_time_in_chatter_and_marks_agree_wherever_the_limit_lies() {
    let mut short = 0;
    for depth in ["0.48 mm", "0.5 mm", "0.52 mm"] {
        let scenario = scenario(&[&format!("part.shaft.operation.turn.depth_of_cut=\"{depth}\"")]);
        for policy in ["constant", "reactive", "productivity, constrained"] {
            let log = log(&scenario, policy);
            agrees(&log);
            short += log.passes.iter().filter(|row| (1e-9..3.0).contains(&row.chatter_time)).count();
        }
    }
    assert!(short > 0);
}

/// Of many edges some meet the limit for an instant only: that was logged as chatter without time in it.
#[test]
fn a_shop_over_many_edges_agrees_with_itself() {
    let scenario = read(FILE.as_ref(), &[]).unwrap().scenario;
    agrees(&log(&scenario, "constant"));
}

fn scenario_without_limits() -> Scenario {
    let mut scenario = scenario(&[]);
    for operation in scenario.parts.iter_mut().flat_map(|part| &mut part.operations) {
        operation.roughness_limit = f64::INFINITY;
    }
    scenario
}

#[test]
fn a_machine_that_has_heard_chatter_goes_where_it_is_quiet() {
    let scenario = scenario(&[]);
    let (constant, reactive) = (log(&scenario, "constant"), log(&scenario, "reactive"));
    for operation in 0..2 {
        let (before, after) = (chatter_share(&constant, operation), chatter_share(&reactive, operation));
        assert!(after < 0.7 * before, "operation {operation}: {before} and {after}");
    }
    // The path is the same, in however many pieces it is cut.
    let path = |log: &RunLog| {
        let done: Vec<u32> =
            (0..log.jobs.len() as u32).filter(|job| log.jobs[*job as usize].outcome == JobOutcome::Good).collect();
        let path_of = |job: u32| {
            log.passes.iter().filter(|row| row.job == job && row.operation == 0).map(|row| row.path).sum::<f64>()
        };
        done.first().map(|job| path_of(*job))
    };
    let expected = 2.0 * std::f64::consts::PI * 0.04 * 0.4 / 0.2e-3;
    if let Some(path) = path(&reactive) {
        assert!((path / expected - 1.0).abs() < 1e-9, "{path} {expected}");
    }
}

#[test]
fn layers_keep_below_the_nominal_limit_and_take_their_time() {
    let scenario = scenario(&["tool.insert.scatter=none", "tool.\"end mill\".scatter=none"]);
    let log = log(&scenario, "depth reduction");
    for row in log.passes.iter().filter(|row| row.operation == 0 && row.end < log.horizon) {
        assert!(row.stability_margin > 0.05, "{row:?}");
        assert!(row.depth_of_cut < 0.5e-3 && row.depth_of_cut > 0.1e-3);
        let layers = 0.55e-3 / row.depth_of_cut;
        assert!((layers - layers.round()).abs() < 1e-9 && (row.path / layers.round() - 251.3).abs() < 0.1, "{row:?}");
    }
}

#[test]
fn a_margin_is_kept_on_the_nominal_structure() {
    let scenario = scenario(&["tool.insert.scatter=none", "tool.\"end mill\".scatter=none"]);
    for policy in ["best lobe", "robust lobe", "productivity, constrained"] {
        let log = log(&scenario, policy);
        let judged = log.passes.iter().filter(|row| row.operation == 0);
        let quiet = judged.clone().filter(|row| row.stability_margin > 0.0).count();
        assert!(quiet as f64 > 0.9 * judged.count() as f64, "{policy}");
    }
}

#[test]
fn the_same_seed_gives_the_same_log() {
    let scenario = scenario(&[]);
    let (first, second) = (log(&scenario, "reactive"), log(&scenario, "reactive"));
    assert_eq!(first.digest, second.digest);
    // As text, for what is not defined is not equal to itself.
    assert_eq!(format!("{:?}", first.passes), format!("{:?}", second.passes));
}

#[test]
fn a_structure_that_is_none_is_told_with_its_place() {
    let cases = [
        ("tool.insert.structure=chatter/missing.toml", "missing.toml"),
        ("tool.insert.structure=chatter/milling-slot.toml", "describes no turning"),
        ("tool.\"end mill\".structure=chatter/milling-slot.toml", "its cutter has 2 teeth"),
        ("tool.insert.structure_scatter.damping_ratio=2", "outside 0 to 0.5"),
        ("part.shaft.operation.turn.position=\"900 mm\"", "the tool is on the bar"),
        ("policy.1.chatter=best_lobes", "best_lobe"),
    ];
    for (change, told) in cases {
        let Err(ReadError::Faults(list)) = read(FILE.as_ref(), &[change.to_owned()]) else { panic!("{change}") };
        let text: Vec<String> = list.problems.iter().map(|problem| format!("{:?}", problem.fault)).collect();
        assert!(text.iter().any(|fault| fault.contains(told)) || list.to_string().contains(told), "{change}: {list}");
    }
}

/// The shipped scenario with the mill's modes in a structure file by speed: the same at 2000 and 7000 rpm.
fn by_speed(name: &str, change: impl Fn(String) -> String, cutter: &str) -> Result<Scenario, ReadError> {
    let folder = std::env::temp_dir().join(format!("toolroom-shop-{name}-{}", std::process::id()));
    let chatter = folder.join("chatter");
    std::fs::create_dir_all(&chatter).unwrap();
    let shipped = std::path::Path::new(FILE).parent().unwrap().to_path_buf();
    let text = |file: &str| std::fs::read_to_string(shipped.join(file)).unwrap();
    std::fs::write(folder.join("shop.toml"), text("chatter-policies.toml")).unwrap();
    std::fs::write(chatter.join("shaft.toml"), text("chatter/shaft.toml")).unwrap();
    let lobes = text("chatter/endmill.toml");
    let (before, rest) = lobes.split_once("[[mode]]").unwrap();
    let (_, after) = rest.split_once("[cutter]").unwrap();
    std::fs::write(
        chatter.join("endmill.toml"),
        format!("{before}structure = \"modes.toml\"\n[cutter]\n{cutter}\n{after}"),
    )
    .unwrap();
    let mode = |name: &str, direction: &str, frequency: f64, stiffness: f64| {
        format!(
            "[[speed.mode]]\nname = \"{name}\"\ndirection = {direction}\nnatural_frequency = {{ value = \"{frequency} Hz\" }}\n\
             damping_ratio = {{ value = 0.03 }}\nstiffness = {{ value = \"{stiffness} N/um\" }}\n"
        )
    };
    let speed = |rpm: f64| {
        let modes = mode("feed", "[1, 0]", 1150.0, 11.0) + &mode("normal", "[0, 1]", 1240.0, 9.6);
        format!("[[speed]]\nspindle_speed = \"{rpm} rpm\"\n{modes}")
    };
    let head = "schema = 1\nname = \"modes\"\n[measurement]\nsource = \"taps\"\n";
    std::fs::write(chatter.join("modes.toml"), change(format!("{head}{}{}", speed(2000.0), speed(7000.0)))).unwrap();
    let short = ["shop.horizon=\"1.2 h\"".to_owned(), "shop.warm_up=\"0 h\"".to_owned()];
    let found = read(&folder.join("shop.toml"), &short);
    std::fs::remove_dir_all(folder).unwrap();
    found.map(|file| file.scenario)
}

#[test]
fn modes_by_speed_are_those_of_the_cut_and_refused_where_nobody_measured() {
    let same = by_speed("same", |text| text, "").unwrap();
    let short = ["shop.horizon=\"1.2 h\"".to_owned(), "shop.warm_up=\"0 h\"".to_owned()];
    let plain = read(FILE.as_ref(), &short).unwrap().scenario;
    let (with, without) = (log(&same, "best lobe"), log(&plain, "best lobe"));
    assert!(!with.passes.is_empty());
    assert_eq!(format!("{:?}", with.passes), format!("{:?}", without.passes));
    // 160 m/min are 4244 rpm.
    let refused = |error: ReadError, words: [&str; 2]| {
        let text = format!("{error:?} {error}");
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    };
    let faster = by_speed("outside", |text| text.replace("2000 rpm", "5000 rpm"), "");
    refused(faster.unwrap_err(), ["cutting_speed", "[[speed]]"]);
}

#[test]
fn a_wall_is_judged_at_its_worst_place_and_a_ball_end_by_its_corner() {
    let stations = |text: String| {
        text.replace("[[speed", "[[station")
            .replace("spindle_speed = \"2000 rpm\"", "position = \"0 mm\"")
            .replace("spindle_speed = \"7000 rpm\"", "position = \"80 mm\"")
    };
    let soft = |text: String| {
        let text = stations(text);
        let (near, far) = text.split_once("80 mm").unwrap();
        format!("{near}80 mm{}", far.replace("9.6 N/um", "3.2 N/um"))
    };
    let short = ["shop.horizon=\"1.2 h\"".to_owned(), "shop.warm_up=\"0 h\"".to_owned()];
    let plain = log(&read(FILE.as_ref(), &short).unwrap().scenario, "constant");
    let same = log(&by_speed("wall", stations, "").unwrap(), "constant");
    assert_eq!(format!("{:?}", same.passes), format!("{:?}", plain.passes));
    let soft = log(&by_speed("soft", soft, "").unwrap(), "constant");
    let ball = log(&by_speed("ball", |text| text, "corner_radius = \"2 mm\"").unwrap(), "constant");
    let margin = |log: &RunLog| {
        let milled = log.passes.iter().filter(|row| row.operation == 1).map(|row| row.stability_margin);
        milled.fold(f64::INFINITY, f64::min)
    };
    assert!(margin(&soft) < margin(&plain) - 0.1, "{} {}", margin(&soft), margin(&plain));
    assert_ne!(format!("{:?}", ball.passes), format!("{:?}", plain.passes));
}

/// A machine whose structure is softer than the one that was tapped: it chatters more there, nowhere else, and size zero is the
/// shop without the effect.
#[test]
fn a_softer_structure_of_one_machine_chatters_there() {
    let with = |effects: &str| log(&scenario(&[&format!("tool.insert.effects={effects}")]), "constant");
    let plain = log(&scenario(&[]), "constant");
    let machine = |log: &RunLog, machine: u32| {
        let turned = log.passes.iter().filter(move |row| row.operation == 0 && row.machine == machine);
        turned.map(|row| row.stability_margin).fold(f64::INFINITY, f64::min)
    };
    let on_first =
        |id: &str, size: f64| format!("[{{ id = \"{id}\", size = {size}, scope = {{ machine = \"L1\" }} }}]");
    for id in ["mode_frequency", "mode_damping", "mode_stiffness"] {
        assert_eq!(format!("{:?}", with(&on_first(id, 0.0)).passes), format!("{:?}", plain.passes), "{id}");
    }
    let softer = with(&on_first("mode_stiffness", -0.3));
    // The margin is 1 − depth/limit, and the limit goes with the stiffness.
    assert!(machine(&softer, 0) < machine(&plain, 0) - 0.2, "{} {}", machine(&softer, 0), machine(&plain, 0));
    assert!((machine(&softer, 1) - machine(&plain, 1)).abs() < 0.1, "{} {}", machine(&softer, 1), machine(&plain, 1));
    let stiffer = with(&on_first("mode_stiffness", 0.5));
    assert!(machine(&stiffer, 0) > machine(&plain, 0) + 0.1, "{} {}", machine(&stiffer, 0), machine(&plain, 0));
}
