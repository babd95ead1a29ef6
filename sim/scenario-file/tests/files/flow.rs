//! Sources of several parts, stocks, samples, weeks that take turns: what is read, and what is told of bad ones.

use super::*;
use toolroom_scenario::{OutsideSample, Pegging, Replenish};

const SHOP: &str = r#"schema = 1
[shop]
name = "flow"
start = "2026-03-30 00:00"
horizon = "3 week"
[statistics]
primary = "tardiness"
until = { lead_time = "half-width 2 %" }
select = { kpi = "tardiness", indifference = "15 min" }
[[calendar]]
name = "turns"
week = [{ mon-fri = ["06:00-14:00", { time = "22:00-06:00", factor = 0.8 }] }, { mon-fri = ["14:00-22:00"] }]
weeks = 2
[[machine]]
name = "saw"
process = "plain"
calendar = "turns"
[[machine]]
name = "bench"
process = "plain"
[[machine]]
name = "CMM"
process = "plain"
[[transport]]
name = "AGV"
capacity = 3
locations = ["saw", "bench"]
times = [["0 min", "2 min"], ["2 min", "0 min"]]
[[part]]
name = "bar"
replenish = "new_order"
replenish_priority = -1
[[part.operation]]
name = "cut"
machines = "saw"
draw = "part"
work = { distribution = "exponential", mean = "5 min" }
outcomes = [{ share = 0.1, scrap = true }]
sample = { every = 4 }
[[part.operation]]
name = "measure"
machines = "CMM"
work = "4 min"
sample = { every = 5, others = "pass" }
[[part]]
name = "frame"
replenish = { overrun = 0.05 }
pegging = "order"
components = [{ part = "bar", quantity = 4 }]
operation = [{ name = "join", machines = "bench", work = "9 min", assemble = true }]
[[part]]
name = "plate"
operation = [{ name = "cut", machines = "saw", work = "2 min" }]
[[stock]]
part = "bar"
quantity = 6
reorder = { below = 4, lot = 20, lead = "2 day" }
[[arrivals]]
part_mix = { plate = 0.75, bar = 0.25 }
quantity = { values = [1, 4], weights = [3, 1] }
pattern = "poisson"
rate = "1 1/h"
[[order]]
id = "F"
part = "frame"
quantity = 21
[[order]]
id = "B"
part = "bar"
quantity = 92
parent = "F"
"#;

#[test]
fn what_flows_is_understood() {
    let file = parse("flow.toml", SHOP, &[]).unwrap_or_else(|error| panic!("{error}"));
    let scenario = &file.scenario;
    let (bar, frame) = (&scenario.parts[0], &scenario.parts[1]);
    assert_eq!(bar.replenish, Replenish::NewOrder { priority: -1 });
    assert_eq!(bar.operations[1].inspection.sample.map(|own| (own.every, own.others)), Some((5, OutsideSample::Pass)));
    assert_eq!((frame.pegging, scenario.orders[1].parent), (Pegging::Order, Some(0)));
    // Five per cent of 21 are two pieces more: 23, for which 92 bars are made.
    assert_eq!((scenario.orders[0].overrun, scenario.orders[0].pieces()), (2, 23));
    let stock = scenario.shared.stocks[0];
    assert_eq!(
        (stock.quantity, stock.reorder.map(|own| (own.below, own.lot, own.lead))),
        (6, Some((4, 20, Some(172_800.0))))
    );
    // By name, whatever the order in the file.
    assert_eq!(scenario.arrivals[0].parts, [(0, 0.25), (2, 0.75)]);
    assert_eq!((scenario.arrivals[0].quantity.mean(), scenario.transports[0].capacity), (1.75, 3));
    assert!(!scenario.calendars[0].paces.is_even());
    // Five nights at 0.8 of the speed.
    let (worked, done) =
        (scenario.calendars[0].working_time(0.0, 604_800.0), scenario.calendars[0].work_done(0.0, 604_800.0));
    assert!((worked - done - 0.2 * 5.0 * 8.0 * 3600.0).abs() < 1e-6, "{worked} {done}");
    assert_eq!(file.statistics.primary.as_deref(), Some("tardiness"));
    assert_eq!(file.statistics.until, [("lead_time".to_owned(), "half-width 2 %".to_owned())]);
    assert_eq!(file.statistics.select.map(|own| own.confidence), Some(0.95), "as it is written");
}

#[test]
fn what_flows_badly_is_told_in_its_place() {
    let cases = [
        ("weeks = 2", "weeks = 3", "contradiction", "`week` is a list"),
        ("factor = 0.8", "factor = 0", "no-date", "factor"),
        ("factor = 0.8", "pace = 0.8", "no-date", "pace"),
        ("plate = 0.75", "plate = 0.7", "arrangement", "add up to 0.95"),
        ("plate = 0.75", "plat = 0.75", "unknown-name", "did you mean `plate`"),
        ("part_mix = { plate = 0.75, bar = 0.25 }", "", "missing-key", "part_mix"),
        ("part_mix", "part = \"plate\"\npart_mix", "not-applicable", "one of part, part_mix"),
        ("weights = [3, 1]", "weights = [3]", "arrangement", "1 weights"),
        ("{ values = [1, 4], weights = [3, 1] }", "{ low = 5, high = 2 }", "arrangement", "above high = 2"),
        ("others = \"pass\"", "others = \"skip\"", "unknown-choice", "worked"),
        (
            "work = \"4 min\"\nsample",
            "work = \"4 min\"\non_reject = { go = \"cut\" }\nsample",
            "not-applicable",
            "on_reject",
        ),
        (
            "name = \"CMM\"\nprocess = \"plain\"",
            "name = \"CMM\"\nprocess = \"plain\"\nload_time = \"1 min\"",
            "arrangement",
            "times of loading",
        ),
        ("outcomes = [{ share = 0.1, scrap = true }]\n", "", "arrangement", "has no outcomes"),
        ("draw = \"part\"", "draw = \"part\"\nwork_per = \"lot\"", "arrangement", "drawn one by one"),
        ("replenish = \"new_order\"\n", "", "not-applicable", "new_order"),
        ("replenish_priority = -1", "replenish_priority = -0.5", "wrong-type", "whole number"),
        ("quantity = 92", "quantity = 91", "arrangement", "needs 92 \"bar\""),
        ("parent = \"F\"", "parent = \"f\"", "unknown-name", "did you mean `F`"),
        ("pegging = \"order\"\n", "", "arrangement", "takes what is in stock"),
        (
            "components = [{ part = \"bar\", quantity = 4 }]",
            "components = [{ part = \"plate\", quantity = 4 }]",
            "arrangement",
            "does not go into",
        ),
        ("[[stock]]\npart = \"bar\"", "[[stock]]\npart = \"plate\"", "arrangement", "goes into no other part"),
        ("below = 4", "below = 0", "out-of-range", "below"),
        ("capacity = 3", "capacity = 0", "out-of-range", "capacity"),
        ("kpi = \"tardiness\", ", "", "missing-key", "kpi"),
    ];
    let mut wrong = Vec::new();
    for (from, to, code, words) in cases {
        assert!(SHOP.contains(from), "{from}");
        let told = faults_of(&SHOP.replacen(from, to, 1), &[]);
        // A fault stands in a line of the section that was spoiled, or names what is in it.
        if !told.iter().any(|(own, line, text)| *own == code && *line > 0 && text.contains(words)) {
            wrong.push(format!("{to}: {told:#?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A distribution of a file beside the scenario, or what is told of it.
fn of_times(table: &str, keys: &str) -> Result<Distribution, Vec<String>> {
    static NUMBER: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
    let number = NUMBER.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("toolroom-times-{}-{number}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let text = SHOP
        .replace("work = \"9 min\"", &format!("work = {{ distribution = \"empirical\", file = \"times.csv\"{keys} }}"));
    std::fs::write(folder.join("shop.toml"), text).expect("written");
    std::fs::write(folder.join("times.csv"), table).expect("written");
    let read = read(&folder.join("shop.toml"), &[]);
    std::fs::remove_dir_all(&folder).expect("removed");
    match read {
        Ok(file) => match &file.scenario.parts[1].operations[0].work {
            Work::Plain(time) => Ok(time.clone()),
            other => panic!("{other:?}"),
        },
        Err(ReadError::Faults(list)) => Err(list.problems.iter().map(|problem| problem.fault.to_string()).collect()),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn observed_times_are_those_of_a_column() {
    // Of 1, 2 and 4 minutes: a quarter lies below 1.5 min, half below 2, three quarters below 3.
    let quantiles = |time: Distribution| [0.0, 0.25, 0.5, 0.75].map(|u| time.quantile(u) / 60.0);
    for (table, keys) in [
        ("time [min]\n4\n1\n2\n", ""),
        ("4\n1\n2\n", ", unit = \"min\""),
        ("240 s\n1 min\n2 min\n", ""),
        ("order,time [s]\nA,240\nB,60\nC,120\nD,\n", ", column = \"time [s]\""),
        ("order;time\n# a remark\nA;240\nB;60\nC;120\n", ", column = \"time\", unit = \"s\""),
    ] {
        assert_eq!(quantiles(of_times(table, keys).expect("times")), [1.0, 1.5, 2.0, 3.0], "{table}");
    }
    for (table, keys, words) in [
        ("time [min]\n4\nlong\n", "", "times.csv, line 3"),
        ("time\n4\n", "", "times.csv, line 2"),
        ("time [min]\n-4\n", "", "is outside 0 to"),
        ("time [min]\n", "", "time"),
        ("time [min]\n4\n", ", column = \"tine\"", "no column \"tine\""),
        ("4\n", ", unit = \"kg\"", "\"kg\" is no unit of time"),
        ("4\n", ", unit = \"min\", values = [\"1 min\"]", "values"),
    ] {
        let told = of_times(table, keys).expect_err(words);
        assert!(told.iter().any(|text| text.contains(words)), "{table}: {told:#?}");
    }
}

#[test]
fn sources_that_bring_jobs_without_end_in_an_instant_are_refused() {
    let text = |work: &str, source: &str| {
        format!(
            "schema = 1\n[shop]\nname = \"x\"\nhorizon = \"1 day\"\n[[machine]]\nname = \"N\"\nprocess = \"plain\"\n\
             [[part]]\nname = \"z\"\noperation = [{{ name = \"z\", machines = \"N\", work = {work} }}]\n\
             [[arrivals]]\npart = \"z\"\n{source}"
        )
    };
    let kept = "pattern = \"constant_work\"\njobs = 1\n";
    let renewed = "pattern = \"renewal\"\ntime_between = \"0 min\"\n";
    for (work, source, wanted) in
        [("\"0 min\"", kept, "part \"z\" takes no time"), ("\"1 min\"", renewed, "the time between jobs is 0")]
    {
        let told = parse("f", &text(work, source), &[]).map(|_| ()).unwrap_err().to_string();
        assert!(told.contains(wanted), "{told}");
    }
    // Where time may pass nothing is refused.
    for change in ["machine.N.load_time=\"1 min\"", "machine.N.setup_time=\"1 min\""] {
        assert!(parse("f", &text("\"0 min\"", kept), &[change.to_owned()]).is_ok(), "{change}");
    }
    assert!(parse("f", &text("\"0 min\"", "pattern = \"poisson\"\nrate = \"1 1/h\"\n"), &[]).is_ok());
}
