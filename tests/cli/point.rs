//! `point`: one operating point, and its slips.

use super::*;

#[test]
fn point_meets_the_reference_numbers_of_turning() {
    let arguments = [
        "point",
        "turning",
        "--tool",
        "ni_vk6om",
        "--set",
        "cutting_speed=40 m/min",
        "--set",
        "flank_wear=0.2 mm",
        "--json",
    ];
    let result = json(&toolroom(&arguments));
    assert_eq!(result["schema"], 1);
    assert_eq!(result["inputs"]["cutting_speed [m/min]"], 40.0);
    let outputs = &result["outputs"];
    let close = |key: &str, expected: f64, tolerance: f64| {
        let value = outputs[key].as_f64().unwrap_or_else(|| panic!("{key} in {outputs}"));
        assert!((value / expected - 1.0).abs() < tolerance, "{key} = {value}, not {expected}");
    };
    // Reference implementation of the wear model: v*(0.2 mm), life and path at 40 m/min.
    close("minimum_wear_speed [m/min]", 39.997815, 1e-6);
    close("tool_life [min]", 14.932164, 1e-6);
    close("path_life [m]", 597.28658, 1e-6);
    close("temperature [K]", 1028.9, 1e-4);
    close("wear_intensity [um/m]", 0.5, 1e-4);
    assert_eq!(outputs["life_model"], "quasi_steady");
}

#[test]
fn an_edge_that_a_cut_overheats_at_once_has_no_life() {
    let life = |speed: &str, model: &str| {
        let speed = format!("cutting_speed={speed}");
        let cut = ["--set", &speed, "--set", "feed_per_rev=0.4 mm", "--set", "depth_of_cut=3 mm"];
        let point = json(&toolroom(&[&["point", "turning", "--life-model", model, "--json"][..], &cut].concat()));
        (point["outputs"]["tool_life [min]"].as_f64().expect("a life"), point["outputs"]["life_ends_by"].clone())
    };
    let (slower, faster) = (life("80 m/min", "quasi_steady"), life("90 m/min", "quasi_steady"));
    assert!((slower.0 - 0.0148).abs() < 1e-4 && slower.1 == "thermal_collapse", "{slower:?}");
    assert_eq!(faster, (0.0, "thermal_collapse".into()));
}

#[test]
fn point_takes_effects_and_refuses_slips() {
    let plain = json(&toolroom(&["point", "turning", "--set", "flank_wear=0.4 mm", "--json"]));
    let worn =
        json(&toolroom(&["point", "turning", "--set", "flank_wear=0.4 mm", "--effect", "wear_force=0.2", "--json"]));
    assert!(worn["outputs"]["cutting_force [N]"].as_f64() > plain["outputs"]["cutting_force [N]"].as_f64());
    let none =
        json(&toolroom(&["point", "turning", "--set", "flank_wear=0.4 mm", "--effect", "wear_force=0", "--json"]));
    let close = |key: &str| {
        let output = |result: &Value| result["outputs"][key].as_f64().expect("a number");
        assert!((output(&none) / output(&plain) - 1.0).abs() < 1e-7, "{key}");
    };
    close("cutting_force [N]");
    close("minimum_wear_speed [m/min]");
    for (wrong, message) in [
        ("cutting_speed=40", "m/min"),
        ("cuting_speed=40 m/min", "did you mean `cutting_speed`?"),
        ("cutting_speed=40 mm", "m/min"),
        ("cutting_speed=9000 m/min", "outside"),
        ("limits.wear=1", "wear_limit"),
        ("nonsense", "name=value"),
    ] {
        let output = toolroom(&["point", "turning", "--set", wrong]);
        assert_eq!(output.status.code(), Some(2), "{wrong}");
        assert!(stderr(&output).contains(message), "{wrong}: {}", stderr(&output));
    }
}
