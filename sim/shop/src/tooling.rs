//! Edges and wheels: mounted, changed, dressed.

use super::draws;
use super::recorder::Recorder;
use super::task::{IN_WORK, Step};
use super::{Shop, ShopError};
use crate::runlog::{ChangeReason, EdgeRow, LogEvent};
use toolroom_cuts::edge::{Edge, owner};
use toolroom_cuts::ports::write;
use toolroom_kernel::Purpose;
use toolroom_process::Record;
use toolroom_scenario::ProcessModel;
use toolroom_scenario::policies::WheelEstimate;

impl<R: Recorder> Shop<'_, R> {
    /// Puts a new edge of `tool` into a machine.
    pub(super) fn mount(&mut self, machine: usize, tool: usize) {
        let now = self.now();
        let process = self.scenario.tools[tool].process.machine_process();
        let state = &mut self.world.machines[machine];
        let entity = self.layout.tool_owners[machine][tool].part(state.mounted[tool]);
        let first = state.mounted[tool] == 0;
        state.mounted[tool] += 1;
        state.magazine = state.magazine.saturating_sub(1);
        let ground = self.take_edge(machine, tool);
        let life_factor = self.life_factor(tool, ground);
        let mut scatter = draws::edge(&self.scenario.tools[tool].scatter, &self.streams, entity);
        scatter.wear_factor /= life_factor;
        let life = self.scenario.tools[tool].life.as_ref();
        let life = life.map(|life| life.time.sample(&mut self.streams.open(entity.part(owner::LIFE), Purpose::Tool)));
        let mut x = process.initial();
        if scatter.initial_flank_wear > 0.0 {
            write(&mut x, self.layout.tools[tool].ports.flank_wear_state, scatter.initial_flank_wear);
        }
        // The first edge of a tool is in the machine when the run begins.
        let at_start = &self.scenario.machines[machine].edges_at_start;
        let worn = at_start.iter().find(|(worn, _)| first && *worn == tool).map(|(_, wear)| *wear);
        if let Some(wear) = worn {
            write(&mut x, self.layout.tools[tool].ports.flank_wear_state, wear);
        }
        let number = self.world.edges_mounted;
        self.world.edges_mounted += 1;
        let row = EdgeRow {
            ground,
            tool: tool as u32,
            machine: machine as u32,
            installed: now.seconds(),
            removed: f64::NAN,
            reason: ChangeReason::EndOfRun,
            cutting_time: 0.0,
            path: 0.0,
            passes: 0,
            parts: 0,
            flank_wear: 0.0,
            mechanical_wear_factor: scatter.wear_factor * scatter.mechanical_factor,
            thermal_wear_factor: scatter.wear_factor * scatter.thermal_factor,
        };
        self.recorder.edge(number, row);
        let edge = Edge {
            number,
            entity,
            row,
            state: x,
            clock: now,
            scatter,
            noise: 0.0,
            noise_time: 0.0,
            change_reason: None,
            observer: None,
            wheel: WheelEstimate::default(),
            samples: 0,
            worn_at_start: worn.is_some(),
            last_speed: None,
            life_left: life.map_or(f64::INFINITY, |life| life * life_factor),
            given_back: false,
        };
        self.world.machines[machine].edges[tool] = Some(edge);
    }

    /// The machine starts to change a spent edge, or to wait for another one from the crib.
    pub(super) fn begin_change(&mut self, machine: usize) -> Result<(), ShopError> {
        let tool = self.world.machines[machine].task.as_ref().expect(IN_WORK).tool();
        if let Some(crib) = self.layout.crib_of[tool] {
            self.give_back(crib, machine)?;
            if !self.finds_edge(machine, tool)? {
                self.await_edge(crib, machine);
                return Ok(());
            }
        }
        self.change_edge(machine);
        Ok(())
    }

    /// The machine changes its edge for one that is there; an empty magazine is refilled on the way.
    pub(super) fn change_edge(&mut self, machine: usize) {
        let now = self.now().seconds();
        let kind = &self.scenario.machines[machine];
        let tool = self.world.machines[machine].task.as_ref().expect(IN_WORK).tool();
        let fetch = self.layout.crib_of[tool].map_or(0.0, |crib| self.scenario.shared.cribs[crib].fetch);
        let change = self.change_time(machine, kind.tool_change_time) + fetch;
        let job = self.job_in(machine);
        let state = &mut self.world.machines[machine];
        let refill = if state.magazine == 0 { kind.refill_time } else { 0.0 };
        let task = state.task.as_mut().expect(IN_WORK);
        task.step = Step::ToolChange;
        task.left = change + refill;
        let number = state.edges[tool].as_mut().map(|edge| {
            if !edge.given_back {
                edge.row.removed = now;
            }
            edge.number
        });
        self.log_event(LogEvent::ToolChange, Some(machine), job, number);
    }

    /// The change is done.
    pub(super) fn replace_edge(&mut self, machine: usize) {
        let state = &mut self.world.machines[machine];
        let tool = state.task.as_ref().expect(IN_WORK).tool();
        if state.magazine == 0 {
            state.magazine = self.scenario.machines[machine].magazine;
        }
        self.retire(machine, tool);
        self.mount(machine, tool);
    }

    /// The machine starts to dress its wheel.
    pub(super) fn begin_dressing(&mut self, machine: usize) {
        let now = self.now().seconds();
        let job = self.job_in(machine);
        let state = &mut self.world.machines[machine];
        let task = state.task.as_mut().expect(IN_WORK);
        let tool = task.machining().tool as usize;
        task.step = Step::Dressing;
        task.left = self.scenario.tools[tool].dressing_time;
        let number = state.edges[tool].as_mut().map(|edge| {
            edge.row.removed = now;
            edge.number
        });
        self.log_event(LogEvent::Dressing, Some(machine), job, number);
    }

    /// The wheel is sharp again; it counts as a new edge and keeps what it has lost.
    pub(super) fn dress(&mut self, machine: usize) {
        let tool = self.world.machines[machine].task.as_ref().expect(IN_WORK).machining().tool as usize;
        let worn = self.world.machines[machine].edges[tool].as_ref().map(|edge| edge.state.clone());
        self.retire(machine, tool);
        let magazine = self.world.machines[machine].magazine;
        self.mount(machine, tool);
        self.world.machines[machine].magazine = magazine; // the same wheel, none taken out
        if let (ProcessModel::Infeed(infeed), Some(worn), Some(edge)) =
            (&self.scenario.tools[tool].process, worn, &mut self.world.machines[machine].edges[tool])
        {
            infeed.dress(&Record::from_slice(&worn)).write_to(&mut edge.state);
        }
    }

    /// Writes the final row of an edge.
    fn retire(&mut self, machine: usize, tool: usize) {
        if let Some(mut edge) = self.world.machines[machine].edges[tool].take() {
            self.scenario.tools[tool].process.machine_process().retire(&edge.state);
            edge.row.reason = edge.change_reason.unwrap_or(ChangeReason::EndOfRun);
            if let Some(observer) = edge.observer.take() {
                self.world.machines[machine].learnt[tool] = Some(observer);
            }
            self.recorder.edge(edge.number, edge.row);
        }
    }

    /// Writes the rows of all edges that are in the machines at the end of the run.
    pub(super) fn retire_all(&mut self) {
        let now = self.now().seconds();
        for machine in 0..self.world.machines.len() {
            for tool in 0..self.scenario.tools.len() {
                if let Some(edge) = &mut self.world.machines[machine].edges[tool] {
                    if edge.row.removed.is_nan() {
                        edge.row.removed = now;
                        edge.change_reason = None; // known to be worn, still in the machine
                    }
                    self.retire(machine, tool);
                }
            }
        }
    }
}
