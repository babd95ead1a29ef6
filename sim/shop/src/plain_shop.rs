//! A shop that is nothing but plain machines with queues before them, from time zero to its horizon.
//!
//! Most of what a shop may have is asked for again and again while nothing of it is there, and its jobs and machines have
//! places for all of it. Here are the few steps that are left, on jobs and machines that are small. The events are the same
//! at the same times in the same order, and who writes them down is told the same: a test holds the log against that of
//! a [`Shop`](super::Shop).

use super::arrival::{drawn_job, due_by, next_interval};
use super::error::ShopError;
use super::event::Event;
use super::layout::{Layout, time_of};
use super::plain_jobs::{PlainJob, PlainJobs};
use super::plain_plan::{PlainOperation, operations};
use super::plain_queue::{Waiting, WaitingWork};
use super::queue_change::QueueChange;
use super::readiness::Readiness;
use super::recorder::{Closing, Recorder};
use super::world::SourceState;
use crate::runlog::{EventRow, JobOutcome, JobRow, LogEvent, MachineState, OperationResult, OperationRow, StateRow};
use std::sync::Arc;
use toolroom_kernel::{Agenda, Calendar, Class, Digest, SimTime, Streams};
use toolroom_scenario::{ArrivalPattern, Distribution, MachineType, Scenario};

/// Numbers of events in the agenda from here on are arrivals, those below ends of steps.
const ARRIVALS: u32 = Agenda::END / 2;

/// A shop under way.
#[derive(Clone, Debug)]
pub(super) struct PlainShop<'a, R> {
    scenario: &'a Scenario,
    layout: Arc<Layout>,
    streams: Streams,
    agenda: Agenda,
    digest: Digest,
    events: u64,
    operations: Vec<PlainOperation>,
    /// First operation of every part.
    firsts: Vec<u32>,
    machines: Vec<PlainMachine<'a>>,
    sources: Vec<PlainSource<'a>>,
    jobs: PlainJobs,
    /// Machines that may choose a job now.
    candidates: Vec<u32>,
    /// Work that waits at every station, where a rule looks at it.
    waiting_work: WaitingWork,
    recorder: R,
    /// Instant of the last event, and events in it so far.
    instant: (SimTime, u64),
}

/// A machine with its queue.
#[derive(Clone, Debug)]
struct PlainMachine<'a> {
    waiting: Waiting<'a>,
    step: PlainStep,
    /// Since when.
    since: SimTime,
    /// Where its job is kept.
    slot: usize,
    /// When its operation began.
    begun: SimTime,
    /// Time of the work of its job, s.
    work: f64,
    ready: Readiness,
    /// Whether it is on the list of machines that may choose a job.
    listed: bool,
}

/// What a machine is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PlainStep {
    Idle,
    Setup,
    Work,
}

impl PlainStep {
    fn state(self) -> MachineState {
        match self {
            Self::Idle => MachineState::Idle,
            Self::Setup => MachineState::Setup,
            Self::Work => MachineState::Working,
        }
    }
}

/// A source with what every arrival asks of it.
#[derive(Clone, Debug)]
struct PlainSource<'a> {
    pattern: &'a ArrivalPattern,
    state: SourceState,
    /// Part and pieces of its jobs, where they are always the same.
    always: Option<(usize, u32)>,
}

impl<'a, R: Recorder> PlainShop<'a, R> {
    /// A shop at time zero with its sources and what they have in the agenda.
    pub fn new(
        scenario: &'a Scenario,
        layout: Arc<Layout>,
        streams: Streams,
        (sources, agenda): (Vec<SourceState>, Agenda),
        recorder: R,
    ) -> Self {
        let source = |(index, state): (usize, SourceState)| {
            let arrival = &scenario.arrivals[index];
            let always = match (&arrival.parts[..], &arrival.quantity) {
                ([_], Distribution::Constant(_)) => Some(drawn_job(scenario, &streams, index, layout.sources[index])),
                _ => None,
            };
            PlainSource { pattern: &arrival.pattern, state, always }
        };
        let machine = |(index, kind): (usize, &MachineType)| PlainMachine {
            waiting: Waiting::at(scenario, index),
            step: PlainStep::Idle,
            since: SimTime::ZERO,
            slot: 0,
            begun: SimTime::ZERO,
            work: 0.0,
            ready: layout.readiness(kind.setup_at_start.as_deref()),
            listed: false,
        };
        let (operations, firsts) = operations(scenario, &layout);
        Self {
            machines: scenario.machines.iter().enumerate().map(machine).collect(),
            sources: sources.into_iter().enumerate().map(source).collect(),
            jobs: PlainJobs::with_operations(layout.plain_operations),
            scenario,
            streams,
            agenda,
            digest: Digest::new(),
            events: 0,
            operations,
            firsts,
            candidates: Vec::new(),
            waiting_work: WaitingWork::of(&layout),
            recorder,
            instant: (SimTime::ZERO, 0),
            layout,
        }
    }

    /// Handles every event up to and at `time`.
    pub fn run_until(&mut self, time: SimTime) -> Result<(), ShopError> {
        while let Some(now) = self.agenda.peek_time().filter(|next| *next <= time) {
            while let Some(event) = self.agenda.pop_before(now, Class::Observe) {
                self.events += 1;
                let (instant, count) = self.instant;
                self.instant = (now, if now == instant { count + 1 } else { 0 });
                if self.instant.1 > super::STUCK_EVENTS {
                    return Err(ShopError::NoProgress { time: now.seconds(), events: self.instant.1 });
                }
                if event < ARRIVALS {
                    self.digest.record(now, &[Event::StepEnd { machine: event }.word()]);
                    self.end_step(event as usize, now)?;
                } else {
                    let source = event - ARRIVALS;
                    self.digest.record(now, &[Event::Arrival { source }.word()]);
                    self.arrive(source as usize, now)?;
                }
            }
            self.dispatch(now)?;
        }
        Ok(())
    }

    /// Writes what is in process at `horizon` and hands out what was recorded.
    pub fn close(mut self, horizon: SimTime) -> R {
        for index in 0..self.machines.len() {
            let machine = &self.machines[index];
            let left = match machine.step {
                PlainStep::Idle => None,
                PlainStep::Setup => Some(machine.work),
                PlainStep::Work => Some((machine.work - (horizon - machine.since)).max(0.0)),
            };
            self.log_state(index, horizon);
            if let Some(time_left) = left {
                self.recorder.operation(OperationRow { time_left, ..self.row(index) });
            }
        }
        self.hand_out(horizon)
    }

    /// Hands out what was recorded up to a time.
    pub fn hand_out(mut self, time: SimTime) -> R {
        for index in 0..self.machines.len() {
            self.log_state(index, time);
        }
        for job in self.jobs.iter() {
            self.recorder.job(job.number, job.row());
        }
        self.recorder.close(Closing {
            horizon: time.seconds(),
            warm_up: self.scenario.warm_up,
            digest: self.digest.value(),
            calendar_events: self.events,
        });
        self.recorder
    }

    /// Time of the last event.
    pub fn now(&self) -> SimTime {
        self.agenda.now()
    }

    /// A source releases its jobs and schedules the next release.
    fn arrive(&mut self, source: usize, now: SimTime) -> Result<(), ShopError> {
        let own = &mut self.sources[source];
        let release = own.state.releases;
        own.state.releases += 1;
        let (count, next) = match own.pattern {
            ArrivalPattern::Schedule(rows) => (rows[self.layout.schedules[source][release as usize]].1, None),
            ArrivalPattern::Renewal(_) | ArrivalPattern::Poisson { .. } => {
                let time = next_interval(own.pattern, &mut own.state.stream);
                (1, time.map(|time| now.after(time)).transpose()?)
            }
            &ArrivalPattern::Batch { interval, size } => {
                (size, Some(SimTime::from_seconds((release + 1) as f64 * interval)?))
            }
            &ArrivalPattern::ConstantWork { jobs } if release == 0 => (jobs, None),
            ArrivalPattern::ConstantWork { .. } => (1, None),
        };
        if let Some(next) = next {
            self.agenda.schedule(next, Class::Arrive, ARRIVALS + source as u32)?;
        }
        (0..count).try_for_each(|_| self.release(source, now))
    }

    /// One job of a source enters the shop.
    fn release(&mut self, source: usize, now: SimTime) -> Result<(), ShopError> {
        let scenario = self.scenario;
        let own = &mut self.sources[source];
        let index = own.state.released;
        own.state.released += 1;
        let entity = || self.layout.sources[source].part(index);
        let (part, quantity) = own.always.unwrap_or_else(|| drawn_job(scenario, &self.streams, source, entity()));
        let batch = u64::from(scenario.parts[part].batch_size.max(1));
        let lot = if batch == 1 { index } else { index / batch };
        let number = self.jobs.released;
        let due = now.seconds() + scenario.parts[part].flow_allowance;
        let mut job = PlainJob {
            arrival: now.seconds(),
            start: f64::NAN,
            due,
            queued: now.seconds(),
            in_process: 0.0,
            number,
            part: part as u32,
            quantity,
            // Nobody counts beyond that.
            lot: u32::try_from(lot + 1).unwrap_or(u32::MAX),
            source: source as u32,
            operation: 0,
        };
        let slot = self.jobs.insert(job);
        let drawn = self.jobs.drawn_of(slot);
        if let Some(ranks) = own.state.ranks.iter_mut().find(|ranks| ranks.part == part) {
            ranks.next(&scenario.parts[part].operations, drawn);
        }
        let plans = &self.layout.operations[part];
        let time = |(plan, drawn): (_, &f64)| time_of(plan, f64::from(quantity), *drawn);
        let work = || plans.iter().zip(drawn.iter()).map(time).sum::<f64>();
        if let Some(due) = due_by(&scenario.arrivals[source].due, job.arrival, work, (&self.streams, entity)) {
            job.due = due;
            self.jobs.all[slot].due = due;
        }
        self.recorder.arrival(number, job.row());
        self.log_event(LogEvent::Arrival, None, number, now);
        if self.is_done(&job) {
            return self.leave(slot, now);
        }
        self.join(slot, now);
        Ok(())
    }

    /// The operation that a job waits for or is in, among all.
    #[inline]
    fn place(&self, job: &PlainJob) -> usize {
        self.firsts[job.part as usize] as usize + job.operation as usize
    }

    /// Whether no operation is left.
    #[inline]
    fn is_done(&self, job: &PlainJob) -> bool {
        self.place(job) == self.firsts[job.part as usize + 1] as usize
    }

    /// A job waits for its operation.
    #[inline]
    fn join(&mut self, slot: usize, now: SimTime) {
        let place = self.place(&self.jobs.all[slot]);
        self.jobs.all[slot].queued = now.seconds();
        let index = self.operations[place].machine;
        self.waiting_work.weigh(&self.layout, &self.jobs, slot, QueueChange::Comes);
        let machine = &mut self.machines[index as usize];
        machine.waiting.join(&self.layout, &self.jobs, slot, now);
        if machine.step == PlainStep::Idle && !machine.listed {
            machine.listed = true;
            self.candidates.push(index);
        }
    }

    /// Idle machines take the first of their queues, in the order of the scenario.
    fn dispatch(&mut self, now: SimTime) -> Result<(), ShopError> {
        if self.candidates.len() > 1 {
            self.candidates.sort_unstable();
        }
        for place in 0..self.candidates.len() {
            let index = self.candidates[place] as usize;
            let machine = &mut self.machines[index];
            machine.listed = false;
            if let Some(slot) = machine.waiting.take(&self.layout, &self.jobs, &self.waiting_work, now) {
                self.waiting_work.weigh(&self.layout, &self.jobs, slot, QueueChange::Leaves);
                self.begin(index, slot, now)?;
            }
        }
        self.candidates.clear();
        Ok(())
    }

    /// A machine takes a job.
    fn begin(&mut self, index: usize, slot: usize, now: SimTime) -> Result<(), ShopError> {
        let operation = &self.operations[self.place(&self.jobs.all[slot])];
        let job = &mut self.jobs.all[slot];
        if job.start.is_nan() {
            job.start = now.seconds();
        }
        let (number, quantity, of_part) = (job.number, job.quantity, job.operation as usize);
        let work = operation.time(quantity, self.jobs.drawn_at(slot)[of_part]);
        let group = operation.setup_group;
        let ready = self.machines[index].ready;
        let setup = self.layout.setup(self.scenario, index, ready, group, operation.setup_time);
        self.log_state(index, now);
        if setup.is_some() {
            self.log_event(LogEvent::Setup, Some(index), number, now);
        }
        let machine = &mut self.machines[index];
        (machine.slot, machine.begun, machine.work) = (slot, now, work);
        let taken = match setup {
            Some(time) if time > 0.0 => {
                machine.step = PlainStep::Setup;
                time
            }
            Some(_) | None => {
                machine.step = PlainStep::Work;
                machine.ready = Readiness::Group(group);
                work
            }
        };
        Ok(self.agenda.schedule(now.after(taken)?, Class::Finish, index as u32)?)
    }

    /// The step of a machine ends.
    fn end_step(&mut self, index: usize, now: SimTime) -> Result<(), ShopError> {
        self.log_state(index, now);
        let slot = self.machines[index].slot;
        let place = self.place(&self.jobs.all[slot]);
        let machine = &mut self.machines[index];
        if machine.step == PlainStep::Setup {
            machine.ready = Readiness::Group(self.operations[place].setup_group);
            if machine.work > 0.0 {
                machine.step = PlainStep::Work;
                return Ok(self.agenda.schedule(now.after(machine.work)?, Class::Finish, index as u32)?);
            }
        }
        machine.step = PlainStep::Idle;
        if !machine.waiting.is_empty() && !machine.listed {
            machine.listed = true;
            self.candidates.push(index as u32);
        }
        let row = self.row(index);
        let next = row.operation + 1;
        self.recorder.operation(OperationRow { end: now.seconds(), result: OperationResult::Good, next, ..row });
        let job = &mut self.jobs.all[slot];
        job.operation = next;
        job.in_process += now.seconds() - row.start;
        if self.is_done(&self.jobs.all[slot]) {
            return self.leave(slot, now);
        }
        self.join(slot, now);
        Ok(())
    }

    /// A job leaves the shop; constant work lets the next one in.
    fn leave(&mut self, slot: usize, now: SimTime) -> Result<(), ShopError> {
        let job = &self.jobs.all[slot];
        let (number, source) = (job.number, job.source);
        let row = JobRow { finish: now.seconds(), outcome: JobOutcome::Good, ..job.row() };
        self.jobs.remove(slot);
        self.recorder.job(number, row);
        self.log_event(LogEvent::Finish, None, number, now);
        if matches!(self.sources[source as usize].pattern, ArrivalPattern::ConstantWork { .. }) {
            self.agenda.schedule(now, Class::Arrive, ARRIVALS + source)?;
        }
        Ok(())
    }

    /// The row of the operation in a machine, not ended yet.
    #[inline]
    fn row(&self, index: usize) -> OperationRow {
        let machine = &self.machines[index];
        let job = &self.jobs.all[machine.slot];
        let per_piece = self.operations[self.place(job)].per_piece;
        OperationRow {
            job: job.number,
            part: job.part,
            operation: job.operation,
            quantity: job.quantity,
            machine: index as u32,
            start: machine.begun.seconds(),
            waited: (machine.begun.seconds() - job.queued).max(0.0),
            end: f64::NAN,
            time_left: 0.0,
            time_before: 0.0,
            work: if per_piece { f64::from(job.quantity) } else { 1.0 },
            next: job.operation,
            result: OperationResult::InProcess,
        }
    }

    /// Writes the stay of a machine in what it does up to now.
    #[inline]
    fn log_state(&mut self, index: usize, now: SimTime) {
        let machine = &mut self.machines[index];
        if now > machine.since {
            let job = (machine.step != PlainStep::Idle).then(|| self.jobs.all[machine.slot].number);
            self.recorder.state(StateRow {
                machine: index as u32,
                state: machine.step.state(),
                start: machine.since.seconds(),
                end: now.seconds(),
                in_shift: true,
                job,
            });
            machine.since = now;
        }
    }

    #[inline]
    fn log_event(&mut self, event: LogEvent, machine: Option<usize>, job: u32, now: SimTime) {
        let machine = machine.map(|index| index as u32);
        self.recorder.event(EventRow { time: now.seconds(), event, machine, job: Some(job), edge: None });
    }
}

/// What the calendar of a [`Shop`](super::Shop) of plain machines holds at time zero.
pub(super) fn agenda_of(mut calendar: Calendar<Event>) -> Result<Agenda, ShopError> {
    let mut agenda = Agenda::default();
    while let Some((time, event)) = calendar.pop() {
        if let Some(number) = numbered(event) {
            agenda.schedule(time, event.class(), number)?;
        }
    }
    Ok(agenda)
}

/// The number of an event in the agenda; a shop of plain machines has no others.
fn numbered(event: Event) -> Option<u32> {
    match event {
        Event::StepEnd { machine } => Some(machine),
        Event::Arrival { source } => Some(ARRIVALS + source),
        Event::Failure { .. }
        | Event::Repair { .. }
        | Event::Release { .. }
        | Event::BatchDue { .. }
        | Event::Pool
        | Event::Delivery { .. }
        | Event::PickUp { .. }
        | Event::Moved { .. }
        | Event::Restock { .. }
        | Event::MakeUp { .. }
        | Event::Pace { .. }
        | Event::Edges { .. }
        | Event::Regrind { .. }
        | Event::Maintenance { .. }
        | Event::Window { .. }
        | Event::Maintained { .. }
        | Event::Alone { .. }
        | Event::Walked { .. }
        | Event::Planned { .. }
        | Event::Crew { .. }
        | Event::Operator { .. }
        | Event::ShiftStart { .. }
        | Event::ShiftEnd { .. } => None,
    }
}
