//! Expressions of all languages: one tree, one evaluation, and in [`parser`] one parser.

mod parser;

use crate::{Dialect, Fault};
pub use parser::Parser;

/// Functions of expressions; angles are degrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// Angle of a sine.
    Asin,
    /// Angle of a cosine.
    Acos,
    /// Angle of a tangent.
    Atan,
    /// Angle of the point (x, y), given y and x.
    Atan2,
    /// Square root.
    Sqrt,
    /// Square.
    Square,
    /// Amount.
    Abs,
    /// Nearest whole number.
    Round,
    /// Whole part.
    Fix,
    /// Next whole number.
    Up,
    /// What is behind the point.
    Fraction,
    /// Natural logarithm.
    Ln,
    /// Power of e.
    Exp,
    /// Sign, 0 of 0.
    Sign,
    /// Whether it is 0.
    Not,
    /// Power.
    Power,
    /// Whether a variable has a value.
    Exists,
}

/// Operators between two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// Sum.
    Add,
    /// Difference.
    Subtract,
    /// Product.
    Multiply,
    /// Quotient.
    Divide,
    /// Remainder.
    Modulo,
    /// Whole part of the quotient.
    Whole,
    /// Power.
    Power,
    /// Whether both are equal.
    Equal,
    /// Whether they differ.
    NotEqual,
    /// Whether the first is greater.
    Greater,
    /// Whether the first is not less.
    GreaterEqual,
    /// Whether the first is less.
    Less,
    /// Whether the first is not greater.
    LessEqual,
    /// Both, bit by bit on controls with macros.
    And,
    /// Either, bit by bit on controls with macros.
    Or,
    /// One of them, bit by bit on controls with macros.
    ExclusiveOr,
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Expression {
    /// A number.
    Number(f64),
    /// A variable by number, such as `#5`, `R5` or `Q5`.
    Variable(Box<Self>),
    /// A variable by name.
    Named(String),
    /// The other sign.
    Negate(Box<Self>),
    /// A function of its arguments.
    Call(Function, Vec<Self>),
    /// An operator between two values.
    Binary(Operator, Box<(Self, Self)>),
}

/// Where variables stand.
pub trait Variables {
    /// Value of a numbered variable; `None` is vacant.
    ///
    /// # Errors
    /// Why the variable cannot be read.
    fn number(&self, index: u32) -> Result<Option<f64>, String>;
    /// Value of a named variable; `None` where there is none.
    ///
    /// # Errors
    /// Why the variable cannot be read.
    fn named(&self, name: &str) -> Result<Option<f64>, String>;
}

/// Share of the larger amount, at least 1, within which two values are equal: what decimal input leaves over (assumption).
const EQUAL: f64 = 1e-9;

/// Whether two values are equal as controls compare them.
pub fn equal(a: f64, b: f64) -> bool {
    (a - b).abs() <= EQUAL * a.abs().max(b.abs()).max(1.0)
}

/// A truth as the number that stands for it.
fn truth(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

impl Expression {
    /// The number, where the expression is one.
    pub fn literal(&self) -> Option<f64> {
        if let Self::Number(value) = self { Some(*value) } else { None }
    }

    /// The expression with the other sign.
    fn negated(self) -> Self {
        if let Self::Number(value) = self { Self::Number(-value) } else { Self::Negate(Box::new(self)) }
    }

    /// Value; `None` is vacant.
    ///
    /// # Errors
    /// A variable that has no value or cannot be read, a division by zero, a result that is no number.
    pub fn value(&self, variables: &dyn Variables, dialect: Dialect) -> Result<Option<f64>, Fault> {
        let part = |own: &Self| own.value(variables, dialect);
        Ok(Some(match self {
            Self::Number(value) => *value,
            Self::Variable(index) => {
                let index = part(index)?.ok_or_else(|| Fault::new("the number of a variable is vacant"))?;
                if !(0.0..=9_999_999.0).contains(&index.round()) || (index - index.round()).abs() > 1e-4 {
                    return Err(Fault::new(format!("{index} is no number of a variable")));
                }
                return variables.number(index.round() as u32).map_err(Fault::new);
            }
            Self::Named(name) => {
                return match variables.named(name).map_err(Fault::new)? {
                    None => Err(Fault::new(format!("{name} has no value yet; assign one before"))),
                    value => Ok(value),
                };
            }
            Self::Negate(own) => match part(own)? {
                Some(value) => -value,
                None => return Ok(None),
            },
            Self::Call(Function::Exists, arguments) => match arguments.first() {
                Some(Self::Named(name)) => truth(variables.named(name).map_err(Fault::new)?.is_some()),
                _ => return Err(Fault::new("EXISTS takes a variable with a name")),
            },
            Self::Call(function, arguments) => {
                let mut values = [0.0; 2];
                for (value, argument) in values.iter_mut().zip(arguments) {
                    *value = part(argument)?.unwrap_or(0.0);
                }
                function.value(values, dialect)?
            }
            Self::Binary(operator, sides) => {
                let (a, b) = (part(&sides.0)?, part(&sides.1)?);
                // A vacant variable equals only another one on Fanuc and Haas.
                let compares = matches!(operator, Operator::Equal | Operator::NotEqual);
                if compares && (a.is_none() || b.is_none()) {
                    truth((a.is_none() == b.is_none()) == (*operator == Operator::Equal))
                } else {
                    operator.value(a.unwrap_or(0.0), b.unwrap_or(0.0), dialect)?
                }
            }
        }))
    }
}

fn finite(value: f64, what: &str) -> Result<f64, Fault> {
    if value.is_finite() { Ok(value) } else { Err(Fault::new(format!("{what} gives no number"))) }
}

impl Function {
    fn value(self, [a, b]: [f64; 2], dialect: Dialect) -> Result<f64, Fault> {
        finite(
            match self {
                Self::Sin => a.to_radians().sin(),
                Self::Cos => a.to_radians().cos(),
                Self::Tan => a.to_radians().tan(),
                Self::Asin => a.asin().to_degrees(),
                Self::Acos => a.acos().to_degrees(),
                Self::Atan => a.atan().to_degrees(),
                // From 0 to 360 degrees on Fanuc, from -180 to 180 elsewhere.
                Self::Atan2 if dialect.has_macros() => a.atan2(b).to_degrees().rem_euclid(360.0),
                Self::Atan2 => a.atan2(b).to_degrees(),
                Self::Sqrt => a.sqrt(),
                Self::Square => a * a,
                Self::Abs => a.abs(),
                Self::Round => a.round(),
                // FIX and FUP cut and fill the amount on Fanuc, the value on LinuxCNC; TRUNC and INT cut the amount.
                Self::Fix if dialect == Dialect::LinuxCnc => a.floor(),
                Self::Fix => a.trunc(),
                Self::Up if dialect == Dialect::LinuxCnc => a.ceil(),
                Self::Up => a.abs().ceil() * a.signum(),
                Self::Fraction => a.fract(),
                Self::Ln => a.ln(),
                Self::Exp => a.exp(),
                Self::Sign if a == 0.0 => 0.0,
                Self::Sign => a.signum(),
                Self::Not => truth(a == 0.0),
                Self::Power => a.powf(b),
                Self::Exists => 0.0,
            },
            "the function",
        )
    }
}

impl Operator {
    fn value(self, a: f64, b: f64, dialect: Dialect) -> Result<f64, Fault> {
        let whole = |value: f64| value.round() as i64;
        let bits = dialect.has_macros();
        let equal = equal(a, b);
        if b == 0.0 && matches!(self, Self::Divide | Self::Modulo | Self::Whole) {
            return Err(Fault::new("the program divides by zero"));
        }
        finite(
            match self {
                Self::Add => a + b,
                Self::Subtract => a - b,
                Self::Multiply => a * b,
                Self::Divide => a / b,
                Self::Modulo if dialect == Dialect::LinuxCnc => a.rem_euclid(b),
                Self::Modulo => a % b,
                Self::Whole => (a / b).trunc(),
                Self::Power => a.powf(b),
                Self::Equal => truth(equal),
                Self::NotEqual => truth(!equal),
                Self::Greater => truth(a > b && !equal),
                Self::GreaterEqual => truth(a > b || equal),
                Self::Less => truth(a < b && !equal),
                Self::LessEqual => truth(a < b || equal),
                Self::And if bits => (whole(a) & whole(b)) as f64,
                Self::Or if bits => (whole(a) | whole(b)) as f64,
                Self::ExclusiveOr if bits => (whole(a) ^ whole(b)) as f64,
                Self::And => truth(a != 0.0 && b != 0.0),
                Self::Or => truth(a != 0.0 || b != 0.0),
                Self::ExclusiveOr => truth((a != 0.0) != (b != 0.0)),
            },
            "the expression",
        )
    }
}
