//! An operation step by step: setup, load, passes with edge changes, unload, inspection.

use super::deviation::ScopedOperation;
use super::inspection::Verdict;
use super::operation_plan::ContentPlan;
use super::readiness::Readiness;
use super::recorder::Recorder;
use super::task::{Content, IN_WORK, Machining, Step, Task};
use super::{Shop, ShopError};
use crate::runlog::{ChangeReason, JobOutcome, LogEvent, OperationResult, OperationRow};
use toolroom_cuts::workpiece::Piece;
use toolroom_kernel::{EventKey, Purpose, SimTime};
use toolroom_scenario::{ShopConstant, WorkPer};

/// Owner of the setups of a job, part of its own name; operations are counted from it.
const SETUP: u64 = 1 << 46;

impl<R: Recorder> Shop<'_, R> {
    /// The setup that a machine needs for an operation, s; `None` where it needs none.
    #[inline]
    pub(super) fn setup_for(&self, machine: usize, part: usize, index: usize) -> Option<f64> {
        let plan = &self.layout.operations[part][index];
        let usual = plan.setup_time.unwrap_or(self.layout.machine_plans[machine].setup_time);
        self.layout.setup(self.scenario, machine, self.world.machines[machine].ready, plan.setup_group, usual)
    }

    /// The same for the next operation of a job: a machine is set up once for all jobs of an order.
    pub(super) fn setup_of_next(&self, machine: usize, slot: u32) -> Option<f64> {
        let (job, state) = (self.world.jobs.at(slot), &self.world.machines[machine]);
        let setup = self.setup_for(machine, job.row.part as usize, job.operation as usize);
        setup.filter(|_| !(state.set_up && state.is_kept_for(job.origin)))
    }

    /// The setup of a job that is begun, s: drawn where it is random, the same on every machine and under every rule.
    pub(super) fn drawn_setup(&self, machine: usize, slot: u32, usual: f64) -> f64 {
        let job = self.world.jobs.at(slot);
        let operation = &self.scenario.parts[job.row.part as usize].operations[job.operation as usize];
        let Some(spread) =
            operation.setup_spread.as_ref().filter(|_| self.scenario.machines[machine].setup_matrix.is_none())
        else {
            return usual;
        };
        let owner = job.entity.part(SETUP + u64::from(job.operation));
        spread.sample(&mut self.streams.at(owner, Purpose::Processing, u64::from(job.visits)))
    }

    /// A machine takes a job, and in a batch others with it.
    pub(super) fn begin(&mut self, machine: usize, slot: u32, riders: Vec<u32>) -> Result<(), ShopError> {
        if self.layout.machine_plans[machine].one_step && riders.is_empty() && self.begin_one_step(machine, slot)? {
            self.look_ahead(slot);
            return Ok(());
        }
        let scoped = self.scoped_operation(machine, slot);
        let task = self.task_of(machine, slot, riders, &scoped);
        let job = self.world.jobs.at(slot);
        let (number, origin) = (job.number, job.origin);
        let plan = &self.layout.operations[job.row.part as usize][job.operation as usize];
        let state = &mut self.world.machines[machine];
        let setup = plan.setup_time.unwrap_or(self.layout.machine_plans[machine].setup_time);
        // A machine is set up once for all jobs of an order, unless it does something else in between.
        let kept = state.is_kept_for(origin);
        let again = std::mem::replace(&mut state.set_up, kept) && kept;
        let needed = self.layout.setup(self.scenario, machine, state.ready, plan.setup_group, setup).filter(|_| !again);
        let needed = needed.map(|time| self.drawn_setup(machine, slot, time));
        let setup = scoped.calibrated(self.scenario, ShopConstant::SetupTime, needed.unwrap_or(0.0));
        let state = &mut self.world.machines[machine];
        state.task = Some(Task { left: if needed.is_some() { setup } else { 0.0 }, ..task });
        if needed.is_some() {
            self.log_event(LogEvent::Setup, Some(machine), Some(number), None);
        }
        self.look_ahead(slot);
        self.start_clocks(machine)?;
        self.drive(machine, true)
    }

    /// An operation in a machine as it begins, without setup.
    pub(super) fn task_of(&mut self, machine: usize, slot: u32, riders: Vec<u32>, scoped: &ScopedOperation) -> Task {
        let now = self.now();
        let job = self.world.jobs.at(slot);
        let (part, index) = (job.row.part as usize, job.operation as usize);
        let plan = self.layout.operations[part][index];
        let [mut load_time, mut unload_time] = self.handling(machine, slot, scoped);
        for &rider in &riders {
            let handling = self.handling(machine, rider, scoped);
            load_time += handling[0];
            unload_time += handling[1];
        }
        let content = match plan.content {
            ContentPlan::Plain => {
                // All that is worked on together is done when the longest work is.
                let work_of = |slot: u32| self.whole_work(machine, slot, scoped);
                let whole = riders.iter().map(|rider| work_of(*rider)).fold(work_of(slot), f64::max);
                let moved = self.deviating(scoped, slot, whole);
                let time = self.world.jobs.at_mut(slot).rest.take().unwrap_or(moved);
                self.plain_content(slot, !riders.is_empty(), time)
            }
            ContentPlan::Machining { tool, .. } => {
                let cutting_time = self.layout.cutting_times[part][index];
                let moved = scoped.moved(self.scenario, cutting_time);
                Content::Machining(Box::new(Machining {
                    tool,
                    delay: self.delay(scoped, slot, moved.pace * cutting_time),
                    hold: self.hold(scoped, slot),
                    moved,
                    acting: scoped.acting(self.scenario, tool as usize),
                    lost_edges: 0,
                    piece: Piece::default(),
                }))
            }
        };
        Task {
            slot,
            begun: now,
            step: Step::Setup,
            left: 0.0,
            since: now,
            end: None,
            operator: None,
            presence: 0.0,
            waits: false,
            load_time,
            unload_time,
            content,
            before: 0.0,
            riders,
            tending: if self.world.operators.is_empty() { None } else { self.tending_of(slot) },
        }
    }

    /// All of the plain work of a job in a machine, s.
    pub(super) fn whole_work(&self, machine: usize, slot: u32, scoped: &ScopedOperation) -> f64 {
        let (times, drawn) = self.plain_work(machine, slot);
        times * self.plain_time(scoped, drawn)
    }

    /// Times of loading and unloading a job, s.
    fn handling(&mut self, machine: usize, slot: u32, scoped: &ScopedOperation) -> [f64; 2] {
        let (now, kind) = (self.now(), &self.scenario.machines[machine]);
        let job = self.world.jobs.at_mut(slot);
        if job.row.start.is_nan() {
            job.row.start = now.seconds();
        }
        // Drawn here, once: work that is repeated takes the same time, and two draws an
        // operation keep a job's later times the same under every policy.
        let times = match &mut job.handling {
            Some(stream) => [kind.load_time.sample(stream), kind.unload_time.sample(stream)],
            None => self.layout.handling[machine],
        };
        let pieces = f64::from(job.row.quantity);
        scoped.handling(self.scenario, times).map(|time| pieces * time)
    }

    /// Goes through steps without duration and schedules the end of the first that takes time.
    ///
    /// While machines choose (`dispatching`), even an operation without any duration ends by an
    /// event: its job must not reach a queue before the instant is settled again.
    pub(super) fn drive(&mut self, machine: usize, dispatching: bool) -> Result<(), ShopError> {
        loop {
            let Some(task) = &self.world.machines[machine].task else { return Ok(()) }; // the operation is over
            if matches!(task.step, Step::NoTool) {
                self.show_state(machine);
                return Ok(()); // it goes on when an edge comes
            }
            if task.left > 0.0 && !self.is_attended(machine) {
                self.show_state(machine);
                return Ok(());
            }
            let Some(task) = &self.world.machines[machine].task else { return Ok(()) };
            if task.left > 0.0 || dispatching && matches!(task.step, Step::Unload) {
                let pace = if task.step.is_paced() { self.pace_at(machine, self.now()) } else { 1.0 };
                let time = self.now().after(task.left / pace)?;
                let end = self.schedule(time, super::Event::StepEnd { machine: machine as u32 })?;
                let now = self.now();
                if let Some(task) = &mut self.world.machines[machine].task {
                    task.end = Some(end);
                    task.since = now;
                }
                self.tend(machine)?;
                self.show_state(machine);
                return Ok(());
            }
            self.end_step(machine)?;
        }
    }

    /// The step of a machine ends by its event.
    pub(super) fn step_ended(&mut self, machine: usize) -> Result<(), ShopError> {
        if self.layout.machine_plans[machine].is_quick && self.end_quick(machine)? {
            return Ok(());
        }
        let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
        task.end = None;
        task.left = 0.0;
        match task.content {
            Content::Plain(_) => {
                if matches!(task.step, Step::Work) && task.unload_time == 0.0 {
                    return self.end_operation(machine); // there is nothing to take off
                }
            }
            Content::Stretches(_) => {
                let elapsed = self.calendar.now() - task.since;
                self.note_stretch(machine, elapsed);
            }
            Content::Machining(_) => {}
        }
        self.end_tending(machine);
        self.end_step(machine)?;
        self.drive(machine, false)
    }

    /// When the step of a machine ends, if nothing interrupts it; `None` where nothing moves.
    pub(super) fn end_of_step(&self, machine: usize) -> Result<Option<(EventKey, SimTime)>, ShopError> {
        let Some(task) = &self.world.machines[machine].task else { return Ok(None) };
        let Some(end) = task.end else { return Ok(None) };
        Ok(Some((end, task.since.after(task.left / self.step_pace(machine))?)))
    }

    /// Stops a machine in the middle of a step; what is left of it is kept.
    pub(super) fn halt(&mut self, machine: usize) -> Result<(), ShopError> {
        let (now, pace) = (self.now(), self.step_pace(machine));
        // An idle machine has nothing to stop, one that stands already neither.
        let Some(task) = &mut self.world.machines[machine].task else { return Ok(()) };
        let Some(end) = task.end.take() else { return Ok(()) };
        let elapsed = now - task.since;
        task.left = (task.left - elapsed * pace).max(0.0);
        self.calendar.cancel(end);
        if !matches!(task.step, Step::Pass(_)) {
            self.note_stretch(machine, elapsed);
            self.note_tending(machine, elapsed);
            return Ok(());
        }
        self.note_tending(machine, elapsed);
        let task = self.world.machines[machine].task.as_ref().expect(IN_WORK);
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
                let stand_in = job.stand_in;
                self.world.machines[machine].ready = Readiness::Group(plan.setup_group);
                if stand_in {
                    self.end_ahead(machine);
                } else {
                    self.load(machine);
                }
                Ok(())
            }
            Step::Load => match task.content {
                Content::Plain(time) => {
                    self.work(machine, time);
                    Ok(())
                }
                Content::Stretches(_) => self.stretch(machine),
                Content::Machining(_) => self.next_pass(machine),
            },
            Step::Work => match task.content {
                Content::Stretches(_) => self.end_stretch(machine),
                Content::Plain(_) | Content::Machining(_) => {
                    self.unload(machine);
                    Ok(())
                }
            },
            Step::NoTool => unreachable!("it ends when an edge comes, not by itself"),
            Step::ToolChange => {
                let stretched = matches!(task.content, Content::Stretches(_));
                self.replace_edge(machine);
                if stretched { self.stretch(machine) } else { self.next_pass(machine) }
            }
            Step::Pass(_) => self.end_pass(machine),
            Step::Reading => self.next_pass(machine),
            Step::Delay => {
                self.finish_cutting(machine);
                Ok(())
            }
            Step::Hold => {
                self.log_event(LogEvent::FeedRelease, Some(machine), self.job_in(machine), None);
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
    pub(super) fn unload(&mut self, machine: usize) {
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
            self.log_event(LogEvent::FeedHold, Some(machine), self.job_in(machine), None);
            return;
        }
        let tool = task.machining().tool as usize;
        let dull = self.world.machines[machine].edges[tool]
            .as_ref()
            .is_some_and(|edge| edge.change_reason == Some(ChangeReason::Dressing));
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
        self.end_for(machine, &task, task.slot)?;
        task.riders.iter().try_for_each(|rider| self.end_for(machine, &task, *rider))
    }

    /// The operation in a machine is over for one of its jobs.
    fn end_for(&mut self, machine: usize, task: &Task, slot: u32) -> Result<(), ShopError> {
        let job = self.world.jobs.at(slot);
        let (part, index) = (job.row.part as usize, job.operation as usize);
        let bad = match &task.content {
            Content::Plain(_) | Content::Stretches(_) => None,
            Content::Machining(machining) => machining.piece.fault(&self.scenario.parts[part].operations[index]),
        };
        let whole = job.row.quantity;
        if let Some(outcome) = bad {
            let inspection = &self.scenario.parts[part].operations[index].inspection;
            let again =
                outcome != JobOutcome::ToolFailure && inspection.rework_max.is_none_or(|most| job.visits < most);
            let back = inspection.on_reject.filter(|_| again).map(|to| Verdict::Back(to as u32));
            return self.end_as(machine, task, (slot, back.unwrap_or(Verdict::Scrap(outcome))), whole);
        }
        if !self.layout.operations[part][index].inspected {
            return self.end_as(machine, task, (slot, Verdict::Good), whole);
        }
        self.inspect(machine, slot).into_iter().try_for_each(|own| self.end_as(machine, task, own, whole))
    }

    /// A job goes on, goes back or leaves; it was one of `whole` pieces when the operation began.
    fn end_as(
        &mut self,
        machine: usize,
        task: &Task,
        (slot, verdict): (u32, Verdict),
        whole: u32,
    ) -> Result<(), ShopError> {
        let index = self.world.jobs.at(slot).operation;
        let row = OperationRow {
            end: self.calendar.now().seconds(),
            result: verdict.result(),
            ..self.row(machine, task, slot, whole)
        };
        self.world.jobs.at_mut(slot).row.in_process += row.end - row.start;
        match verdict {
            Verdict::Back(to) => self.send_back(slot, to),
            Verdict::Good | Verdict::Scrap(_) => {
                let job = self.world.jobs.at_mut(slot);
                job.operation = job.next_operation(self.layout.operations[job.row.part as usize].len()) as u32;
            }
        }
        self.unclamp(slot, index as usize, true);
        self.log_state(machine); // who counts operations wants to know how long they took
        self.recorder.operation(OperationRow { next: self.world.jobs.at(slot).operation, ..row });
        if self.world.flow.is_limited() {
            self.free_place(slot); // with blocking before service the machine's place counts with the buffer's
        }
        self.passed(slot, index);
        self.took_out(machine);
        self.show_state(machine);
        self.may_choose(machine);
        match verdict {
            Verdict::Scrap(outcome) => self.leave(slot, outcome),
            Verdict::Good | Verdict::Back(_) => self.enqueue(slot, Some(machine)),
        }
    }

    /// The row of an operation in a machine for one of its jobs, not ended yet; the job was one of `whole`
    /// pieces when it began.
    pub(super) fn row(&self, machine: usize, task: &Task, slot: u32, whole: u32) -> OperationRow {
        let job = self.world.jobs.at(slot);
        let pieces = f64::from(job.row.quantity);
        let share = match self.layout.operations[job.row.part as usize][job.operation as usize].work_per {
            WorkPer::Part => pieces,
            WorkPer::Lot | WorkPer::Batch => pieces / f64::from(whole),
        };
        OperationRow {
            job: job.number,
            part: job.row.part,
            operation: job.operation,
            quantity: job.row.quantity,
            machine: machine as u32,
            start: task.begun.seconds(),
            waited: (task.begun - job.queued).max(0.0),
            end: f64::NAN,
            time_left: 0.0,
            time_before: task.before,
            work: share / (1 + task.riders.len()) as f64,
            next: job.operation,
            result: OperationResult::InProcess,
        }
    }

    /// Writes the row of the operation that is in a machine at the end of the run.
    pub(super) fn log_in_process(&mut self, machine: usize) {
        let Some(task) = &self.world.machines[machine].task else { return }; // nothing is in work
        let job = self.world.jobs.at(task.slot);
        if job.stand_in {
            return; // the machine is set up for what is not there yet
        }
        let time_left = self.time_left(task, job.row.part as usize, job.operation as usize);
        let jobs = std::iter::once(&task.slot).chain(&task.riders);
        let rows: Vec<OperationRow> = jobs
            .map(|slot| self.row(machine, task, *slot, self.world.jobs.at(*slot).row.quantity))
            .map(|row| OperationRow { time_left, ..row })
            .collect();
        rows.into_iter().for_each(|row| self.recorder.operation(row));
    }

    /// Time that the operation in a machine still takes, s, its setup included; `None` where there is none.
    pub(super) fn left_in(&self, machine: usize) -> Option<f64> {
        let task = self.world.machines[machine].task.as_ref()?;
        let job = self.world.jobs.at(task.slot);
        let elapsed = if task.end.is_some() { self.now() - task.since } else { 0.0 };
        let setup = if matches!(task.step, Step::Setup) { task.left } else { 0.0 };
        let left = setup + self.time_left(task, job.row.part as usize, job.operation as usize)
            - elapsed * self.step_pace(machine);
        // Passes take their time whatever the shift; their setup and handling are taken for as fast as them.
        let plain = matches!(task.content, Content::Plain(_));
        Some(if plain { left / self.pace_at(machine, self.now()) } else { left })
    }

    /// Time in cut and in handling that an operation still takes, s. What policies will make of
    /// passes to come is not known: they count as programmed.
    fn time_left(&self, task: &Task, part: usize, operation: usize) -> f64 {
        let Machining { delay, hold, piece, .. } = match &task.content {
            Content::Machining(machining) => &**machining,
            Content::Stretches(work) => {
                return match task.step {
                    Step::Setup => task.load_time + work.left + task.unload_time,
                    Step::Load => task.left + work.left + task.unload_time,
                    Step::Work | Step::ToolChange | Step::NoTool => work.left + task.unload_time,
                    Step::Unload => task.left,
                    Step::Pass(_) | Step::Reading | Step::Delay | Step::Hold | Step::Dressing => {
                        unreachable!("steps of an operation that is cut")
                    }
                };
            }
            Content::Plain(time) => {
                return match task.step {
                    Step::Setup => task.load_time + time + task.unload_time,
                    Step::Load => task.left + time + task.unload_time,
                    Step::Work => task.left + task.unload_time,
                    Step::Unload => task.left,
                    Step::NoTool
                    | Step::ToolChange
                    | Step::Pass(_)
                    | Step::Reading
                    | Step::Delay
                    | Step::Hold
                    | Step::Dressing => {
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
            Step::ToolChange | Step::NoTool => due() + after_cutting,
            Step::Reading => task.left + due() + after_cutting,
            Step::Pass(_) => task.left + from(pass + 1) + after_cutting,
            Step::Delay | Step::Hold => task.left + after_cutting,
            Step::Dressing | Step::Work => task.unload_time,
            Step::Unload => task.left,
        }
    }
}
