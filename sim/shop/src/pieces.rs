//! Pieces of a job that are not all alike: times drawn for each, and samples.
//!
//! Pieces have numbers within their order or source, from 0, and a job has consecutive ones. Which of them are in a sample
//! follows from the number alone, so that it is the same whatever the order in which jobs are worked on.

use super::Shop;
use super::recorder::Recorder;
use rand::RngExt;
use toolroom_kernel::Stream;
use toolroom_scenario::{DrawUnit, Operation, Work};

/// Times of plain work of every piece of a job, s, by operation.
pub(super) type PieceTimes = Vec<(usize, Vec<f64>)>;

impl<R: Recorder> Shop<'_, R> {
    /// Draws the plain work of an operation of a job from a stream: one rank for the job, or one for each of its pieces.
    pub(super) fn draw_work(&mut self, slot: u32, index: usize, stream: &mut Stream) {
        let scenario = self.scenario;
        let job = self.world.jobs.at_mut(slot);
        let operation = &scenario.parts[job.row.part as usize].operations[index];
        let Work::Plain(time) = &operation.work else { return };
        let count = job.row.quantity;
        if operation.draw == DrawUnit::Part && count > 1 {
            let times = (0..count).map(|_| time.sample(stream)).collect();
            let own = job.piece_times.get_or_insert_default();
            own.retain(|(known, _)| *known != index);
            own.push((index, times));
            self.sum_up(slot, index);
        } else {
            let rank = stream.random();
            self.set_rank(slot, index, rank);
            self.set_work(slot, index, time.quantile(rank));
        }
    }

    /// Keeps the rank of a job at an operation for which machines have times of their own.
    pub(super) fn set_rank(&mut self, slot: u32, index: usize, rank: f64) {
        if self.layout.operations[self.world.jobs.at(slot).row.part as usize][index].own_times {
            self.world.jobs.set_rank(slot, index, rank);
        }
    }

    /// The pieces of a job all need the same plain work for an operation, s; those that pass by it need none.
    pub(super) fn set_work(&mut self, slot: u32, index: usize, time: f64) {
        *self.world.jobs.drawn_mut(slot, index) = time * self.worked_share(slot, index);
    }

    /// Share of the pieces of a job on which an operation is done.
    fn worked_share(&self, slot: u32, index: usize) -> f64 {
        let job = self.world.jobs.at(slot);
        if !self.layout.operations[job.row.part as usize][index].apart {
            return 1.0;
        }
        let operation = &self.scenario.parts[job.row.part as usize].operations[index];
        f64::from(worked(operation, job.first_piece, job.row.quantity)) / f64::from(job.row.quantity)
    }

    /// Plain work of an operation of a job on a machine, s, that of a piece or of the job as drawn; `None` where the machine has
    /// no time of its own for it.
    pub(super) fn own_work(&self, machine: usize, slot: u32, index: usize) -> Option<f64> {
        let part = self.world.jobs.at(slot).row.part as usize;
        if !self.layout.operations[part][index].own_times {
            return None;
        }
        let time = self.scenario.parts[part].operations[index].own_time_on(machine)?;
        Some(time.quantile(self.world.jobs.rank(slot, index)) * self.worked_share(slot, index))
    }

    /// The mean time of a piece of a job whose pieces have times of their own.
    fn sum_up(&mut self, slot: u32, index: usize) {
        let job = self.world.jobs.at(slot);
        let inspection = &self.scenario.parts[job.row.part as usize].operations[index].inspection;
        let sample = inspection.sample.filter(|_| inspection.passes_by());
        let Some((_, times)) = job.piece_times.iter().flat_map(|own| own.iter()).find(|(own, _)| *own == index) else {
            return;
        };
        let worked = (job.first_piece..).zip(times).filter(|(piece, _)| sample.is_none_or(|own| own.has(*piece)));
        let sum: f64 = worked.map(|(_, time)| time).sum();
        let mean = sum / f64::from(job.row.quantity);
        *self.world.jobs.drawn_mut(slot, index) = mean;
    }

    /// The last pieces of a job are a job of their own now: each has the times of its pieces.
    pub(super) fn part_pieces(&mut self, slot: u32, divided: u32) {
        let (first, own, others) = {
            let (job, other) = (self.world.jobs.at(slot), self.world.jobs.at(divided));
            (job.first_piece, job.row.quantity, other.row.quantity)
        };
        self.world.jobs.at_mut(divided).first_piece = first + u64::from(own);
        let part = self.world.jobs.at(slot).row.part as usize;
        for index in 0..self.layout.operations[part].len() {
            if !self.layout.operations[part][index].apart {
                continue;
            }
            let rest = self.world.jobs.at_mut(slot).piece_times.as_mut().and_then(|all| {
                let (_, times) = all.iter_mut().find(|(known, _)| *known == index)?;
                Some(times.split_off(own as usize))
            });
            if let Some(rest) = rest {
                let times = self.world.jobs.at_mut(divided).piece_times.get_or_insert_default();
                times.retain(|(known, _)| *known != index);
                times.push((index, rest));
                self.sum_up(slot, index);
                self.sum_up(divided, index);
                continue;
            }
            // All pieces need the same: what one of a sample needs follows from their mean.
            let operation = &self.scenario.parts[part].operations[index];
            let before = worked(operation, first, own + others);
            if before > 0 {
                let time = self.world.jobs.drawn(slot, index) * f64::from(own + others) / f64::from(before);
                self.set_work(slot, index, time);
                self.set_work(divided, index, time);
            }
        }
    }

    /// A job passes by the operations at which none of its pieces is in the sample.
    pub(super) fn pass_by(&mut self, slot: u32) {
        loop {
            let job = self.world.jobs.at(slot);
            let (part, index) = (job.row.part as usize, job.operation);
            let operations = &self.scenario.parts[part].operations;
            let Some(operation) = operations.get(index as usize) else { return };
            if !operation.inspection.passes_by() || worked(operation, job.first_piece, job.row.quantity) > 0 {
                return;
            }
            let next = job.next_operation(operations.len()) as u32;
            self.world.jobs.at_mut(slot).operation = next;
            self.passed(slot, index);
        }
    }
}

/// Pieces of a job on which an operation is done.
fn worked(operation: &Operation, first: u64, quantity: u32) -> u32 {
    let sample = operation.inspection.sample.filter(|_| operation.inspection.passes_by());
    sample.map_or(quantity, |sample| sample.among(first, quantity))
}
