//! Formulas as programs over a stack, for every number type.

use super::dimension::constant;
use super::expression::{Binary, Function, Node, NodeKind, Unary};
use super::slots::Quantity;
use crate::Context;
use toolroom_process::Number;

/// Numbers of a shape at most.
pub(crate) const SHAPES: usize = 7;
/// Parts of a formula at most.
pub(crate) const MOST_PARTS: usize = 64;
/// Numbers that wait on the stack at most; a formula of [`MOST_PARTS`] parts needs no more.
const STACK: usize = MOST_PARTS / 2 + 1;

/// One step of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operation {
    Number(f64),
    /// The size.
    Size,
    /// A number of the shape.
    Shape(usize),
    /// A quantity of the context.
    Quantity(Quantity),
    Unary(Unary),
    Binary(Binary),
    /// A power with this exponent.
    Power(f64),
    /// A function with this number of arguments.
    Call(Function, usize),
}

/// A formula that can be evaluated.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Program(Vec<Operation>);

/// What a name of a formula is.
pub(crate) fn place(slot: usize) -> Place {
    match slot {
        0 => Place::Size,
        shape if shape <= SHAPES => Place::Shape(shape - 1),
        quantity => Place::Quantity(Quantity::ALL[quantity - SHAPES - 1]),
    }
}

/// Size, shape or context.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    Size,
    Shape(usize),
    Quantity(Quantity),
}

impl Program {
    /// The program of a formula of [`MOST_PARTS`] parts at most.
    pub fn of(node: &Node) -> Self {
        let mut operations = Vec::new();
        compile(node, &mut operations);
        Self(operations)
    }

    /// The value.
    #[inline]
    pub fn value<N: Number>(&self, size: N, shape: &[N; SHAPES], context: &Context<N>) -> N {
        let mut stack = [N::from(0.0); STACK];
        let mut top = 0;
        for operation in &self.0 {
            match *operation {
                Operation::Number(value) => (stack[top], top) = (N::from(value), top + 1),
                Operation::Size => (stack[top], top) = (size, top + 1),
                Operation::Shape(i) => (stack[top], top) = (shape[i], top + 1),
                Operation::Quantity(quantity) => (stack[top], top) = (quantity.of(context), top + 1),
                Operation::Unary(Unary::Negative) => stack[top - 1] = -stack[top - 1],
                Operation::Unary(Unary::Not) => stack[top - 1] = truth(stack[top - 1].re() == 0.0),
                Operation::Power(exponent) => stack[top - 1] = raised(stack[top - 1], exponent),
                Operation::Binary(operator) => {
                    top -= 1;
                    stack[top - 1] = combined(operator, stack[top - 1], stack[top]);
                }
                Operation::Call(function, count) => {
                    let first = top - count;
                    stack[first] = called(function, &stack[first..top]);
                    top = first + 1;
                }
            }
        }
        stack[0]
    }
}

fn compile(node: &Node, operations: &mut Vec<Operation>) {
    if let Some(value) = constant(node) {
        operations.push(Operation::Number(value));
        return;
    }
    match &node.kind {
        NodeKind::Number(value, _) | NodeKind::Celsius(value) => operations.push(Operation::Number(*value)),
        NodeKind::Name(slot) => operations.push(match place(*slot) {
            Place::Size => Operation::Size,
            Place::Shape(i) => Operation::Shape(i),
            Place::Quantity(quantity) => Operation::Quantity(quantity),
        }),
        NodeKind::Unary(operator, of) => {
            compile(of, operations);
            operations.push(Operation::Unary(*operator));
        }
        NodeKind::Binary(operator, left, right) => {
            compile(left, operations);
            if let (Binary::Power, Some(exponent)) = (operator, constant(right)) {
                operations.push(Operation::Power(exponent));
                return;
            }
            compile(right, operations);
            operations.push(Operation::Binary(*operator));
        }
        NodeKind::Call(function, arguments) => {
            arguments.iter().for_each(|argument| compile(argument, operations));
            operations.push(Operation::Call(*function, arguments.len()));
        }
    }
}

fn truth<N: Number>(holds: bool) -> N {
    N::from(if holds { 1.0 } else { 0.0 })
}

/// A power whose slope at zero is a number where the exponent is one or more.
fn raised<N: Number>(base: N, exponent: f64) -> N {
    if base.re() == 0.0 && exponent > 1.0 { base * 0.0 } else { base.powf(exponent) }
}

fn combined<N: Number>(operator: Binary, a: N, b: N) -> N {
    match operator {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        Binary::Power => a.powd(b),
        Binary::Less => truth(a.re() < b.re()),
        Binary::LessOrEqual => truth(a.re() <= b.re()),
        Binary::Greater => truth(a.re() > b.re()),
        Binary::GreaterOrEqual => truth(a.re() >= b.re()),
        Binary::Equal => truth(a.re() == b.re()),
        Binary::Unequal => truth(a.re() != b.re()),
        Binary::And => truth(a.re() != 0.0 && b.re() != 0.0),
        Binary::Or => truth(a.re() != 0.0 || b.re() != 0.0),
    }
}

/// Functions at their arguments. At a kink the slope is that to the right.
fn called<N: Number>(function: Function, arguments: &[N]) -> N {
    let first = arguments[0];
    let best = |better: fn(f64, f64) -> bool| {
        arguments[1..].iter().fold(first, |best, other| if better(other.re(), best.re()) { *other } else { best })
    };
    match function {
        Function::If => arguments[if first.re() != 0.0 { 1 } else { 2 }],
        Function::Minimum => best(|a, b| a < b || a.is_nan()),
        Function::Maximum => best(|a, b| a > b || a.is_nan()),
        Function::Absolute => {
            if first.re() < 0.0 {
                -first
            } else {
                first
            }
        }
        Function::Exponential => first.exp(),
        Function::Logarithm => first.ln(),
        Function::SquareRoot => first.sqrt(),
        Function::Sine => first.sin(),
        Function::Cosine => first.cos(),
        Function::HyperbolicTangent => first.tanh(),
        Function::Step => truth(first.re() >= 0.0),
        Function::Bump => {
            let away = (first - arguments[1]) / arguments[2];
            (-(away * away) * 0.5).exp()
        }
    }
}
