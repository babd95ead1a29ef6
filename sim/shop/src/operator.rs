//! People: a step that needs a skill waits until somebody who has it is free.
//!
//! Nobody is given away while events of an instant are settled. Then steps that wait are served in the
//! order in which the rules of their machines would take their jobs; what somebody leaves whose shift is over passes on before. Of the people who are free and have
//! the skill the one with the fewest skills goes, then the one who has been free for longest, then the
//! first of the file: a setter is not spent on loading. Who tends machines by a share is free for others as long as their
//! shares add up to no more than one. Where ways take time, the person walks from the last machine first, and the step waits.

use super::event::Event;
use super::recorder::Recorder;
use super::task::{IN_WORK, Step, Task};
use super::{Shop, ShopError};
use crate::runlog::AttendanceRow;
use std::cmp::Ordering;
use toolroom_kernel::{EventKey, SimTime};
use toolroom_queues::Keys;

/// A person in the shop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperatorState {
    /// Whether in shift.
    pub here: bool,
    /// The machine to which the person attends; of several the last.
    pub machine: Option<u32>,
    /// Since when the person attends to it, or is free.
    pub since: SimTime,
    /// Shares of the machines that the person tends, 0 to 1.
    pub load: f64,
    /// Where the person is, by place of the ways.
    pub place: u32,
    /// The end of the way that the person walks.
    pub walking: Option<EventKey>,
}

impl OperatorState {
    /// Whether the person can take on a step that needs this share.
    fn has_time(&self, share: f64) -> bool {
        self.here && self.walking.is_none() && self.load + share <= 1.0 + SHARES
    }
}

/// Shares that add up to this much more than one are one: they are kept in single precision, and ten of 0.1 are one.
const SHARES: f64 = 1e-6;

/// A step that waits for somebody.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepRequest {
    keys: Keys,
    /// When its job came to the queue, s, and its number: the tie breaks.
    arrival: (f64, u32),
    machine: u32,
    skill: usize,
    share: f64,
    /// When the shift of the person was over who attended to it.
    left: Option<SimTime>,
}

impl StepRequest {
    /// What somebody leaves in this instant passes to another before anything else is served.
    fn order(&self, other: &Self, now: SimTime) -> Ordering {
        let passed = (self.left != Some(now)).cmp(&(other.left != Some(now)));
        let keys = self.keys.iter().zip(&other.keys).map(|(a, b)| a.total_cmp(b));
        let arrival = self.arrival.0.total_cmp(&other.arrival.0).then(self.arrival.1.cmp(&other.arrival.1));
        keys.fold(passed, Ordering::then).then(arrival).then(self.machine.cmp(&other.machine))
    }
}

impl<R: Recorder> Shop<'_, R> {
    /// Puts everybody in or out of shift at time zero.
    pub(super) fn open_operators(&mut self) -> Result<(), ShopError> {
        for (operator, resource) in self.scenario.operators.iter().enumerate() {
            let here = resource.calendar.is_none_or(|calendar| self.scenario.calendars[calendar].works_at(0.0));
            let since = SimTime::ZERO;
            self.world.operators.push(OperatorState { here, machine: None, since, load: 0.0, place: 0, walking: None });
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
        if comes || self.world.operators[operator].machine.is_none() {
            return Ok(());
        }
        for machine in 0..self.world.machines.len() {
            if self.attends(operator, machine) {
                self.leave_machine(operator, machine)?;
            }
        }
        Ok(())
    }

    fn attends(&self, operator: usize, machine: usize) -> bool {
        let task = self.world.machines[machine].task.as_ref();
        task.is_some_and(|task| task.operator == Some(operator as u32))
    }

    /// A person whose shift is over leaves a machine, which waits for another one.
    fn leave_machine(&mut self, operator: usize, machine: usize) -> Result<(), ShopError> {
        if let Some((end, _)) = self.end_of_step(machine)?.filter(|(_, time)| *time == self.now()) {
            self.calendar.cancel(end); // what ends at this instant has ended
            self.step_ended(machine)?;
        }
        if self.attends(operator, machine) {
            self.halt(machine)?;
            self.release_operator(machine);
            self.await_operator(machine);
            let now = self.now();
            let awaiting = self.world.awaiting.iter_mut().filter(|own| own.machine as usize == machine);
            awaiting.for_each(|own| own.left = Some(now));
            self.show_state(machine);
        }
        Ok(())
    }

    /// The skill that the step in a machine needs, and the share of a person.
    fn needed(&self, machine: usize) -> Option<(usize, f64)> {
        let task = self.world.machines[machine].task.as_ref()?;
        let job = self.world.jobs.at(task.slot);
        let attendance = self.scenario.parts[job.row.part as usize].operations[job.operation as usize].attendance;
        match task.step {
            Step::Setup => attendance.setup.map(|skill| (skill, 1.0)),
            Step::Load | Step::Unload => attendance.load.map(|skill| (skill, 1.0)),
            Step::NoTool => None,
            Step::Work
            | Step::Pass(_)
            | Step::ToolChange
            | Step::Reading
            | Step::Delay
            | Step::Hold
            | Step::Dressing => {
                let alone = task.tending.as_ref().is_some_and(|tending| tending.left <= 0.0);
                attendance.run.filter(|_| !alone).map(|skill| (skill, attendance.presence.share()))
            }
        }
    }

    /// Whether the step in a machine may go on as far as people are concerned; else it waits from now on.
    /// Whoever is not needed any more is free.
    pub(super) fn is_attended(&mut self, machine: usize) -> bool {
        if self.world.operators.is_empty() {
            return true;
        }
        let needed = self.needed(machine);
        let task = self.world.machines[machine].task.as_ref().expect(IN_WORK);
        if let Some(operator) = task.operator {
            let skills = &self.scenario.operators[operator as usize].skills;
            if let Some((_, share)) = needed.filter(|(skill, _)| skills.contains(skill))
                && self.keeps(operator as usize, machine, share)
            {
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
            task.left = state.segment.requested; // the pass is planned again when somebody is there
        }
        self.await_operator(machine);
        false
    }

    /// Whether a person who attends to a machine has time for the share of its next step, and gets it then.
    fn keeps(&mut self, operator: usize, machine: usize, share: f64) -> bool {
        let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
        let state = &mut self.world.operators[operator];
        let more = share - f64::from(task.presence);
        if more.abs() <= SHARES {
            return true;
        }
        let fits = state.load + more <= 1.0 + SHARES;
        if fits {
            state.load += more;
            self.log_attendance(machine);
            self.world.machines[machine].task.as_mut().expect(IN_WORK).presence = share as f32;
            if more < 0.0 {
                self.person_is_free();
            }
        }
        fits
    }

    /// Writes how long somebody has attended to a machine, who may go on with it.
    pub(super) fn log_attendance(&mut self, machine: usize) {
        let Some(Task { operator: Some(operator), presence: share, slot, .. }) = self.world.machines[machine].task
        else {
            return;
        };
        let (start, end) = (self.world.attended[machine].seconds(), self.now().seconds());
        self.world.attended[machine] = self.now();
        if end > start {
            let job = self.world.jobs.at(slot).number;
            self.recorder.attendance(AttendanceRow { operator, machine: machine as u32, job, start, end, share });
        }
    }

    fn await_operator(&mut self, machine: usize) {
        let Some((skill, share)) = self.needed(machine) else { return };
        let slot = self.world.machines[machine].task.as_ref().expect(IN_WORK).slot;
        let keys = self.keys_of(machine, slot);
        let job = self.world.jobs.at(slot);
        let arrival = (job.queued.seconds(), job.number);
        self.world.awaiting.push(StepRequest { keys, arrival, machine: machine as u32, skill, share, left: None });
        self.world.machines[machine].task.as_mut().expect(IN_WORK).waits = true;
    }

    /// Nobody attends to a machine any more, which waits for nobody either.
    pub(super) fn release_operator(&mut self, machine: usize) {
        if self.world.operators.is_empty() {
            return;
        }
        let now = self.now();
        self.log_attendance(machine);
        let Some(task) = &mut self.world.machines[machine].task else { return }; // an idle machine
        if std::mem::take(&mut task.waits) {
            self.world.awaiting.retain(|each| each.machine as usize != machine);
        }
        if let Some(operator) = task.operator.take() {
            let share = f64::from(std::mem::take(&mut task.presence));
            let state = &mut self.world.operators[operator as usize];
            state.load -= share;
            if state.load <= SHARES {
                (state.load, state.machine) = (0.0, None);
            }
            state.since = now;
            if let Some(walk) = state.walking.take() {
                self.calendar.cancel(walk); // and goes back to where the way began, in no time
            }
            self.person_is_free();
        }
    }

    /// Gives people who are free to the steps that wait for them.
    pub(super) fn assign_operators(&mut self) -> Result<(), ShopError> {
        if self.world.awaiting.is_empty() {
            return Ok(());
        }
        let now = self.now();
        self.world.awaiting.sort_by(|a, b| a.order(b, now));
        let mut next = 0;
        while let Some(&StepRequest { machine, skill, share, .. }) = self.world.awaiting.get(next) {
            let Some(operator) = self.free_operator(skill, share) else {
                next += 1;
                continue;
            };
            self.world.awaiting.remove(next);
            let machine = machine as usize;
            let way = self.way(operator, machine);
            let state = &mut self.world.operators[operator];
            state.machine = Some(machine as u32);
            state.since = now;
            let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
            task.operator = Some(operator as u32);
            self.world.attended[machine] = now;
            task.presence = share as f32;
            state.load += f64::from(task.presence);
            match way {
                Some((_, time)) if time > 0.0 => {
                    let walk = self.schedule(now.after(time)?, Event::Walked { machine: machine as u32 })?;
                    self.world.operators[operator].walking = Some(walk);
                }
                Some(_) | None => self.attend(machine)?,
            }
        }
        Ok(())
    }

    /// Place of a machine on the ways of a person, and the time to it, s.
    fn way(&self, operator: usize, machine: usize) -> Option<(u32, f64)> {
        let ways = self.scenario.operators[operator].walk.as_ref()?;
        let place = ways.location(&self.scenario.machines[machine].location)?;
        Some((place as u32, ways.times[self.world.operators[operator].place as usize][place]))
    }

    /// A person has come to a machine.
    pub(super) fn walked(&mut self, machine: usize) -> Result<(), ShopError> {
        let task = self.world.machines[machine].task.as_ref().expect(IN_WORK);
        let operator = task.operator.expect("who walks to a machine attends to it");
        self.world.operators[operator as usize].walking = None;
        self.attend(machine)
    }

    /// The step for which a person is there goes on.
    fn attend(&mut self, machine: usize) -> Result<(), ShopError> {
        let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
        task.waits = false;
        let (passes, operator) = (matches!(task.step, Step::Pass(_)), task.operator);
        if let Some(operator) = operator
            && let Some((place, _)) = self.way(operator as usize, machine)
        {
            self.world.operators[operator as usize].place = place;
        }
        if passes {
            self.plan_segment(machine)?;
        }
        self.drive(machine, false)
    }

    /// Whoever attends to the first time of a piece only leaves its machine when that is over.
    pub(super) fn tend(&mut self, machine: usize) -> Result<(), ShopError> {
        let Some(Task { step, tending: Some(tending), left, .. }) = &self.world.machines[machine].task else {
            return Ok(()); // nobody leaves before the end
        };
        if !step.is_run() || tending.left <= 0.0 || tending.left >= *left {
            return Ok(());
        }
        let time = self.now().after(tending.left)?;
        let leaves = self.schedule(time, Event::Alone { machine: machine as u32 })?;
        let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
        if let Some(tending) = &mut task.tending {
            tending.leaves = Some(leaves);
        }
        Ok(())
    }

    /// The step of a machine is over, in which somebody may have attended to it.
    pub(super) fn end_tending(&mut self, machine: usize) {
        let task = self.world.machines[machine].task.as_ref().expect(IN_WORK);
        if task.tending.is_some() {
            let elapsed = self.now() - task.since;
            self.note_tending(machine, elapsed);
        }
    }

    /// Who goes to a step that needs a skill.
    pub(super) fn free_operator(&self, skill: usize, share: f64) -> Option<usize> {
        let people = self.scenario.operators.iter().zip(&self.world.operators).enumerate();
        let able = people.filter(|(_, (own, state))| state.has_time(share) && own.skills.contains(&skill));
        let best = able.min_by(|(_, (a, free)), (_, (b, other))| {
            a.skills.len().cmp(&b.skills.len()).then(free.since.cmp(&other.since))
        });
        best.map(|(operator, _)| operator)
    }
}
