//! An operation step by step: setup, load, passes with edge changes, unload, inspection.

use super::layout::ContentPlan;
use super::machine::{Content, IN_WORK, Machining, Piece, Readiness, Step, Task};
use super::recorder::Recorder;
use super::{Shop, ShopError};
use crate::runlog::{ChangeReason, JobOutcome, OperationResult, OperationRow};
use toolroom_scenario::{Distribution, Operation, ShopConstant};

impl Piece {
    /// Why it is no good part, if it is none.
    fn fault(&self, operation: &Operation) -> Option<JobOutcome> {
        let rough = self.surface.roughness > operation.roughness_limit;
        if self.spoiled {
            Some(JobOutcome::ToolFailure)
        } else if rough && self.surface.chattered {
            Some(JobOutcome::Chatter)
        } else if self.burnt {
            Some(JobOutcome::Burnt)
        } else if rough || self.size_error.abs() > operation.size_tolerance {
            Some(JobOutcome::OutOfTolerance)
        } else {
            None
        }
    }
}

impl<R: Recorder> Shop<'_, R> {
    /// A machine takes a job.
    pub(super) fn begin(&mut self, machine: usize, slot: u32) -> Result<(), ShopError> {
        let now = self.now();
        let job = self.world.jobs.at_mut(slot);
        if job.row.start.is_nan() {
            job.row.start = now.seconds();
        }
        let (number, part, index) = (job.number, job.row.part as usize, job.operation as usize);
        let kind = &self.scenario.machines[machine];
        // Drawn here, once: work that is repeated takes the same time, and two draws an
        // operation keep a job's later times the same under every policy.
        let mut draw = |time: &Distribution| match &mut job.handling {
            Some(stream) => time.sample(stream),
            None => time.mean(),
        };
        let (load_time, unload_time) = (draw(&kind.load_time), draw(&kind.unload_time));
        let plan = self.layout.operations[part][index];
        let asked = self.asked(machine, slot);
        let [load_time, unload_time] = asked.handling(self.scenario, [load_time, unload_time]);
        let pieces = f64::from(self.world.jobs.at(slot).row.quantity);
        let content = match plan.content {
            ContentPlan::Plain => Content::Plain(pieces * self.plain_time(&asked, slot, index)),
            ContentPlan::Machining { tool, cutting_time, .. } => {
                let moved = asked.moved(self.scenario, cutting_time);
                Content::Machining(Machining {
                    tool,
                    delay: self.delay(&asked, slot, moved.pace * cutting_time),
                    hold: self.hold(&asked, slot),
                    moved,
                    acting: asked.acting(self.scenario, tool as usize),
                    lost_edges: 0,
                    piece: Piece::default(),
                })
            }
        };
        let state = &mut self.world.machines[machine];
        let setup = self.scenario.parts[part].operations[index].setup_time.unwrap_or(kind.setup_time);
        let needed = self.layout.setup(self.scenario, machine, state.ready, plan.setup_group, setup);
        let change = needed.is_some();
        let setup = asked.calibrated(self.scenario, ShopConstant::SetupTime, needed.unwrap_or(0.0));
        state.task = Some(Task {
            slot,
            begun: now,
            step: Step::Setup,
            left: if change { setup } else { 0.0 },
            since: now,
            end: None,
            operator: None,
            waits: false,
            load_time: pieces * load_time,
            unload_time: pieces * unload_time,
            content,
        });
        if change {
            self.log_event("setup", Some(machine), Some(number), None);
        }
        self.start_clocks(machine)?;
        self.drive(machine, true)
    }

    /// Goes through steps without duration and schedules the end of the first that takes time.
    ///
    /// While machines choose (`dispatching`), even an operation without any duration ends by an
    /// event: its job must not reach a queue before the instant is settled again.
    pub(super) fn drive(&mut self, machine: usize, dispatching: bool) -> Result<(), ShopError> {
        loop {
            let Some(task) = &self.world.machines[machine].task else { return Ok(()) }; // the operation is over
            if task.left > 0.0 && !self.is_attended(machine) {
                self.show_state(machine);
                return Ok(());
            }
            let Some(task) = &self.world.machines[machine].task else { return Ok(()) };
            if task.left > 0.0 || dispatching && matches!(task.step, Step::Unload) {
                let at = self.now().after(task.left)?;
                let end = self.schedule(at, super::Event::StepEnd { machine: machine as u32 })?;
                let now = self.now();
                if let Some(task) = &mut self.world.machines[machine].task {
                    task.end = Some(end);
                    task.since = now;
                }
                self.show_state(machine);
                return Ok(());
            }
            self.end_step(machine)?;
        }
    }

    /// The step of a machine ends by its event.
    pub(super) fn step_ended(&mut self, machine: usize) -> Result<(), ShopError> {
        let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
        task.end = None;
        task.left = 0.0;
        self.end_step(machine)?;
        self.drive(machine, false)
    }

    /// Stops a machine in the middle of a step; what is left of it is kept.
    pub(super) fn halt(&mut self, machine: usize) -> Result<(), ShopError> {
        let now = self.now();
        // An idle machine has nothing to stop, one that stands already neither.
        let Some(task) = &mut self.world.machines[machine].task else { return Ok(()) };
        let Some(end) = task.end.take() else { return Ok(()) };
        let elapsed = now - task.since;
        task.left = (task.left - elapsed).max(0.0);
        self.calendar.cancel(end);
        if !matches!(task.step, Step::Pass(_)) {
            return Ok(());
        }
        let pace = task.machining().moved.pace;
        self.halt_pass(machine, elapsed / pace)
    }

    fn end_step(&mut self, machine: usize) -> Result<(), ShopError> {
        let task = self.world.machines[machine].task.as_ref().expect(IN_WORK);
        let slot = task.slot;
        match task.step {
            Step::Setup => {
                let job = self.world.jobs.at(slot);
                let plan = self.layout.operations[job.row.part as usize][job.operation as usize];
                self.world.machines[machine].ready = Readiness::Group(plan.setup_group);
                self.load(machine);
                Ok(())
            }
            Step::Load => match task.content {
                Content::Plain(time) => {
                    self.work(machine, time);
                    Ok(())
                }
                Content::Machining(_) => self.next_pass(machine),
            },
            Step::Work => {
                self.unload(machine);
                Ok(())
            }
            Step::ToolChange => {
                self.replace_edge(machine);
                self.next_pass(machine)
            }
            Step::Pass(_) => self.end_pass(machine),
            Step::Reading => self.next_pass(machine),
            Step::Delay => {
                self.finish_cutting(machine);
                Ok(())
            }
            Step::Hold => {
                self.log_event("feed_release", Some(machine), self.job_in(machine), None);
                self.finish_cutting(machine);
                Ok(())
            }
            Step::Dressing => {
                self.dress(machine);
                self.unload(machine);
                Ok(())
            }
            Step::Unload => self.end_operation(machine),
        }
    }

    /// Begins loading.
    pub(super) fn load(&mut self, machine: usize) {
        let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
        task.step = Step::Load;
        task.left = task.load_time;
    }

    /// Begins plain work.
    fn work(&mut self, machine: usize, time: f64) {
        let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
        task.step = Step::Work;
        task.left = time;
    }

    /// Begins unloading.
    fn unload(&mut self, machine: usize) {
        let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
        task.step = Step::Unload;
        task.left = task.unload_time;
    }

    /// All passes are cut, or the part is lost: the wheel is dressed if it has to be, the part
    /// is taken off.
    pub(super) fn finish_cutting(&mut self, machine: usize) {
        let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
        let delay = std::mem::take(&mut task.machining_mut().delay);
        if delay > 0.0 {
            task.step = Step::Delay;
            task.left = delay;
            return;
        }
        let hold = std::mem::take(&mut task.machining_mut().hold);
        if hold > 0.0 {
            task.step = Step::Hold;
            task.left = hold;
            self.log_event("feed_hold", Some(machine), self.job_in(machine), None);
            return;
        }
        let tool = task.machining().tool as usize;
        let dull = self.world.machines[machine].edges[tool]
            .as_ref()
            .is_some_and(|edge| edge.spent == Some(ChangeReason::Dressing));
        if dull {
            self.begin_dressing(machine);
        } else {
            self.unload(machine);
        }
    }

    /// Inspection: a good part goes on, a bad one leaves.
    fn end_operation(&mut self, machine: usize) -> Result<(), ShopError> {
        self.stop_clocks(machine);
        self.release_operator(machine);
        let state = &mut self.world.machines[machine];
        let task = state.task.take().expect(IN_WORK);
        if std::mem::take(&mut state.leaving) {
            state.off_shift = true;
        }
        let job = self.world.jobs.at_mut(task.slot);
        let (part, index) = (job.row.part as usize, job.operation as usize);
        let operation = &self.scenario.parts[part].operations[index];
        let bad = match &task.content {
            Content::Plain(_) => None,
            Content::Machining(Machining { piece, .. }) => piece.fault(operation),
        };
        job.operation += 1;
        let result = if bad.is_some() { OperationResult::Bad } else { OperationResult::Good };
        let row = OperationRow {
            job: job.number,
            part: part as u32,
            operation: index as u32,
            quantity: job.row.quantity,
            machine: machine as u32,
            start: task.begun.seconds(),
            end: self.calendar.now().seconds(),
            time_left: 0.0,
            result,
        };
        self.recorder.operation(row);
        if self.world.flow.is_limited() {
            self.free_place(task.slot); // with blocking before service the machine's place counts with the buffer's
        }
        self.passed(task.slot, index as u32);
        self.show_state(machine);
        self.may_choose(machine);
        match bad {
            Some(outcome) => self.leave(task.slot, outcome),
            None => self.enqueue(task.slot, Some(machine)),
        }
    }

    /// Writes the row of the operation that is in a machine at the end of the run.
    pub(super) fn log_in_process(&mut self, machine: usize) {
        let Some(task) = &self.world.machines[machine].task else { return }; // nothing is in work
        let job = self.world.jobs.at(task.slot);
        let row = OperationRow {
            job: job.number,
            part: job.row.part,
            operation: job.operation,
            quantity: job.row.quantity,
            machine: machine as u32,
            start: task.begun.seconds(),
            end: f64::NAN,
            time_left: self.time_left(task, job.row.part as usize, job.operation as usize),
            result: OperationResult::InProcess,
        };
        self.recorder.operation(row);
    }

    /// Time that the operation in a machine still takes, s, its setup included; `None` where there is none.
    pub(super) fn left_in(&self, machine: usize) -> Option<f64> {
        let task = self.world.machines[machine].task.as_ref()?;
        let job = self.world.jobs.at(task.slot);
        let elapsed = if task.end.is_some() { self.now() - task.since } else { 0.0 };
        let setup = if matches!(task.step, Step::Setup) { task.left } else { 0.0 };
        Some(setup + self.time_left(task, job.row.part as usize, job.operation as usize) - elapsed)
    }

    /// Time in cut and in handling that an operation still takes, s. What policies will make of
    /// passes to come is not known: they count as programmed.
    fn time_left(&self, task: &Task, part: usize, operation: usize) -> f64 {
        let Machining { delay, hold, piece, .. } = match &task.content {
            Content::Machining(machining) => machining,
            Content::Plain(time) => {
                return match task.step {
                    Step::Setup => task.load_time + time + task.unload_time,
                    Step::Load => task.left + time + task.unload_time,
                    Step::Work => task.left + task.unload_time,
                    Step::Unload => task.left,
                    Step::ToolChange | Step::Pass(_) | Step::Reading | Step::Delay | Step::Hold | Step::Dressing => {
                        unreachable!("steps of an operation with a tool")
                    }
                };
            }
        };
        let passes = &self.layout.pass_times[part][operation];
        let from = |first: usize| if piece.spoiled { 0.0 } else { passes.iter().skip(first).sum::<f64>() };
        let pass = piece.pass as usize;
        let due =
            || from(pass + 1) + if piece.spoiled { 0.0 } else { passes.get(pass).unwrap_or(&0.0) * piece.share_left };
        let after_cutting = delay + hold + task.unload_time;
        match task.step {
            Step::Setup => task.load_time + due() + after_cutting,
            Step::Load => task.left + due() + after_cutting,
            Step::ToolChange => due() + after_cutting,
            Step::Reading => task.left + due() + after_cutting,
            Step::Pass(_) => task.left + from(pass + 1) + after_cutting,
            Step::Delay | Step::Hold => task.left + after_cutting,
            Step::Dressing | Step::Work => task.unload_time,
            Step::Unload => task.left,
        }
    }
}
