//! Time in cut as programmed: the yardstick of effectiveness and of the cell.

use toolroom_process::{Field, MachineProcess};
use toolroom_sim::scenario::{Cut, Operation, Scenario, Work};

/// Time in cut of every operation at the programmed speeds, s, by part and operation.
///
/// A pass takes path over feed rate where the process has a feed rate (milling), else path over
/// cutting speed (turning); a grinding phase takes its revolutions over the work speed.
pub fn programmed_cutting_times(scenario: &Scenario) -> Vec<Vec<f64>> {
    let time = |operation: &Operation| match &operation.work {
        Work::Cutting(cuts) => {
            let process = scenario.tools.get(operation.tool).map(|tool| tool.process.machine_process());
            cuts.iter().map(|cut| process.map_or(f64::NAN, |process| cut_time(process, cut))).sum()
        }
        Work::Grinding { work_rotation_speed, phases } => {
            let revolutions: f64 = phases.iter().map(|phase| f64::from(phase.revolutions)).sum();
            revolutions * std::f64::consts::TAU / work_rotation_speed
        }
        Work::Contour(work) => work.programmed.iter().map(|plan| plan.time()).sum(),
        Work::Cycle(cycle) => {
            let revolutions: f64 = cycle.programmed.iter().map(|phase| f64::from(phase.revolutions)).sum();
            revolutions * std::f64::consts::TAU / cycle.conditions.work_rotation_speed
        }
    };
    scenario.parts.iter().map(|part| part.operations.iter().map(time).collect()).collect()
}

fn cut_time(process: &dyn MachineProcess, cut: &Cut) -> f64 {
    let Some(feed_rate) = element(process.outputs(), "feed_rate") else {
        return cut.path_length / cut.cutting_speed;
    };
    let mut input = start_values(process.inputs());
    let programmed = [
        ("cutting_speed", cut.cutting_speed),
        ("feed_per_rev", cut.feed),
        ("feed_per_tooth", cut.feed),
        ("depth_of_cut", cut.depth_of_cut),
        ("width_of_cut", cut.width_of_cut),
        ("engaged", 1.0),
    ];
    for (name, value) in programmed {
        if let Some(at) = element(process.inputs(), name) {
            input[at] = value;
        }
    }
    let mut output = start_values(process.outputs());
    process.output(&process.initial(), &input, &mut output);
    cut.path_length / output[feed_rate]
}

/// Position of a field among the elements.
fn element(fields: &[Field], name: &str) -> Option<usize> {
    let index = fields.iter().position(|field| field.name == name)?;
    Some(fields[..index].iter().map(|field| field.len).sum())
}

fn start_values(fields: &[Field]) -> Vec<f64> {
    fields.iter().flat_map(|field| std::iter::repeat_n(field.start, field.len)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use std::sync::Arc;
    use toolroom_cutting::Milling;
    use toolroom_sim::scenario::ProcessModel;

    #[test]
    fn turning_takes_path_over_speed_and_grinding_its_revolutions() {
        // Two cuts of 60 m at 0.5 m/s; 100 revolutions, one a second.
        let times = programmed_cutting_times(&fixture::scenario());
        assert_eq!(times.len(), 1);
        assert!((times[0][0] - 240.0).abs() < 1e-12 && (times[0][1] - 100.0).abs() < 1e-12);
    }

    #[test]
    fn milling_takes_path_over_feed_rate() {
        let mut scenario = fixture::scenario();
        let milling = Milling::named("c45_endmill_d12").expect("a shipped set");
        let (teeth, diameter) = (milling.cutter.teeth, milling.cutter.diameter);
        scenario.tools[0].process = ProcessModel::Milling(Arc::new(milling));
        let Work::Cutting(cuts) = &mut scenario.parts[0].operations[0].work else { panic!("the fixture turns first") };
        cuts.truncate(1);
        cuts[0].width_of_cut = 0.5 * diameter;
        // Speed 0.5 m/s, feed 0.1 mm a tooth: feed rate = f z v / (π D).
        let feed_rate = 1e-4 * teeth * 0.5 / (std::f64::consts::PI * diameter);
        let time = programmed_cutting_times(&scenario)[0][0];
        assert!((time - 60.0 / feed_rate).abs() < 1e-9 * time, "{time}");
    }
}
