//! Setup files: stock and tools of a part program.

use crate::drawn::{CONTOUR, DXF, LAYER, PART, UNIT, not_of_contour, outline, part};
use crate::end::End;
use crate::engaged::{Outline, Stock};
use crate::gouge::Part;
use crate::holder::Holder;
use crate::limits::FeedLimits;
use crate::load::{Tool, ToolForce};
use crate::profile::Profile;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toolroom_contour::{Cutter, Machine, PARAMETER_SETS, Parameters, Point};
use toolroom_form::{Fault, Form, FormFile, Key, Kind, ReadError, Section, Value, Walk, parse, read};
use toolroom_program::Control;

/// Stock and tools of a part program.
///
/// ```
/// let text = r#"
/// schema = 1
/// [stock]
/// box = [["-5 mm", "-5 mm", "-20 mm"], ["65 mm", "65 mm", "0 mm"]]
/// [[tool]]
/// number = 3
/// diameter = "10 mm"
/// teeth = 4
/// "#;
/// let setup = toolroom_stock::Setup::parse("setup.toml", text, &[]).unwrap().content;
/// assert_eq!(setup.tools[&3].radius, 5e-3);
/// assert!((setup.stock.volume() - 0.07 * 0.07 * 0.02).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// What is cut.
    pub stock: Stock,
    /// The part that should be left, where the file has one.
    pub part: Option<Part>,
    /// Tools by their number in the program.
    pub tools: BTreeMap<u32, Tool>,
    /// Names of the tools that have one, by their number: those of a scenario, whose edges they wear.
    pub names: BTreeMap<u32, String>,
    /// Numbers of the tools whose end does not cut at its centre.
    pub hollow: BTreeSet<u32>,
    /// What the feed of each tool has to keep, by its number: the limits of its parameter set with those of the file.
    pub limits: BTreeMap<u32, FeedLimits>,
    /// Spindle speeds that a plan may choose for each tool, rad/s, by its number: those of the machine of its parameter set.
    pub speeds: BTreeMap<u32, Vec<f64>>,
    /// Origins of work offsets, X, Y and Z in mm, by the number of their code.
    pub origins: BTreeMap<u32, [f64; 3]>,
    /// Machine file or preset that the file names.
    pub drives: Option<String>,
    /// Cell of a grid of heights that the file gives, m.
    pub resolution: Option<f64>,
}

/// Cell of the grid over the smallest diameter where none is given (assumption; spec of this project).
const CELL: f64 = 0.02;

const FARTHEST: f64 = 100.0;
const PLACE: Kind = Kind::quantity("m", "mm", -FARTHEST, FARTHEST, "0 mm");
const CORNER: Kind = Kind::List(&PLACE);
const FEED: Kind = Kind::positive("m/s", "mm/min", 10.0, "2000 mm/min");
const SPEED: Kind = Kind::positive("rad/s", "rpm", 1e5, "8000 rpm");
const SMALL: Kind = Kind::positive("m", "um", 0.1, "50 um");
const OFFSET: Kind = Kind::quantity("m", "mm", 0.0, FARTHEST, "2 mm");
const LENGTH: Kind = Kind::positive("m", "mm", FARTHEST, "50 mm");

static CYLINDER: Form = Form {
    title: "cylinder",
    doc: "A round stock that stands along Z",
    keys: &[
        Key::required("diameter", LENGTH, "Diameter"),
        Key::required("height", LENGTH, "Height"),
        Key::default("base", PLACE, "0 mm", "Height of its lower face in the coordinates of the program"),
        Key::default("centre", CORNER, "[\"0 mm\", \"0 mm\"]", "Its axis, X and Y"),
    ],
};

/// Keys of a stock that is drawn.
const DRAWN: [&str; 3] = ["offset", "base", "height"];

static STOCK: Form = Form {
    title: "[stock]",
    doc: "What is cut, in the coordinates of the program: a box, a cylinder, or what a contour file or a drawing outlines",
    keys: &[
        Key::optional("box", Kind::List(&CORNER), "Least and greatest corner, X, Y and Z of each"),
        Key::optional("cylinder", Kind::Table(&CYLINDER), "A round stock"),
        CONTOUR,
        DXF,
        LAYER,
        UNIT,
        Key::optional(
            "offset",
            OFFSET,
            "How far the stock reaches beyond the contour or drawing; left out: not at all",
        ),
        Key::optional("base", PLACE, "Height of the lower face of such a stock in the coordinates of the program"),
        Key::optional("height", LENGTH, "Height of such a stock"),
        Key::optional(
            "resolution",
            Kind::positive("m", "mm", 0.1, "0.1 mm"),
            "Cell of the grid of heights where a tool has an end that is not flat, and for all tools where it is given; left out: a fiftieth of the smallest diameter",
        ),
    ],
};

/// Names of parameter sets, for messages.
const SETS: [&str; PARAMETER_SETS.len()] = {
    let mut names = [""; PARAMETER_SETS.len()];
    let mut i = 0;
    while i < PARAMETER_SETS.len() {
        names[i] = PARAMETER_SETS[i].0;
        i += 1;
    }
    names
};

static LIMITS: Form = Form {
    title: "[limits]",
    doc: "What planned feeds have to keep beside the limits of the parameter sets, or instead of them; for all tools, or for one",
    keys: &[
        Key::optional(
            "highest_feed",
            FEED,
            "Highest feed of the path; left out: that of the set, else that of the program",
        ),
        Key::optional(
            "highest_spindle_speed",
            SPEED,
            "Highest spindle speed that a plan with speeds commands; left out: that of the set",
        ),
        Key::optional("lowest_spindle_speed", SPEED, "Lowest such speed; left out: that of the set"),
        Key::optional("lowest_feed", FEED, "Lowest feed that a plan commands; left out: that of the set"),
        Key::optional("air_feed", FEED, "Feed where no material is within 1 mm; left out: the highest feed"),
        Key::optional(
            "power",
            Kind::positive("W", "kW", 1e6, "5 kW"),
            "Cutting power; left out: that of the set at the cutter",
        ),
        Key::optional(
            "feed_force",
            Kind::positive("N", "N", 1e7, "3000 N"),
            "Force on the cutter; left out: that of the set",
        ),
        Key::optional("deflection", SMALL, "Deflection of the tip across the path; left out: no limit"),
        Key::optional(
            "chip_thickness",
            SMALL,
            "Thickest chip; left out: the thickest that the tool cuts as programmed",
        ),
        Key::optional("least_chip_thickness", SMALL, "Chips below it are reported; left out: none"),
        Key::optional(
            "tool_life",
            Kind::positive("s", "min", 1e7, "60 min"),
            "Least life of the edges; left out: that of the set",
        ),
        Key::optional("roughness", SMALL, "Roughness Rz of walls; left out: no limit"),
    ],
};

static HOLDER: Form = Form {
    title: "holder",
    doc: "The holder of a tool: a cylinder whose lower face is at the tool's length above its tip",
    keys: &[Key::required("diameter", LENGTH, "Diameter")],
};

/// Forms of an end, in the order in which they are read.
const SHAPES: [&str; 4] = ["flat", "bull", "ball", "taper"];

static TOOL: Form = Form {
    title: "[[tool]]",
    doc: "An end mill",
    keys: &[
        Key::required("number", Kind::Count { min: 0, max: 99_999_999 }, "T of the program"),
        Key::optional("name", Kind::Name, "Name; in a shop that of the scenario's tool, whose edges it wears"),
        Key::required("diameter", LENGTH, "Diameter"),
        Key::required("teeth", Kind::Count { min: 1, max: 100 }, "Teeth"),
        Key::optional("length", LENGTH, "Length from the holder to the tip; left out: the overhang of the set"),
        Key::optional(
            "parameter_set",
            Kind::Choice(&SETS),
            "Set of contour milling whose edge forces and life it has; its shank bends with the diameter and length given here",
        ),
        Key::default(
            "shape",
            Kind::Choice(&SHAPES),
            "flat",
            "Form of the end: flat, bull with corner_radius, ball, or taper with tip_diameter and taper_angle",
        ),
        Key::optional(
            "corner_radius",
            LENGTH,
            "Radius of the corner of a bull end, no greater than that of the cutter",
        ),
        Key::optional("tip_diameter", LENGTH, "Diameter of a tapered end at its tip, less than that of the cutter"),
        Key::optional(
            "taper_angle",
            Kind::quantity("rad", "deg", 0.001, 1.5, "5 deg"),
            "Angle of a tapered end between its axis and its side",
        ),
        Key::default(
            "centre_cutting",
            Kind::Flag,
            "true",
            "Whether its end cuts at its centre; plunges of a tool that does not are reported",
        ),
        Key::optional(
            "holder",
            Kind::Table(&HOLDER),
            "What holds it, above its length: reported where it meets material",
        ),
        Key::optional("limits", Kind::Table(&LIMITS), "Limits of this tool, in place of those of the file"),
    ],
};

/// Codes of the work offsets, from 54 on.
const OFFSETS: [&str; 6] = ["G54", "G55", "G56", "G57", "G58", "G59"];

static ORIGINS: Form = Form {
    title: "[offsets]",
    doc: "Origins of the work offsets against each other; without them a program may cut in one of them alone",
    keys: &[
        Key::optional(
            OFFSETS[0],
            CORNER,
            "Origin, X, Y and Z, 0 if left out; the stock lies in the coordinates of G54",
        ),
        Key::optional(OFFSETS[1], CORNER, "Origin, X, Y and Z"),
        Key::optional(OFFSETS[2], CORNER, "Origin, X, Y and Z"),
        Key::optional(OFFSETS[3], CORNER, "Origin, X, Y and Z"),
        Key::optional(OFFSETS[4], CORNER, "Origin, X, Y and Z"),
        Key::optional(OFFSETS[5], CORNER, "Origin, X, Y and Z"),
    ],
};

/// Keys of a setup file of a part program.
pub static SETUP: Form = Form {
    title: "the setup of a part program",
    doc: "Stock and tools of a part program",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::optional("drives", Kind::Text, "Machine file, from the folder of this file, or a preset"),
        Key::required("stock", Kind::Table(&STOCK), "What is cut"),
        Key::optional("offsets", Kind::Table(&ORIGINS), "How the work offsets of the program lie to each other"),
        Key::optional("finished_part", Kind::Table(&PART), "The part that should be left"),
        Key::optional("limits", Kind::Table(&LIMITS), "What planned feeds have to keep"),
        Key::optional("tool", Kind::Tables(&TOOL), "Tools of the program"),
    ],
};

impl Setup {
    /// Reads a setup file with values replaced as after `--set`.
    ///
    /// # Errors
    /// [`ReadError`]: the file cannot be opened, or every fault found in it.
    pub fn read(path: &Path, set: &[String]) -> Result<FormFile<Self>, ReadError> {
        read(path, set, &SETUP, setup)
    }

    /// [`Setup::read`] of a text; `file` is its name in messages.
    ///
    /// # Errors
    /// [`ReadError`] with every fault found.
    pub fn parse(file: &str, text: &str, set: &[String]) -> Result<FormFile<Self>, ReadError> {
        parse(file, text, set, &SETUP, setup)
    }

    /// The machine file that a setup read from `file` names, from its folder unless it is a preset.
    pub fn machine_file(&self, file: &Path) -> Option<PathBuf> {
        let name = self.drives.as_deref()?;
        let beside = file.with_file_name(name);
        Some(if beside.exists() { beside } else { name.into() })
    }

    /// Tells a control what the setup says: diameters of the tools, how the work offsets lie, and that what is cut lies in one place.
    pub fn tell(&self, control: &mut Control) {
        control.diameters.extend(self.tools.iter().map(|(number, tool)| (*number, 2e3 * tool.radius)));
        control.origins.extend(&self.origins);
        control.one_place = true;
    }

    /// Cell of the grid of heights that the stock has to be, m; `None` where all tools are flat and no cell is given.
    pub fn cell(&self) -> Option<f64> {
        let flat = self.tools.values().all(|tool| tool.end.is_flat());
        let least = self.tools.values().map(|tool| 2.0 * tool.radius).reduce(f64::min);
        self.resolution.or(least.filter(|_| !flat).map(|diameter| CELL * diameter))
    }

    /// Greatest radius of a tool, m; 5 mm where there is none.
    pub fn radius(&self) -> f64 {
        self.tools.values().map(|tool| tool.radius).reduce(f64::max).unwrap_or(5e-3)
    }
}

/// The numbers of a list of quantities; `None` where a problem was noted.
fn numbers(value: &Value<'_>) -> Option<Vec<f64>> {
    let Value::List(list) = value else { return None };
    list.iter().map(|got| if let Value::Si(value) = got.value { Some(value) } else { None }).collect()
}

/// What is cut; `None` where a problem was noted.
fn stock(walk: &mut Walk, section: &Section<'_>) -> Option<Stock> {
    let wrong = |walk: &mut Walk, key: &str, expected: &str, example: &str| {
        let (read, expected, example) = ("other values".to_owned(), expected.to_owned(), example.to_owned());
        walk.fault(section.span_of(key), Fault::WrongType { key: key.to_owned(), read, expected, example });
    };
    let example = "[[\"0 mm\", \"0 mm\", \"-20 mm\"], [\"60 mm\", \"40 mm\", \"0 mm\"]]";
    let given: Vec<&str> = ["box", "cylinder", "contour", "dxf"].into_iter().filter(|key| section.given(key)).collect();
    let [kind] = given[..] else {
        wrong(walk, given.get(1).unwrap_or(&"box"), "one of a box, a cylinder, a contour and a drawing", example);
        return None;
    };
    let drawn = kind == "contour" || kind == "dxf";
    not_of_contour(walk, section, kind);
    for key in DRAWN.into_iter().filter(|key| !drawn && section.given(key)) {
        let (case, applicable) = (format!("a stock with `{kind}`"), "a stock with `contour` or `dxf`".to_owned());
        walk.fault(section.span_of(key), Fault::NotApplicable { key, case, applicable });
    }
    match kind {
        "box" => {
            let corners: Option<Vec<Vec<f64>>> = section.list("box").iter().map(|got| numbers(&got.value)).collect();
            if let [low, high] = corners?.as_slice()
                && let ([x0, y0, z0], [x1, y1, z1]) = (low.as_slice(), high.as_slice())
                && x0 < x1
                && y0 < y1
                && z0 < z1
            {
                let outline = Outline::Box(Point { x: *x0, y: *y0 }, Point { x: *x1, y: *y1 });
                return Some(Stock { outline, base: *z0, top: *z1 });
            }
            wrong(walk, "box", "the least and the greatest corner, X, Y and Z of each", example);
            None
        }
        "cylinder" => {
            let table = walk.table(section, "cylinder")?;
            let (diameter, height, base) = (table.si("diameter")?, table.si("height")?, table.si("base")?);
            if let [x, y] = table.numbers("centre")?[..] {
                let outline = Outline::Circle(Point { x, y }, 0.5 * diameter);
                return Some(Stock { outline, base, top: base + height });
            }
            wrong(walk, "cylinder", "a centre of X and Y", "[\"0 mm\", \"0 mm\"]");
            None
        }
        _ => {
            for (key, example) in [("base", "\"-20 mm\""), ("height", "\"20 mm\"")] {
                if !section.given(key) {
                    let (section_path, example) = (section.path.clone(), example.to_owned());
                    walk.fault(section.span_of(kind), Fault::MissingKey { section: section_path, key, example });
                }
            }
            let sections = outline(walk, section, kind)?;
            let (base, height) = (section.si("base")?, section.si("height")?);
            let profile = Profile::new(&sections, section.si("offset").unwrap_or(0.0));
            Some(Stock { outline: Outline::Profile(Arc::new(profile)), base, top: base + height })
        }
    }
}

/// Limits with those that a table gives in place of theirs.
fn limited(mut limits: FeedLimits, table: Option<&Section<'_>>, floor: f64) -> FeedLimits {
    let Some(table) = table else { return limits };
    let given = |key: &str, limit: &mut Option<f64>| *limit = table.si(key).or(*limit);
    given("highest_feed", &mut limits.highest_feed);
    given("air_feed", &mut limits.air_feed);
    given("power", &mut limits.power);
    given("feed_force", &mut limits.feed_force);
    given("deflection", &mut limits.deflection);
    given("chip_thickness", &mut limits.chip_thickness);
    given("tool_life", &mut limits.tool_life);
    limits.lowest_feed = table.si("lowest_feed").unwrap_or(limits.lowest_feed);
    limits.least_chip_thickness = table.si("least_chip_thickness").unwrap_or(limits.least_chip_thickness);
    limits.roughness = table.si("roughness").map(|roughness| (roughness, floor)).or(limits.roughness);
    limits
}

/// The form of the end of a tool of this radius, m; `None` where a problem was noted.
fn end(walk: &mut Walk, section: &Section<'_>, radius: f64) -> Option<End> {
    let mut wrong = |key: &str, read: &str, expected: &str, example: &str| {
        let [key, read, expected, example] = [key, read, expected, example].map(str::to_owned);
        let at = if section.given(&key) { key.as_str() } else { "shape" };
        walk.fault(section.span_of(at), Fault::WrongType { key: key.clone(), read, expected, example });
        None
    };
    let shape = section.text("shape").unwrap_or(SHAPES[0]);
    let keys = ["corner_radius", "tip_diameter", "taper_angle"];
    let due: &[&str] = match shape {
        "bull" => &keys[..1],
        "taper" => &keys[1..],
        _ => &[],
    };
    for key in keys {
        match (section.si(key), due.contains(&key)) {
            (None, true) => return wrong(key, "nothing", &format!("a value for a {shape} end"), "\"1 mm\""),
            (Some(_), false) => {
                return wrong(key, "a value", &format!("no value for a {shape} end"), "shape = \"bull\"");
            }
            (Some(_), true) | (None, false) => {}
        }
    }
    match shape {
        "ball" => Some(End::Corner(radius)),
        "bull" => match section.si("corner_radius")? {
            corner if corner <= radius => Some(End::Corner(corner)),
            _ => wrong("corner_radius", "more than the radius of the cutter", "at most that radius", "\"1 mm\""),
        },
        "taper" => match 0.5 * section.si("tip_diameter")? {
            tip if tip < radius => Some(End::Taper(tip, section.si("taper_angle")?)),
            _ => wrong("tip_diameter", "no less than the diameter", "a diameter below that of the cutter", "\"2 mm\""),
        },
        _ => Some(End::Flat),
    }
}

fn setup(walk: &mut Walk, root: &Section<'_>) -> Option<Setup> {
    let blank = walk.table(root, "stock");
    let resolution = blank.as_ref().and_then(|section| section.si("resolution"));
    let stock = blank.and_then(|section| stock(walk, &section));
    let part = walk.table(root, "finished_part").and_then(|section| part(walk, &section));
    let shared = walk.table(root, "limits");
    let (mut tools, mut names, mut hollow) = (BTreeMap::new(), BTreeMap::new(), BTreeSet::new());
    let (mut limits, mut speeds) = (BTreeMap::new(), BTreeMap::new());
    for section in walk.sections(root, "tool", None) {
        let set = section.text("parameter_set").and_then(|name| Parameters::named(name).ok());
        let of_tool = walk.table(&section, "limits");
        let holder = walk.table(&section, "holder").and_then(|table| table.si("diameter"));
        if holder.is_some() && section.si("length").is_none() {
            let (key, expected) =
                ("length".to_owned(), "the length from the holder to the tip, since a holder is given".to_owned());
            let (read, example) = ("nothing".to_owned(), "\"60 mm\"".to_owned());
            walk.fault(section.span_of("holder"), Fault::WrongType { key, read, expected, example });
        }
        let (Some(number), Some(diameter), Some(teeth)) =
            (section.count("number"), section.si("diameter"), section.count("teeth"))
        else {
            continue;
        };
        let overhang = section.si("length").or(set.as_ref().map(|set| set.cutter.overhang));
        let base = match (&set, overhang) {
            (Some(set), Some(overhang)) => FeedLimits::from_parameters(set, diameter, overhang),
            (None, _) | (_, None) => FeedLimits::default(),
        };
        let floor = set.as_ref().map_or(0.0, |set| set.cutter.roughness_floor);
        let base = limited(base, shared.as_ref(), floor);
        limits.insert(number as u32, limited(base, of_tool.as_ref(), floor));
        if let Some(set) = &set {
            let of = |table: Option<&Section<'_>>, key: &str| table.and_then(|table| table.si(key));
            let given = |key: &str| of(of_tool.as_ref(), key).or(of(shared.as_ref(), key));
            let machine = Machine {
                lowest_spindle_speed: given("lowest_spindle_speed").unwrap_or(set.machine.lowest_spindle_speed),
                highest_spindle_speed: given("highest_spindle_speed").unwrap_or(set.machine.highest_spindle_speed),
                ..set.machine
            };
            speeds.insert(number as u32, machine.spindle_speeds());
        }
        let force = set.map(|set| {
            let overhang = overhang.unwrap_or(set.cutter.overhang);
            let cutter = Cutter { diameter, teeth: teeth as f64, overhang, ..set.cutter };
            ToolForce { edge: set.force, stiffness: cutter.stiffness(), life: set.life }
        });
        if let Some(name) = section.text("name") {
            names.insert(number as u32, name.to_owned());
        }
        let holder = holder.zip(section.si("length"));
        let holder = holder.map(|(diameter, overhang)| Holder { radius: 0.5 * diameter, overhang });
        if section.flag("centre_cutting") == Some(false) {
            hollow.insert(number as u32);
        }
        let Some(end) = end(walk, &section, 0.5 * diameter) else { continue };
        tools.insert(number as u32, Tool { radius: 0.5 * diameter, end, teeth: teeth as f64, force, holder });
    }
    let mut origins = BTreeMap::new();
    if let Some(section) = walk.table(root, "offsets") {
        for (code, key) in (54..).zip(OFFSETS).filter(|(_, key)| section.given(key)) {
            match section.numbers(key).as_deref() {
                Some([x, y, z]) => {
                    origins.insert(code, [x, y, z].map(|place| 1e3 * place));
                }
                _ => {
                    let (read, expected) = ("other values".to_owned(), "X, Y and Z".to_owned());
                    let example = "[\"100 mm\", \"0 mm\", \"0 mm\"]".to_owned();
                    walk.fault(section.span_of(key), Fault::WrongType { key: key.to_owned(), read, expected, example });
                }
            }
        }
    }
    let drives = root.text("drives").map(str::to_owned);
    Some(Setup { stock: stock?, part, tools, names, hollow, limits, speeds, origins, drives, resolution })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(tool: &str) -> Result<Setup, String> {
        let text = format!(
            "schema = 1\n[stock]\nbox = [[\"0 mm\", \"0 mm\", \"-20 mm\"], [\"60 mm\", \"40 mm\", \"0 mm\"]]\n\
             [[tool]]\nnumber = 1\ndiameter = \"10 mm\"\nteeth = 2\n{tool}\n"
        );
        Setup::parse("setup.toml", &text, &[]).map(|file| file.content).map_err(|error| error.to_string())
    }

    #[test]
    fn ends_are_read_with_what_they_need_and_nothing_else() {
        let end = |tool: &str| read(tool).expect("a setup").tools[&1].end;
        assert_eq!(end(""), End::Flat);
        assert_eq!(end("shape = \"ball\""), End::Corner(5e-3));
        assert_eq!(end("shape = \"bull\"\ncorner_radius = \"1 mm\""), End::Corner(1e-3));
        assert_eq!(
            end("shape = \"taper\"\ntip_diameter = \"4 mm\"\ntaper_angle = \"45 deg\""),
            End::Taper(2e-3, 0.25 * std::f64::consts::PI)
        );
        assert_eq!(read("shape = \"ball\"").expect("a setup").cell(), Some(0.2e-3));
        assert_eq!(read("").expect("a setup").cell(), None);
        for (tool, key) in [
            ("shape = \"bull\"", "corner_radius"),
            ("shape = \"bull\"\ncorner_radius = \"6 mm\"", "corner_radius"),
            ("corner_radius = \"1 mm\"", "corner_radius"),
            ("shape = \"taper\"\ntip_diameter = \"10 mm\"\ntaper_angle = \"5 deg\"", "tip_diameter"),
            ("shape = \"taper\"\ntip_diameter = \"4 mm\"", "taper_angle"),
            ("shape = \"ball\"\ntaper_angle = \"5 deg\"", "taper_angle"),
        ] {
            let error = read(tool).expect_err("a fault");
            assert!(error.contains(key), "{tool}: {error}");
        }
    }

    #[test]
    fn two_parts_in_two_work_offsets_are_cut_where_they_lie_or_not_at_all() {
        let text =
            "G21 G90 T1 M6\nS3000 M3\nG54 G0 X-8. Y10. Z-4.\nG1 X30. F400\nG0 Z5.\nG55 X-8. Y10.\nZ-4.\nG1 X30.\nM30\n";
        let removed = |setup: &str| {
            let setup = read(setup).expect("a setup");
            let mut control = Control::default();
            setup.tell(&mut control);
            let mut follower = crate::Follower::new(&setup);
            for event in toolroom_program::Run::new(text, &control).map_err(|error| error.to_string())? {
                let kind = event.map_err(|error| error.to_string())?.kind;
                if let toolroom_program::EventKind::ToolChange(tool) = kind {
                    follower.change(tool);
                }
                if let toolroom_program::EventKind::Motion(motion) = kind {
                    follower.motion(&motion).map_err(|error| error.to_string())?;
                }
            }
            Ok::<f64, String>(1e9 * follower.cutting().removed())
        };
        let slot = 4.0 * (10.0 * 30.0 + 0.5 * std::f64::consts::PI * 25.0);
        // G55 lies 20 mm behind G54, so that there are two slots.
        let two = removed("[offsets]\nG55 = [\"0 mm\", \"20 mm\", \"0 mm\"]").expect("two parts");
        assert!((two - 2.0 * slot).abs() < 1e-3 * slot, "{two} mm3, {slot}");
        let refused = removed("").expect_err("nobody knows where the second lies");
        assert!(refused.contains("8:") && refused.contains("[offsets]"), "{refused}");
        for wrong in ["G55 = [\"0 mm\", \"20 mm\"]", "G60 = [\"0 mm\", \"20 mm\", \"0 mm\"]"] {
            assert!(read(&format!("[offsets]\n{wrong}")).is_err(), "{wrong}");
        }
    }
}
