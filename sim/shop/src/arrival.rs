//! Jobs enter.

use super::event::Event;
use super::job::Job;
use super::queue::Waiting;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use crate::runlog::{JobOutcome, JobRow};
use rand::RngExt;
use toolroom_kernel::{Entity, Purpose, SimTime};
use toolroom_scenario::ArrivalPattern;

impl<R: Recorder> Shop<'_, R> {
    /// Schedules the first release of every source; constant work enters at once.
    pub(super) fn open_sources(&mut self) -> Result<(), ShopError> {
        for source in 0..self.scenario.arrivals.len() {
            match &self.scenario.arrivals[source].pattern {
                ArrivalPattern::Schedule(rows) => {
                    // Rows may stand in any order; each is an event of its own.
                    for &(time, _) in rows {
                        let at = SimTime::from_seconds(time)?;
                        self.schedule(at, Event::Arrival { source: source as u32 })?;
                    }
                }
                ArrivalPattern::Renewal(_) | ArrivalPattern::Poisson { .. } => self.schedule_next(source)?,
                ArrivalPattern::Batch { .. } | ArrivalPattern::ConstantWork { .. } => {
                    self.schedule(SimTime::ZERO, Event::Arrival { source: source as u32 })?;
                }
            }
        }
        Ok(())
    }

    /// A source releases its jobs and schedules the next release.
    pub(super) fn arrive(&mut self, source: usize) -> Result<(), ShopError> {
        let release = self.world.sources[source].releases;
        self.world.sources[source].releases += 1;
        let count = match &self.scenario.arrivals[source].pattern {
            ArrivalPattern::Schedule(rows) => rows[self.layout.schedules[source][release as usize]].1,
            ArrivalPattern::Renewal(_) | ArrivalPattern::Poisson { .. } => {
                self.schedule_next(source)?;
                1
            }
            &ArrivalPattern::Batch { interval, size } => {
                // From the number of the lot, so that no rounding adds up.
                let next = SimTime::from_seconds((release + 1) as f64 * self.interval(source, interval))?;
                self.schedule(next, Event::Arrival { source: source as u32 })?;
                size
            }
            &ArrivalPattern::ConstantWork { jobs } if release == 0 => jobs,
            ArrivalPattern::ConstantWork { .. } => 1,
        };
        for _ in 0..count {
            self.release(source)?;
        }
        Ok(())
    }

    /// Draws when the next job of a source comes.
    fn schedule_next(&mut self, source: usize) -> Result<(), ShopError> {
        let stream = &mut self.world.sources[source].stream;
        let time = match &self.scenario.arrivals[source].pattern {
            ArrivalPattern::Renewal(time) => time.sample(stream),
            ArrivalPattern::Poisson { rate } if *rate > 0.0 => -(-stream.random::<f64>()).ln_1p() / rate,
            ArrivalPattern::Poisson { .. }
            | ArrivalPattern::Schedule(_)
            | ArrivalPattern::Batch { .. }
            | ArrivalPattern::ConstantWork { .. } => return Ok(()),
        };
        let next = self.now().after(self.interval(source, time))?;
        self.schedule(next, Event::Arrival { source: source as u32 })?;
        Ok(())
    }

    /// One job of a source enters the shop.
    pub(super) fn release(&mut self, source: usize) -> Result<(), ShopError> {
        let now = self.now();
        let part = self.scenario.arrivals[source].part;
        let index = self.world.sources[source].released;
        self.world.sources[source].released += 1;
        let origin = Entity::named("job").part(source as u64);
        let entity = origin.part(index);
        let lot = index / u64::from(self.scenario.parts[part].batch_size.max(1));
        // Nobody counts beyond that.
        let named = u32::try_from(lot + 1).unwrap_or(u32::MAX);
        let number = self.world.jobs.released;
        let row = JobRow {
            part: part as u32,
            lot: named,
            arrival: now.seconds(),
            start: f64::NAN,
            finish: f64::NAN,
            due: now.seconds() + self.scenario.parts[part].flow_allowance,
            outcome: JobOutcome::InProcess,
        };
        let handling = self.layout.random_handling.then(|| self.streams.open(entity, Purpose::Processing));
        let source = source as u32;
        let job = Job { number, entity, source, row, operation: 0, waiting: false, queued: now, origin, lot, handling };
        let slot = self.world.jobs.insert(job);
        for (operation, stream) in &mut self.world.sources[source as usize].ranks {
            *self.world.jobs.rank_mut(slot, *operation) = stream.random();
        }
        self.recorder.job(number, row);
        self.log_event("arrival", None, Some(number), None);
        self.enqueue(slot)
    }

    /// A job joins the queues of its next operation, or leaves where there is none.
    pub(super) fn enqueue(&mut self, slot: u32) -> Result<(), ShopError> {
        let now = self.now();
        let job = self.world.jobs.at_mut(slot);
        let (part, operation) = (job.row.part as usize, job.operation as usize);
        let Some(next) = self.scenario.parts[part].operations.get(operation) else {
            return self.leave(slot, JobOutcome::Good);
        };
        job.waiting = true;
        job.queued = now;
        let waiting = Waiting { since: now, number: job.number, slot, operation: job.operation };
        for &machine in &next.machines {
            self.world.machines[machine].queue.join(waiting);
            self.may_choose(machine);
        }
        Ok(())
    }

    /// A job leaves the shop; constant work lets the next one in.
    pub(super) fn leave(&mut self, slot: u32, outcome: JobOutcome) -> Result<(), ShopError> {
        let Some(mut job) = self.world.jobs.remove(slot) else { return Ok(()) };
        job.row.finish = self.now().seconds();
        job.row.outcome = outcome;
        self.recorder.job(job.number, job.row);
        let event = if outcome == JobOutcome::Good { "finish" } else { "scrap" };
        self.log_event(event, None, Some(job.number), None);
        let source = job.source as usize;
        if matches!(self.scenario.arrivals[source].pattern, ArrivalPattern::ConstantWork { .. }) {
            // By an event: a routing without duration must not recurse.
            self.schedule(self.now(), Event::Arrival { source: source as u32 })?;
        }
        Ok(())
    }
}
