//! Part programs that mills run: tool call by tool call, each with the edge of its tool.

use crate::policies::PlanError;
use crate::{ProcessModel, ToolType};
use std::path::Path;
use toolroom_stock::{CallError, Calls, Setup, Span, TimedStretch};

/// A part program as the work of an operation.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramWork {
    /// The program as written in the scenario.
    pub file: String,
    /// Its tool calls in order: the passes of the operation.
    pub calls: Vec<ToolCall>,
    /// What a log of the machine could time by itself.
    pub stretches: Vec<TimedStretch>,
}

/// A call of a tool of the shop.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolCall {
    /// Tool, by index into those of the scenario.
    pub tool: usize,
    /// Time of all that happens until the next one, s.
    pub time: f64,
    /// Way of the tool in material, m.
    pub path: f64,
    /// What the tool does, in order; their times add up to `time`.
    pub spans: Vec<Span>,
}

/// Why a program is no work for a shop.
#[derive(Debug, thiserror::Error)]
pub enum ProgramWorkError {
    /// The program or its machine.
    #[error("{file}:{reason}")]
    Program {
        /// The program as written.
        file: String,
        /// Why.
        reason: Box<CallError>,
    },
    /// No tool of the setup is one of the shop.
    #[error("no [[tool]] of {setup} has the `name` of a tool of the scenario ({known}): nothing would wear")]
    NoTool {
        /// The setup as written.
        setup: String,
        /// Tools of the scenario.
        known: String,
    },
    /// A tool that is no cutter of the shop's mills.
    #[error("tool \"{tool}\" of {setup} is no milling tool in the scenario")]
    NoMill {
        /// The setup as written.
        setup: String,
        /// Name.
        tool: String,
    },
    /// The cutter of the setup is another than that of the scenario.
    #[error(transparent)]
    Cutter(#[from] PlanError),
}

impl ProgramWork {
    /// The program `file` with its `setup`, both names from `folder`, for tools of a shop.
    ///
    /// Tools of the setup without a name of the shop wear no edge; their time goes with the call before of one that has, or
    /// with the first.
    ///
    /// # Errors
    /// [`ProgramWorkError`].
    pub fn new(
        folder: &Path,
        [file, setup_file]: [&str; 2],
        setup: &Setup,
        tools: &[Option<&ToolType>],
        names: &[String],
    ) -> Result<Self, ProgramWorkError> {
        let refuse = |reason| ProgramWorkError::Program { file: file.to_owned(), reason: Box::new(reason) };
        let run = Calls::of_files(&folder.join(file), &folder.join(setup_file), setup).map_err(refuse)?;
        let mut work = Self { file: file.to_owned(), calls: Vec::new(), stretches: run.stretches };
        let mut before: Vec<Span> = Vec::new();
        for call in run.calls {
            let named = call.tool.and_then(|number| setup.names.get(&number));
            let Some(tool) = named.and_then(|name| names.iter().position(|known| known == name)) else {
                // What wears nothing is out of cut for everything that wears.
                let idle = [Span { time: call.time, cut: None }];
                match work.calls.last_mut() {
                    Some(last) => {
                        last.time += call.time;
                        last.spans.extend(idle);
                    }
                    None => before.extend(idle),
                }
                continue;
            };
            let cutter = call.tool.and_then(|number| setup.tools.get(&number));
            match (tools[tool].map(|tool| &tool.process), cutter) {
                (Some(ProcessModel::Milling(milling)), Some(cutter)) => {
                    let both = [
                        ("a diameter in mm of", 2e3 * cutter.radius, 1e3 * milling.cutter.diameter),
                        ("a number of teeth of", cutter.teeth, milling.cutter.teeth),
                    ];
                    for (quantity, planned, mounted) in both {
                        if (planned - mounted).abs() > 1e-9 * mounted {
                            let file = setup_file.to_owned();
                            return Err(PlanError::Cutter { file, quantity, planned, tool: mounted }.into());
                        }
                    }
                }
                // An imported unit has its cutter by itself; a tool at fault was noted.
                (Some(ProcessModel::Other(_)) | None, _) | (_, None) => {}
                (Some(ProcessModel::Turning(_) | ProcessModel::Infeed(_)), Some(_)) => {
                    let (setup, tool) = (setup_file.to_owned(), names[tool].clone());
                    return Err(ProgramWorkError::NoMill { setup, tool });
                }
            }
            let time = call.time + before.iter().map(|span| span.time).sum::<f64>();
            work.calls.push(ToolCall {
                tool,
                time,
                path: call.path,
                spans: before.drain(..).chain(call.spans).collect(),
            });
        }
        if work.calls.is_empty() {
            return Err(ProgramWorkError::NoTool { setup: setup_file.to_owned(), known: names.join(", ") });
        }
        Ok(work)
    }

    /// Time of the whole program, s.
    pub fn time(&self) -> f64 {
        self.calls.iter().map(|call| call.time).sum()
    }
}
