//! Work that is in the shop when the run begins.
//!
//! All of it comes in the first instant, before anything is released: first what has been where it is for longest.
//! An order in a machine is set up and loaded, and needs what its operation has left. Of an order whose jobs move apart,
//! some have passed the operation, and the machine that is kept for the rest works on the next one.

use super::operation_plan::ContentPlan;
use super::readiness::Readiness;
use super::recorder::Recorder;
use super::task::{Content, IN_WORK, Step};
use super::{Shop, ShopError};
use toolroom_scenario::{InProcess, Work};

impl<R: Recorder> Shop<'_, R> {
    /// An order of which several jobs are in the shop is where it is at the start; `passed` of them have passed that operation.
    pub(super) fn set_lot_at_start(&mut self, order: usize, inside: &InProcess, passed: u32) {
        if self.world.lots[order].is_none() {
            return; // it is one job
        }
        let machine = inside.machine.map(|machine| machine as u32);
        self.world.set_lot(order as u32, inside.operation as u32, passed, machine);
        if let Some(machine) = inside.machine.filter(|_| inside.setup_left == 0.0) {
            let group = self.layout.operations[self.scenario.orders[order].part][inside.operation].setup_group;
            self.world.machines[machine].ready = Readiness::Group(group);
            self.show_state(machine);
        }
    }

    /// A job of an order that is in the shop at the start comes to where it is.
    pub(super) fn come_at_start(&mut self, slot: u32, inside: &InProcess) -> Result<(), ShopError> {
        let machine = inside.machine;
        let job = self.world.jobs.at_mut(slot);
        let operations = &self.scenario.parts[job.row.part as usize].operations;
        let begun = job.operation as usize + usize::from(machine.is_some());
        job.supplied = operations[..begun].iter().any(|operation| operation.assembles);
        self.clamp_at_start_of_run(slot, machine.is_some());
        match machine {
            Some(machine) => self.take_at_start(machine, slot, inside),
            None => {
                self.come(slot, None);
                Ok(())
            }
        }
    }

    /// A machine has a job when the run begins.
    fn take_at_start(&mut self, machine: usize, slot: u32, inside: &InProcess) -> Result<(), ShopError> {
        let scoped = self.scoped_operation(machine, slot);
        let job = self.world.jobs.at(slot);
        let (part, index) = (job.row.part as usize, job.operation as usize);
        let (plan, operation) = (self.layout.operations[part][index], &self.scenario.parts[part].operations[index]);
        if self.world.machines[machine].task.is_some() {
            return self.ride_at_start(machine, slot, inside);
        }
        let mut task = self.task_of(machine, slot, Vec::new(), &scoped);
        let mut begins_within = false;
        if inside.setup_left > 0.0 {
            task.left = inside.setup_left;
        } else {
            match (&mut task.content, plan.content) {
                (Content::Plain(whole), _) => {
                    task.step = Step::Work;
                    task.before = inside.done * *whole;
                    task.left = *whole - task.before;
                }
                (Content::Stretches(work), _) => {
                    task.step = Step::Load;
                    task.before = inside.done * work.whole;
                    work.left = work.whole - task.before;
                    if work.piece.is_finite() {
                        work.piece_left = work.piece - task.before % work.piece;
                    }
                }
                (Content::Machining(machining), ContentPlan::Machining { .. }) => {
                    // A ground piece begins anew.
                    let ground = matches!(operation.work, Work::Grinding { .. } | Work::Cycle(_));
                    let done = if ground { 0.0 } else { inside.done };
                    task.step = Step::Load;
                    task.before = done * self.layout.cutting_times[part][index] * machining.moved.pace;
                    let (pass, share_left) = come_to(&self.layout.pass_times[part][index], done);
                    machining.piece.pass = pass;
                    if let Some(tool) = operation.tool_of_pass(pass as usize) {
                        machining.tool = tool as u32;
                    }
                    machining.piece.share_left = share_left;
                    begins_within = pass > 0;
                }
                (Content::Machining(_), ContentPlan::Plain) => unreachable!("plain work has no passes"),
            }
        }
        self.look_ahead(slot);
        let state = &mut self.world.machines[machine];
        state.task = Some(task);
        if inside.setup_left == 0.0 {
            state.ready = Readiness::Group(plan.setup_group);
        }
        if self.scenario.machines[machine].batch.is_some() {
            state.batch.begun += 1;
        }
        if begins_within {
            self.clamp_at_start(machine);
        }
        self.go_on_at_start(machine)
    }

    /// A job is in a machine beside others, which are there already; all are done when the longest work is.
    fn ride_at_start(&mut self, machine: usize, slot: u32, inside: &InProcess) -> Result<(), ShopError> {
        let scoped = self.scoped_operation(machine, slot);
        self.stop_clocks(machine);
        self.halt(machine)?;
        self.release_operator(machine);
        let batches = std::mem::take(&mut self.world.machines[machine].batch.begun);
        let plan = self.task_of(machine, slot, Vec::new(), &scoped);
        let state = &mut self.world.machines[machine];
        state.batch.begun = batches;
        let task = state.task.as_mut().expect(IN_WORK);
        task.riders.push(slot);
        task.load_time += plan.load_time;
        task.unload_time += plan.unload_time;
        if let (Content::Plain(whole), Content::Plain(together)) = (plan.content, &mut task.content) {
            let left = (1.0 - inside.done) * whole;
            *together = together.max(whole);
            if matches!(task.step, Step::Work) && left > task.left {
                (task.left, task.before) = (left, whole - left);
            }
        }
        self.go_on_at_start(machine)
    }

    /// The work in a machine goes on, where the machine works when the run begins.
    fn go_on_at_start(&mut self, machine: usize) -> Result<(), ShopError> {
        self.start_clocks(machine)?;
        if self.world.machines[machine].is_up() {
            self.drive(machine, false)?;
        }
        self.show_state(machine);
        Ok(())
    }
}

/// The pass to which an operation has come when a share of it is done, and what is left of that pass; by its passes as
/// programmed, s.
fn come_to(passes: &[f64], done: f64) -> (u32, f64) {
    let mut behind = done * passes.iter().sum::<f64>();
    for (pass, time) in (0..).zip(passes) {
        if behind < *time {
            return (pass, 1.0 - behind / time);
        }
        behind -= time;
    }
    ((passes.len() - 1) as u32, f64::EPSILON) // all but rounding is done
}

#[cfg(test)]
mod tests {
    use super::come_to;

    #[test]
    fn an_operation_goes_on_within_its_pass() {
        let passes = [60.0, 30.0, 10.0];
        assert_eq!(come_to(&passes, 0.0), (0, 1.0));
        assert_eq!(come_to(&passes, 0.45), (0, 0.25));
        assert_eq!(come_to(&passes, 0.6), (1, 1.0));
        assert_eq!(come_to(&passes, 0.75), (1, 0.5));
        assert_eq!(come_to(&passes, 0.95), (2, 0.5));
    }
}
