//! Tool files: the segments of a tool from its tip on, and how it is held.

use std::path::Path;
use toolroom_dynamics::{Body, Damper, Joint, Material, Segment, chain};
use toolroom_form::{Fault, Form, FormFile, Key, Kind, ReadError, Section, Walk};

/// Materials by name: usual handbook values, an assumption for any one tool. Young's modulus (Pa), density (kg/m³), Poisson's
/// ratio, loss factor.
pub(super) const MATERIALS: [(&str, Material); 3] = [
    ("carbide", Material { youngs_modulus: 580e9, density: 14_500.0, poisson_ratio: 0.24, loss_factor: 0.004 }),
    ("hss", Material { youngs_modulus: 220e9, density: 8_100.0, poisson_ratio: 0.29, loss_factor: 0.004 }),
    ("steel", Material { youngs_modulus: 205e9, density: 7_850.0, poisson_ratio: 0.29, loss_factor: 0.004 }),
];
const MATERIAL_WORDS: &[&str] = &["carbide", "hss", "steel"];

const LENGTH: Kind = Kind::positive("m", "mm", 2.0, "40 mm");

/// The whole file.
pub static TOOL: Form = Form {
    title: "the tool file",
    doc: "A tool as round segments from its tip on, for toolroom swap",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::required("name", Kind::Name, "Short name"),
        Key::required("segment", Kind::Tables(&SEGMENT), "Segments, the tip first"),
        Key::optional(
            "damper",
            Kind::Table(&DAMPER),
            "A mass on a spring inside of the tool, as in a damped boring bar",
        ),
        Key::optional("joint", Kind::Table(&JOINT), "Springs between tool and spindle; left out: rigid"),
    ],
};

static SEGMENT: Form = Form {
    title: "[[segment]]",
    doc: "A part with one round section",
    keys: &[
        Key::required("length", LENGTH, "Length"),
        Key::required("diameter", LENGTH, "Outer diameter"),
        Key::default("inner_diameter", Kind::quantity("m", "mm", 0.0, 2.0, "6 mm"), "0 mm", "Diameter of a bore"),
        Key::default(
            "bending_factor",
            Kind::positive("1", "1", 1.0, "0.8"),
            "1",
            "Share of the diameter that bends; about 0.8 for a fluted length",
        ),
        Key::default(
            "inertia_factor",
            Kind::positive("1", "1", 1.0, "0.8"),
            "1",
            "Share of the diameter whose mass moves",
        ),
        Key::default("material", Kind::Choice(MATERIAL_WORDS), "carbide", "Material; values below replace its own"),
        Key::optional("youngs_modulus", Kind::positive("Pa", "GPa", 2e12, "580 GPa"), "Young's modulus"),
        Key::optional("density", Kind::positive("kg/m3", "kg/m3", 3e4, "14500 kg/m3"), "Density"),
        Key::optional("poisson_ratio", Kind::quantity("1", "1", 0.0, 0.499, "0.24"), "Poisson's ratio"),
        Key::optional("loss_factor", Kind::quantity("1", "1", 0.0, 1.0, "0.004"), "Hysteretic loss factor"),
    ],
};

static DAMPER: Form = Form {
    title: "[damper]",
    doc: "A mass on a spring and a dashpot inside of the tool",
    keys: &[
        Key::required("mass", Kind::positive("kg", "kg", 1e3, "0.2 kg"), "Its mass"),
        Key::required(
            "natural_frequency",
            Kind::positive("Hz", "Hz", 1e5, "180 Hz"),
            "Natural frequency of the mass on its spring, the tool held fast",
        ),
        Key::required(
            "damping_ratio",
            Kind::quantity("1", "1", 0.0, 10.0, "0.15"),
            "Share of critical damping of the same",
        ),
        Key::default("segments", Kind::Count { min: 0, max: 1000 }, "0", "Segments between the tip and the damper"),
    ],
};

static JOINT: Form = Form {
    title: "[joint]",
    doc: "Springs between tool and spindle",
    keys: &[
        Key::required("radial", Kind::positive("N/m", "N/um", 1e12, "200 N/um"), "Radial stiffness"),
        Key::required("angular", Kind::positive("N m/rad", "N m/rad", 1e9, "25000 N m/rad"), "Angular stiffness"),
        Key::default("loss_factor", Kind::quantity("1", "1", 0.0, 1.0, "0.02"), "0", "Hysteretic loss factor"),
    ],
};

/// What a tool file says.
#[derive(Clone, Debug)]
pub struct Tool {
    /// Short name.
    pub name: String,
    /// Segments, the tip first.
    pub segments: Vec<Segment>,
    /// Springs between tool and spindle.
    pub joint: Option<Joint>,
    /// A damper, and the number of segments between the tip and it.
    pub damper: Option<(Damper, usize)>,
}

impl Tool {
    /// Its receptances with free ends at `w` (rad/s, positive); none where one is infinite.
    pub fn body(&self, w: f64) -> Option<Body> {
        let Some((damper, place)) = &self.damper else { return chain(&self.segments, w) };
        let (front, behind) = self.segments.split_at(*place);
        let damped = chain(behind, w)?.damped(damper, w)?;
        if front.is_empty() { Some(damped) } else { chain(front, w)?.with(&damped) }
    }
}

/// Reads a tool file; `overrides` are `path=value` as after `--set`.
///
/// # Errors
/// As [`file::read`](toolroom_form::read).
pub fn read_tool(path: &Path, overrides: &[String]) -> Result<FormFile<Tool>, ReadError> {
    toolroom_form::read(path, overrides, &TOOL, resolve)
}

fn resolve(walk: &mut Walk, root: &Section<'_>) -> Option<Tool> {
    let sections = walk.sections(root, "segment", None);
    let segments: Option<Vec<Segment>> = sections.iter().map(|section| segment(walk, section)).collect();
    let joint = walk.table(root, "joint").map(|section| Joint {
        radial: section.required("radial"),
        angular: section.required("angular"),
        loss_factor: section.si("loss_factor").unwrap_or(0.0),
    });
    let segments = segments?;
    if segments.is_empty() {
        let example = "[[segment]] with length, diameter and material";
        walk.fault(root.span_of("segment"), Fault::Nothing { what: "segment", example });
    }
    let damper = match walk.table(root, "damper") {
        Some(section) => Some(damper(walk, &section, segments.len())?),
        None => None,
    };
    Some(Tool { name: root.text("name")?.to_owned(), segments, joint, damper })
}

/// A damper and its place in a tool of some segments.
fn damper(walk: &mut Walk, section: &Section<'_>, segments: usize) -> Option<(Damper, usize)> {
    let place = section.count("segments").and_then(|count| usize::try_from(count).ok())?;
    if place >= segments {
        let fault = Fault::Contradiction {
            first: "segments",
            first_value: place.to_string(),
            second: "segment",
            second_value: segments.to_string(),
            rule: "a damper lies in front of a segment",
        };
        walk.fault(section.span_of("segments"), fault);
    }
    let (mass, natural_frequency, damping_ratio) =
        (section.si("mass")?, section.si("natural_frequency")?, section.si("damping_ratio")?);
    Some((Damper { mass, natural_frequency, damping_ratio }, place.min(segments.saturating_sub(1))))
}

fn segment(walk: &mut Walk, section: &Section<'_>) -> Option<Segment> {
    let word = section.text("material")?;
    let (_, known) = MATERIALS.iter().find(|(name, _)| *name == word)?;
    let (diameter, inner_diameter) = (section.si("diameter")?, section.si("inner_diameter")?);
    let (bending_factor, inertia_factor) = (section.si("bending_factor")?, section.si("inertia_factor")?);
    if inner_diameter >= diameter * bending_factor.min(inertia_factor) {
        let fault = Fault::Contradiction {
            first: "inner_diameter",
            first_value: format!("{} mm", inner_diameter * 1e3),
            second: "diameter",
            second_value: format!("{} mm", diameter * 1e3),
            rule: "the bore leaves a wall, of the share of the diameter that bends too",
        };
        walk.fault(section.span_of("inner_diameter"), fault);
    }
    Some(Segment {
        length: section.si("length")?,
        diameter,
        inner_diameter,
        bending_factor,
        inertia_factor,
        material: Material {
            youngs_modulus: section.si("youngs_modulus").unwrap_or(known.youngs_modulus),
            density: section.si("density").unwrap_or(known.density),
            poisson_ratio: section.si("poisson_ratio").unwrap_or(known.poisson_ratio),
            loss_factor: section.si("loss_factor").unwrap_or(known.loss_factor),
        },
    })
}
