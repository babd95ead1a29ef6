//! The pool before the shop: jobs that have come and are not let in yet.
//!
//! A job counts as in the shop from its arrival on, so that its lead time has its time in the pool. The jobs of an order are
//! let in together.

use super::event::Event;
use super::job::Origin;
use super::look::{Look, facts, started_work};
use super::recorder::Recorder;
use super::{Shop, ShopError};
use crate::runlog::LogEvent;
use toolroom_kernel::SimTime;
use toolroom_queues::{Keys, QueueEntry, Ranked};
use toolroom_scenario::{DispatchRule, ReleaseRule};

/// Share of a norm that sums of times may be off by rounding.
const ROUNDING: f64 = 1e-9;

/// Jobs that wait to be let in.
#[derive(Clone, Debug, Default)]
pub struct Pool {
    /// In the order in which they came; those of one order together.
    entries: Vec<Entry>,
    /// Whether it is time to look at them.
    is_due: bool,
    /// Whether the next look is in the calendar.
    is_planned: bool,
}

/// Jobs that are let in together.
#[derive(Clone, Debug)]
struct Entry {
    slots: Vec<u32>,
    since: SimTime,
}

impl<R: Recorder> Shop<'_, R> {
    /// A job that has come is let in, or waits in the pool.
    pub(super) fn let_in(&mut self, slot: u32) -> Result<(), ShopError> {
        let now = self.now();
        let scenario = self.scenario;
        match &scenario.control.release {
            ReleaseRule::Immediate => return self.enqueue(slot, None),
            ReleaseRule::AtDate { lead } => {
                let time = SimTime::from_seconds((self.world.jobs.at(slot).row.due - lead).max(0.0))?;
                if time <= now {
                    return self.enqueue(slot, None);
                }
                self.schedule(time, Event::Pool)?;
            }
            ReleaseRule::Workload { every, .. } => self.plan_look(*every, true)?,
        }
        let origin = self.world.jobs.at(slot).origin;
        let last = self.world.pool.entries.last_mut();
        let same = |entry: &&mut Entry| {
            matches!(origin, Origin::Order(_)) && self.world.jobs.at(entry.slots[0]).origin == origin
        };
        match last.filter(same) {
            Some(entry) => entry.slots.push(slot),
            None => self.world.pool.entries.push(Entry { slots: vec![slot], since: now }),
        }
        Ok(())
    }

    /// Puts the next look at the pool into the calendar: this instant counts where `from_now`.
    fn plan_look(&mut self, every: f64, from_now: bool) -> Result<(), ShopError> {
        if std::mem::replace(&mut self.world.pool.is_planned, true) {
            return Ok(());
        }
        let now = self.now();
        let mut number = (now.seconds() / every).floor();
        // Rounding may hide on which side of now it is.
        while SimTime::from_seconds(number * every)? < now || !from_now && SimTime::from_seconds(number * every)? == now
        {
            number += 1.0;
        }
        self.schedule(SimTime::from_seconds(number * every)?, Event::Pool)?;
        Ok(())
    }

    /// It is time to look at the pool, when all else of the instant is settled.
    pub(super) fn look_at_pool(&mut self) {
        self.world.pool.is_due = true;
        self.world.pool.is_planned = false;
    }

    /// Lets in what may come, where it is time to look.
    pub(super) fn release_from_pool(&mut self) -> Result<(), ShopError> {
        if !std::mem::take(&mut self.world.pool.is_due) {
            return Ok(());
        }
        let (now, scenario) = (self.now(), self.scenario);
        match &scenario.control.release {
            ReleaseRule::Immediate => Ok(()),
            ReleaseRule::AtDate { lead } => {
                let entries = std::mem::take(&mut self.world.pool.entries);
                let is_time = |entry: &Entry| {
                    let due = self.world.jobs.at(entry.slots[0]).row.due;
                    SimTime::from_seconds((due - lead).max(0.0)).is_ok_and(|time| time <= now)
                };
                let (released, kept): (Vec<Entry>, Vec<Entry>) = entries.into_iter().partition(is_time);
                self.world.pool.entries = kept;
                released.into_iter().try_for_each(|entry| self.release_entry(entry))
            }
            ReleaseRule::Workload { norm, every, sequence } => {
                self.release_by_load(*norm, sequence)?;
                if self.world.pool.entries.is_empty() { Ok(()) } else { self.plan_look(*every, false) }
            }
        }
    }

    fn release_entry(&mut self, entry: Entry) -> Result<(), ShopError> {
        for slot in entry.slots {
            self.log_event(LogEvent::Release, None, Some(self.world.jobs.at(slot).number), None);
            self.enqueue(slot, None)?;
        }
        Ok(())
    }

    /// Corrected aggregate load: lets in whose share of the load of every station on its way stays within the norm. A
    /// station without any load takes whatever comes first, or work beyond the norm would wait for ever.
    fn release_by_load(&mut self, norm: f64, sequence: &[DispatchRule]) -> Result<(), ShopError> {
        let mut loads = vec![0.0; self.layout.overlapping.len()];
        let mut outside = vec![false; self.world.jobs.places() as usize];
        let entries = &self.world.pool.entries;
        entries.iter().flat_map(|entry| &entry.slots).for_each(|slot| outside[*slot as usize] = true);
        for slot in (0..self.world.jobs.places()).filter(|slot| !outside[*slot as usize]) {
            if self.world.jobs.get(slot).is_some_and(|job| !job.stand_in) {
                self.add_load(slot, &mut loads);
            }
        }
        let mut entries: Vec<(Ranked, Entry)> = std::mem::take(&mut self.world.pool.entries)
            .into_iter()
            .map(|entry| self.ranked(entry, sequence))
            .collect();
        entries.sort_by_key(|(rank, _)| *rank);
        let mut kept = Vec::new();
        for (_, entry) in entries {
            let mut added = loads.clone();
            entry.slots.iter().for_each(|slot| self.add_load(*slot, &mut added));
            let row = self.world.jobs.at(entry.slots[0]).row;
            let fits = self.layout.operations[row.part as usize]
                .iter()
                .zip(&self.scenario.parts[row.part as usize].operations)
                .all(|(plan, operation)| {
                    let station = plan.station as usize;
                    let most = norm * operation.machines.len() as f64 * (1.0 + ROUNDING);
                    loads[station] <= ROUNDING * norm || added[station] <= most
                });
            if fits {
                loads = added;
                self.release_entry(entry)?;
            } else {
                kept.push(entry);
            }
        }
        kept.sort_by_key(|entry| (entry.since, self.world.jobs.at(entry.slots[0]).number));
        self.world.pool.entries = kept;
        Ok(())
    }

    /// Adds what a job brings to the stations of its operations that are not done: their time over their place in the routing.
    fn add_load(&self, slot: u32, loads: &mut [f64]) {
        let job = self.world.jobs.at(slot);
        let part = job.row.part as usize;
        let plans = &self.layout.operations[part];
        for (place, operation) in job.places_left(plans.len()) {
            let time = self.layout.time(&self.world.jobs, slot, part, operation);
            loads[plans[operation].station as usize] += time / (place + 1) as f64;
        }
    }

    fn ranked(&self, entry: Entry, sequence: &[DispatchRule]) -> (Ranked, Entry) {
        let slot = entry.slots[0];
        let job = self.world.jobs.at(slot);
        let machine = self.scenario.parts[job.row.part as usize].operations[job.operation as usize].machines[0];
        let facts = facts(self.scenario, &self.layout, &self.streams, (&self.world.jobs, slot), (machine, sequence));
        let waiting = QueueEntry { since: entry.since, number: job.number, slot, operation: job.operation };
        let now = self.now().seconds();
        let look = Look {
            scenario: self.scenario,
            layout: &self.layout,
            jobs: &self.world.jobs,
            waiting_work: &self.world.waiting_work,
            started: started_work(self.scenario, &self.layout, (&self.world.jobs, &self.world.machines), now),
            chooser: None,
            rules: sequence,
            now,
        };
        let keys: Keys = look.keys(&waiting, &facts, look.measures(&facts));
        (Ranked { keys, waiting }, entry)
    }
}
