//! Cribs, planned maintenance, and people for a part of an operation, against results worked out by hand.

use toolroom_scenario::Scenario;
use toolroom_scenario_file::{parse, read};
use toolroom_shop::run;
use toolroom_shop::runlog::{MachineState, RunLog};

fn parsed(text: &str) -> Scenario {
    parse("cribs.toml", text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario
}

/// When the jobs are finished, min.
fn finishes(log: &RunLog) -> Vec<f64> {
    log.jobs.iter().map(|job| (job.finish / 6.0).round() / 10.0).collect()
}

/// Stays of a machine in a state, min.
fn minutes(log: &RunLog, machine: u32, state: MachineState) -> Vec<(f64, f64)> {
    let rows = log.states.iter().filter(|row| row.machine == machine && row.state == state);
    let tenths = |time: f64| (time / 6.0).round() / 10.0;
    rows.map(|row| (tenths(row.start), tenths(row.end))).collect()
}

/// Share of the run in a state.
fn share(log: &RunLog, machine: u32, state: MachineState) -> f64 {
    let rows = log.states.iter().filter(|row| row.machine == machine && row.state == state);
    rows.map(|row| row.end - row.start).sum::<f64>() / log.horizon
}

/// A machine that always has work whose edges last 20 minutes, and a crib with what `crib` says.
fn worn(edges: u32, crib: &str, work: &str) -> Scenario {
    parsed(&format!(
        r#"
schema = 1
[shop]
name = "worn"
horizon = "4 h"
[[machine]]
name = "M"
process = "plain"
tool_change_time = "1 min"
[[machine]]
name = "grinder"
process = "plain"
[[tool]]
name = "drill"
process = "life_only"
life = "20 min"
edge_cost = "10 EUR"
[[crib]]
tool = "drill"
edges = {edges}
{crib}
[[part]]
name = "part"
operation = [{{ name = "bore", machines = "M", work = "{work}", tool = "drill" }}]
[[order]]
id = "A"
part = "part"
quantity = 1
"#
    ))
}

#[test]
fn an_edge_is_changed_in_the_middle_of_the_work() {
    // 50 minutes of work on edges of 20: changes at 20 and, a minute later on, at 41.
    let log = run(&worn(3, "", "50 min"), 0, 0).unwrap();
    assert_eq!(finishes(&log), [52.0]);
    assert_eq!(minutes(&log, 0, MachineState::ToolChange), [(20.0, 21.0), (41.0, 42.0)]);
    let lives: Vec<f64> = log.edges.iter().map(|edge| edge.cutting_time / 60.0).collect();
    assert!(lives.iter().zip([20.0, 20.0, 10.0]).all(|(life, by_hand)| (life - by_hand).abs() < 1e-6), "{lives:?}");
    // Bringing it from the crib takes its time, too.
    let log = run(&worn(3, "fetch = \"3 min\"", "50 min"), 0, 0).unwrap();
    assert_eq!(finishes(&log), [58.0]);
    // With two edges and none ground the third never comes.
    let log = run(&worn(2, "", "50 min"), 0, 0).unwrap();
    assert_eq!(minutes(&log, 0, MachineState::WaitingTool), [(41.0, 240.0)]);
}

/// A part that is bored at twice the speed at which edges last 40 minutes, then reamed at that speed: the exponent of 1 makes
/// edges last 20 minutes at twice the speed.
fn at_speeds(life_at: &str, reamed: &str) -> String {
    format!(
        r#"
schema = 1
[shop]
name = "speeds"
horizon = "4 h"
[[machine]]
name = "M"
process = "plain"
tool_change_time = "1 min"
[[tool]]
name = "drill"
process = "life_only"
life = "40 min"
{life_at}
edge_cost = "10 EUR"
[[part]]
name = "part"
operation = [
    {{ name = "bore", machines = "M", work = "15 min", tool = "drill", cutting_speed = "160 m/min" }},
    {{ name = "ream", machines = "M", work = "20 min", {reamed} }},
]
[[order]]
id = "A"
part = "part"
quantity = 1
"#
    )
}

#[test]
fn shares_of_the_life_that_speeds_take_add_up() {
    let life_at = "life_at = { cutting_speed = \"80 m/min\", speed_exponent = 1.0 }";
    // Boring takes 30 of 40 minutes of life, so that the edge is changed after 10 minutes of reaming.
    let log = run(&parsed(&at_speeds(life_at, "tool = \"drill\"")), 0, 0).unwrap();
    assert_eq!(minutes(&log, 0, MachineState::ToolChange), [(25.0, 26.0)]);
    assert_eq!(finishes(&log), [36.0]);
    // Reamed at half the speed it ages half as fast: 10 minutes of life are 20 of work.
    let slow = "tool = \"drill\", cutting_speed = \"40 m/min\"";
    let log = run(&parsed(&at_speeds(life_at, slow)), 0, 0).unwrap();
    assert_eq!(finishes(&log), [35.0]);
    // By the fourth power of the speed boring takes 16 times its time, 6 edges of 2.5 minutes each.
    let log = run(&parsed(&at_speeds(&life_at.replace("1.0", "4.0"), slow)), 0, 0).unwrap();
    assert_eq!(minutes(&log, 0, MachineState::ToolChange).len(), 6);
}

#[test]
fn a_cutting_speed_that_moves_no_life_is_refused() {
    let refused = |text: &str| parse("speeds.toml", text, &[]).err().unwrap().to_string();
    let message = refused(&at_speeds("", "tool = \"drill\""));
    assert!(message.contains("nothing says how the life of \"drill\" falls with the cutting speed"), "{message}");
    let life_at = "life_at = { cutting_speed = \"80 m/min\", speed_exponent = 1.0 }";
    let message = refused(&at_speeds(life_at, "cutting_speed = \"40 m/min\""));
    assert!(message.contains("plain work without a tool has no cutting speed"), "{message}");
}

#[test]
fn the_only_edge_is_ground_while_its_machine_waits_for_it() {
    let grinder = "regrind = { station = \"grinder\", time = \"30 min\", times = 2 }";
    let log = run(&worn(1, grinder, "50 min"), 0, 0).unwrap();
    // 20 min of work, 30 at the grinder, a change, 20 of work, 30, a change, 10 of work.
    assert_eq!(minutes(&log, 0, MachineState::WaitingTool), [(20.0, 50.0), (71.0, 101.0)]);
    assert_eq!(minutes(&log, 1, MachineState::Working), [(20.0, 50.0), (71.0, 101.0)]);
    assert_eq!(log.jobs[0].finish, 112.0 * 60.0);
    assert_eq!(log.edges.iter().map(|edge| edge.ground).collect::<Vec<_>>(), [0, 1, 2]);
    // Ground once only, it is thrown away after its second life.
    let once = "regrind = { station = \"grinder\", time = \"30 min\", times = 1 }";
    let log = run(&worn(1, once, "50 min"), 0, 0).unwrap();
    assert_eq!(minutes(&log, 0, MachineState::WaitingTool), [(20.0, 50.0), (71.0, 240.0)]);
    // With a shorter life after every regrinding: 20, 18, 12 minutes of work.
    let shorter = "regrind = { time = \"30 min\", times = 9, life_factor = 0.9 }";
    let log = run(&worn(1, shorter, "50 min"), 0, 0).unwrap();
    assert_eq!(minutes(&log, 0, MachineState::Working), [(0.0, 20.0), (51.0, 69.0), (100.0, 112.0)]);
}

/// Two pieces that a machine with the only edge bores and the grinder polishes; the grinder is kept for their order.
#[test]
fn a_grinder_that_is_kept_for_an_order_grinds_the_edge_for_which_the_order_waits() {
    let scenario = parsed(
        r#"
schema = 1
[shop]
name = "kept"
horizon = "4 h"
[[machine]]
name = "M"
process = "plain"
tool_change_time = "1 min"
[[machine]]
name = "grinder"
process = "plain"
setup_at_start = ""
setup_time = "4 min"
[[tool]]
name = "drill"
process = "life_only"
life = "20 min"
edge_cost = "10 EUR"
[[crib]]
tool = "drill"
edges = 1
regrind = { station = "grinder", time = "10 min" }
[[part]]
name = "part"
operation = [
    { name = "bore", machines = "M", work = "15 min", tool = "drill" },
    { name = "polish", machines = "grinder", work = "5 min" },
]
[[order]]
id = "A"
part = "part"
quantity = 2
transfer = 1
"#,
    );
    let log = run(&scenario, 0, 0).unwrap();
    // The first piece is polished from 19 to 24; at 20 the edge is spent. It is ground from 28 to 38, with a setup before and one
    // after, and the last ten minutes of boring begin at 39.
    assert_eq!(minutes(&log, 0, MachineState::WaitingTool), [(20.0, 38.0)]);
    assert_eq!(minutes(&log, 1, MachineState::Setup), [(15.0, 19.0), (24.0, 28.0), (49.0, 53.0)]);
    assert_eq!(minutes(&log, 1, MachineState::Working), [(19.0, 24.0), (28.0, 38.0), (53.0, 58.0)]);
    let pieces = log.jobs.iter().filter(|job| job.order.is_some()).map(|job| job.finish / 60.0).collect::<Vec<_>>();
    assert_eq!(pieces, [24.0, 58.0]);
}

#[test]
fn edges_are_bought_in_lots_and_ground_in_batches() {
    // The second of two edges is taken at 20; one is ordered whenever none is left, and comes after 35 minutes.
    let buy = "buy = { below = 1, lot = 1, lead = \"35 min\" }";
    let log = run(&worn(2, buy, "70 min"), 0, 0).unwrap();
    assert_eq!(minutes(&log, 0, MachineState::WaitingTool), [(41.0, 55.0), (76.0, 90.0)]);
    assert_eq!(finishes(&log)[0], 101.0);
    // Two are sent together at 41 and come back together, half an hour later for each.
    let batch = "regrind = { station = \"grinder\", time = \"15 min\", batch = 2 }";
    let log = run(&worn(2, batch, "70 min"), 0, 0).unwrap();
    assert_eq!(minutes(&log, 1, MachineState::Working), [(41.0, 71.0)]);
    assert_eq!(minutes(&log, 0, MachineState::WaitingTool), [(41.0, 71.0)]);
}

/// One machine that always has work, and its grinder: a closed line of two exponential servers with three customers.
#[test]
fn a_crib_is_a_closed_line_of_machine_and_grinder() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shop/crib.toml");
    let scenario =
        read(file.as_ref(), &["shop.horizon=\"60000 h\"".to_owned()]).unwrap_or_else(|error| panic!("{error}"));
    let log = run(&scenario.scenario, 0, 0).unwrap();
    // Chances of 0 to 3 edges at the machine are as 27 : 36 : 48 : 64, by the ratio 4/3 of the two rates.
    let (cutting, load) = (148.0 / 175.0, 111.0 / 175.0);
    let (here, there) = (share(&log, 0, MachineState::Working), share(&log, 1, MachineState::Working));
    // Four standard errors of 0.0029 and 0.0038, by twelve runs of an independent model as long.
    assert!((here - cutting).abs() < 0.012, "{here} against {cutting}");
    assert!((there - load).abs() < 0.015, "{there} against {load}");
}

/// A machine in one shift of 8 hours a day that always has half an hour of work.
fn maintained(maintenance: &str) -> Scenario {
    parsed(&format!(
        r#"
schema = 1
[shop]
name = "maintained"
horizon = "48 h"
[[calendar]]
name = "day"
period = "24 h"
at_end = "resume"
shift = [{{ start = "6 h", end = "14 h" }}]
[[calendar]]
name = "evening"
period = "24 h"
shift = [{{ start = "16 h", end = "20 h" }}]
[[machine]]
name = "M"
process = "plain"
calendar = "day"
[[part]]
name = "part"
operation = [{{ name = "work", machines = "M", work = "30 min" }}]
[[arrivals]]
part = "part"
pattern = "constant_work"
jobs = 2
[[maintenance]]
machines = "M"
{maintenance}
"#
    ))
}

#[test]
fn maintenance_waits_for_the_end_of_the_operation() {
    let hours = |spans: &[(f64, f64)]| spans.iter().map(|(from, to)| (from * 60.0, to * 60.0)).collect::<Vec<_>>();
    // After 100 minutes of work the fourth part is in the machine; it is finished first.
    let log = run(&maintained("every = \"100 min\"\nduration = \"1 h\""), 0, 0).unwrap();
    let first = hours(&[(8.0, 9.0), (11.0, 12.0)]);
    assert_eq!(minutes(&log, 0, MachineState::Maintenance)[..2], first);
    // By the calendar at every multiple of ten hours: at 10, and at 20, which waits for the shift at 30 and stands for that
    // of 30 as well; 40 is out of shift again.
    let calendar = "every = \"10 h\"\nclock = \"calendar\"\nduration = \"1 h\"";
    let log = run(&maintained(calendar), 0, 0).unwrap();
    assert_eq!(minutes(&log, 0, MachineState::Maintenance), hours(&[(10.0, 11.0), (30.0, 31.0)]));
    // In its window it takes no time of the shift.
    let window = "every = \"100 min\"\nduration = \"1 h\"\nwindow = \"evening\"";
    let log = run(&maintained(window), 0, 0).unwrap();
    assert_eq!(minutes(&log, 0, MachineState::Maintenance), hours(&[(16.0, 17.0), (40.0, 41.0)]));
    assert!(log.states.iter().filter(|row| row.state == MachineState::Maintenance).all(|row| !row.in_shift));
    assert_eq!(log.jobs.iter().filter(|job| job.finish.is_finite()).count(), 32);
}

/// Machines whose work somebody tends.
fn tended(machines: u32, run: &str, people: &str, orders: &str) -> Scenario {
    parsed(&format!(
        r#"
schema = 1
[shop]
name = "tended"
horizon = "10 h"
[[operator]]
name = "tender"
skills = "tend"
{people}
[[machine]]
name = "M"
count = {machines}
process = "plain"
[[machine]]
name = "N"
process = "plain"
[[part]]
name = "part"
operation = [{{ name = "work", machines = "M", work = "10 min", operator = {{ run = {run} }} }}]
[[part]]
name = "other"
operation = [{{ name = "work", machines = "N", work = "10 min", operator = {{ run = "tend" }} }}]
{orders}
"#
    ))
}

fn order(id: &str, part: &str, quantity: u32, release: u32) -> String {
    format!("[[order]]\nid = \"{id}\"\npart = \"{part}\"\nquantity = {quantity}\nrelease = \"{release} min\"\n")
}

#[test]
fn one_person_tends_as_many_machines_as_shares_allow() {
    let five: String = (0..5).map(|each| order(&each.to_string(), "part", 1, 0)).collect();
    // Three shares of 0.3 fit into one person.
    let log = run(&tended(5, "{ skill = \"tend\", share = 0.3 }", "", &five), 0, 0).unwrap();
    assert_eq!(finishes(&log), [10.0, 10.0, 10.0, 20.0, 20.0]);
    let two = run(&tended(5, "{ skill = \"tend\", share = 0.3 }", "count = 2", &five), 0, 0).unwrap();
    assert_eq!(finishes(&two), [10.0; 5]);
    // Five of 0.2 are one person, and so are ten of 0.1.
    let fifth = run(&tended(5, "{ skill = \"tend\", share = 0.2 }", "", &five), 0, 0).unwrap();
    assert_eq!(finishes(&fifth), [10.0; 5]);
    let ten: String = (0..11).map(|each| order(&each.to_string(), "part", 1, 0)).collect();
    let tenth = run(&tended(11, "{ skill = \"tend\", share = 0.1 }", "", &ten), 0, 0).unwrap();
    assert_eq!(finishes(&tenth).iter().filter(|finish| **finish == 10.0).count(), 10);
    // What needs all of a person waits for the machines that this one tends.
    let mixed = order("a", "part", 1, 0) + &order("b", "other", 1, 1);
    let log = run(&tended(5, "{ skill = \"tend\", share = 0.3 }", "", &mixed), 0, 0).unwrap();
    assert_eq!(finishes(&log), [10.0, 20.0]);
}

#[test]
fn a_person_for_the_first_time_of_a_piece_leaves_its_machine_alone() {
    // Two minutes for each piece: the second machine starts two minutes later, and a third one two more.
    let three: String = (0..3).map(|each| order(&each.to_string(), "part", 1, 0)).collect();
    let log = run(&tended(3, "{ skill = \"tend\", first = \"2 min\" }", "", &three), 0, 0).unwrap();
    assert_eq!(finishes(&log), [10.0, 12.0, 14.0]);
    // Of two pieces of a lot the second waits while the other machine begins at 10 minutes.
    let lots = order("a", "part", 2, 0) + &order("b", "part", 1, 9);
    let log = run(&tended(2, "{ skill = \"tend\", first = \"2 min\" }", "", &lots), 0, 0).unwrap();
    assert_eq!(finishes(&log), [21.0, 19.0]);
    assert_eq!(minutes(&log, 0, MachineState::WaitingOperator), [(10.0, 11.0)]);
}

#[test]
fn a_person_walks_from_machine_to_machine() {
    let ways = "walk = { locations = [\"N\", \"M\"], times = [[\"0 min\", \"3 min\"], [\"4 min\", \"0 min\"]] }";
    let orders = order("a", "part", 1, 0) + &order("b", "part", 1, 0) + &order("c", "other", 1, 0);
    let log = run(&tended(1, "\"tend\"", ways, &orders), 0, 0).unwrap();
    // From N to M in 3 minutes; the step that waits at N goes before the next job at M: 4 minutes there, and 3 back.
    assert_eq!(finishes(&log), [13.0, 40.0, 27.0]);
    assert_eq!(minutes(&log, 0, MachineState::WaitingOperator)[0], (0.0, 3.0));
}

/// Two families of jobs with exponential setups between them; the family of the last job goes first, and a setup is made only
/// for work that waits.
#[test]
fn two_families_wait_for_setups_as_their_markov_chain_says() {
    let text = r#"
schema = 1
[shop]
name = "families"
horizon = "80000 h"
[dispatch]
rule = ["least_setup", "fifo"]
[[machine]]
name = "M"
process = "plain"
[[part]]
name = "a"
operation = [{ name = "do", machines = "M", work = { distribution = "exponential", mean = "8.333333333333334 min" }, setup_group = "a", setup_time = { distribution = "exponential", mean = "30 min" } }]
[[part]]
name = "b"
operation = [{ name = "do", machines = "M", work = { distribution = "exponential", mean = "10 min" }, setup_group = "b", setup_time = { distribution = "exponential", mean = "30 min" } }]
[[arrivals]]
part = "a"
pattern = "poisson"
rate = "3 1/h"
[[arrivals]]
part = "b"
pattern = "poisson"
rate = "0.6 1/h"
"#;
    let log = run(&parsed(text), 0, 0).unwrap();
    let wait = |part: u32, work: f64| {
        let of_part = log.jobs.iter().filter(|job| job.part == part && job.finish.is_finite());
        let stays: Vec<f64> = of_part.map(|job| (job.finish - job.arrival) / 60.0).collect();
        stays.iter().sum::<f64>() / stays.len() as f64 - work
    };
    // Waits in the queue end with the setup: 44.87980 and 73.35391 min by the stationary distribution of the chain; 240 000 and 48 000 correlated waits.
    let (a, b) = (wait(0, 25.0 / 3.0), wait(1, 10.0));
    assert!((a / 44.879_80 - 1.0).abs() < 0.03 && (b / 73.353_91 - 1.0).abs() < 0.03, "{a}, {b}");
    let setup = share(&log, 0, MachineState::Setup);
    assert!((setup / 0.302_553 - 1.0).abs() < 0.01, "{setup}");
}

#[test]
fn fewer_edges_than_machines_are_refused() {
    let text = "schema = 1\n[shop]\nname = \"few\"\nhorizon = \"4 h\"\n[[machine]]\nname = \"M\"\ncount = 2\nprocess = \"plain\"\n\
        [[tool]]\nname = \"drill\"\nprocess = \"life_only\"\nlife = \"20 min\"\nedge_cost = \"1 EUR\"\n[[crib]]\ntool = \"drill\"\nedges = 1\n\
        [[part]]\nname = \"p\"\noperation = [{ name = \"o\", machines = \"M\", work = \"5 min\", tool = \"drill\" }]\n\
        [[order]]\nid = \"A\"\npart = \"p\"\n";
    let error = parse("few.toml", text, &[]).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("2 machines use \"drill\", whose edges are ground 1 at a time, and there are 1"), "{error}");
}
