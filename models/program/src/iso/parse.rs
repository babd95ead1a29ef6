//! Lines of Fanuc, Haas and LinuxCNC programs as statements.

use super::words::{ANGLE, CHAMFER, DISTANCE, ROUNDING};
use crate::Dialect;
use crate::error::Fault;
use std::ops::ControlFlow;
use toolroom_dialect::{Expression, Parser};
use toolroom_pages::{PageWindow, Reader};

/// A letter with its value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Word {
    pub letter: u8,
    pub column: usize,
    pub value: Expression,
    /// Whether the number has a decimal point; an expression counts as one that has.
    pub pointed: bool,
}

/// Words and assignments of a block.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BlockCode {
    pub words: Vec<Word>,
    pub assignments: Vec<(Expression, Expression)>,
}

/// Control words of LinuxCNC.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Order {
    Sub,
    EndSub(Option<Expression>),
    Return(Option<Expression>),
    Call(Vec<Expression>),
    While(Expression),
    EndWhile,
    Do,
    /// The condition at the end of a loop that begins with `do`.
    DoWhile(Expression),
    If(Expression),
    ElseIf(Expression),
    Else,
    EndIf,
    Repeat(Expression),
    EndRepeat,
    Break,
    Continue,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Code {
    /// The number of a program.
    Program(u32),
    Block(BlockCode),
    If(Expression, Box<Code>),
    Goto(Expression),
    While(Option<Expression>),
    End,
    Order(String, Order),
    /// Output to a printer or file.
    Print,
    Fault(Fault),
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Statement {
    pub line: usize,
    pub file: usize,
    /// Number of block skip, 0 for none.
    pub skip: u8,
    pub number: Option<u32>,
    pub code: Code,
    /// Where a condition that fails, or the end of a loop, goes on.
    pub jump: usize,
    /// End of a whole `if`.
    pub end: usize,
}

/// Makes statements of lines.
#[derive(Clone)]
pub(super) struct LineReader {
    dialect: Dialect,
    file: usize,
    /// Lines with `%` up to now.
    tape: u32,
    begun: bool,
}

impl LineReader {
    pub fn new(dialect: Dialect, file: usize) -> Self {
        Self { dialect, file, tape: 0, begun: false }
    }
}

impl Reader for LineReader {
    type Item = Statement;

    fn line(&mut self, number: usize, line: &str, list: &mut Vec<Statement>) -> ControlFlow<()> {
        let line = line.trim_start_matches('\u{feff}').replace('\0', " ").to_ascii_uppercase();
        let trimmed = line.trim();
        if trimmed.starts_with('%') {
            self.tape += 1;
            return if self.tape > 1 || self.begun { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        }
        if trimmed.is_empty() {
            return ControlFlow::Continue(());
        }
        let mut statement =
            Statement { line: number, file: self.file, skip: 0, number: None, code: Code::Print, jump: 0, end: 0 };
        let code = match clean(&line) {
            Ok(line) => {
                let mut parser = Parser::new(&line, 0, self.dialect);
                read(&mut parser, &mut statement).unwrap_or_else(Code::Fault)
            }
            Err(fault) => Code::Fault(fault),
        };
        let says_nothing =
            matches!(&code, Code::Block(block) if block.words.is_empty() && block.assignments.is_empty());
        if !says_nothing || statement.number.is_some() {
            statement.code = code;
            list.push(statement);
            self.begun = true;
        }
        ControlFlow::Continue(())
    }

    fn stays(statement: &Statement) -> bool {
        statement.code.flows() || statement.jump > 0 || statement.end > 0
    }
}

impl Code {
    /// Whether it is the part of a loop or condition, which are joined.
    fn flows(&self) -> bool {
        match self {
            Self::While(_) | Self::End | Self::Order(..) => true,
            Self::Program(_) | Self::Block(_) | Self::If(..) | Self::Goto(_) | Self::Print | Self::Fault(_) => false,
        }
    }
}

/// A line with blanks in place of its comments.
fn clean(line: &str) -> Result<String, Fault> {
    let mut inside = None;
    let mut clean = String::with_capacity(line.len());
    for (start, letter) in line.char_indices() {
        match (letter, inside) {
            (';', None) => break,
            ('(', None) => inside = Some(start),
            (')', Some(_)) => {
                inside = None;
                clean.push(' ');
                continue;
            }
            (')', None) => return Err(Fault::at(start + 1, "`)` closes no comment")),
            _ => {}
        }
        // Columns count bytes as the parser does.
        if inside.is_some() {
            (0..letter.len_utf8()).for_each(|_| clean.push(' '));
        } else {
            clean.push(letter);
        }
    }
    inside.map_or(Ok(clean), |at| Err(Fault::at(at + 1, "the comment has no `)`")))
}

fn read(parser: &mut Parser<'_>, statement: &mut Statement) -> Result<Code, Fault> {
    for _ in 0..2 {
        if parser.eat(b'/') {
            let digit = parser.text.get(parser.at).filter(|b| b.is_ascii_digit()).map(|b| b - b'0');
            parser.at += usize::from(digit.is_some());
            statement.skip = digit.unwrap_or(1).max(1);
        }
        if statement.number.is_none() && parser.peek() == b'N' {
            parser.at += 1;
            // LinuxCNC allows fractions in block numbers, which nothing refers to.
            let (number, _) = parser.number()?;
            statement.number = Some(number as u32);
        }
    }
    if parser.peek() == b':' {
        parser.at += 1;
        return Ok(Code::Program(parser.number()?.0 as u32));
    }
    if parser.peek() == b'O' {
        return order(parser);
    }
    let start = parser.at;
    let word = parser.letters();
    match word {
        "IF" if parser.dialect != Dialect::LinuxCnc => {
            let condition = parser.prefix()?;
            if parser.starts("THEN") {
                parser.at += 4;
                return Ok(Code::If(condition, Box::new(Code::Block(block(parser)?))));
            }
            if parser.starts("GOTO") {
                parser.at += 4;
                let target = parser.prefix()?;
                end(parser)?;
                return Ok(Code::If(condition, Box::new(Code::Goto(target))));
            }
            Err(parser.fault("IF [condition] is followed by GOTO or THEN"))
        }
        "GOTO" if parser.dialect != Dialect::LinuxCnc => {
            let target = parser.prefix()?;
            end(parser)?;
            Ok(Code::Goto(target))
        }
        "WHILE" | "DO" if parser.dialect != Dialect::LinuxCnc => {
            let condition = if word == "WHILE" {
                let condition = parser.prefix()?;
                if parser.letters() != "DO" {
                    return Err(parser.fault("WHILE [condition] is followed by DO and a number"));
                }
                Some(condition)
            } else {
                None
            };
            statement.end = parser.number()?.0 as usize;
            end(parser)?;
            Ok(Code::While(condition))
        }
        "END" if parser.dialect != Dialect::LinuxCnc => {
            statement.end = parser.number()?.0 as usize;
            end(parser)?;
            Ok(Code::End)
        }
        "POPEN" | "PCLOS" | "DPRNT" | "BPRNT" if parser.dialect != Dialect::LinuxCnc => Ok(Code::Print),
        _ => {
            parser.at = start;
            Ok(Code::Block(block(parser)?))
        }
    }
}

fn end(parser: &mut Parser<'_>) -> Result<(), Fault> {
    if parser.peek() == 0 { Ok(()) } else { Err(parser.fault("nothing may follow here")) }
}

fn block(parser: &mut Parser<'_>) -> Result<BlockCode, Fault> {
    let mut code = BlockCode::default();
    loop {
        match parser.peek() {
            0 => {
                code.words.shrink_to_fit();
                return Ok(code);
            }
            b'#' => {
                parser.at += 1;
                let target = parser.hash()?;
                parser.expect(b'=')?;
                code.assignments.push((target, parser.expression()?));
            }
            letter @ b'A'..=b'Z' => {
                let column = parser.at + 1;
                parser.at += 1;
                if letter == b'T' && parser.peek() == b'"' {
                    return Err(Fault::at(column, "a tool by name; write its number"));
                }
                if parser.peek().is_ascii_alphabetic() {
                    parser.at = column - 1;
                    let word = parser.letters().to_owned();
                    let message =
                        format!("{word} is not understood here; it is a word of another control, or misspelt");
                    return Err(Fault::at(column, message));
                }
                let start = parser.at;
                let value = parser.prefix().map_err(|fault| fault.or_at(column))?;
                let text = &parser.text[start..parser.at];
                let pointed = value.literal().is_none() || text.contains(&b'.');
                code.words.push(Word { letter, column, value, pointed });
            }
            other @ (b'@' | b'^') if parser.dialect == Dialect::LinuxCnc => {
                let column = parser.at + 1;
                parser.at += 1;
                let value = parser.prefix().map_err(|fault| fault.or_at(column))?;
                let letter = if other == b'@' { DISTANCE } else { ANGLE };
                code.words.push(Word { letter, column, value, pointed: true });
            }
            b',' => {
                let column = parser.at + 1;
                parser.at += 1;
                let letter = match parser.peek() {
                    b'C' if parser.dialect.has_macros() => CHAMFER,
                    b'R' if parser.dialect.has_macros() => ROUNDING,
                    _ => {
                        let message = "`,` begins a chamfer, a rounding or an angle; only ,C and ,R of Fanuc and Haas are followed";
                        return Err(Fault::at(column, message));
                    }
                };
                parser.at += 1;
                let start = parser.at;
                let value = parser.prefix().map_err(|fault| fault.or_at(column))?;
                let pointed = value.literal().is_none() || parser.text[start..parser.at].contains(&b'.');
                code.words.push(Word { letter, column, value, pointed });
            }
            other => {
                let message = format!("`{}` is not understood here", char::from(other).escape_default());
                return Err(parser.fault(message));
            }
        }
    }
}

/// A program's number, or a control word of LinuxCNC.
fn order(parser: &mut Parser<'_>) -> Result<Code, Fault> {
    let column = parser.at + 1;
    parser.at += 1;
    let name = if parser.peek() == b'<' {
        parser.at += 1;
        let start = parser.at;
        while parser.text.get(parser.at).is_some_and(|b| *b != b'>') {
            parser.at += 1;
        }
        let name = String::from_utf8_lossy(&parser.text[start..parser.at]).split_whitespace().collect::<String>();
        parser.expect(b'>')?;
        name
    } else {
        format!("{}", parser.number()?.0)
    };
    if parser.peek() == 0 || parser.dialect != Dialect::LinuxCnc {
        let number = name.parse().map_err(|_| Fault::at(column, "a program is named by its number here"))?;
        if parser.peek() != 0 && parser.letters().len() > 1 {
            return Err(Fault::at(column, "words behind O are control words of LinuxCNC"));
        }
        return Ok(Code::Program(number));
    }
    let word = parser.letters().to_owned();
    let value = |parser: &mut Parser<'_>| parser.prefix();
    let optional = |parser: &mut Parser<'_>| {
        if parser.peek() == b'[' { parser.prefix().map(Some) } else { Ok(None) }
    };
    let order = match word.as_str() {
        "SUB" => Order::Sub,
        "ENDSUB" => Order::EndSub(optional(parser)?),
        "RETURN" => Order::Return(optional(parser)?),
        "CALL" => {
            let mut arguments = Vec::new();
            while parser.peek() == b'[' {
                arguments.push(parser.prefix()?);
            }
            if arguments.len() > 30 {
                return Err(parser.fault("a call takes at most 30 values"));
            }
            Order::Call(arguments)
        }
        "WHILE" => Order::While(value(parser)?),
        "ENDWHILE" => Order::EndWhile,
        "DO" => Order::Do,
        "IF" => Order::If(value(parser)?),
        "ELSEIF" => Order::ElseIf(value(parser)?),
        "ELSE" => Order::Else,
        "ENDIF" => Order::EndIf,
        "REPEAT" => Order::Repeat(value(parser)?),
        "ENDREPEAT" => Order::EndRepeat,
        "BREAK" => Order::Break,
        "CONTINUE" => Order::Continue,
        _ => return Err(Fault::at(column, format!("O{name} {word} is no control word"))),
    };
    end(parser)?;
    Ok(Code::Order(name, order))
}

/// A part of a loop or condition that is not closed yet.
pub(super) struct Open {
    name: String,
    index: usize,
    kind: Opened,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Opened {
    /// DO of Fanuc.
    Loop,
    Sub,
    Do,
    Branch,
    While,
    Repeat,
}

impl Open {
    pub fn index(&self) -> usize {
        self.index
    }

    /// The fault of what is never closed.
    pub fn fault(&self) -> Fault {
        Fault::at(1, format!("{} is not closed: its end is missing", self.name))
    }
}

/// Joins the parts of loops and conditions; `index` is the newest statement.
pub(super) fn link(list: &mut PageWindow<'_, Statement>, index: usize, open: &mut Vec<Open>) {
    let Some(statement) = list.item(index).filter(|statement| statement.code.flows()) else { return };
    let (code, number) = (statement.code.clone(), statement.end);
    let change = |list: &mut PageWindow<'_, Statement>, at: usize, to: &dyn Fn(&mut Statement)| {
        if let Some(statement) = list.item(at) {
            to(statement);
        }
    };
    let join = |list: &mut PageWindow<'_, Statement>, from: usize, to: usize| change(list, from, &|s| s.jump = to);
    let unmatched = |list: &mut PageWindow<'_, Statement>, what: &str| {
        change(list, index, &|statement| {
            statement.code = Code::Fault(Fault::at(1, format!("{what} without its beginning")));
            // Nothing leads there; what is not 0 stays.
            statement.end = usize::MAX;
        });
    };
    match code {
        Code::While(_) => open.push(Open { name: format!("DO{number}"), index, kind: Opened::Loop }),
        Code::End => match open.pop_if(|last| last.kind == Opened::Loop && last.name == format!("DO{number}")) {
            Some(begin) => {
                join(list, begin.index, index + 1);
                join(list, index, begin.index);
            }
            None => unmatched(list, "END"),
        },
        Code::Order(name, order) => {
            let label = format!("O{name}");
            let top = open.last().filter(|last| last.name == label).map(|last| (last.index, last.kind));
            match order {
                Order::Sub => open.push(Open { name: label, index, kind: Opened::Sub }),
                Order::Do => open.push(Open { name: label, index, kind: Opened::Do }),
                Order::If(_) => open.push(Open { name: label, index, kind: Opened::Branch }),
                Order::Repeat(_) => open.push(Open { name: label, index, kind: Opened::Repeat }),
                Order::While(condition) => {
                    if let Some((begin, Opened::Do)) = top {
                        open.pop();
                        let code = Code::Order(name, Order::DoWhile(condition));
                        change(list, index, &|statement| statement.code = code.clone());
                        join(list, index, begin);
                        join(list, begin, index);
                    } else {
                        open.push(Open { name: label, index, kind: Opened::While });
                    }
                }
                Order::EndSub(_) | Order::EndWhile | Order::EndRepeat => {
                    let fits = matches!(
                        (top, &order),
                        (Some((_, Opened::Sub)), Order::EndSub(_))
                            | (Some((_, Opened::While)), Order::EndWhile)
                            | (Some((_, Opened::Repeat)), Order::EndRepeat)
                    );
                    match top.filter(|_| fits) {
                        Some((begin, _)) => {
                            open.pop();
                            join(list, begin, index + 1);
                            join(list, index, begin);
                        }
                        None => unmatched(list, &format!("the end of {label}")),
                    }
                }
                Order::ElseIf(_) | Order::Else | Order::EndIf => match top {
                    Some((begin, Opened::Branch)) => {
                        open.pop();
                        join(list, begin, index);
                        // The branches of an `if` are chained by `end` until it is closed.
                        if order == Order::EndIf {
                            let mut branch = Some(begin);
                            while let Some(statement) = branch.and_then(|branch| list.item(branch)) {
                                branch = statement.end.checked_sub(1);
                                statement.end = index;
                            }
                        } else {
                            change(list, index, &|statement| statement.end = begin + 1);
                            open.push(Open { name: label, index, kind: Opened::Branch });
                        }
                    }
                    _ => unmatched(list, &label),
                },
                Order::Break | Order::Continue => match open.iter().rev().find(|known| known.name == label) {
                    Some(known) => join(list, index, known.index),
                    None => unmatched(list, &format!("{label} break or continue")),
                },
                Order::Return(_) | Order::Call(_) | Order::DoWhile(_) => {}
            }
        }
        Code::Program(_) | Code::Block(_) | Code::If(..) | Code::Goto(_) | Code::Print | Code::Fault(_) => {}
    }
}
