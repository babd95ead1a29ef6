//! Jobs as they came: what inspections divide from one belongs to it.

use crate::runlog::RunLog;

/// All pieces of a job that came, wherever inspections sent them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WholeJob {
    /// The job as it came: its number.
    pub number: usize,
    /// Pieces with which it came.
    pub quantity: u32,
    /// Pieces of it that were scrapped.
    pub scrapped: u32,
    /// When the last of them left the shop, s; NaN: some are still in it.
    pub finish: f64,
}

impl RunLog {
    /// The job from which inspections have divided the job `number`: itself, where none has.
    pub fn root(&self, mut number: usize) -> usize {
        while let Some(parent) = self.jobs[number].divided_from {
            number = parent as usize;
        }
        number
    }

    /// The jobs that came, in the order of their number, each with all that was divided from it.
    pub fn whole_jobs(&self) -> Vec<WholeJob> {
        let mut places = vec![usize::MAX; self.jobs.len()];
        let mut whole: Vec<WholeJob> = Vec::new();
        for (number, job) in self.jobs.iter().enumerate() {
            let root = self.root(number);
            // What is divided from a job comes after it.
            if root == number {
                places[number] = whole.len();
                whole.push(WholeJob { number, quantity: 0, scrapped: 0, finish: f64::NEG_INFINITY });
            }
            let own = &mut whole[places[root]];
            own.quantity += job.quantity;
            own.scrapped += if job.outcome.is_scrap() { job.quantity } else { 0 };
            own.finish = if own.finish.is_nan() || job.finish.is_nan() { f64::NAN } else { own.finish.max(job.finish) };
        }
        whole
    }
}
