//! Which cases are diagnosed.

use crate::BlindError;
use toolroom_truth::{Case, Extent, GENERATORS, Set, suite};

/// Cases of the benchmark.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Seed of the cases.
    pub seed: u64,
    /// All cases, or a few of each kind.
    pub extent: Extent,
    /// The only process, where one is given.
    pub process: Option<String>,
    /// The only set, by its name, where one is given.
    pub only: Option<String>,
    /// Groups over their usual number.
    pub times: usize,
    /// How far the equations of the shops are off, as a share.
    pub form: f64,
    /// Part `k` of `n`, where only a part is diagnosed: every `n`-th case.
    pub part: Option<(usize, usize)>,
}

impl Selection {
    /// The selected cases.
    ///
    /// # Errors
    /// [`BlindError::UnknownProcess`] and [`BlindError::UnknownSet`].
    pub fn cases(&self) -> Result<Vec<Case>, BlindError> {
        let mut cases = suite(self.seed, self.extent);
        if let Some(process) = &self.process {
            cases.retain(|case| case.process == process);
            if cases.is_empty() {
                let known = GENERATORS.iter().map(|generator| generator.process).collect();
                return Err(BlindError::UnknownProcess { process: process.clone(), known });
            }
        }
        if let Some(only) = &self.only {
            cases.retain(|case| case.set.name() == only);
            if cases.is_empty() {
                return Err(BlindError::UnknownSet { set: only.clone(), known: Set::ALL.map(Set::name).to_vec() });
            }
        }
        for case in &mut cases {
            (case.times, case.form) = (self.times, self.form);
        }
        if let Some((k, n)) = self.part {
            let mut number = 0;
            cases.retain(|_| {
                number += 1;
                number % n == k % n
            });
        }
        Ok(cases)
    }
}
