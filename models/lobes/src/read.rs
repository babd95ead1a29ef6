//! From the sections of a lobes file to cut, chart and operating points.

use super::coefficients;
use super::keys::LOBES;
use super::pair::{direction, pair};
use super::structure::{self, Structure};
use super::words::{DirectionWord, LobesProcess, PresetWord, SupportWord};
use super::{Chart, Limits, LobesCut, LobesFile, Point, axes};
use std::f64::consts::TAU;
use std::path::Path;
use toolroom_chatter::paper::{FiveDegrees, Preset, Reduced};
use toolroom_chatter::{
    Axis, Bar, Cutter, Direction, Engagement, Milling, MillingForce, Mode, Scatter, SpeedVariation, Support, Turning,
};
use toolroom_form::{Fault, FormFile, ReadError, Section, Walk, significant};
use toolroom_process::unit::convert;

/// Reads a lobes file; `overrides` are `path=value` as after `--set`.
///
/// # Errors
/// As [`file::read`](toolroom_form::read).
pub fn read(path: &Path, overrides: &[String]) -> Result<FormFile<LobesFile>, ReadError> {
    toolroom_form::read(path, overrides, &LOBES, resolve)
}

/// [`read`] of a text; `file` is its name in messages.
///
/// # Errors
/// As [`file::parse`](toolroom_form::parse).
pub fn parse(file: &str, text: &str, overrides: &[String]) -> Result<FormFile<LobesFile>, ReadError> {
    toolroom_form::parse(file, text, overrides, &LOBES, resolve)
}

/// From the sections of a lobes file to what they mean.
fn resolve(walk: &mut Walk, root: &Section<'_>) -> Option<LobesFile> {
    let process = root.chosen("process", LobesProcess::from_word);
    let structure = if root.given("structure") { structure::named(walk, root) } else { None };
    let (mut feed, mut deviation) = (None, None);
    let cut = match process {
        Some(LobesProcess::Milling) => milling(walk, root, structure.as_ref(), &mut deviation).map(LobesCut::Milling),
        Some(LobesProcess::Turning) => turning(walk, root, structure.as_ref(), &mut feed, &mut deviation),
        Some(LobesProcess::Chuck) => chuck(walk, root, LobesProcess::Chuck).map(LobesCut::Chuck),
        Some(LobesProcess::ChipLag) => chuck(walk, root, LobesProcess::ChipLag).map(LobesCut::ChipLag),
        Some(LobesProcess::Lathe) => lathe(walk, root).map(|lathe| LobesCut::Lathe(Box::new(lathe))),
        None => None,
    };
    let case = process.map(|process| ("process", process.word()));
    let variation = walk.table_in(root, "speed_variation", case).and_then(|section| {
        let revolutions = u32::try_from(section.count("revolutions")?).ok()?;
        Some(SpeedVariation { amplitude: section.si("amplitude")?, revolutions, phase: section.si("phase") })
    });
    // Without a process, which is a fault, the chart is read as that of a cut.
    let axes = axes(process.unwrap_or(LobesProcess::Turning));
    let chart = walk.table_in(root, "chart", case).and_then(|section| chart(walk, &section, axes));
    let points = walk.sections(root, "point", case);
    let points = points.iter().enumerate().map(|(i, section)| Point {
        name: section.text("name").map_or_else(|| format!("point {}", i + 1), str::to_owned),
        speed: section.required(axes[0].0),
        depth: section.required(axes[1].0),
    });
    let points = points.collect();
    let name = root.text("name")?.to_owned();
    let title = root.text("title").filter(|title| !title.is_empty()).unwrap_or(&name).to_owned();
    let limits = limits(walk, root, case);
    let stated = scatter(walk, root);
    let table = structure.as_ref().and_then(|structure| structure.table.clone());
    let of_structure = structure.and_then(|structure| {
        let known = structure.scatter?;
        // What was identified stands in place of what is usual for a coefficient of a table.
        let coefficients = deviation.map(|deviation: f64| deviation.hypot(structure.stiffness_deviation).min(1.0));
        Some(Scatter { coefficients: coefficients.unwrap_or(known.coefficients), ..known })
    });
    let scatter = stated.or(of_structure);
    let cut = cut?;
    if let LobesCut::Milling(cut) = &cut {
        feed = Some(cut.feed_per_tooth).filter(|feed| *feed > 0.0);
    }
    if feed.is_none() && limits != Limits::default() {
        let (section, key, example) = match process {
            Some(LobesProcess::Turning) => ("[cut] beside [limits]", "feed_per_rev", "\"0.2 mm/rev\""),
            _ => ("[force] beside [limits]", "feed_per_tooth", "\"0.1 mm/tooth\""),
        };
        let fault = Fault::MissingKey { section: section.to_owned(), key, example: example.to_owned() };
        walk.fault(root.span_of("limits"), fault);
    }
    // A force across the cutting speed takes no power: such a limit would never act.
    let across = matches!(&cut, LobesCut::Turning { cut, .. } if cut.force_angle == 0.0);
    if across && (limits.power.is_some() || limits.torque.is_some()) {
        let section = "[cut] beside a limit of power or torque".to_owned();
        let fault = Fault::MissingKey { section, key: "force_angle", example: "\"70 deg\"".to_owned() };
        walk.fault(root.span_of("limits"), fault);
    }
    Some(LobesFile { name, title, cut, variation, chart: chart?, points, scatter, limits, feed, table })
}

/// The section `[limits]`, of `process` where that is a case of its keys.
fn limits(walk: &mut Walk, root: &Section<'_>, case: Option<(&'static str, &'static str)>) -> Limits {
    let Some(section) = walk.table_in(root, "limits", case) else { return Limits::default() };
    Limits {
        power: section.si("power"),
        torque: section.si("torque"),
        force: section.si("max_force"),
        surface_error: section.si("tolerance"),
    }
}

/// The section `[scatter]`.
fn scatter(walk: &mut Walk, root: &Section<'_>) -> Option<Scatter> {
    let section = walk.table(root, "scatter")?;
    Some(Scatter {
        natural_frequency: section.si("natural_frequency")?,
        damping_ratio: section.si("damping_ratio")?,
        coefficients: section.si("coefficients")?,
    })
}

/// Key of an axis, its unit in files and that for people.
type Quantity = (&'static str, &'static str, &'static str);

fn chart(walk: &mut Walk, section: &Section<'_>, [speed, depth]: [Quantity; 2]) -> Option<Chart> {
    let points = |key: &str| section.count(key).and_then(|count| usize::try_from(count).ok());
    let (columns, rows) = (points("columns")?, points("rows")?);
    let speed = range(walk, section, speed, columns);
    let depth = range(walk, section, depth, rows);
    Some(Chart {
        speed: speed?,
        depth: depth?,
        boundary_only: section.flag("boundary_only")?,
        beside: section.numbers("lag").or_else(|| section.numbers("allowance")).unwrap_or_default(),
    })
}

/// Two ascending values.
fn range(walk: &mut Walk, section: &Section<'_>, (key, si, display): Quantity, points: usize) -> Option<Axis> {
    let values = pair(walk, section, key, "two values, least and greatest")?;
    let [start, end] = values;
    if start < end {
        return Some(Axis { start, end, points });
    }
    let shown = |value| match display {
        "1" => significant(value),
        unit => format!("{} {unit}", significant(convert(value, si, unit))),
    };
    let fault = Fault::Contradiction {
        first: "least",
        first_value: shown(start),
        second: "greatest",
        second_value: shown(end),
        rule: "the range of a chart ascends",
    };
    walk.fault(section.span_of(key), fault);
    None
}

/// All modes, of the file or of the structure file that it names; `None` where one of them has a fault.
fn modes(walk: &mut Walk, root: &Section<'_>, structure: Option<&Structure>) -> Option<Vec<Mode>> {
    let sections = walk.sections(root, "mode", None);
    if root.given("structure") {
        if !sections.is_empty() {
            let fault = Fault::Contradiction {
                first: "structure",
                first_value: root.text("structure").unwrap_or_default().to_owned(),
                second: "mode",
                second_value: format!("{} modes", sections.len()),
                rule: "the modes stand in one of the two places",
            };
            walk.fault(root.span_of("structure"), fault);
            return None;
        }
        return structure.map(|structure| structure.modes.clone());
    }
    sections.iter().map(|section| mode(walk, section)).collect::<Vec<_>>().into_iter().collect()
}

fn mode(walk: &mut Walk, section: &Section<'_>) -> Option<Mode> {
    let direction = direction(walk, section)?;
    let (natural_frequency, damping_ratio) = (section.si("natural_frequency")?, section.si("damping_ratio")?);
    match (section.given("stiffness"), section.given("mass")) {
        (true, false) => {
            Some(Mode { direction, natural_frequency, damping_ratio, stiffness: section.si("stiffness")? })
        }
        (false, true) => Some(Mode::from_mass(direction, natural_frequency, damping_ratio, section.si("mass")?)),
        (true, true) => {
            let shown = |key| section.si(key).map_or_else(String::new, significant);
            let fault = Fault::Contradiction {
                first: "stiffness",
                first_value: shown("stiffness") + " N/m",
                second: "mass",
                second_value: shown("mass") + " kg",
                rule: "with the natural frequency one of them says the other",
            };
            walk.fault(section.span_of("mass"), fault);
            None
        }
        (false, false) => {
            let (section_title, example) = ("[[mode]]".to_owned(), "\"1.34 N/um\"".to_owned());
            let fault = Fault::MissingKey { section: section_title, key: "stiffness", example };
            walk.fault(section.span_of(""), fault);
            None
        }
    }
}

/// Says so where no mode moves the cut.
fn some_modes(walk: &mut Walk, root: &Section<'_>, modes: &[Mode]) {
    if modes.is_empty() {
        let example = "[[mode]] with direction, natural_frequency, damping_ratio and stiffness";
        walk.fault(root.span_of("mode"), Fault::Nothing { what: "vibration mode", example });
    }
}

/// The cut; the relative standard deviation of a coefficient file goes to `deviation`.
fn milling(
    walk: &mut Walk,
    root: &Section<'_>,
    structure: Option<&Structure>,
    deviation: &mut Option<f64>,
) -> Option<Milling> {
    let modes = modes(walk, root, structure);
    if let Some(modes) = &modes {
        some_modes(walk, root, modes);
    }
    let cutter = walk.table(root, "cutter").and_then(|section| cutter(walk, &section));
    let engagement = walk.table(root, "engagement").and_then(|section| {
        let direction = match section.chosen("direction", DirectionWord::from_word)? {
            DirectionWord::Up => Direction::Up,
            DirectionWord::Down => Direction::Down,
        };
        Engagement::new(section.si("immersion")?, direction).ok()
    });
    let force = walk.table(root, "force")?;
    let feed_per_tooth = force.si("feed_per_tooth")?;
    let cutter = cutter?;
    if cutter.runout > 0.0 && feed_per_tooth == 0.0 {
        let section = "[force] of a cutter with runout".to_owned();
        let example = "\"0.1 mm/tooth\"".to_owned();
        walk.fault(force.span_of("feed_per_tooth"), Fault::MissingKey { section, key: "feed_per_tooth", example });
    }
    let file = if force.given("coefficients") { coefficients::named(walk, &force) } else { None };
    *deviation = file.as_ref().map(|file| file.deviation);
    let of_file = |i: usize| file.as_ref().map(|file| file.chip[i]);
    let tangential = coefficients::value(walk, &force, "tangential", "\"600 MPa\"", of_file(0));
    let radial = coefficients::value(walk, &force, "radial", "\"200 MPa\"", of_file(1));
    // What is written here counts before the file.
    let edge = |i: usize, key: &str| match &file {
        Some(file) if !force.given(key) => Some(file.edge[i]),
        Some(_) | None => force.si(key),
    };
    let force = MillingForce {
        tangential: tangential?,
        radial: radial?,
        process_damping: force.si("process_damping")?,
        edge_tangential: edge(0, "edge_tangential")?,
        edge_radial: edge(1, "edge_radial")?,
        axial: force.si("axial")?,
    };
    Some(Milling {
        modes: modes?,
        cutter,
        engagement: engagement?,
        force,
        feed_per_tooth,
        by_speed: structure.and_then(|structure| structure.by_speed.clone()),
        along_path: structure.and_then(|structure| structure.along_path.clone()),
    })
}

fn cutter(walk: &mut Walk, section: &Section<'_>) -> Option<Cutter> {
    let pitch = section.numbers("pitch").unwrap_or_default();
    let teeth = usize::try_from(section.count("teeth")?).ok()?;
    if section.given("pitch") {
        let whole = pitch.iter().sum::<f64>();
        if pitch.len() != teeth {
            let fault = Fault::Contradiction {
                first: "teeth",
                first_value: teeth.to_string(),
                second: "pitch",
                second_value: format!("{} angles", pitch.len()),
                rule: "every tooth has one pitch angle",
            };
            walk.fault(section.span_of("pitch"), fault);
        } else if (whole / TAU - 1.0).abs() > 1e-6 {
            let fault = Fault::OutOfRange {
                key: "pitch".to_owned(),
                read: format!("{} deg in all", significant(whole.to_degrees())),
                range: "a whole turn, 360 deg".to_owned(),
                meant: Vec::new(),
            };
            walk.fault(section.span_of("pitch"), fault);
        }
    }
    let (diameter, corner_radius) = (section.si("diameter")?, section.si("corner_radius")?);
    let millimetres = |value: f64| format!("{} mm", significant(value * 1e3));
    if corner_radius > 0.5 * diameter {
        let fault = Fault::Contradiction {
            first: "corner_radius",
            first_value: millimetres(corner_radius),
            second: "diameter",
            second_value: millimetres(diameter),
            rule: "a corner is at most a ball end, half the diameter",
        };
        walk.fault(section.span_of("corner_radius"), fault);
    }
    if corner_radius > 0.0 && (section.given("pitch") || section.si("runout").is_some_and(|runout| runout > 0.0)) {
        let fault = Fault::Contradiction {
            first: "corner_radius",
            first_value: millimetres(corner_radius),
            second: if section.given("pitch") { "pitch" } else { "runout" },
            second_value: "given".to_owned(),
            rule: "cutters with a corner radius are calculated with equal pitch and without runout",
        };
        walk.fault(section.span_of("corner_radius"), fault);
    }
    let taper_angle = section.si("taper_angle")?;
    let degrees = |value: f64| format!("{} deg", significant(value.to_degrees()));
    let beside = ["corner_radius", "runout", "runout_angle"]
        .into_iter()
        .find(|key| section.si(key).is_some_and(|own| own > 0.0));
    if let Some(second) = beside.or_else(|| section.given("pitch").then_some("pitch")).filter(|_| taper_angle > 0.0) {
        let fault = Fault::Contradiction {
            first: "taper_angle",
            first_value: degrees(taper_angle),
            second,
            second_value: "given".to_owned(),
            rule: "tapered cutters are calculated without a corner radius, with equal pitch and without runout",
        };
        walk.fault(section.span_of("taper_angle"), fault);
    }
    Some(Cutter {
        teeth,
        diameter,
        helix_angle: section.si("helix_angle")?,
        pitch,
        runout: section.si("runout")?,
        runout_angle: section.si("runout_angle")?,
        corner_radius,
        taper_angle,
    })
}

/// The cut; its feed per revolution, where it is given, goes to `feed`, the relative standard deviation of a coefficient
/// file to `deviation`.
fn turning(
    walk: &mut Walk,
    root: &Section<'_>,
    structure: Option<&Structure>,
    feed: &mut Option<f64>,
    deviation: &mut Option<f64>,
) -> Option<LobesCut> {
    let modes = modes(walk, root, structure);
    let cut = walk.table(root, "cut");
    let diameter = cut.as_ref().and_then(|cut| cut.si("diameter"));
    let section = walk.table(root, "bar");
    let bar = match (&section, diameter) {
        (Some(section), Some(diameter)) => bending(walk, section, diameter),
        _ => None,
    };
    let modes = modes?;
    if section.is_some() {
        bar?;
    } else {
        some_modes(walk, root, &modes);
    }
    let cut = cut?;
    *feed = cut.si("feed_per_rev");
    let file = if cut.given("coefficients") { coefficients::named(walk, &cut) } else { None };
    *deviation = file.as_ref().map(|file| file.deviation);
    // The tangential force acts along the cutting speed, the radial one along the chip thickness.
    let resultant = file.as_ref().map(|file| file.chip[0].hypot(file.chip[1]));
    let cutting_coefficient = coefficients::value(walk, &cut, "cutting_coefficient", "\"1500 MPa\"", resultant);
    let force_angle = match &file {
        Some(file) if !cut.given("force_angle") => Some(file.chip[0].atan2(file.chip[1])),
        Some(_) | None => cut.si("force_angle"),
    };
    let cut = Turning {
        modes,
        cutting_coefficient: cutting_coefficient?,
        force_angle: force_angle?,
        process_damping: cut.si("process_damping")?,
        diameter: diameter?,
        chip_exponent: cut.si("chip_exponent")?,
        by_speed: structure.and_then(|structure| structure.by_speed.clone()),
        along_path: structure.and_then(|structure| structure.along_path.clone()),
    };
    Some(LobesCut::Turning { cut, bar })
}

/// The bar and the place of the tool on it.
fn bending(walk: &mut Walk, section: &Section<'_>, diameter: f64) -> Option<(Bar, f64)> {
    let (length, position) = (section.si("length")?, section.si("position")?);
    let bar = Bar {
        length,
        diameter,
        youngs_modulus: section.si("youngs_modulus")?,
        density: section.si("density")?,
        damping_ratio: section.si("damping_ratio")?,
        chuck_stiffness: section.si("chuck_stiffness")?,
        support: match section.chosen("support", SupportWord::from_word)? {
            SupportWord::Chuck => Support::Chuck,
            SupportWord::Tailstock => Support::Tailstock,
        },
    };
    let bends = bar.mode_at(position).is_ok();
    if !bends {
        let millimetres = |value: f64| format!("{} mm", significant(value * 1e3));
        let fault = Fault::Contradiction {
            first: "position",
            first_value: millimetres(position),
            second: "length",
            second_value: millimetres(length),
            rule: "the tool is on the bar and not at a support, where nothing moves",
        };
        walk.fault(section.span_of("position"), fault);
    }
    bends.then_some((bar, position))
}

fn preset(section: &Section<'_>) -> Option<Preset> {
    Some(match section.chosen("preset", PresetWord::from_word)? {
        PresetWord::F0_120Hz => Preset::F0_120Hz,
        PresetWord::Fig3Fit => Preset::Fig3Fit,
        PresetWord::Table2Milli => Preset::Table2Milli,
        PresetWord::Table2Literal => Preset::Table2Literal,
    })
}

/// The section `[chuck]`; where lag and cutting stiffness are the axes they are none of its keys.
fn chuck(walk: &mut Walk, root: &Section<'_>, process: LobesProcess) -> Option<Reduced> {
    let section = walk.table_in(root, "chuck", Some(("process", process.word())))?;
    let lag = if process == LobesProcess::Chuck { section.si("lag")? } else { 0.0 };
    let published = Reduced::from_preset(preset(&section)?, lag);
    Some(Reduced {
        mass: section.si("mass").unwrap_or(published.mass),
        damping: section.si("damping").unwrap_or(published.damping),
        stiffness: section.si("stiffness").unwrap_or(published.stiffness),
        cutting_stiffness: section.si("cutting_stiffness").unwrap_or(published.cutting_stiffness),
        lag: published.lag,
    })
}

fn lathe(walk: &mut Walk, root: &Section<'_>) -> Option<FiveDegrees> {
    let section = walk.table(root, "lathe")?;
    let (lag, feed_per_rev) = (section.si("lag")?, section.si("feed_per_rev")?);
    Some(FiveDegrees {
        mu_allowance: section.numbers("allowance").unwrap_or_default(),
        workpiece_lag: section.flag("workpiece_lag")?,
        regeneration: section.flag("regeneration")?,
        ..FiveDegrees::from_preset(preset(&section)?, lag, feed_per_rev)
    })
}
