//! Units of a formula, checked on its tree.

use super::expression::{Binary, FormulaError, Function, Node, NodeKind, Unary};
use toolroom_process::unit;

/// Powers of metre, kilogram, second, kelvin, ampere, mole, revolution, currency.
pub(crate) type Powers = [f64; 8];

const NUMBER: Powers = [0.0; 8];
const KELVIN: Powers = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
/// Powers that differ by less are the same: square roots of squares.
const SAME: f64 = 1e-9;

/// Powers of an SI unit.
pub(crate) fn powers(si: &str) -> Powers {
    unit::parse(si).map_or(NUMBER, |unit| unit.dimension.map(f64::from))
}

fn same(a: &Powers, b: &Powers) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME)
}

/// A unit in words: `number`, `m`, `m kg/s2`.
pub(crate) fn words(powers: &Powers) -> String {
    if same(powers, &NUMBER) {
        return "a number".to_owned();
    }
    si_text(powers)
}

/// A unit as text that can be read again, in base units.
pub(crate) fn si_text(powers: &Powers) -> String {
    const SYMBOLS: [&str; 8] = ["m", "kg", "s", "K", "A", "mol", "rev", "EUR"];
    let part = |wanted: f64| {
        let parts = SYMBOLS.iter().zip(powers).filter(|(_, power)| **power * wanted > SAME);
        let symbol = |(symbol, power): (&&str, &f64)| match power.abs() {
            one if (one - 1.0).abs() < SAME => (*symbol).to_owned(),
            power => format!("{symbol}{power}"),
        };
        parts.map(symbol).collect::<Vec<_>>()
    };
    let (over, under) = (part(1.0), part(-1.0));
    match (over.is_empty(), under.is_empty()) {
        (true, true) => "1".to_owned(),
        (_, true) => over.join(" "),
        (true, false) => format!("1/{}", under.join(" ")),
        (false, false) => format!("{}/{}", over.join(" "), under.join(" ")),
    }
}

/// The unit of a part, and whether it is a temperature on a scale rather than a difference of temperatures.
struct Meaning {
    powers: Powers,
    celsius: bool,
}

fn refused(node: &Node, message: impl Into<String>) -> FormulaError {
    FormulaError { code: "effect-unit", message: message.into(), span: node.span.clone() }
}

/// Unit of a formula over quantities of the units `names`.
///
/// # Errors
/// [`FormulaError`] where units do not fit.
pub(crate) fn of(node: &Node, names: &[Powers]) -> Result<Powers, FormulaError> {
    difference(node, names)
}

/// Unit of a part that may be no temperature on the scale of Celsius.
fn difference(node: &Node, names: &[Powers]) -> Result<Powers, FormulaError> {
    let meant = meaning(node, names)?;
    if meant.celsius {
        let message = "a temperature in degC stands beside another temperature only (compared, subtracted, min, max); a difference is in K";
        return Err(refused(node, message));
    }
    Ok(meant.powers)
}

fn number(node: &Node, names: &[Powers], whose: &str) -> Result<(), FormulaError> {
    let base = difference(node, names)?;
    if same(&base, &NUMBER) {
        Ok(())
    } else {
        Err(refused(node, format!("{whose} needs a number, has {}", words(&base))))
    }
}

/// Two parts of one unit: that unit, and which of them are temperatures on the scale of Celsius.
fn alike(sign: &str, node: &Node, right: &Node, names: &[Powers]) -> Result<(Powers, [bool; 2]), FormulaError> {
    let (a, b) = (meaning(node, names)?, meaning(right, names)?);
    if same(&a.powers, &b.powers) {
        return Ok((a.powers, [a.celsius, b.celsius]));
    }
    let message = format!("`{sign}` needs equal units: {} and {}", words(&a.powers), words(&b.powers));
    Err(FormulaError { code: "effect-unit", message, span: node.span.start..right.span.end })
}

fn meaning(node: &Node, names: &[Powers]) -> Result<Meaning, FormulaError> {
    let plain = |powers: Powers| Ok(Meaning { powers, celsius: false });
    match &node.kind {
        NodeKind::Number(_, dimension) => plain(dimension.map(f64::from)),
        NodeKind::Celsius(_) => Ok(Meaning { powers: KELVIN, celsius: true }),
        NodeKind::Name(slot) => plain(names.get(*slot).copied().unwrap_or(NUMBER)),
        NodeKind::Unary(Unary::Negative, of) => plain(difference(of, names)?),
        NodeKind::Unary(Unary::Not, of) => number(of, names, "not").and_then(|()| plain(NUMBER)),
        NodeKind::Binary(operator, left, right) => binary(node, *operator, left, right, names),
        NodeKind::Call(function, arguments) => call(*function, arguments, names),
    }
}

fn binary(node: &Node, operator: Binary, left: &Node, right: &Node, names: &[Powers]) -> Result<Meaning, FormulaError> {
    let plain = |powers: Powers| Ok(Meaning { powers, celsius: false });
    match operator {
        Binary::Add => {
            let (powers, celsius) = alike("+", left, right, names)?;
            if celsius.contains(&true) {
                difference(if celsius[0] { left } else { right }, names)?;
            }
            plain(powers)
        }
        Binary::Subtract => {
            let (powers, celsius) = alike("-", left, right, names)?;
            // A temperature less one in degC is a difference; a number with a unit is a difference already.
            let literal = |node: &Node| matches!(node.kind, NodeKind::Number(..));
            if (celsius[1] && literal(left)) || (celsius[0] && literal(right)) {
                difference(if celsius[0] { left } else { right }, names)?;
            }
            plain(powers)
        }
        Binary::Multiply | Binary::Divide => {
            let (a, b) = (difference(left, names)?, difference(right, names)?);
            let sign = if operator == Binary::Multiply { 1.0 } else { -1.0 };
            plain(std::array::from_fn(|i| a[i] + sign * b[i]))
        }
        Binary::Power => power(node, left, right, names),
        Binary::Less
        | Binary::LessOrEqual
        | Binary::Greater
        | Binary::GreaterOrEqual
        | Binary::Equal
        | Binary::Unequal => {
            alike("comparison", left, right, names)?;
            plain(NUMBER)
        }
        Binary::And | Binary::Or => {
            let word = if operator == Binary::And { "and" } else { "or" };
            number(left, names, word)?;
            number(right, names, word)?;
            plain(NUMBER)
        }
    }
}

fn power(node: &Node, base: &Node, exponent: &Node, names: &[Powers]) -> Result<Meaning, FormulaError> {
    let base_dimension = difference(base, names)?;
    number(exponent, names, "the exponent of ^")?;
    if same(&base_dimension, &NUMBER) {
        return Ok(Meaning { powers: NUMBER, celsius: false });
    }
    match constant(exponent) {
        Some(exponent) => Ok(Meaning { powers: base_dimension.map(|power| power * exponent), celsius: false }),
        None => {
            let message =
                format!("the base has the unit {}: the exponent of ^ is a constant there", words(&base_dimension));
            Err(refused(node, message))
        }
    }
}

/// Value of a part without names.
pub(crate) fn constant(node: &Node) -> Option<f64> {
    match &node.kind {
        NodeKind::Number(value, _) => Some(*value),
        NodeKind::Celsius(_) | NodeKind::Name(_) | NodeKind::Call(..) => None,
        NodeKind::Unary(Unary::Negative, of) => constant(of).map(|value| -value),
        NodeKind::Unary(Unary::Not, _) => None,
        NodeKind::Binary(operator, left, right) => {
            let (a, b) = (constant(left)?, constant(right)?);
            match operator {
                Binary::Add => Some(a + b),
                Binary::Subtract => Some(a - b),
                Binary::Multiply => Some(a * b),
                Binary::Divide => Some(a / b),
                Binary::Power => Some(a.powf(b)),
                Binary::Less
                | Binary::LessOrEqual
                | Binary::Greater
                | Binary::GreaterOrEqual
                | Binary::Equal
                | Binary::Unequal
                | Binary::And
                | Binary::Or => None,
            }
        }
    }
}

fn call(function: Function, arguments: &[Node], names: &[Powers]) -> Result<Meaning, FormulaError> {
    let word = function.word();
    let plain = |powers: Powers| Ok(Meaning { powers, celsius: false });
    match function {
        Function::If => {
            number(&arguments[0], names, "the condition of if")?;
            let (powers, [a, b]) = alike("if", &arguments[1], &arguments[2], names)?;
            if a != b {
                difference(&arguments[if a { 1 } else { 2 }], names)?;
            }
            Ok(Meaning { powers, celsius: a })
        }
        Function::Minimum | Function::Maximum => {
            let mut celsius = true;
            for other in &arguments[1..] {
                let (_, both) = alike(word, &arguments[0], other, names)?;
                celsius &= both[0] && both[1];
            }
            Ok(Meaning { powers: meaning(&arguments[0], names)?.powers, celsius })
        }
        Function::Absolute => plain(difference(&arguments[0], names)?),
        Function::SquareRoot => plain(difference(&arguments[0], names)?.map(|power| 0.5 * power)),
        Function::Exponential
        | Function::Logarithm
        | Function::Sine
        | Function::Cosine
        | Function::HyperbolicTangent
        | Function::Step => number(&arguments[0], names, word).and_then(|()| plain(NUMBER)),
        Function::Bump => {
            alike(word, &arguments[0], &arguments[1], names)?;
            let (_, celsius) = alike(word, &arguments[0], &arguments[2], names)?;
            if celsius[1] {
                difference(&arguments[2], names)?;
            }
            plain(NUMBER)
        }
    }
}

/// That a factor is a number, or a summand has the unit of its term.
///
/// # Errors
/// [`FormulaError`] with the part that has another unit.
pub(crate) fn fits(node: &Node, names: &[Powers], term: &Powers, factor: bool) -> Result<(), FormulaError> {
    if factor
        && let NodeKind::Binary(Binary::Add | Binary::Subtract, left, right) = &node.kind
        && let (Ok(a), Ok(b)) = (of(left, names), of(right, names))
        && !same(&a, &b)
    {
        let (part, has) = if same(&a, &NUMBER) { (right, b) } else { (left, a) };
        return Err(refused(part, format!("a factor is a number; the term is {}", words(&has))));
    }
    let part = of(node, names)?;
    if same(&part, if factor { &NUMBER } else { term }) {
        return Ok(());
    }
    let message = if factor {
        format!("a factor is a number; this one is {}", words(&part))
    } else {
        format!("a summand has the unit of its term, {}; this one is {}", words(term), words(&part))
    };
    Err(refused(node, message))
}
