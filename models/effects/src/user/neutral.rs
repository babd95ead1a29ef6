//! That an effect of size zero changes nothing, and that no context drives a term out of its range.

use super::change::Change;
use super::dimension::constant;
use super::expression::{Binary, FormulaError, Function, Node, NodeKind, Unary};
use super::program::{Place, SHAPES, place};
use super::slots::Quantity;
use crate::Context;
use toolroom_process::Field;

/// Contexts at which neutrality is tried.
const NEUTRAL_POINTS: usize = 200;
/// Contexts at which the range of a term is tried.
const RANGE_POINTS: usize = 1000;

/// A formula at size zero, as far as its tree tells.
enum ZeroForm {
    /// This number, whatever the context.
    Number(f64),
    /// Anything.
    Open,
}

/// Value of a formula at size zero where its tree tells that it is the same in all contexts.
fn at_zero(node: &Node) -> ZeroForm {
    if let Some(value) = constant(node) {
        return ZeroForm::Number(value);
    }
    match &node.kind {
        NodeKind::Number(value, _) | NodeKind::Celsius(value) => ZeroForm::Number(*value),
        NodeKind::Name(slot) if place(*slot) == Place::Size => ZeroForm::Number(0.0),
        NodeKind::Name(_) => ZeroForm::Open,
        NodeKind::Unary(Unary::Negative, of) => match at_zero(of) {
            ZeroForm::Number(value) => ZeroForm::Number(-value),
            ZeroForm::Open => ZeroForm::Open,
        },
        NodeKind::Unary(Unary::Not, of) => match at_zero(of) {
            ZeroForm::Number(value) => ZeroForm::Number(f64::from(u8::from(value == 0.0))),
            ZeroForm::Open => ZeroForm::Open,
        },
        NodeKind::Binary(operator, left, right) => binary_at_zero(*operator, at_zero(left), at_zero(right)),
        NodeKind::Call(function, arguments) => {
            let values: Vec<ZeroForm> = arguments.iter().map(at_zero).collect();
            called_at_zero(*function, &values)
        }
    }
}

fn binary_at_zero(operator: Binary, left: ZeroForm, right: ZeroForm) -> ZeroForm {
    let truth = |holds: bool| ZeroForm::Number(f64::from(u8::from(holds)));
    match (operator, left, right) {
        // What is finite everywhere, which the range of the term asks for, times nothing is nothing.
        (Binary::Multiply, ZeroForm::Number(0.0), _) | (Binary::Multiply, _, ZeroForm::Number(0.0)) => {
            ZeroForm::Number(0.0)
        }
        (Binary::Divide, ZeroForm::Number(0.0), _) => ZeroForm::Number(0.0),
        (Binary::Power, _, ZeroForm::Number(0.0)) | (Binary::Power, ZeroForm::Number(1.0), _) => ZeroForm::Number(1.0),
        (_, ZeroForm::Number(a), ZeroForm::Number(b)) => match operator {
            Binary::Add => ZeroForm::Number(a + b),
            Binary::Subtract => ZeroForm::Number(a - b),
            Binary::Multiply => ZeroForm::Number(a * b),
            Binary::Divide => ZeroForm::Number(a / b),
            Binary::Power => ZeroForm::Number(a.powf(b)),
            Binary::Less => truth(a < b),
            Binary::LessOrEqual => truth(a <= b),
            Binary::Greater => truth(a > b),
            Binary::GreaterOrEqual => truth(a >= b),
            Binary::Equal => truth(a == b),
            Binary::Unequal => truth(a != b),
            Binary::And => truth(a != 0.0 && b != 0.0),
            Binary::Or => truth(a != 0.0 || b != 0.0),
        },
        _ => ZeroForm::Open,
    }
}

fn called_at_zero(function: Function, values: &[ZeroForm]) -> ZeroForm {
    let number = |value: &ZeroForm| if let ZeroForm::Number(value) = value { Some(*value) } else { None };
    let all: Option<Vec<f64>> = values.iter().map(number).collect();
    if function == Function::If {
        return match (number(&values[0]), number(&values[1]), number(&values[2])) {
            (Some(condition), a, b) => (if condition != 0.0 { a } else { b }).map_or(ZeroForm::Open, ZeroForm::Number),
            (None, Some(a), Some(b)) if a == b => ZeroForm::Number(a),
            (None, ..) => ZeroForm::Open,
        };
    }
    let Some(all) = all else { return ZeroForm::Open };
    ZeroForm::Number(match function {
        Function::If => return ZeroForm::Open,
        Function::Minimum => all.iter().copied().fold(f64::INFINITY, f64::min),
        Function::Maximum => all.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        Function::Absolute => all[0].abs(),
        Function::Exponential => all[0].exp(),
        Function::Logarithm => all[0].ln(),
        Function::SquareRoot => all[0].sqrt(),
        Function::Sine => all[0].sin(),
        Function::Cosine => all[0].cos(),
        Function::HyperbolicTangent => all[0].tanh(),
        Function::Step => f64::from(u8::from(all[0] >= 0.0)),
        Function::Bump => (-0.5 * ((all[0] - all[1]) / all[2]).powi(2)).exp(),
    })
}

/// Points in the unit cube that fill it evenly: multiples of the fractional parts of square roots of primes (Weyl 1916),
/// and its corners of all least and all greatest values.
fn points(count: usize, axes: usize) -> impl Iterator<Item = Vec<f64>> {
    const PRIMES: [f64; 12] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0];
    let step = |axis: usize| {
        let prime = PRIMES[axis % PRIMES.len()] + (40 * (axis / PRIMES.len())) as f64;
        prime.sqrt().fract()
    };
    let even = (0..count).map(move |i| (0..axes).map(|axis| (0.5 + i as f64 * step(axis)).fract()).collect());
    [vec![0.0; axes], vec![1.0; axes]].into_iter().chain(even)
}

/// A value of a range, in every other context by its logarithm where the range spans decades: small values are
/// ordinary there.
fn within(field: &Field, share: f64, by_logarithm: bool) -> f64 {
    let (low, high) = (field.min, field.max);
    if by_logarithm && low >= 0.0 && share > 0.0 && share < 1.0 {
        let least = if low > 0.0 { low } else { 1e-6 * high };
        return least * (high / least).powf(share);
    }
    low + share * (high - low)
}

/// The quantities that a formula names, and shape and context at one point.
pub(super) struct Point {
    pub size: f64,
    pub shape: [f64; SHAPES],
    pub context: Context,
}

impl Point {
    /// What a change names, with its fields, in the order of its slots.
    fn named<'a>(&self, change: &Change, fields: &'a [Field]) -> Vec<(&'a Field, f64)> {
        let one = |slot: &usize| match place(*slot) {
            Place::Size => (&fields[0], self.size),
            Place::Shape(i) => (&fields[i + 1], self.shape[i]),
            Place::Quantity(quantity) => (quantity.field(), quantity.of(&self.context)),
        };
        change.slots().iter().map(one).collect()
    }

    /// Whether everything that a change names is a finite number.
    pub fn is_finite(&self, change: &Change, fields: &[Field]) -> bool {
        self.named(change, fields).iter().all(|(_, value)| value.is_finite())
    }

    /// What a change names, with its values, for people.
    pub fn words(&self, change: &Change, fields: &[Field]) -> String {
        let one = |(field, value): (&Field, f64)| {
            let unit = if field.display == "1" { String::new() } else { format!(" {}", field.display) };
            format!("{} {:.4e}{unit}", field.name, field.to_display(value))
        };
        self.named(change, fields).into_iter().map(one).collect::<Vec<_>>().join(", ")
    }
}

/// Points over the ranges of what a change names.
fn contexts<'a>(change: &'a Change, fields: &'a [Field], count: usize) -> impl Iterator<Item = Point> + 'a {
    let slots = change.slots();
    points(count, slots.len()).enumerate().map(move |(i, shares)| {
        let default = |at: usize| fields.get(at + 1).map_or(0.0, |field| field.start);
        let mut point = Point { size: 0.0, shape: std::array::from_fn(default), context: Context::neutral() };
        for (slot, share) in slots.iter().zip(&shares) {
            let by_logarithm = i % 2 == 0;
            match place(*slot) {
                Place::Size => point.size = within(&fields[0], *share, by_logarithm),
                Place::Shape(at) => point.shape[at] = within(&fields[at + 1], *share, by_logarithm),
                Place::Quantity(Quantity::lot_deviation) => point.context.lot_deviation = share.round(),
                Place::Quantity(quantity) => {
                    *quantity.of_mut(&mut point.context) = within(quantity.field(), *share, by_logarithm);
                }
            }
        }
        point
    })
}

/// That a change of size zero is none: by its tree, and at points of all ranges.
///
/// # Errors
/// [`FormulaError`] `effect-neutral`.
pub(crate) fn neutral(node: &Node, change: &Change, fields: &[Field]) -> Result<(), FormulaError> {
    let due = if change.term.is_factor() { 1.0 } else { 0.0 };
    let refused = |message: String| FormulaError { code: "effect-neutral", message, span: node.span.clone() };
    for mut point in contexts(change, fields, NEUTRAL_POINTS) {
        point.size = 0.0;
        let value = change.program.value(0.0, &point.shape, &point.context);
        // What is no number is out of range, which is asked next.
        if value.is_finite() && value != due {
            let place = point.words(change, fields);
            return Err(refused(format!("not neutral: at size 0 it is {value} and not {due}, with {place}")));
        }
    }
    match at_zero(node) {
        ZeroForm::Number(value) if value == due => Ok(()),
        ZeroForm::Number(_) | ZeroForm::Open => {
            let form = if due == 1.0 { "1 + size * …" } else { "size * …" };
            Err(refused(format!("cannot be shown to be {due} at size 0 in every context; write it as {form}")))
        }
    }
}

/// That a change stays a number within the range of its term in all documented contexts, at all sizes and shapes.
///
/// # Errors
/// [`FormulaError`] `effect-range` with the context.
pub(crate) fn in_range(node: &Node, change: &Change, fields: &[Field]) -> Result<(), FormulaError> {
    let term = change.term.field();
    for point in contexts(change, fields, RANGE_POINTS) {
        let value = change.program.value(point.size, &point.shape, &point.context);
        if !(value >= term.min && value <= term.max) {
            let [low, high, value] = [term.min, term.max, value].map(|value| term.to_display(value));
            let unit = if term.display == "1" { String::new() } else { format!(" {}", term.display) };
            let (name, place) = (term.name, point.words(change, fields));
            let message = format!("{name} would be {value:.4e}{unit}, its range is {low} … {high}{unit}; with {place}");
            return Err(FormulaError { code: "effect-range", message, span: node.span.clone() });
        }
    }
    Ok(())
}
