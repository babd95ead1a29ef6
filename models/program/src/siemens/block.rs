//! What the words of a SINUMERIK block do.

use super::Siemens;
use super::modes::Move;
use super::parse::{Count, Item};
use crate::error::Fault;
use crate::kernel::Kernel;
use crate::motion::{AXES, EventKind, Sense};
use crate::run::Flow;
use toolroom_dialect::Expression;

/// The value of an address.
#[derive(Clone, Debug)]
struct Value {
    address: String,
    count: Count,
    value: f64,
    column: usize,
    used: bool,
}

/// Values of a block by address.
#[derive(Default)]
pub(super) struct Values(Vec<Value>);

impl Values {
    /// Value, how it counts, and column; it counts as understood afterwards.
    pub fn take(&mut self, address: &str) -> Option<(f64, Count, usize)> {
        let word = self.0.iter_mut().find(|word| word.address == address && !word.used)?;
        word.used = true;
        Some((word.value, word.count, word.column))
    }

    pub fn has(&self, address: &str) -> bool {
        self.0.iter().any(|own| own.address == address)
    }
}

/// Words that change how the control computes, but neither the path nor the time at programmed feeds; TRAFOOF ends
/// transformations of five axes, of which none is followed.
const QUIET: &str = "TRAFOOF CUT2DF FFWON FFWOF SOFT BRISK DRIVE COMPON COMPCURV COMPCAD COMPOF NORM KONT KONTC KONTT CFC CFTCP \
                     CFIN WALIMON WALIMOF STOPRE ORIWKS ORIMKS ORIAXES DIAMOF UPATH SPATH STARTFIFO STOPFIFO DYNNORM DYNPOS \
                     DYNROUGH DYNSEMIFIN DYNFINISH DYNPREC FIFOCTRL COMPSURF FNORM SBLON SBLOF";

impl Siemens {
    pub(super) fn block(&mut self, items: &[Item], kernel: &mut Kernel) -> Result<Flow, Fault> {
        let mut values = Values::default();
        let mut keywords: Vec<(&str, usize)> = Vec::new();
        let mut calls: Vec<(&str, &[Option<Expression>], usize)> = Vec::new();
        let mut g: Vec<(u32, usize)> = Vec::new();
        let mut m: Vec<(u32, usize)> = Vec::new();
        let mut named_tool = false;
        for item in items {
            match item {
                Item::Assign(target, value) => {
                    let value = self.value(value)?;
                    self.assign(target, value)?;
                }
                Item::Define(name, value) => {
                    let value = self.value(value)?;
                    self.define(name, value);
                }
                Item::Text { address, text, column } => {
                    if address != "T" {
                        return Err(Fault::at(
                            *column,
                            format!("{address}=\"{text}\" is not understood; only T takes a name"),
                        )
                        .refusing());
                    }
                    named_tool = true;
                }
                Item::Keyword(word, column) => keywords.push((word, *column)),
                Item::Call(word, arguments, column) => calls.push((word, arguments, *column)),
                Item::Word { address, column, .. } if self.is_ambiguous(address) => {
                    return Err(Fault::at(
                        *column,
                        format!(
                            "{address} is a variable here, by its DEF or PROC, and an address of the control: it might move an \
                             axis or take a value; give the variable a name whose first two characters are letters"
                        ),
                    )
                    .refusing());
                }
                // A variable may have the name of an axis with a number.
                Item::Word { address, value, .. } if self.is_defined(address) => {
                    let value = self.value(value)?;
                    self.assign(&Expression::Named(address.clone()), value)?;
                }
                Item::Word { address, count, value, column } => {
                    let value = self.value(value).map_err(|fault| fault.or_at(*column))?;
                    let code = |limit: f64| {
                        if (0.0..=limit).contains(&value) && value.fract() == 0.0 {
                            Ok((value as u32, *column))
                        } else {
                            Err(Fault::at(*column, format!("{address}{value} is no code")))
                        }
                    };
                    match address.as_str() {
                        "G" => g.push(code(9999.0)?),
                        "M" | "M1" => m.push(code(99_999.0)?),
                        _ => {
                            if values.has(address) {
                                return Err(Fault::at(
                                    *column,
                                    format!("{address} stands twice in the block; leave one out"),
                                ));
                            }
                            values.0.push(Value {
                                address: address.clone(),
                                count: *count,
                                value,
                                column: *column,
                                used: false,
                            });
                        }
                    }
                }
            }
        }
        let (mut motions, mut machine, mut stop, mut dwell, mut home) = (0, false, false, false, false);
        let mut pole = None;
        self.modes.about_pole = false;
        for (code, column) in g {
            match code {
                4 => dwell = true,
                9 => stop = true,
                53 | 153 => machine = true,
                74 | 75 => home = true,
                110..=112 => pole = Some((code, column)),
                _ => motions += u32::from(self.code(code, &mut values, kernel).map_err(|fault| fault.or_at(column))?),
            }
        }
        let mut frame: Option<(&str, usize)> = None;
        let mut modal_call = false;
        let mut sub: Option<(&str, usize)> = None;
        for (word, column) in keywords {
            match word {
                "SUPA" => machine = true,
                "CIP" | "CT" => {
                    self.modes.motion = if word == "CIP" { Move::Through } else { Move::Tangent };
                    motions += 1;
                }
                "TRANS" | "ATRANS" | "ROT" | "AROT" | "SCALE" | "ASCALE" | "MIRROR" | "AMIRROR" => {
                    frame = Some((word, column))
                }
                "MCALL" => modal_call = true,
                "RET" => m.push((17, column)),
                "DIAMON" => {
                    return Err(Fault::at(
                        column,
                        "DIAMON is a word of lathes; SINUMERIK programs are followed for mills",
                    ));
                }
                _ if QUIET.split(' ').any(|quiet| quiet == word) => {}
                _ => sub = Some((word, column)),
            }
        }
        if motions > 1 {
            return Err(Fault::new("two motions stand in one block; give each a block of its own"));
        }
        if dwell {
            self.dwell(&mut values, kernel)?;
        } else {
            self.technology(&mut values, kernel)?;
        }
        if named_tool {
            self.modes.next_tool = None;
            kernel.note("a tool is called by its name, so its number is not known");
            if self.turret {
                kernel.change_tool(None);
            }
        }
        let (before, after): (Vec<_>, Vec<_>) =
            m.into_iter().partition(|(code, _)| !matches!(code, 0 | 1 | 2 | 5 | 9 | 17 | 30));
        for (code, _) in before {
            self.function(code, kernel);
        }
        if modal_call {
            self.modal = None;
        }
        for (word, arguments, column) in calls {
            // Their values, such as _ROUGH, move nothing.
            if matches!(word, "MSG" | "CYCLE832") {
                continue;
            }
            let mut list = Vec::with_capacity(arguments.len());
            for argument in arguments {
                list.push(argument.as_ref().map(|argument| self.value(argument)).transpose()?);
            }
            self.cycle(word, &list, modal_call, kernel).map_err(|fault| fault.or_at(column))?;
        }
        if let Some((code, column)) = pole {
            self.pole(code, &mut values, kernel).map_err(|fault| fault.or_at(column))?;
        } else if let Some((word, column)) = frame {
            self.frame(word, &mut values, kernel).map_err(|fault| fault.or_at(column))?;
        } else if home {
            let axes: Vec<usize> = (0..6)
                .filter(|axis| {
                    values
                        .take(&format!("{}1", AXES[*axis]))
                        .or_else(|| values.take(&AXES[*axis].to_string()))
                        .is_some()
                })
                .collect();
            kernel.machine_motion(&axes)?;
        } else if machine {
            let axes: Vec<usize> = (0..6).filter(|axis| values.take(&AXES[*axis].to_string()).is_some()).collect();
            // D0 and G0 of the block have been taken; the axes go where only the machine knows.
            kernel.machine_motion(&axes)?;
        } else if !dwell {
            kernel.moved = false;
            self.motion(&mut values, kernel)?;
            if kernel.moved {
                if stop || kernel.exact {
                    kernel.push(EventKind::ExactStop);
                }
                if let Some(modal) = self.modal.clone() {
                    self.repeat(&modal, kernel)?;
                }
            }
        }
        if let Some((word, column)) = sub.filter(|_| modal_call) {
            self.cycle(word, &[], true, kernel).map_err(|fault| fault.or_at(column))?;
        } else if let Some((word, column)) = sub {
            let count = values.take("P").map_or(1.0, |(count, ..)| count);
            if !(0.0..=1e8).contains(&count) {
                return Err(Fault::at(column, format!("P={count} is no number of runs")));
            }
            let line = kernel.line;
            self.call(word, count as u32, Vec::new(), false, line).map_err(|fault| fault.or_at(column))?;
        } else if let Some((number, _, column)) = values.take("L") {
            let count = values.take("P").map_or(1.0, |(count, ..)| count);
            let line = kernel.line;
            self.call(&format!("L{number}"), count.clamp(0.0, 1e8) as u32, Vec::new(), false, line)
                .map_err(|fault| fault.or_at(column))?;
        }
        if let Some(left) = values.0.iter().find(|own| !own.used) {
            let message = format!(
                "{} {} has no meaning for siemens in this block; it might move axes or take time: mend the block",
                left.address, left.value
            );
            return Err(Fault::at(left.column, message));
        }
        for (code, _) in after {
            match code {
                0 => kernel.push(EventKind::Stop(false)),
                1 => kernel.push(EventKind::Stop(true)),
                5 => kernel.spindle(Sense::Still),
                9 => kernel.push(EventKind::Coolant(false)),
                _ => {
                    kernel.push(EventKind::Auxiliary(code, 0.0));
                    if matches!(code, 2 | 30) || !self.back(kernel) {
                        kernel.end()?;
                        return Ok(Flow::Ended);
                    }
                }
            }
        }
        Ok(Flow::Going)
    }
}
