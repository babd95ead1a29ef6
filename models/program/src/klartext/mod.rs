//! Heidenhain Klartext: positioning, contours, labels, Q parameters and drilling cycles.

mod approach;
mod block;
mod contour;
mod cycles;
mod line;
mod pattern;
mod system;

use crate::error::Fault;
use crate::frame::Frame;
use crate::kernel::Kernel;
use crate::library::{Library, Twice};
use crate::motion::EventKind;
use crate::run::{Flow, Interpreter, Place};
use crate::{Dialect, Units};
use approach::Approach;
use contour::Corner;
use cycles::Cycle;
use line::{LineReader, Statement};
use std::collections::{BTreeMap, HashMap};
use toolroom_dialect::{Parser, Variables, equal};
use toolroom_pages::{Pages, Source};

#[derive(Clone, Debug, Default)]
struct Store(BTreeMap<u32, f64>);

impl Variables for Store {
    fn number(&self, index: u32) -> Result<Option<f64>, String> {
        match self.0.get(&index) {
            Some(value) => Ok(Some(*value)),
            None if index < 100 => Ok(Some(0.0)),
            None => Err(format!("Q{index} has no value yet; assign one before")),
        }
    }

    fn named(&self, _: &str) -> Result<Option<f64>, String> {
        Ok(None)
    }
}

#[derive(Clone, Debug)]
struct Call {
    start: usize,
    back: usize,
    left: u32,
    line: usize,
    count: usize,
    /// Whether LBL 0 ends it; a repeat ends where it was called, and a program with its file.
    label: bool,
    end: Option<usize>,
}

/// Coordinate transformations by the old cycles 7, 8, 10 and 11.
#[derive(Clone, Debug)]
struct Transform {
    shift: [f64; 9],
    mirror: [bool; 3],
    angle: f64,
    factor: f64,
}

pub(crate) struct Klartext {
    statements: Pages<LineReader>,
    files: Vec<String>,
    labels: HashMap<(usize, String), usize>,
    pc: usize,
    calls: Vec<Call>,
    store: Store,
    library: Library,
    pole: [f64; 2],
    has_pole: bool,
    direction: [f64; 3],
    left: Option<bool>,
    tool_feed: Option<f64>,
    radii: BTreeMap<u32, f64>,
    /// Oversize of the radius of the tool in the spindle, DR of its call, mm.
    oversize: f64,
    cycle: Option<Cycle>,
    /// Parameters of an old cycle while its blocks are read.
    old: BTreeMap<u32, f64>,
    modal_call: bool,
    transform: Transform,
    corner: Option<Corner>,
    /// An approach that waits for the first element of its contour.
    approach: Option<Approach>,
    /// The datum of cycle 247 in force.
    datum: Option<u32>,
}

/// Depth of subprograms and programs (assumption: 10 as for the other controls; manuals name 8 to 19, cited from memory).
const DEPTH: usize = 10;

impl Klartext {
    pub fn new(text: &Source, library: Library) -> Result<Self, Fault> {
        let mut interpreter = Self {
            statements: Pages::new(),
            files: Vec::new(),
            labels: HashMap::new(),
            pc: 0,
            calls: Vec::new(),
            store: Store::default(),
            library,
            pole: [0.0; 2],
            has_pole: false,
            direction: [0.0; 3],
            left: None,
            tool_feed: None,
            radii: BTreeMap::new(),
            oversize: 0.0,
            cycle: None,
            old: BTreeMap::new(),
            modal_call: false,
            transform: Transform { shift: [0.0; 9], mirror: [false; 3], angle: 0.0, factor: 1.0 },
            corner: None,
            approach: None,
            datum: None,
        };
        interpreter.add(text, String::new())?;
        Ok(interpreter)
    }

    fn add(&mut self, text: &Source, name: String) -> Result<usize, Fault> {
        let file = self.files.len();
        let Self { statements, labels, .. } = self;
        let (mut lines, mut twice) = (HashMap::new(), None);
        let items = statements.add(text, LineReader::new(file), |index, list| {
            let Some(statement) = list.item(index) else { return };
            let Some(label) = statement.label() else { return };
            if let Some(first) = lines.insert(label.to_owned(), statement.line) {
                twice.get_or_insert_with(|| Twice(format!("LBL {label}"), first, statement.line));
            }
            labels.entry((file, label.to_owned())).or_insert(index);
        })?;
        Twice::refuse(twice, &name)?;
        self.files.push(name);
        Ok(items.start)
    }

    fn value(&self, text: &str, column: usize) -> Result<f64, Fault> {
        // Most values are numbers.
        if let Ok(value) = text.parse::<f64>()
            && text.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.'))
        {
            return Ok(value);
        }
        let place = |fault: Fault| Fault::at(column, fault.message);
        let mut parser = Parser::new(text, 0, Dialect::Heidenhain);
        let tree = parser.expression().map_err(place)?;
        if parser.peek() != 0 {
            return Err(Fault::at(column, format!("{text} is no value")));
        }
        Ok(tree.value(&self.store, Dialect::Heidenhain).map_err(place)?.unwrap_or(0.0))
    }

    fn frame(&self, kernel: &Kernel) -> Frame {
        let mut frame = Frame::shifted(self.transform.shift);
        let factors = self.transform.mirror.map(|mirrored| if mirrored { -1.0 } else { 1.0 });
        frame = frame.after(&Frame::scaled(factors, [0.0; 3]));
        frame = frame.after(&Frame::turned(self.transform.angle, kernel.plane, [0.0; 2]));
        frame.after(&Frame::scaled([self.transform.factor; 3], [0.0; 3]))
    }

    fn label(&self, name: &str, file: usize) -> Result<usize, Fault> {
        let name = name.trim_matches('"');
        self.labels
            .get(&(file, name.to_owned()))
            .copied()
            .ok_or_else(|| Fault::new(format!("there is no LBL {name} in this program; check the label")))
    }

    fn push(&mut self, call: Call) -> Result<(), Fault> {
        if self.calls.len() >= DEPTH {
            return Err(Fault::new(format!("subprograms and repeats are nested more than {DEPTH} deep")));
        }
        self.calls.push(call);
        Ok(())
    }

    /// `CALL LBL 1 REP 3`, `CALL PGM NAME`.
    fn call(&mut self, words: &[(String, usize)], index: usize, kernel: &mut Kernel) -> Result<(), Fault> {
        let word = |index: usize| words.get(index).map_or("", |(word, _)| word.as_str());
        let column = words.get(2).map_or(1, |(_, column)| *column);
        let line = kernel.line;
        match word(1) {
            "LBL" => {
                let start = self
                    .label(word(2), self.statements.text(index).unwrap_or(0))
                    .map_err(|fault| fault.or_at(column))?;
                let repeats = word(3).strip_prefix("REP").map(|rest| if rest.is_empty() { word(4) } else { rest });
                match repeats {
                    // A part program repeat runs from the label to here, so many times more.
                    Some(count) => {
                        let count = count.split('/').next().unwrap_or_default();
                        let count = self.value(count, column)?;
                        if !(0.0..=1e8).contains(&count) {
                            return Err(Fault::at(column, format!("REP {count} is no number of repeats")));
                        }
                        if start > index {
                            return Err(Fault::at(column, "a repeat begins at a label before it"));
                        }
                        if count >= 1.0 {
                            let back = self.pc;
                            self.push(Call {
                                start,
                                back,
                                left: count as u32 - 1,
                                line,
                                count: 1,
                                label: false,
                                end: Some(index),
                            })?;
                            self.pc = start;
                            kernel.loop_line = line;
                        }
                    }
                    None => {
                        let back = self.pc;
                        self.push(Call { start, back, left: 0, line, count: 1, label: true, end: None })?;
                        self.pc = start;
                    }
                }
            }
            "PGM" => {
                let full = word(2).trim_matches('"');
                let stem = full.rsplit(['\\', '/', ':']).next().unwrap_or(full).trim_end_matches(".H");
                let names = [stem.to_owned(), stem.to_ascii_lowercase()];
                let missing =
                    || Fault::at(column, format!("CALL PGM {stem}: no such program; put {stem}.H beside this one"));
                let (file, text) = self.library.find(&names, &[".H", ".h", ""]).ok_or_else(missing)?;
                let start = match self.files.iter().position(|known| *known == file) {
                    Some(known) => self.statements.items(known).start,
                    None => self.add(&text, file)?,
                };
                let back = self.pc;
                self.push(Call { start, back, left: 0, line, count: 1, label: false, end: None })?;
                self.pc = start;
            }
            _ => return Err(Fault::at(column, "CALL takes LBL or PGM; other calls are not followed").refusing()),
        }
        Ok(())
    }

    /// The end of the innermost subprogram or called program; false in the main program.
    fn back(&mut self, label: bool) -> bool {
        // Repeats are no calls: LBL 0 within one is passed over, and with a subprogram the repeats in it end.
        let innermost = self.calls.iter().rposition(|call| call.end.is_none());
        match innermost.map(|place| (place, &self.calls[place])) {
            Some((place, call)) if call.label == label => {
                self.pc = call.back;
                self.calls.truncate(place);
                true
            }
            // LBL 0 outside of a call is passed over; a program that ends within a subprogram ends altogether.
            _ => label,
        }
    }

    /// `FN 9: IF +Q1 EQU +Q2 GOTO LBL 5` and its like.
    fn function(&mut self, text: &str, index: usize, kernel: &mut Kernel) -> Result<(), Fault> {
        let (number, body) =
            text[2..].split_once(':').ok_or_else(|| Fault::new("FN number: is followed by its function"))?;
        let number: u32 = number.trim().parse().map_err(|_| Fault::new("the number of FN is missing"))?;
        let body = body.trim();
        if (9..=12).contains(&number) {
            let rest =
                body.strip_prefix("IF").ok_or_else(|| Fault::new("FN 9 to FN 12 are written IF … GOTO LBL …"))?;
            let (condition, label) = rest.split_once("GOTO LBL").ok_or_else(|| Fault::new("GOTO LBL is missing"))?;
            let words: Vec<&str> = condition.split_whitespace().collect();
            let [a, relation, b] = words[..] else {
                return Err(Fault::new("a condition compares two values by EQU, NE, GT or LT"));
            };
            let (a, b) = (self.value(a, 1)?, self.value(b, 1)?);
            let equal = equal(a, b);
            let holds = match relation {
                "EQU" => equal,
                "NE" => !equal,
                "GT" => a > b && !equal,
                "LT" => a < b && !equal,
                _ => return Err(Fault::new(format!("{relation} is no relation; EQU, NE, GT and LT are"))),
            };
            if holds {
                self.pc = self.label(label.trim(), self.statements.text(index).unwrap_or(0))?;
                if self.pc <= index {
                    kernel.loop_line = kernel.line;
                }
            }
            return Ok(());
        }
        let (target, value) = body.split_once('=').ok_or_else(|| Fault::new("FN number: Q = value"))?;
        if number == 18 {
            let target =
                target.trim().strip_prefix("SYSREAD").ok_or_else(|| Fault::new("FN 18: SYSREAD Q = ID NR IDX"))?;
            let result = self.system_value(value, kernel)?;
            return self.set(target.trim(), result);
        }
        let words: Vec<&str> = value.split_whitespace().collect();
        let operand = |interpreter: &Self, place: usize| {
            let word = words.get(place).ok_or_else(|| Fault::new("a value is missing"))?;
            interpreter.value(word, 1)
        };
        let last = words.len().saturating_sub(1);
        let result = match number {
            0 => operand(self, 0)?,
            1 => operand(self, 0)? + operand(self, last)?,
            2 => operand(self, 0)? - operand(self, last)?,
            3 => operand(self, 0)? * operand(self, last)?,
            4 => operand(self, 0)? / operand(self, last)?,
            5 => operand(self, last)?.sqrt(),
            6 => operand(self, last)?.to_radians().sin(),
            7 => operand(self, last)?.to_radians().cos(),
            8 => operand(self, 0)?.hypot(operand(self, last)?),
            13 => operand(self, 0)?.atan2(operand(self, last)?).to_degrees().rem_euclid(360.0),
            _ => {
                return Err(Fault::new(format!(
                    "FN {number} reads or writes values of the control, and is not followed"
                ))
                .refusing());
            }
        };
        if !result.is_finite() {
            return Err(Fault::new(format!("FN {number} gives no number: check its values")));
        }
        self.set(target.trim(), result)
    }

    fn set(&mut self, target: &str, value: f64) -> Result<(), Fault> {
        let index = target.strip_prefix('Q').and_then(|digits| digits.parse().ok());
        let index = index.ok_or_else(|| Fault::new(format!("{target} is no Q parameter that is followed")))?;
        self.store.0.insert(index, value);
        Ok(())
    }
}

impl Interpreter for Klartext {
    fn step(&mut self, kernel: &mut Kernel) -> Result<Flow, Fault> {
        let index = self.pc;
        let file = self
            .calls
            .iter()
            .rev()
            .find(|call| !call.label && call.end.is_none())
            .map_or(0, |call| self.statements.text(call.start).unwrap_or(0));
        let Some(statement) = self.statements.at(index)?.filter(|statement| statement.file == file) else {
            if self.back(false) {
                return Ok(Flow::Going);
            }
            self.flush(kernel)?;
            kernel.end()?;
            return Ok(Flow::Ended);
        };
        kernel.line = statement.line;
        kernel.depth = self.calls.len();
        kernel.main_line = self
            .calls
            .first()
            .map_or(statement.line, |call| if call.end.is_some() { statement.line } else { call.line });
        self.pc += 1;
        if statement.skip && kernel.control.skip[1] {
            return Ok(Flow::Going);
        }
        // The repeat that stands here has its own counter while it runs.
        if let Some(call) = self.calls.last_mut().filter(|call| call.end == Some(index)) {
            if call.left > 0 {
                call.left -= 1;
                call.count += 1;
                self.pc = call.start;
                kernel.loop_line = kernel.line;
            } else {
                self.pc = call.back;
                self.calls.pop();
            }
            return Ok(Flow::Going);
        }
        self.run(&statement, index, kernel)
    }

    fn variables(&self) -> Vec<(String, f64)> {
        self.store.0.iter().map(|(number, value)| (format!("Q{number}"), *value)).collect()
    }

    fn place(&self) -> Place {
        let file = self.statements.text(self.pc.saturating_sub(1));
        // Repeats of a part are no calls.
        let calls = self.calls.iter().rev().filter(|call| call.end.is_none());
        Place::new(file, &self.files, calls.map(|call| (call.line, call.count)))
    }
}

impl Klartext {
    fn run(&mut self, statement: &Statement, index: usize, kernel: &mut Kernel) -> Result<Flow, Fault> {
        let words = &statement.words;
        let word = |index: usize| words.get(index).map_or("", |(word, _)| word.as_str());
        let column = words.first().map_or(1, |(_, column)| *column);
        let first = word(0);
        match first {
            "BEGIN" => {
                match words.last().map(|(word, _)| word.as_str()) {
                    Some("MM") => kernel.scale = Some(Units::Millimetre.scale()),
                    Some("INCH") => kernel.scale = Some(Units::Inch.scale()),
                    _ => return Err(Fault::at(column, "BEGIN PGM ends with MM or INCH")),
                }
                return Ok(Flow::Going);
            }
            "END" => {
                if self.back(false) {
                    return Ok(Flow::Going);
                }
                self.flush(kernel)?;
                kernel.end()?;
                return Ok(Flow::Ended);
            }
            "BLK" => return Ok(Flow::Going),
            "LBL" => {
                if word(1) == "0" {
                    self.back(true);
                }
                return Ok(Flow::Going);
            }
            "CALL" => {
                self.call(words, index, kernel)?;
                return Ok(Flow::Going);
            }
            _ => {}
        }
        if first == "FN" || (first.starts_with("FN") && first.as_bytes().get(2).is_some_and(u8::is_ascii_digit)) {
            self.function(&statement.text, index, kernel).map_err(|fault| fault.or_at(column))?;
            return Ok(Flow::Going);
        }
        let is_q = first.strip_prefix('Q').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
        if is_q && statement.text.contains('=') {
            let (target, value) = statement.text.split_once('=').unwrap_or_default();
            let value = self.value(value.trim(), column)?;
            self.set(target.trim(), value).map_err(|fault| fault.or_at(column))?;
            return Ok(Flow::Going);
        }
        kernel.push(EventKind::Block);
        self.block(statement, kernel).map_err(|fault| fault.or_at(column))
    }
}
