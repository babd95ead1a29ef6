//! Structure files: the modes of machine and tool that a tap test has found, in a file of their own.

use super::keys::{DAMPING_RATIO, FREQUENCY, STIFFNESS};
use super::pair::direction;
use super::tapped;
use std::path::{Path, PathBuf};
use toolroom_chatter::{Mode, PathModes, Scatter, SpeedModes};
use toolroom_form::{Content, ContentFault, Fault, Form, FormFile, Key, Kind, ReadError, Section, Walk, significant};
use toolroom_process::unit::convert;

/// Natural frequency of the mode that stands for all modes above the range, over the highest one of the file: its
/// compliance is 10 % more than the residual at the highest mode and 1 % more at a third of that frequency, and a residual is
/// itself a few hundredths of the compliance. Farther up the period map of milling would have to resolve shorter waves.
const ABOVE: f64 = 10.0 / 3.0;
/// Damping ratio of that mode (assumption: between that of a tool and that of a joint; at a tenth of its frequency it turns
/// the compliance by 0.02 rad).
const ABOVE_DAMPING: f64 = 0.1;

/// The whole file.
pub static STRUCTURE: Form = Form {
    title: "the structure file",
    doc: "Vibration modes of machine and tool as a tap test has found them, for `structure` of lobes files",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::required("name", Kind::Name, "Short name"),
        Key::optional("measurement", Kind::Table(&MEASUREMENT), "Where the modes come from"),
        Key::optional("mode", Kind::Tables(&FITTED_MODE), "Vibration modes at the point of cut"),
        Key::optional(
            "speed",
            Kind::Tables(&SPEED),
            "In place of [[mode]]: the modes at several spindle speeds, ascending, where they change with the speed",
        ),
        Key::optional(
            "station",
            Kind::Tables(&STATION),
            "In place of [[mode]]: the modes at several places along the path of the tool, as of a thin wall; the worst \
             place counts",
        ),
        Key::optional(
            "table",
            Kind::Text,
            "Measured frequency responses, whose own limit `lobes` puts beside that of the modes; where this file has no modes \
             they are fitted to it. The path counts from this file",
        ),
        Key::optional(
            "mass_loss",
            Kind::quantity("1", "1", 0.0, 0.9, "0.1"),
            "Beside [[station]]: share of the modal masses that the cut has removed at the end of the path",
        ),
        Key::optional("residual", Kind::Table(&RESIDUAL), "What the modes above the measured range give way"),
        Key::optional("covariance", Kind::Table(&COVARIANCE), "Covariance of all values of the modes"),
    ],
};

static MEASUREMENT: Form = Form {
    title: "[measurement]",
    doc: "Where the modes come from",
    keys: &[
        Key::default("source", Kind::Text, "", "Measured file and the command that fitted it"),
        Key::default("quality", Kind::Text, "", "What the fit says of itself"),
    ],
};

static SPEED: Form = Form {
    title: "[[speed]]",
    doc: "The modes at one spindle speed: at every speed the same modes, in the same order",
    keys: &[
        Key::required("spindle_speed", Kind::positive("rad/s", "rpm", 1e6, "6000 rpm"), "Spindle speed of the tap"),
        Key::required("mode", Kind::Tables(&FITTED_MODE), "Vibration modes at the point of cut"),
    ],
};

static STATION: Form = Form {
    title: "[[station]]",
    doc: "The modes at one place of the path: at every place the same modes, in the same order",
    keys: &[
        Key::required("position", Kind::quantity("m", "mm", -100.0, 100.0, "40 mm"), "Place along the path"),
        Key::required("mode", Kind::Tables(&FITTED_MODE), "Vibration modes with the cut at this place"),
    ],
};

static FITTED_MODE: Form = Form {
    title: "[[mode]]",
    doc: "One vibration mode at the point of cut",
    keys: &[
        Key::optional("name", Kind::Name, "Name, for --set mode.NAME.stiffness.value=…"),
        Key::required(
            "direction",
            Kind::List(&Kind::quantity("1", "1", -1e6, 1e6, "1")),
            "Two components: (feed, normal to it) in milling, (chip thickness, cutting speed) in turning",
        ),
        Key::required("natural_frequency", Kind::Table(&FREQUENCY_FORM), "Undamped natural frequency"),
        Key::required("damping_ratio", Kind::Table(&DAMPING_FORM), "Share of critical damping"),
        Key::required("stiffness", Kind::Table(&STIFFNESS_FORM), "Modal stiffness"),
        Key::optional(
            "rotation",
            Kind::quantity("1/m", "1/m", -1e4, 1e4, "-9 1/m"),
            "Slope over displacement of a base that `toolroom swap` puts a tool on",
        ),
    ],
};

static FREQUENCY_FORM: Form = Form {
    title: "natural_frequency",
    doc: "Natural frequency with its standard deviation",
    keys: &[
        Key::required("value", FREQUENCY, "The value"),
        Key::default("sd", Kind::quantity("Hz", "Hz", 0.0, 1e6, "2 Hz"), "0 Hz", "Its standard deviation"),
    ],
};

static DAMPING_FORM: Form = Form {
    title: "damping_ratio",
    doc: "Damping ratio with its standard deviation",
    keys: &[
        Key::required("value", DAMPING_RATIO, "The value"),
        Key::default("sd", Kind::quantity("1", "1", 0.0, 1.0, "0.001"), "0", "Its standard deviation"),
    ],
};

static STIFFNESS_FORM: Form = Form {
    title: "stiffness",
    doc: "Modal stiffness with its standard deviation",
    keys: &[
        Key::required("value", STIFFNESS, "The value"),
        Key::default("sd", Kind::quantity("N/m", "N/um", 0.0, 1e12, "1 N/um"), "0 N/um", "Its standard deviation"),
    ],
};

const COMPLIANCE: Kind = Kind::quantity("m/N", "um/N", -1.0, 1.0, "0.002 um/N");

static RESIDUAL: Form = Form {
    title: "[residual]",
    doc: "Static compliance of all modes above the measured range",
    keys: &[
        Key::default("upper_xx", COMPLIANCE, "0 um/N", "In the first direction"),
        Key::default("upper_xy", COMPLIANCE, "0 um/N", "Of one direction under a force in the other"),
        Key::default("upper_yy", COMPLIANCE, "0 um/N", "In the second direction"),
    ],
};

static COVARIANCE: Form = Form {
    title: "[covariance]",
    doc: "Covariance of all values, in Hz, 1 and N/m",
    keys: &[
        Key::required("names", Kind::List(&Kind::Text), "Modes and their keys, such as m1.stiffness"),
        Key::required("matrix", Kind::Content(&MATRIX), "One row a name"),
    ],
};

static MATRIX: Content = Content {
    expected: "a list of rows",
    example: "[[0.01, 0], [0, 1e-8]]",
    schema: || serde_json::json!({ "type": "array", "items": { "type": "array", "items": { "type": "number" } } }),
    entry: None,
};

/// A structure file that could not be read.
#[derive(Clone, Debug, thiserror::Error)]
#[error("structure \"{file}\": {reason}")]
pub(super) struct StructureFault {
    /// The file.
    file: String,
    /// What is wrong.
    reason: String,
    /// What would do.
    fix: String,
}

impl ContentFault for StructureFault {
    fn code(&self) -> &'static str {
        "structure"
    }

    fn fix(&self) -> Option<String> {
        Some(self.fix.clone())
    }
}

/// What a structure file says.
#[derive(Clone, Debug)]
pub struct Structure {
    /// Short name.
    pub name: String,
    /// The modes; what the modes above the range give way is a stiff mode, or two of them, at the end.
    pub modes: Vec<Mode>,
    /// The same by spindle speed, where the modes change with it; `modes` are then those of the least speed.
    pub by_speed: Option<SpeedModes>,
    /// The same along the path of the tool, where the modes change on it; `modes` are then those of its first station.
    pub along_path: Option<PathModes>,
    /// Measured responses whose own limit stands beside that of the modes.
    pub table: Option<PathBuf>,
    /// Slope over displacement (1/m) of the modes of the file, where it is given.
    pub rotations: Vec<Option<f64>>,
    /// Relative standard deviations, of the least known mode each; none where the file has none.
    pub scatter: Option<Scatter>,
    /// Relative standard deviation of the least known stiffness.
    pub stiffness_deviation: f64,
    /// Relative standard deviations of frequency, damping ratio and stiffness of every mode of the file.
    pub deviations: Vec<[f64; 3]>,
}

/// Relative standard deviation of a cutting-force coefficient from a table (assumption, usual for a work material that was
/// not tested itself). The stiffness of a mode acts on stability as the coefficients do, and adds to it.
const COEFFICIENTS: f64 = 0.15;

/// Reads a structure file; `overrides` are `path=value` as after `--set`.
///
/// # Errors
/// As [`file::read`](toolroom_form::read).
pub fn read_structure(path: &Path, overrides: &[String]) -> Result<FormFile<Structure>, ReadError> {
    toolroom_form::read(path, overrides, &STRUCTURE, resolve)
}

/// The structure file that a lobes file names.
pub(super) fn named(walk: &mut Walk, root: &Section<'_>) -> Option<Structure> {
    let name = root.text("structure")?.to_owned();
    let path = walk.folder.join(&name);
    walk.named(path.clone());
    match read_structure(&path, &[]) {
        Ok(file) => Some(file.content),
        Err(error) => {
            let file = path.display().to_string();
            let fix = format!(
                "give a structure file of `toolroom modes`; `toolroom check {file}` tells its faults line by line"
            );
            let fault = StructureFault { file, reason: error.to_string(), fix };
            walk.fault(root.span_of("structure"), Fault::Content(std::sync::Arc::new(fault)));
            None
        }
    }
}

/// A mode, and the relative standard deviations of frequency, damping and stiffness.
type Estimated = (Mode, [f64; 3]);
/// The modes at one speed, and these of each.
type Row = (Vec<Mode>, Vec<[f64; 3]>);

fn resolve(walk: &mut Walk, root: &Section<'_>) -> Option<Structure> {
    let table_path = root.text("table").map(|name| walk.folder.join(name));
    if let Some(path) = &table_path {
        walk.named(path.clone());
    }
    let plain = walk.sections(root, "mode", None);
    let speeds = walk.sections(root, "speed", None);
    let stations = walk.sections(root, "station", None);
    let by_row = [&speeds, &stations]
        .map(|rows| rows.iter().map(|row| walk.sections(row, "mode", None)).collect::<Vec<Vec<Section<'_>>>>());
    if let Some(path) = table_path.as_ref().filter(|_| plain.is_empty() && speeds.is_empty() && stations.is_empty()) {
        return of_table(walk, root, path);
    }
    one_place(walk, root, [("mode", plain.len()), ("speed", speeds.len()), ("station", stations.len())])?;
    if root.given("mass_loss") && stations.is_empty() {
        let example = "[[station]] with position and its modes".to_owned();
        let section = "a structure file with mass_loss".to_owned();
        walk.fault(root.span_of("mass_loss"), Fault::MissingKey { section, key: "station", example });
        return None;
    }
    let rows: Vec<&[Section<'_>]> =
        if plain.is_empty() { by_row.iter().flatten().map(Vec::as_slice).collect() } else { vec![&plain[..]] };
    let modes: Vec<Vec<Option<Estimated>>> =
        rows.iter().map(|sections| sections.iter().map(|section| mode(walk, section)).collect()).collect();
    for described in ["measurement", "covariance"] {
        walk.table(root, described);
    }
    let residual = walk.table(root, "residual");
    let upper = residual.map_or(Some([0.0; 3]), |section| {
        Some([section.si("upper_xx")?, section.si("upper_xy")?, section.si("upper_yy")?])
    });
    let rotations = rows[0].iter().map(|section| section.si("rotation")).collect();
    let mut known: Vec<Row> = modes
        .into_iter()
        .map(|row| Some(row.into_iter().collect::<Option<Vec<_>>>()?.into_iter().unzip()))
        .collect::<Option<_>>()?;
    let name = root.text("name")?.to_owned();
    let all: Vec<Mode> = known.iter().flat_map(|(modes, _)| modes).copied().collect();
    let greatest = |i: usize| known.iter().flat_map(|(_, sds)| sds).map(|sd| sd[i]).fold(0.0, f64::max).min(1.0);
    let [natural_frequency, damping_ratio, stiffness] = [0, 1, 2].map(greatest);
    let uncertain = natural_frequency > 0.0 || damping_ratio > 0.0 || stiffness > 0.0;
    let coefficients = COEFFICIENTS.hypot(stiffness).min(1.0);
    let scatter = uncertain.then_some(Scatter { natural_frequency, damping_ratio, coefficients });
    // One compliance above the range stands at all speeds.
    let above = stiff_modes(&all, upper?);
    known.iter_mut().for_each(|(modes, _)| modes.extend(&above));
    let rows = table(walk, &speeds, &known, &SPEEDS)?;
    let by_speed = if rows.is_empty() { None } else { Some(SpeedModes::new(rows).ok()?) };
    let rows = table(walk, &stations, &known, &STATIONS)?;
    let mass_loss = root.si("mass_loss").unwrap_or(0.0);
    let along_path = if rows.is_empty() { None } else { Some(PathModes::new(rows, mass_loss).ok()?) };
    let (modes, deviations) = known.swap_remove(0);
    Some(Structure {
        name,
        modes,
        by_speed,
        along_path,
        table: table_path,
        rotations,
        scatter,
        stiffness_deviation: stiffness,
        deviations,
    })
}

/// The structure whose modes are fitted to a table; it has nothing beside the table but a name.
fn of_table(walk: &mut Walk, root: &Section<'_>, path: &Path) -> Option<Structure> {
    for described in ["measurement", "covariance", "residual"] {
        walk.table(root, described);
    }
    let name = root.text("name")?.to_owned();
    let fitted = tapped::structure(&name, path).and_then(|text| {
        let file = toolroom_form::parse(&path.display().to_string(), &text, &[], &STRUCTURE, resolve);
        file.map_err(|error| error.to_string())
    });
    match fitted {
        Ok(file) => Some(Structure { table: Some(path.to_owned()), ..file.content }),
        Err(reason) => {
            let file = path.display().to_string();
            let fix = format!("`toolroom modes {file}` tells what it holds and why it is not used");
            let fault = StructureFault { file, reason, fix };
            walk.fault(root.span_of("table"), Fault::Content(std::sync::Arc::new(fault)));
            None
        }
    }
}

/// The modes stand in one of the places where they can, of which each has a number of tables; a fault where they do not.
fn one_place(walk: &mut Walk, root: &Section<'_>, places: [(&'static str, usize); 3]) -> Option<()> {
    let given: Vec<(&'static str, usize)> = places.into_iter().filter(|(_, count)| *count > 0).collect();
    let (fault, place) = match given[..] {
        [_] => return Some(()),
        [(first, some), (second, others), ..] => {
            let shown = |key: &str, count: usize| format!("{count} {key}s");
            let fault = Fault::Contradiction {
                first,
                first_value: shown(first, some),
                second,
                second_value: shown(second, others),
                rule: "modes are those of all speeds and places, or stand under each [[speed]] or each [[station]]",
            };
            (fault, second)
        }
        [] => {
            let what = "vibration mode";
            (Fault::Nothing { what, example: "[[mode]] with natural_frequency, damping_ratio and stiffness" }, "")
        }
    };
    walk.fault(root.span_of(place), fault);
    None
}

/// What the rows of a table of modes are.
struct Rows {
    /// Key of the value of a row, its unit in files and for people.
    value: (&'static str, &'static str, &'static str),
    /// What is due where there is one row alone.
    second: (&'static str, &'static str),
}

const SPEEDS: Rows = Rows {
    value: ("spindle_speed", "rad/s", "rpm"),
    second: (
        "second spindle speed",
        "[[speed]] with spindle_speed and its modes, or [[mode]] alone for modes of all speeds",
    ),
};
const STATIONS: Rows = Rows {
    value: ("position", "m", "mm"),
    second: (
        "second station",
        "[[station]] with position and its modes, or [[mode]] alone for modes of the whole path",
    ),
};

/// The modes at the value of each row; none without rows, and a fault at the row that does not fit the one before it.
fn table(walk: &mut Walk, sections: &[Section<'_>], known: &[Row], rows: &Rows) -> Option<Vec<(f64, Vec<Mode>)>> {
    let (key, si, unit) = rows.value;
    let values: Vec<f64> = sections.iter().map(|section| section.si(key)).collect::<Option<_>>()?;
    for (i, section) in sections.iter().enumerate().skip(1) {
        let shown = |value: f64| format!("{} {unit}", significant(convert(value, si, unit)));
        let (before, here) = (known[i - 1].0.len(), known[i].0.len());
        let fault = if values[i] <= values[i - 1] {
            (key, shown(values[i]), key, shown(values[i - 1]), "the rows of a table of modes ascend")
        } else if before != here {
            let count = |modes: usize| format!("{modes} modes");
            ("mode", count(here), "mode", count(before), "every row has the same modes, in the same order")
        } else {
            continue;
        };
        let (first, first_value, second, second_value, rule) = fault;
        let fault = Fault::Contradiction { first, first_value, second, second_value: second_value + " before", rule };
        walk.fault(section.span_of(key), fault);
        return None;
    }
    if let [single] = sections {
        let (what, example) = rows.second;
        walk.fault(single.span_of(""), Fault::Nothing { what, example });
        return None;
    }
    Some(values.into_iter().zip(known).map(|(value, (modes, _))| (value, modes.clone())).collect())
}

/// A mode, and the relative standard deviations of frequency, damping and stiffness.
fn mode(walk: &mut Walk, section: &Section<'_>) -> Option<Estimated> {
    let direction = direction(walk, section)?;
    let mut estimate = |key: &str| {
        let table = walk.table(section, key)?;
        Some((table.si("value")?, table.si("sd")?))
    };
    let (frequency, damping, stiffness) =
        (estimate("natural_frequency"), estimate("damping_ratio"), estimate("stiffness"));
    let (frequency, damping, stiffness) = (frequency?, damping?, stiffness?);
    let mode = Mode { direction, natural_frequency: frequency.0, damping_ratio: damping.0, stiffness: stiffness.0 };
    Some((mode, [frequency, damping, stiffness].map(|(value, sd)| sd / value)))
}

/// The compliance xx, xy, yy (m/N) of the modes above the range as stiff modes along its principal directions. A negative
/// one is left out: it would be no structure. Where all modes move along one line, so do they.
fn stiff_modes(modes: &[Mode], [xx, xy, yy]: [f64; 3]) -> Vec<Mode> {
    let Some(highest) = modes.iter().map(|mode| mode.natural_frequency).reduce(f64::max) else { return Vec::new() };
    let [x, y] = modes[0].direction;
    let parallel = modes.iter().all(|mode| (mode.direction[0] * y - mode.direction[1] * x).abs() < 1e-9);
    let principal = if parallel {
        vec![([x, y], xx.max(yy))]
    } else {
        let (mean, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        let (sine, cosine) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
        vec![([cosine, sine], mean + half), ([-sine, cosine], mean - half)]
    };
    principal
        .into_iter()
        .filter(|(_, compliance)| *compliance > 0.0)
        .map(|(direction, compliance)| Mode {
            direction,
            natural_frequency: ABOVE * highest,
            damping_ratio: ABOVE_DAMPING,
            stiffness: 1.0 / compliance,
        })
        .collect()
}
