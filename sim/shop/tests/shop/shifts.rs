//! Working time.

use crate::scenarios::{self, jobs_at, operation, run, time_in};
use toolroom_scenario::{Distribution, FailureClock, FailureMode, Interruption, Scenario, Shift, ShiftCalendar};
use toolroom_shop::runlog::{JobOutcome, MachineState, RunLog};

/// Work from 100 to 200 of every 1000 s; a job of 70 s arrives at 150.
fn shop(at_end: Interruption) -> Scenario {
    let mut shop = scenarios::scenario();
    shop.parts[0].operations = vec![operation(&[0], &[30.0, 40.0])];
    shop.arrivals[0] = jobs_at(&[(150.0, 1)]);
    shop.machines[0].calendar = Some(0);
    let shifts = vec![Shift { start: 100.0, end: 200.0 }];
    shop.calendars = vec![ShiftCalendar::periodic("short", 1000.0, shifts, at_end)];
    shop.horizon = 2000.0;
    shop
}

fn ends(log: &RunLog) -> (JobOutcome, f64) {
    (log.jobs[0].outcome, log.jobs[0].finish)
}

#[test]
fn what_would_cross_the_end_of_the_shift_is_not_begun() {
    // A shift from 6 to 14 o'clock, work of 3 h and of 45 min from 6 o'clock on: at 12 only 2 h are left. What is short goes
    // first by then, once at 12:00 and once at 12:45; 13:30 is too late for either. The long work begins on the next day.
    let text = "schema = 1\n[shop]\nname = \"fits\"\nhorizon = \"48 h\"\n\
        [[calendar]]\nname = \"day\"\nshift = [{ start = \"6 h\", end = \"14 h\" }]\nat_end = \"resume\"\nstart_only_if_fits = true\n\
        [[machine]]\nname = \"M\"\nprocess = \"plain\"\ncalendar = \"day\"\n\
        [[part]]\nname = \"long\"\noperation = [{ name = \"do\", machines = \"M\", work = \"3 h\" }]\n\
        [[part]]\nname = \"short\"\noperation = [{ name = \"do\", machines = \"M\", work = \"45 min\" }]\n\
        [[arrivals]]\npart = \"long\"\npattern = \"schedule\"\nlot = [{ time = \"0 h\", size = 3 }]\n\
        [[arrivals]]\npart = \"short\"\npattern = \"schedule\"\nlot = [{ time = \"6 h\", size = 3 }]\n";
    let hours = |text: &str| -> Vec<f64> {
        let scenario =
            toolroom_scenario_file::parse("fits.toml", text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
        let log = toolroom_shop::run(&scenario, 0, 0).unwrap();
        log.jobs.iter().map(|job| job.finish / 3600.0).collect()
    };
    assert_eq!(hours(text), [9.0, 12.0, 33.0, 12.75, 13.5, 33.75]);
    // Without it the third long one is begun at 12 and goes on in the next shift.
    assert_eq!(hours(&text.replace("start_only_if_fits = true\n", "")), [9.0, 12.0, 31.0, 31.75, 32.5, 33.25]);
    // What ends exactly with the shift is begun.
    let exact = text.replace("work = \"45 min\"", "work = \"1 h\"");
    assert_eq!(hours(&exact), [9.0, 12.0, 33.0, 13.0, 14.0, 34.0]);
    // What fits into no shift would never be begun.
    let never = text.replace("work = \"3 h\"", "work = \"9 h\"");
    let error = toolroom_scenario_file::parse("fits.toml", &never, &[]).expect_err("it never fits").to_string();
    assert!(error.contains("longer than any shift"), "{error}");
}

#[test]
fn a_shift_that_finishes_its_part_ends_late() {
    let log = run(&shop(Interruption::Finish));
    assert_eq!(ends(&log), (JobOutcome::Good, 220.0));
    assert_eq!(time_in(&log, 0, MachineState::OffShift), 2000.0 - 120.0 - 100.0);
}

#[test]
fn a_part_left_in_the_machine_is_resumed_next_shift() {
    let log = run(&shop(Interruption::Resume));
    assert_eq!(ends(&log), (JobOutcome::Good, 1120.0));
    assert_eq!(log.passes[1].cutting_time, 40.0);
    assert_eq!(time_in(&log, 0, MachineState::OffShift), 1800.0);
}

#[test]
fn a_part_may_have_to_be_begun_again() {
    let log = run(&shop(Interruption::Repeat));
    assert_eq!(ends(&log), (JobOutcome::Good, 1170.0));
    assert_eq!(time_in(&log, 0, MachineState::Cutting), 50.0 + 70.0);
}

#[test]
fn a_part_may_be_lost_at_the_end_of_a_shift() {
    assert_eq!(ends(&run(&shop(Interruption::Scrap))), (JobOutcome::ShiftEnd, 200.0));
}

/// The same shop, down from 180 on for `repair` seconds.
fn broken(at_end: Interruption, repair: f64) -> RunLog {
    let mut shop = shop(at_end);
    shop.failures = vec![FailureMode {
        name: None,
        machine: 0,
        time_between: Distribution::Constant(180.0),
        time_to_repair: Distribution::Constant(repair),
        clock: FailureClock::Calendar,
        crew: None,
        part: Interruption::Resume,
    }];
    shop.horizon = 1500.0;
    run(&shop)
}

#[test]
fn a_repair_that_goes_on_after_the_shift_is_out_of_shift() {
    for at_end in [Interruption::Finish, Interruption::Resume] {
        let log = broken(at_end, 1400.0);
        let down: Vec<(f64, f64, bool)> = log
            .states
            .iter()
            .filter(|row| row.state == MachineState::Down)
            .map(|row| (row.start, row.end, row.in_shift))
            .collect();
        assert_eq!(
            down,
            [(180.0, 200.0, true), (200.0, 1100.0, false), (1100.0, 1200.0, true), (1200.0, 1500.0, false)]
        );
    }
}

#[test]
fn a_part_in_a_machine_that_is_down_at_the_end_of_the_shift_waits_for_the_next() {
    for at_end in [Interruption::Finish, Interruption::Resume] {
        // Repaired at 330; 40 s of the part are left, and the next failure comes at 1170.
        let log = broken(at_end, 150.0);
        assert_eq!(ends(&log), (JobOutcome::Good, 1140.0));
    }
}

#[test]
fn a_machine_that_fails_in_overtime_takes_no_other_part() {
    let mut shop = shop(Interruption::Finish);
    shop.arrivals[0] = jobs_at(&[(150.0, 2)]);
    shop.failures = vec![FailureMode {
        name: None,
        machine: 0,
        time_between: Distribution::Constant(210.0),
        time_to_repair: Distribution::Constant(5.0),
        clock: FailureClock::Calendar,
        crew: None,
        part: Interruption::Scrap,
    }];
    shop.horizon = 1400.0;
    let log = run(&shop);
    assert_eq!(ends(&log), (JobOutcome::Breakdown, 210.0));
    assert_eq!(log.jobs[1].start, 1100.0);
}

#[test]
fn nothing_starts_outside_the_shift() {
    let mut shop = shop(Interruption::Resume);
    shop.arrivals[0] = jobs_at(&[(20.0, 1), (200.0, 1)]);
    let log = run(&shop);
    assert_eq!((log.jobs[0].start, log.jobs[1].start), (100.0, 1100.0));
}
