//! The finished part of a study, kept to the last bit: what a stopped study goes on from, and what
//! its report is drawn from again.

use super::{EdgeLife, NamedLife, Precision, Run, Study, StudyError};
use crate::variants::{SelectedShop, VariantRuns};
use serde::{Deserialize, Serialize, Serializer};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use toolroom_scenario::Scenario;
use toolroom_steady::OneRun;

/// Figures and edges of every finished replication.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Finished {
    /// Replications that all policies finished.
    pub replications: u32,
    /// Whether that is all of them.
    pub complete: bool,
    digest: u64,
    /// By policy and replication; null where it is not defined.
    values: Vec<Vec<Vec<Option<f64>>>>,
    edge_lives: Vec<Vec<NamedLife>>,
    /// Stop rule, as on the command line.
    #[serde(default)]
    until: Vec<String>,
    /// Variants of the shop.
    #[serde(default)]
    variants: Vec<VariantRuns>,
    /// The best of them.
    #[serde(default)]
    selection: Option<SelectedShop>,
    /// Where it was read, with the log tables of the same replications.
    #[serde(skip)]
    pub directory: PathBuf,
}

/// [`Finished`] as it is written.
#[derive(Serialize)]
struct FinishedFile<'a> {
    schema: u32,
    replications: u32,
    complete: bool,
    digest: u64,
    values: Vec<Figures<'a>>,
    edge_lives: Vec<Lives<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    until: Vec<String>,
    #[serde(skip_serializing_if = "<[VariantRuns]>::is_empty")]
    variants: &'a [VariantRuns],
    #[serde(skip_serializing_if = "Option::is_none")]
    selection: Option<&'a SelectedShop>,
}

/// Figures of every replication of a policy.
struct Figures<'a> {
    study: &'a Study,
    policy: usize,
}

impl Serialize for Figures<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let defined = |values: Vec<f64>| -> Vec<Option<f64>> {
            values.into_iter().map(|value| value.is_finite().then_some(value)).collect()
        };
        serializer.collect_seq(self.study.values[self.policy].iter().map(defined))
    }
}

/// Edges of every replication of a policy.
struct Lives<'a> {
    study: &'a Study,
    policy: usize,
}

impl Serialize for Lives<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.study.edge_lives(self.policy).map(|life| life.named()))
    }
}

/// Why the finished part of a study cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FinishedError {
    /// The file cannot be read.
    #[error("cannot read {path}: {source}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        source: io::Error,
    },
    /// The file is not what was written.
    #[error("{path} is not the finished part of a study: {source}")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: serde_json::Error,
    },
}

impl Finished {
    /// Name of its file beside the other results.
    pub(crate) const FILE: &str = "study.json";

    /// Writes what a study has finished, row by row.
    pub(crate) fn write(study: &Study, out: impl io::Write) -> io::Result<()> {
        let policies = 0..study.policies.len();
        let told = FinishedFile {
            schema: 1,
            replications: study.replications,
            complete: study.complete,
            digest: study.digest,
            values: policies.clone().map(|policy| Figures { study, policy }).collect(),
            edge_lives: policies.map(|policy| Lives { study, policy }).collect(),
            until: study.until.iter().map(Precision::to_string).collect(),
            variants: &study.variants,
            selection: study.selection.as_ref(),
        };
        Ok(serde_json::to_writer(out, &told)?)
    }

    /// Reads what a study left in its directory.
    ///
    /// # Errors
    /// See [`FinishedError`].
    pub fn read(directory: &Path) -> Result<Self, FinishedError> {
        let path = directory.join(Self::FILE);
        let text = fs::read(&path).map_err(|source| FinishedError::Unreadable { path: path.clone(), source })?;
        let read: Self = serde_json::from_slice(&text).map_err(|source| FinishedError::Damaged { path, source })?;
        Ok(Self { directory: directory.to_owned(), ..read })
    }

    /// Takes a study that has run nothing to where this one was. `first` is its first replication,
    /// run again, which has to come out as it did.
    pub(super) fn restore(&self, scenario: &Scenario, first: Vec<Run>, study: &mut Study) -> Result<(), StudyError> {
        let again = |run: &Run, position: usize| {
            let there = self.values.get(position).and_then(|values| values.first());
            there.is_some_and(|there| same(there, &run.values))
                && self.values[position].len() == self.replications as usize
                && self.values[position].iter().all(|values| values.len() == run.values.len())
        };
        for (position, run) in first.into_iter().enumerate() {
            let lives = self.lives(position).filter(|lives| lives.starts_with(&run.lives) && again(&run, position));
            let Some(lives) = lives else {
                let policy = scenario.policies[study.policies[position]].name.clone();
                return Err(StudyError::NotRepeated { policy });
            };
            for values in &self.values[position] {
                let values: Vec<f64> = values.iter().map(|value| value.unwrap_or(f64::NAN)).collect();
                study.values[position].push(&values);
            }
            lives.iter().for_each(|life| study.edge_lives[position].push(&life.numbers()));
            study.one_run[position] = run.lead_times.as_ref().and_then(OneRun::from_lead_times);
            study.first_logs.extend(run.log);
        }
        study.digest = self.digest;
        study.variants.clone_from(&self.variants);
        study.selection.clone_from(&self.selection);
        study.replications = self.replications;
        if study.until.is_empty() {
            study.until = self.until.iter().filter_map(|text| text.parse().ok()).collect();
        }
        Ok(())
    }

    fn lives(&self, position: usize) -> Option<Vec<EdgeLife>> {
        self.edge_lives.get(position)?.iter().map(EdgeLife::of_named).collect()
    }
}

/// To the last bit; what is not defined is equal to what is not defined.
fn same(there: &[Option<f64>], here: &[f64]) -> bool {
    there.len() == here.len()
        && there.iter().zip(here).all(|(there, here)| match there {
            Some(there) => there.to_bits() == here.to_bits(),
            None => !here.is_finite(),
        })
}
