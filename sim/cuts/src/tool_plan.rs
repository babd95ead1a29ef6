//! A tool as the engine sees it, and how long its passes take.

use super::ports::{Ports, read, start_values, write};
use toolroom_scenario::{Cut, GrindingPhase, ProcessModel};

/// A tool as the engine sees it.
#[derive(Clone, Debug)]
pub struct ToolPlan {
    /// Where its quantities sit.
    pub ports: Ports,
    /// Input elements at their start values.
    pub input: Vec<f64>,
}

impl ToolPlan {
    /// Of the process of a tool.
    pub fn from_process_model(process: &ProcessModel) -> Self {
        let structure = process.has_structure();
        let process = process.machine_process();
        let ports = Ports { structure, ..Ports::of(process) };
        let mut input: Vec<f64> = start_values(process.inputs()).collect();
        write(&mut input, ports.engaged, 1.0);
        Self { ports, input }
    }

    /// The input of a cut at its programmed speed, without scatter.
    pub fn cut_input(&self, cut: &Cut) -> Vec<f64> {
        let mut input = Vec::new();
        self.write_cut(cut, &mut input);
        input
    }

    /// The same into a buffer that is there already.
    pub fn write_cut(&self, cut: &Cut, input: &mut Vec<f64>) {
        input.clone_from(&self.input);
        write(input, self.ports.cutting_speed, cut.cutting_speed);
        write(input, self.ports.feed, cut.feed);
        write(input, self.ports.depth_of_cut, cut.depth_of_cut);
        write(input, self.ports.width_of_cut, cut.width_of_cut);
        if cut.diameter > 0.0 {
            write(input, self.ports.workpiece_diameter, cut.diameter);
        }
        write(input, self.ports.position, cut.position);
    }
}

/// Duration of a whole pass at the constant speed in `input`, s: path over feed rate for
/// processes that have one (milling), else path over cutting speed.
pub fn cut_duration(cut: &Cut, process: &ProcessModel, tool: &ToolPlan, input: &[f64]) -> f64 {
    let process = process.machine_process();
    let Some(feed_rate) = tool.ports.feed_rate else { return cut.path_length / cut.cutting_speed };
    let mut output: Vec<f64> = start_values(process.outputs()).collect();
    let fresh = process.initial();
    process.output(&fresh, input, &mut output);
    process.retire(&fresh);
    cut.path_length / read(&output, Some(feed_rate), f64::NAN)
}

/// Duration of a grinding phase, s.
pub fn phase_duration(phase: &GrindingPhase, work_rotation_speed: f64) -> f64 {
    f64::from(phase.revolutions) * std::f64::consts::TAU / work_rotation_speed
}
