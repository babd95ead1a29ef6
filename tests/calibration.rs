//! Calibration on one's own tools: from a table of wear readings to a set that shops accept, with what it does not tell.

use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

fn toolroom(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(arguments)
        .env("NO_COLOR", "1")
        .current_dir(folder)
        .output()
        .expect("the binary runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A calibration of turning on `wear.csv`, from the shipped set, to `my.toml`.
fn calibrated(folder: &Path, more: &[&str]) -> Output {
    let command =
        ["calibrate", "turning", "--model", "c45_t15k6", "--data", "wear.csv", "--limit", "0.3 mm", "--out", "my.toml"];
    toolroom(folder, &[&command[..], more].concat())
}

/// The answer of a command for programs.
fn answer(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// Six edges at three speeds whose life is 30 min · (220 m/min / v)⁴ to 0.3 mm, worn evenly over time, with levels and
/// reading errors of a fixed pattern; `unit` in mm is that of the wear readings.
fn wear(unit: f64, header: &str) -> String {
    let mut table = format!(
        "operation_id,machine,tool_id,sequence,cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],cutting_time [min],{header},edge_end\n"
    );
    for (edge, (speed, level)) in
        [(180.0, 1.1), (180.0, 0.9), (220.0, 0.95), (220.0, 1.05), (280.0, 1.0), (280.0, 1.1)].into_iter().enumerate()
    {
        let life = 30.0 * (220.0_f64 / speed).powi(4) / level;
        for reading in 1..=8_u32 {
            let error = [0.004, -0.006, 0.008, -0.003][(edge + reading as usize) % 4];
            let wear = (0.3 * f64::from(reading) / 8.0 + error) / unit;
            let end = if reading == 8 { "worn" } else { "" };
            let time = life / 8.0;
            let _ = writeln!(table, "O{edge}-{reading},L1,E{edge},{reading},{speed},0.3,1.5,{time:.4},{wear:.5},{end}");
        }
    }
    table
}

#[test]
fn wear_readings_become_a_set_with_intervals_that_shops_accept() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    fs::write(folder.join("wear.csv"), wear(1.0, "flank_wear [mm]")).expect("a table");
    let answer = answer(&calibrated(folder, &["--json"]));
    assert_eq!((&answer["edges"], &answer["readings"], &answer["ends"]["worn"]), (&6.into(), &48.into(), &6.into()));
    let life = answer["life"].as_array().expect("lives").iter();
    let life =
        life.clone().find(|life| life["cutting_speed [m/min]"].as_f64().is_some_and(|v| (v - 220.0).abs() < 1e-9));
    let life = &life.expect("a tested speed")["ci90"];
    assert!(life[0].as_f64() < Some(30.0) && Some(30.0) < life[1].as_f64(), "{life}");
    for file in ["my.toml", "my-posterior.parquet", "my-calibration.json", "my-report.html"] {
        assert!(folder.join(file).exists(), "{file}");
    }
    let checked = toolroom(folder, &["check", "my.toml"]);
    assert_eq!(checked.status.code(), Some(0), "{}", text(&checked.stderr));
    let point = toolroom(folder, &["point", "turning", "--tool", "my.toml", "--json"]);
    assert_eq!(point.status.code(), Some(0), "{}", text(&point.stderr));
    // Feed and depth do not vary, so that not everything is determined; the files are written all the same.
    let strict = calibrated(folder, &["--law", "extended_taylor", "--strict"]);
    assert_eq!(strict.status.code(), Some(1), "{}", text(&strict.stderr));
    assert!(text(&strict.stdout).contains("vary feed_per_rev"), "{}", text(&strict.stdout));
}

#[test]
fn tables_that_cannot_be_calibrated_on_are_refused_with_a_reason() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    fs::write(folder.join("unit.csv"), wear(1.0, "flank_wear [um]")).expect("a table");
    let mut words = wear(1.0, "flank_wear [mm]");
    words = words.replace(",worn", ",blunt");
    fs::write(folder.join("words.csv"), words).expect("a table");
    // Lines are those of the file, however they end and whatever comments stand above.
    let rows = wear(1.0, "flank_wear [mm]");
    let speed = format!("# our log\n{rows}").replacen("180", "-180", 1).replace('\n', "\r\n");
    fs::write(folder.join("speed.csv"), speed).expect("a table");
    let unread = rows.lines().map(|line| format!("{}\n", line.rsplitn(3, ',').last().unwrap_or_default()));
    fs::write(folder.join("unread.csv"), unread.collect::<String>()).expect("a table");
    let lives = "tool_id,cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],life [min],censored\n";
    let life = |rows: &str| format!("{lives}{rows}");
    fs::write(folder.join("good.csv"), life("A,180,0.2,1,40,yes\nB,220,0.2,1,20,\n")).expect("a table");
    fs::write(folder.join("twice.csv"), life("A,180,0.2,1,40,\nA,220,0.2,1,20,\n")).expect("a table");
    fs::write(folder.join("nothing.csv"), "").expect("a table");
    fs::write(
        folder.join("both.csv"),
        life("A,180,0.2,1,40,1\n").replace("censored\n", "censored,edge_end\n").replace(",1\n", ",1,worn\n"),
    )
    .expect("a table");
    // The same without the names of operations and machines: units are wrong on the whole.
    let short: String = rows
        .lines()
        .filter_map(|line| line.split_once(',')?.1.split_once(','))
        .map(|(_, rest)| format!("{rest}\n"))
        .collect();
    fs::write(folder.join("fast.csv"), short.replacen("[m/min]", "[m/s]", 1)).expect("a table");
    let short_in_um: String = wear(1e-3, "flank_wear [mm]")
        .lines()
        .filter_map(|line| line.split_once(',')?.1.split_once(','))
        .map(|(_, rest)| format!("{rest}\n"))
        .collect();
    fs::write(folder.join("thousand.csv"), short_in_um).expect("a table");
    fs::write(folder.join("teeth.csv"), short.replacen("feed_per_rev", "feed_per_tooth", 1)).expect("a table");
    for (file, reason) in [
        ("unit.csv", "write flank_wear [mm]"),
        ("words.csv", "`blunt`"),
        ("none.csv", "none.csv"),
        ("speed.csv", "line 3: a cutting_speed of -180 m/min"),
        ("unread.csv", "no row has a flank_wear"),
        ("good.csv", "line 2: censored is `yes`"),
        ("twice.csv", "two lives, in line 2 and line 3"),
        ("nothing.csv", "there is no row of data"),
        ("both.csv", "line 2: censored is 1"),
        ("fast.csv", "line 2, cutting_speed is 10800 m/min, beyond 3000 m/min"),
        ("thousand.csv", "write flank_wear [um]"),
        ("teeth.csv", "it is one of milling"),
    ] {
        let output =
            toolroom(folder, &["calibrate", "turning", "--model", "c45_t15k6", "--data", file, "--out", "my.toml"]);
        let message = text(&output.stderr);
        assert!(output.status.code() == Some(2) && message.contains(reason), "{file}: {message}");
        assert!(!folder.join("my.toml").exists(), "{file}");
    }
}

/// A study of tool lives on the same draws: the edge of median level lasts as long as the calibration says.
fn lives_of_draws_spread_as_the_calibration_says(folder: &Path, calibration: &Value) {
    let study = "schema = 1\nname = \"lives\"\nlives = 400\nparameter_set = \"./my.toml\"\n\
                 parameters_from = \"my-posterior.parquet\"\n\
                 [[condition]]\ncutting_speed = \"220 m/min\"\nfeed_per_rev = \"0.3 mm/rev\"\ndepth_of_cut = \"1.5 mm\"\n";
    fs::write(folder.join("lives.toml"), study).expect("a study");
    let lived = |out: &str, threads: &str| {
        answer(&toolroom(folder, &["life", "lives.toml", "--threads", threads, "--out", out, "--json"]))
    };
    let (lives, again) = (lived("lives", "1"), lived("again", "2"));
    assert_eq!(lives["digest"], again["digest"]);
    let row = calibration["life"]
        .as_array()
        .expect("lives")
        .iter()
        .find(|row| row["cutting_speed [m/min]"].as_f64().is_some_and(|speed| (speed - 220.0).abs() < 1e-9));
    let row = row.expect("a tested speed");
    let drawn = &lives["edge_of_median_level"];
    assert_eq!(drawn["draws"], 200);
    let near = |own: &Value, other: &Value| {
        let (own, other) = (own.as_f64().expect("a life"), other.as_f64().expect("a life"));
        assert!((own / other - 1.0).abs() < 0.02, "{drawn} against {row}");
    };
    near(&drawn["median [min]"], &row["median [min]"]);
    near(&drawn["ci90 [min]"][0], &row["ci90"][0]);
    near(&drawn["ci90 [min]"][1], &row["ci90"][1]);
    // Edges spread about as the next edge of the calibration does: its limit and scatter are the same.
    let (low, high) =
        (row["next_edge90"][0].as_f64().expect("a life"), row["next_edge90"][1].as_f64().expect("a life"));
    let quantile = |share: &str| lives["quantiles"][share].as_f64().expect("a life");
    assert!(
        (quantile("p5 [min]") / low - 1.0).abs() < 0.15 && (quantile("p95 [min]") / high - 1.0).abs() < 0.15,
        "{row}"
    );
    let early = format!("{study}[early]\nage = \"8 min\"\nwear_shift = 3\nchipping_rate = 30\n");
    fs::write(folder.join("early.toml"), early).expect("a study");
    let refused = toolroom(folder, &["check", "early.toml"]);
    let message = text(&refused.stderr);
    assert!(refused.status.code() == Some(2) && message.contains("parameters_from"), "{message}");
}

#[test]
fn draws_of_a_calibration_enter_a_shop_and_say_what_they_leave_open() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    fs::write(folder.join("wear.csv"), wear(1.0, "flank_wear [mm]")).expect("a table");
    let calibration = answer(&calibrated(folder, &["--law", "extended_taylor", "--draws", "200", "--json"]));
    lives_of_draws_spread_as_the_calibration_says(folder, &calibration);
    let shipped = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/steel-shafts.toml"));
    let keys = "parameter_set = \"./my.toml\"\nparameters_from = \"my-posterior.parquet\"";
    let scenario = shipped.expect("the shipped scenario").replace("parameter_set = \"c45_t15k6\"", keys);
    fs::write(folder.join("shop.toml"), scenario.replace("horizon = \"70 h\"", "horizon = \"34 h\""))
        .expect("a scenario");
    let answer = answer(&toolroom(folder, &["compare", "shop.toml", "--replications", "8", "--out", "out", "--json"]));
    let notes = answer["decision"]["notes"].to_string();
    assert!(notes.contains("over 2 draws of the parameters") && notes.contains("of what your data allow"), "{notes}");
    // What "needs about" counts are replications as they are given, not the two draws of four each.
    let line = answer["decision"]["line"].as_str().expect("a line");
    if let Some((_, rest)) = line.split_once("needs about ") {
        let count: f64 = rest.split(' ').next().and_then(|word| word.parse().ok()).expect("a number");
        assert!(count >= 8.0, "{line}");
    }
    // A value that both the file and the draws give, and draws of another law.
    let text_of = |path: &str| fs::read_to_string(folder.join(path)).expect("a file");
    let twice = text_of("shop.toml")
        .replace("parameters_from", "parameters = { extended_taylor = { speed_exponent = 4.0 } }\nparameters_from");
    fs::write(folder.join("twice.toml"), twice).expect("a scenario");
    fs::write(folder.join("law.toml"), text_of("shop.toml").replace("./my.toml", "c45_t15k6")).expect("a scenario");
    for (file, reason) in [("twice.toml", "which the draws hold as well"), ("law.toml", "another wear law")] {
        let refused = toolroom(folder, &["check", file]);
        let message = text(&refused.stderr);
        assert!(refused.status.code() == Some(2) && message.contains(reason), "{file}: {message}");
    }
}

#[test]
fn the_records_of_a_shop_are_calibrated_to_what_made_them() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    // A shop whose edges wear half as fast again by heat as the set says.
    let shipped = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/steel-shafts.toml"));
    let own =
        "parameter_set = \"c45_t15k6\"\nparameters = { energy_balance = { thermal_wear_rate = \"1.95 um/min\" } }";
    let scenario = shipped.expect("the shipped scenario").replace("parameter_set = \"c45_t15k6\"", own);
    fs::write(folder.join("shop.toml"), scenario.replace("horizon = \"70 h\"", "horizon = \"46 h\""))
        .expect("a scenario");
    let done = |arguments: &[&str]| {
        let output = toolroom(folder, arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
        output.stdout
    };
    let json = |arguments: &[&str]| serde_json::from_slice::<Value>(&done(arguments)).expect("JSON");
    let one = ["--policy", "programmed", "--replications", "1"];
    done(&[&["run", "shop.toml", "--records", "records", "--out", "out"][..], &one[..]].concat());
    done(&["calibrate", "--bake", "shop.toml", "--tool", "insert", "--out", "truth.toml"]);
    let calibrate = ["calibrate", "turning", "--model", "c45_t15k6", "--law", "energy_balance", "--draws", "400"];
    let answer = json(&[&calibrate[..], &["--data", "records/operations.csv", "--out", "my.toml", "--json"]].concat());
    assert!(answer["readings"].as_u64() > Some(1000), "{answer}");
    let lives = answer["life"].as_array().expect("lives");
    assert!(!lives.is_empty());
    for life in lives {
        let set =
            |key: &str, name: &str, unit: &str| format!("{name}={} {unit}", life[key].as_f64().expect("a number"));
        let speed = set("cutting_speed [m/min]", "cutting_speed", "m/min");
        let feed = set("feed_per_rev [mm]", "feed_per_rev", "mm");
        let depth = set("depth_of_cut [mm]", "depth_of_cut", "mm");
        let point = json(&[
            "point",
            "turning",
            "--tool",
            "truth.toml",
            "--set",
            &speed,
            "--set",
            &feed,
            "--set",
            &depth,
            "--json",
        ]);
        let path = point["outputs"]["path_life [m]"].as_f64().expect("a path");
        let truth = (path / life["cutting_speed [m/min]"].as_f64().expect("a speed")).ln();
        let end = |place: usize| life["ci90"][place].as_f64().expect("a life").ln();
        let (middle, deviation) = (0.5 * (end(0) + end(1)), (end(1) - end(0)) / 3.29);
        assert!((truth - middle).abs() < 3.0 * deviation, "{} min against {life}", truth.exp());
        assert!(deviation < 0.2, "the data tell the life: {life}");
    }
}

/// Eight cutters as a shop may log them: minutes since the cutter was mounted, wear in um, two materials of which steel wears
/// a cutter out in half the time.
fn milling_log() -> String {
    let mut table = String::from("cutter;no;stock;vc;fz;ae;t;VB\n");
    let cutters = [
        (150.0, 0.05, 3.0, "iron"),
        (150.0, 0.08, 3.0, "steel"),
        (190.0, 0.05, 6.0, "steel"),
        (190.0, 0.08, 6.0, "iron"),
        (230.0, 0.05, 3.0, "iron"),
        (230.0, 0.08, 6.0, "steel"),
    ];
    for (cutter, (speed, feed, width, stock)) in cutters.into_iter().enumerate() {
        let level = [1.05, 0.95, 1.0, 1.1, 0.9, 1.0][cutter] * if stock == "steel" { 2.0 } else { 1.0 };
        let life =
            40.0 * (190.0_f64 / speed).powi(3) * (0.05_f64 / feed).powf(0.5) * (3.0_f64 / width).powf(0.65) / level;
        for reading in 1..=6_u32 {
            let share = f64::from(reading) / 6.0;
            let wear = 300.0 * share + [4.0, -6.0, 3.0][(cutter + reading as usize) % 3];
            let _ = writeln!(table, "C{cutter};{reading};{stock};{speed};{feed};{width};{:.3};{wear:.1}", life * share);
        }
    }
    table
}

#[test]
fn a_log_of_milling_becomes_a_set_whose_draws_a_shop_takes() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    fs::write(folder.join("log.csv"), milling_log()).expect("a table");
    let map = "schema = 1\nprocess = \"milling\"\ncolumn = [\n\
               { name = \"machine\", constant = \"M1\" },\n{ name = \"tool_id\", from = \"cutter\" },\n\
               { name = \"sequence\", from = \"no\" },\n{ name = \"material\", from = \"stock\" },\n\
               { name = \"cutting_speed\", from = \"vc\", unit = \"m/min\" },\n\
               { name = \"feed_per_tooth\", from = \"fz\", unit = \"mm\" },\n\
               { name = \"depth_of_cut\", constant = \"12 mm\" },\n\
               { name = \"width_of_cut\", from = \"ae\", unit = \"mm\" },\n\
               { name = \"cutting_time\", from = \"t\", unit = \"min\", running = true },\n\
               { name = \"flank_wear\", from = \"VB\", unit = \"um\" },\n]\n";
    fs::write(folder.join("map.toml"), map).expect("a mapping");
    let imported = toolroom(folder, &["import", "csv", "log.csv", "--map", "map.toml", "--out", "records"]);
    assert_eq!(imported.status.code(), Some(0), "{}", text(&imported.stderr));
    let command = ["calibrate", "milling", "--model", "c45_endmill_d12", "--data", "records", "--out", "mill.toml"];
    let more = ["--by", "material", "--shape", "straight", "--draws", "200", "--json"];
    let answer = answer(&toolroom(folder, &[&command[..], &more[..]].concat()));
    let steel = answer["parameters"].as_array().expect("a list").iter().find(|own| own["name"] == "material=steel");
    let ends = &steel.expect("a factor")["ci90"];
    assert!(ends[0].as_f64() < Some(2.0) && Some(2.0) < ends[1].as_f64(), "{ends}");
    let checked = toolroom(folder, &["check", "mill.toml"]);
    assert_eq!(checked.status.code(), Some(0), "{}", text(&checked.stderr));
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/gap/milling.toml");
    let shop = fs::read_to_string(shipped).expect("the shipped scenario");
    let keys = "parameter_set = \"./mill.toml\"\nparameters_from = \"mill-posterior.parquet\"";
    fs::write(folder.join("shop.toml"), shop.replace("parameter_set = \"c45_endmill_d12\"", keys)).expect("a scenario");
    let ran = toolroom(folder, &["run", "shop.toml", "--out", "out"]);
    assert_eq!(ran.status.code(), Some(0), "{}", text(&ran.stderr));
    // What a scenario states beside the set becomes a set of its own.
    let stated = keys.replace(
        "\nparameters_from = \"mill-posterior.parquet\"",
        "\nparameters = { life = { speed_exponent = 4.0 } }",
    );
    fs::write(folder.join("stated.toml"), shop.replace("parameter_set = \"c45_endmill_d12\"", &stated))
        .expect("a file");
    let baked = toolroom(folder, &["calibrate", "--bake", "stated.toml", "--tool", "end mill", "--out", "baked.toml"]);
    assert_eq!(baked.status.code(), Some(0), "{}", text(&baked.stderr));
    assert!(text(&baked.stdout).contains("life.speed_exponent"), "{}", text(&baked.stdout));
    let checked = toolroom(folder, &["check", "baked.toml"]);
    assert_eq!(checked.status.code(), Some(0), "{}", text(&checked.stderr));
    for (wrong, reason) in [
        (["--by", "stock"], "no such column"),
        (["--law", "usui"], "no wear law `usui` of milling"),
        (["--shape", "bent"], "no shape `bent`"),
        (["--holdout", "C9"], "no edge `C9`"),
    ] {
        let refused = toolroom(folder, &[&command[..6], &["--out", "none.toml"], &wrong[..]].concat());
        let message = text(&refused.stderr);
        assert!(refused.status.code() == Some(2) && message.contains(reason), "{wrong:?}: {message}");
    }
}

#[test]
fn a_wear_rate_that_was_measured_is_in_the_baked_set() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/steel-shafts.toml");
    let shop = fs::read_to_string(shipped).expect("the shipped scenario");
    let entry = |tool: &str, factor: f64| {
        format!(
            "[[calibration]]\nparameter = \"wear_rate\"\ntarget = \"tool {tool}\"\nfactor = {factor}\nstandard_error = 0.05\n\
             by = \"gap apply\"\n"
        )
    };
    let measured = format!("{shop}\n{}{}", entry("insert", 1.25), entry("end mill", 0.8));
    fs::write(folder.join("shop.toml"), measured).expect("a scenario");
    for (tool, levels, other) in [
        ("insert", "energy_balance.mechanical_wear_per_path and energy_balance.thermal_wear_rate", "end mill"),
        ("end mill", "life.reference_life", "insert"),
    ] {
        let words = ["calibrate", "--bake", "shop.toml", "--tool", tool, "--force", "--json", "--out", "baked.toml"];
        let baked = answer(&toolroom(folder, &words));
        let moved: Vec<&str> =
            baked["moved"].as_array().expect("a list").iter().filter_map(|line| line.as_str()).collect();
        assert!(moved.iter().any(|line| line.starts_with("wear_rate: times") && line.ends_with(levels)), "{moved:?}");
        assert_eq!(baked["left_out"], serde_json::json!([format!("wear_rate of tool {other}")]));
        let set = fs::read_to_string(folder.join("baked.toml")).expect("a set");
        let first = levels.split(' ').next().expect("a level");
        assert!(set.contains(&format!("\"{first}\" = {{ factor = 1.0512")), "{set}");
    }
}

#[test]
fn edges_whose_record_begins_late_are_not_taken_for_new() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    // The first half of each edge's readings is lost: they begin at 0.19 mm of 0.3.
    let late = |line: &&str| !line.starts_with('O') || !["-1,", "-2,", "-3,", "-4,"].iter().any(|at| line.contains(at));
    let table = wear(1.0, "flank_wear [mm]");
    fs::write(folder.join("wear.csv"), table.lines().filter(late).collect::<Vec<_>>().join("\n")).expect("a table");
    let life = |more: &[&str]| {
        let output =
            calibrated(folder, &[&["--law", "extended_taylor", "--draws", "200", "--force", "--json"], more].concat());
        let found = answer(&output);
        let parameters = found["parameters"].as_array().expect("a list").clone();
        let life =
            parameters.into_iter().find(|own| own["name"].as_str().is_some_and(|name| name.contains("reference_life")));
        (life.expect("a life")["map"].as_f64().expect("a number"), found.to_string())
    };
    let (by_itself, told) = life(&[]);
    // At 180 m/min the edges last for 30 min · (220/180)⁴ = 67 min.
    assert!((55.0..80.0).contains(&by_itself), "{by_itself}");
    assert!(told.contains("6 edges, E0 first, begin at their first readings (0.1"), "{told}");
    assert_eq!(life(&["--start", "unknown"]).0, by_itself);
    assert!(life(&["--start", "new"]).0 < 40.0);
}

#[test]
fn a_decision_of_a_scenario_says_what_to_measure_and_edges_that_chip_give_a_rate() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    // The fourth edge chipped.
    let whole = wear(1.0, "flank_wear [mm]");
    let table = whole
        .lines()
        .map(|line| if line.starts_with("O3-8") { line.replace(",worn", ",chipped") } else { line.to_owned() });
    fs::write(folder.join("wear.csv"), table.collect::<Vec<_>>().join("\n")).expect("a table");
    fs::write(folder.join("priors.toml"), "[prior]\n\"extended_taylor.feed_exponent\" = { deviation = 0.2 }\n")
        .expect("a file");
    let shop = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/steel-shafts.toml");
    let shop = shop.to_str().expect("a path");
    let more = ["--law", "extended_taylor", "--draws", "500", "--decision", shop, "--prior", "priors.toml", "--json"];
    let answer = answer(&calibrated(folder, &more));
    let chips = &answer["scatter"]["chipping_rate [1/km]"];
    assert!(chips["chips"] == 1 && chips["ci90"][0].as_f64() < chips["value"].as_f64(), "{chips}");
    assert!(fs::read_to_string(folder.join("my.toml")).expect("a set").contains("[parameters.chipping]"));
    let decision = &answer["decision"];
    let share = decision["second_better"].as_f64().expect("a share");
    assert!((0.0..=1.0).contains(&share) && decision["evpi_per_km"].as_f64() >= Some(0.0), "{decision}");
    for test in decision["next_experiment"].as_array().expect("a list") {
        assert!(test["sd_decision_after"].as_f64() < test["sd_decision_before"].as_f64(), "{test}");
    }
    let feed = answer["parameters"]
        .as_array()
        .expect("a list")
        .iter()
        .find(|own| own["name"] == "extended_taylor.feed_exponent");
    assert_eq!(feed.expect("a parameter")["prior"]["sd"], 0.2);
}

#[test]
fn what_one_life_leaves_open_enters_shops_and_stability_charts() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    let known = ["calibrate", "turning", "--life", "15 min", "--at", "200 m/min", "--out", "first.toml"];
    answer(&toolroom(folder, &[&known[..], &["--draws", "200", "--json"]].concat()));
    let shipped = |file: &str| fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).expect("shipped");
    let keys = "parameter_set = \"./first.toml\"\nparameters_from = \"first-posterior.parquet\"";
    let shop = shipped("scenarios/steel-shafts.toml").replace("parameter_set = \"c45_t15k6\"", keys);
    fs::write(folder.join("shop.toml"), shop).expect("a scenario");
    let checked = toolroom(folder, &["check", "shop.toml"]);
    assert_eq!(checked.status.code(), Some(0), "{}", text(&checked.stderr));
    // A force known to a quarter leaves open whether a cut near its limit is stable.
    fs::write(folder.join("chart.toml"), shipped("scenarios/chatter/turning-bar.toml")).expect("a chart");
    let at = ["lobes", "chart.toml", "--at", "1000 rpm", "1 mm", "--json"];
    let draws = ["--parameters-from", "first-posterior.parquet", "--parameter-set", "first.toml"];
    let judged = answer(&toolroom(folder, &[&at[..], &draws[..]].concat()));
    let probability = judged["p_stable"].as_f64().expect("a probability");
    assert!(0.5 < probability && probability < 1.0, "{judged}");
    let other =
        toolroom(folder, &["lobes", "chart.toml", "--at", "1000 rpm", "1 mm", "--parameters-from", "first.toml"]);
    assert_eq!(other.status.code(), Some(2), "draws belong to a set: {}", text(&other.stderr));
}

#[test]
fn wear_over_the_path_is_calibrated_like_wear_over_the_time() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    let timed = wear(1.0, "flank_wear [mm]");
    fs::write(folder.join("wear.csv"), &timed).expect("a table");
    let more = ["--law", "extended_taylor", "--draws", "200", "--json"];
    let by_time = answer(&calibrated(folder, &more));
    let over_path = timed.lines().enumerate().map(|(row, line)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if row == 0 {
            cells[7] = "path_length [m]".to_owned();
        } else {
            let [speed, time] = [4, 7].map(|place| cells[place].parse::<f64>().expect("a number"));
            cells[7] = format!("{:.9}", speed * time);
        }
        cells.join(",")
    });
    fs::write(folder.join("wear.csv"), over_path.collect::<Vec<_>>().join("\n")).expect("a table");
    let by_path = answer(&calibrated(folder, &more));
    let life = |answer: &Value| answer["life"][0]["median [min]"].as_f64().expect("a life");
    assert!((life(&by_path) / life(&by_time) - 1.0).abs() < 1e-3, "{} {}", life(&by_path), life(&by_time));
}
