//! SINUMERIK 840D: words, expressions, control structures, frames and drilling cycles.

mod block;
mod cycles;
mod modes;
mod parse;
mod path;
mod polar;

use crate::Dialect;
use crate::error::Fault;
use crate::kernel::Kernel;
use crate::library::Library;
use crate::motion::EventKind;
use crate::run::{Flow, Interpreter, Place, between};
use cycles::Modal;
use modes::Modes;
use parse::{Code, Direction, Item, LineReader, Statement, link};
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use toolroom_dialect::{Expression, Variables};
use toolroom_pages::{Pages, Source};

/// Variables: R parameters and names.
#[derive(Clone, Debug, Default)]
struct Store {
    numbered: BTreeMap<u32, f64>,
    named: HashMap<String, f64>,
}

impl Variables for Store {
    fn number(&self, index: u32) -> Result<Option<f64>, String> {
        Ok(Some(self.numbered.get(&index).copied().unwrap_or(0.0)))
    }

    fn named(&self, name: &str) -> Result<Option<f64>, String> {
        match name {
            "TRUE" => Ok(Some(1.0)),
            // Neither a search, a simulation nor a dry run.
            "FALSE" | "$P_SEARCH" | "$P_SIM" | "$P_DRYRUN" | "$P_ISTEST" => Ok(Some(0.0)),
            _ => match self.named.get(name) {
                Some(value) => Ok(Some(*value)),
                None if name.starts_with('$') => {
                    Err(format!("{name} belongs to the control, and its value is not known here"))
                }
                None => Err(format!("{name} has no value; define it with DEF, or mend the word")),
            },
        }
    }
}

/// Modes that a subprogram with SAVE gives back: absolute or by steps, plane, exact stop, motion, frame.
#[derive(Clone, Debug)]
struct Saved {
    absolute: bool,
    plane: [usize; 3],
    exact: bool,
    modes: Modes,
}

/// A call or a repeated part that has not ended.
#[derive(Clone, Debug)]
struct Call {
    start: usize,
    /// Statement behind the part; `None` for a subprogram, which ends by itself.
    end: Option<usize>,
    back: usize,
    left: u32,
    line: usize,
    count: usize,
    /// Whether motions call it.
    modal: bool,
    /// Values that the call gives to the parameters.
    arguments: Vec<Option<f64>>,
    /// Variables of the same name outside, which come back when it ends.
    hidden: Vec<(String, Option<f64>)>,
    saved: Option<Box<Saved>>,
}

impl Call {
    fn new(start: usize, end: Option<usize>, back: usize, runs: u32, line: usize) -> Self {
        let (left, count) = (runs - 1, 1);
        Self {
            start,
            end,
            back,
            left,
            line,
            count,
            modal: false,
            arguments: Vec::new(),
            hidden: Vec::new(),
            saved: None,
        }
    }
}

pub(crate) struct Siemens {
    statements: Pages<LineReader>,
    files: Vec<String>,
    sections: HashMap<String, usize>,
    /// Statements that begin sections, in order.
    heads: Vec<usize>,
    pc: usize,
    calls: Vec<Call>,
    store: Store,
    modes: Modes,
    modal: Option<Modal>,
    library: Library,
    /// Whether T changes the tool by itself, since the program has no M6.
    turret: bool,
}

/// Depth of subprograms below the main program (SINUMERIK 840D: 11 levels with it; cited from memory: assumption).
const DEPTH: usize = 10;

impl Siemens {
    pub fn new(text: &Source, library: Library) -> Result<Self, Fault> {
        let mut interpreter = Self {
            statements: Pages::new(),
            files: Vec::new(),
            sections: HashMap::new(),
            heads: Vec::new(),
            pc: 0,
            calls: Vec::new(),
            store: Store::default(),
            modes: Modes::default(),
            modal: None,
            library,
            turret: true,
        };
        interpreter.add(text, String::new())?;
        Ok(interpreter)
    }

    fn add(&mut self, text: &Source, file: String) -> Result<usize, Fault> {
        let reader = LineReader { file: self.files.len() };
        let is_program = self.files.is_empty();
        self.files.push(file);
        let mut open = Vec::new();
        let Self { statements, sections, heads, turret, .. } = self;
        let is_m6 = |item: &Item| matches!(item, Item::Word { address, value, .. } if address == "M" && value.literal() == Some(6.0));
        let items = statements.add(text, reader, |index, list| {
            link(list, index, &mut open);
            match list.item(index).map(|statement| &statement.code) {
                Some(Code::Section(name)) => {
                    sections.entry(name.clone()).or_insert(index + 1);
                    heads.push(index);
                }
                Some(Code::Block(items)) if is_program && items.iter().any(is_m6) => *turret = false,
                _ => {}
            }
        })?;
        for index in open {
            if let Some(statement) = statements.item(index) {
                statement.code = Code::Fault(Fault::at(1, "the end of this loop or condition is missing"));
            }
        }
        Ok(items.start)
    }

    fn value(&self, expression: &Expression) -> Result<f64, Fault> {
        Ok(expression.value(&self.store, Dialect::Siemens)?.unwrap_or(0.0))
    }

    /// Whether DEF has given a name with a number a value.
    fn is_defined(&self, name: &str) -> bool {
        name.len() > 1 && self.store.named.contains_key(name)
    }

    /// Whether a word with this one letter may mean a variable of the running program or subprogram. The control asks for names whose first
    /// two characters are letters or underscores (840D, fundamentals, "identifiers"); where such a variable is only read, what is
    /// meant is clear.
    fn is_ambiguous(&self, address: &str) -> bool {
        let call = self.calls.iter().rev().find(|call| call.end.is_none());
        address.len() == 1
            && match call {
                Some(call) => call.hidden.iter().any(|(known, _)| known == address),
                None => self.store.named.contains_key(address),
            }
    }

    fn assign(&mut self, target: &Expression, value: f64) -> Result<(), Fault> {
        match target {
            Expression::Named(name) if name.starts_with('$') => {
                Err(Fault::new(format!("{name} belongs to the control, and what is written there is not followed")).refusing())
            }
            Expression::Named(name) if !self.store.named.contains_key(name) => Err(Fault::new(format!(
                "{name}= is not understood; it might move axes or take time: mend it, or define {name} with DEF where it is a variable"
            )).refusing()),
            Expression::Named(name) => {
                self.store.named.insert(name.clone(), value);
                Ok(())
            }
            Expression::Variable(index) => {
                let index = self.value(index)?;
                if !(0.0..=9999.0).contains(&index) {
                    return Err(Fault::new(format!("R{index} is no R parameter")));
                }
                self.store.numbered.insert(index.round() as u32, value);
                Ok(())
            }
            Expression::Number(_) | Expression::Negate(_) | Expression::Call(..) | Expression::Binary(..) => {
                Err(Fault::new("only a variable takes a value"))
            }
        }
    }

    /// Statements of the section in which `pc` stands.
    fn unit(&self, pc: usize) -> Range<usize> {
        between(&self.heads, pc, self.statements.items(self.statements.text(pc).unwrap_or(0)))
    }

    fn label(&mut self, name: &str, from: usize, direction: Direction) -> Result<usize, Fault> {
        let Range { start, end } = self.unit(from);
        let number: Option<u32> = name.strip_prefix('N').and_then(|rest| rest.parse().ok());
        let fits = |statement: &Statement| {
            statement.label.as_deref() == Some(name) || (number.is_some() && statement.number == number)
        };
        let mut found = None;
        if direction != Direction::Backward {
            found = self.statements.find(from + 1..end, fits)?;
        }
        if direction != Direction::Forward && found.is_none() {
            found = self.statements.find_back(start..from.min(end), fits)?;
        }
        found.ok_or_else(|| {
            Fault::new(format!("there is no label {name} in this direction; check name and GOTOF or GOTOB"))
        })
    }

    /// Defines a variable where the program stands: that of the same name outside is hidden until the subprogram ends.
    fn define(&mut self, name: &str, value: f64) {
        let outside = self.store.named.insert(name.to_owned(), value);
        let call = self.calls.iter_mut().rev().find(|call| call.end.is_none());
        if let Some(call) = call.filter(|call| call.hidden.iter().all(|(known, _)| known != name)) {
            call.hidden.push((name.to_owned(), outside));
        }
    }

    /// The head of a subprogram: its parameters take the values of the call.
    fn procedure(&mut self, parameters: &[(String, Expression)], saves: bool, kernel: &Kernel) -> Result<(), Fault> {
        let Some(call) = self.calls.last().filter(|call| call.end.is_none()) else { return Ok(()) };
        let arguments = call.arguments.clone();
        if arguments.len() > parameters.len() {
            return Err(Fault::new(format!(
                "the call gives {} values, and the subprogram takes {}",
                arguments.len(),
                parameters.len()
            )));
        }
        let mut values = Vec::with_capacity(parameters.len());
        for (index, (_, otherwise)) in parameters.iter().enumerate() {
            values.push(arguments.get(index).copied().flatten().map_or_else(|| self.value(otherwise), Ok)?);
        }
        for ((name, _), value) in parameters.iter().zip(values) {
            self.define(name, value);
        }
        if saves && let Some(call) = self.calls.last_mut().filter(|call| call.saved.is_none()) {
            let Kernel { absolute, plane, exact, .. } = *kernel;
            call.saved = Some(Box::new(Saved { absolute, plane, exact, modes: self.modes.clone() }));
        }
        Ok(())
    }

    /// Calls a subprogram by its name, with values for its parameters; `modal` where a motion calls it.
    fn call(
        &mut self,
        name: &str,
        count: u32,
        arguments: Vec<Option<f64>>,
        modal: bool,
        line: usize,
    ) -> Result<(), Fault> {
        let start = match self.sections.get(name) {
            Some(start) => *start,
            None => {
                let lower = name.to_ascii_lowercase();
                let names = [name.to_owned(), lower.clone(), format!("_N_{name}_SPF")];
                let missing = Fault::new(format!(
                    "{name} is no word of this control that is followed, and no such subprogram is there; mend the word, or put \
                     {name}.SPF beside the program"
                ));
                let (file, text) = self.library.find(&names, &[".SPF", ".spf", ".MPF", ".mpf", ""]).ok_or(missing)?;
                let offset = self.add(&text, file)?;
                self.sections.insert(name.to_owned(), offset);
                offset
            }
        };
        if count == 0 {
            return Ok(());
        }
        if !arguments.is_empty() && !self.takes_values(start)? {
            return Err(Fault::new(format!("{name} takes no values: PROC {name}( ) with its parameters is missing")));
        }
        self.push(Call { modal, arguments, ..Call::new(start, None, self.pc, count, line) })?;
        self.pc = start;
        Ok(())
    }

    /// Whether a subprogram begins with PROC.
    fn takes_values(&mut self, start: usize) -> Result<bool, Fault> {
        let end = self.statements.len();
        let first = self.statements.find(start..end, |statement| !matches!(statement.code, Code::Nothing))?;
        let Some(first) = first else { return Ok(false) };
        Ok(self.statements.at(first)?.is_some_and(|statement| matches!(statement.code, Code::Procedure(..))))
    }

    fn push(&mut self, call: Call) -> Result<(), Fault> {
        if self.calls.len() >= DEPTH {
            return Err(Fault::new(format!("subprograms and repeated parts are nested more than {DEPTH} deep")));
        }
        self.calls.push(call);
        Ok(())
    }

    /// Ends a subprogram; false in the main program.
    fn back(&mut self, kernel: &mut Kernel) -> bool {
        // Repeated parts end with the subprogram in which they stand.
        while self.calls.last().is_some_and(|call| call.end.is_some()) {
            self.calls.pop();
        }
        let Some(call) = self.calls.last_mut() else { return false };
        if call.left > 0 {
            call.left -= 1;
            call.count += 1;
            self.pc = call.start;
            return true;
        }
        self.pc = call.back;
        let (hidden, saved) = (std::mem::take(&mut call.hidden), call.saved.take());
        self.calls.pop();
        for (name, value) in hidden {
            match value {
                Some(value) => self.store.named.insert(name, value),
                None => self.store.named.remove(&name),
            };
        }
        if let Some(saved) = saved {
            (kernel.absolute, kernel.plane, kernel.exact) = (saved.absolute, saved.plane, saved.exact);
            // Tools and offsets are no modes.
            self.modes = saved.modes.with_tools_of(&self.modes);
            kernel.frame = self.modes.whole_frame();
        }
        true
    }

    fn run(&mut self, code: &Code, index: usize, kernel: &mut Kernel) -> Result<Flow, Fault> {
        let jump = self.statements.at(index)?.map_or(0, |statement| statement.jump);
        match code {
            Code::Fault(fault) => return Err(fault.clone().refusing()),
            Code::Nothing | Code::EndIf | Code::Loop | Code::Repeat => {}
            Code::Procedure(parameters, saves) => self.procedure(parameters, *saves, kernel)?,
            Code::Section(_) => {
                if index > 0 {
                    return self.section_end(kernel);
                }
            }
            Code::Block(items) => {
                kernel.push(EventKind::Block);
                return self.block(items, kernel);
            }
            Code::If(condition) => {
                if self.value(condition)? == 0.0 {
                    self.pc = jump;
                }
            }
            Code::Else => self.pc = jump,
            Code::While(condition) => {
                if self.value(condition)? == 0.0 {
                    self.pc = jump;
                }
            }
            Code::EndWhile => self.pc = jump,
            Code::EndLoop => self.pc = jump + 1,
            Code::Until(condition) => {
                if self.value(condition)? == 0.0 {
                    self.pc = jump + 1;
                }
            }
            Code::For(variable, from, to) => {
                let (from, to) = (self.value(from)?, self.value(to)?);
                self.assign(variable, from)?;
                if from > to {
                    self.pc = jump;
                }
            }
            Code::EndFor => {
                let head = self.statements.at(jump)?;
                let Some(Code::For(variable, _, to)) = head.as_ref().map(|head| &head.code) else {
                    return Err(Fault::new("ENDFOR without FOR"));
                };
                let next = self.value(variable)? + 1.0;
                self.assign(variable, next)?;
                if next <= self.value(to)? {
                    self.pc = jump + 1;
                }
            }
            Code::Goto(condition, direction, label) => {
                let holds = condition.as_ref().map_or(Ok(1.0), |condition| self.value(condition))?;
                if holds != 0.0 {
                    self.pc = self.label(label, index, *direction)?;
                    // A jump out of a repeated part ends it.
                    while self
                        .calls
                        .last()
                        .is_some_and(|call| call.end.is_some_and(|end| !(call.start..end).contains(&self.pc)))
                    {
                        self.calls.pop();
                    }
                }
            }
            Code::Again(first, second, count, only) => {
                let count = self.value(count)?;
                if !(0.0..=1e8).contains(&count) {
                    return Err(Fault::new(format!("P={count}: write a number of repeats from 0 to 100 000 000")));
                }
                let start = self
                    .label(first, index, Direction::Backward)
                    .or_else(|_| self.label(first, index, Direction::Forward))?;
                let end = match second {
                    _ if *only => start + 1,
                    Some(second) => self.label(second, start - usize::from(start > 0), Direction::Forward)? + 1,
                    None => {
                        let end = self.unit(index).end;
                        let ends = |statement: &Statement| statement.label.as_deref() == Some("ENDLABEL");
                        let found = self.statements.find(start..end, ends)?;
                        match found {
                            Some(index) => index + 1,
                            None if start < index => index,
                            None => {
                                return Err(Fault::new(
                                    "the repeated part has no end: ENDLABEL or a second label is missing",
                                ));
                            }
                        }
                    }
                };
                if count >= 1.0 {
                    let line = kernel.line;
                    self.push(Call::new(start, Some(end), self.pc, count as u32, line))?;
                    self.pc = start;
                }
            }
        }
        if self.pc <= index {
            kernel.loop_line = kernel.line;
        }
        Ok(Flow::Going)
    }

    /// A section or file has no more statements.
    fn section_end(&mut self, kernel: &mut Kernel) -> Result<Flow, Fault> {
        if self.back(kernel) {
            return Ok(Flow::Going);
        }
        kernel.end()?;
        Ok(Flow::Ended)
    }
}

impl Interpreter for Siemens {
    fn step(&mut self, kernel: &mut Kernel) -> Result<Flow, Fault> {
        while let Some(call) = self.calls.last_mut() {
            if call.end != Some(self.pc) {
                break;
            }
            if call.left > 0 {
                call.left -= 1;
                call.count += 1;
                self.pc = call.start;
                break;
            }
            self.pc = call.back;
            self.calls.pop();
        }
        let index = self.pc;
        let file = self
            .calls
            .iter()
            .rev()
            .find(|call| call.end.is_none())
            .map_or(0, |call| self.statements.text(call.start.min(self.statements.len() - 1)).unwrap_or(0));
        let Some(statement) = self.statements.at(index)?.filter(|statement| statement.file == file) else {
            return self.section_end(kernel);
        };
        kernel.line = statement.line;
        kernel.depth = self.calls.len();
        kernel.main_line = self
            .calls
            .first()
            .map_or(statement.line, |call| if call.end.is_some() { statement.line } else { call.line });
        self.pc += 1;
        if statement.skip.is_some_and(|level| kernel.control.skip[usize::from(level.min(9))]) {
            return Ok(Flow::Going);
        }
        self.run(&statement.code, index, kernel)
    }

    fn variables(&self) -> Vec<(String, f64)> {
        let mut named: Vec<(String, f64)> =
            self.store.named.iter().map(|(name, value)| (name.clone(), *value)).collect();
        named.sort_by(|a, b| a.0.cmp(&b.0));
        self.store.numbered.iter().map(|(number, value)| (format!("R{number}"), *value)).chain(named).collect()
    }

    fn place(&self) -> Place {
        let file = self.statements.text(self.pc.saturating_sub(1));
        // Repeats of a part are no calls.
        let calls = self.calls.iter().rev().filter(|call| call.end.is_none());
        Place::new(file, &self.files, calls.map(|call| (call.line, call.count)))
    }
}
