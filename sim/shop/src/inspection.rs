//! What becomes of jobs when an operation is done: they go on, go back, or are scrapped.
//!
//! A job of several pieces that are judged one by one is divided: those that go on stay together, those
//! that go back to one operation follow as a job of their own, and so do those that are scrapped. What is
//! drawn for them belongs to the name of the job, the operation and the number of the visit.

use super::Shop;
use super::flow::Place;
use super::job::{Job, Origin};
use super::recorder::Recorder;
use crate::runlog::{JobOutcome, LogEvent, OperationResult};
use rand::RngExt;
use toolroom_kernel::Purpose;
use toolroom_scenario::{InspectedTo, InspectedUnit, InspectionOutcome, ShopConstant, Work};

/// Owner of the jobs that were divided from another, part of that one's name.
const DIVIDED: u64 = 1 << 42;

/// What becomes of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// It goes on.
    Good,
    /// It goes back to an operation.
    Back(u32),
    /// It is lost.
    Scrap(JobOutcome),
}

impl Verdict {
    /// What the log says of the operation.
    pub fn result(self) -> OperationResult {
        match self {
            Self::Good => OperationResult::Good,
            Self::Back(_) => OperationResult::Rework,
            Self::Scrap(_) => OperationResult::Bad,
        }
    }
}

impl<R: Recorder> Shop<'_, R> {
    /// Jobs into which one divides when its operation on a machine is done, each with what becomes of it.
    pub(super) fn inspect(&mut self, machine: usize, slot: u32) -> Vec<(u32, Verdict)> {
        let scenario = self.scenario;
        let job = self.world.jobs.at(slot);
        let (part, index) = (job.row.part as usize, job.operation);
        let inspection = &scenario.parts[part].operations[index as usize].inspection;
        let moved = self.moved_shares(machine, slot, &inspection.outcomes);
        let (quantity, visits, first) = (job.row.quantity, job.visits, job.first_piece);
        let owner = job.entity.part(u64::from(index));
        let mut stream = self.streams.at(owner, Purpose::Quality, u64::from(visits));
        let apart = inspection.per == InspectedUnit::Part && quantity > 1 && !self.world.flow.is_limited();
        let mut counts = vec![0u32; inspection.outcomes.len() + 1];
        for piece in 0..if apart { quantity } else { 1 } {
            let judged = inspection.sample.is_none_or(|sample| {
                if apart { sample.has(first + u64::from(piece)) } else { sample.among(first, quantity) > 0 }
            });
            if !judged {
                counts[0] += if apart { 1 } else { quantity };
                continue;
            }
            let rank: f64 = stream.random();
            let mut below = 0.0;
            let found = inspection.outcomes.iter().enumerate().position(|(place, outcome)| {
                below += moved.get(place).copied().unwrap_or(outcome.share);
                rank < below
            });
            counts[found.map_or(0, |found| found + 1)] += if apart { 1 } else { quantity };
        }
        let verdict = |place: usize| match place.checked_sub(1).map(|outcome| inspection.outcomes[outcome].to) {
            None => Verdict::Good,
            Some(InspectedTo::Operation(_)) if inspection.rework_max.is_some_and(|most| visits >= most) => {
                Verdict::Scrap(JobOutcome::Rejected)
            }
            Some(InspectedTo::Operation(to)) => Verdict::Back(to as u32),
            Some(InspectedTo::Scrap) => Verdict::Scrap(JobOutcome::Rejected),
        };
        // Several outcomes may come to the same.
        let mut groups: Vec<(Verdict, u32)> = Vec::new();
        for (place, count) in counts.into_iter().enumerate().filter(|(_, count)| *count > 0) {
            let outcome = verdict(place);
            match groups.iter_mut().find(|(other, _)| *other == outcome) {
                Some((_, sum)) => *sum += count,
                None => groups.push((outcome, count)),
            }
        }
        let mut divided = Vec::with_capacity(groups.len());
        for (place, (verdict, count)) in groups.into_iter().enumerate() {
            let group = if place == 0 { slot } else { self.divide(slot, count) };
            divided.push((group, verdict));
        }
        divided
    }

    /// Shares of outcomes as calibration has moved those that scrap; none where there is no calibration. Of shares that are more
    /// than all together the later outcomes lack what is beyond.
    fn moved_shares(&self, machine: usize, slot: u32, outcomes: &[InspectionOutcome]) -> Vec<f64> {
        if self.scenario.calibrations.is_empty() {
            return Vec::new();
        }
        let operation = self.scoped_operation(machine, slot);
        let moved = |outcome: &InspectionOutcome| match outcome.to {
            InspectedTo::Scrap => {
                operation.calibrated(self.scenario, ShopConstant::Scrap, outcome.share).clamp(0.0, 1.0)
            }
            InspectedTo::Operation(_) => outcome.share,
        };
        outcomes.iter().map(moved).collect()
    }

    /// Takes pieces out of a job, as a job of their own at the same operation.
    fn divide(&mut self, slot: u32, pieces: u32) -> u32 {
        let number = self.world.jobs.released;
        let parent = self.world.jobs.at_mut(slot);
        parent.row.quantity -= pieces;
        let entity = parent.entity.part(DIVIDED + u64::from(parent.divisions));
        parent.divisions += 1;
        let mut job = Job { number, entity, divisions: 0, handling: None, ..parent.clone() };
        job.row.quantity = pieces;
        job.row.divided_from = Some(parent.number);
        let (row, origin, operation) = (job.row, job.origin, job.operation);
        let operations = self.scenario.parts[row.part as usize].operations.len();
        if self.layout.random_handling {
            job.handling = Some(Box::new(self.streams.open(entity, Purpose::Processing)));
        }
        let drawn: Vec<(usize, f64)> = (0..operations)
            .filter(|each| matches!(self.scenario.parts[row.part as usize].operations[*each].work, Work::Plain(_)))
            .map(|each| (each, self.world.jobs.drawn(slot, each)))
            .collect();
        let ticket = job.ticket;
        let divided = self.world.jobs.insert(job);
        if self.has_cards() {
            self.enroll(divided, Some(ticket));
        }
        for (index, time) in drawn {
            *self.world.jobs.drawn_mut(divided, index) = time;
        }
        self.world.jobs.copy_ranks(slot, divided);
        self.part_pieces(slot, divided);
        if let Origin::Order(order) = origin {
            self.world.join_lot(order, operation);
        }
        self.recorder.arrival(number, row);
        divided
    }

    /// A job goes back to an operation: its times from there on are drawn anew.
    pub(super) fn send_back(&mut self, slot: u32, end: u32) {
        let scenario = self.scenario;
        let job = self.world.jobs.at_mut(slot);
        job.visits += 1;
        let from = std::mem::replace(&mut job.operation, end);
        let (entity, visit, part, origin) = (job.entity, u64::from(job.visits), job.row.part as usize, job.origin);
        if let Origin::Order(order) = origin {
            self.world.repeat_in_lot(order, end, from);
            self.look_again(order);
        }
        for index in end as usize..=from as usize {
            if matches!(scenario.parts[part].operations[index].work, Work::Plain(_)) {
                let mut stream = self.streams.at(entity.part(index as u64), Purpose::Processing, visit);
                self.draw_work(slot, index, &mut stream);
            }
        }
        debug_assert!(!matches!(self.world.jobs.at(slot).reserved, Some(Place::Buffer(_))));
        self.log_event(LogEvent::Rework, None, Some(self.world.jobs.at(slot).number), None);
    }
}
