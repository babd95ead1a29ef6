//! Expressions of all languages: one tree, one parser, one evaluation.

use crate::Dialect;
use crate::error::Fault;

/// Functions of expressions; angles are degrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Sqrt,
    Square,
    Abs,
    Round,
    Fix,
    Up,
    Fraction,
    Ln,
    Exp,
    Sign,
    Not,
    Power,
    Exists,
}

/// Operators between two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    Whole,
    Power,
    Equal,
    NotEqual,
    Greater,
    GreaterEqual,
    Less,
    LessEqual,
    And,
    Or,
    ExclusiveOr,
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Expression {
    Number(f64),
    /// A variable by number, such as `#5`, `R5` or `Q5`.
    Variable(Box<Self>),
    /// A variable by name.
    Named(String),
    Negate(Box<Self>),
    Call(Function, Vec<Self>),
    Binary(Operator, Box<(Self, Self)>),
}

/// Where variables stand.
pub(crate) trait Variables {
    /// Value of a numbered variable; `None` is vacant.
    fn number(&self, index: u32) -> Result<Option<f64>, String>;
    /// Value of a named variable; `None` where there is none.
    fn named(&self, name: &str) -> Result<Option<f64>, String>;
}

/// Equal within what decimal input leaves over.
const EQUAL: f64 = 1e-9;

impl Expression {
    /// The number, where the expression is one.
    pub fn literal(&self) -> Option<f64> {
        if let Self::Number(value) = self { Some(*value) } else { None }
    }

    /// Value; `None` is vacant.
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
                Some(Self::Named(name)) => f64::from(u8::from(variables.named(name).map_err(Fault::new)?.is_some())),
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
                match operator {
                    Operator::Equal if a.is_none() || b.is_none() => f64::from(u8::from(a.is_none() == b.is_none())),
                    Operator::NotEqual if a.is_none() || b.is_none() => f64::from(u8::from(a.is_none() != b.is_none())),
                    _ => operator.value(a.unwrap_or(0.0), b.unwrap_or(0.0), dialect)?,
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
        let macros = matches!(dialect, Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas);
        finite(
            match self {
                Self::Sin => a.to_radians().sin(),
                Self::Cos => a.to_radians().cos(),
                Self::Tan => a.to_radians().tan(),
                Self::Asin => a.asin().to_degrees(),
                Self::Acos => a.acos().to_degrees(),
                Self::Atan => a.atan().to_degrees(),
                // From 0 to 360 degrees on Fanuc, from -180 to 180 elsewhere.
                Self::Atan2 if macros => a.atan2(b).to_degrees().rem_euclid(360.0),
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
                Self::Not => f64::from(u8::from(a == 0.0)),
                Self::Power => a.powf(b),
                Self::Exists => 0.0,
            },
            "the function",
        )
    }
}

impl Operator {
    fn value(self, a: f64, b: f64, dialect: Dialect) -> Result<f64, Fault> {
        let truth = |holds: bool| f64::from(u8::from(holds));
        let whole = |value: f64| value.round() as i64;
        let bits = matches!(dialect, Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas);
        let equal = (a - b).abs() <= EQUAL * a.abs().max(b.abs()).max(1.0);
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

/// Reads expressions out of a line in capitals.
pub(crate) struct Parser<'t> {
    pub text: &'t [u8],
    pub at: usize,
    pub dialect: Dialect,
    depth: u32,
}

/// Nesting beyond this is refused.
const DEPTH: u32 = 60;

impl<'t> Parser<'t> {
    pub fn new(text: &'t str, at: usize, dialect: Dialect) -> Self {
        Self { text: text.as_bytes(), at, dialect, depth: 0 }
    }

    pub fn fault(&self, message: impl Into<String>) -> Fault {
        Fault::at(self.at + 1, message)
    }

    pub fn blank(&mut self) {
        while self.text.get(self.at).is_some_and(|b| b.is_ascii_whitespace()) {
            self.at += 1;
        }
    }

    /// Next byte behind blanks; 0 at the end.
    pub fn peek(&mut self) -> u8 {
        self.blank();
        self.text.get(self.at).copied().unwrap_or(0)
    }

    pub fn eat(&mut self, wanted: u8) -> bool {
        let found = self.peek() == wanted;
        self.at += usize::from(found);
        found
    }

    pub fn expect(&mut self, wanted: u8) -> Result<(), Fault> {
        if self.eat(wanted) { Ok(()) } else { Err(self.fault(format!("`{}` is missing here", char::from(wanted)))) }
    }

    /// A run of letters, digits, `_` and `$` that starts with none of the digits.
    pub fn identifier(&mut self) -> &'t str {
        self.blank();
        let start = self.at;
        while self.text.get(self.at).is_some_and(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'$')) {
            self.at += 1;
        }
        std::str::from_utf8(&self.text[start..self.at]).unwrap_or_default()
    }

    /// A run of letters.
    pub fn letters(&mut self) -> &'t str {
        self.blank();
        let start = self.at;
        while self.text.get(self.at).is_some_and(u8::is_ascii_alphabetic) {
            self.at += 1;
        }
        std::str::from_utf8(&self.text[start..self.at]).unwrap_or_default()
    }

    pub fn starts(&mut self, word: &str) -> bool {
        self.blank();
        self.text[self.at.min(self.text.len())..].starts_with(word.as_bytes())
    }

    /// Digits with at most one point; the number and whether it has a point.
    pub fn number(&mut self) -> Result<(f64, bool), Fault> {
        self.blank();
        let start = self.at;
        let comma = self.dialect == Dialect::Heidenhain;
        let is_point = |b: u8| b == b'.' || (comma && b == b',');
        while self.text.get(self.at).is_some_and(|b| b.is_ascii_digit() || is_point(*b)) {
            self.at += 1;
        }
        let text = String::from_utf8_lossy(&self.text[start..self.at]).replace(',', ".");
        let pointed = text.contains('.');
        if !text.bytes().any(|b| b.is_ascii_digit()) || text.len() > 40 {
            self.at = start;
            return Err(self.fault("a number is missing here"));
        }
        text.parse().map(|value| (value, pointed)).map_err(|_| {
            self.at = start;
            self.fault("this is no number")
        })
    }

    pub fn expression(&mut self) -> Result<Expression, Fault> {
        self.level(0)
    }

    fn level(&mut self, least: u8) -> Result<Expression, Fault> {
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(self.fault("the expression is nested too deeply"));
        }
        let mut left = self.prefix()?;
        while let Some((operator, strength, length)) = self.operator() {
            if strength < least {
                break;
            }
            self.at += length;
            let right = self.level(strength + 1)?;
            left = Expression::Binary(operator, Box::new((left, right)));
        }
        self.depth -= 1;
        Ok(left)
    }

    fn operator(&mut self) -> Option<(Operator, u8, usize)> {
        use Operator::*;
        self.blank();
        let rest = &self.text[self.at..];
        let has = |word: &str| rest.starts_with(word.as_bytes());
        let siemens = self.dialect == Dialect::Siemens;
        let klartext = self.dialect == Dialect::Heidenhain;
        let iso = !siemens && !klartext;
        let linuxcnc = self.dialect == Dialect::LinuxCnc;
        let symbols: &[(&str, Operator, u8)] = if siemens {
            &[
                ("==", Equal, 2),
                ("<>", NotEqual, 2),
                (">=", GreaterEqual, 2),
                ("<=", LessEqual, 2),
                (">", Greater, 2),
                ("<", Less, 2),
            ]
        } else if klartext {
            &[("^", Power, 6), ("%", Modulo, 5)]
        } else {
            &[("**", Power, 6)]
        };
        if let Some((word, operator, strength)) = symbols.iter().find(|(word, ..)| has(word)) {
            return Some((*operator, *strength, word.len()));
        }
        match rest.first() {
            Some(b'+') => return Some((Add, 4, 1)),
            Some(b'-') => return Some((Subtract, 4, 1)),
            Some(b'*') => return Some((Multiply, 5, 1)),
            Some(b'/') => return Some((Divide, 5, 1)),
            _ => {}
        }
        let words: &[(&str, Operator, u8)] = if iso && !linuxcnc {
            // AND binds as a product on Fanuc, OR and XOR as a sum.
            &[
                ("MOD", Modulo, 5),
                ("AND", And, 5),
                ("XOR", ExclusiveOr, 4),
                ("OR", Or, 4),
                ("EQ", Equal, 2),
                ("NE", NotEqual, 2),
                ("GE", GreaterEqual, 2),
                ("GT", Greater, 2),
                ("LE", LessEqual, 2),
                ("LT", Less, 2),
            ]
        } else if linuxcnc {
            &[
                ("MOD", Modulo, 5),
                ("AND", And, 1),
                ("XOR", ExclusiveOr, 1),
                ("OR", Or, 1),
                ("EQ", Equal, 2),
                ("NE", NotEqual, 2),
                ("GE", GreaterEqual, 2),
                ("GT", Greater, 2),
                ("LE", LessEqual, 2),
                ("LT", Less, 2),
            ]
        } else if siemens {
            &[("DIV", Whole, 5), ("MOD", Modulo, 5), ("AND", And, 1), ("XOR", ExclusiveOr, 1), ("OR", Or, 1)]
        } else {
            &[]
        };
        let (word, operator, strength) = words.iter().find(|(word, ..)| has(word))?;
        let clear = iso || rest.get(word.len()).is_none_or(|b| !b.is_ascii_alphanumeric());
        clear.then_some((*operator, *strength, word.len()))
    }

    /// The value behind a word's letter: a number, a variable or an expression in brackets.
    pub fn prefix(&mut self) -> Result<Expression, Fault> {
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(self.fault("the expression is nested too deeply"));
        }
        let own = self.operand();
        self.depth -= 1;
        own
    }

    fn operand(&mut self) -> Result<Expression, Fault> {
        let siemens = self.dialect == Dialect::Siemens;
        let klartext = self.dialect == Dialect::Heidenhain;
        let (open, close) = if siemens || klartext { (b'(', b')') } else { (b'[', b']') };
        let next = self.peek();
        if next == open {
            self.at += 1;
            let own = self.expression()?;
            self.expect(close)?;
            return Ok(own);
        }
        match next {
            b'-' => {
                self.at += 1;
                Ok(match self.prefix()? {
                    Expression::Number(value) => Expression::Number(-value),
                    own => Expression::Negate(Box::new(own)),
                })
            }
            b'+' => {
                self.at += 1;
                self.prefix()
            }
            b'0'..=b'9' | b'.' | b',' => Ok(Expression::Number(self.number()?.0)),
            b'#' if open == b'[' => {
                self.at += 1;
                self.hash()
            }
            b'A'..=b'Z' | b'_' | b'$' => self.word(open, close),
            0 => Err(self.fault("a value is missing here")),
            other => Err(self.fault(format!("`{}` is no value", char::from(other).escape_default()))),
        }
    }

    /// What stands behind `#`.
    pub fn hash(&mut self) -> Result<Expression, Fault> {
        match self.peek() {
            b'<' => {
                self.at += 1;
                let start = self.at;
                while self.text.get(self.at).is_some_and(|b| *b != b'>') {
                    self.at += 1;
                }
                let name = String::from_utf8_lossy(&self.text[start..self.at]).split_whitespace().collect::<String>();
                self.expect(b'>')?;
                if self.dialect != Dialect::LinuxCnc {
                    return Err(self.fault("variables with names are words of LinuxCNC"));
                }
                Ok(Expression::Named(name))
            }
            b'0'..=b'9' => Ok(Expression::Variable(Box::new(Expression::Number(self.number()?.0)))),
            b'[' | b'#' => Ok(Expression::Variable(Box::new(self.prefix()?))),
            _ => Err(self.fault("the number of a variable is missing behind #")),
        }
    }

    fn word(&mut self, open: u8, close: u8) -> Result<Expression, Fault> {
        use Function::*;
        let start = self.at;
        let siemens = self.dialect == Dialect::Siemens;
        let klartext = self.dialect == Dialect::Heidenhain;
        let word = if siemens || klartext { self.identifier() } else { self.letters() };
        let digits = |prefix: &str| {
            word.strip_prefix(prefix).filter(|rest| !rest.is_empty()).and_then(|rest| rest.parse::<u32>().ok())
        };
        if siemens {
            if let Some(index) = digits("R") {
                return Ok(Expression::Variable(Box::new(Expression::Number(f64::from(index)))));
            }
            match word {
                "R" if self.peek() == b'[' => {
                    self.at += 1;
                    let index = self.expression()?;
                    self.expect(b']')?;
                    return Ok(Expression::Variable(Box::new(index)));
                }
                "TRUE" => return Ok(Expression::Number(1.0)),
                "FALSE" => return Ok(Expression::Number(0.0)),
                "$PI" => return Ok(Expression::Number(std::f64::consts::PI)),
                "NOT" => return Ok(Expression::Call(Not, vec![self.prefix()?])),
                _ => {}
            }
        }
        if klartext {
            if let Some(index) = digits("Q") {
                return Ok(Expression::Variable(Box::new(Expression::Number(f64::from(index)))));
            }
            if word == "PI" {
                return Ok(Expression::Number(std::f64::consts::PI));
            }
            if word == "NEG" {
                return Ok(Expression::Negate(Box::new(self.prefix()?)));
            }
        }
        let function = match word {
            "SIN" => Sin,
            "COS" => Cos,
            "TAN" => Tan,
            "ASIN" => Asin,
            "ACOS" => Acos,
            "ATAN" => Atan,
            "ATAN2" if siemens => Atan2,
            "SQRT" | "SQR" => Sqrt,
            "SQ" if klartext => Square,
            "POT" if siemens => Square,
            "ABS" => Abs,
            "ROUND" | "RND" if !klartext => Round,
            "FIX" | "INT" | "TRUNC" => Fix,
            "FUP" | "ROUNDUP" => Up,
            "FRAC" if klartext => Fraction,
            "LN" => Ln,
            "EXP" => Exp,
            "SGN" if klartext => Sign,
            "POW" => Power,
            "EXISTS" => Exists,
            _ if siemens && self.peek() != b'(' && !word.starts_with('$') => {
                return Ok(Expression::Named(word.to_owned()));
            }
            _ => {
                self.at = start;
                let word = if word.is_empty() { "this" } else { word };
                return Err(self.fault(format!("{word} is no function or variable that is known here")));
            }
        };
        if klartext && self.peek() != b'(' {
            return Ok(Expression::Call(function, vec![self.prefix()?]));
        }
        self.expect(open)?;
        let mut arguments = vec![self.expression()?];
        while self.eat(b',') {
            arguments.push(self.expression()?);
        }
        self.expect(close)?;
        let wanted = match function {
            Atan2 | Power => 2,
            _ => 1,
        };
        // ATAN[y]/[x] is the angle of the point.
        if function == Atan && !siemens && !klartext {
            if arguments.len() == 2 {
                return Ok(Expression::Call(Atan2, arguments));
            }
            let here = self.at;
            if self.eat(b'/') && self.peek() == b'[' {
                arguments.push(self.prefix()?);
                return Ok(Expression::Call(Atan2, arguments));
            }
            self.at = here;
        }
        if arguments.len() != wanted {
            return Err(self.fault(format!("{word} takes {wanted} values")));
        }
        Ok(Expression::Call(function, arguments))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Table;
    impl Variables for Table {
        fn number(&self, index: u32) -> Result<Option<f64>, String> {
            Ok(if index == 0 { None } else { Some(f64::from(index)) })
        }
        fn named(&self, name: &str) -> Result<Option<f64>, String> {
            Ok((name == "N").then_some(7.0))
        }
    }

    fn value(text: &str, dialect: Dialect) -> f64 {
        let mut parser = Parser::new(text, 0, dialect);
        let tree = parser.expression().unwrap_or_else(|fault| panic!("{text}: {fault:?}"));
        assert_eq!(parser.peek(), 0, "{text}: all is read");
        tree.value(&Table, dialect).expect("a value").unwrap_or(f64::NAN)
    }

    #[test]
    fn expressions_of_every_language_have_their_values() {
        use Dialect::*;
        for (text, dialect, expected) in [
            ("#2+#3*4", Fanuc, 14.0),
            ("[#2+#3]*4-1", Fanuc, 19.0),
            ("2*COS[60]", Haas, 1.0),
            ("ATAN[-1]/[1]", Fanuc, 315.0),
            ("ATAN[-1]/[1]", LinuxCnc, -45.0),
            ("#[#2+1]", Fanuc, 3.0),
            ("##5", Fanuc, 5.0),
            ("2 ** 3 ** 1", LinuxCnc, 8.0),
            ("#<n> GT 6 AND 1 LT 2", LinuxCnc, 1.0),
            ("-7 MOD 3", LinuxCnc, 2.0),
            ("-7 MOD 3", Fanuc, -1.0),
            ("FUP[-1.2]", Fanuc, -2.0),
            ("FIX[-1.2]", LinuxCnc, -2.0),
            ("#0 EQ 0", Fanuc, 0.0),
            ("6 AND 3", Fanuc, 2.0),
            ("R2*SIN(30)+POT(3)", Siemens, 10.0),
            ("7 DIV 2 + 7 MOD 2", Siemens, 4.0),
            ("NOT (R1==2) AND N<>6", Siemens, 1.0),
            ("ATAN2(1,1)", Siemens, 45.0),
            ("Q2 + SQ 3 * SIN 90", Heidenhain, 11.0),
            ("( Q2 + 3 ) ^ 2", Heidenhain, 25.0),
            ("SQRT Q4 - NEG 1,5", Heidenhain, 3.5),
            ("2 - 3 - 4", Fanuc, -5.0),
        ] {
            let text = text.to_uppercase();
            assert!((value(&text, dialect) - expected).abs() < 1e-12, "{text}: {}", value(&text, dialect));
        }
    }

    #[test]
    fn nesting_without_end_is_refused() {
        let text = "[".repeat(100_000);
        assert!(Parser::new(&text, 0, Dialect::Fanuc).expression().is_err());
        let text = "-".repeat(100_000);
        assert!(Parser::new(&text, 0, Dialect::Siemens).expression().is_err());
    }
}
