//! `[[tool]]`: process, constants, scatter and costs of a kind of tool.

use super::crib::{LIFE, LIFE_AT};
use super::quantity::{COST, DEVIATION, DURATION, TIME};
use crate::choices::{IsolationWord, ProcessKind};
use crate::measured::SCOPE;
use serde_json::{Map, Value, json};
use toolroom_effects::Effect;
use toolroom_form::{Content, Form, Key, Kind, field, schema};
use toolroom_wear::{HANDBOOK, Scatter};

pub(super) static TOOL: Form = Form {
    title: "[[tool]]",
    doc: "A kind of tool with its process model",
    keys: &[
        Key::required("name", Kind::Name, "Unique name"),
        Key::required(
            "process",
            Kind::Choice(ProcessKind::OF_TOOLS),
            "Process; life_only: nothing but how long its edges last, in operations with `work`",
        ),
        LIFE,
        LIFE_AT,
        Key::optional(
            "parameter_set",
            Kind::Name,
            "Tool and work material: name of a parameter set of the process; due unless a unit is named",
        )
        .when("process", ProcessKind::WORDS),
        Key::optional(
            "parameters_from",
            Kind::Text,
            "Draws of a calibration, a Parquet table beside this file: each replication takes one, the same under every policy",
        )
        .when("process", ProcessKind::WORDS),
        Key::optional("fmu", Kind::Text, "FMI unit that stands in for the process; its path from this file")
            .when("process", ProcessKind::CUTTING),
        Key::optional("wiring", Kind::Table(&WIRING), "Which variable of the unit stands for which quantity")
            .when("process", ProcessKind::CUTTING),
        Key::optional(
            "parameters",
            Kind::Parameters,
            "Deviations from the parameter set, group by group; the group of another wear law makes that the law of the tool",
        )
        .when("process", ProcessKind::WORDS),
        Key::optional(
            "handbook",
            Kind::Table(&HANDBOOK),
            "Constants of a handbook or of tests, which go before those of the parameter set and after `parameters`",
        )
        .when("process", &[ProcessKind::Turning.word()]),
        Key::optional("effects", Kind::Content(&EFFECTS), "Effects switched on in the true world")
            .when("process", ProcessKind::WORDS),
        Key::optional(
            "structure",
            Kind::Text,
            "Lobes file beside this one with the vibration modes around the cut; left out: every cut is stable",
        )
        .when("process", ProcessKind::CUTTING),
        Key::optional(
            "structure_scatter",
            Kind::Table(&STRUCTURE_SCATTER),
            "How the machines' structures differ from that; left out: as the modes of its structure file are known, else not at all",
        )
        .when("process", ProcessKind::CUTTING),
        Key::required("edge_cost", COST, "Cost of one cutting edge, or of one dressing of a wheel"),
        Key::default("dressing_time", TIME, "1.5 min", "Dressing the wheel").when("process", &["infeed"]),
        Key::optional(
            "scatter",
            Scatter::<f64>::KIND,
            "Scatter of edges, workpieces and wear; a table changes single values of the shop's. Left out: that of the parameter set, \
             else the shop's",
        )
        .when("process", ProcessKind::WORDS),
    ],
};

static STRUCTURE_SCATTER: Form = Form {
    title: "structure_scatter",
    doc: "Relative standard deviations of the machines' structures, all modes of a machine alike",
    keys: &[
        Key::default("natural_frequency", DEVIATION, "0 %", "Of natural frequencies"),
        Key::default("damping_ratio", DEVIATION, "0 %", "Of damping ratios"),
    ],
};

/// How a unit is wired; what is left out is found by name.
static WIRING: Form = Form {
    title: "wiring",
    doc: "Which variable of the unit stands for which quantity; left out: the one of the same name",
    keys: &[
        Key::optional("inputs", Kind::Texts, "Variable for an input, such as cutting_speed = \"vc [m/min]\""),
        Key::optional("outputs", Kind::Texts, "Variable for an output, such as flank_wear = \"tool.VB\""),
        Key::optional("events", Kind::Texts, "Boolean variable that an event sets, such as wear_limit = \"tool.worn\""),
        Key::optional("start", Kind::Texts, "Start values of parameters, in the unit's own units"),
        Key::optional("step", DURATION, "Longest communication step; left out: a whole pass"),
        Key::default(
            "isolation",
            Kind::Choice(IsolationWord::WORDS),
            IsolationWord::Process.word(),
            "Where the unit's code runs: in a worker process, or in the program itself",
        ),
        Key::default("call_limit", DURATION, "10 s", "Longest time of one call of a unit in a worker process"),
    ],
};

/// Effects of the catalogue.
static EFFECTS: Content = Content {
    expected: "a list of effects",
    example: "[{ id = \"wear_force\", size = 0.2 }]",
    schema: || {
        let all = Effect::all().map(effect).chain([user_effect()]);
        json!({ "type": "array", "items": { "oneOf": all.collect::<Vec<_>>() } })
    },
    entry: Some(["id", "size"]),
};

/// An effect that the file defines itself.
fn user_effect() -> Value {
    let amount = json!({ "type": ["number", "string"] });
    json!({
        "type": "object", "required": ["id", "size"],
        "properties": {
            "id": { "type": "string", "pattern": "\\.", "description": "Id of an [[effect]] of this file" },
            "size": amount, "standard_error": amount, "shape": { "type": "object" }, "scope": { "type": "object" },
        },
    })
}

/// An effect with its size and shape.
fn effect(kind: Effect) -> Value {
    let mut properties = Map::new();
    properties.insert("id".to_owned(), json!({ "const": kind.entry().id, "description": kind.entry().title }));
    let fields = kind.parameters().fields().iter().map(|each| (each.name.to_owned(), field(each)));
    let parameters: Map<String, Value> = fields.collect();
    let shape: Map<String, Value> = parameters.clone().into_iter().filter(|(name, _)| name != "size").collect();
    if !shape.is_empty() {
        properties.insert(
            "shape".to_owned(),
            json!({
                "type": "object", "additionalProperties": false, "properties": shape,
                "description": "Parameters beside the size; they may also stand beside it",
            }),
        );
    }
    properties.extend(parameters);
    properties.insert(
        "standard_error".to_owned(),
        json!({ "type": ["number", "string"], "description": "Standard error of the size, in its unit" }),
    );
    let mut scope = schema(&SCOPE, "scope");
    ["$schema", "title"].iter().for_each(|key| drop(scope.as_object_mut().and_then(|scope| scope.remove(*key))));
    properties.insert("scope".to_owned(), scope);
    json!({ "type": "object", "additionalProperties": false, "properties": properties, "required": ["id", "size"] })
}
