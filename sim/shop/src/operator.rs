//! People: a step that needs a skill waits until somebody who has it is free.
//!
//! Nobody is given away while events of an instant are settled. Then steps that wait are served in the
//! order in which the rules of their machines would take their jobs. Of the people who are free and have
//! the skill the one with the fewest skills goes, then the one who has been free for longest, then the
//! first of the file: a setter is not spent on loading.

use super::dispatch::keys_of;
use super::event::Event;
use super::machine::{IN_WORK, Step};
use super::queue::Keys;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use std::cmp::Ordering;
use toolroom_kernel::SimTime;

/// A person in the shop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperatorState {
    /// Whether in shift.
    pub here: bool,
    /// The machine to which the person attends.
    pub machine: Option<u32>,
    /// Since when the person attends to it, or is free.
    pub since: SimTime,
}

/// A step that waits for somebody.
#[derive(Clone, Copy, Debug)]
pub(super) struct Awaiting {
    keys: Keys,
    /// When its job came to the queue, s, and its number: the tie breaks.
    arrival: (f64, u32),
    machine: u32,
    skill: usize,
}

impl Awaiting {
    fn order(&self, other: &Self) -> Ordering {
        let keys = self.keys.iter().zip(&other.keys).map(|(a, b)| a.total_cmp(b));
        let arrival = self.arrival.0.total_cmp(&other.arrival.0).then(self.arrival.1.cmp(&other.arrival.1));
        keys.fold(Ordering::Equal, Ordering::then).then(arrival).then(self.machine.cmp(&other.machine))
    }
}

impl<R: Recorder> Shop<'_, R> {
    /// Puts everybody in or out of shift at time zero.
    pub(super) fn open_operators(&mut self) -> Result<(), ShopError> {
        for (operator, resource) in self.scenario.operators.iter().enumerate() {
            let here = resource.calendar.is_none_or(|calendar| self.scenario.calendars[calendar].works_at(0.0));
            self.world.operators.push(OperatorState { here, machine: None, since: SimTime::ZERO });
            self.schedule_operator(operator)?;
        }
        Ok(())
    }

    fn schedule_operator(&mut self, operator: usize) -> Result<(), ShopError> {
        let calendar = self.scenario.operators[operator].calendar.map(|index| &self.scenario.calendars[index]);
        let Some(boundary) = calendar.and_then(|calendar| calendar.next_boundary(self.now().seconds())) else {
            return Ok(());
        };
        let operator = operator as u32;
        self.schedule(SimTime::from_seconds(boundary.time)?, Event::Operator { operator, comes: boundary.starts })?;
        Ok(())
    }

    /// A person comes to work, or leaves: what the person attends to waits for another one.
    pub(super) fn operator_shift(&mut self, operator: usize, comes: bool) -> Result<(), ShopError> {
        self.schedule_operator(operator)?;
        self.world.operators[operator].here = comes;
        self.person_is_free();
        let Some(machine) = self.world.operators[operator].machine.filter(|_| !comes).map(|index| index as usize)
        else {
            return Ok(());
        };
        if let Some(task) = &self.world.machines[machine].task
            && let Some(end) = task.end
            && task.since.after(task.left)? == self.now()
        {
            self.calendar.cancel(end); // what ends at this instant has ended
            self.step_ended(machine)?;
        }
        if self.world.operators[operator].machine == Some(machine as u32) {
            self.halt(machine)?;
            self.release_operator(machine);
            self.await_operator(machine);
            self.show_state(machine);
        }
        Ok(())
    }

    /// The skill that the step in a machine needs.
    fn needed_skill(&self, machine: usize) -> Option<usize> {
        let task = self.world.machines[machine].task.as_ref()?;
        let job = self.world.jobs.at(task.slot);
        let attendance = self.scenario.parts[job.row.part as usize].operations[job.operation as usize].attendance;
        match task.step {
            Step::Setup => attendance.setup,
            Step::Load | Step::Unload => attendance.load,
            Step::Work
            | Step::Pass(_)
            | Step::ToolChange
            | Step::Reading
            | Step::Delay
            | Step::Hold
            | Step::Dressing => attendance.run,
        }
    }

    /// Whether the step in a machine may go on as far as people are concerned; else it waits from now on.
    /// Whoever is not needed any more is free.
    pub(super) fn is_attended(&mut self, machine: usize) -> bool {
        if self.world.operators.is_empty() {
            return true;
        }
        let needed = self.needed_skill(machine);
        let task = self.world.machines[machine].task.as_ref().expect(IN_WORK);
        if let Some(operator) = task.operator {
            let skills = &self.scenario.operators[operator as usize].skills;
            if needed.is_some_and(|skill| skills.contains(&skill)) {
                return true;
            }
            self.release_operator(machine);
        }
        if needed.is_none() {
            return true;
        }
        let state = &mut self.world.machines[machine];
        let task = state.task.as_mut().expect(IN_WORK);
        if matches!(task.step, Step::Pass(_)) {
            task.left = state.segment.asked; // the pass is planned again when somebody is there
        }
        self.await_operator(machine);
        false
    }

    fn await_operator(&mut self, machine: usize) {
        let Some(skill) = self.needed_skill(machine) else { return };
        let slot = self.world.machines[machine].task.as_ref().expect(IN_WORK).slot;
        let keys = keys_of(self, machine, slot);
        let job = self.world.jobs.at(slot);
        let arrival = (job.queued.seconds(), job.number);
        self.world.awaiting.push(Awaiting { keys, arrival, machine: machine as u32, skill });
        self.world.machines[machine].task.as_mut().expect(IN_WORK).waits = true;
    }

    /// Nobody attends to a machine any more, which waits for nobody either.
    pub(super) fn release_operator(&mut self, machine: usize) {
        if self.world.operators.is_empty() {
            return;
        }
        let now = self.now();
        let Some(task) = &mut self.world.machines[machine].task else { return }; // an idle machine
        if std::mem::take(&mut task.waits) {
            self.world.awaiting.retain(|each| each.machine as usize != machine);
        }
        if let Some(operator) = task.operator.take() {
            let state = &mut self.world.operators[operator as usize];
            state.machine = None;
            state.since = now;
            self.person_is_free();
        }
    }

    /// Gives people who are free to the steps that wait for them.
    pub(super) fn assign_operators(&mut self) -> Result<(), ShopError> {
        if self.world.awaiting.is_empty() {
            return Ok(());
        }
        self.world.awaiting.sort_by(Awaiting::order);
        let mut next = 0;
        while let Some(&Awaiting { machine, skill, .. }) = self.world.awaiting.get(next) {
            let Some(operator) = self.free_operator(skill) else {
                next += 1;
                continue;
            };
            self.world.awaiting.remove(next);
            let (now, machine) = (self.now(), machine as usize);
            let state = &mut self.world.operators[operator];
            state.machine = Some(machine as u32);
            state.since = now;
            let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
            task.operator = Some(operator as u32);
            task.waits = false;
            if matches!(task.step, Step::Pass(_)) {
                self.plan_segment(machine)?;
            }
            self.drive(machine, false)?;
        }
        Ok(())
    }

    /// Who goes to a step that needs a skill.
    pub(super) fn free_operator(&self, skill: usize) -> Option<usize> {
        let people = self.scenario.operators.iter().zip(&self.world.operators).enumerate();
        let able =
            people.filter(|(_, (own, state))| state.here && state.machine.is_none() && own.skills.contains(&skill));
        let best = able.min_by(|(_, (a, free)), (_, (b, other))| {
            a.skills.len().cmp(&b.skills.len()).then(free.since.cmp(&other.since))
        });
        best.map(|(operator, _)| operator)
    }
}
