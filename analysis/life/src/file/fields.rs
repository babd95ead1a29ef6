//! Numbers of the model that vary from edge to edge, and how they go together.

use super::words::FamilyWord;
use crate::measured::numbers;
use crate::study::Field;
use crate::study::edge::COORDINATES;
use crate::study::spread::{Copula, Spread};
use std::path::Path;
use toolroom_form::{Fault, Section, Walk, nearest, significant};
use toolroom_process::{Record, unit};
use toolroom_wear::{Cut, Pair};

/// What may stand before the dot in the name of a field, for messages.
const GROUPS: &str = "GROUP.NAME as in [parameters], such as limits.wear_limit; cut.NAME, such as cut.hardness";

/// The numbers that vary, and all that the file names as such, faulty ones too.
pub(super) fn fields(walk: &mut Walk, root: &Section<'_>, pair: &Pair, directory: &Path) -> (Vec<Field>, Vec<String>) {
    let mut pair = pair.clone();
    let mut targets: Vec<(String, Option<&'static str>, usize, &'static toolroom_process::Field)> = Vec::new();
    for (group, record) in pair.parameters_mut() {
        let named = record.fields().iter().enumerate();
        targets.extend(named.map(|(i, field)| (format!("{group}.{}", field.name), Some(group), i, field)));
    }
    let cut = Cut::<f64>::FIELDS.iter().enumerate();
    targets.extend(cut.map(|(i, field)| (format!("cut.{}", field.name), None, i, field)));
    let (mut fields, mut names) = (Vec::new(), Vec::<String>::new());
    for section in walk.sections(root, "field", None) {
        let Some(name) = section.text("name") else { continue };
        if names.iter().any(|known| known == name) {
            walk.fault(section.span_of("name"), Fault::DuplicateName { kind: "field", name: name.to_owned() });
        }
        names.push(name.to_owned());
        let Some((_, group, index, field)) = targets.iter().find(|(known, ..)| known == name) else {
            let all = || targets.iter().map(|target| target.0.as_str());
            let group = name.split('.').next();
            let mut known: Vec<&str> = all().filter(|known| known.split('.').next() == group).collect();
            if known.is_empty() {
                known.push(GROUPS);
            }
            let fault = Fault::UnknownName {
                kind: "field",
                name: name.to_owned(),
                nearest: nearest(name, all()).map(str::to_owned),
                known: known.join(", "),
            };
            walk.fault(section.span_of("name"), fault);
            continue;
        };
        if let Some(spread) = spread(walk, &section, field, directory) {
            fields.push(Field { name: name.to_owned(), group: *group, index: *index, spread });
        }
    }
    (fields, names)
}

/// A value in the unit of a field; `None` with or after a fault.
fn value(walk: &mut Walk, section: &Section<'_>, key: &str, unit: &'static str) -> Option<f64> {
    let text = section.text(key)?.to_owned();
    match unit::quantity(&text, unit) {
        Ok(value) => Some(value),
        Err(reason) => {
            let accepted = unit::accepted(unit);
            let example = format!("a number with one of {accepted}");
            walk.fault(section.span_of(key), Fault::Quantity { key: key.to_owned(), reason, example });
            None
        }
    }
}

fn spread(
    walk: &mut Walk,
    section: &Section<'_>,
    field: &'static toolroom_process::Field,
    directory: &Path,
) -> Option<Spread> {
    let given = |walk: &mut Walk, key: &str| value(walk, section, key, field.unit);
    let spread = match section.chosen("distribution", FamilyWord::from_word)? {
        FamilyWord::Normal => {
            Spread::Normal { mean: given(walk, "mean")?, deviation: positive(walk, section, "deviation", field.unit)? }
        }
        FamilyWord::Lognormal => {
            Spread::Lognormal { median: positive(walk, section, "median", field.unit)?, sigma: section.si("sigma")? }
        }
        FamilyWord::Weibull => {
            Spread::Weibull { scale: positive(walk, section, "scale", field.unit)?, shape: section.si("shape")? }
        }
        FamilyWord::Gamma => {
            Spread::Gamma { scale: positive(walk, section, "scale", field.unit)?, shape: section.si("shape")? }
        }
        FamilyWord::Empirical => return empirical(walk, section, field, directory),
        family @ (FamilyWord::Triangular | FamilyWord::Uniform | FamilyWord::Beta) => {
            let (low, high) = (given(walk, "low"), given(walk, "high"));
            let (low, high) = (low?, high?);
            let mode = if family == FamilyWord::Triangular { given(walk, "mode")? } else { 0.5 * (low + high) };
            if !(low < high && (low..=high).contains(&mode)) {
                let shown = |value: f64| significant(unit::convert(value, field.unit, field.display));
                let fault = Fault::Contradiction {
                    first: "low",
                    first_value: shown(low),
                    second: "high",
                    second_value: shown(high),
                    rule: "the least is below the greatest, the most likely between them",
                };
                walk.fault(section.span_of("high"), fault);
                return None;
            }
            if family == FamilyWord::Triangular {
                Spread::Triangular { low, mode, high }
            } else if family == FamilyWord::Uniform {
                Spread::Uniform { low, high }
            } else {
                Spread::Beta { low, high, alpha: section.si("alpha")?, beta: section.si("beta")? }
            }
        }
    };
    // What a field cannot hold is cut off, whether the file says so or not.
    let least = if section.given("least") { given(walk, "least")? } else { f64::NEG_INFINITY };
    let most = if section.given("most") { given(walk, "most")? } else { f64::INFINITY };
    let (low, high) = (least.max(field.min), most.min(field.max));
    if spread.quantile(0.0) >= low && spread.quantile(1.0) <= high {
        return Some(spread);
    }
    let cut = Spread::truncated(spread, low, high);
    if cut.is_none() {
        let shown = |value: f64| significant(unit::convert(value, field.unit, field.display));
        let fault = Fault::Contradiction {
            first: "least",
            first_value: shown(low),
            second: "most",
            second_value: shown(high),
            rule: "the distribution lies nearly all outside what the field can hold",
        };
        walk.fault(section.span_of("name"), fault);
    }
    cut
}

fn positive(walk: &mut Walk, section: &Section<'_>, key: &'static str, unit: &'static str) -> Option<f64> {
    let value = value(walk, section, key, unit)?;
    if value > 0.0 {
        return Some(value);
    }
    let read = section.text(key).unwrap_or_default().to_owned();
    let fault =
        Fault::OutOfRange { key: key.to_owned(), read, range: "all positive values".to_owned(), meant: Vec::new() };
    walk.fault(section.span_of(key), fault);
    None
}

fn empirical(
    walk: &mut Walk,
    section: &Section<'_>,
    field: &'static toolroom_process::Field,
    directory: &Path,
) -> Option<Spread> {
    let path = directory.join(section.text("file")?);
    let column = section.text("column")?;
    let bytes = match toolroom_form::bytes(&path) {
        Ok(bytes) => bytes,
        Err(error) => {
            let file = section.text("file").unwrap_or_default().to_owned();
            walk.fault(section.span_of("file"), Fault::Unreadable { file, reason: error.kind() });
            return None;
        }
    };
    match numbers(&path.display().to_string(), &bytes, column) {
        Ok(mut values) => {
            walk.named(path);
            values.iter_mut().for_each(|value| *value = unit::convert(*value, field.display, field.unit));
            values.sort_by(f64::total_cmp);
            Some(Spread::Empirical(values))
        }
        Err(error) => {
            walk.fault(section.span_of("file"), Fault::Table { reason: error.to_string() });
            None
        }
    }
}

/// The copula over the inputs that every study has and those that the file has `named`.
pub(super) fn copula(walk: &mut Walk, root: &Section<'_>, named: &[String]) -> Option<Copula> {
    let sections = walk.sections(root, "correlation", None);
    if sections.is_empty() {
        return None;
    }
    let names: Vec<&str> = COORDINATES.into_iter().chain(named.iter().map(String::as_str)).collect();
    let mut entries = Vec::new();
    for section in &sections {
        let mut index = |key: &str| {
            let name = section.text(key)?;
            let found = names.iter().position(|known| *known == name);
            if found.is_none() {
                let fault = Fault::UnknownName {
                    kind: "input",
                    name: name.to_owned(),
                    nearest: nearest(name, names.iter().copied()).map(str::to_owned),
                    known: names.join(", "),
                };
                walk.fault(section.span_of(key), fault);
            }
            found
        };
        let (first, second) = (index("first"), index("second"));
        let (Some(first), Some(second), Some(value)) = (first, second, section.si("value")) else { continue };
        if first == second || entries.iter().any(|(i, j, _)| [(first, second), (second, first)].contains(&(*i, *j))) {
            let fault = Fault::Contradiction {
                first: "first",
                first_value: names[first].to_owned(),
                second: "second",
                second_value: names[second].to_owned(),
                rule: "a correlation is that of two inputs, given once",
            };
            walk.fault(section.span_of("second"), fault);
            continue;
        }
        entries.push((first, second, value));
    }
    let copula = Copula::from_dimensions(names.len(), &entries);
    if copula.is_none() {
        let fault = Fault::Contradiction {
            first: "correlations",
            first_value: entries.len().to_string(),
            second: "inputs",
            second_value: names.len().to_string(),
            rule: "the correlation matrix is positive definite",
        };
        walk.fault(root.span_of("correlation"), fault);
    }
    copula
}
