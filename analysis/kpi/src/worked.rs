//! Worked examples of the key figures, read as scenario files: a grinder whose parts take a known
//! time (revolutions over speed, a wheel that does not wear), a mill at a known spindle speed.

use super::*;
use toolroom_scenario_file as file;
use toolroom_shop::runlog::JobOutcome;

/// One grinder of 60 EUR/h with parts of whole minutes back to back; `more` are further keys of
/// the machine.
fn grinder(horizon: &str, warm_up: &str, minutes: u32, more: &str, tables: &str) -> String {
    let rest = 60 * minutes - 1;
    format!(
        r#"schema = 1
[shop]
name = "worked"
title = "Worked example"
horizon = "{horizon}"
warm_up = "{warm_up}"
shift_length = "8 h"
[[machine]]
name = "G"
process = "infeed"
rate = "60 EUR/h"
load_time = "0 s"
unload_time = "0 s"
{more}
[[tool]]
name = "wheel"
process = "infeed"
parameter_set = "zb153u_40kh"
edge_cost = "0 EUR"
scatter = "none"
[[part]]
name = "ring"
[[part.operation]]
name = "grind"
machines = "G"
tool = "wheel"
work_rotation_speed = "60 rpm"
phase = [{{ infeed_per_rev = "0.1 um/rev", revolutions = 1 }}, {{ infeed_per_rev = "0 um/rev", revolutions = {rest} }}]
size_tolerance = "1 mm"
[[arrivals]]
part = "ring"
pattern = "constant_work"
jobs = 2
[[policy]]
name = "programmed"
speed = "programmed"
{tables}"#
    )
}

fn calendar(start: &str, end: &str, at_end: &str) -> String {
    format!(
        "[[calendar]]\nname = \"early\"\nperiod = \"24 h\"\nshift = [{{ start = \"{start}\", end = \"{end}\" }}]\n\
         at_end = \"{at_end}\"\n"
    )
}

/// A failure at a time of day; it comes again as long after its repair.
fn failure(at: &str, repair: &str, part: &str) -> String {
    format!(
        "[[failure]]\nmachines = [\"G\"]\ntime_between = \"{at}\"\ntime_to_repair = \"{repair}\"\nclock = \"calendar\"\n\
         part = \"{part}\"\n"
    )
}

struct Run {
    scenario: Scenario,
    log: RunLog,
    values: Vec<f64>,
}

impl Run {
    fn of(text: &str) -> Self {
        let scenario = file::parse("worked.toml", text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
        let log = toolroom_shop::run(&scenario, 0, 0).expect("a run");
        identity(&scenario, &log);
        let values = evaluate(&scenario, &log);
        let policy = std::sync::Arc::new(
            toolroom_scenario::policies::ResolvedPolicy::from_scenario(&scenario, 0).expect("a policy"),
        );
        let shop = toolroom_shop::Shop::with_recorder(&scenario, policy, 0, Counting::new(&scenario)).expect("a shop");
        let counted = shop.run().expect("a run").values();
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&counted), bits(&values), "counted on the way and from the log");
        Self { scenario, log, values }
    }

    /// Figure of the shop, or of the grinder with `G/` before it.
    fn figure(&self, id: &str) -> f64 {
        let (machine, id) = id.strip_prefix("G/").map_or((None, id), |id| (Some(0), id));
        let list = kpis(&self.scenario);
        let index = list.iter().position(|kpi| kpi.machine == machine && kpi.definition.id == id);
        self.values[index.unwrap_or_else(|| panic!("no figure {id}"))]
    }

    fn holds(&self, expected: &[(&str, f64)]) {
        for &(id, expected) in expected {
            let found = self.figure(id);
            assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{id} = {found}, not {expected}");
        }
    }

    /// Good parts and paid machine time.
    fn parts_and_cost(&self) -> (u32, f64) {
        let counting = Counting::from_scenario(&self.scenario, &self.log);
        let tally = counting.tally();
        (tally.good, tally.machine_cost)
    }
}

/// PBT = AUBT + ADOT: the time that the calendar plans (and overtime) is that of the states in shift.
fn identity(scenario: &Scenario, log: &RunLog) {
    for (machine, tally) in Counting::from_scenario(scenario, log).tally().machines.iter().enumerate() {
        let planned = tally.planned_busy_time();
        let spent = tally.busy_time() + tally.state(toolroom_shop::runlog::MachineState::Idle);
        let name = &scenario.machines[machine].name;
        assert!((planned - spent).abs() <= 1e-9 * planned, "{}, {name}: {planned} s, not {spent} s", scenario.name);
    }
}

/// Two days that count, shift from 6 to 14 o'clock, parts of half an hour. Hour 37 is the first of
/// these days at 13 o'clock.
fn two_days(at_end: &str, failure: &str) -> Run {
    Run::of(&grinder("72 h", "24 h", 30, "calendar = \"early\"", &(calendar("6 h", "14 h", at_end) + failure)))
}

const HOUR: f64 = 3600.0;

#[test]
fn a_repair_at_night_is_no_planned_time_and_costs_nothing() {
    for at_end in ["resume", "finish", "repeat", "scrap"] {
        let run = two_days(at_end, &failure("37 h", "8 h", "resume"));
        assert_eq!(run.parts_and_cost(), (30, 960.0), "{at_end}");
        run.holds(&[
            ("availability", 0.9375),
            ("effectiveness", 1.0),
            ("quality_ratio", 1.0),
            ("oee", 0.9375),
            ("G/oee", 0.9375),
            ("parts_per_shift", 15.0),
            ("G/down_time_share", 1.0 / 48.0),
            ("G/off_shift_time_share", 32.0 / 48.0),
            ("G/mttr", 8.0 * HOUR),
            ("G/mtbf", 15.0 * HOUR),
        ]);
        // The same with the repair inside the shift.
        let day = two_days(at_end, &failure("37 h", "1 h", "resume"));
        assert_eq!(day.parts_and_cost(), (30, 960.0), "{at_end}");
        day.holds(&[("oee", 0.9375), ("G/mttr", HOUR)]);
    }
}

#[test]
fn a_repair_in_the_shift_takes_planned_time() {
    let run = two_days("resume", &failure("34 h", "2 h", "resume"));
    assert_eq!(run.parts_and_cost(), (28, 960.0));
    run.holds(&[("availability", 0.875), ("effectiveness", 1.0), ("oee", 0.875)]);
}

#[test]
fn overtime_to_finish_a_part_is_planned_and_paid() {
    // Begun at 13:00, down from 13:10 until 21:10, gone on with next day; the last part is begun at
    // 13:50 and finished at 14:20.
    let run = two_days("finish", &failure("37.166666666666666667 h", "8 h", "resume"));
    let (parts, cost) = run.parts_and_cost();
    assert_eq!(parts, 31);
    assert!((cost - 980.0).abs() < 1e-9, "{cost}");
    run.holds(&[("availability", 15.5 / (16.0 + 1.0 / 3.0)), ("effectiveness", 1.0)]);
}

#[test]
fn a_failure_in_overtime_leaves_the_part_for_the_next_shift() {
    // Parts of 35 minutes: the fourteenth is begun at 13:35 and would be finished at 14:10.
    let tables = calendar("6 h", "14 h", "finish") + &failure("38.1 h", "1 h", "resume");
    let run = Run::of(&grinder("72 h", "24 h", 35, "calendar = \"early\"", &tables));
    let second_day = |time: f64| (time - 54.0 * HOUR) / 60.0;
    let stopped = run.log.operations.iter().find(|row| row.end > 54.0 * HOUR).expect("a part");
    assert!((second_day(stopped.end) - 4.0).abs() < 1e-9, "{}", second_day(stopped.end));
    run.holds(&[("effectiveness", 1.0)]);
}

#[test]
fn an_operation_over_the_horizon_counts_by_its_part() {
    let expected = [("effectiveness", 1.0), ("quality_ratio", 1.0), ("G/throughput", 1.0 / HOUR)];
    // 40 minutes each from 0: one is completed, the second half done.
    let run = Run::of(&grinder("60 min", "0 h", 40, "", ""));
    run.holds(&expected);
    run.holds(&[("oee", 1.0), ("grinding_time", 2400.0), ("cell_time_ratio", 1.0)]);
    // The horizon is the end of the shift.
    let run = Run::of(&grinder("60 min", "0 h", 40, "calendar = \"early\"", &calendar("0 h", "1 h", "resume")));
    run.holds(&expected);
    run.holds(&[("oee", 1.0)]);
    // The machine is down at the horizon.
    let run = Run::of(&grinder("60 min", "0 h", 40, "", &failure("57 min", "1 h", "resume")));
    run.holds(&expected);
    run.holds(&[("oee", 0.95), ("availability", 0.95), ("grinding_time", 2400.0)]);
    // The window begins in the middle of an operation.
    let run = Run::of(&grinder("80 min", "20 min", 40, "", ""));
    run.holds(&[("oee", 1.0), ("effectiveness", 1.0), ("G/throughput", 2.0 / HOUR)]);
}

#[test]
fn half_a_day_of_one_cut_is_no_finished_part() {
    // 8 of 12 hours are cut when the shift ends; the horizon is midnight.
    let run = Run::of(&grinder("24 h", "0 h", 720, "calendar = \"early\"", &calendar("8 h", "16 h", "resume")));
    run.holds(&[("effectiveness", 1.0), ("availability", 1.0), ("G/throughput", 0.0), ("parts_per_shift", 0.0)]);
    assert!(run.figure("oee").is_nan() && run.figure("quality_ratio").is_nan(), "nothing was completed");
}

#[test]
fn work_that_an_interruption_undoes_takes_time_and_earns_nothing() {
    // Down after 40 + 20 minutes; the second part is cut again from 61 minutes on, or lost.
    for part in ["repeat", "scrap"] {
        let run = Run::of(&grinder("101 min", "0 h", 40, "", &failure("60 min", "1 min", part)));
        run.holds(&[("availability", 100.0 / 101.0), ("effectiveness", 0.8), ("quality_ratio", 1.0)]);
        assert_eq!(run.parts_and_cost().0, 2, "{part}");
        assert_eq!(run.figure("scrap_rate"), if part == "scrap" { 1.0 / 3.0 } else { 0.0 });
    }
}

#[test]
fn a_part_lost_at_the_end_of_a_shift_is_no_breakdown() {
    let run = Run::of(&grinder("4 h", "0 h", 40, "calendar = \"early\"", &calendar("0 h", "1 h", "scrap")));
    assert_eq!(run.log.jobs[1].outcome, JobOutcome::ShiftEnd);
    assert_eq!(run.log.jobs[1].outcome.name(), "shift_end");
}

#[test]
fn milling_has_the_cutting_speed_of_its_circumference() {
    // 795.775 rpm of a cutter of 12 mm, 0.05 mm at two teeth.
    let text = grinder("2 h", "0 h", 40, "", "")
        .replace("process = \"infeed\"", "process = \"milling\"\nspeed_range = [\"10 m/min\", \"300 m/min\"]");
    let (before, after) = text.split_once("[[tool]]").expect("a tool");
    let after = after
        .replace("\nspeed_range = [\"10 m/min\", \"300 m/min\"]", "")
        .replace("zb153u_40kh\"", "c45_endmill_d12\"\nparameters = { cutter = { teeth = 2 } }");
    let start = after.find("work_rotation_speed").expect("work");
    let end = after.find("size_tolerance").expect("a tolerance");
    let cut = "cutting_speed = \"30 m/min\"\nfeed_per_tooth = \"0.05 mm/tooth\"\ndepth_of_cut = \"6 mm\"\n\
               width_of_cut = \"3 mm\"\npath_length = \"100 mm\"\npasses = 2\n";
    let run = Run::of(&format!("{before}[[tool]]{}{cut}{}", &after[..start], &after[end..]));
    let feed_speed = 795.774_715_459_476_7 / 60.0 * 2.0 * 0.05e-3;
    run.holds(&[("mean_cutting_speed", 0.5), ("mean_cutting_speed_milling", 0.5), ("mean_feed_speed", feed_speed)]);
    assert!(run.figure("mean_cutting_speed_turning").is_nan());
    let list = kpis(&run.scenario);
    let feed = list.iter().find(|kpi| kpi.definition.id == "mean_feed_speed").expect("a figure");
    assert_eq!(feed.key(), "mean_feed_speed [mm/min]");
    assert!((feed_speed * feed.definition.file_scale() - 79.577).abs() < 5e-4);
}

#[test]
fn planned_busy_time_is_busy_and_idle_time_in_every_shipped_scenario() {
    let folder = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios"));
    let mut files: Vec<_> =
        std::fs::read_dir(folder).expect("scenarios").map(|entry| entry.expect("a file").path()).collect();
    files.push(folder.join("gap/shop.toml"));
    files.push(folder.join("shop/flexible-cell.toml")); // with delays for want of fixtures
    files.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    files.sort();
    let mut seen = Vec::new();
    for path in files {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        // A chart of stability, and a shop with a unit that is made first.
        if ["chuck-fig3", "fmu-lathe"].contains(&name.as_str()) {
            continue;
        }
        let scenario = file::read(&path, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
        let log = toolroom_shop::run(&scenario, 0, 0).expect("a run");
        identity(&scenario, &log);
        seen.push(name);
    }
    assert!(seen.len() >= 10, "{seen:?}");
}

/// Values of the figures of a plain scenario by their ids, those of its first machine behind those of the shop.
fn plain(text: &str) -> impl Fn(&str) -> f64 {
    let scenario = file::parse("plain.toml", text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
    let log = toolroom_shop::run(&scenario, 0, 0).unwrap();
    let (values, kpis) = (evaluate(&scenario, &log), kpis(&scenario));
    move |id| {
        let position =
            kpis.iter().position(|kpi| kpi.definition.id == id && kpi.machine.is_none_or(|machine| machine == 0));
        values[position.unwrap_or_else(|| panic!("no figure {id}"))]
    }
}

#[test]
fn planned_maintenance_is_no_planned_busy_time() {
    // Shift from 6 to 14, half an hour of work without end; from 8 to 9 it is maintained: seven hours are planned, all worked.
    let figure = plain(
        r#"
schema = 1
[shop]
name = "maintained"
horizon = "24 h"
[[calendar]]
name = "day"
period = "24 h"
at_end = "resume"
shift = [{ start = "6 h", end = "14 h" }]
[[machine]]
name = "M"
process = "plain"
calendar = "day"
rate = "60 EUR/h"
[[operator]]
name = "setter"
skills = "setup"
calendar = "day"
rate = "30 EUR/h"
[[maintenance]]
machines = "M"
every = "8 h"
clock = "calendar"
duration = "1 h"
[[part]]
name = "part"
operation = [{ name = "work", machines = "M", work = "30 min" }]
[[arrivals]]
part = "part"
pattern = "constant_work"
jobs = 2
"#,
    );
    assert!((figure("availability") - 1.0).abs() < 1e-9);
    assert!((figure("maintenance_time_share") - 1.0 / 24.0).abs() < 1e-12);
    // 14 parts; seven paid hours of the machine, and eight of the setter.
    assert!((figure("machine_cost_per_part") - 7.0 * 60.0 / 14.0).abs() < 1e-9);
    assert!((figure("cost_per_part") - (7.0 * 60.0 + 8.0 * 30.0) / 14.0).abs() < 1e-9);
}

#[test]
fn a_ground_edge_costs_its_regrinding() {
    // Edges of 20 minutes: one new, then the same ground three times, in 80 minutes of work and two parts.
    let figure = plain(
        r#"
schema = 1
[shop]
name = "ground"
horizon = "4 h"
[[machine]]
name = "M"
process = "plain"
[[tool]]
name = "drill"
process = "life_only"
life = "20 min"
edge_cost = "10 EUR"
[[crib]]
tool = "drill"
edges = 1
regrind = { time = "10 min", cost = "2 EUR" }
[[part]]
name = "part"
operation = [{ name = "bore", machines = "M", work = "40 min", tool = "drill" }]
[[arrivals]]
part = "part"
pattern = "schedule"
lot = [{ time = "0 min", size = 2 }]
"#,
    );
    assert!((figure("edge_cost_per_part") - (10.0 + 3.0 * 2.0) / 2.0).abs() < 1e-9, "{}", figure("edge_cost_per_part"));
    assert!((figure("waiting_tool_time_share") - 30.0 / 240.0).abs() < 1e-12);
    assert!((figure("tool_life") - 1200.0).abs() < 1e-9, "{} s", figure("tool_life"));
    assert!(figure("path_per_edge").is_nan());
}

/// Four orders of 60 min at once on one machine; two are done when the run ends after 150 min, and had waited for 0 and 60 min.
#[test]
fn what_is_unfinished_at_the_horizon_has_no_part_in_the_queue_time() {
    let order = |id: u32| format!("[[order]]\nid = \"{id}\"\npart = \"A\"\ndue = \"10 h\"\n");
    let shop = "schema = 1\n[shop]\nname = \"q\"\nhorizon = \"150 min\"\n[[machine]]\nname = \"M\"\nprocess = \"plain\"\n\
                [[part]]\nname = \"A\"\noperation = [{ name = \"a\", machines = \"M\", work = \"60 min\" }]\n";
    let run = Run::of(&format!("{shop}{}", (1..=4).map(order).collect::<String>()));
    run.holds(&[("lead_time", 90.0 * 60.0), ("queue_time", 30.0 * 60.0), ("flow_factor", 1.5)]);
}

/// Two orders of two pieces each on one machine, 10 min a piece, setup of 5 min before each (other groups); the second order waits
/// for 25 min and is 10 min late, with a weight of 3.
#[test]
fn waiting_tardiness_and_the_ratios_of_setup_are_those_of_the_envelope() {
    let operation = |group: &str| {
        format!(
            "[[part.operation]]\nname = \"work\"\nmachines = \"M\"\nwork = \"10 min\"\nsetup_time = \"5 min\"\nsetup_group = \"{group}\"\n"
        )
    };
    let run = Run::of(&format!(
        "schema = 1\n[shop]\nname = \"two\"\nhorizon = \"60 min\"\n[[machine]]\nname = \"M\"\nprocess = \"plain\"\nsetup_at_start = \"\"\n\
         [[part]]\nname = \"A\"\n{}[[part]]\nname = \"B\"\n{}\
         [[order]]\nid = \"1\"\npart = \"A\"\nquantity = 2\nrelease = \"0 min\"\ndue = \"30 min\"\n\
         [[order]]\nid = \"2\"\npart = \"B\"\nquantity = 2\nrelease = \"0 min\"\ndue = \"40 min\"\nweight = 3\n",
        operation("a"),
        operation("b")
    ));
    // A from 0 to 25 min, B from 25 to 50 min, and 10 min without work.
    run.holds(&[
        ("lead_time", 37.5 * 60.0),
        ("queue_time", 12.5 * 60.0),
        ("flow_factor", 75.0 / 40.0),
        ("tardiness", 5.0 * 60.0),
        ("weighted_tardiness", 15.0 * 60.0),
        ("greatest_tardiness", 10.0 * 60.0),
        ("on_time", 0.5),
        ("allocation_ratio", 50.0 / 60.0),
        ("utilisation_efficiency", 40.0 / 50.0),
        ("technical_efficiency", 1.0),
        ("setup_ratio", 10.0 / 50.0),
        ("oee", 40.0 / 60.0),
        ("nee", 50.0 / 60.0),
    ]);
    assert!((run.figure("lead_time_p50") / (25.0 * 60.0) - 1.0).abs() < 0.004);
    assert!((run.figure("lead_time_p95") / (50.0 * 60.0) - 1.0).abs() < 0.004);
}

#[test]
fn figures_by_part_customer_and_station_are_those_of_their_jobs() {
    let part = |name: &str, minutes: u32| {
        format!(
            "[[part]]\nname = \"{name}\"\n[[part.operation]]\nname = \"work\"\nmachines = \"M\"\nwork = \"{minutes} min\"\n\
             [[part.operation]]\nname = \"wash\"\nmachines = \"W\"\nwork = \"1 min\"\n"
        )
    };
    let order = |id: u32, part: &str, due: u32, customer: &str| {
        format!(
            "[[order]]\nid = \"{id}\"\npart = \"{part}\"\nrelease = \"0 min\"\ndue = \"{due} min\"\ncustomer = \"{customer}\"\n"
        )
    };
    let run = Run::of(&format!(
        "schema = 1\n[shop]\nname = \"groups\"\nhorizon = \"100 min\"\n[[machine]]\nname = \"M\"\nprocess = \"plain\"\n\
         [[machine]]\nname = \"W\"\nprocess = \"plain\"\n{}{}{}{}{}",
        part("A", 10),
        part("B", 20),
        order(1, "A", 60, "Miller"),
        order(2, "A", 60, "Baker"),
        order(3, "B", 30, "Miller")
    ));
    // M: 0 to 10, 10 to 20, 20 to 40 min; W: 10 to 11, 20 to 21, 40 to 41 min.
    let counting = Counting::from_scenario(&run.scenario, &run.log);
    let values = counting.group_values();
    assert_eq!(values.len(), group_values_len(&run.scenario));
    let mut values = values.into_iter();
    let mut found = std::collections::BTreeMap::new();
    for kind in GroupKind::ALL {
        for group in kind.groups(&run.scenario) {
            for definition in kind.definitions() {
                found.insert((kind.name(), group.clone(), definition.id), values.next().expect("a value"));
            }
        }
    }
    let holds = |kind: &'static str, group: &str, expected: &[(&'static str, f64)]| {
        for &(id, expected) in expected {
            let value = found[&(kind, group.to_owned(), id)];
            assert!((value - expected).abs() <= 0.004 * expected.abs(), "{kind} {group} {id}: {value}, not {expected}");
        }
    };
    holds("part", "A", &[("good", 2.0), ("lead_time", 16.0 * 60.0), ("tardy_share", 0.0), ("queue_time", 5.0 * 60.0)]);
    holds("part", "B", &[("good", 1.0), ("lead_time", 41.0 * 60.0), ("tardiness", 11.0 * 60.0), ("wip", 0.41)]);
    holds("customer", "Miller", &[("good", 2.0), ("lead_time", 26.0 * 60.0), ("greatest_tardiness", 11.0 * 60.0)]);
    holds("customer", "Baker", &[("good", 1.0), ("lead_time_p95", 21.0 * 60.0), ("flow_factor", 21.0 / 11.0)]);
    holds("station", "M", &[("begun", 3.0), ("queue_wait", 10.0 * 60.0), ("availability", 0.4)]);
    holds("station", "W", &[("begun", 3.0), ("queue_wait", 0.0), ("good_operations", 3.0)]);
    assert_eq!(found.keys().filter(|(kind, ..)| *kind == "customer").count(), 20);
}

#[test]
fn the_wait_for_a_crew_begins_with_the_breakdown_and_ends_with_the_repair_begun() {
    // Both machines break down after 60 min; one fitter repairs the first in 30 min and then the other.
    let machine = |name: &str| {
        format!(
            "[[machine]]\nname = \"{name}\"\nprocess = \"plain\"\n[[failure]]\nmachines = [\"{name}\"]\ntime_between = \"60 min\"\n\
                 time_to_repair = \"30 min\"\nclock = \"calendar\"\ncrew = \"fitters\"\n"
        )
    };
    let run = Run::of(&format!(
        "schema = 1\n[shop]\nname = \"crew\"\nhorizon = \"110 min\"\n{}{}[[crew]]\nname = \"fitters\"\n\
         [[part]]\nname = \"A\"\n[[part.operation]]\nname = \"work\"\nmachines = [\"M\", \"N\"]\nwork = \"1 h\"\n\
         [[arrivals]]\npart = \"A\"\npattern = \"constant_work\"\njobs = 2\n",
        machine("M"),
        machine("N")
    ));
    run.holds(&[("crew_wait", 15.0 * 60.0)]);
}
