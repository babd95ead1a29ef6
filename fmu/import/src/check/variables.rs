//! Variables: names, units, ranges, start values, combinations that the standard allows.

use super::{Findings, Rule, Severity};
use crate::description::{Dimension, ModelDescription, ValueType, Variable};
use std::collections::{BTreeMap, HashMap};

pub(super) fn check(description: &ModelDescription, findings: &mut Findings) {
    for variable in &description.variables {
        let mut fault = |message: String| {
            findings.line(Rule::Description, Severity::Error, variable.line, format!("{}: {message}", variable.name));
        };
        for message in combination(description, variable).into_iter().chain(range(variable)) {
            fault(message);
        }
        if let Some(unit) = variable.unit.as_ref().filter(|unit| !description.units.contains_key(*unit)) {
            fault(format!("unit \"{unit}\" is not among the <UnitDefinitions>"));
        }
        if let Some(name) = variable.declared_type.as_ref().filter(|name| !description.types.contains_key(*name)) {
            fault(format!("type \"{name}\" is not among the <TypeDefinitions>"));
        }
    }
    references(description, findings);
    independent(description, findings);
    if !identifier_fits(description) {
        findings.whole(Rule::Description, Severity::Error, "a modelIdentifier is no C identifier");
    }
    if let Some(date) = description.about.get("generationDateAndTime")
        && !is_utc(date)
    {
        let message = format!("generationDateAndTime = \"{date}\" is not of the form YYYY-MM-DDThh:mm:ssZ");
        findings.whole(Rule::Description, Severity::Warning, message);
    }
}

/// Causality, variability, initial and start value that contradict each other.
fn combination(description: &ModelDescription, variable: &Variable) -> Vec<String> {
    let mut faults = Vec::new();
    let Variable { causality, variability, .. } = variable;
    let major = description.major;
    let causalities: &[&str] = &[
        "input",
        "output",
        "parameter",
        "calculatedParameter",
        "local",
        "independent",
        "structuralParameter",
        "dependent",
    ];
    if !causalities.contains(&causality.as_str())
        || (major == 2 && matches!(causality.as_str(), "structuralParameter" | "dependent"))
    {
        return vec![format!("causality \"{causality}\" is not known")];
    }
    let allowed: &[&str] = match causality.as_str() {
        "parameter" | "calculatedParameter" | "structuralParameter" => &["fixed", "tunable"],
        "input" => &["discrete", "continuous"],
        "independent" => &["continuous"],
        "output" => &["constant", "discrete", "continuous"],
        _ => &["constant", "fixed", "tunable", "discrete", "continuous"],
    };
    // FMI 3.0 has clocks and triggered variables beside continuous time.
    if !allowed.contains(&variability.as_str()) {
        faults.push(format!("a variable of causality {causality} cannot be {variability}"));
    }
    let initials: &[&str] = match (causality.as_str(), variability.as_str()) {
        ("independent", _) => &[],
        ("parameter" | "structuralParameter" | "input", _) | ("output" | "local", "constant") => &["exact"],
        ("calculatedParameter", _) | ("local", "fixed" | "tunable") => &["calculated", "approx"],
        _ => &["exact", "calculated", "approx"],
    };
    if let Some(initial) = variable.initial.as_deref().filter(|initial| !initials.contains(initial)) {
        let due = if initials.is_empty() { "neither known nor unknown".to_owned() } else { initials.join(" or ") };
        faults.push(format!("a {variability} variable of causality {causality} is {due} at first, not {initial}"));
    }
    let float = matches!(variable.value_type, ValueType::Float64 | ValueType::Float32);
    if variability == "continuous" && !float {
        faults.push(format!("only reals are continuous, this is a {}", variable.value_type));
    }
    let needs_start = matches!(causality.as_str(), "input" | "parameter" | "structuralParameter")
        || variability == "constant"
        || matches!(variable.initial.as_deref(), Some("exact" | "approx"));
    let clock = variable.value_type == ValueType::Clock;
    if needs_start && variable.start.is_none() && !clock {
        faults.push("a start value is due".to_owned());
    }
    if variable.start.is_some() && variable.initial.as_deref() == Some("calculated") {
        faults.push("a calculated variable has no start value".to_owned());
    }
    faults.extend(start(variable));
    faults.extend(size(description, variable));
    faults
}

/// A start value that is no value of the variable's type.
fn start(variable: &Variable) -> Option<String> {
    let text = variable.start.as_deref()?;
    let fits = |each: &str| match variable.value_type {
        ValueType::Float64 | ValueType::Float32 => each.parse::<f64>().is_ok_and(f64::is_finite),
        ValueType::Integer(bits, signed) => {
            let least = if signed { -(1i128 << (bits - 1)) } else { 0 };
            let values = least..least + (1i128 << bits);
            each.parse::<i128>().is_ok_and(|value| values.contains(&value))
        }
        ValueType::Enumeration => each.parse::<i64>().is_ok(),
        ValueType::Boolean => matches!(each, "true" | "false" | "1" | "0"),
        // Bytes of two hexadecimal digits each.
        ValueType::Binary => each.len().is_multiple_of(2) && each.bytes().all(|digit| digit.is_ascii_hexdigit()),
        ValueType::String | ValueType::Clock => true,
    };
    (!text.split_whitespace().all(fits)).then(|| format!("start = \"{text}\" is no {}", variable.value_type))
}

/// Dimensions of no known size, and start values that are not as many as the array has elements.
fn size(description: &ModelDescription, variable: &Variable) -> Option<String> {
    for dimension in &variable.dimensions {
        let Dimension::Of(reference) = *dimension else { continue };
        let referenced = description.variables.iter().find(|each| each.reference == reference);
        let sizes = |referenced: &&Variable| {
            referenced.causality == "structuralParameter" || referenced.variability == "constant"
        };
        if !referenced
            .is_some_and(|referenced| sizes(&referenced) && referenced.value_type == ValueType::Integer(64, false))
        {
            return Some(format!("the dimension {reference} is no structural parameter or constant of type UInt64"));
        }
    }
    // A text may hold spaces, and a binary value is one word.
    if matches!(variable.value_type, ValueType::String | ValueType::Binary | ValueType::Clock) {
        return None;
    }
    let given = variable.start.as_deref()?.split_whitespace().count() as u64;
    let elements: u64 = description.extents(variable, &BTreeMap::new())?.iter().product();
    (given != elements && (given != 1 || variable.dimensions.is_empty()))
        .then(|| format!("{given} start values for {elements}"))
}

fn range(variable: &Variable) -> Vec<String> {
    let mut faults = Vec::new();
    if let (Some(min), Some(max)) = (variable.min, variable.max)
        && min > max
    {
        faults.push(format!("min = {min} is above max = {max}"));
    }
    let start = variable.start.as_deref().and_then(|text| text.trim().parse::<f64>().ok());
    if let Some(start) = start.filter(|_| variable.value_type != ValueType::String)
        && (variable.min.is_some_and(|min| start < min) || variable.max.is_some_and(|max| start > max))
    {
        faults.push(format!("start = {start} is outside its range"));
    }
    if variable.nominal.is_some_and(|nominal| nominal <= 0.0) {
        faults.push("nominal is not positive".to_owned());
    }
    faults
}

/// FMI 3.0 gives every variable its own reference; FMI 2.0 shares one among aliases of a type.
fn references(description: &ModelDescription, findings: &mut Findings) {
    let mut seen: HashMap<(u32, Option<ValueType2>), &Variable> = HashMap::new();
    for variable in &description.variables {
        let class = (description.major == 2).then(|| ValueType2::from_value_type(variable.value_type));
        let Some(before) = seen.insert((variable.reference, class), variable) else { continue };
        let message = format!("{} and {} share the value reference {}", before.name, variable.name, variable.reference);
        if description.major == 3 {
            findings.line(Rule::Description, Severity::Error, variable.line, message);
        } else if before.unit != variable.unit {
            let message = format!("{message}, but not the unit");
            findings.line(Rule::Description, Severity::Error, variable.line, message);
        }
    }
}

/// The four families of functions of FMI 2.0, each with its own references.
#[derive(PartialEq, Eq, Hash)]
enum ValueType2 {
    Real,
    Integer,
    Boolean,
    String,
}

impl ValueType2 {
    fn from_value_type(value_type: ValueType) -> Self {
        match value_type {
            ValueType::Float64 | ValueType::Float32 => Self::Real,
            ValueType::Integer(..) | ValueType::Enumeration => Self::Integer,
            ValueType::Boolean => Self::Boolean,
            ValueType::String | ValueType::Binary | ValueType::Clock => Self::String,
        }
    }
}

fn independent(description: &ModelDescription, findings: &mut Findings) {
    let times: Vec<&Variable> =
        description.variables.iter().filter(|variable| variable.causality == "independent").collect();
    if times.len() > 1 {
        findings.line(Rule::Description, Severity::Error, times[1].line, "there is more than one independent variable");
    } else if times.is_empty() && description.major == 3 {
        findings.whole(Rule::Description, Severity::Error, "FMI 3 asks for an independent variable, usually time");
    }
    if description.major == 2 && !times.is_empty() {
        let message = "importers based on FMI Library ask for a start value of the independent variable; it may be left out in FMI 2.0";
        findings.line(Rule::Description, Severity::Note, times[0].line, message);
    }
}

fn identifier_fits(description: &ModelDescription) -> bool {
    description.interfaces().all(|(_, interface)| {
        let mut letters = interface.identifier.chars();
        letters.next().is_some_and(|first| first.is_ascii_alphabetic() || first == '_')
            && letters.all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
    })
}

/// `2026-11-21T15:00:00Z`.
fn is_utc(date: &str) -> bool {
    let form = b"dddd-dd-ddTdd:dd:ddZ";
    date.len() == form.len()
        && date.bytes().zip(form).all(|(read, due)| if *due == b'd' { read.is_ascii_digit() } else { read == *due })
}
