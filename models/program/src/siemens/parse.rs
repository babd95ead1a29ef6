//! Lines of SINUMERIK programs as statements.

use crate::Dialect;
use crate::error::Fault;
use std::ops::ControlFlow;
use toolroom_dialect::{Expression, Parser};
use toolroom_pages::{PageWindow, Reader};

/// How a value of an axis counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Count {
    /// By G90 or G91.
    Modal,
    /// AC( ).
    Absolute,
    /// IC( ).
    Step,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Item {
    /// An address such as X, CR or I1, with its value.
    Word {
        address: String,
        count: Count,
        value: Expression,
        column: usize,
    },
    /// A tool or program by name.
    Text {
        address: String,
        text: String,
        column: usize,
    },
    /// A word without value, such as TRANS or SUPA.
    Keyword(String, usize),
    /// A cycle or subprogram with values.
    Call(String, Vec<Option<Expression>>, usize),
    Assign(Expression, Expression),
    /// A variable of the program with its first value.
    Define(String, Expression),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    Forward,
    Backward,
    Either,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Code {
    Block(Vec<Item>),
    Section(String),
    If(Expression),
    Else,
    EndIf,
    While(Expression),
    EndWhile,
    For(Expression, Expression, Expression),
    EndFor,
    Loop,
    EndLoop,
    Repeat,
    Until(Expression),
    Goto(Option<Expression>, Direction, String),
    /// Labels of the first and last block, further runs, whether only the block of the label runs.
    Again(String, Option<String>, Expression, bool),
    /// Parameters of a subprogram with the values that hold where a call leaves them out, and whether it saves modes.
    Procedure(Vec<(String, Expression)>, bool),
    Nothing,
    Fault(Fault),
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Statement {
    pub line: usize,
    pub file: usize,
    pub skip: Option<u8>,
    pub number: Option<u32>,
    pub label: Option<String>,
    pub code: Code,
    pub jump: usize,
}

/// Makes statements of lines.
#[derive(Clone)]
pub(super) struct LineReader {
    pub file: usize,
}

impl Reader for LineReader {
    type Item = Statement;

    fn line(&mut self, number: usize, line: &str, list: &mut Vec<Statement>) -> ControlFlow<()> {
        let line = line.trim_start_matches('\u{feff}').replace('\0', " ").to_ascii_uppercase();
        let (file, jump) = (self.file, 0);
        let mut statement =
            Statement { line: number, file, skip: None, number: None, label: None, code: Code::Nothing, jump };
        let trimmed = line.trim();
        if let Some(header) = trimmed.strip_prefix("%_N_") {
            let name = header.trim_end_matches("_MPF").trim_end_matches("_SPF");
            statement.code = Code::Section(name.to_owned());
            list.push(statement);
        } else if !trimmed.starts_with('%') && !trimmed.is_empty() {
            let line = comment(&line);
            let mut parser = Parser::new(line, 0, Dialect::Siemens);
            if parser.peek() != 0 {
                statement.code = read(&mut parser, &mut statement).unwrap_or_else(Code::Fault);
                list.push(statement);
            }
        }
        ControlFlow::Continue(())
    }

    fn stays(statement: &Statement) -> bool {
        statement.code.flows() || statement.jump > 0
    }
}

/// A line without its comment; a semicolon in a text is none.
fn comment(line: &str) -> &str {
    let mut quoted = false;
    for (start, letter) in line.char_indices() {
        match letter {
            '"' => quoted = !quoted,
            ';' if !quoted => return &line[..start],
            _ => {}
        }
    }
    line
}

fn read(parser: &mut Parser<'_>, statement: &mut Statement) -> Result<Code, Fault> {
    if parser.eat(b'/') {
        let digit = parser.text.get(parser.at).filter(|b| b.is_ascii_digit()).map(|b| b - b'0');
        parser.at += usize::from(digit.is_some());
        // `/` and `/0` are the first switch.
        statement.skip = Some(digit.unwrap_or(0).max(1));
    }
    if parser.peek() == b'N' && parser.text.get(parser.at + 1).is_some_and(u8::is_ascii_digit) {
        parser.at += 1;
        statement.number = Some(parser.number()?.0 as u32);
    }
    let start = parser.at;
    let word = parser.identifier().to_owned();
    if word.len() >= 2
        && !word.as_bytes()[1].is_ascii_digit()
        && parser.peek() == b':'
        && parser.text.get(parser.at + 1) != Some(&b'=')
    {
        parser.at += 1;
        statement.label = Some(word);
        return read_code(parser);
    }
    parser.at = start;
    read_code(parser)
}

fn end(parser: &mut Parser<'_>, code: Code) -> Result<Code, Fault> {
    if parser.peek() == 0 { Ok(code) } else { Err(parser.fault("nothing may follow here")) }
}

fn direction(word: &str) -> Option<Direction> {
    match word {
        "GOTOF" => Some(Direction::Forward),
        "GOTOB" => Some(Direction::Backward),
        "GOTO" => Some(Direction::Either),
        _ => None,
    }
}

fn read_code(parser: &mut Parser<'_>) -> Result<Code, Fault> {
    parser.blank();
    let start = parser.at;
    let word = parser.identifier().to_owned();
    let code = match word.as_str() {
        "IF" => {
            let condition = parser.expression()?;
            if parser.peek() == 0 {
                return Ok(Code::If(condition));
            }
            let word = parser.identifier().to_owned();
            let direction =
                direction(&word).ok_or_else(|| parser.fault("GOTOF, GOTOB or GOTO is missing behind the condition"))?;
            let label = parser.identifier().to_owned();
            Code::Goto(Some(condition), direction, label)
        }
        "GOTO" | "GOTOF" | "GOTOB" => {
            let label = parser.identifier().to_owned();
            Code::Goto(None, direction(&word).unwrap_or(Direction::Either), label)
        }
        "ELSE" => Code::Else,
        "ENDIF" => Code::EndIf,
        "WHILE" => Code::While(parser.expression()?),
        "ENDWHILE" => Code::EndWhile,
        "LOOP" => Code::Loop,
        "ENDLOOP" => Code::EndLoop,
        "FOR" => {
            let variable = parser.prefix()?;
            parser.expect(b'=')?;
            let from = parser.expression()?;
            if parser.identifier() != "TO" {
                return Err(parser.fault("TO is missing in the loop"));
            }
            Code::For(variable, from, parser.expression()?)
        }
        "ENDFOR" => Code::EndFor,
        "REPEAT" if parser.peek() == 0 => Code::Repeat,
        "UNTIL" => Code::Until(parser.expression()?),
        "REPEAT" | "REPEATB" => {
            let first = parser.identifier().to_owned();
            let mut second = None;
            let mut count = Expression::Number(1.0);
            while parser.peek() != 0 {
                if parser.starts("P=") || parser.starts("P ") {
                    parser.at += 1;
                    parser.eat(b'=');
                    count = parser.expression()?;
                } else {
                    let word = parser.identifier().to_owned();
                    if word.is_empty() || second.is_some() {
                        return Err(parser.fault("REPEAT takes one or two labels and P=number"));
                    }
                    second = Some(word);
                }
            }
            Code::Again(first, second, count, word == "REPEATB")
        }
        "MSG" => {
            // A message moves nothing.
            parser.at = parser.text.len();
            Code::Nothing
        }
        "DEF" => return definition(parser),
        "PROC" => return procedure(parser),
        "EXTERN" => {
            // What a subprogram takes is said again by itself.
            parser.at = parser.text.len();
            Code::Nothing
        }
        "WORKPIECE" => {
            // The blank of the simulation moves nothing.
            parser.at = parser.text.len();
            Code::Nothing
        }
        "CASE" | "GOTOC" | "GOTOS" => {
            return Err(
                Fault::at(start + 1, format!("{word} is not followed; write jumps with IF and GOTOF")).refusing()
            );
        }
        _ => {
            parser.at = start;
            return block(parser).map(Code::Block);
        }
    };
    end(parser, code)
}

fn definition(parser: &mut Parser<'_>) -> Result<Code, Fault> {
    let kind = parser.identifier().to_owned();
    if !matches!(kind.as_str(), "REAL" | "INT" | "BOOL") {
        return Err(parser
            .fault(format!("variables of the kind {kind} are not followed; REAL, INT and BOOL are"))
            .refusing());
    }
    let mut items = Vec::new();
    loop {
        let name = parser.identifier().to_owned();
        if name.is_empty() || parser.peek() == b'[' {
            return Err(parser.fault("the name of a single variable is missing here"));
        }
        let value = if parser.eat(b'=') { parser.expression()? } else { Expression::Number(0.0) };
        items.push(Item::Define(name, value));
        if !parser.eat(b',') {
            break;
        }
    }
    end(parser, Code::Block(items))
}

/// `PROC NAME(REAL A, INT B=2) SAVE`.
fn procedure(parser: &mut Parser<'_>) -> Result<Code, Fault> {
    parser.identifier();
    let mut parameters = Vec::new();
    if parser.eat(b'(') && !parser.eat(b')') {
        loop {
            let kind = parser.identifier().to_owned();
            if !matches!(kind.as_str(), "REAL" | "INT" | "BOOL") {
                return Err(parser
                    .fault(format!("a parameter of the kind {kind} is not followed; REAL, INT and BOOL are, by value"))
                    .refusing());
            }
            let name = parser.identifier().to_owned();
            if name.is_empty() || parser.peek() == b'[' {
                return Err(parser.fault("the name of a single parameter is missing here"));
            }
            let value = if parser.eat(b'=') { parser.expression()? } else { Expression::Number(0.0) };
            parameters.push((name, value));
            if !parser.eat(b',') {
                break;
            }
        }
        parser.expect(b')')?;
    }
    let mut saves = false;
    while parser.peek() != 0 {
        match parser.identifier() {
            "SAVE" => saves = true,
            "DISPLOF" | "DISPLON" | "SBLOF" | "ACTBLOCNO" | "ACTBLOCNOON" => {}
            _ => return Err(parser.fault("SAVE, DISPLOF and SBLOF may follow a subprogram's parameters")),
        }
    }
    Ok(Code::Procedure(parameters, saves))
}

fn value(parser: &mut Parser<'_>) -> Result<(Count, Expression), Fault> {
    parser.blank();
    let start = parser.at;
    let word = parser.identifier();
    let count = match word {
        "AC" | "ACP" | "ACN" | "DC" => Count::Absolute,
        "IC" => Count::Step,
        _ => {
            parser.at = start;
            return Ok((Count::Modal, parser.expression()?));
        }
    };
    parser.expect(b'(')?;
    let condition = parser.expression()?;
    parser.expect(b')')?;
    Ok((count, condition))
}

fn quoted(parser: &mut Parser<'_>) -> Result<String, Fault> {
    parser.expect(b'"')?;
    let start = parser.at;
    while parser.text.get(parser.at).is_some_and(|b| *b != b'"') {
        parser.at += 1;
    }
    let text = String::from_utf8_lossy(&parser.text[start..parser.at]).into_owned();
    parser.expect(b'"')?;
    Ok(text)
}

fn block(parser: &mut Parser<'_>) -> Result<Vec<Item>, Fault> {
    let mut items = Vec::new();
    while parser.peek() != 0 {
        let start = parser.at;
        let column = start + 1;
        let word = parser.identifier().to_owned();
        let bytes = word.as_bytes();
        if word.is_empty() {
            let other = char::from(parser.peek()).escape_default();
            return Err(parser.fault(format!("`{other}` is not understood here")).refusing());
        }
        let single = bytes[0].is_ascii_alphabetic() && (bytes.len() == 1 || bytes[1].is_ascii_digit());
        if single {
            let letter = char::from(bytes[0]);
            let digits = bytes[1..].iter().take_while(|b| b.is_ascii_digit()).count();
            parser.at = start + 1 + digits;
            let extended = digits > 0 && parser.peek() == b'=' && parser.text.get(parser.at + 1) != Some(&b'=');
            if letter == 'R' && digits > 0 && extended {
                parser.at += 1;
                let index: f64 = word[1..=digits].parse().unwrap_or(f64::MAX);
                let target = Expression::Variable(Box::new(Expression::Number(index)));
                items.push(Item::Assign(target, parser.expression()?));
                continue;
            }
            if letter == 'R' && digits == 0 && parser.peek() == b'[' {
                parser.at += 1;
                let index = parser.expression()?;
                parser.expect(b']')?;
                parser.expect(b'=')?;
                items.push(Item::Assign(Expression::Variable(Box::new(index)), parser.expression()?));
                continue;
            }
            if extended {
                parser.at += 1;
                let address = word[..=digits].to_owned();
                let (count, value) = value(parser)?;
                items.push(Item::Word { address, count, value, column });
                continue;
            }
            parser.at = start + 1;
            let address = letter.to_string();
            if parser.eat(b'=') {
                if parser.peek() == b'"' {
                    items.push(Item::Text { address, text: quoted(parser)?, column });
                    continue;
                }
                let (count, value) = value(parser)?;
                items.push(Item::Word { address, count, value, column });
                continue;
            }
            let negative = match parser.peek() {
                b'-' => true,
                b'+' | b'0'..=b'9' | b'.' => false,
                _ => return Err(Fault::at(column, format!("the value of {letter} is missing"))),
            };
            parser.at += usize::from(matches!(parser.peek(), b'-' | b'+'));
            let (number, _) = parser.number()?;
            let value = Expression::Number(if negative { -number } else { number });
            items.push(Item::Word { address, count: Count::Modal, value, column });
            continue;
        }
        if parser.peek() == b'=' && parser.text.get(parser.at + 1) != Some(&b'=') {
            parser.at += 1;
            const ADDRESSES: [&str; 12] =
                ["CR", "AR", "TURN", "RPL", "ADIS", "ADISPOS", "RND", "RNDM", "CHF", "CHR", "AP", "RP"];
            if ADDRESSES.contains(&word.as_str()) {
                let (count, value) = value(parser)?;
                items.push(Item::Word { address: word, count, value, column });
            } else {
                items.push(Item::Assign(Expression::Named(word), parser.expression()?));
            }
            continue;
        }
        if parser.peek() == b'(' {
            parser.at += 1;
            let mut arguments = Vec::new();
            loop {
                match parser.peek() {
                    b',' => {
                        parser.at += 1;
                        arguments.push(None);
                        continue;
                    }
                    b')' => break,
                    b'"' => {
                        let message = format!("{word} with a text among its values is not followed; post its motions");
                        return Err(Fault::at(column, message).refusing());
                    }
                    _ => arguments.push(Some(parser.expression()?)),
                }
                if !parser.eat(b',') {
                    break;
                }
            }
            parser.expect(b')')?;
            items.push(Item::Call(word, arguments, column));
            continue;
        }
        if word == "CALL" && parser.peek() == b'"' {
            items.push(Item::Keyword(quoted(parser)?, column));
            continue;
        }
        items.push(Item::Keyword(word, column));
    }
    Ok(items)
}

impl Code {
    /// Whether it is the part of a loop or condition, which are joined.
    fn flows(&self) -> bool {
        match self {
            Self::If(_)
            | Self::Else
            | Self::EndIf
            | Self::While(_)
            | Self::EndWhile
            | Self::For(..)
            | Self::EndFor
            | Self::Loop
            | Self::EndLoop
            | Self::Repeat
            | Self::Until(_) => true,
            Self::Block(_)
            | Self::Section(_)
            | Self::Goto(..)
            | Self::Again(..)
            | Self::Procedure(..)
            | Self::Nothing
            | Self::Fault(_) => false,
        }
    }
}

/// Joins the parts of loops and conditions; `index` is the newest statement, `open` are those without end.
pub(super) fn link(list: &mut PageWindow<'_, Statement>, index: usize, open: &mut Vec<usize>) {
    let Some(code) = list.item(index).filter(|item| item.code.flows()).map(|item| item.code.clone()) else { return };
    let top = open.last().and_then(|last| list.item(*last)).map(|item| &item.code);
    let fits = match (&code, top) {
        (Code::If(_) | Code::While(_) | Code::For(..) | Code::Loop | Code::Repeat, _) => {
            open.push(index);
            return;
        }
        (Code::Else, Some(Code::If(_)))
        | (Code::EndIf, Some(Code::If(_) | Code::Else))
        | (Code::EndWhile, Some(Code::While(_)))
        | (Code::EndFor, Some(Code::For(..)))
        | (Code::EndLoop, Some(Code::Loop))
        | (Code::Until(_), Some(Code::Repeat)) => true,
        _ => false,
    };
    match open.pop().filter(|_| fits) {
        Some(begin) => {
            if let Some(beginning) = list.item(begin) {
                beginning.jump = index + 1;
            }
            if let Some(ending) = list.item(index) {
                ending.jump = begin;
            }
            if code == Code::Else {
                open.push(index);
            }
        }
        None => {
            if let Some(ending) = list.item(index) {
                ending.code = Code::Fault(Fault::at(1, "this end has no beginning of its kind before it"));
                // Nothing leads there; what is not 0 stays.
                ending.jump = usize::MAX;
            }
        }
    }
}
