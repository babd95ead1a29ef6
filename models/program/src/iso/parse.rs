//! Lines of Fanuc, Haas and LinuxCNC programs as statements.

use super::words::{ANGLE, CHAMFER, DISTANCE, ROUNDING};
use crate::Dialect;
use crate::error::Fault;
use crate::expression::{Expression, Parser};

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

/// Statements of a text, with the jumps of its loops from `offset`.
pub(super) fn statements(text: &str, dialect: Dialect, file: usize, offset: usize) -> Vec<Statement> {
    // Programs of CAM systems have millions of lines: what is kept of each takes no more than it needs.
    let mut list: Vec<Statement> = Vec::with_capacity(text.bytes().filter(|byte| *byte == b'\n').count() + 1);
    let mut open: Vec<(String, usize)> = Vec::new();
    let mut tape = 0;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim_start_matches('\u{feff}').replace('\0', " ").to_ascii_uppercase();
        let trimmed = line.trim();
        if trimmed.starts_with('%') {
            tape += 1;
            if tape > 1 || !list.is_empty() {
                break;
            }
            continue;
        }
        if trimmed.is_empty() {
            continue;
        }
        let mut statement =
            Statement { line: index + 1, file, skip: 0, number: None, code: Code::Print, jump: 0, end: 0 };
        let code = match clean(&line) {
            Ok(line) => {
                let mut parser = Parser::new(&line, 0, dialect);
                read(&mut parser, &mut statement).unwrap_or_else(Code::Fault)
            }
            Err(fault) => Code::Fault(fault),
        };
        if matches!(&code, Code::Block(block) if block.words.is_empty() && block.assignments.is_empty())
            && statement.number.is_none()
        {
            continue;
        }
        statement.code = code;
        list.push(statement);
        let index = list.len() - 1;
        link(&mut list, index, offset, &mut open);
    }
    for (name, index) in open {
        let message = format!("{name} is not closed: its end is missing");
        list[index].code = Code::Fault(Fault::at(1, message));
    }
    list
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

/// Joins the parts of loops and conditions; `own` is the newest statement.
fn link(list: &mut [Statement], index: usize, offset: usize, open: &mut Vec<(String, usize)>) {
    let place = index + offset;
    let unmatched = |list: &mut [Statement], what: &str| {
        list[index].code = Code::Fault(Fault::at(1, format!("{what} without its beginning")));
    };
    match list[index].code.clone() {
        Code::While(_) => open.push((format!("DO{}", list[index].end), index)),
        Code::End => {
            let wanted = format!("DO{}", list[index].end);
            match open.pop() {
                Some((name, begin)) if name == wanted => {
                    list[begin].jump = place + 1;
                    list[index].jump = begin + offset;
                }
                other => {
                    open.extend(other);
                    unmatched(list, "END");
                }
            }
        }
        Code::Order(name, order) => {
            let top = open.last().filter(|(known, _)| *known == format!("O{name}")).map(|(_, index)| *index);
            let kind = top.map(|index| list[index].code.clone());
            let top_order =
                kind.as_ref().and_then(|code| if let Code::Order(_, order) = code { Some(order) } else { None });
            match order {
                Order::Sub | Order::Do | Order::If(_) | Order::Repeat(_) => open.push((format!("O{name}"), index)),
                Order::While(condition) => {
                    if let (Some(begin), Some(Order::Do)) = (top, top_order) {
                        open.pop();
                        list[index].code = Code::Order(name, Order::DoWhile(condition));
                        list[index].jump = begin + offset;
                        list[begin].jump = place;
                    } else {
                        open.push((format!("O{name}"), index));
                    }
                }
                Order::EndSub(_) | Order::EndWhile | Order::EndRepeat => {
                    let fits = matches!(
                        (top_order, &order),
                        (Some(Order::Sub), Order::EndSub(_))
                            | (Some(Order::While(_)), Order::EndWhile)
                            | (Some(Order::Repeat(_)), Order::EndRepeat)
                    );
                    match top.filter(|_| fits) {
                        Some(begin) => {
                            open.pop();
                            list[begin].jump = place + 1;
                            list[index].jump = begin + offset;
                        }
                        None => unmatched(list, &format!("the end of O{name}")),
                    }
                }
                Order::ElseIf(_) | Order::Else | Order::EndIf => {
                    let fits = matches!(top_order, Some(Order::If(_) | Order::ElseIf(_) | Order::Else));
                    match top.filter(|_| fits) {
                        Some(begin) => {
                            open.pop();
                            list[begin].jump = place;
                            // The branches of an `if` are chained by `end` until it is closed.
                            if order == Order::EndIf {
                                let mut branch = begin;
                                loop {
                                    let before = list[branch].end;
                                    list[branch].end = place;
                                    if before == 0 {
                                        break;
                                    }
                                    branch = before - 1;
                                }
                            } else {
                                list[index].end = begin + 1;
                                open.push((format!("O{name}"), index));
                            }
                        }
                        None => unmatched(list, &format!("O{name}")),
                    }
                }
                Order::Break | Order::Continue => {
                    let wanted = format!("O{name}");
                    match open.iter().rev().find(|(known, _)| *known == wanted) {
                        Some((_, begin)) => list[index].jump = *begin + offset,
                        None => unmatched(list, &format!("O{name} break or continue")),
                    }
                }
                Order::Return(_) | Order::Call(_) | Order::DoWhile(_) => {}
            }
        }
        Code::Program(_) | Code::Block(_) | Code::If(..) | Code::Goto(_) | Code::Print | Code::Fault(_) => {}
    }
}
