//! Part programs: every tool call is a pass of its tool, its spans are the commands of that pass.

use super::pass::{LONG, PassStart, Place};
use super::recorder::Recorder;
use super::task::{IN_WORK, InCut, Machining, in_cut};
use super::{Shop, ShopError};
use crate::runlog::ChangeReason;
use toolroom_cuts::ports::{Ports, read, write};
use toolroom_cuts::program::{Block, Program};
use toolroom_scenario::policies::{Conditions, Observation};
use toolroom_scenario::{CutConditions, ToolCall};

impl<R: Recorder> Shop<'_, R> {
    /// A tool call begins, with its tool change: speeds and feeds are those of the program under every policy.
    pub(super) fn begin_call(
        &mut self,
        machine: usize,
        place: Place,
        first_pass: u32,
        call: &ToolCall,
    ) -> Result<(), ShopError> {
        let controller = self.controllers.of_pass(machine, first_pass + place.pass as u32);
        let tool = &self.scenario.tools[place.tool];
        let tool_plan = &self.layout.tools[place.tool];
        let ports = &tool_plan.ports;
        let state = &mut self.world.machines[machine];
        let InCut { machining: Machining { moved, piece, .. }, edge, .. } =
            in_cut(&mut state.task, &mut state.edges[place.tool]);
        let observation = Observation {
            path: call.path * piece.share_left,
            edge_path: edge.row.path,
            edge_time: edge.row.cutting_time,
            edge_parts: edge.row.parts,
            last_speed: edge.last_speed,
            observer: edge.observer.as_ref(),
            reaction: None,
            true_wear: None,
            true_edge: None,
        };
        let main = longest(call);
        let in_cut_time: f64 = call.spans.iter().filter(|span| span.cut.is_some()).map(|span| span.time).sum();
        let conditions = Conditions::constant(main.map_or(0.0, |cut| cut.cutting_speed));
        if edge.row.passes > 0 && controller.change_due(&observation, &conditions, in_cut_time * piece.share_left) {
            edge.change_reason = Some(ChangeReason::Rule);
            return self.begin_change(machine);
        }
        let mut program = program(call, ports);
        program.skip(call.time * (1.0 - piece.share_left));
        let duration = call.time * piece.share_left;
        let mut input = tool_plan.input.clone();
        edge.draw_noise(&tool.scatter, &self.streams);
        edge.write_scatter(&tool.scatter, &self.pairs[place.tool], piece.blank, ports, &mut input);
        let rate = read(&input, ports.wear_rate_factor, 1.0) * moved.wear_rate;
        write(&mut input, ports.wear_rate_factor, rate);
        if ports.structure {
            let owner = self.layout.tool_owners[machine][place.tool];
            let factors = super::draws::structure(&tool.structure_scatter, &self.streams, owner);
            write(&mut input, ports.natural_frequency_factor, factors.0);
            write(&mut input, ports.modal_damping_factor, factors.1);
        }
        piece.renew_surface();
        write(&mut input, ports.pass_time, duration.min(LONG));
        program.command(0.0, &mut input);
        state.segment.program = program;
        state.segment.start_input = input;
        let (feed, depth_of_cut) = main.map_or((0.0, 0.0), |cut| (cut.feed_per_tooth, cut.depth_of_cut));
        let opened = PassStart { feed, depth_of_cut, speed: conditions.start_speed, ..PassStart::lasting(duration) };
        self.open_pass(machine, place, opened);
        self.plan_segment(machine)
    }

    /// The tool of the pass that comes next is at work; what acts on it is decided anew where it is another one.
    pub(super) fn take_tool(&mut self, machine: usize, place: Place) {
        let operation = &self.scenario.parts[place.part].operations[place.operation];
        let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
        let (slot, machining) = (task.slot, task.machining_mut());
        let Some(tool) = operation.tool_of_pass(machining.piece.pass as usize) else { return };
        if machining.tool as usize != tool {
            machining.tool = tool as u32;
            let acting = self.scoped_operation(machine, slot).acting(self.scenario, tool);
            self.world.machines[machine].task.as_mut().expect(IN_WORK).machining_mut().acting = acting;
        }
    }
}

/// The conditions that hold longest.
fn longest(call: &ToolCall) -> Option<CutConditions> {
    let cuts = call.spans.iter().filter_map(|span| Some((span.time, span.cut?)));
    cuts.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, cut)| cut)
}

/// The spans one after the other. Out of cut the conditions before them stand in the input and do nothing.
fn program(call: &ToolCall, ports: &Ports) -> Program {
    let commands = |values: &[(Option<usize>, f64)]| {
        values.iter().filter_map(|&(element, value)| Some((element?, value))).collect()
    };
    let blocks = call.spans.iter().map(|span| {
        let commands = match span.cut {
            None => commands(&[(ports.engaged, 0.0)]),
            Some(cut) => commands(&[
                (ports.engaged, 1.0),
                (ports.cutting_speed, cut.cutting_speed),
                (ports.feed, cut.feed_per_tooth),
                (ports.depth_of_cut, cut.depth_of_cut),
                (ports.width_of_cut, cut.width_of_cut),
                (ports.down_milling, if cut.down { 1.0 } else { 0.0 }),
            ]),
        };
        Block { duration: span.time, commands }
    });
    Program { blocks: blocks.collect() }
}
