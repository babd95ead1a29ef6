//! Grinding phases: what the controller makes of the force, what the wheel has gone through.

use super::pass::{PassStart, Place};
use super::recorder::Recorder;
use super::task::{InCut, MOUNTED, in_cut};
use super::{Shop, ShopError};
use crate::runlog::ChangeReason;
use toolroom_cuts::edge::owner;
use toolroom_cuts::ports::write;
use toolroom_cuts::program::{Block, Program};
use toolroom_cuts::tool_plan::phase_duration;
use toolroom_infeed::{Input, State};
use toolroom_kernel::Purpose;
use toolroom_process::{Process, Record};
use toolroom_scenario::policies::ForceReading;
use toolroom_scenario::{GrindingPhase, ProcessModel, Work};

impl<R: Recorder> Shop<'_, R> {
    /// The next part comes before the wheel, which has contact with it where the machine believes
    /// it to be.
    pub(super) fn clamp_ground_part(&mut self, machine: usize, place: Place, first_pass: u32) {
        let compensation = match &self.scenario.parts[place.part].operations[place.operation].work {
            Work::Cycle(cycle) => cycle.wear_compensation,
            Work::Plain(_) | Work::Cutting(_) | Work::Grinding { .. } | Work::Contour(_) | Work::Program(_) => 0.0,
        };
        let ProcessModel::Infeed(infeed) = self.process(machine, place.tool) else { return };
        let state = &mut self.world.machines[machine];
        let InCut { machining, edge, .. } = in_cut(&mut state.task, &mut state.edges[place.tool]);
        let mut part = infeed.new_part(&Record::from_slice(&edge.state));
        machining.piece.correction = compensation * part.wheel_wear;
        part.commanded_infeed = machining.piece.correction;
        part.write_to(&mut edge.state);
        if let Some(controller) = self.controllers.grinding(first_pass) {
            controller.begin_part(&mut edge.wheel);
        }
    }

    /// A phase begins. Which infeeds follow each other is found on a copy of wheel and part,
    /// revolution by revolution with the force that the controller sees there; then they are the
    /// program of one pass.
    pub(super) fn begin_phase(&mut self, machine: usize, place: Place, first_pass: u32) -> Result<(), ShopError> {
        let (scenario, streams) = (self.scenario, self.streams);
        let now = self.now().seconds();
        let tool = &scenario.tools[place.tool];
        let plan = &self.layout.tools[place.tool];
        let ports = &plan.ports;
        let operation = self.world.jobs.at(place.slot).entity.part(place.operation as u64);
        let state = &mut self.world.machines[machine];
        let InCut { machining, edge, .. } = in_cut(&mut state.task, &mut state.edges[place.tool]);
        let mut input = plan.input.clone();
        let (programmed, work_rotation_speed) = match &scenario.parts[place.part].operations[place.operation].work {
            Work::Grinding { work_rotation_speed, phases } => (phases[place.pass], *work_rotation_speed),
            Work::Cycle(cycle) => {
                cycle.conditions.write_to(&mut input);
                write(&mut input, ports.engaged, 1.0);
                (cycle.programmed[place.pass], cycle.conditions.work_rotation_speed)
            }
            Work::Plain(_) | Work::Cutting(_) | Work::Contour(_) | Work::Program(_) => {
                unreachable!("phases are those of grinding")
            }
        };
        write(&mut input, ports.work_rotation_speed, work_rotation_speed);
        ports.write_ages(&mut input, now, &scenario.machines[machine]);
        edge.write_scatter(&tool.scatter, &self.pairs[place.tool], machining.piece.blank, ports, &mut input);
        let mut readings = Vec::new();
        let phases = match (&tool.process, self.controllers.grinding(first_pass)) {
            (ProcessModel::Infeed(infeed), Some(controller)) => {
                let mut part = State::from_slice(&edge.state);
                let conditions = Input::from_slice(&input);
                controller.phase(place.pass, &edge.wheel, |infeed_per_rev| {
                    let input = Input { infeed_per_rev, ..conditions };
                    part.commanded_infeed += infeed_per_rev;
                    part = infeed.revolution(&part, &input);
                    let owner = operation.part(owner::NORMAL_FORCE);
                    let mut noise = streams.at(owner, Purpose::Measurement, part.revolutions as u64);
                    let force = controller.measured(infeed.output(&part, &input).normal_force, &mut noise);
                    readings.push(ForceReading { revolution: part.revolutions, infeed_per_rev, force });
                    force
                })
            }
            (ProcessModel::Infeed(_), None)
            | (ProcessModel::Turning(_) | ProcessModel::Milling(_) | ProcessModel::Other(_), _) => vec![programmed],
        };
        let block = |phase: &GrindingPhase| Block {
            duration: phase_duration(phase, work_rotation_speed),
            commands: ports.feed.map(|feed| (feed, phase.infeed_per_rev)).into_iter().collect(),
        };
        let infeed_per_rev = phases.first().map_or(0.0, |phase| phase.infeed_per_rev);
        write(&mut input, ports.feed, infeed_per_rev);
        let program = Program { blocks: phases.iter().map(block).collect() };
        let opened = PassStart { feed: infeed_per_rev, readings, ..PassStart::lasting(program.duration()) };
        state.segment.program = program;
        state.segment.start_input = input;
        self.open_pass(machine, place, opened);
        self.plan_segment(machine)
    }

    /// Wheel and part have moved on: the controller sees the forces of the revolutions that are
    /// over, and the wheel may have come to its dressing limit.
    pub(super) fn ground(&mut self, machine: usize, place: Place, first_pass: u32) {
        let ProcessModel::Infeed(infeed) = self.process(machine, place.tool) else { return };
        let controller = self.controllers.grinding(first_pass);
        let state = &mut self.world.machines[machine];
        let InCut { step, edge, .. } = in_cut(&mut state.task, &mut state.edges[place.tool]);
        let part = State::from_slice(&edge.state);
        if let Some(controller) = controller {
            let readings = &mut step.pass_mut().readings;
            let past = readings.iter().take_while(|reading| reading.revolution <= part.revolutions).count();
            for reading in readings.drain(..past) {
                controller.see(&mut edge.wheel, &reading);
            }
        }
        if controller.is_none_or(|controller| controller.dressing_due(0, &edge.wheel).is_none()) {
            // Read from the state: the event is hidden where the part burns in the same revolution.
            let mut indicators = [0.0; 2];
            infeed.event_indicators(&part, &Input::from_slice(&state.segment.input), &mut indicators);
            if indicators[1] >= 0.0 {
                edge.change_reason = Some(ChangeReason::Dressing);
            }
        }
    }

    /// The part is ground: the dressing rule decides on the wheel.
    pub(super) fn judge_wheel(&mut self, machine: usize, place: Place, first_pass: u32) {
        let Some(controller) = self.controllers.grinding(first_pass) else { return };
        let edge = self.world.machines[machine].edges[place.tool].as_mut().expect(MOUNTED);
        if controller.dressing_due(edge.row.parts, &edge.wheel) == Some(true) {
            edge.change_reason = Some(ChangeReason::Dressing);
        }
    }
}
