//! Formulas in the files of users: from text to tree.
//!
//! ```text
//! or      := and { "or" and }
//! and     := not { "and" not }
//! not     := "not" not | compare
//! compare := sum [ ("<" | "<=" | ">" | ">=" | "==" | "!=") sum ]
//! sum     := product { ("+" | "-") product }
//! product := sign { ("*" | "·" | "/") sign }
//! sign    := "-" sign | power
//! power   := atom [ "^" sign ]
//! atom    := number [unit] | name | function "(" or { "," or } ")" | "(" or ")"
//! ```
//!
//! A unit belongs to the number before it: `cutting_speed / 200 m/min` divides by 200 m/min.

use std::ops::Range;
use strsim::jaro_winkler;
use toolroom_process::unit;

/// Bytes of the formula.
pub(crate) type Span = Range<usize>;

/// Longest formula that is read, bytes: one that a person can read is far shorter.
const LONGEST: usize = 2000;
/// Brackets, signs and powers that may stand in each other.
const DEEPEST: usize = 48;

/// Why a formula was refused, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormulaError {
    /// Stable code: `effect-parse`, `effect-unit`, `effect-neutral`, `effect-range`.
    pub code: &'static str,
    /// What is wrong.
    pub message: String,
    /// Bytes of the formula that are at fault.
    pub span: Span,
}

impl FormulaError {
    pub(crate) fn parse(span: Span, message: impl Into<String>) -> Self {
        Self { code: "effect-parse", message: message.into(), span }
    }

    /// The message with its column, counted in letters from 1, and the formula with a mark under the place.
    pub fn marked(&self, formula: &str) -> String {
        let start = self.span.start.min(formula.len());
        let before = formula.get(..start).map_or(0, |text| text.chars().count());
        let inside = formula.get(self.span.clone()).map_or(1, |text| text.chars().count().max(1));
        let mark = format!("{}{}", " ".repeat(before), "^".repeat(inside));
        format!("column {}: {}\n  {formula}\n  {mark}", before + 1, self.message)
    }
}

/// Operators with one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unary {
    Negative,
    Not,
}

/// Operators with two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    Unequal,
    And,
    Or,
}

/// Functions by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    If,
    Minimum,
    Maximum,
    Absolute,
    Exponential,
    Logarithm,
    SquareRoot,
    Sine,
    Cosine,
    HyperbolicTangent,
    Step,
    Bump,
}

impl Function {
    /// Word, function, and least and greatest number of arguments.
    pub const ALL: [(&'static str, Self, usize, usize); 12] = [
        ("if", Self::If, 3, 3),
        ("min", Self::Minimum, 2, 8),
        ("max", Self::Maximum, 2, 8),
        ("abs", Self::Absolute, 1, 1),
        ("exp", Self::Exponential, 1, 1),
        ("ln", Self::Logarithm, 1, 1),
        ("sqrt", Self::SquareRoot, 1, 1),
        ("sin", Self::Sine, 1, 1),
        ("cos", Self::Cosine, 1, 1),
        ("tanh", Self::HyperbolicTangent, 1, 1),
        ("step", Self::Step, 1, 1),
        ("bump", Self::Bump, 3, 3),
    ];

    /// Word of the function.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(_, own, ..)| *own == self).map_or("", |(word, ..)| word)
    }
}

/// A part of a formula with its place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    pub kind: NodeKind,
    pub span: Span,
}

/// What a part of a formula is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum NodeKind {
    /// A number, SI, with the powers of its unit.
    Number(f64, unit::Dimension),
    /// A temperature on the scale of Celsius, in kelvin.
    Celsius(f64),
    /// A quantity by its place among the names.
    Name(usize),
    Unary(Unary, Box<Node>),
    Binary(Binary, Box<Node>, Box<Node>),
    Call(Function, Vec<Node>),
}

impl Node {
    /// Number of parts.
    pub fn count(&self) -> usize {
        1 + self.parts().iter().map(|part| part.count()).sum::<usize>()
    }

    /// The parts of which it is made.
    pub fn parts(&self) -> Vec<&Node> {
        match &self.kind {
            NodeKind::Number(..) | NodeKind::Celsius(_) | NodeKind::Name(_) => Vec::new(),
            NodeKind::Unary(_, of) => vec![of],
            NodeKind::Binary(_, left, right) => vec![left, right],
            NodeKind::Call(_, arguments) => arguments.iter().collect(),
        }
    }

    /// Whether a quantity for which `wanted` holds occurs in it.
    pub fn names(&self, wanted: &dyn Fn(usize) -> bool) -> bool {
        matches!(self.kind, NodeKind::Name(slot) if wanted(slot)) || self.parts().iter().any(|part| part.names(wanted))
    }
}

/// Whether a word may be a name of a quantity: letters, digits and low lines, a letter first, no unit and no word of
/// the language.
pub(crate) fn is_name(word: &str) -> bool {
    let mut letters = word.chars();
    letters.next().is_some_and(|first| first.is_ascii_lowercase())
        && letters.all(|letter| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '_')
        && unit::parse(word).is_err()
        && !WORDS.contains(&word)
        && Function::ALL.iter().all(|(own, ..)| *own != word)
}

const WORDS: [&str; 3] = ["and", "or", "not"];

/// Reads a formula over the quantities `names`.
///
/// # Errors
/// [`FormulaError`] with the place of what is no part of a formula.
pub(crate) fn parse(text: &str, names: &[&str]) -> Result<Node, FormulaError> {
    if text.len() > LONGEST {
        let message = format!("a formula has at most {LONGEST} letters, this one {}", text.len());
        return Err(FormulaError::parse(0..1, message));
    }
    let mut reader = Reader { text, at: 0, depth: 0, names };
    let node = reader.any()?;
    reader.space();
    if reader.at < text.len() {
        let next = reader.rest().chars().next().unwrap_or(' ');
        let end = reader.at + next.len_utf8();
        let message = match next {
            ',' => "a comma stands between the arguments of a function; decimals take a point".to_owned(),
            ')' => "this bracket closes nothing".to_owned(),
            _ => format!("`{next}` cannot follow here; an operator is due"),
        };
        return Err(FormulaError::parse(reader.at..end, message));
    }
    Ok(node)
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
    names: &'a [&'a str],
}

type Read = Result<Node, FormulaError>;

fn joined(operator: Binary, node: Node, right: Node) -> Node {
    let span = node.span.start..right.span.end;
    Node { kind: NodeKind::Binary(operator, Box::new(node), Box::new(right)), span }
}

/// Length of the word at the start of a text.
fn word_length(text: &str) -> usize {
    text.find(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '_')).unwrap_or(text.len())
}

/// Length of the symbol of a unit at the start of a text, its power included.
fn symbol_length(text: &str) -> usize {
    if text.starts_with('%') {
        return 1;
    }
    let part = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, 'µ' | 'μ' | '²' | '³' | '_');
    if !text.starts_with(|first: char| part(first) && !first.is_ascii_digit()) {
        return 0;
    }
    text.find(|letter: char| !part(letter)).unwrap_or(text.len())
}

impl<'a> Reader<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn space(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    /// Takes `sign` where it is next.
    fn take(&mut self, sign: &str) -> bool {
        self.space();
        let found = self.rest().starts_with(sign);
        self.at += if found { sign.len() } else { 0 };
        found
    }

    /// Takes a word of the language where it is next.
    fn take_word(&mut self, word: &str) -> bool {
        self.space();
        let found = &self.rest()[..word_length(self.rest())] == word;
        self.at += if found { word.len() } else { 0 };
        found
    }

    fn deeper(&mut self, read: impl FnOnce(&mut Self) -> Read) -> Read {
        self.depth += 1;
        if self.depth > DEEPEST {
            let message = format!("more than {DEEPEST} brackets, signs and powers stand in each other");
            return Err(FormulaError::parse(self.at..self.at + 1, message));
        }
        let node = read(self);
        self.depth -= 1;
        node
    }

    fn any(&mut self) -> Read {
        let mut left = self.all()?;
        while self.take_word("or") {
            left = joined(Binary::Or, left, self.all()?);
        }
        Ok(left)
    }

    fn all(&mut self) -> Read {
        let mut left = self.not()?;
        while self.take_word("and") {
            left = joined(Binary::And, left, self.not()?);
        }
        Ok(left)
    }

    fn not(&mut self) -> Read {
        self.space();
        let start = self.at;
        if !self.take_word("not") {
            return self.comparison();
        }
        let operand = self.deeper(Self::not)?;
        Ok(Node { span: start..operand.span.end, kind: NodeKind::Unary(Unary::Not, Box::new(operand)) })
    }

    fn comparison(&mut self) -> Read {
        let left = self.sum()?;
        let operators = [
            ("<=", Binary::LessOrEqual),
            (">=", Binary::GreaterOrEqual),
            ("==", Binary::Equal),
            ("!=", Binary::Unequal),
            ("<", Binary::Less),
            (">", Binary::Greater),
        ];
        for (sign, operator) in operators {
            if self.take(sign) {
                return Ok(joined(operator, left, self.sum()?));
            }
        }
        Ok(left)
    }

    fn sum(&mut self) -> Read {
        let mut left = self.product()?;
        loop {
            let operator = if self.take("+") {
                Binary::Add
            } else if self.take("-") || self.take("−") {
                Binary::Subtract
            } else {
                return Ok(left);
            };
            left = joined(operator, left, self.product()?);
        }
    }

    fn product(&mut self) -> Read {
        let mut left = self.sign()?;
        loop {
            let operator = if self.take("*") || self.take("·") || self.take("×") {
                Binary::Multiply
            } else if self.take("/") {
                Binary::Divide
            } else {
                return Ok(left);
            };
            left = joined(operator, left, self.sign()?);
        }
    }

    fn sign(&mut self) -> Read {
        self.space();
        let start = self.at;
        if !(self.take("-") || self.take("−")) {
            return self.power();
        }
        let operand = self.deeper(Self::sign)?;
        Ok(Node { span: start..operand.span.end, kind: NodeKind::Unary(Unary::Negative, Box::new(operand)) })
    }

    fn power(&mut self) -> Read {
        let base = self.atom()?;
        if !self.take("^") {
            return Ok(base);
        }
        // `0.3 mm^2` is a square millimetre to one reader and the square of 0.3 mm to another.
        let text = &self.text[base.span.clone()];
        let bare = matches!(base.kind, NodeKind::Number(_, power) if power != [0; 8]) && !text.starts_with('(');
        if bare {
            let message = format!("`{text}^` can be read in two ways; write ({text})^2 or 1 mm2");
            return Err(FormulaError::parse(base.span.start..self.at, message));
        }
        let exponent = self.deeper(Self::sign)?;
        Ok(joined(Binary::Power, base, exponent))
    }

    fn atom(&mut self) -> Read {
        self.space();
        let start = self.at;
        if self.take("(") {
            let inner = self.deeper(Self::any)?;
            if !self.take(")") {
                return Err(FormulaError::parse(start..start + 1, "this bracket is not closed"));
            }
            return Ok(Node { span: start..self.at, kind: inner.kind });
        }
        let first = self.rest().chars().next();
        match first {
            None => Err(FormulaError::parse(start..start, "the formula ends where a number or a name is due")),
            Some(digit) if digit.is_ascii_digit() || digit == '.' => self.number(),
            Some(letter) if letter.is_ascii_alphabetic() || letter == '_' => self.word(),
            Some(other) => {
                let message = format!("`{other}` is no number, name or bracket");
                Err(FormulaError::parse(start..start + other.len_utf8(), message))
            }
        }
    }

    fn number(&mut self) -> Read {
        let start = self.at;
        let digits = |text: &str| text.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(text.len());
        self.at += digits(self.rest());
        if self.rest().starts_with('.') {
            self.at += 1;
            self.at += digits(self.rest());
        }
        if let Some(rest) = self.rest().strip_prefix(['e', 'E']) {
            let signed = rest.trim_start_matches(['+', '-']);
            if signed.starts_with(|first: char| first.is_ascii_digit()) && rest.len() - signed.len() <= 1 {
                self.at += 1 + rest.len() - signed.len() + digits(signed);
            }
        }
        let number = &self.text[start..self.at];
        let Ok(value) = number.parse::<f64>() else {
            return Err(FormulaError::parse(start..self.at, format!("`{number}` is no number")));
        };
        let Some(unit) = self.unit() else {
            return Ok(Node { span: start..self.at, kind: NodeKind::Number(value, [0; 8]) });
        };
        let span = start..self.at;
        let written = &self.text[unit];
        let Ok(read) = unit::parse(written) else {
            return Err(FormulaError::parse(span, format!("`{written}` is no unit")));
        };
        let si = value * read.factor + read.offset;
        let what = if read.offset == 0.0 {
            NodeKind::Number(si, without_turns(read.dimension))
        } else {
            NodeKind::Celsius(si)
        };
        Ok(Node { kind: what, span })
    }

    /// Whether a unit is next, from `at` on: its end.
    fn symbol(&self, start: usize) -> Option<usize> {
        let rest = &self.text[start..];
        let symbol = &rest[..symbol_length(rest)];
        let called = rest[symbol.len()..].trim_start().starts_with('(');
        let known = self.names.contains(&symbol) || WORDS.contains(&symbol);
        (!symbol.is_empty() && !called && !known && unit::parse(symbol).is_ok()).then_some(start + symbol.len())
    }

    /// Takes the unit after a number: symbols joined by `/`, `·` or a space.
    fn unit(&mut self) -> Option<Span> {
        let after_space = |at: usize| at + self.text[at..].len() - self.text[at..].trim_start().len();
        let start = after_space(self.at);
        let mut end = self.symbol(start)?;
        loop {
            let next = after_space(end);
            let sign = self.text[next..].chars().next().filter(|sign| matches!(sign, '/' | '·'));
            let from = sign.map_or(next, |sign| after_space(next + sign.len_utf8()));
            let Some(further) = self.symbol(from).filter(|_| from > end) else { break };
            end = further;
        }
        self.at = end;
        Some(start..end)
    }

    fn word(&mut self) -> Read {
        let start = self.at;
        let length = word_length(self.rest());
        let word = &self.rest()[..length];
        self.at += length;
        let span = start..self.at;
        let called = self.rest().trim_start().starts_with('(');
        if let (true, Some((_, function, least, most))) = (called, Function::ALL.iter().find(|(own, ..)| *own == word))
        {
            return self.call(*function, start, *least, *most);
        }
        if let Some(slot) = self.names.iter().position(|name| *name == word) {
            return Ok(Node { kind: NodeKind::Name(slot), span });
        }
        let functions = || Function::ALL.iter().map(|(own, ..)| *own);
        let likeness = |own: &&str| jaro_winkler(own, word);
        let all = self.names.iter().copied().chain(functions());
        let nearest = all.max_by(|a, b| likeness(a).total_cmp(&likeness(b))).unwrap_or("");
        let message = if functions().any(|own| own == word) {
            format!("`{word}` is a function; its arguments stand in brackets")
        } else if called {
            format!("unknown function `{word}`; there are {}", functions().collect::<Vec<_>>().join(", "))
        } else {
            format!("unknown name `{word}`; nearest: `{nearest}` (`toolroom effects --context` lists all)")
        };
        Err(FormulaError::parse(span, message))
    }

    fn call(&mut self, function: Function, start: usize, least: usize, most: usize) -> Read {
        self.space();
        let bracket = self.at;
        self.at += 1;
        let mut arguments = Vec::new();
        loop {
            let argument = self.deeper(Self::any)?;
            arguments.push(argument);
            if self.take(",") {
                continue;
            }
            if self.take(")") {
                break;
            }
            return Err(FormulaError::parse(bracket..bracket + 1, "this bracket is not closed"));
        }
        let span = start..self.at;
        if arguments.len() < least || arguments.len() > most {
            let due = if least == most { least.to_string() } else { format!("{least} to {most}") };
            let message = format!("`{}` takes {due} arguments, here are {}", function.word(), arguments.len());
            return Err(FormulaError::parse(span, message));
        }
        Ok(Node { kind: NodeKind::Call(function, arguments), span })
    }
}

/// A feed per revolution is a length: turns in the denominator of a unit may be left out.
fn without_turns(mut dimension: unit::Dimension) -> unit::Dimension {
    const TURNS: usize = 6;
    dimension[TURNS] = dimension[TURNS].max(0);
    dimension
}
