//! The keys of a parameter set file.

use super::material::{ISO_513, MATERIAL_GROUPS};
use serde_json::{Map, Value, json};
use toolroom_form::{Content, Form, Key, Kind};
use toolroom_process::Field;

/// A parameter set: constants of one tool in one work material, each with its source.
pub static PARAMETER_SET: Form = Form {
    title: "the parameter set",
    doc: "Constants of one tool in one work material, each with its source",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::required("name", Kind::Name, "Name of the set"),
        Key::required("title", Kind::Text, "One line for people"),
        Key::optional(
            "process",
            Kind::Choice(&["turning", "milling"]),
            "Process that the set is for; left out, told by its groups",
        ),
        Key::optional(
            "based_on",
            Kind::Text,
            "Shipped set or path of a file that gives every value that this file leaves out",
        ),
        Key::optional("law", Kind::Choice(&LAWS), "Wear law; left out, the one whose group is given"),
        Key::optional("material", Kind::Table(&MATERIAL), "Work material, for what nothing else gives"),
        Key::optional("handbook", Kind::Table(&HANDBOOK), "Constants as handbooks and tests give them"),
        Key::optional("parameters", Kind::Content(&PARAMETERS), "Values by group, each with its source"),
        Key::optional("prior", Kind::Content(&PRIOR), "How well values are known, for a calibration"),
        Key::optional("scatter", crate::Scatter::<f64>::KIND, "Scatter of tools of this set that state none"),
    ],
};

/// The words of the wear laws, of which turning alone has several.
static LAWS: [&str; 4] = crate::TURNING_SETS.law_names();

static MATERIAL: Form = Form {
    title: "material",
    doc: "The work material by its classification",
    keys: &[
        Key::optional("iso513", Kind::Choice(ISO_513), "ISO 513 letter of the application group"),
        Key::optional("vdi3323", Kind::Count { min: 1, max: MATERIAL_GROUPS as u64 }, "VDI 3323 material group"),
        Key::optional("hardness", Kind::Text, "Hardness, for people"),
    ],
};

/// Constants of handbooks and tests, in the set of a file or of a tool.
pub static HANDBOOK: Form = Form {
    title: "[handbook]",
    doc: "Constants as handbooks and tests give them; converted when the set is read",
    keys: &[
        Key::optional("taylor", Kind::Table(&TAYLOR), "Extended Taylor law"),
        Key::optional("kienzle", Kind::Table(&KIENZLE), "Specific cutting force of Kienzle"),
        Key::optional("lives", Kind::Tables(&LIFE), "Tool lives of a test (ISO 3685)"),
        Key::optional("one_life", Kind::Table(&ONE_LIFE), "About how long an edge lasts at one cut"),
    ],
};

/// `v = C / (T^m ap^x f^y)`, speed in terms of life.
pub(super) const SPEED_FORM: &str = "v = C / (T^m ap^x f^y)";
/// `v T^n f^a ap^b = C`, the product form.
pub(super) const PRODUCT_FORM: &str = "v T^n f^a ap^b = C";

pub(super) static TAYLOR: Form = Form {
    title: "handbook, taylor",
    doc: "Extended Taylor law; depth and feed in mm, life in life_unit",
    keys: &[
        Key::required("form", Kind::Choice(&[SPEED_FORM, PRODUCT_FORM]), "How the constants are meant"),
        Key::required("C", SPEED, "Speed at which an edge lasts one life_unit at 1 mm of depth and feed"),
        Key::required("m", LIFE_EXPONENT, "Exponent of life, below 1").when("form", &[SPEED_FORM]),
        Key::required("x", RATIO_OR_ZERO, "Exponent of depth of cut; 0 where the law has none")
            .when("form", &[SPEED_FORM]),
        Key::required("y", RATIO_OR_ZERO, "Exponent of feed; 0 where the law has none").when("form", &[SPEED_FORM]),
        Key::required("n", LIFE_EXPONENT, "Exponent of life, below 1").when("form", &[PRODUCT_FORM]),
        Key::optional("a", RATIO_OR_ZERO, "Exponent of feed").when("form", &[PRODUCT_FORM]),
        Key::optional("b", RATIO_OR_ZERO, "Exponent of depth of cut").when("form", &[PRODUCT_FORM]),
        Key::default("life_unit", Kind::Choice(&["min", "s"]), "min", "Unit in which C counts the life"),
        Key::optional("wear_limit", LENGTH, "Flank wear at the end of the life"),
        Key::required("source", Kind::Text, "Where the constants come from"),
    ],
};

pub(super) static KIENZLE: Form = Form {
    title: "handbook, kienzle",
    doc: "F_c = kc11·b·h^(1 - mc) with thickness h and width b of the uncut chip",
    keys: &[
        Key::required("kc11", STRESS, "Specific force of a chip of 1 mm by 1 mm"),
        Key::required("mc", RATIO, "Exponent of chip thickness"),
        Key::optional("cutting_edge_angle", ANGLE, "Angle between cutting edge and feed; left out, that of the set"),
        Key::optional("rake_angle", ANGLE, "Rake angle; the force falls by 1.5 % a degree above rake_reference"),
        Key::default("rake_reference", ANGLE, "6 deg", "Rake angle at which kc11 was measured"),
        Key::required("source", Kind::Text, "Where the constants come from"),
    ],
};

pub(super) static LIFE: Form = Form {
    title: "[[handbook.lives]]",
    doc: "The life of one edge",
    keys: &[
        Key::required("cutting_speed", SPEED, "Cutting speed"),
        Key::required("life", TIME, "Time in cut until the wear limit"),
        Key::optional("feed", LENGTH, "Feed per revolution; left out, that of the set's reference cut"),
        Key::optional("depth_of_cut", LENGTH, "Depth of cut; left out, that of the set's reference cut"),
        Key::optional("wear_limit", LENGTH, "Flank wear at the end of the life"),
        Key::optional("source", Kind::Text, "Where the life comes from"),
    ],
};

pub(super) static ONE_LIFE: Form = Form {
    title: "handbook, one_life",
    doc: "About how long an edge lasts at one cut; exponents are assumed from the tool material",
    keys: &[
        Key::required("life", TIME, "Time in cut until the wear limit"),
        Key::required("cutting_speed", SPEED, "Cutting speed"),
        Key::optional("feed", LENGTH, "Feed per revolution; left out, that of the set's reference cut"),
        Key::optional("depth_of_cut", LENGTH, "Depth of cut; left out, that of the set's reference cut"),
        Key::default("tool_material", Kind::Choice(super::one_life::ToolMaterial::WORDS), "carbide", "Tool material"),
        Key::optional("wear_limit", LENGTH, "Flank wear at the end of the life"),
        Key::optional("source", Kind::Text, "Who says so"),
    ],
};

const SPEED: Kind = Kind::quantity("m/s", "m/min", 1e-3, 500.0, "420 m/min");
const TIME: Kind = Kind::quantity("s", "min", 1.0, 1e7, "15 min");
const LENGTH: Kind = Kind::quantity("m", "mm", 1e-6, 20e-3, "0.3 mm");
const STRESS: Kind = Kind::quantity("Pa", "N/mm2", 1e7, 2e10, "1700 N/mm2");
const ANGLE: Kind = Kind::quantity("rad", "deg", -0.6, 2.0, "45 deg");
const RATIO: Kind = Kind::quantity("1", "1", 0.01, 1.0, "0.25");
/// An exponent of life; above 1 it is the inverse that is stated, which is answered where it is read.
const LIFE_EXPONENT: Kind = Kind::quantity("1", "1", 0.01, 20.0, "0.25");
const RATIO_OR_ZERO: Kind = Kind::quantity("1", "1", 0.0, 5.0, "0.2");

/// A parameter with its source, as files write it.
fn entry(field: &Field) -> Value {
    json!({
        "type": "object",
        "required": ["value", "source"],
        "additionalProperties": false,
        "properties": { "value": toolroom_form::field(field), "source": { "type": "string", "minLength": 1 } },
    })
}

static PARAMETERS: Content = Content {
    expected: "groups of parameters",
    example: "{ limits = { wear_limit = { value = \"0.3 mm\", source = \"our rule\" } } }",
    // Groups of milling are not listed: that room stands above this one.
    schema: || {
        let group = |fields: &[Field]| -> Value {
            let entries: Map<String, Value> =
                fields.iter().map(|field| (field.name.to_owned(), entry(field))).collect();
            json!({ "type": "object", "properties": entries })
        };
        let groups: Map<String, Value> =
            crate::TURNING_SETS.groups.iter().map(|each| (each.name.to_owned(), group(each.fields))).collect();
        json!({ "type": "object", "properties": groups })
    },
    entry: None,
};

pub(super) static PRIOR: Content = Content {
    expected: "a table of parameters with a factor or a deviation",
    example: "{ \"extended_taylor.speed_exponent\" = { factor = 1.35 } }",
    schema: || {
        let positive = json!({ "type": "number", "exclusiveMinimum": 0.0 });
        json!({
            "type": "object",
            "additionalProperties": {
                "type": "object",
                "additionalProperties": false,
                "properties": { "factor": { "type": "number", "exclusiveMinimum": 1.0 }, "deviation": positive },
            },
        })
    },
    entry: None,
};
