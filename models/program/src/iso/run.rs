//! The flow of a program: blocks, jumps, loops, calls.

use super::cycles::Cycle;
use super::increments::Increments;
use super::modes::Modes;
use super::parse::{BlockCode, Code, LineReader, Order, link};
use super::turn::{Drilling, Turned, TwoBlocks};
use super::variables::{Locals, Store};
use super::words::Words;
use crate::Dialect;
use crate::error::Fault;
use crate::kernel::Kernel;
use crate::library::{Library, Twice};
use crate::motion::EventKind;
use crate::run::{Flow, Interpreter, Place, between};
use std::collections::HashMap;
use std::ops::Range;
use toolroom_dialect::Expression;
use toolroom_pages::{Pages, Source};

/// A call that has not returned.
#[derive(Clone, Debug)]
pub(super) struct Call {
    /// Statement behind the call.
    pub back: usize,
    /// First statement of the subprogram.
    pub start: usize,
    /// Repetitions that are left.
    pub left: u32,
    /// Whether it has variables of its own.
    pub own: bool,
    /// Line of the call and how often it has run.
    pub line: usize,
    pub count: usize,
    /// Whether it is that of a modal macro.
    pub modal: bool,
    /// Counters of `repeat` loops.
    loops: Vec<(usize, u64)>,
}

/// The interpreter.
pub(crate) struct Iso {
    pub(super) dialect: Dialect,
    pub(super) statements: Pages<LineReader>,
    files: Vec<String>,
    programs: HashMap<u32, usize>,
    /// Statements with the number of a program, in order.
    heads: Vec<usize>,
    subs: HashMap<String, usize>,
    /// Block numbers with their statements, sorted; filled by the first jump to one.
    numbers: Vec<(u32, u32)>,
    /// Statements whose numbers are there.
    numbered: usize,
    pub(super) pc: usize,
    pub(super) calls: Vec<Call>,
    loops: Vec<(usize, u64)>,
    pub(super) store: Store,
    pub(super) modes: Modes,
    pub(super) cycle: Option<Cycle>,
    /// The cycle of a lathe that ran last.
    pub(super) turned: Option<Turned>,
    /// The cycle of a lathe that drills.
    pub(super) drilling: Option<Drilling>,
    /// Values of the first block of a cycle in two.
    pub(super) two: TwoBlocks,
    library: Library,
    /// Macro that every motion calls (G66): its first statement and its values.
    pub(super) modal_macro: Option<(usize, Locals)>,
    words: Words,
    increments: Increments,
    /// End of the last cubic spline, and its last control point from there, mm.
    pub(super) spline_end: Option<([f64; 2], [f64; 2])>,
}

/// Depth of calls and of levels of macro variables (assumption: 10 levels as on newer Fanuc controls; older ones allow 4,
/// and what they would refuse runs here).
const DEPTH: usize = 10;

impl Iso {
    pub fn new(text: &Source, dialect: Dialect, library: Library) -> Result<Self, Fault> {
        let mut interpreter = Self {
            dialect,
            statements: Pages::new(),
            files: Vec::new(),
            programs: HashMap::new(),
            heads: Vec::new(),
            subs: HashMap::new(),
            numbers: Vec::new(),
            numbered: 0,
            pc: 0,
            calls: Vec::new(),
            loops: Vec::new(),
            store: Store::new(dialect),
            modes: Modes::new(dialect != Dialect::LinuxCnc),
            cycle: None,
            turned: None,
            drilling: None,
            two: TwoBlocks::default(),
            library,
            modal_macro: None,
            words: Words::default(),
            increments: Increments::default(),
            spline_end: None,
        };
        interpreter.add(text, String::new())?;
        Ok(interpreter)
    }

    fn add(&mut self, text: &Source, name: String) -> Result<(), Fault> {
        let reader = LineReader::new(self.dialect, self.files.len());
        let mut open = Vec::new();
        let (mut lines, mut twice) = (HashMap::new(), None);
        let Self { statements, programs, subs, heads, .. } = self;
        statements.add(text, reader, |index, list| {
            link(list, index, &mut open);
            match list.item(index).map(|statement| (&statement.code, statement.line)) {
                Some((Code::Program(number), line)) => {
                    if let Some(first) = lines.insert(*number, line) {
                        twice.get_or_insert_with(|| Twice(format!("O{number}"), first, line));
                    }
                    programs.entry(*number).or_insert(index);
                    heads.push(index);
                }
                Some((Code::Order(name, Order::Sub), _)) => {
                    subs.entry(name.clone()).or_insert(index);
                }
                _ => {}
            }
        })?;
        Twice::refuse(twice, &name)?;
        self.files.push(name);
        for open in open {
            if let Some(statement) = statements.item(open.index()) {
                statement.code = Code::Fault(open.fault());
            }
        }
        Ok(())
    }

    fn value(&self, expression: &Expression) -> Result<Option<f64>, Fault> {
        expression.value(&self.store, self.dialect)
    }

    fn truth(&self, expression: &Expression) -> Result<bool, Fault> {
        Ok(self.value(expression)?.unwrap_or(0.0) != 0.0)
    }

    /// Statements of the program in which `pc` stands.
    fn unit(&self, pc: usize) -> Range<usize> {
        between(&self.heads, pc, self.statements.items(self.statements.text(pc).unwrap_or(0)))
    }

    /// Statement of block `number`: forward from here, then from the top of the program.
    pub(super) fn block_number(&mut self, number: u32, start: usize) -> Result<usize, Fault> {
        let count = self.statements.len();
        if self.numbered < count {
            let mut index = self.numbered;
            let numbers = &mut self.numbers;
            self.statements.find(index..count, |statement| {
                numbers.extend(statement.number.map(|number| (number, index as u32)));
                index += 1;
                false
            })?;
            self.numbers.sort_unstable();
            self.numbered = count;
        }
        let unit = self.unit(start);
        let first = |least: usize| {
            let at = self.numbers.partition_point(|entry| *entry < (number, least as u32));
            let (known, index) = *self.numbers.get(at)?;
            Some(index as usize).filter(|index| known == number && *index < unit.end)
        };
        first(unit.start.max(start + 1))
            .or_else(|| first(unit.start))
            .ok_or_else(|| Fault::new(format!("there is no block N{number} in this program; check the number")))
    }

    /// First statement of a program by its number, here or in a file beside this one.
    pub(super) fn program(&mut self, number: u32) -> Result<usize, Fault> {
        if let Some(index) = self.programs.get(&number) {
            return Ok(index + 1);
        }
        let names = [format!("O{number:04}"), format!("O{number:05}"), format!("O{number}"), format!("{number:04}")];
        let missing = Fault::new(format!(
            "P{number}: no such program; put O{number} into this file, or the file O{number:04} beside it"
        ));
        let (name, text) = self.library.find(&names, &["", ".nc", ".NC", ".cnc", ".tap", ".txt"]).ok_or(missing)?;
        let start = self.statements.len();
        self.add(&text, name)?;
        Ok(self.programs.get(&number).map_or(start, |index| index + 1))
    }

    pub(super) fn call(
        &mut self,
        start: usize,
        count: u32,
        locals: Option<Locals>,
        line: usize,
        modal: bool,
    ) -> Result<(), Fault> {
        if self.calls.len() >= DEPTH {
            return Err(Fault::new(format!(
                "subprograms call each other more than {DEPTH} deep; check for one that calls itself"
            )));
        }
        if count == 0 {
            return Ok(());
        }
        let has_locals = locals.is_some();
        self.store.levels.extend(locals);
        let loops = std::mem::take(&mut self.loops);
        self.calls.push(Call { back: self.pc, start, left: count - 1, own: has_locals, line, count: 1, modal, loops });
        self.pc = start;
        Ok(())
    }

    /// Returns from a subprogram, or begins it again; `to` is a block of the caller. False in the main program.
    pub(super) fn back(&mut self, to: Option<u32>) -> Result<bool, Fault> {
        let Some(call) = self.calls.last_mut() else { return Ok(false) };
        if call.left > 0 && to.is_none() {
            call.left -= 1;
            call.count += 1;
            self.pc = call.start;
            self.loops.clear();
            return Ok(true);
        }
        let Some(call) = self.calls.pop() else { return Ok(false) };
        if call.own {
            self.store.levels.pop();
        }
        self.loops = call.loops;
        self.pc = call.back;
        if let Some(number) = to {
            self.pc = self.block_number(number, call.back.saturating_sub(1))?;
        }
        Ok(true)
    }

    fn assign(&mut self, assignments: &[(Expression, Expression)], kernel: &mut Kernel) -> Result<Flow, Fault> {
        // All values of a line are worked out before any is stored.
        let mut values = Vec::with_capacity(assignments.len());
        for (_, value) in assignments {
            values.push(self.value(value)?);
        }
        for ((target, _), value) in assignments.iter().zip(values) {
            match target {
                Expression::Named(name) => self.store.name(name, value.unwrap_or(0.0)),
                Expression::Variable(index) => {
                    let index = self.value(index)?.unwrap_or(-1.0);
                    if !(0.0..=99_999.0).contains(&index) {
                        return Err(Fault::new(format!("#{index} is no variable")));
                    }
                    let index = index.round() as u32;
                    match index {
                        3000 if self.dialect != Dialect::LinuxCnc => {
                            kernel.note(format!("the program ends here with alarm {}", value.unwrap_or(0.0)));
                            kernel.end()?;
                            return Ok(Flow::Ended);
                        }
                        3006 if self.dialect != Dialect::LinuxCnc => kernel.push(EventKind::Stop(false)),
                        _ => self.store.set(index, value).map_err(Fault::new)?,
                    }
                }
                Expression::Number(_) | Expression::Negate(_) | Expression::Call(..) | Expression::Binary(..) => {
                    return Err(Fault::new("only a variable takes a value"));
                }
            }
        }
        Ok(Flow::Going)
    }

    fn block(&mut self, code: &BlockCode, kernel: &mut Kernel) -> Result<Flow, Fault> {
        let mut words = std::mem::take(&mut self.words);
        words.clear();
        // Positions are requested by variables only.
        if code.words.iter().any(|word| word.value.literal().is_none()) {
            self.refresh(kernel);
        }
        for word in &code.words {
            let value = self.value(&word.value).map_err(|fault| fault.or_at(word.column))?;
            match value {
                Some(value) => {
                    words.put(word.letter, value, word.pointed, word.column)?;
                    if word.value.literal().is_some() {
                        self.increments.take(self.dialect, word.letter, value, word.pointed, kernel);
                    }
                }
                None => {
                    let variable = if let Expression::Variable(index) = &word.value {
                        format!("#{}", self.value(index)?.unwrap_or(0.0))
                    } else {
                        "its value".to_owned()
                    };
                    words.vacant.push((word.letter, variable));
                }
            }
        }
        let flow = self.execute(&mut words, kernel);
        self.words = words;
        let flow = flow?;
        if code.assignments.is_empty() {
            return Ok(flow);
        }
        self.refresh(kernel);
        match self.assign(&code.assignments, kernel)? {
            Flow::Going => Ok(flow),
            Flow::Ended => Ok(Flow::Ended),
        }
    }

    /// Where a statement leads: see [`Statement::jump`] and [`Statement::end`].
    fn links(&mut self, index: usize) -> Result<(usize, usize), Fault> {
        Ok(self.statements.at(index)?.map_or((0, 0), |statement| (statement.jump, statement.end)))
    }

    fn order(&mut self, name: &str, order: &Order, index: usize) -> Result<(), Fault> {
        let (jump, end) = self.links(index)?;
        match order {
            // A definition is passed over.
            Order::Sub => self.pc = jump,
            Order::EndSub(value) | Order::Return(value) => {
                let value = value.as_ref().map(|value| self.value(value)).transpose()?.flatten();
                if !self.back(None)? {
                    return Err(Fault::new("a return outside of a subprogram"));
                }
                self.store.name("_VALUE", value.unwrap_or(0.0));
                self.store.name("_VALUE_RETURNED", f64::from(u8::from(value.is_some())));
            }
            Order::Call(arguments) => {
                let mut locals = Locals::default();
                for (slot, argument) in locals.numbered[1..].iter_mut().zip(arguments) {
                    *slot = self.value(argument)?;
                }
                let start = self.sub(name)?;
                let line = self.statements.at(index)?.map_or(0, |statement| statement.line);
                self.call(start, 1, Some(locals), line, false)?;
            }
            Order::While(condition) => {
                if !self.truth(condition)? {
                    self.pc = jump;
                }
            }
            Order::EndWhile => self.pc = jump,
            Order::Do => {}
            Order::DoWhile(condition) => {
                if self.truth(condition)? {
                    self.pc = jump;
                }
            }
            Order::If(condition) => {
                let mut holds = self.truth(condition)?;
                let mut branch = index;
                while !holds {
                    (branch, _) = self.links(branch)?;
                    // An `else` holds whenever it is reached.
                    let statement = self.statements.at(branch)?;
                    let code = statement.as_ref().map(|statement| &statement.code);
                    holds = if let Some(Code::Order(_, Order::ElseIf(condition))) = code {
                        self.truth(condition)?
                    } else {
                        true
                    };
                }
                self.pc = branch + 1;
            }
            Order::ElseIf(_) | Order::Else => self.pc = end,
            Order::EndIf => {}
            Order::Repeat(count) => {
                let count = self.value(count)?.unwrap_or(0.0).round();
                if count < 1.0 {
                    self.pc = jump;
                } else {
                    self.loops.push((index, count.min(1e15) as u64 - 1));
                }
            }
            Order::EndRepeat => match self.loops.last_mut() {
                Some((begin, left)) if *begin == jump && *left > 0 => {
                    *left -= 1;
                    self.pc = jump + 1;
                }
                _ => {
                    self.loops.pop();
                }
            },
            Order::Break | Order::Continue => {
                let Some(begin) = self.statements.at(jump)? else { return Ok(()) };
                let repeats = matches!(begin.code, Code::Order(_, Order::Repeat(_)));
                let ends = *order == Order::Break;
                self.pc = if matches!(begin.code, Code::Order(_, Order::Do)) {
                    // The end of such a loop is its condition.
                    begin.jump + usize::from(ends)
                } else if ends {
                    begin.jump
                } else if repeats {
                    begin.jump - 1
                } else {
                    jump
                };
                if repeats && ends {
                    self.loops.pop();
                }
            }
        }
        Ok(())
    }

    fn sub(&mut self, name: &str) -> Result<usize, Fault> {
        if let Some(index) = self.subs.get(name) {
            return Ok(index + 1);
        }
        let lower = name.to_ascii_lowercase();
        let missing = Fault::new(format!(
            "o<{lower}> call: no such subprogram; define it in this file, or put {lower}.ngc beside it"
        ));
        let (file, text) =
            self.library.find(&[lower, name.to_owned()], &[".ngc", ".NGC"]).ok_or_else(|| missing.clone())?;
        self.add(&text, file)?;
        self.subs.get(name).map(|index| index + 1).ok_or(missing)
    }

    fn refresh(&mut self, kernel: &Kernel) {
        let scale = kernel.scale.unwrap_or(1.0);
        let position = kernel.program_at();
        self.store.position =
            std::array::from_fn(|i| if (3..6).contains(&i) { position[i] } else { position[i] / scale });
        self.modes.publish(kernel, &mut self.store.modal);
    }

    /// Motions call the macro of G66.
    pub(super) fn modal_call(&mut self, line: usize) -> Result<(), Fault> {
        if let Some((start, locals)) = self.modal_macro.clone()
            && !self.calls.iter().any(|call| call.modal)
        {
            self.call(start, 1, Some(locals), line, true)?;
        }
        Ok(())
    }
}

impl Interpreter for Iso {
    fn step(&mut self, kernel: &mut Kernel) -> Result<Flow, Fault> {
        let Some(statement) = self.statements.at(self.pc)? else {
            // The end of the file ends the program, as the tape does.
            kernel.end()?;
            return Ok(Flow::Ended);
        };
        let index = self.pc;
        let crosses = self.calls.is_empty() && statement.file > 0;
        if crosses {
            kernel.end()?;
            return Ok(Flow::Ended);
        }
        kernel.line = statement.line;
        kernel.main_line = self.calls.first().map_or(statement.line, |call| call.line);
        kernel.depth = self.calls.len();
        self.pc += 1;
        if statement.skip > 0 && kernel.control.skip[usize::from(statement.skip)] {
            return Ok(Flow::Going);
        }
        self.run(&statement.code, index, kernel)
    }

    fn variables(&self) -> Vec<(String, f64)> {
        self.store.known()
    }

    fn place(&self) -> Place {
        let file = self.statements.text(self.pc.saturating_sub(1));
        Place::new(file, &self.files, self.calls.iter().rev().map(|call| (call.line, call.count)))
    }
}

impl Iso {
    pub(super) fn run(&mut self, code: &Code, index: usize, kernel: &mut Kernel) -> Result<Flow, Fault> {
        match code {
            Code::Fault(fault) => return Err(fault.clone().refusing()),
            Code::Print => {}
            Code::Program(_) => {
                // A second program begins where the first has no end.
                let heads = self.heads.partition_point(|head| *head < index);
                if self.calls.is_empty() && heads < index {
                    kernel.end()?;
                    return Ok(Flow::Ended);
                }
            }
            Code::Block(block) => {
                if block.words.is_empty() {
                    if block.assignments.iter().any(|(_, value)| value.literal().is_none()) {
                        self.refresh(kernel);
                    }
                    return self.assign(&block.assignments, kernel);
                }
                kernel.push(EventKind::Block);
                return self.block(block, kernel);
            }
            Code::If(condition, then) => {
                self.refresh(kernel);
                if self.truth(condition)? {
                    return self.run(then, index, kernel);
                }
            }
            Code::Goto(target) => {
                let number = self.value(target)?.unwrap_or(-1.0);
                if !(0.0..=99_999_999.0).contains(&number) {
                    return Err(Fault::new(format!("GOTO {number}: that is no block number")));
                }
                self.pc = self.block_number(number.round() as u32, index)?;
                if self.pc <= index {
                    kernel.loop_line = kernel.line;
                }
            }
            Code::While(condition) => {
                if let Some(condition) = condition {
                    self.refresh(kernel);
                    if !self.truth(condition)? {
                        (self.pc, _) = self.links(index)?;
                    }
                }
            }
            Code::End => {
                (self.pc, _) = self.links(index)?;
                kernel.loop_line = kernel.line;
            }
            Code::Order(name, order) => {
                self.refresh(kernel);
                self.order(name, order, index)?;
                if self.pc <= index {
                    kernel.loop_line = kernel.line;
                }
            }
        }
        Ok(Flow::Going)
    }
}
