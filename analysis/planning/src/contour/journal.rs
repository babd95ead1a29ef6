//! Draws of the conditions that are kept as they end, so that a study of scatter goes on where it was interrupted.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::HashMap;
use std::path::Path;
use toolroom_contour::{Constraint, Draw, DrawKeeper, Pass};
use toolroom_shards::{Journal, ShardError};

/// A draw as the journal holds it. The conditions themselves follow from seed and number and are not kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct KeptDraw {
    /// Pass, what scatters, and what the plan makes least.
    study: String,
    /// From 0.
    number: u32,
    productivity_gain: Option<f64>,
    cost_change: Option<f64>,
    /// Names of the constraints that the nominal plan breaks.
    broken: Vec<String>,
}

/// The journal of a plan.
#[derive(Debug)]
pub struct DrawJournal {
    journal: Journal<KeptDraw>,
    kept: HashMap<(String, u32), KeptDraw>,
}

impl DrawJournal {
    /// The journal in the file `path` of the work that `head` tells, with the draws of earlier work.
    ///
    /// # Errors
    /// [`ShardError`]: a file that cannot be read, or the journal of other work.
    pub fn open(path: &Path, head: &Value) -> Result<Self, ShardError> {
        let (journal, pieces) = Journal::open(path, head)?;
        let kept = pieces.into_iter().map(|piece: KeptDraw| ((piece.study.clone(), piece.number), piece)).collect();
        Ok(Self { journal, kept })
    }

    /// Draws that earlier work has kept.
    pub fn count(&self) -> usize {
        self.kept.len()
    }

    /// Why draws could not be kept, where that is so.
    pub fn failure(&self) -> Option<String> {
        self.journal.failure()
    }
}

/// Keeps the draws of one study of scatter, and tells that one has ended.
pub(super) struct Keeper<'a> {
    pub study: String,
    pub journal: Option<&'a DrawJournal>,
    pub done: &'a (dyn Fn() + Sync),
}

impl DrawKeeper for Keeper<'_> {
    fn kept(&self, number: u32, pass: &Pass) -> Option<Draw> {
        let kept = self.journal?.kept.get(&(self.study.clone(), number))?;
        let constraint = |name: &String| Constraint::ALL.into_iter().find(|constraint| constraint.name() == name);
        // A journal with a constraint that nobody knows is of another version: the draw is worked out again.
        let broken = kept.broken.iter().map(constraint).collect::<Option<Vec<_>>>()?;
        (self.done)();
        let (productivity_gain, cost_change) = (kept.productivity_gain, kept.cost_change);
        Some(Draw { pass: *pass, productivity_gain, cost_change, broken })
    }

    fn ended(&self, number: u32, draw: &Draw) {
        if let Some(DrawJournal { journal, .. }) = self.journal {
            journal.add(&KeptDraw {
                study: self.study.clone(),
                number,
                productivity_gain: draw.productivity_gain,
                cost_change: draw.cost_change,
                broken: draw.broken.iter().map(|constraint| constraint.name().to_owned()).collect(),
            });
        }
        (self.done)();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::{StudyOptions, studies};
    use serde_json::json;
    use std::sync::atomic::{AtomicU32, Ordering};
    use toolroom_contour::ContourFile;

    #[test]
    fn a_study_that_goes_on_has_the_draws_of_one_that_was_never_interrupted() {
        let text = include_str!("../../../../scenarios/contour/rk3.toml");
        let file = ContourFile::parse("rk3.toml", text, &[]).expect("a contour").content;
        let options = StudyOptions { passes: vec!["finish".to_owned()], draws: 3, seed: 7, ..StudyOptions::default() };
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("draws");
        let work = |journal: Option<&DrawJournal>| {
            let count = AtomicU32::new(0);
            let progress = |_, _| {
                count.fetch_add(1, Ordering::Relaxed);
            };
            let studies = studies(&file, &options, &|_| (), &progress, journal).expect("plans");
            let by = studies[0].scatter.iter().flat_map(|scattered| &scattered.by_objective);
            let draws: Vec<Draw> = by.flat_map(|sensitivity| sensitivity.draws.clone()).collect();
            (draws, count.into_inner())
        };
        let (whole, parts) = work(None);
        assert_eq!((whole.len(), parts), (24, 26));
        let open = || DrawJournal::open(&path, &json!({ "seed": 7 })).expect("a journal");
        let journal = open();
        assert_eq!((journal.count(), work(Some(&journal)).0), (0, whole.clone()));
        // A process that died after some draws.
        let lines = std::fs::read_to_string(&path).expect("written");
        let first: String = lines.lines().take(11).map(|line| format!("{line}\n")).collect();
        std::fs::write(&path, first).expect("writable");
        let journal = open();
        assert_eq!((journal.count(), work(Some(&journal))), (10, (whole, parts)), "kept draws count as done");
        assert_eq!(open().count(), 24);
    }
}
