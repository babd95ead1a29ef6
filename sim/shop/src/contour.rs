//! Passes around a contour: its sections are the program of one pass; the wall that is left is
//! judged by its form.

use super::draws;
use super::pass::{PassStart, Place};
use super::recorder::Recorder;
use super::task::{InCut, in_cut};
use super::{Shop, ShopError};
use crate::runlog::ChangeReason;
use toolroom_contour::{EdgeForce, HelicalCut};
use toolroom_cuts::ports::{Ports, write};
use toolroom_cuts::program::{Block, Program};
use toolroom_cutting::{Milling, MillingInput, MillingState};
use toolroom_process::Record;
use toolroom_scenario::ProcessModel;
use toolroom_scenario::policies::{Conditions, ContourPlan, Observation};

impl<R: Recorder> Shop<'_, R> {
    /// A pass begins: every section at its planned speed and feed, as deep in the stock as the
    /// allowance of this part makes it.
    pub(super) fn begin_contour(&mut self, machine: usize, place: Place, first_pass: u32) -> Result<(), ShopError> {
        let pass = first_pass + place.pass as u32;
        let allowance = self.allowance(machine, place, first_pass);
        let plan =
            self.controllers.contour(machine, pass).expect("a contour is planned for every machine that may mill it");
        let controller = self.controllers.of_pass(machine, pass);
        let tool = &self.scenario.tools[place.tool];
        let tool_plan = &self.layout.tools[place.tool];
        let ports = &tool_plan.ports;
        let state = &mut self.world.machines[machine];
        let InCut { machining, edge, .. } = in_cut(&mut state.task, &mut state.edges[place.tool]);
        let first = plan.sections.first().map_or((0.0, 0.0), |first| (first.cutting_speed, first.feed_per_tooth));
        let mut program = program(plan, allowance, ports);
        program.skip(plan.time() * (1.0 - machining.piece.share_left));
        let duration = plan.time() * machining.piece.share_left;
        let observation = Observation {
            path: plan.path_length * machining.piece.share_left,
            edge_path: edge.row.path,
            edge_time: edge.row.cutting_time,
            edge_parts: edge.row.parts,
            last_speed: edge.last_speed,
            observer: edge.observer.as_ref(),
            reaction: None,
            true_wear: None,
            true_edge: None,
        };
        if edge.row.passes > 0 && controller.change_due(&observation, &Conditions::constant(first.0), duration) {
            edge.change_reason = Some(ChangeReason::Rule);
            return self.begin_change(machine);
        }
        let mut input = tool_plan.input.clone();
        write(&mut input, ports.cutting_speed, first.0);
        write(&mut input, ports.feed, first.1);
        write(&mut input, ports.depth_of_cut, plan.depth_of_cut);
        write(&mut input, ports.down_milling, if plan.milling == toolroom_contour::Milling::Down { 1.0 } else { 0.0 });
        edge.draw_noise(&tool.scatter, &self.streams);
        edge.write_scatter(&tool.scatter, &self.pairs[place.tool], machining.piece.blank, ports, &mut input);
        program.command(0.0, &mut input);
        state.segment.program = program;
        state.segment.start_input = input;
        let depth_of_cut = plan.depth_of_cut;
        let opened = PassStart { feed: first.1, depth_of_cut, speed: first.0, ..PassStart::lasting(duration) };
        self.open_pass(machine, place, opened);
        self.plan_segment(machine)
    }

    /// Allowance of this part on this pass, m.
    fn allowance(&self, machine: usize, place: Place, first_pass: u32) -> f64 {
        let Some(plan) = self.controllers.contour(machine, first_pass + place.pass as u32) else { return 0.0 };
        let operation = self.world.jobs.at(place.slot).entity.part(place.operation as u64);
        let scatter = &self.scenario.tools[place.tool].scatter;
        draws::depth(scatter, &self.streams, operation, place.pass as u32, plan.allowance)
    }

    /// Greatest error of the wall at the state to which the segment has come, m, with its sign;
    /// `None` for work that is no contour.
    pub(super) fn form_error(&self, machine: usize, place: Place, first_pass: u32) -> Option<f64> {
        let plan = self.controllers.contour(machine, first_pass + place.pass as u32)?;
        let ProcessModel::Milling(milling) = self.process(machine, place.tool) else { return None };
        let segment = &self.world.machines[machine].segment;
        let cutter = MillingState::from_slice(&segment.state);
        let conditions = MillingInput::from_slice(&segment.input);
        Some(form_error(plan, milling, &cutter, &conditions, self.allowance(machine, place, first_pass)))
    }
}

/// The sections one after the other; what is spent around corners and on spindle speeds comes
/// before, out of cut.
fn program(plan: &ContourPlan, allowance: f64, ports: &Ports) -> Program {
    let commands = |values: &[(Option<usize>, f64)]| {
        values.iter().filter_map(|&(element, value)| Some((element?, value))).collect()
    };
    let idle = Block { duration: plan.idle_time, commands: commands(&[(ports.engaged, 0.0)]) };
    let sections = plan.sections.iter().map(|section| {
        let immersion = section.engagement(plan.cutter_radius, allowance).immersion;
        Block {
            duration: section.time,
            commands: commands(&[
                (ports.engaged, 1.0),
                (ports.cutting_speed, section.cutting_speed),
                (ports.feed, section.feed_per_tooth),
                (ports.width_of_cut, immersion),
            ]),
        }
    });
    let idle = (plan.idle_time > 0.0).then_some(idle);
    Program { blocks: idle.into_iter().chain(sections).collect() }
}

/// Greatest error of the wall, m, with its sign (positive where material is left): deflection of
/// the cutter as it is, worst over the height, less what the programme takes back, and the error of
/// the drives; in corners the path alone.
///
/// The loss of radius by wear shifts the whole wall; it is taken to be corrected at the offset of the
/// tool and left out.
fn form_error(
    plan: &ContourPlan,
    milling: &Milling,
    cutter: &MillingState,
    conditions: &MillingInput,
    allowance: f64,
) -> f64 {
    let (force, stiffness) = (&milling.force, milling.cutter.static_stiffness);
    let hard = conditions.hardness_ratio.powf(force.hardness_exponent) * conditions.force_factor;
    let edge = EdgeForce {
        tangential_cutting: force.tangential_cutting * hard,
        radial_cutting: force.radial_cutting * hard,
        tangential_edge: force.tangential_edge * conditions.force_factor + force.flank_shear_stress * cutter.flank_wear,
        radial_edge: force.radial_edge * conditions.force_factor + force.flank_pressure * cutter.flank_wear,
        ..EdgeForce::default()
    };
    let mut greatest = plan.corner_error;
    for section in &plan.sections {
        let engagement = section.engagement(plan.cutter_radius, allowance);
        let input = MillingInput {
            cutting_speed: section.cutting_speed,
            feed_per_tooth: section.feed_per_tooth,
            width_of_cut: engagement.immersion,
            engaged: 1.0,
            ..*conditions
        };
        let cut = HelicalCut {
            force: &edge,
            milling: plan.milling,
            engagement_angle: engagement.angle,
            depth_of_cut: plan.depth_of_cut,
            teeth: milling.cutter.teeth,
            lag: plan.helix_lag.max(1e-6 / plan.depth_of_cut),
        };
        let mean = edge.mean(engagement.angle, plan.depth_of_cut, milling.cutter.teeth, plan.milling);
        // The process knows the mean force with all its effects; the helix adds to it over the height.
        let helix = worst(&cut, section.feed_per_tooth) - mean.at(section.feed_per_tooth).normal;
        let deflection = milling.observe(cutter, &input).form_error + helix / stiffness - section.compensation;
        let error = deflection + section.path_error;
        if error.abs() > greatest.abs() {
            greatest = error;
        }
    }
    greatest
}

/// Force of greatest magnitude at which any height of the wall is finished, N.
fn worst(cut: &HelicalCut<'_>, feed_per_tooth: f64) -> f64 {
    let kinks = cut.heights();
    let between = kinks.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let forces = kinks.iter().copied().chain(between).map(|height| cut.finishing_force(feed_per_tooth, height));
    forces.fold(0.0, |worst: f64, force| if force.abs() > worst.abs() { force } else { worst })
}
