//! Who chooses the speed of mills.

use toolroom_scenario::policies::{Observation, ResolvedPolicy};
use toolroom_scenario_file::parse;

const MILLS: &str = r#"
schema = 1

[shop]
name = "mills"
replications = 2
horizon = "10 h"
warm_up = "0 h"
shift_length = "8 h"

[[machine]]
name = "M"
process = "milling"
rate = "80 EUR/h"
load_time = "60 s"
unload_time = "30 s"
tool_change_time = "2 min"
speed_range = ["60 m/min", "400 m/min"]

[[tool]]
name = "cutter"
process = "milling"
parameter_set = "c45_endmill_d12"
edge_cost = "20 EUR"

[[part]]
name = "plate"

[[part.operation]]
name = "slot"
machines = "M"
tool = "cutter"
passes = 2
cutting_speed = "150 m/min"
feed_per_tooth = "0.05 mm/tooth"
depth_of_cut = "3 mm"
width_of_cut = "3 mm"
path_length = "100 mm"
size_tolerance = "250 um"

[[arrivals]]
part = "plate"
pattern = "constant_work"
jobs = 2

[[policy]]
name = "given"
speed = "constant"
cutting_speed = "120 m/min"
tool_change = { rule = "wear_limit", limit = "0.2 mm" }

[[policy]]
name = "factor"
speed = "programmed"
speed_factor = 0.8
tool_change = { rule = "wear_limit", limit = "0.2 mm" }

[[policy]]
name = "follows wear"
speed = "minimum_wear"
tool_change = { rule = "wear_limit", limit = "0.2 mm" }
"#;

const LATHE: &str = r#"
[[machine]]
name = "L"
process = "turning"
rate = "70 EUR/h"
load_time = "60 s"
unload_time = "30 s"
tool_change_time = "2 min"
speed_range = ["60 m/min", "400 m/min"]

[[tool]]
name = "insert"
process = "turning"
parameter_set = "c45_t15k6"
edge_cost = "8 EUR"

[[part]]
name = "shaft"

[[part.operation]]
name = "turn"
machines = "L"
tool = "insert"
cutting_speed = "180 m/min"
feed_per_rev = "0.3 mm/rev"
depth_of_cut = "1.5 mm"
diameter = "55 mm"
length = "400 mm"
size_tolerance = "150 um"

[[arrivals]]
part = "shaft"
pattern = "constant_work"
jobs = 1
"#;

/// Speed in m/min that each policy commands in the first pass.
fn commanded(text: &str) -> Vec<f64> {
    let file = parse("mills.toml", text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let scenario = file.scenario;
    let observation = Observation {
        path: 0.1,
        edge_path: 0.0,
        edge_time: 0.0,
        edge_parts: 0,
        last_speed: None,
        observer: None,
        reaction: None,
        true_wear: None,
        true_edge: None,
    };
    let speed = |policy: usize| {
        let policy = ResolvedPolicy::from_scenario(&scenario, policy).expect("a policy");
        60.0 * policy.of_pass(0, 0).choose(&observation).start_speed
    };
    (0..scenario.policies.len()).map(speed).collect()
}

#[test]
fn policies_choose_the_speed_of_mills_where_there_is_no_lathe() {
    let speeds = commanded(MILLS);
    for (speed, expected) in speeds.iter().zip([120.0, 120.0, 150.0]) {
        assert!((speed - expected).abs() < 1e-9, "{speeds:?}: a rule without a model of wear cuts as programmed");
    }
    let beside_a_lathe = commanded(&format!("{MILLS}{LATHE}"));
    assert!(beside_a_lathe.iter().all(|speed| (speed - 150.0).abs() < 1e-9), "{beside_a_lathe:?}");
}

#[test]
fn a_set_of_another_process_is_told_as_such() {
    let message = parse("mills.toml", &MILLS.replace("c45_endmill_d12", "c45_t15k6"), &[]).err().unwrap().to_string();
    assert!(message.contains("it is a set of turning, where one of milling is due"), "{message}");
    assert!(message.contains("there are c45_endmill_d12, mill_t15k6_d32"), "{message}");
    let message = parse("mills.toml", &MILLS.replace("c45_endmill_d12", "zb153u_40kh"), &[]).err().unwrap().to_string();
    assert!(message.contains("it is a set of grinding, where one of milling is due"), "{message}");
}
