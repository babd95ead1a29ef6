//! Reads expressions in the words of each language.

use super::{Expression, Function, Operator};
use crate::{Dialect, Fault};

/// Nesting beyond this is refused: a bound against texts without end (assumption).
const DEPTH: u32 = 60;

/// Operators between two values: word, operator, and how strongly it binds.
type Words = &'static [(&'static str, Operator, u8)];

/// Comparisons of Fanuc, Haas and LinuxCNC.
const COMPARISONS: Words = &[
    ("EQ", Operator::Equal, 2),
    ("NE", Operator::NotEqual, 2),
    ("GE", Operator::GreaterEqual, 2),
    ("GT", Operator::Greater, 2),
    ("LE", Operator::LessEqual, 2),
    ("LT", Operator::Less, 2),
];
/// Fanuc and Haas: AND binds as a product, OR and XOR as a sum.
const MACROS: Words = &[
    ("MOD", Operator::Modulo, 5),
    ("AND", Operator::And, 5),
    ("XOR", Operator::ExclusiveOr, 4),
    ("OR", Operator::Or, 4),
];
/// LinuxCNC and Siemens: AND, OR and XOR bind least.
const LOGIC: Words = &[
    ("MOD", Operator::Modulo, 5),
    ("AND", Operator::And, 1),
    ("XOR", Operator::ExclusiveOr, 1),
    ("OR", Operator::Or, 1),
];
const DIVISION: Words = &[("DIV", Operator::Whole, 5)];

/// Signs of all languages.
const SIGNS: Words =
    &[("+", Operator::Add, 4), ("-", Operator::Subtract, 4), ("*", Operator::Multiply, 5), ("/", Operator::Divide, 5)];
const POWERS: Words = &[("**", Operator::Power, 6)];
const KLARTEXT: Words = &[("^", Operator::Power, 6), ("%", Operator::Modulo, 5)];
const SIEMENS: Words = &[
    ("==", Operator::Equal, 2),
    ("<>", Operator::NotEqual, 2),
    (">=", Operator::GreaterEqual, 2),
    ("<=", Operator::LessEqual, 2),
    (">", Operator::Greater, 2),
    ("<", Operator::Less, 2),
];

/// Reads expressions out of a line in capitals.
pub struct Parser<'t> {
    /// The line.
    pub text: &'t [u8],
    /// Place of the next byte.
    pub at: usize,
    /// The language of the line.
    pub dialect: Dialect,
    depth: u32,
}

impl<'t> Parser<'t> {
    /// A parser of `text` from the byte `at` on.
    pub fn new(text: &'t str, at: usize, dialect: Dialect) -> Self {
        Self { text: text.as_bytes(), at, dialect, depth: 0 }
    }

    /// A fault at the place that was reached.
    pub fn fault(&self, message: impl Into<String>) -> Fault {
        Fault::at(self.at + 1, message)
    }

    /// Passes over white space.
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

    /// Passes over `wanted`, where it stands next behind blanks; whether it does.
    pub fn eat(&mut self, wanted: u8) -> bool {
        let found = self.peek() == wanted;
        self.at += usize::from(found);
        found
    }

    /// Passes over `wanted`.
    ///
    /// # Errors
    /// Another byte stands there.
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

    /// Whether `word` stands next behind blanks.
    pub fn starts(&mut self, word: &str) -> bool {
        self.blank();
        self.text[self.at.min(self.text.len())..].starts_with(word.as_bytes())
    }

    /// Digits with at most one point; the number and whether it has a point.
    ///
    /// # Errors
    /// No number stands there.
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

    /// An expression.
    ///
    /// # Errors
    /// What is missing, unknown or nested too deeply, with its column.
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

    /// The operator that stands here, how strongly it binds, and its length in bytes.
    fn operator(&mut self) -> Option<(Operator, u8, usize)> {
        self.blank();
        let rest = &self.text[self.at..];
        let (signs, words): (Words, [Words; 2]) = match self.dialect {
            Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas => (POWERS, [MACROS, COMPARISONS]),
            Dialect::LinuxCnc => (POWERS, [LOGIC, COMPARISONS]),
            Dialect::Siemens => (SIEMENS, [DIVISION, LOGIC]),
            Dialect::Heidenhain => (KLARTEXT, [&[], &[]]),
        };
        let has = |(word, ..): &&(&str, Operator, u8)| rest.starts_with(word.as_bytes());
        if let Some((sign, operator, strength)) = signs.iter().chain(SIGNS).find(has) {
            return Some((*operator, *strength, sign.len()));
        }
        let (word, operator, strength) = words.into_iter().flatten().find(has)?;
        // A name of Siemens may begin with the word of an operator.
        let clear = self.brackets() == (b'[', b']') || rest.get(word.len()).is_none_or(|b| !b.is_ascii_alphanumeric());
        clear.then_some((*operator, *strength, word.len()))
    }

    /// What encloses a part of an expression.
    fn brackets(&self) -> (u8, u8) {
        match self.dialect {
            Dialect::Siemens | Dialect::Heidenhain => (b'(', b')'),
            Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas | Dialect::LinuxCnc => (b'[', b']'),
        }
    }

    /// The value behind a word's letter: a number, a variable or an expression in brackets.
    ///
    /// # Errors
    /// What is missing, unknown or nested too deeply, with its column.
    pub fn prefix(&mut self) -> Result<Expression, Fault> {
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(self.fault("the expression is nested too deeply"));
        }
        let operand = self.operand();
        self.depth -= 1;
        operand
    }

    fn operand(&mut self) -> Result<Expression, Fault> {
        let (open, close) = self.brackets();
        let next = self.peek();
        if next == open {
            self.at += 1;
            let inner = self.expression()?;
            self.expect(close)?;
            return Ok(inner);
        }
        match next {
            b'-' => {
                self.at += 1;
                Ok(self.prefix()?.negated())
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
    ///
    /// # Errors
    /// No number or name of a variable stands there.
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
            _ if siemens && self.peek() != b'(' && (!word.starts_with('$') || word.starts_with("$P_")) => {
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
        let wanted = if matches!(function, Atan2 | Power) { 2 } else { 1 };
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
    use crate::expression::Variables;

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
