//! What the true shop does otherwise than planned.

use super::Shop;
use super::recorder::Recorder;
use rand::RngExt;
use toolroom_kernel::{Entity, Purpose};
use toolroom_scenario::{Deviation, Distribution, MICRO_STOP};

/// Owners of the draws of short stops and of holds, parts of the operation's own name.
const STOPS: u64 = 1 << 40;
const HOLDS: u64 = STOPS + 1;

impl<R: Recorder> Shop<'_, R> {
    /// Size of a deviation that acts on a machine now.
    pub(super) fn deviation(&self, id: &str, machine: usize) -> f64 {
        if self.scenario.deviations.is_empty() {
            return 0.0;
        }
        let (kind, calendars) = (&self.scenario.machines[machine], &self.scenario.calendars);
        let acting = Deviation::acting(&self.scenario.deviations, id, kind, calendars, self.now().seconds());
        acting.map(|own| own.size).sum()
    }

    /// Time that the program of a job's operation takes beyond its passes, s.
    pub(super) fn delay(&self, machine: usize, slot: u32) -> f64 {
        let slower = self.deviation("feed_override", machine);
        let rate = self.deviation("micro_stops", machine);
        if slower == 0.0 && rate == 0.0 {
            return 0.0;
        }
        let job = self.world.jobs.at(slot);
        let programmed = self.layout.operations[job.row.part as usize][job.operation as usize].cutting_time;
        let owner: Entity = job.entity.part(u64::from(job.operation)).part(STOPS);
        let mut stream = self.streams.open(owner, Purpose::Processing);
        let wait = Distribution::Exponential { mean: 1.0 };
        let stop = Distribution::Exponential { mean: MICRO_STOP };
        let (mut at, mut stopped) = (0.0, 0.0);
        loop {
            at += wait.sample(&mut stream);
            if at > rate * programmed {
                break;
            }
            stopped += stop.sample(&mut stream);
        }
        slower * programmed + stopped
    }

    /// Time for which the feed of a job's operation is held, s.
    pub(super) fn hold(&self, machine: usize, slot: u32) -> f64 {
        if self.scenario.deviations.is_empty() {
            return 0.0;
        }
        let job = self.world.jobs.at(slot);
        let owner: Entity = job.entity.part(u64::from(job.operation)).part(HOLDS);
        let mut stream = self.streams.open(owner, Purpose::Processing);
        let (kind, calendars) = (&self.scenario.machines[machine], &self.scenario.calendars);
        let acting = Deviation::acting(&self.scenario.deviations, "feed_hold", kind, calendars, self.now().seconds());
        acting.filter(|own| stream.random::<f64>() < own.share).map(|own| own.size).sum()
    }
}
