//! How many pieces a right shop scraps: what its own simulation scraps.

use toolroom_scenario::{InspectedTo, Operation, Scenario};
use toolroom_shop::runlog::JobOutcome;

/// Longest run that is simulated, s. Assumption: as for the lives of edges.
const STRETCH: f64 = 5.0 * 86400.0;
/// Simulated pieces for each of the log. Assumption: the share by the file is then known twice as well as that of the log.
const FOR_EACH: u64 = 4;
/// Most replications (assumption: of a part that hardly ever comes no more are simulated).
const REPLICATIONS: u32 = 8;

/// Pieces of a part type that left the simulated shop.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedScrap {
    /// The part type.
    pub part: String,
    /// Pieces of jobs of which nothing is left in the shop.
    pub left: u64,
    /// Those of them that were scrapped.
    pub scrapped: u64,
    /// Variance of their number over that of as many pieces that know nothing of each other (1), 1 and more: lots that are
    /// judged as a whole.
    pub clustering: f64,
    /// The only operation whose inspection scraps them.
    pub operation: Option<String>,
    /// Whether anything but inspections scraps some: wear, chatter, burn, breakdowns, the end of a shift. Their causes are no
    /// shares of the file.
    pub otherwise: bool,
}

/// What the shop of a scenario scraps, with all that its file states, of each part type; against a log in which `pieces` of the
/// part that is seen most have left. Parts of which nothing left, and a shop that cannot be run, are in no list.
pub fn expected_scrap(scenario: &Scenario, pieces: u64) -> Vec<ExpectedScrap> {
    let stretch = Scenario { horizon: scenario.horizon.min(STRETCH), warm_up: 0.0, ..scenario.clone() };
    let mut parts: Vec<Sums> = vec![Sums::default(); scenario.parts.len()];
    for replication in 0..REPLICATIONS {
        let Ok(log) = toolroom_shop::run(&stretch, 0, replication) else { return Vec::new() };
        let mut jobs = log.whole_jobs();
        jobs.retain(|job| job.finish.is_finite());
        for job in jobs {
            parts[log.jobs[job.number].part as usize].jobs.push((job.quantity, job.scrapped));
        }
        for job in log.jobs.iter().filter(|job| job.outcome.is_scrap()) {
            parts[job.part as usize].otherwise |= job.outcome != JobOutcome::Rejected;
        }
        if parts.iter().map(Sums::left).max().unwrap_or(0) >= FOR_EACH * pieces {
            break;
        }
    }
    let all = scenario.parts.iter().zip(parts);
    all.filter(|(_, sums)| sums.left() > 0).map(|(part, sums)| sums.expected(&part.name, &part.operations)).collect()
}

/// Jobs of a part type that left.
#[derive(Clone, Default)]
struct Sums {
    /// Pieces, and those that were scrapped.
    jobs: Vec<(u32, u32)>,
    otherwise: bool,
}

impl Sums {
    fn left(&self) -> u64 {
        self.jobs.iter().map(|job| u64::from(job.0)).sum()
    }

    fn expected(self, part: &str, operations: &[Operation]) -> ExpectedScrap {
        let scraps = |own: &&Operation| own.inspection.outcomes.iter().any(|outcome| outcome.to == InspectedTo::Scrap);
        let mut scraps = operations.iter().filter(scraps);
        let only = scraps.next().filter(|_| scraps.next().is_none());
        ExpectedScrap {
            part: part.to_owned(),
            left: self.left(),
            scrapped: self.jobs.iter().map(|job| u64::from(job.1)).sum(),
            clustering: clustering(&self.jobs),
            operation: only.map(|own| own.name.clone()),
            otherwise: self.otherwise,
        }
    }
}

/// Variance of a number of scrapped pieces over that of independent ones, from jobs of so many pieces and so many scrapped; at
/// least 1.
fn clustering(jobs: &[(u32, u32)]) -> f64 {
    let [pieces, scrapped] = jobs
        .iter()
        .fold([0.0, 0.0], |[pieces, scrapped], job| [pieces + f64::from(job.0), scrapped + f64::from(job.1)]);
    let share = scrapped / pieces;
    let binomial = pieces * share * (1.0 - share);
    if !(binomial > 0.0) {
        return 1.0;
    }
    let variance: f64 = jobs.iter().map(|job| (f64::from(job.1) - share * f64::from(job.0)).powi(2)).sum();
    (variance / binomial).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn what_is_scrapped_together_scatters_more() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let alone: Vec<(u32, u32)> = (0..4000).map(|_| (1, u32::from(random.random::<f64>() < 0.05))).collect();
        assert!((1.0..1.3).contains(&clustering(&alone)), "{}", clustering(&alone));
        // Lots of ten pieces that are scrapped as a whole: ten times the variance.
        let lots: Vec<(u32, u32)> = alone.iter().map(|job| (10, 10 * job.1)).collect();
        assert!((9.0..13.0).contains(&clustering(&lots)), "{}", clustering(&lots));
        assert_eq!(clustering(&[(1, 0); 9]), 1.0);
    }
}
