//! Breakdowns and repairs, and what becomes of the work in the machine.

use super::event::Event;
use super::recorder::Recorder;
use super::task::{Content, Step, Task};
use super::{Shop, ShopError};
use crate::runlog::{JobOutcome, LogEvent, OperationResult, OperationRow};
use toolroom_cuts::workpiece::Piece;
use toolroom_kernel::Purpose;
use toolroom_scenario::{Distribution, FailureClock, Interruption, ShopConstant, ShopEffect};

impl<R: Recorder> Shop<'_, R> {
    /// Draws the first failure of every mode.
    pub(super) fn open_failures(&mut self) -> Result<(), ShopError> {
        (0..self.scenario.failures.len()).try_for_each(|mode| self.wind_up(mode))
    }

    /// A mode begins to run towards its next failure.
    fn wind_up(&mut self, mode: usize) -> Result<(), ShopError> {
        let failure = &self.scenario.failures[mode];
        let regular = self.deviation(ShopEffect::BreakdownShape, failure.machine);
        let between = match failure.time_between {
            Distribution::Exponential { mean } if regular != 0.0 => {
                &Distribution::Weibull { mean, shape: 1.0 + regular }
            }
            Distribution::Constant(_)
            | Distribution::Exponential { .. }
            | Distribution::Erlang { .. }
            | Distribution::Gamma { .. }
            | Distribution::Lognormal { .. }
            | Distribution::Weibull { .. }
            | Distribution::Triangular { .. }
            | Distribution::Beta { .. }
            | Distribution::Normal { .. }
            | Distribution::Uniform { .. }
            | Distribution::DiscreteUniform { .. }
            | Distribution::Empirical(_) => &failure.time_between,
        };
        let time = between.sample(&mut self.failure_stream(mode, Purpose::Failure));
        let time = self.moved(ShopConstant::TimeBetweenFailures, failure.machine, time).max(0.0);
        self.world.modes[mode].left = time;
        match failure.clock {
            FailureClock::Calendar => {
                let due = self.now().after(time)?;
                self.world.modes[mode].due = Some(self.schedule(due, Event::Failure { mode: mode as u32 })?);
                Ok(())
            }
            FailureClock::Busy => self.start_clocks(failure.machine),
        }
    }

    fn failure_stream(&self, mode: usize, purpose: Purpose) -> toolroom_kernel::Stream {
        self.streams.at(self.layout.mode_owners[mode], purpose, self.world.modes[mode].count)
    }

    /// Lets the busy clocks of a machine run, if it works.
    pub(super) fn start_clocks(&mut self, machine: usize) -> Result<(), ShopError> {
        if !self.layout.upkeep_of[machine].is_empty() {
            self.start_upkeep_clocks(machine)?;
        }
        let state = &self.world.machines[machine];
        if self.layout.modes_of[machine].is_empty() || !state.is_up() || state.task.is_none() {
            return Ok(());
        }
        for i in 0..self.layout.modes_of[machine].len() {
            let mode = self.layout.modes_of[machine][i];
            let clock = &self.world.modes[mode as usize];
            if self.scenario.failures[mode as usize].clock != FailureClock::Busy || clock.failed || clock.due.is_some()
            {
                continue;
            }
            let time = self.now().after(clock.left)?;
            let due = self.schedule(time, Event::Failure { mode })?;
            let clock = &mut self.world.modes[mode as usize];
            clock.since = self.calendar.now();
            clock.due = Some(due);
        }
        Ok(())
    }

    /// Stops the busy clocks of a machine.
    pub(super) fn stop_clocks(&mut self, machine: usize) {
        if !self.layout.upkeep_of[machine].is_empty() {
            self.stop_upkeep_clocks(machine);
        }
        let now = self.now();
        for &mode in &self.layout.modes_of[machine] {
            if self.scenario.failures[mode as usize].clock != FailureClock::Busy {
                continue;
            }
            let clock = &mut self.world.modes[mode as usize];
            if let Some(due) = clock.due.take() {
                self.calendar.cancel(due);
                clock.left = (clock.left - (now - clock.since)).max(0.0);
            }
        }
    }

    pub(super) fn fail(&mut self, mode: usize) -> Result<(), ShopError> {
        let failure = &self.scenario.failures[mode];
        let machine = failure.machine;
        self.log_event(LogEvent::Failure, Some(machine), self.job_in(machine), None);
        let clock = &mut self.world.modes[mode];
        clock.failed = true;
        clock.due = None;
        let repair = failure.time_to_repair.sample(&mut self.failure_stream(mode, Purpose::Repair));
        let repair = self.moved(ShopConstant::TimeToRepair, machine, repair).max(0.0);
        self.interrupt(machine, failure.part, JobOutcome::Breakdown)?;
        let state = &mut self.world.machines[machine];
        state.failures += 1;
        if std::mem::take(&mut state.leaving) {
            // Nobody waits after the shift for a repair: the part stays for the next one.
            state.off_shift = true;
        }
        self.show_state(machine);
        self.world.modes[mode].repair = repair;
        self.call_crew(mode)
    }

    pub(super) fn repair(&mut self, mode: usize) -> Result<(), ShopError> {
        let machine = self.scenario.failures[mode].machine;
        self.log_event(LogEvent::Repair, Some(machine), None, None);
        self.release_crew(mode)?;
        let clock = &mut self.world.modes[mode];
        clock.failed = false;
        clock.count += 1;
        self.world.machines[machine].failures -= 1;
        self.wind_up(mode)?; // first: the clock must not run on with the time of the last failure
        self.go_on(machine)
    }

    /// Stops what a machine is doing and settles what becomes of the part, which leaves as
    /// `scrapped` where it is lost.
    pub(super) fn interrupt(
        &mut self,
        machine: usize,
        how: Interruption,
        scrapped: JobOutcome,
    ) -> Result<(), ShopError> {
        if let Some((end, _)) = self.end_of_step(machine)?.filter(|(_, time)| *time == self.now()) {
            self.calendar.cancel(end); // what ends at this instant has ended
            self.step_ended(machine)?;
        }
        self.stop_clocks(machine);
        self.halt(machine)?;
        self.release_operator(machine);
        match how {
            Interruption::Resume | Interruption::Finish => Ok(()),
            Interruption::Repeat => {
                self.restart(machine);
                Ok(())
            }
            Interruption::Scrap => self.scrap_in_machine(machine, scrapped),
        }
    }

    /// A machine that came up again goes on, or takes a job.
    pub(super) fn go_on(&mut self, machine: usize) -> Result<(), ShopError> {
        if !self.world.machines[machine].is_up() {
            self.show_state(machine);
            return Ok(());
        }
        if self.world.machines[machine].task.is_none() {
            self.show_state(machine);
            self.world.flow.suspect = true;
            self.may_choose(machine);
            return Ok(());
        }
        self.challenge(machine);
        self.start_clocks(machine)?;
        let task = self.world.machines[machine].task.as_ref();
        if task.is_some_and(|task| task.end.is_some() || task.waits) {
            return Ok(()); // its operation never stopped: the shift came back before the part was finished
        }
        if task.is_some_and(|task| matches!(task.step, Step::Pass(_))) {
            self.plan_segment(machine)?;
        }
        self.drive(machine, false)
    }

    /// The operation begins anew when the machine goes on; what was cut is lost.
    fn restart(&mut self, machine: usize) {
        self.close_pass(machine);
        self.forget_edge(machine);
        let now = self.now();
        let Some(slot) = self.world.machines[machine].task.as_ref().map(|task| task.slot) else { return };
        let tending = self.tending_of(slot);
        let Some(task) = self.world.machines[machine].task.as_mut() else { return }; // an idle machine
        if matches!(task.step, Step::Setup) {
            return; // no part in the machine yet
        }
        let spell = now - task.begun;
        task.begun = now;
        task.before = 0.0;
        task.tending = tending;
        match &mut task.content {
            Content::Plain(_) => {} // the same time again
            Content::Stretches(work) => (work.left, work.piece_left) = (work.whole, work.piece),
            Content::Machining(machining) => machining.piece = Piece::default(),
        }
        self.world.jobs.at_mut(slot).row.in_process += spell;
        self.load(machine);
    }

    fn scrap_in_machine(&mut self, machine: usize, outcome: JobOutcome) -> Result<(), ShopError> {
        if self.world.machines[machine].task.as_ref().is_some_and(|task| matches!(task.step, Step::Setup)) {
            return Ok(()); // no part in the machine yet
        }
        self.close_pass(machine);
        self.forget_edge(machine);
        let Some(task) = self.world.machines[machine].task.take() else { return Ok(()) }; // an idle machine
        self.lose(machine, &task, task.slot, outcome)?;
        task.riders.iter().try_for_each(|rider| self.lose(machine, &task, *rider, outcome))
    }

    /// A job in a machine is lost.
    pub(super) fn lose(
        &mut self,
        machine: usize,
        task: &Task,
        slot: u32,
        outcome: JobOutcome,
    ) -> Result<(), ShopError> {
        let (end, whole) = (self.now().seconds(), self.world.jobs.at(slot).row.quantity);
        let row = OperationRow { end, result: OperationResult::Lost, ..self.row(machine, task, slot, whole) };
        self.recorder.operation(row);
        self.leave(slot, outcome)?;
        self.took_out(machine);
        Ok(())
    }
}
