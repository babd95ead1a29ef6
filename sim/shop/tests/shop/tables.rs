//! Shipped shops whose tables stand in another order.

use toolroom_scenario_file::parse;
use toolroom_shop::run;

/// The text of a scenario whose tables called `[[word]]` stand in reverse order, each with the tables inside it; those of machines
/// only where `machines` says so.
fn reversed(text: &str, machines: bool) -> String {
    let mut blocks: Vec<(String, String)> = vec![(String::new(), String::new())];
    for line in text.lines() {
        let header = line.strip_prefix('[').map(|rest| rest.trim_start_matches('['));
        let word = header.and_then(|rest| rest.split(']').next()).filter(|word| !word.contains(['.', '"', ' ', '{']));
        if let Some(word) = word {
            let several = line.starts_with("[[");
            blocks.push((if several { word.to_owned() } else { String::new() }, String::new()));
        }
        let (_, block) = blocks.last_mut().expect("there is the head");
        block.push_str(line);
        block.push('\n');
    }
    // The first policy is the one that runs.
    let turns = |word: &str| !word.is_empty() && word != "policy" && (machines || word != "machine");
    let mut all = String::new();
    for (place, (word, block)) in blocks.iter().enumerate() {
        let alike: Vec<usize> = (0..blocks.len()).filter(|other| blocks[*other].0 == *word).collect();
        let index = alike.iter().position(|other| *other == place).expect("it is like itself");
        all += if turns(word) { &blocks[alike[alike.len() - 1 - index]].1 } else { block };
    }
    all
}

#[test]
fn shipped_shops_give_the_same_results_with_tables_in_another_order() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/shop");
    let mut other = Vec::new();
    for name in [
        "assembly",
        "cards",
        "crib",
        "flexible-cell",
        "ft06",
        "ft10",
        "furnace",
        "job-shop",
        "line",
        "mixed",
        "orders",
        "rework",
        "running",
        "urgent",
    ] {
        let file = folder.join(format!("{name}.toml"));
        let text = std::fs::read_to_string(&file).unwrap();
        // Idle machines choose in the order of the file: where a job needs fixture and person together, the first of two
        // machines has the person.
        let machines = name != "flexible-cell";
        let turned = reversed(&text, machines);
        assert!(turned != text, "{name} has no table to turn");
        let results = |text: &str| {
            // What has orders ends with them.
            let has_orders = text.contains("[[order]]") || text.contains("[tables]");
            let shorter: &[&str] = if has_orders { &[] } else { &["shop.warm_up=\"0 h\"", "shop.horizon=\"60 h\""] };
            let changes: Vec<String> = shorter.iter().map(|&change| change.to_owned()).collect();
            let scenario = parse(file.to_str().unwrap(), text, &changes)
                .unwrap_or_else(|error| panic!("{name}: {error}"))
                .scenario;
            let log = run(&scenario, 0, 0).unwrap();
            let of = |job: &toolroom_shop::runlog::JobRow| {
                let part = scenario.parts[job.part as usize].name.clone();
                (
                    job.arrival.to_bits(),
                    part,
                    job.order.map(|order| scenario.orders[order as usize].id.clone()),
                    job.finish.to_bits(),
                )
            };
            let mut jobs: Vec<_> = log.jobs.iter().map(of).collect();
            jobs.sort();
            assert!(jobs.len() > 2, "{name}");
            jobs
        };
        if results(&text) != results(&turned) {
            other.push(name);
        }
    }
    assert!(other.is_empty(), "{other:?}");
}

/// Two sources of a part: each draws by its name, whatever else comes.
#[test]
fn a_source_with_a_name_draws_the_same_whatever_other_sources_there_are() {
    let head = "schema = 1\n[shop]\nname = \"t\"\nhorizon = \"100 h\"\n[[machine]]\nname = \"A\"\nprocess = \"plain\"\n\
                [[part]]\nname = \"p\"\n[[part.operation]]\nname = \"o\"\nmachines = \"A\"\n\
                work = { distribution = \"exponential\", mean = \"1 min\" }\n";
    let source = |name: &str, pieces: u32| {
        let name = if name.is_empty() { String::new() } else { format!("name = \"{name}\"\n") };
        format!("[[arrivals]]\n{name}part = \"p\"\npattern = \"poisson\"\nrate = \"2 1/h\"\nquantity = {pieces}\n")
    };
    let jobs = |sources: &[String]| {
        let text = format!("{head}{}", sources.concat());
        let scenario = parse("t.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
        let log = run(&scenario, 0, 0).unwrap();
        let own = log.jobs.iter().filter(|job| job.quantity == 7);
        own.map(|job| job.arrival.to_bits()).collect::<Vec<_>>()
    };
    let alone = jobs(&[source("export", 7)]);
    assert!(alone.len() > 150);
    assert_eq!(jobs(&[source("export", 7), source("home", 1)]), alone);
    assert_eq!(jobs(&[source("", 1), source("another", 2), source("export", 7)]), alone);
    assert_ne!(jobs(&[source("home", 7)]), alone);
}
