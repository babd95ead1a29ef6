//! Shifts of dates with breaks, and what the choice of machines knows of lots.

use crate::scenarios::run;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::parse;

/// One order of `pieces` pieces from Monday 2026-03-30 on, on machines by a calendar, `calendar` being its further keys.
fn shop(calendar: &str, week: &str, operation: &str, (release, pieces): (&str, u32)) -> Result<Scenario, String> {
    let machine = |name: &str| format!("[[machine]]\nname = \"{name}\"\nprocess = \"plain\"\ncalendar = \"day\"\n");
    let text = format!(
        "schema = 1\n[shop]\nname = \"dates\"\nstart = \"2026-03-30\"\nhorizon = \"2 week\"\n\
         [[calendar]]\nname = \"day\"\nweek = {week}\n{calendar}{}{}\
         [[part]]\nname = \"p\"\n[[part.operation]]\nname = \"o\"\n{operation}\
         [[order]]\nid = \"1\"\npart = \"p\"\nquantity = {pieces}\nrelease = \"{release}\"\ndue = \"2026-04-10\"\n",
        machine("A"),
        machine("B")
    );
    parse("dates.toml", &text, &[]).map(|file| file.scenario).map_err(|error| format!("{error}: {error:?}"))
}

/// Begin and end of the only operation, h since Monday midnight, and its machine.
fn times(scenario: Result<Scenario, String>) -> (f64, f64, u32) {
    let log = run(&scenario.unwrap_or_else(|error| panic!("{error}")));
    let row = log.operations.iter().find(|row| row.end.is_finite()).expect("it is done");
    (row.start / 3600.0, row.end / 3600.0, row.machine)
}

const EARLY: &str = "{ mon-fri = [\"06:00-14:00\"] }";
const BREAK: &str = "breaks = [\"10:00-10:15\"]\n";
const THREE_HOURS: &str = "machines = \"A\"\nwork = \"3 h\"\n";

#[test]
fn a_break_pauses_the_work_whatever_becomes_of_it_at_the_end_of_the_shift() {
    for at_end in ["resume", "repeat", "scrap", "finish"] {
        let calendar = format!("{BREAK}at_end = \"{at_end}\"\n");
        let found = times(shop(&calendar, EARLY, THREE_HOURS, ("2026-03-30 08:00", 1)));
        assert_eq!(found, (8.0, 11.25, 0), "{at_end}");
    }
}

#[test]
fn work_fits_into_a_shift_around_its_break() {
    let fits = format!("{BREAK}start_only_if_fits = true\n");
    let five = "machines = \"A\"\nwork = \"5 h\"\n";
    assert_eq!(times(shop(&fits, EARLY, five, ("2026-03-30 08:00", 1))), (8.0, 13.25, 0));
    // From 9 o'clock on 4 h 45 min are left.
    assert_eq!(times(shop(&fits, EARLY, five, ("2026-03-30 09:00", 1))), (30.0, 35.25, 0));
    let error = shop(&fits, EARLY, "machines = \"A\"\nwork = \"7.8 h\"\n", ("2026-03-30 08:00", 1)).expect_err("never");
    assert!(error.contains("longer than any shift"), "{error}");
}

#[test]
fn what_fits_is_judged_by_the_time_on_the_machine() {
    // Ten pieces of 10 min at three times that are 5 h; at half they are 50 min.
    let calendar = "start_only_if_fits = true\n";
    let on = |factor: &str| format!("machines = \"A\"\nwork = \"10 min\"\ntime_on = {{ A = {factor} }}\n");
    assert_eq!(times(shop(calendar, EARLY, &on("3.0"), ("2026-03-30 10:00", 10))), (30.0, 35.0, 0));
    assert_eq!(times(shop(calendar, EARLY, &on("\"30 min\""), ("2026-03-30 10:00", 10))), (30.0, 35.0, 0));
    let (begun, ended, _) = times(shop(calendar, EARLY, &on("0.5"), ("2026-03-30 13:00", 10)));
    assert!(begun == 13.0 && (ended - 13.0 - 50.0 / 60.0).abs() < 1e-9, "{begun} {ended}");
}

#[test]
fn the_machine_of_the_earliest_finish_is_that_of_the_whole_lot() {
    // A stands ready and takes 18 min a piece, B needs 30 min of setup and takes 6 min: of one piece A is done first, of ten B.
    let operation = "machines = [\"A\", \"B\"]\nwork = \"6 min\"\nsetup_time = \"30 min\"\nsetup_group = \"g\"\n\
                     machine_choice = \"earliest_finish\"\ntime_on = { A = 3.0 }\n";
    let machine = |pieces: u32| {
        let mut scenario = shop("", EARLY, operation, ("2026-03-30 06:00", pieces)).unwrap();
        scenario.machines[0].setup_at_start = Some("g".to_owned());
        scenario.machines[1].setup_at_start = Some(String::new());
        times(Ok(scenario))
    };
    assert_eq!(machine(1).2, 0);
    let (begun, ended, machine) = machine(10);
    assert!(machine == 1 && (ended - begun - 1.5).abs() < 1e-9, "{machine}, {begun} to {ended}");
}

#[test]
fn a_day_alone_goes_before_the_range_that_holds_it_and_two_ranges_contradict() {
    // Seven hours from Friday 6 o'clock: six on Friday, one on Monday.
    for day in ["mon-fri = [\"06:00-14:00\"], fri", "fri-sat = [], mon-thu = [\"06:00-14:00\"], fri"] {
        let week = format!("{{ {day} = [\"06:00-12:00\"] }}");
        let found = times(shop("", &week, "machines = \"A\"\nwork = \"7 h\"\n", ("2026-04-03 06:00", 1)));
        assert_eq!(found, (102.0, 175.0, 0), "{week}");
    }
    let error = shop("", "{ mon-thu = [\"06:00-14:00\"], thu-fri = [] }", THREE_HOURS, ("2026-03-30", 1));
    let error = error.expect_err("Thursday stands twice");
    assert!(error.contains("mon-thu") && error.contains("thu-fri"), "{error}");
}

#[test]
fn a_shop_of_orders_has_no_warm_up_and_a_horizon_that_is_none_brings_no_other_fault() {
    let told = |shop: &str, more: &str| {
        let text = format!(
            "schema = 1\n[shop]\nname = \"t\"\nstart = \"2026-03-30\"\n{shop}\n[[calendar]]\nname = \"day\"\nweek = {EARLY}\n\
             [[machine]]\nname = \"A\"\nprocess = \"plain\"\ncalendar = \"day\"\n[[part]]\nname = \"p\"\n\
             [[part.operation]]\nname = \"o\"\n{THREE_HOURS}{more}"
        );
        format!("{:?}", parse("t.toml", &text, &[]).expect_err("a fault"))
    };
    let order = "[[order]]\nid = \"1\"\npart = \"p\"\nquantity = 1\nrelease = \"2026-03-31\"\ndue = \"2026-04-10\"\n";
    let warm = told("horizon = \"2 week\"\nwarm_up = \"1 day\"", order);
    assert!(warm.contains("take out `warm_up`"), "{warm}");
    let horizon = told("horizon = \"2 weks\"", order);
    assert!(
        horizon.contains("weks") && !horizon.contains("released") && !horizon.contains("working time"),
        "{horizon}"
    );
}
