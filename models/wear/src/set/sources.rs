//! The sections `[handbook]` and `material` of a set: read and converted.

use super::fault::SetFault;
use super::form::SPEED_FORM;
use super::handbook::{ASSUMED_EXPONENTS, FittedLives, HandbookTaylor, Kienzle, ReferenceLife, TestedLife};
use super::material::{FORCE_DEVIATION, MaterialGroup};
use super::one_life::{ABOUT, EDGE_SCATTER, OneLife, SPEED_EXPONENT_DEVIATION, ToolMaterial};
use super::values::{Placed, Values};
use super::{Origin, Spread};
use crate::{ExtendedTaylor, Force, Scatter};
use std::collections::BTreeMap;
use std::ops::Range;
use toolroom_form::{Fault, Section, Walk, significant};
use toolroom_process::{Field, Record};

/// Exponents that lives tell only where they vary feed and depth.
const EXPONENTS: [&str; 2] = ["feed_exponent", "depth_exponent"];

/// What the sections give.
#[derive(Default)]
pub(super) struct Converted {
    /// Values by group and name.
    pub values: Values,
    /// Values of the material, for where nothing else gives them.
    pub material: Option<Values>,
    /// The law that they are of.
    pub law: Option<&'static str>,
    pub prior: BTreeMap<String, Spread>,
    pub scatter: Option<Scatter>,
    pub notes: Vec<String>,
}

/// The value of a parameter of the file or of its base, by group and name.
type Reference<'a> = &'a dyn Fn(&str, &str) -> Option<f64>;

pub(super) fn convert(walk: &mut Walk, root: &Section<'_>, reference: Reference<'_>) -> Converted {
    let mut converted = Converted::default();
    if let Some(handbook) = walk.table(root, "handbook") {
        one_law(walk, &handbook);
        if let Some(taylor) = walk.table(&handbook, "taylor") {
            self::taylor(walk, &taylor, reference, &mut converted);
        } else if handbook.given("lives") {
            lives(walk, &handbook, reference, &mut converted);
        } else if let Some(one) = walk.table(&handbook, "one_life") {
            one_life(walk, &one, reference, &mut converted);
        }
        if let Some(kienzle) = walk.table(&handbook, "kienzle") {
            force(walk, &kienzle, reference, &mut converted);
        }
    }
    if let Some(material) = walk.table(root, "material") {
        converted.material = of_material(walk, &material, reference, &mut converted);
    }
    converted
}

/// Taylor's constants, tested lives and one life all give the same values.
fn one_law(walk: &mut Walk, handbook: &Section<'_>) {
    let given: Vec<&str> = ["taylor", "lives", "one_life"].into_iter().filter(|key| handbook.given(key)).collect();
    if let [first, second, ..] = given[..] {
        let (a, b) = (handbook.span_of(first), handbook.span_of(second));
        let key = format!("the tool life ({first} and {second})");
        walk.fault(b.clone(), SetFault::TwoSources { key, first: walk.line(&a), second: walk.line(&b) });
    }
}

/// The cut about which the law is stated: v, f, a of the set, SI.
fn cut(reference: Reference<'_>) -> Option<[f64; 3]> {
    Some([
        reference("limits", "reference_speed")?,
        reference("temperature", "reference_feed")?,
        reference("temperature", "reference_depth")?,
    ])
}

fn no_cut(walk: &mut Walk, span: Range<usize>) {
    let what = "no reference cut: limits.reference_speed, temperature.reference_feed and temperature.reference_depth \
                are due here or in the set of `based_on`";
    walk.fault(span, SetFault::Implausible(what.to_owned()));
}

/// Range of a life at the reference cut that a handbook's constants can mean, s (assumption: from half
/// a minute to ten hours).
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 30.0..=36_000.0;

fn taylor(walk: &mut Walk, section: &Section<'_>, reference: Reference<'_>, converted: &mut Converted) {
    let Some(reference_cut) = cut(reference) else { return no_cut(walk, section.span.clone()) };
    let number = |key: &str| section.si(key);
    let Some(constant) = number("C") else { return };
    let unit = if section.text("life_unit") == Some("s") { 1.0 } else { 60.0 };
    let (form, or_zero) = (section.text("form"), |key: &str| number(key).unwrap_or(0.0));
    let law = if form == Some(SPEED_FORM) {
        let Some(m) = number("m") else { return };
        if !exponent_of_life(walk, section, "m", m) {
            return;
        }
        HandbookTaylor {
            constant,
            life_exponent: m,
            depth_exponent: or_zero("x"),
            feed_exponent: or_zero("y"),
            life_unit: unit,
        }
    } else {
        let Some(n) = number("n") else { return };
        if !exponent_of_life(walk, section, "n", n) {
            return;
        }
        HandbookTaylor::of_product(constant, n, or_zero("a"), or_zero("b"), unit)
    };
    let life = law.about(reference_cut[0], reference_cut[1], reference_cut[2]);
    let shown = |seconds: f64| format!("{} min", significant(seconds / 60.0));
    if !PLAUSIBLE.contains(&life.life) {
        let other = if unit == 1.0 { 60.0 } else { 1.0 };
        let reading = |unit: f64, word: &str| {
            format!(
                "with the life in {word} an edge lasts {}",
                shown(
                    HandbookTaylor { life_unit: unit, ..law }
                        .about(reference_cut[0], reference_cut[1], reference_cut[2])
                        .life
                )
            )
        };
        let words = |unit: f64| if unit == 1.0 { "seconds" } else { "minutes" };
        let message = format!(
            "`C` gives no plausible life at the reference cut ({} m/min, {} mm/rev, {} mm): {}; {}. C changes by 60^m \
             with the unit of the life, and feed and depth count in mm",
            significant(reference_cut[0] * 60.0),
            significant(reference_cut[1] * 1e3),
            significant(reference_cut[2] * 1e3),
            reading(unit, words(unit)),
            reading(other, words(other)),
        );
        walk.fault(section.span_of("C"), SetFault::Implausible(message));
        return;
    }
    let source = section.text("source").unwrap_or_default();
    set_law(walk, section, converted, (life, reference_cut), source);
    let limit = section.si("wear_limit").map(|limit| (limit, section.span_of("wear_limit")));
    set_limit(converted, limit, reference, source);
}

/// Whether `value` can be the exponent of life; tables that state T as a function of v have its inverse.
fn exponent_of_life(walk: &mut Walk, section: &Section<'_>, key: &str, value: f64) -> bool {
    if value > 1.0 {
        let message = format!(
            "`{key}` = {} is no exponent of the life, which is below 1: in T = A/v^{} the life falls with that power of the \
             speed; write {key} = {}",
            significant(value),
            significant(value),
            significant(value.recip())
        );
        walk.fault(section.span_of(key), SetFault::Implausible(message));
    }
    value <= 1.0
}

fn lives(walk: &mut Walk, handbook: &Section<'_>, reference: Reference<'_>, converted: &mut Converted) {
    let entries = walk.sections(handbook, "lives", None);
    let Some(reference_cut) = cut(reference) else { return no_cut(walk, handbook.span_of("lives")) };
    let tested: Vec<TestedLife> = entries
        .iter()
        .filter_map(|entry| {
            Some(TestedLife {
                cutting_speed: entry.si("cutting_speed")?,
                feed: entry.si("feed").unwrap_or(reference_cut[1]),
                depth_of_cut: entry.si("depth_of_cut").unwrap_or(reference_cut[2]),
                life: entry.si("life")?,
            })
        })
        .collect();
    if tested.len() < entries.len() {
        return;
    }
    let fit = match FittedLives::new(&tested) {
        Ok(fit) => fit,
        Err(reason) => return walk.fault(handbook.span_of("lives"), SetFault::Model(reason)),
    };
    // What the lives do not vary they do not tell: the exponent of the file or of its base stands, else an assumed one.
    let others = EXPONENTS.map(|name| reference("extended_taylor", name));
    let fit = fit.with_exponents([0, 1].map(|place| others[place].unwrap_or(ASSUMED_EXPONENTS[place])));
    let [speed_exponent, feed_exponent, depth_exponent] = fit.all_exponents();
    let law = ReferenceLife {
        life: fit.life(reference_cut[0], reference_cut[1], reference_cut[2]),
        speed_exponent,
        feed_exponent,
        depth_exponent,
    };
    let mut source = format!("fitted to {} lives", tested.len());
    if let Some(stated) = entries.iter().find_map(|entry| entry.text("source")) {
        source.push_str(&format!(", {stated}"));
    }
    if let Some((low, high)) = fit.interval(0, 0.90) {
        converted.notes.push(format!(
            "speed exponent {} (90 % {} to {}), standard deviation of ln T {} with {} degrees of freedom",
            significant(speed_exponent),
            significant(low),
            significant(high),
            significant(fit.scatter),
            fit.freedom
        ));
    }
    set_law(walk, handbook, converted, (law, reference_cut), &source);
    for (place, name) in EXPONENTS.into_iter().enumerate().filter(|(place, _)| fit.exponents[place + 1].is_none()) {
        match others[place] {
            Some(_) => {
                converted.values.remove(&("extended_taylor", name));
            }
            None => {
                assumed(converted, name, "assumption: middle of handbook values for carbide; the lives do not vary it")
            }
        }
    }
    for (name, (value, error)) in ["speed_exponent", "feed_exponent", "depth_exponent"]
        .iter()
        .zip(fit.exponents)
        .filter_map(|(name, fitted)| Some((name, fitted?)))
    {
        let spread =
            if *name == "speed_exponent" { Spread::Factor((error / value).exp()) } else { Spread::Deviation(error) };
        converted.prior.insert(format!("extended_taylor.{name}"), spread);
    }
    let limits: Vec<(f64, Range<usize>)> =
        entries.iter().filter_map(|entry| Some((entry.si("wear_limit")?, entry.span_of("wear_limit")))).collect();
    if let Some((_, span)) = limits.iter().find(|(limit, _)| (limit / limits[0].0 - 1.0).abs() > 1e-9) {
        let message = "these lives belong to different wear limits".to_owned();
        walk.fault(span.clone(), SetFault::Implausible(message));
    }
    set_limit(converted, limits.into_iter().next(), reference, &source);
}

/// Says of an exponent that nothing in the file states it.
fn assumed(converted: &mut Converted, name: &'static str, source: &str) {
    if let Some(placed) = converted.values.get_mut(&("extended_taylor", name)) {
        (placed.source, placed.origin) = (source.to_owned(), Origin::Assumed);
    }
}

fn one_life(walk: &mut Walk, section: &Section<'_>, reference: Reference<'_>, converted: &mut Converted) {
    let Some(reference_cut) = cut(reference) else { return no_cut(walk, section.span.clone()) };
    let (Some(life), Some(cutting_speed)) = (section.si("life"), section.si("cutting_speed")) else { return };
    let Some(tool_material) = section.chosen("tool_material", ToolMaterial::from_word) else { return };
    let one = OneLife { life, cutting_speed, tool_material };
    // The law is stated about the cut at which the life is known.
    let life_cut = [
        cutting_speed,
        section.si("feed").unwrap_or(reference_cut[1]),
        section.si("depth_of_cut").unwrap_or(reference_cut[2]),
    ];
    let source = section.text("source").unwrap_or("one life, about");
    set_law(walk, section, converted, (one.law(), life_cut), source);
    for name in ["speed_exponent", "feed_exponent", "depth_exponent"] {
        assumed(converted, name, &format!("assumption: {} in general", tool_material.word()));
    }
    let [q, r] = OneLife::deviations();
    converted.prior.extend([
        ("extended_taylor.reference_life".to_owned(), Spread::Factor(ABOUT.exp())),
        ("extended_taylor.speed_exponent".to_owned(), Spread::Factor(SPEED_EXPONENT_DEVIATION.exp())),
        ("extended_taylor.feed_exponent".to_owned(), Spread::Deviation(q)),
        ("extended_taylor.depth_exponent".to_owned(), Spread::Deviation(r)),
    ]);
    // The wear of edges scatters as a whole: a Taylor law has no parts to scatter on their own.
    let scatter = Scatter { common_wear: EDGE_SCATTER, mechanical_wear: 0.0, thermal_wear: 0.0, ..Scatter::shop() };
    converted.scatter = Some(scatter);
    converted.notes.push(
        "one life says nothing of how wear depends on the state of the edge: under this set adaptive speed gains \
         exactly nothing, and whether it would pay can not be judged"
            .to_owned(),
    );
    let limit = section.si("wear_limit").map(|limit| (limit, section.span_of("wear_limit")));
    set_limit(converted, limit, reference, source);
}

/// The law about a cut, into the group `extended_taylor`.
fn set_law(
    walk: &mut Walk,
    section: &Section<'_>,
    converted: &mut Converted,
    (law, at): (ReferenceLife, [f64; 3]),
    source: &str,
) {
    converted.law = Some("extended_taylor");
    let values = [
        ("reference_life", law.life),
        ("speed_exponent", law.speed_exponent),
        ("feed_exponent", law.feed_exponent),
        ("depth_exponent", law.depth_exponent),
        ("reference_speed", at[0]),
        ("reference_feed", at[1]),
        ("reference_depth", at[2]),
    ];
    for (name, value) in values {
        set(walk, section, converted, ExtendedTaylor::<f64>::FIELDS, ("extended_taylor", name, value), source);
    }
}

/// The wear limit at which lives end is that of the law and of the edge; where none is stated, lives
/// end at the wear limit of the set.
fn set_limit(converted: &mut Converted, limit: Option<(f64, Range<usize>)>, reference: Reference<'_>, source: &str) {
    let Some((value, span)) = limit else {
        if let Some(value) = reference("limits", "wear_limit") {
            let source = "assumption: the lives end at the wear limit of the set".to_owned();
            let placed = Placed { value, source, origin: Origin::Assumed, span: 0..0 };
            converted.values.insert(("extended_taylor", "wear_limit"), placed);
        }
        return;
    };
    for key in [("extended_taylor", "wear_limit"), ("limits", "wear_limit")] {
        let placed = Placed { value, source: source.to_owned(), origin: Origin::Handbook, span: span.clone() };
        converted.values.insert(key, placed);
    }
}

fn set(
    walk: &mut Walk,
    section: &Section<'_>,
    converted: &mut Converted,
    fields: &'static [Field],
    (group, name, value): (&'static str, &'static str, f64),
    source: &str,
) {
    if let Some(Err(reason)) = fields.iter().find(|field| field.name == name).map(|field| field.check(value)) {
        walk.fault(section.span.clone(), Fault::Model { subject: format!("{}, {group}", section.path), reason });
        return;
    }
    let span = section.span.clone();
    converted.values.insert((group, name), Placed { value, source: source.to_owned(), origin: Origin::Handbook, span });
}

fn force(walk: &mut Walk, section: &Section<'_>, reference: Reference<'_>, converted: &mut Converted) {
    let (Some(kc11), Some(exponent)) = (section.si("kc11"), section.si("mc")) else { return };
    let stated = section.si("cutting_edge_angle");
    let angle = stated.or(reference("force", "cutting_edge_angle"));
    let Some(cutting_edge_angle) = angle else {
        let fault = Fault::MissingKey {
            section: section.path.clone(),
            key: "cutting_edge_angle",
            example: "\"45 deg\"".to_owned(),
        };
        return walk.fault(section.span.clone(), fault);
    };
    let rake = section.si("rake_angle").map_or(0.0, |rake| rake - section.required("rake_reference"));
    let kienzle = Kienzle { kc11, exponent, cutting_edge_angle }.with_rake(rake);
    let source = section.text("source").unwrap_or_default().to_owned();
    for (name, value) in of_kienzle(&kienzle) {
        set(walk, section, converted, Force::<f64>::FIELDS, ("force", name, value), &source);
    }
    if let Some(angle) = stated {
        set(walk, section, converted, Force::<f64>::FIELDS, ("force", "cutting_edge_angle", angle), &source);
    }
}

/// The parameters of the group `force` that a specific cutting force gives.
fn of_kienzle(kienzle: &Kienzle) -> [(&'static str, f64); 4] {
    let (specific_force, feed_exponent) = kienzle.force();
    [
        ("specific_force", specific_force),
        ("feed_exponent", feed_exponent),
        ("depth_exponent", 1.0),
        ("speed_exponent", 0.0),
    ]
}

fn of_material(
    walk: &mut Walk,
    section: &Section<'_>,
    reference: Reference<'_>,
    converted: &mut Converted,
) -> Option<Values> {
    let of_group = section.count("vdi3323").and_then(|group| MaterialGroup::of_group(u32::try_from(group).ok()?));
    let letter = section.text("iso513");
    if let (Some(group), Some(letter)) = (of_group, letter)
        && group.iso513 != letter
    {
        let message = format!("vdi3323 = {} is of ISO 513 group {}, not {letter}", group.group, group.iso513);
        walk.fault(section.span_of("vdi3323"), SetFault::Implausible(message));
        return None;
    }
    let group = of_group.or_else(|| MaterialGroup::of_letter(letter?))?;
    let cutting_edge_angle = reference("force", "cutting_edge_angle")?;
    let kienzle = Kienzle { kc11: group.kc11, exponent: group.exponent, cutting_edge_angle };
    converted.prior.entry("force.specific_force".to_owned()).or_insert(Spread::Factor(1.0 + FORCE_DEVIATION));
    let placed = |value| Placed { value, source: group.source(), origin: Origin::Handbook, span: section.span.clone() };
    Some(of_kienzle(&kienzle).into_iter().map(|(name, value)| (("force", name), placed(value))).collect())
}
