//! Components that are reordered or made for an order, vehicles that carry several jobs, buffers that count pieces, by hand.

use crate::scenarios;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::parse;
use toolroom_shop::run;
use toolroom_shop::runlog::{MachineState, RunLog};

fn parsed(text: &str) -> Scenario {
    parse("stocks.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).scenario
}

/// Gears are made on `G`, one a minute, and two of them go into a box on `bench`, five minutes each.
fn boxes(stock: &str, boxes: &str) -> Scenario {
    parsed(&format!(
        "schema = 1\n[shop]\nname = \"boxes\"\nhorizon = \"10 h\"\n[[machine]]\nname = \"G\"\nprocess = \"plain\"\n\
         [[machine]]\nname = \"bench\"\nprocess = \"plain\"\n\
         [[part]]\nname = \"gear\"\noperation = [{{ name = \"hob\", machines = \"G\", work = \"1 min\" }}]\n\
         [[part]]\nname = \"box\"\ncomponents = [{{ part = \"gear\", quantity = 2 }}]\n\
         operation = [{{ name = \"join\", machines = \"bench\", work = \"5 min\", assemble = true }}]\n{stock}\n{boxes}"
    ))
}

/// Minutes at which an event happened.
fn times(log: &RunLog, event: &str) -> Vec<f64> {
    log.events.iter().filter(|row| row.event.name() == event).map(|row| row.time / 60.0).collect()
}

/// Minutes at which the operations of a machine began.
fn starts(log: &RunLog, machine: u32) -> Vec<f64> {
    log.operations.iter().filter(|row| row.machine == machine).map(|row| row.start / 60.0).collect()
}

const FOUR: &str = "[[arrivals]]\npart = \"box\"\npattern = \"schedule\"\nlot = [{ time = \"0 min\", size = 4 }]\n";

#[test]
fn a_stock_is_filled_when_few_are_left() {
    // The first box takes two of four gears: two are left, fewer than four, so that six are ordered and made until 6. The
    // boxes begin at 0, 5, 10 and 15; the last takes two of four, and six more are ordered.
    let made = boxes("[[stock]]\npart = \"gear\"\nquantity = 4\nreorder = { below = 4, lot = 6 }", FOUR);
    let log = run(&made, 0, 0).unwrap();
    assert_eq!((starts(&log, 1), times(&log, "reorder")), (vec![0.0, 5.0, 10.0, 15.0], vec![0.0, 15.0]));
    let gears: Vec<(f64, f64, u32)> = log
        .jobs
        .iter()
        .filter(|job| job.part == 0)
        .map(|job| (job.arrival / 60.0, job.finish / 60.0, job.quantity))
        .collect();
    assert_eq!(gears, [(0.0, 6.0, 6), (15.0, 21.0, 6)]);
    // Bought, they come after 20 minutes, and the third box waits for them.
    let bought =
        boxes("[[stock]]\npart = \"gear\"\nquantity = 4\nreorder = { below = 4, lot = 6, lead = \"20 min\" }", FOUR);
    let log = run(&bought, 0, 0).unwrap();
    assert_eq!((starts(&log, 1), times(&log, "restock")), (vec![0.0, 5.0, 20.0, 25.0], vec![20.0, 45.0]));
    // Nobody orders any: two boxes are made.
    let log = run(&boxes("[[stock]]\npart = \"gear\"\nquantity = 5", FOUR), 0, 0).unwrap();
    assert_eq!(starts(&log, 1), [0.0, 5.0]);
    // Nothing in stock at the start is filled up at once: lots until the position is at least that.
    let log = run(&boxes("[[stock]]\npart = \"gear\"\nreorder = { below = 5, lot = 2 }", FOUR), 0, 0).unwrap();
    assert_eq!(times(&log, "reorder")[..3], [0.0, 0.0, 0.0]);
    assert_eq!(starts(&log, 1), [2.0, 7.0, 12.0, 17.0]);
}

#[test]
fn what_is_made_for_an_order_goes_into_no_other() {
    let text = "[[order]]\nid = \"P1\"\npart = \"box\"\n[[order]]\nid = \"P2\"\npart = \"box\"\n\
        [[order]]\nid = \"c1\"\npart = \"gear\"\nquantity = 2\nparent = \"P2\"\n\
        [[order]]\nid = \"c2\"\npart = \"gear\"\nquantity = 2\nparent = \"P1\"\n";
    let shop = |pegged: bool| {
        let mut shop = boxes("", "[[order]]\nid = \"x\"\npart = \"box\"\n[[order]]\nid = \"y\"\npart = \"gear\"\n");
        let file = format!(
            "schema = 1\n[shop]\nname = \"pegged\"\nhorizon = \"10 h\"\n[[machine]]\nname = \"G\"\nprocess = \"plain\"\n\
             [[machine]]\nname = \"bench\"\nprocess = \"plain\"\n\
             [[part]]\nname = \"gear\"\noperation = [{{ name = \"hob\", machines = \"G\", work = \"5 min\" }}]\n\
             [[part]]\nname = \"box\"\ncomponents = [{{ part = \"gear\", quantity = 2 }}]\n{}\
             operation = [{{ name = \"join\", machines = \"bench\", work = \"5 min\", assemble = true }}]\n{}",
            if pegged { "pegging = \"order\"\n" } else { "" },
            if pegged {
                text.to_owned()
            } else {
                text.replace("parent = \"P2\"\n", "").replace("parent = \"P1\"\n", "")
            },
        );
        shop.clone_from(&parsed(&file));
        run(&shop, 0, 0).unwrap()
    };
    let begun = |log: &RunLog| {
        let at = |order: u32| log.jobs.iter().find(|job| job.order == Some(order)).map(|job| job.start / 60.0);
        (at(0), at(1))
    };
    // The gears of c1 are done at 10, those of c2 at 20.
    assert_eq!(begun(&shop(true)), (Some(20.0), Some(10.0)));
    assert_eq!(begun(&shop(false)), (Some(10.0), Some(20.0)));
}

#[test]
fn a_vehicle_takes_what_waits_for_its_way() {
    let delivered = |capacity: u32| {
        let text = format!(
            "schema = 1\n[shop]\nname = \"agv\"\nhorizon = \"10 h\"\n[[machine]]\nname = \"P\"\nprocess = \"plain\"\n\
             [[machine]]\nname = \"Q\"\nprocess = \"plain\"\n[[transport]]\nname = \"AGV\"\ncapacity = {capacity}\n\
             locations = [\"P\", \"Q\"]\ntimes = [[\"0 min\", \"8 min\"], [\"8 min\", \"0 min\"]]\n\
             [[part]]\nname = \"job\"\noperation = [{{ name = \"first\", machines = \"P\", work = \"0 min\" }}, {{ name = \"second\", machines = \"Q\", work = \"0 min\" }}]\n\
             [[arrivals]]\npart = \"job\"\npattern = \"schedule\"\nlot = [{{ time = \"0 min\" }}, {{ time = \"1 min\" }}, {{ time = \"9 min\" }}, {{ time = \"15 min\" }}, {{ time = \"17 min\" }}]\n"
        );
        let log = run(&parsed(&text), 0, 0).unwrap();
        (times(&log, "move"), times(&log, "delivery"))
    };
    // Alone: there and back, one job after the other.
    assert_eq!(delivered(1), (vec![0.0, 8.0, 24.0, 40.0, 56.0], vec![8.0, 24.0, 40.0, 56.0, 72.0]));
    // It sets out for the second job at 8, is there at 16, and takes the two with it that have come until then.
    assert_eq!(delivered(3), (vec![0.0, 8.0, 16.0, 16.0, 24.0], vec![8.0, 24.0, 24.0, 24.0, 40.0]));
    assert_eq!(delivered(2), (vec![0.0, 8.0, 16.0, 24.0, 32.0], vec![8.0, 24.0, 24.0, 40.0, 40.0]));
}

/// Three orders of six pieces through two stations, a minute and three minutes a piece, with the keys of the second one.
fn line(second: &str) -> RunLog {
    let text = format!(
        "schema = 1\n[shop]\nname = \"line\"\nhorizon = \"10 h\"\n[[machine]]\nname = \"A\"\nprocess = \"plain\"\n\
         [[machine]]\nname = \"B\"\nprocess = \"plain\"\n{second}\n[[part]]\nname = \"p\"\n\
         operation = [{{ name = \"first\", machines = \"A\", work = \"1 min\" }}, {{ name = \"second\", machines = \"B\", work = \"3 min\" }}]\n\
         [[order]]\nid = \"1\"\npart = \"p\"\nquantity = 6\n[[order]]\nid = \"2\"\npart = \"p\"\nquantity = 6\n\
         [[order]]\nid = \"3\"\npart = \"p\"\nquantity = 6\n"
    );
    run(&parsed(&text), 0, 0).unwrap()
}

#[test]
fn places_may_be_those_of_pieces() {
    // The first order is in B from 6 to 24. The second fills six places at 12; the third finds no six others at 18.
    let blocked = |second: &str| scenarios::time_in(&line(second), 0, MachineState::Blocked) / 60.0;
    assert_eq!(blocked("input_buffer = 2"), 0.0);
    assert_eq!(blocked("input_buffer = 10\nbuffer_unit = \"pieces\""), 6.0);
    assert_eq!(blocked("input_buffer = 12\nbuffer_unit = \"pieces\""), 0.0);
    assert_eq!(blocked("[[buffer]]\nname = \"shelf\"\nplaces = 11\nunit = \"pieces\"\nbefore = [\"B\"]"), 6.0);
}

#[test]
fn pieces_that_wait_for_each_others_places_are_found() {
    // Orders of three pieces go from A to B, others from B to A; before each there are places for four pieces.
    let text = "schema = 1\n[shop]\nname = \"circle\"\nhorizon = \"10 h\"\n\
        [[machine]]\nname = \"A\"\nprocess = \"plain\"\ninput_buffer = 4\nbuffer_unit = \"pieces\"\n\
        [[machine]]\nname = \"B\"\nprocess = \"plain\"\ninput_buffer = 4\nbuffer_unit = \"pieces\"\n\
        [[part]]\nname = \"x\"\noperation = [{ name = \"1\", machines = \"A\", work = \"1 min\" }, { name = \"2\", machines = \"B\", work = \"1 min\" }]\n\
        [[part]]\nname = \"y\"\noperation = [{ name = \"1\", machines = \"B\", work = \"1 min\" }, { name = \"2\", machines = \"A\", work = \"1 min\" }]\n";
    let orders = |count: usize| {
        (0..count)
            .map(|i| format!("[[order]]\nid = \"{i}\"\npart = \"{}\"\nquantity = 3\n", ["x", "y"][i % 2]))
            .collect::<String>()
    };
    let shop = |count: usize| run(&parsed(&format!("{text}{}", orders(count))), 0, 0);
    assert!(shop(2).is_ok());
    let error = shop(6).unwrap_err().to_string();
    assert!(error.starts_with("deadlock at 180 s: A holds 0 that wants B; B holds 1 that wants A"), "{error}");
}
