//! Calibrations, effects and deviations of a file act where they say.

use toolroom_process::{AnyRecord, Process};
use toolroom_scenario::{CalibrationShift, Occasion, ProcessModel, Target, calibrated};
use toolroom_scenario_file::parse;

const SHOP: &str = include_str!("../../../../scenarios/gap/turning.toml");

fn with(more: &str) -> Result<toolroom_scenario::Scenario, String> {
    let (head, tail) = SHOP.split_once("scatter = \"lab\"").expect("the tool");
    let (tool, rest) = more.split_once("---").unwrap_or(("", more));
    let text = format!("{head}scatter = \"lab\"\n{tool}{tail}\n{rest}");
    parse("shop.toml", &text, &[]).map(|file| file.scenario).map_err(|error| error.to_string())
}

fn force(process: &ProcessModel) -> f64 {
    let ProcessModel::Turning(turning) = process else { panic!("turning") };
    let mut turning = (**turning).clone();
    let groups = turning.parameters_mut();
    let (_, record): &(_, &mut dyn AnyRecord) = groups.iter().find(|(group, _)| *group == "force").expect("a group");
    let i = record.fields().iter().position(|field| field.name == "specific_force").expect("a field");
    record.value(i).expect("a value")
}

#[test]
fn a_calibration_moves_the_constant_of_its_tool() {
    let scenario = with(
        "[[calibration]]\nparameter = \"force.specific_force\"\ntarget = \"tool insert\"\nfactor = 1.25\n\
         standard_error = 0.01\nprior = 0.08\nby = \"diagnosis 9c41e0b2\"\n",
    )
    .unwrap();
    let tool = &scenario.tools[0];
    assert!((force(&tool.process) / force(tool.bare()) - 1.25).abs() < 1e-15);
    let calibration = &scenario.calibrations[0];
    assert_eq!(
        (calibration.standard_error, calibration.prior, calibration.by.as_str()),
        (Some(0.01), Some(0.08), "diagnosis 9c41e0b2")
    );
    assert_eq!(
        (&calibration.target, calibration.moved),
        (&Target::Tool("insert".to_owned()), CalibrationShift::Factor(1.25))
    );
}

#[test]
fn a_scope_decides_which_process_a_tool_has() {
    let scenario = with(
        "effects = [\n  { id = \"wear_force\", size = 0.2, scope = { machine = \"L\" } },\n  \
         { id = \"built_up_edge\", size = 0.1, shape = { centre = \"92 m/min\", width = 0.15 }, standard_error = 0.02 },\n\
         ]\n---[[calibration]]\nparameter = \"force.specific_force\"\ntarget = \"tool insert\"\nfactor = 2.0\n\
         scope = { shift = [\"S1\", \"S3\"], until = \"8 h\" }\n",
    )
    .unwrap();
    let tool = &scenario.tools[0];
    let mut occasion = Occasion::at(0.0);
    assert_eq!(tool.variants.acting(&occasion), 0);
    occasion.set("machine", "L2");
    occasion.set("shift", "S3");
    let both = tool.variants.acting(&occasion);
    assert_eq!(both, 3);
    assert!((force(tool.process_of(both)) / force(&tool.process) - 2.0).abs() < 1e-15);
    occasion.time = Some(8.0 * 3600.0);
    assert_eq!(tool.variants.acting(&occasion), 1);
    let effects = |process: &ProcessModel| match process {
        ProcessModel::Turning(turning) => turning.effects.iter().map(|own| own.entry().id).collect::<Vec<_>>(),
        _ => Vec::new(),
    };
    assert_eq!(effects(&tool.process), ["built_up_edge"]);
    assert_eq!(effects(tool.process_of(1)), ["built_up_edge", "wear_force"]);
    assert!(effects(tool.bare()).is_empty());
    let window = tool.variants.effects[1].effect.parameters();
    assert!((window.value(1).unwrap() - 92.0 / 60.0).abs() < 1e-12 && window.value(2) == Some(0.15));
}

#[test]
fn factors_and_summands_of_the_shop_meet_in_an_operation() {
    let scenario = with(
        "[[calibration]]\nparameter = \"handling_time\"\ntarget = \"shop\"\nfactor = 1.1\n\
         [[calibration]]\nparameter = \"handling_time\"\ntarget = \"machine L\"\nsummand = \"0.8 s\"\n\
         [[calibration]]\nparameter = \"handling_time\"\ntarget = \"part part/turn\"\nsummand = \"3 s\"\nscope = { machine = \"L2\" }\n",
    )
    .unwrap();
    let time = |machine: &str| {
        let mut occasion = Occasion::default();
        occasion.set("machine", machine.to_owned());
        occasion.set("part", "part");
        occasion.set("operation", "turn");
        calibrated(&scenario.calibrations, toolroom_scenario::ShopConstant::HandlingTime, &occasion, 100.0)
    };
    assert!((time("L1") - 110.8).abs() < 1e-12 && (time("L2") - 113.8).abs() < 1e-12);
    assert!((time("X") - 110.0).abs() < 1e-12);
}

#[test]
fn deviations_take_numbers_scopes_and_the_old_shift() {
    let scenario = with(
        "[[deviation]]\nid = \"feed_override\"\nsize = -0.167\nscope = { machine = [\"L1\"], shift = \"S2\" }\n\
         [[deviation]]\nid = \"operator_delay\"\nsize = \"12 s\"\nshift = \"S1\"\n",
    )
    .unwrap();
    assert_eq!((scenario.deviations[0].size, scenario.deviations[1].size), (-0.167, 12.0));
    assert_eq!(scenario.deviations[0].scope.words(), "machine=L1, shift=S2");
    assert_eq!(scenario.deviations[1].scope, toolroom_scenario::Scope::shift("S1"));
}

#[test]
fn what_nobody_knows_is_named_with_its_fix() {
    for (more, wanted) in [
        (
            "[[calibration]]\nparameter = \"force.specifc_force\"\ntarget = \"tool insert\"\nfactor = 1.1\n",
            "specific_force",
        ),
        ("[[calibration]]\nparameter = \"handling\"\ntarget = \"shop\"\nfactor = 1.1\n", "parameter"),
        ("[[calibration]]\nparameter = \"wear_rate\"\ntarget = \"tool insrt\"\nfactor = 1.1\n", "insrt"),
        ("[[calibration]]\nparameter = \"wear_rate\"\ntarget = \"tool insert\"\n", "one of them is due"),
        (
            "[[calibration]]\nparameter = \"force.specific_force\"\ntarget = \"tool insert\"\nfactor = 1e5\n",
            "specific_force",
        ),
        ("[[calibration]]\nparameter = \"handling_time\"\ntarget = \"shop\"\nsummand = \"2 mm\"\n", "summand"),
        ("[[deviation]]\nid = \"micro_stops\"\nsize = \"-1 1/h\"\n", "size"),
        ("[[deviation]]\nid = \"feed_override\"\nsize = -0.6\n", "size"),
        (
            "[[deviation]]\nid = \"feed_override\"\nsize = 0.1\n[[deviation]]\nid = \"feed_override\"\nsize = 0.2\n",
            "two deviation",
        ),
        ("[[deviation]]\nid = \"feed_override\"\nsize = 0.1\nscope = { machine = \"L9\" }\n", "no machine \"L9\""),
        (
            "[[calendar]]\nname = \"day\"\nperiod = \"1 day\"\nshift = [{ start = \"6 h\", end = \"14 h\" }, { start = \"14 h\", end = \"22 h\" }]\n\
             [[deviation]]\nid = \"operator_delay\"\nsize = \"20 s\"\nscope = { shift = \"S9\" }\n",
            "no shift \"S9\"",
        ),
        ("[[deviation]]\nid = \"feed_override\"\nsize = 0.1\nscope = { from = \"2026-03-02T06:00\" }\n", "no start"),
        (
            "[[deviation]]\nid = \"feed_override\"\nsize = 0.1\nscope = { from = \"2 h\", until = \"1 h\" }\n",
            "ends after",
        ),
        ("effects = [{ id = \"wear_force\", size = 0.1 }, { id = \"wear_force\", size = 0.2 }]\n---", "twice"),
        ("effects = [{ id = \"wear_force\", shape = { size = 0.1 } }]\n---", "beside the shape"),
    ] {
        let error = with(more).expect_err(more);
        assert!(error.contains(wanted), "{more}\n{error}");
    }
}
