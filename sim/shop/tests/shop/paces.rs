//! Shifts in which work goes slower or faster, and weeks that alternate, by hand.

use toolroom_scenario::Scenario;
use toolroom_scenario_file::parse;
use toolroom_shop::run;

fn parsed(text: &str) -> Scenario {
    parse("paces.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).scenario
}

/// Hours from the start to the ends of orders of `job`, which come at given times, in a shop with one machine and its calendar.
fn ends(calendar: &str, operation: &str, releases: &[&str]) -> Vec<f64> {
    let mut text = format!(
        "schema = 1\n[shop]\nname = \"paces\"\nstart = \"2026-03-30 00:00\"\nhorizon = \"3 week\"\n[[calendar]]\nname = \"c\"\n{calendar}\n\
         [[machine]]\nname = \"M\"\nprocess = \"plain\"\ncalendar = \"c\"\nsetup_at_start = \"\"\n\
         [[part]]\nname = \"job\"\n[[part.operation]]\nname = \"do\"\nmachines = \"M\"\n{operation}\n"
    );
    for (number, release) in releases.iter().enumerate() {
        text.push_str(&format!("[[order]]\nid = \"{number}\"\npart = \"job\"\nrelease = \"{release}\"\n"));
    }
    let log = run(&parsed(&text), 0, 0).unwrap();
    log.jobs.iter().map(|job| job.finish / 3600.0).collect()
}

fn near(computed: &[f64], exact: &[f64]) {
    let close = computed.len() == exact.len() && computed.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(close, "{computed:?} instead of {exact:?}");
}

/// Eight hours as planned, then eight at half the speed, every day.
const HALF: &str = "shift = [{ start = \"0 h\", end = \"8 h\" }, { start = \"8 h\", end = \"16 h\", factor = 0.5 }]\nat_end = \"resume\"";

#[test]
fn work_goes_at_the_pace_of_its_shift() {
    // Eight of ten hours in the first shift, the other two take four.
    near(&ends(HALF, "work = \"10 h\"", &["0 h"]), &[12.0]);
    // Two of six hours from 12 to 16, and four from midnight on.
    near(&ends(HALF, "work = \"6 h\"", &["12 h"]), &[28.0]);
    // A setup of an hour from 8 to 10, work of an hour from 10 to 12.
    near(&ends(HALF, "work = \"1 h\"\nsetup_time = \"1 h\"", &["8 h"]), &[12.0]);
    // Faster than planned.
    near(&ends(&HALF.replace("0.5", "2.0"), "work = \"10 h\"", &["0 h"]), &[9.0]);
    // One after the other: 0 to 6, then two hours and four at half the speed, and 14 to 16 with five of six left.
    near(&ends(HALF, "work = \"6 h\"", &["0 h", "0 h", "0 h"]), &[6.0, 16.0, 30.0]);
}

#[test]
fn what_is_interrupted_begins_again_at_the_pace_of_then() {
    let repeat = HALF.replace("resume", "repeat");
    // Lost at 16, and again from midnight on.
    near(&ends(&repeat, "work = \"6 h\"", &["12 h"]), &[30.0]);
    // Left at 16: an hour, which takes two. That is just what may be finished first.
    let within = format!("{HALF}\nfinish_within = \"1 h\"");
    near(&ends(&within, "work = \"3 h\"", &["12 h"]), &[17.0]);
}

#[test]
fn an_operation_fits_by_the_work_that_is_done_until_the_end() {
    let fits = format!("{HALF}\nstart_only_if_fits = true");
    // From 8 o'clock on four hours of work are done until 16; from 6 o'clock on six.
    near(&ends(&fits, "work = \"4 h\"", &["8 h"]), &[16.0]);
    near(&ends(&fits, "work = \"5 h\"", &["8 h"]), &[29.0]);
    near(&ends(&fits, "work = \"6 h\"", &["6 h"]), &[16.0]);
}

#[test]
fn a_slow_night_shift_of_dates_goes_on_into_the_morning() {
    let calendar = "week = { mon-fri = [\"06:00-14:00\", { time = \"22:00-06:00\", factor = 0.8 }] }";
    // Ten hours from Monday 12:00: two until 14:00, 6.4 in the night, 1.6 from Tuesday 06:00 on.
    near(&ends(calendar, "work = \"10 h\"", &["2026-03-30 12:00"]), &[24.0 + 7.6]);
}

#[test]
fn early_and_late_weeks_take_turns() {
    let calendar = "week = [{ mon-fri = [\"06:00-14:00\"] }, { mon-fri = [\"14:00-22:00\"] }]\nweeks = 2";
    // Ten hours from Friday 12:00: two then, eight in the late shift of the next Monday.
    near(&ends(calendar, "work = \"10 h\"", &["2026-04-03 12:00"]), &[7.0 * 24.0 + 22.0]);
    let other = format!("{calendar}\nfirst_week = \"2026-04-08\"");
    // A late week first: eight hours on that Friday, two in the early shift of Monday.
    near(&ends(&other, "work = \"10 h\"", &["2026-04-03 12:00"]), &[7.0 * 24.0 + 8.0]);
}
