//! A comparison in shards: the replications of the shop as it is and of its variants are cut into parts that any host
//! computes.

use crate::request::{UnknownPolicy, policies_named};
use crate::study::{KnownRuns, StoredRun, StudyError, known, stored_digest, stored_runs};
use crate::variants::{self, VariantError, VariantShop};
use std::path::{Path, PathBuf};
use toolroom_form::ReadError;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::{ScenarioFile, ShopVariant, parse};
pub use toolroom_shards::Axis;
use toolroom_shards::{Computed, PLAN, Plan, ShardError, Work};

/// Why a planned comparison was not computed.
#[derive(Debug, thiserror::Error)]
pub enum PlannedError {
    /// The scenario of the plan.
    #[error(transparent)]
    Scenario(#[from] ReadError),
    /// A policy of the plan.
    #[error(transparent)]
    Policy(#[from] UnknownPolicy),
    /// A variant of the plan.
    #[error(transparent)]
    Variant(#[from] VariantError),
    /// A run stopped.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The files of the parts.
    #[error(transparent)]
    Shard(#[from] ShardError),
}

/// The policies, by index, and the variants that a comparison of `file` is of; `names` are those of policies, none for all
/// of them, and without an axis it is of all that the file has. One policy by name is compared with the first of the file; of
/// the axis of variants there is but the first policy, whatever is named.
///
/// # Errors
/// [`UnknownPolicy`]
pub fn compared(
    file: &ScenarioFile,
    names: &[String],
    axis: Option<Axis>,
) -> Result<(Vec<usize>, Vec<ShopVariant>), UnknownPolicy> {
    let mut policies = policies_named(&file.scenario, names)?;
    if policies.len() == 1 && policies[0] != 0 {
        policies.insert(0, 0);
    }
    let variants = match axis {
        Some(Axis::Policy) => Vec::new(),
        Some(Axis::Variant) => {
            policies.truncate(1);
            file.variants.clone()
        }
        Some(Axis::Both) | None => file.variants.clone(),
    };
    Ok((policies, variants))
}

/// The plan of a comparison in at most `shards` parts; a replication each where it is `None`. `names` are those of the
/// policies and `axis` what is compared, as for [`compared`]. The scenario of `file` was read as `name` with `overrides`.
///
/// # Errors
/// [`PlannedError`] of policies and variants that cannot be run, and of a file that they name and that cannot be read.
pub fn plan(
    version: &str,
    (name, file): (&str, &ScenarioFile),
    overrides: Vec<String>,
    (names, axis): (&[String], Option<Axis>),
    shards: Option<u64>,
) -> Result<Plan, PlannedError> {
    let scenario = &file.scenario;
    let replications = u64::from(scenario.replications);
    let (_, variants) = compared(file, names, axis)?;
    let variants = variants::shops(name, &file.text, &overrides, &variants)?;
    let mut files = file.files.clone();
    let own = variants.into_iter().flat_map(|variant| variant.files);
    own.for_each(|path: PathBuf| {
        if !files.contains(&path) {
            files.push(path)
        }
    });
    Ok(Plan {
        schema: PLAN,
        kind: Work::Compare,
        version: version.to_owned(),
        name: scenario.name.clone(),
        file: name.to_owned(),
        directory: String::new(),
        text: file.text.clone(),
        files: Plan::fingerprints(&files)?,
        overrides,
        policies: names.to_vec(),
        axis,
        seed: scenario.seed,
        pieces: replications,
        shards: shards.unwrap_or(replications).min(replications),
    })
}

/// What the comparison of a plan is of.
#[derive(Clone, Debug)]
pub struct PlannedComparison {
    /// The scenario.
    pub file: ScenarioFile,
    /// Policies by index.
    pub policies: Vec<usize>,
    /// Variants of the shop.
    pub variants: Vec<VariantShop>,
}

impl PlannedComparison {
    /// Reads what a plan holds.
    ///
    /// # Errors
    /// [`PlannedError::Scenario`], [`PlannedError::Policy`], [`PlannedError::Variant`]
    pub fn read(plan: &Plan) -> Result<Self, PlannedError> {
        let file = parse(&plan.file, &plan.text, &plan.overrides)?;
        let (policies, variants) = compared(&file, &plan.policies, plan.axis)?;
        let variants = variants::shops(&plan.file, &plan.text, &plan.overrides, &variants)?;
        Ok(Self { file, policies, variants })
    }

    /// The shop as it is, then its variants.
    fn shops(&self) -> Vec<&Scenario> {
        let variants = self.variants.iter().map(|variant| variant.scenario.as_ref());
        std::iter::once(&self.file.scenario).chain(variants).collect()
    }

    /// Replications `from..to` of every shop, one shop after the other.
    fn runs(&self, (from, to): (u32, u32)) -> Result<Vec<StoredRun>, StudyError> {
        let mut runs = Vec::new();
        for shop in (0..).zip(self.shops()) {
            runs.extend(stored_runs(shop, &self.policies, from, to)?);
        }
        Ok(runs)
    }

    /// The runs in the parts of the plan.
    ///
    /// # Errors
    /// [`ShardError`]: parts that are missing, changed or of another plan.
    pub fn known_runs(&self, plan: &Plan, parts: &Path) -> Result<KnownRuns, ShardError> {
        let digest = |runs: &Vec<StoredRun>, range| stored_digest(&self.shops(), &self.policies, range, runs);
        Ok(known(toolroom_shards::parts(plan, parts, digest)?.into_iter().flatten()))
    }
}

/// Computes one shard into the directory `folder`.
///
/// # Errors
/// See [`PlannedError`].
pub fn shard(plan: &Plan, number: u64, folder: &Path) -> Result<(), PlannedError> {
    let comparison = PlannedComparison::read(plan)?;
    let mut failed = None;
    let ran = toolroom_shards::run(plan, number, folder, |(from, to), _| {
        // Replications are 32-bit numbers by the form of the file.
        let runs = comparison.runs((from as u32, to as u32)).map_err(|error| {
            failed = Some(error);
            let source = std::io::Error::other("the shop stopped");
            ShardError::File { path: folder.to_owned(), source }
        })?;
        let digest = stored_digest(&comparison.shops(), &comparison.policies, (from, to), &runs)
            .map_err(|why| ShardError::Malformed { path: folder.to_owned(), why })?;
        Ok(Computed { content: runs, digest, rows: false })
    });
    match failed {
        Some(error) => Err(error.into()),
        None => Ok(ran?),
    }
}
