//! Repair crews and vehicles against exact values and by hand.

use toolroom_scenario::Scenario;
use toolroom_scenario_file::parse;
use toolroom_shop::run;
use toolroom_shop::runlog::{LogEvent, MachineState, RunLog};

fn parsed(text: &str) -> Scenario {
    parse("shop.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).scenario
}

fn near(computed: f64, exact: f64, relative: f64) {
    assert!((computed / exact - 1.0).abs() < relative, "{computed} instead of {exact}");
}

/// Mean time from each failure to the beginning of its repair, min.
fn wait_for_crew(log: &RunLog) -> f64 {
    let (mut failed, mut waits) = (vec![f64::NAN; 6], Vec::new());
    for row in &log.events {
        let Some(machine) = row.machine.map(|index| index as usize) else { continue };
        match row.event {
            LogEvent::Failure => failed[machine] = row.time,
            LogEvent::RepairStart => waits.push(row.time - failed[machine]),
            _ => {}
        }
    }
    waits.iter().sum::<f64>() / waits.len() as f64 / 60.0
}

#[test]
fn machines_wait_for_their_crew_as_in_the_repairman_model() {
    // Six machines, mean time to failure 480 min, to repair 60 min: birth and death of failures (Feller).
    let text = |count: u32| {
        format!(
            "schema = 1\n[shop]\nname = \"crew\"\nhorizon = \"60000 h\"\n\
             [[machine]]\nname = \"M\"\ncount = 6\nprocess = \"plain\"\n[[crew]]\nname = \"fitters\"\ncount = {count}\n\
             [[failure]]\nmachines = \"M\"\nclock = \"calendar\"\ncrew = \"fitters\"\n\
             time_between = {{ distribution = \"exponential\", mean = \"480 min\" }}\n\
             time_to_repair = {{ distribution = \"exponential\", mean = \"60 min\" }}\n\
             [[part]]\nname = \"job\"\noperation = [{{ name = \"do\", machines = \"M\", work = \"1 min\" }}]\n\
             [[arrivals]]\npart = \"job\"\npattern = \"schedule\"\nlot = [{{ time = \"0 min\" }}]\n"
        )
    };
    for (count, available, wait) in [(1, 0.813_664, 49.924_0), (2, 0.882_760, 3.749_022)] {
        let log = run(&parsed(&text(count)), 0, 0).unwrap();
        let down = log.states.iter().filter(|row| row.state == MachineState::Down).map(|row| row.end - row.start);
        near(1.0 - down.sum::<f64>() / (6.0 * log.horizon), available, 0.01);
        near(wait_for_crew(&log), wait, 0.05);
    }
}

/// Jobs that are done in no time at P and carried to Q, with the keys of the transport.
fn carried(transport: &str, arrivals: &str, horizon: &str) -> RunLog {
    let text = format!(
        "schema = 1\n[shop]\nname = \"agv\"\nhorizon = \"{horizon}\"\n\
         [[machine]]\nname = \"P\"\nprocess = \"plain\"\n[[machine]]\nname = \"Q\"\nprocess = \"plain\"\n\
         [[machine]]\nname = \"R\"\nprocess = \"plain\"\n[[transport]]\nname = \"AGV\"\n{transport}\n\
         [[part]]\nname = \"job\"\noperation = [{{ name = \"first\", machines = \"P\", work = \"0 min\" }}, \
         {{ name = \"second\", machines = \"Q\", work = \"0 min\" }}]\n\
         [[part]]\nname = \"back\"\noperation = [{{ name = \"first\", machines = \"R\", work = \"0 min\" }}, \
         {{ name = \"second\", machines = \"P\", work = \"0 min\" }}]\n{arrivals}"
    );
    run(&parsed(&text), 0, 0).unwrap()
}

#[test]
fn a_vehicle_is_a_server_with_an_empty_way() {
    // Moves one way, 8 min in each direction: M/D/1 with 16 min of service, but the job is there when it is unloaded.
    let log = carried(
        "locations = [\"P\", \"Q\"]\ntimes = [[\"0 min\", \"8 min\"], [\"8 min\", \"0 min\"]]",
        "[[arrivals]]\npart = \"job\"\npattern = \"poisson\"\nrate = \"2.4 1/h\"\n",
        "30000 h",
    );
    let stays: Vec<f64> =
        log.jobs.iter().filter(|job| job.finish.is_finite()).map(|job| job.finish - job.arrival).collect();
    near(stays.iter().sum::<f64>() / stays.len() as f64 / 60.0, 30.222_222, 0.02);
}

#[test]
fn vehicles_park_and_choose_as_they_are_told() {
    let places = "locations = [\"P\", \"Q\", \"R\"]\n\
        times = [[\"0 min\", \"4 min\", \"1 min\"], [\"4 min\", \"0 min\", \"9 min\"], [\"1 min\", \"9 min\", \"0 min\"]]";
    let two = "[[arrivals]]\npart = \"job\"\npattern = \"schedule\"\nlot = [{ time = \"0 min\", size = 2 }]\n\
        [[arrivals]]\npart = \"back\"\npattern = \"schedule\"\nlot = [{ time = \"1 min\" }]\n";
    let ends = |keys: &str| -> Vec<f64> {
        let log = carried(&format!("{places}\n{keys}"), two, "2 h");
        log.jobs.iter().map(|job| job.finish / 60.0).collect()
    };
    // First job: 4 min. Second: 4 back, 4 there. The one at R: 9 from Q, then 1.
    assert_eq!(ends(""), [4.0, 12.0, 22.0]);
    // Two vehicles take the first two at once, and the nearer by number the last.
    assert_eq!(ends("count = 2"), [4.0, 4.0, 14.0]);
    // At 4 the vehicle is at Q: P is nearer than R.
    assert_eq!(ends("rule = \"nearest\""), [4.0, 12.0, 22.0]);
    let late = two.replace("size = 2", "size = 1").replace("1 min\" }]", "10 min\" }]");
    let ends = |keys: &str| -> Vec<f64> {
        let log = carried(&format!("{places}\n{keys}"), &late, "2 h");
        log.jobs.iter().map(|job| job.finish / 60.0).collect()
    };
    // From Q at 10: 9 and 1. From home, where it has been since 8: 1 and 1.
    assert_eq!(ends(""), [4.0, 20.0]);
    assert_eq!(ends("park = \"home\""), [4.0, 12.0]);
}

#[test]
fn moves_without_a_vehicle_take_their_time() {
    let log = |move_time: &str, locations: [&str; 3]| {
        let machine = |(name, location): (&str, &str)| {
            format!("[[machine]]\nname = \"{name}\"\nprocess = \"plain\"\nlocation = \"{location}\"\n")
        };
        let machines: String = ["P", "Q", "R"].into_iter().zip(locations).map(machine).collect();
        let text = format!(
            "schema = 1\n[shop]\nname = \"moves\"\nhorizon = \"60 h\"\nmove_time = {move_time}\n{machines}\
             [[part]]\nname = \"job\"\noperation = [{{ name = \"first\", machines = \"P\", work = \"1 min\" }}, \
             {{ name = \"second\", machines = [\"Q\", \"R\"], work = \"5 min\" }}]\n\
             [[arrivals]]\npart = \"job\"\npattern = \"schedule\"\nlot = [{{ time = \"0 min\", size = 3 }}]\n"
        );
        run(&parsed(&text), 0, 0).unwrap()
    };
    let ends = |log: &RunLog| -> Vec<f64> { log.jobs.iter().map(|job| job.finish / 60.0).collect() };
    // Done at 1, 2 and 3, there at 5, 6 and 7; the third waits for Q.
    let moved = log("\"4 min\"", ["here", "there", "there"]);
    assert_eq!(ends(&moved), [10.0, 11.0, 15.0]);
    let at = |event| -> Vec<f64> {
        moved.events.iter().filter(|row| row.event == event).map(|row| row.time / 60.0).collect()
    };
    assert_eq!((at(LogEvent::Move), at(LogEvent::Delivery)), (vec![1.0, 2.0, 3.0], vec![5.0, 6.0, 7.0]));
    // Where one of its machines stands here, a job stays.
    assert_eq!(ends(&log("\"4 min\"", ["here", "there", "here"])), ends(&log("\"0 min\"", ["here", "there", "there"])));
    // A random move is that of the job, whatever else moves.
    let random = "{ distribution = \"exponential\", mean = \"4 min\" }";
    let [all, again] = [0, 1].map(|_| ends(&log(random, ["here", "there", "there"])));
    assert_eq!(all, again);
    assert!(all.iter().all(|end| end.fract() != 0.0), "{all:?}");
}

#[test]
fn what_vehicles_cannot_do_is_refused() {
    let text = "schema = 1\n[shop]\nname = \"agv\"\nhorizon = \"1 h\"\n\
         [[machine]]\nname = \"P\"\nprocess = \"plain\"\n[[machine]]\nname = \"Q\"\nprocess = \"plain\"\n\
         [[transport]]\nname = \"AGV\"\nlocations = [\"P\", \"Q\"]\ntimes = [[\"0 min\", \"8 min\"], [\"8 min\", \"0 min\"]]\n\
         [[part]]\nname = \"job\"\noperation = [{ name = \"first\", machines = \"P\", work = \"0 min\" }]\n\
         [[arrivals]]\npart = \"job\"\npattern = \"schedule\"\nlot = [{ time = \"0 min\" }]\n";
    assert!(parse("agv.toml", text, &[]).is_ok());
    for (from, to, word) in [
        ("\"P\", \"Q\"]", "\"P\", \"W\"]", "\"W\""),
        (", [\"8 min\", \"0 min\"]]", "]", "2 rows and 2 columns"),
        ("machines = \"P\"", "machines = [\"P\", \"Q\"]", "several places"),
    ] {
        let error = parse("agv.toml", &text.replacen(from, to, 1), &[]).expect_err(word).to_string();
        assert!(error.contains(word), "{error}");
    }
}

#[test]
fn a_crew_begins_repairs_in_its_shift_and_finishes_them() {
    // It breaks down every 5 hours of the clock for an hour; the crew works from 6 to 11 o'clock.
    let text = "schema = 1\n[shop]\nname = \"crew\"\nhorizon = \"40 h\"\n\
        [[calendar]]\nname = \"day\"\nperiod = \"24 h\"\nshift = [{ start = \"6 h\", end = \"11 h\" }]\n\
        [[machine]]\nname = \"M\"\nprocess = \"plain\"\n[[crew]]\nname = \"fitters\"\ncalendar = \"day\"\n\
        [[failure]]\nmachines = \"M\"\nclock = \"calendar\"\ncrew = \"fitters\"\ntime_between = \"210 min\"\ntime_to_repair = \"3 h\"\n\
        [[part]]\nname = \"job\"\noperation = [{ name = \"do\", machines = \"M\", work = \"1 min\" }]\n\
        [[arrivals]]\npart = \"job\"\npattern = \"schedule\"\nlot = [{ time = \"0 min\" }]\n";
    let log = run(&parsed(text), 0, 0).unwrap();
    let down = log.states.iter().filter(|row| row.state == MachineState::Down);
    let hours: Vec<(f64, f64)> = down.map(|row| (row.start / 3600.0, row.end / 3600.0)).collect();
    // Down at 3.5, repaired from 6 to 9; down at 12.5, repaired from 30 on; down again at 36.5.
    assert_eq!(hours, [(3.5, 9.0), (12.5, 33.0), (36.5, 40.0)]);
}
