//! Every output of a process at one operating point, or at many.
//!
//! A parameter set is used at the cut for which it was made; changes of inputs, states and parameters are texts of the
//! form `key=value` with a unit. Numbers of a [`Point`] are in the units of their headers.

mod error;
mod evaluate;
mod grid;
mod turning;

pub use error::PointError;
pub use grid::{Axis, Column, PointGrid};

use evaluate::evaluate;
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::Path;
use toolroom_cutting::{LifeModel, Milling, MillingInput};
use toolroom_effects::{Definition, Effect, Effects};
use toolroom_form::significant;
use toolroom_infeed::{Infeed, Parameters};
use toolroom_process::{Process, ProcessEvent};

/// A process that can be evaluated at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointProcess {
    /// Turning of a tool and workpiece pair.
    Turning,
    /// Milling with a cutter.
    Milling,
    /// Plunge grinding.
    Infeed,
}

/// What is evaluated where.
#[derive(Clone, Debug)]
pub struct PointOptions {
    /// Name of a parameter set, or path of its file; that of the demo where it is `None`.
    pub tool: Option<String>,
    /// Changes `key=value` of inputs and states, `group.key=value` of parameters.
    pub changes: Vec<String>,
    /// Effects that are switched on, `id=size`.
    pub effects: Vec<String>,
    /// Effects that a user has defined.
    pub defined: Vec<&'static Definition>,
    /// Time by which the process is advanced, with its unit.
    pub advance: Option<String>,
    /// How the life of a turning tool is worked out.
    pub life_model: LifeModel,
}

impl Default for PointOptions {
    /// A set of the demo without changes and effects; lives of a tool body in balance.
    fn default() -> Self {
        Self {
            tool: None,
            changes: Vec::new(),
            effects: Vec::new(),
            defined: Vec::new(),
            advance: None,
            life_model: LifeModel::QuasiSteady,
        }
    }
}

/// One operating point worked out: values by header.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Name of the process.
    pub process: &'static str,
    /// Inputs, after the advance where there is one.
    pub inputs: Vec<(String, Value)>,
    /// The state, after the advance where there is one.
    pub state: Vec<(String, Value)>,
    /// Outputs; of turning also speeds and lives.
    pub outputs: Vec<(String, Value)>,
    /// What stopped the advance before its time.
    pub event: Option<ProcessEvent>,
}

/// Effects of the options.
fn effects(options: &PointOptions) -> Result<Effects, PointError> {
    let effects =
        options.effects.iter().map(|text| Effect::parse(text, &options.defined)).collect::<Result<Vec<_>, _>>();
    effects.and_then(Effects::new).map_err(PointError::Effect)
}

/// Milling with the set of the options, at the cut for which that was made, unless a change says otherwise.
fn milling(options: &PointOptions, effects: Effects) -> Result<(Milling, MillingInput), PointError> {
    let milling = Milling::load(options.tool.as_deref().unwrap_or("c45_endmill_d12"), Path::new(""))?;
    effects.check(Milling::NAME).map_err(PointError::Effect)?;
    let start = MillingInput {
        cutting_speed: milling.life.reference_speed,
        feed_per_tooth: milling.life.reference_feed,
        depth_of_cut: milling.life.reference_depth,
        width_of_cut: milling.life.reference_width,
        ..MillingInput::default()
    };
    Ok((Milling { effects, ..milling }, start))
}

/// Grinding with the set of the options.
fn infeed(options: &PointOptions, effects: Effects) -> Result<Infeed, PointError> {
    let parameters = Parameters::named(options.tool.as_deref().unwrap_or("zb153u_40kh"))?;
    Infeed::new(parameters, effects).map_err(PointError::Effect)
}

impl Point {
    /// Evaluates a process.
    ///
    /// # Errors
    /// See [`PointError`].
    pub fn new(process: PointProcess, options: &PointOptions) -> Result<Self, PointError> {
        let effects = effects(options)?;
        match process {
            PointProcess::Turning => turning::point(options, effects),
            PointProcess::Milling => {
                let (mut milling, start) = milling(options, effects)?;
                Ok(evaluate(&mut milling, start, options)?.0)
            }
            PointProcess::Infeed => {
                let mut infeed = infeed(options, effects)?;
                Ok(evaluate(&mut infeed, toolroom_infeed::Input::default(), options)?.0)
            }
        }
    }

    /// The point for programs.
    pub fn json(&self) -> Value {
        let object = |values: &[(String, Value)]| Map::from_iter(values.iter().cloned());
        json!({
            "schema": 1,
            "process": self.process,
            "inputs": object(&self.inputs),
            "state": object(&self.state),
            "outputs": object(&self.outputs),
            "event": self.event.map(ProcessEvent::name),
        })
    }

    /// The point for a terminal.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n", self.process);
        for (title, values) in [("inputs", &self.inputs), ("state", &self.state), ("outputs", &self.outputs)] {
            let _ = writeln!(text, "{title}");
            for (name, value) in values {
                let value = match value {
                    Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), significant),
                    Value::String(text) => text.clone(),
                    Value::Null | Value::Bool(_) | Value::Array(_) | Value::Object(_) => value.to_string(),
                };
                let _ = writeln!(text, "  {name:34} {value:>14}");
            }
        }
        if let Some(event) = self.event {
            let _ = writeln!(text, "stopped by {}", event.name());
        }
        text.trim_end().to_owned()
    }
}
