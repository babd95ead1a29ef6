//! Reading a parameter set: its values, those of the set that it is based on, and the law.

use super::fault::{LONGEST_CHAIN, SetFault};
use super::form::PARAMETER_SET;
use super::prior::priors;
use super::values::{Placed, Values};
use super::{Catalogue, Group, Origin, ParameterSet, ParameterValue, collapse, diffusion, sources};
use crate::Scatter;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};
use toolroom_form::{Fault, Quantity, ReadError, Section, Value, Walk, display, nearest, parse};
use toolroom_process::Field;

pub(super) fn file(
    path: &Path,
    overrides: &[String],
    catalogues: &[&'static Catalogue],
    chain: &[PathBuf],
) -> Result<ParameterSet, ReadError> {
    let content = toolroom_form::text(path)?;
    let real_path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let longer: Vec<PathBuf> = chain.iter().cloned().chain([real_path]).collect();
    let mut set = text(&path.display().to_string(), &content, overrides, catalogues, &longer)?;
    set.files.insert(0, path.to_owned());
    Ok(set)
}

/// `chain` are the files that lead here, this one included where it is a file.
pub(super) fn text(
    name: &str,
    content: &str,
    overrides: &[String],
    catalogues: &[&'static Catalogue],
    chain: &[PathBuf],
) -> Result<ParameterSet, ReadError> {
    let resolve = |walk: &mut Walk, root: &Section<'_>| set(walk, root, catalogues, chain);
    Ok(parse(name, content, overrides, &PARAMETER_SET, resolve)?.content)
}

fn set(
    walk: &mut Walk,
    root: &Section<'_>,
    catalogues: &[&'static Catalogue],
    chain: &[PathBuf],
) -> Option<ParameterSet> {
    let catalogue = catalogue(walk, root, catalogues)?;
    let base = match root.text("based_on") {
        Some(reference) => Some(base(walk, root, reference, catalogue, chain)?),
        None => None,
    };
    if let Some(key) = ["handbook", "material"].into_iter().find(|key| root.given(key))
        && catalogue.laws().next().is_none()
    {
        let applicable = "parameters, prior, scatter".to_owned();
        let case = format!("process = \"{}\"", catalogue.process);
        walk.fault(root.span_of(key), Fault::NotApplicable { key, case, applicable });
    }
    let faults = walk.problems.len();
    let values = given(walk, root, catalogue);
    let mut set = merged(walk, root, catalogue, (values, faults), base)?;
    set.prior.extend(priors(walk, root, catalogue));
    set.scatter = Scatter::of_section(walk, root, "[scatter]").or(set.scatter);
    Some(ParameterSet { name: root.text("name")?.to_owned(), title: root.text("title")?.to_owned(), ..set })
}

/// The values of a section over those of the set that it is based on: stated ones, what its constants give (keys `handbook` and
/// `material`), and the law that follows from both. Values that are missing are told where there are no more than `faults` so far.
pub(super) fn merged(
    walk: &mut Walk,
    section: &Section<'_>,
    catalogue: &'static Catalogue,
    (mut values, faults): (Values, usize),
    base: Option<ParameterSet>,
) -> Option<ParameterSet> {
    let named: Vec<&'static str> =
        catalogue.laws().filter(|law| values.keys().any(|(group, _)| group == law)).collect();
    let inherited = |group: &str, name: &str| {
        let base = base.as_ref()?;
        base.values.iter().chain(&base.unused).find(|value| value.group == group && value.field.name == name)
    };
    // What the conversions refer to: the reference cut of this section or of its base.
    let reference = |group: &str, name: &str| {
        let entry = values.iter().find(|((entry, key), _)| *entry == group && *key == name);
        entry.map(|(_, placed)| placed.value).or(inherited(group, name).map(|value| value.value))
    };
    let mut converted = sources::convert(walk, section, &reference);
    let law = law(walk, section, catalogue, &named, &converted, base.as_ref())?;
    if let Some(law) = law {
        diffusion::at_reference(walk, law, section, &mut values, base.as_ref());
    }
    wear_limits(walk, &values, &converted);
    // The force of a material group stands where nothing else gives a force.
    let (force, material) = (("force", "specific_force"), converted.material.take());
    if let Some(of_material) = material
        && !values.contains_key(&force)
        && !converted.values.contains_key(&force)
    {
        converted.values.extend(of_material);
    }
    let found = |group: &Group, field: &'static Field| {
        let key = (group.name, field.name);
        let placed = values.get(&key).or(converted.values.get(&key));
        match (placed, inherited(group.name, field.name)) {
            (Some(placed), _) => Some(ParameterValue {
                group: group.name,
                field,
                value: placed.value,
                origin: placed.origin.clone(),
                source: placed.source.clone(),
            }),
            (None, Some(value)) => {
                let origin = match &value.origin {
                    Origin::Based(set) => Origin::Based(set.clone()),
                    Origin::Assumed => Origin::Assumed,
                    Origin::Given | Origin::Handbook => {
                        Origin::Based(base.as_ref().map_or(String::new(), |base| base.name.clone()))
                    }
                };
                Some(ParameterValue { origin, ..value.clone() })
            }
            (None, None) => group.assumed.contains(&field.name).then(|| ParameterValue {
                group: group.name,
                field,
                value: field.start,
                origin: Origin::Assumed,
                source: "default".to_owned(),
            }),
        }
    };
    let (mut all, mut unused) = (Vec::new(), Vec::new());
    for group in catalogue.groups {
        let here: Vec<Option<ParameterValue>> = group.fields.iter().map(|field| found(group, field)).collect();
        if group.law && Some(group.name) != law {
            unused.extend(here.into_iter().collect::<Option<Vec<_>>>().into_iter().flatten());
            continue;
        }
        let missing: Vec<&str> =
            group.fields.iter().zip(&here).filter(|(_, value)| value.is_none()).map(|(field, _)| field.name).collect();
        if !missing.is_empty() && walk.problems.len() == faults {
            let fault = SetFault::Missing { group: group.name, names: missing.join(", ") };
            walk.fault(section.span_of("parameters"), fault);
        }
        all.extend(here.into_iter().flatten());
    }
    if let Some(base) = &base {
        collapse::of_another_law(&mut all, law, base.law);
    }
    let passed_over = passed_over(walk, catalogue, &values, &converted.values);
    let base = base.unwrap_or_else(|| ParameterSet::empty(catalogue.process));
    let mut prior = base.prior;
    prior.extend(converted.prior);
    let notes = converted.notes.into_iter().chain(passed_over).chain(base.notes).collect();
    let scatter = converted.scatter.or(base.scatter);
    Some(ParameterSet { law, values: all, unused, prior, scatter, notes, ..base })
}

/// The catalogue of the process: as stated, or the one that has all groups of the file.
fn catalogue(walk: &mut Walk, root: &Section<'_>, catalogues: &[&'static Catalogue]) -> Option<&'static Catalogue> {
    if let Some(process) = root.text("process") {
        let found = catalogues.iter().find(|catalogue| catalogue.process == process);
        if found.is_none() {
            let due = catalogues.first().map_or("", |catalogue| catalogue.process);
            walk.fault(root.span_of("process"), SetFault::Process { read: process.to_owned(), due });
        }
        return found.copied();
    }
    let groups: Vec<String> = match root.got("parameters").map(|got| &got.value) {
        Some(Value::Raw(DeValue::Table(table))) => table.keys().map(|key| key.get_ref().to_string()).collect(),
        _ => Vec::new(),
    };
    let fits = |catalogue: &&&Catalogue| groups.iter().all(|group| catalogue.group(group).is_some());
    catalogues.iter().find(fits).or(catalogues.first()).copied()
}

fn base(
    walk: &mut Walk,
    root: &Section<'_>,
    reference: &str,
    catalogue: &'static Catalogue,
    chain: &[PathBuf],
) -> Option<ParameterSet> {
    let span = root.span_of("based_on");
    if super::is_path(reference) {
        let path = walk.folder.join(reference);
        let real_path = std::fs::canonicalize(&path).unwrap_or(path);
        if chain.contains(&real_path) {
            walk.fault(span, SetFault::Cycle(reference.to_owned()));
            return None;
        }
    }
    if chain.len() > LONGEST_CHAIN {
        walk.fault(span, SetFault::Chain);
        return None;
    }
    match ParameterSet::load_after(reference, &walk.folder, catalogue, chain) {
        Ok(base) => Some(base),
        Err(reason) => {
            walk.fault(span, SetFault::Base(reason.to_string()));
            None
        }
    }
}

/// The values of `[parameters.*]`.
fn given(walk: &mut Walk, root: &Section<'_>, catalogue: &'static Catalogue) -> Values {
    let mut values = Values::new();
    let Some(Value::Raw(raw)) = root.got("parameters").map(|got| &got.value) else { return values };
    let example = "[parameters.limits]";
    let DeValue::Table(groups) = raw else {
        walk.wrong_type("parameters", raw, "a table of groups", root.span_of("parameters"), example.to_owned());
        return values;
    };
    for (name, entries) in groups {
        let Some(group) = catalogue.group(name.get_ref()) else {
            let known = || catalogue.groups.iter().map(|group| group.name);
            let fault = Fault::UnknownKey {
                section: "[parameters]".to_owned(),
                key: name.get_ref().to_string(),
                nearest: nearest(name.get_ref(), known()),
                known: known().collect::<Vec<_>>().join(", "),
            };
            walk.fault(name.span(), fault);
            continue;
        };
        let DeValue::Table(entries) = entries.get_ref() else {
            walk.wrong_type(
                name.get_ref(),
                entries.get_ref(),
                "a table of parameters",
                entries.span(),
                example.to_owned(),
            );
            continue;
        };
        for (name, entry) in entries {
            let known = || group.fields.iter().chain(diffusion::legacy(group.name));
            let Some(field) = known().find(|field| field.name == &**name.get_ref()) else {
                let fault = Fault::UnknownKey {
                    section: format!("[parameters.{}]", group.name),
                    key: name.get_ref().to_string(),
                    nearest: nearest(name.get_ref(), known().map(|field| field.name)),
                    known: known().map(|field| field.name).collect::<Vec<_>>().join(", "),
                };
                walk.fault(name.span(), fault);
                continue;
            };
            let DeValue::Table(table) = entry.get_ref() else {
                let example = "{ value = \"…\", source = \"…\" }".to_owned();
                walk.wrong_type(field.name, entry.get_ref(), "a value with its source", entry.span(), example);
                continue;
            };
            if let Some((value, source)) = valued(walk, field, table, entry.span()) {
                let placed = Placed { value, source, origin: Origin::Given, span: entry.span() };
                values.insert((group.name, field.name), placed);
            }
        }
    }
    values
}

/// `{ value, source }` of a parameter.
fn valued(walk: &mut Walk, field: &'static Field, table: &DeTable<'_>, span: Range<usize>) -> Option<(f64, String)> {
    let section = || format!("`{}`", field.name);
    for (key, _) in table.iter().filter(|(key, _)| !["value", "source"].contains(&&**key.get_ref())) {
        let fault = Fault::UnknownKey {
            section: section(),
            key: key.get_ref().to_string(),
            nearest: nearest(key.get_ref(), ["value", "source"]),
            known: "value, source".to_owned(),
        };
        walk.fault(key.span(), fault);
    }
    let mut due = |key: &'static str, example: &str| {
        let got = table.get(key);
        if got.is_none() {
            let fault = Fault::MissingKey { section: section(), key, example: example.to_owned() };
            walk.fault(span.clone(), fault);
        }
        got
    };
    let (value, source) = (due("value", "\"1.5 mm\""), due("source", "\"assumption\""));
    let (value, source) = (value?, source?);
    let Some(text) = source.get_ref().as_str() else {
        walk.wrong_type("source", source.get_ref(), "a line for people", source.span(), "\"assumption\"".to_owned());
        return None;
    };
    match walk.quantity(field.name, &Quantity::of(field), value) {
        Value::Si(value) => Some((value, text.to_owned())),
        Value::Count(_) | Value::Text(_) | Value::Flag(_) | Value::List(_) | Value::Raw(_) | Value::Faulty => None,
    }
}

/// The wear law of the set; `None` inside where sets of the process choose none.
fn law(
    walk: &mut Walk,
    root: &Section<'_>,
    catalogue: &'static Catalogue,
    named: &[&'static str],
    converted: &sources::Converted,
    base: Option<&ParameterSet>,
) -> Option<Option<&'static str>> {
    if catalogue.laws().next().is_none() {
        if root.given("law") {
            let applicable = "based_on, parameters, prior, scatter".to_owned();
            let case = format!("process = \"{}\"", catalogue.process);
            walk.fault(root.span_of("law"), Fault::NotApplicable { key: "law", case, applicable });
        }
        return Some(None);
    }
    let base_law = base.and_then(|base| base.law);
    let of_handbook = converted.law.filter(|_| named.is_empty() || named == ["extended_taylor"]);
    if let Some(word) = root.text("law") {
        let law = catalogue.laws().find(|law| *law == word)?;
        if !named.contains(&law) && base_law != Some(law) && converted.law != Some(law) {
            // Handbook constants with faults give no law: their faults say what to write.
            if root.given("handbook") && !walk.problems.is_empty() {
                return None;
            }
            walk.fault(root.span_of("law"), SetFault::LawWithoutGroup { law });
            return None;
        }
        return Some(Some(law));
    }
    if let ([law], Some(other)) = (named, converted.law)
        && *law != other
    {
        let reason = format!("`handbook` gives values of {other}, and `parameters` those of {law}: keep one of them");
        walk.fault(root.span_of("handbook"), SetFault::Implausible(reason));
        return None;
    }
    match (named, of_handbook, base_law) {
        ([law], ..) => Some(Some(*law)),
        ([], Some(law), _) | ([], None, Some(law)) => Some(Some(law)),
        ([], None, None) => {
            let groups = catalogue.laws().map(|law| format!("[parameters.{law}]")).collect::<Vec<_>>().join(", ");
            if walk.problems.is_empty() {
                walk.fault(
                    root.span.clone(),
                    SetFault::NoLaw(format!("one of {groups} is due, or [handbook], or `based_on`")),
                );
            }
            None
        }
        (several, ..) => {
            let (given, laws) = (several.len(), several.join(", "));
            walk.fault(root.span_of("parameters"), SetFault::Laws { given, laws });
            None
        }
    }
}

/// Handbook values that another value of the file goes before.
fn passed_over(walk: &Walk, catalogue: &Catalogue, values: &Values, converted: &Values) -> Vec<String> {
    let statement = |((group, name), stated): (&(&'static str, &'static str), &Placed)| {
        let entry = converted.get(&(*group, *name)).filter(|entry| entry.origin == Origin::Handbook)?;
        let field = catalogue.group(group)?.fields.iter().find(|field| field.name == *name)?;
        let shown = |value| display(&Quantity::of(field), value);
        (entry.value != stated.value).then(|| {
            let (stated_line, handbook_line) = (walk.line(&stated.span), walk.line(&entry.span));
            format!(
                "{group}.{name} is {}, as line {stated_line} states; the constants of line {handbook_line} would give {}",
                shown(stated.value),
                shown(entry.value)
            )
        })
    };
    values.iter().filter_map(statement).collect()
}

/// A stated wear limit must be the one for which the handbook's lives hold.
fn wear_limits(walk: &mut Walk, values: &Values, converted: &sources::Converted) {
    let key = ("limits", "wear_limit");
    let (Some(stated), Some(tested)) = (values.get(&key), converted.values.get(&key)) else { return };
    if (stated.value / tested.value - 1.0).abs() > 1e-9 {
        let shown = |value: f64| format!("{} mm", toolroom_form::significant(value * 1e3));
        let fault = SetFault::WearLimits {
            first: "limits.wear_limit".to_owned(),
            first_value: shown(stated.value),
            first_line: walk.line(&stated.span),
            second: "the wear limit of the handbook's lives".to_owned(),
            second_value: shown(tested.value),
            second_line: walk.line(&tested.span),
        };
        walk.fault(stated.span.clone(), fault);
    }
}
