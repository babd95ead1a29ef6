//! Plain work that goes on in stretches: an edge wears in it and is changed when its life is over, or somebody attends to the
//! first time of every piece.

use super::recorder::Recorder;
use super::task::{Content, IN_WORK, Step, Stretches, Task, Tending};
use super::{Shop, ShopError};
use crate::runlog::ChangeReason;
use toolroom_scenario::{Presence, WorkPer};

/// What is left of a time below this is rounding, s (assumption: far above what sums of times of a year lose, far below any time
/// of a shop).
const ROUNDING: f64 = 1e-7;

/// A time without what is rounding.
fn rest(time: f64) -> f64 {
    if time <= ROUNDING { 0.0 } else { time }
}

impl<R: Recorder> Shop<'_, R> {
    /// Plain work of this time, s, in one go or in stretches.
    pub(super) fn plain_content(&self, slot: u32, together: bool, time: f64) -> Content {
        let job = self.world.jobs.at(slot);
        let (part, index) = (job.row.part as usize, job.operation as usize);
        if !self.layout.operations[part][index].stretched {
            return Content::Plain(time);
        }
        let operation = &self.scenario.parts[part].operations[index];
        let apart = matches!(operation.attendance.presence, Presence::First(_))
            && operation.work_per == WorkPer::Part
            && !together;
        let piece = if apart { time / f64::from(job.row.quantity) } else { f64::INFINITY };
        let (tool, aging) = operation.worn_tool.map_or((None, 1.0), |own| (Some(own.tool as u32), own.aging));
        Content::Stretches(Box::new(Stretches { whole: time, left: time, piece, piece_left: piece, tool, aging }))
    }

    /// How long somebody still attends to the piece that a job begins, where that is not all the time.
    pub(super) fn tending_of(&self, slot: u32) -> Option<Box<Tending>> {
        let job = self.world.jobs.at(slot);
        let operation = &self.scenario.parts[job.row.part as usize].operations[job.operation as usize];
        match operation.attendance.presence {
            Presence::First(time) if operation.attendance.run.is_some() => {
                Some(Box::new(Tending { left: time, leaves: None }))
            }
            Presence::Whole | Presence::Share(_) | Presence::First(_) => None,
        }
    }

    /// The work in a machine goes on with its next stretch, with a change of its edge, or is over.
    pub(super) fn stretch(&mut self, machine: usize) -> Result<(), ShopError> {
        let task = self.world.machines[machine].task.as_ref().expect(IN_WORK);
        let Content::Stretches(work) = &task.content else { unreachable!("only work in stretches has them") };
        let (left, tool) = (work.left.min(work.piece_left), work.tool.map(|tool| tool as usize));
        if work.left <= 0.0 {
            self.unload(machine);
            return Ok(());
        }
        let (mut length, aging) = (left, work.aging);
        if let Some(tool) = tool {
            let edge = &self.world.machines[machine].edges[tool];
            let (none, spent) = (edge.is_none(), edge.as_ref().is_some_and(|edge| edge.change_reason.is_some()));
            if spent || none && !self.finds_edge(machine, tool)? {
                return self.begin_change(machine);
            }
            if none {
                self.mount(machine, tool);
            }
            let edge = self.world.machines[machine].edges[tool].as_ref();
            length = length.min(edge.map_or(left, |edge| edge.life_left / aging));
        }
        let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
        (task.step, task.left) = (Step::Work, length);
        Ok(())
    }

    /// Work in stretches has gone on for a time, s: what is left of it, of its piece and of its edge.
    pub(super) fn note_stretch(&mut self, machine: usize, elapsed: f64) {
        let state = &mut self.world.machines[machine];
        let Some(Task { step: Step::Work, content: Content::Stretches(work), .. }) = &mut state.task else { return };
        work.left = rest(work.left - elapsed);
        work.piece_left = rest(work.piece_left - elapsed);
        let Some(edge) = work.tool.and_then(|tool| state.edges[tool as usize].as_mut()) else { return };
        edge.life_left = rest(edge.life_left - elapsed * work.aging);
        edge.row.cutting_time += elapsed;
        edge.row.parts += u32::from(work.left == 0.0);
        if edge.life_left == 0.0 {
            edge.change_reason = Some(ChangeReason::WearLimit);
        }
    }

    /// A stretch is over: the next piece begins, where it was one of a piece.
    pub(super) fn end_stretch(&mut self, machine: usize) -> Result<(), ShopError> {
        let slot = self.world.machines[machine].task.as_ref().expect(IN_WORK).slot;
        let tending = self.tending_of(slot);
        let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
        let Content::Stretches(work) = &mut task.content else { unreachable!("only work in stretches has them") };
        if work.piece_left == 0.0 && work.left > 0.0 {
            work.piece_left = work.piece;
            task.tending = tending;
        }
        self.stretch(machine)
    }

    /// The step in a machine has gone on for a time, s, in which somebody may have attended to it.
    pub(super) fn note_tending(&mut self, machine: usize, elapsed: f64) {
        let Some(task) = &mut self.world.machines[machine].task else { return };
        if !task.step.is_run() {
            return;
        }
        if let Some(tending) = &mut task.tending {
            tending.left = rest(tending.left - elapsed);
            if let Some(leaves) = tending.leaves.take() {
                self.calendar.cancel(leaves);
            }
        }
    }

    /// Whoever attended to the beginning of a piece leaves its machine alone.
    pub(super) fn leave_alone(&mut self, machine: usize) {
        let Some(task) = &mut self.world.machines[machine].task else { return };
        if let Some(tending) = &mut task.tending {
            (tending.left, tending.leaves) = (0.0, None);
        }
        self.release_operator(machine);
    }
}
