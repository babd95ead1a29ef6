//! Elements and attributes that the schemas of the standards allow, with the types of their values.
//!
//! # Source
//! `fmi2ModelDescription.xsd` of FMI 2.0.5 and `fmi3ModelDescription.xsd` of FMI 3.0.2 with the files that they include. The order of
//! elements is that of the schema; what annotations hold is free.

use roxmltree::Node;

/// One element a line: its name, where needed after that of its parent; its attributes, `!` where one is required, with
/// the kind of value after `=`; after `>` the elements in it, `+` where one is required, `|` between those of which one is.
///
/// Kinds: `b` truth value, `d` real, `t` date, `i32`, `u8`, … whole numbers, `u32*` a list of them, `u32+` one of at least one,
/// `a/b` one of these words, `a/b*` a list of them; text, where there is none.
const TWO: &str = "
fmiModelDescription: fmiVersion! modelName! guid! description author version copyright license generationTool generationDateAndTime=t variableNamingConvention=flat/structured numberOfEventIndicators=u32 > ModelExchange CoSimulation UnitDefinitions TypeDefinitions LogCategories DefaultExperiment VendorAnnotations ModelVariables+ ModelStructure+
ModelExchange: modelIdentifier! needsExecutionTool=b completedIntegratorStepNotNeeded=b canBeInstantiatedOnlyOncePerProcess=b canNotUseMemoryManagementFunctions=b canGetAndSetFMUstate=b canSerializeFMUstate=b providesDirectionalDerivative=b > SourceFiles
CoSimulation: modelIdentifier! needsExecutionTool=b canHandleVariableCommunicationStepSize=b canInterpolateInputs=b maxOutputDerivativeOrder=u32 canRunAsynchronuously=b canBeInstantiatedOnlyOncePerProcess=b canNotUseMemoryManagementFunctions=b canGetAndSetFMUstate=b canSerializeFMUstate=b providesDirectionalDerivative=b > SourceFiles
SourceFiles: > File+
File: name!
UnitDefinitions: > Unit+
Unit: name! > BaseUnit DisplayUnit
BaseUnit: kg=i32 m=i32 s=i32 A=i32 K=i32 mol=i32 cd=i32 rad=i32 factor=d offset=d
DisplayUnit: name! factor=d offset=d
TypeDefinitions: > SimpleType+
SimpleType: name! description > Real|Integer|Boolean|String|Enumeration
SimpleType/Real: quantity unit displayUnit relativeQuantity=b min=d max=d nominal=d unbounded=b
SimpleType/Integer: quantity min=i32 max=i32
SimpleType/Boolean:
SimpleType/String:
SimpleType/Enumeration: quantity > Item+
Item: name! value!=i32 description
LogCategories: > Category+
Category: name! description
DefaultExperiment: startTime=d stopTime=d tolerance=d stepSize=d
VendorAnnotations: > Tool+
Tool: name! > *
ModelVariables: > ScalarVariable+
ScalarVariable: name! valueReference!=u32 description causality variability initial=exact/approx/calculated canHandleMultipleSetPerTimeInstant=b > Real|Integer|Boolean|String|Enumeration Annotations
ScalarVariable/Real: declaredType quantity unit displayUnit relativeQuantity=b min=d max=d nominal=d unbounded=b start derivative reinit=b
ScalarVariable/Integer: declaredType quantity min=i32 max=i32 start
ScalarVariable/Boolean: declaredType start
ScalarVariable/String: declaredType start
ScalarVariable/Enumeration: declaredType! quantity min=i32 max=i32 start
Annotations: > Tool+
ModelStructure: > Outputs Derivatives InitialUnknowns
Outputs: > Unknown+
Derivatives: > Unknown+
InitialUnknowns: > Unknown+
Unknown: index!=u32 dependencies=u32* dependenciesKind=dependent/constant/fixed/tunable/discrete*
";

/// As [`TWO`].
const THREE: &str = "
fmiModelDescription: fmiVersion! modelName! instantiationToken! description author version copyright license generationTool generationDateAndTime=t variableNamingConvention=flat/structured > ModelExchange CoSimulation ScheduledExecution UnitDefinitions TypeDefinitions LogCategories DefaultExperiment ModelVariables+ ModelStructure+ Annotations
ModelExchange: modelIdentifier! needsExecutionTool=b canBeInstantiatedOnlyOncePerProcess=b canGetAndSetFMUState=b canSerializeFMUState=b providesDirectionalDerivatives=b providesAdjointDerivatives=b providesPerElementDependencies=b needsCompletedIntegratorStep=b providesEvaluateDiscreteStates=b > Annotations
CoSimulation: modelIdentifier! needsExecutionTool=b canBeInstantiatedOnlyOncePerProcess=b canGetAndSetFMUState=b canSerializeFMUState=b providesDirectionalDerivatives=b providesAdjointDerivatives=b providesPerElementDependencies=b canHandleVariableCommunicationStepSize=b fixedInternalStepSize=d maxOutputDerivativeOrder=u32 recommendedIntermediateInputSmoothness=i32 providesIntermediateUpdate=b mightReturnEarlyFromDoStep=b canReturnEarlyAfterIntermediateUpdate=b hasEventMode=b providesEvaluateDiscreteStates=b > Annotations
ScheduledExecution: modelIdentifier! needsExecutionTool=b canBeInstantiatedOnlyOncePerProcess=b canGetAndSetFMUState=b canSerializeFMUState=b providesDirectionalDerivatives=b providesAdjointDerivatives=b providesPerElementDependencies=b > Annotations
UnitDefinitions: > Unit+
Unit: name! > BaseUnit DisplayUnit Annotations
BaseUnit: kg=i32 m=i32 s=i32 A=i32 K=i32 mol=i32 cd=i32 rad=i32 factor=d offset=d
DisplayUnit: name! factor=d offset=d inverse=b > Annotations
Float32Type Float64Type: name! description quantity unit displayUnit relativeQuantity=b unbounded=b min=d max=d nominal=d > Annotations
Int8Type: name! description quantity min=i8 max=i8 > Annotations
UInt8Type: name! description quantity min=u8 max=u8 > Annotations
Int16Type: name! description quantity min=i16 max=i16 > Annotations
UInt16Type: name! description quantity min=u16 max=u16 > Annotations
Int32Type: name! description quantity min=i32 max=i32 > Annotations
UInt32Type: name! description quantity min=u32 max=u32 > Annotations
Int64Type: name! description quantity min=i64 max=i64 > Annotations
UInt64Type: name! description quantity min=u64 max=u64 > Annotations
BooleanType StringType: name! description > Annotations
BinaryType: name! description mimeType maxSize=u64 > Annotations
EnumerationType: name! description quantity min=i64 max=i64 > Item+ Annotations
Item: name! value!=i64 description > Annotations
ClockType: name! description canBeDeactivated=b priority=u32 intervalVariability!=constant/fixed/tunable/changing/countdown/triggered intervalDecimal=d shiftDecimal=d supportsFraction=b resolution=u64 intervalCounter=u64 shiftCounter=u64 > Annotations
LogCategories: > Category+
Category: name! description > Annotations
DefaultExperiment: startTime=d stopTime=d tolerance=d stepSize=d > Annotations
Float32 Float64: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType initial=exact/approx/calculated quantity unit displayUnit relativeQuantity=b unbounded=b min=d max=d nominal=d start derivative reinit=b > Dimension Alias Annotations
Int8: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType initial=exact/approx/calculated quantity min=i8 max=i8 start > Dimension Alias Annotations
UInt8: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType initial=exact/approx/calculated quantity min=u8 max=u8 start > Dimension Alias Annotations
Int16: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType initial=exact/approx/calculated quantity min=i16 max=i16 start > Dimension Alias Annotations
UInt16: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType initial=exact/approx/calculated quantity min=u16 max=u16 start > Dimension Alias Annotations
Int32: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType initial=exact/approx/calculated quantity min=i32 max=i32 start > Dimension Alias Annotations
UInt32: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType initial=exact/approx/calculated quantity min=u32 max=u32 start > Dimension Alias Annotations
Int64: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType initial=exact/approx/calculated quantity min=i64 max=i64 start > Dimension Alias Annotations
UInt64: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType initial=exact/approx/calculated quantity min=u64 max=u64 start > Dimension Alias Annotations
Boolean: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType initial=exact/approx/calculated start > Dimension Alias Annotations
String: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType initial=exact/approx/calculated > Dimension Start Alias Annotations
Binary: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType initial=exact/approx/calculated mimeType maxSize=u64 > Dimension Start Alias Annotations
Enumeration: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ intermediateUpdate=b previous=u32 declaredType! initial=exact/approx/calculated quantity min=i64 max=i64 start > Dimension Alias Annotations
Clock: name! valueReference!=u32 description causality variability canHandleMultipleSetPerTimeInstant=b clocks=u32+ declaredType canBeDeactivated=b priority=u32 intervalVariability!=constant/fixed/tunable/changing/countdown/triggered intervalDecimal=d shiftDecimal=d supportsFraction=b resolution=u64 intervalCounter=u64 shiftCounter=u64 > Alias Annotations
Dimension: start=u64 valueReference=u32
Start: value
Alias: name! description displayUnit
Annotations: > Annotation+
Annotation: type! > *
ModelStructure: > Output ContinuousStateDerivative ClockedState InitialUnknown EventIndicator
Output ContinuousStateDerivative ClockedState InitialUnknown EventIndicator: valueReference!=u32 dependencies=u32* dependenciesKind=dependent/constant/fixed/tunable/discrete* > Annotations
";

/// Lists of elements of several kinds in any order, which have no rule of their own, with what only such elements have and
/// what they are called.
const MIXED: [(&str, &str, &str); 2] =
    [("ModelVariables", "causality", "type of variable"), ("TypeDefinitions", "Type", "definition of a type")];

/// Elements of which a parent may hold several.
const SEVERAL: [&str; 18] = [
    "Alias",
    "Annotation",
    "Category",
    "Dimension",
    "DisplayUnit",
    "File",
    "Item",
    "ScalarVariable",
    "SimpleType",
    "Start",
    "Tool",
    "Unit",
    "Unknown",
    "Output",
    "ContinuousStateDerivative",
    "ClockedState",
    "InitialUnknown",
    "EventIndicator",
];

/// What the schema of a version says against an element and all in it: the element and the words.
pub(super) fn faults<'a, 'i>(root: Node<'a, 'i>, major: u8) -> Vec<(Node<'a, 'i>, String)> {
    let table = if major == 2 { TWO } else { THREE };
    let mut faults = Vec::new();
    let mut open = vec![root];
    while let Some(node) = open.pop() {
        let name = node.tag_name().name();
        let parent = node.parent().map_or("", |parent| parent.tag_name().name());
        let mixed = MIXED.iter().find(|(list, ..)| *list == name).filter(|_| rule(table, name).is_none());
        if let Some((_, mark, kind)) = mixed {
            faults.extend(attribute_faults(node, "").into_iter().map(|message| (node, message)));
            let belongs = |name: &str| {
                name.ends_with(mark) && rule(table, name).is_some()
                    || rule(table, name).is_some_and(|rule| rule.split(' ').any(|word| word == *mark))
            };
            let others = node.children().filter(|child| child.is_element() && !belongs(child.tag_name().name()));
            faults.extend(others.map(|child| (child, format!("<{}> is no {kind}", child.tag_name().name()))));
        }
        let Some(rule) = rule(table, &format!("{parent}/{name}")).or_else(|| rule(table, name)) else {
            // A list that may hold several kinds, or what the schema does not have, which its parent has told.
            open.extend(node.children().filter(Node::is_element));
            continue;
        };
        let (attributes, inside) = rule.split_once('>').unwrap_or((rule, ""));
        faults.extend(attribute_faults(node, attributes).into_iter().map(|message| (node, message)));
        if inside.trim() != "*" {
            faults.extend(element_faults(node, inside, major));
            open.extend(node.children().filter(Node::is_element));
        }
    }
    faults
}

/// The rule of an element.
fn rule(table: &'static str, name: &str) -> Option<&'static str> {
    let mut rules = table.lines().filter_map(|line| line.split_once(':'));
    rules.find(|(names, _)| names.split(' ').any(|each| each == name)).map(|(_, rule)| rule)
}

fn attribute_faults(node: Node<'_, '_>, attributes: &str) -> Vec<String> {
    let element = node.tag_name().name();
    let mut known = Vec::new();
    let mut faults = Vec::new();
    for attribute in attributes.split_whitespace() {
        let (name, kind) = attribute.split_once('=').unwrap_or((attribute, ""));
        let (name, required) = name.strip_suffix('!').map_or((name, false), |name| (name, true));
        known.push(name);
        match node.attribute(name) {
            None if required => faults.push(format!("<{element}> lacks the attribute {name}")),
            Some(value) if !fits(value, kind) => faults.push(format!("{name} = \"{value}\" is {}", due(kind))),
            Some(_) | None => {}
        }
    }
    let plain = node.attributes().filter(|attribute| attribute.namespace().is_none());
    let unknown = plain.filter(|attribute| !known.contains(&attribute.name()));
    faults.extend(unknown.map(|attribute| format!("<{element}> has no attribute {}", attribute.name())));
    faults
}

fn element_faults<'a, 'i>(node: Node<'a, 'i>, inside: &str, major: u8) -> Vec<(Node<'a, 'i>, String)> {
    let parent = node.tag_name().name();
    let mut faults = Vec::new();
    let words = || inside.split_whitespace();
    let has = |name: &str| node.children().any(|child| child.is_element() && child.tag_name().name() == name);
    for word in words() {
        let choices: Vec<&str> = word.trim_end_matches('+').split('|').collect();
        if (word.ends_with('+') || choices.len() > 1) && !choices.iter().any(|name| has(name)) {
            faults.push((node, format!("<{parent}> lacks <{}>", choices.join("> or <"))));
        }
    }
    let (mut reached, mut last) = (0, "");
    for child in node.children().filter(Node::is_element) {
        let name = child.tag_name().name();
        let place = words().position(|word| word.trim_end_matches('+').split('|').any(|known| known == name));
        // FMI 2.0 has its two interfaces in either order.
        let place =
            place.map(|place| if major == 2 && parent == "fmiModelDescription" && place <= 1 { 1 } else { place });
        if let Some(place) = place {
            let before = child.prev_siblings().skip(1).filter(Node::is_element);
            let again = before.map(|each| each.tag_name().name()).any(|each| each == name);
            let choice = place == reached
                && !last.is_empty()
                && name != last
                && words().nth(place).is_some_and(|word| word.contains('|'));
            if (again || choice) && !SEVERAL.contains(&name) {
                faults.push((child, format!("<{parent}> has more than one <{}>", if again { name } else { last })));
            } else if place < reached {
                faults.push((child, format!("<{name}> stands after <{last}>, and belongs before it")));
            }
            if place >= reached {
                (reached, last) = (place, name);
            }
        }
        if !words().any(|word| word.trim_end_matches('+').split('|').any(|known| known == name)) {
            faults.push((child, format!("<{name}> is no element of <{parent}>")));
        }
    }
    faults
}

/// Whether an attribute is of a kind.
fn fits(value: &str, kind: &str) -> bool {
    if let Some(item) = kind.strip_suffix(['*', '+']) {
        let mut values = value.split_whitespace().peekable();
        return (kind.ends_with('*') || values.peek().is_some()) && values.all(|value| fits(value, item));
    }
    let value = value.trim();
    // The schemas have no sign of exponents or infinities that Rust does not read; it reads more.
    let whole =
        |least: i128, greatest: i128| value.parse::<i128>().is_ok_and(|number| (least..=greatest).contains(&number));
    match kind {
        "" => true,
        "b" => matches!(value, "true" | "false" | "1" | "0"),
        "d" => value.parse::<f64>().is_ok(),
        "t" => is_date(value),
        "i8" => whole(i8::MIN.into(), i8::MAX.into()),
        "u8" => whole(0, u8::MAX.into()),
        "i16" => whole(i16::MIN.into(), i16::MAX.into()),
        "u16" => whole(0, u16::MAX.into()),
        "i32" => whole(i32::MIN.into(), i32::MAX.into()),
        "u32" => whole(0, u32::MAX.into()),
        "i64" => whole(i64::MIN.into(), i64::MAX.into()),
        "u64" => whole(0, u64::MAX.into()),
        words => words.split('/').any(|word| word == value),
    }
}

/// What is wrong with a value that is not of a kind.
fn due(kind: &str) -> String {
    match kind.trim_end_matches(['*', '+']) {
        "b" => "neither true nor false".to_owned(),
        "d" => "no number".to_owned(),
        "t" => "no date of the form YYYY-MM-DDThh:mm:ssZ".to_owned(),
        whole if whole.contains(|letter: char| letter.is_ascii_digit()) => {
            let (sign, bits) = whole.split_at(1);
            format!("no {}whole number of {bits} bits", if sign == "u" { "unsigned " } else { "" })
        }
        words => format!("none of {}", words.replace('/', ", ")),
    }
}

/// `2026-11-21T15:00:00`, with a fraction of a second and a time zone or without.
fn is_date(text: &str) -> bool {
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let parts = |text: &str, between: char| -> Vec<usize> {
        text.split(between).map(|part| if digits(part) { part.len() } else { 0 }).collect()
    };
    let Some((date, time)) = text.split_once('T') else { return false };
    let (time, zone) = match time.find(['Z', '+', '-']) {
        Some(at) => time.split_at(at),
        None => (time, "Z"),
    };
    let (time, fraction) = time.split_once('.').unwrap_or((time, "0"));
    let zoned = zone == "Z" || parts(&zone[1..], ':') == [2, 2];
    let dated = matches!(parts(date.trim_start_matches('-'), '-')[..], [year, 2, 2] if year >= 4);
    dated && parts(time, ':') == [2, 2, 2] && digits(fraction) && zoned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_told_from_other_words() {
        for date in ["2026-11-21T15:00:00Z", "2026-11-21T15:00:00.25+01:00", "2026-11-21T15:00:00"] {
            assert!(is_date(date), "{date}");
        }
        for other in ["", "today", "2026-11-21", "2026-11-21T15:00Z", "2026-11-21T15:00:00+1", "26-11-21T15:00:00Z"] {
            assert!(!is_date(other), "{other}");
        }
    }

    #[test]
    fn every_rule_is_one_line_of_known_kinds() {
        for table in [TWO, THREE] {
            for line in table.lines().filter(|line| !line.is_empty()) {
                let (names, rule) = line.split_once(':').expect("a name");
                assert!(!names.is_empty() && !rule.contains(':'), "{line}");
                let (attributes, _) = rule.split_once('>').unwrap_or((rule, ""));
                for (_, kind) in attributes.split_whitespace().filter_map(|attribute| attribute.split_once('=')) {
                    let kind = kind.trim_end_matches(['*', '+']);
                    assert!(
                        kind.contains('/') || ["b", "d", "t"].contains(&kind) || !due(kind).contains("none of"),
                        "{line}"
                    );
                }
            }
        }
    }
}
