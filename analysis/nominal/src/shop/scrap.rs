//! How many pieces a right shop scraps: what its own simulation scraps.

use toolroom_scenario::{InspectedTo, Inspection, Operation, Part, Scenario, Work};
use toolroom_shop::runlog::{JobOutcome, WholeJob};

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
    /// The only operation whose inspection scraps them, by a share of the file.
    pub operation: Option<String>,
    /// Whether anything but inspections scraps some: wear, chatter, burn, breakdowns, the end of a shift. Their causes are no
    /// shares of the file.
    pub otherwise: bool,
}

/// What the shop of a scenario scraps, with all that its file states, of each part type; against a log in which `pieces` of the
/// part that is seen most have left. Parts of which nothing left, and a shop that cannot be run, are in no list.
pub fn expected_scrap(scenario: &Scenario, pieces: u64) -> Vec<ExpectedScrap> {
    if !is_worth_simulating(scenario) {
        let unknown = |part: &Part| ExpectedScrap {
            part: part.name.clone(),
            left: 0,
            scrapped: 0,
            clustering: 1.0,
            operation: None,
            otherwise: true,
        };
        return scenario.parts.iter().map(unknown).collect();
    }
    let whole = Scenario { warm_up: 0.0, ..scenario.clone() };
    let mut parts: Vec<Sums> = vec![Sums::default(); scenario.parts.len()];
    for replication in 0..REPLICATIONS {
        let Ok(log) = toolroom_shop::run(&whole, 0, replication) else { return Vec::new() };
        let jobs = log.whole_jobs();
        let times: Vec<(f64, f64)> = jobs.iter().map(|job| (log.jobs[job.number].arrival, job.finish)).collect();
        for (job, _) in jobs.iter().zip(settled(&times)).filter(|(_, settled)| *settled) {
            let WholeJob { number, quantity, scrapped, .. } = *job;
            parts[log.jobs[number].part as usize].jobs.push((quantity, scrapped));
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

/// Whether a simulation would tell a share: cuts are dear to simulate, and what they spoil is no share of the file.
fn is_worth_simulating(scenario: &Scenario) -> bool {
    let mut operations = scenario.parts.iter().flat_map(|part| &part.operations);
    let cuts = operations.clone().any(|own| !matches!(own.work, Work::Plain(_)));
    !cuts || operations.any(|own| !own.inspection.outcomes.is_empty())
}

/// Which jobs count, from when each came and when all of it had left (s; no number: some is still in the shop): those that came
/// before every job that is still there. A job that is scrapped leaves sooner than a good one, and of the last that came only such
/// would count.
///
/// # Examples
/// ```
/// use toolroom_nominal::shop::settled;
/// assert_eq!(settled(&[(0.0, 9.0), (3.0, f64::NAN), (5.0, 6.0)]), [true, false, false]);
/// ```
pub fn settled(times: &[(f64, f64)]) -> Vec<bool> {
    let open = times.iter().filter(|(_, left)| left.is_nan()).map(|(came, _)| *came).fold(f64::INFINITY, f64::min);
    times.iter().map(|(came, left)| left.is_finite() && *came < open).collect()
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
        // What is sent back too often is scrapped by no share of its own.
        let by_visits = |own: &Inspection| {
            own.rework_max.is_some() && own.outcomes.iter().any(|outcome| outcome.to != InspectedTo::Scrap)
        };
        let by_share = |own: &Inspection| own.outcomes.iter().any(|outcome| outcome.to == InspectedTo::Scrap);
        let mut scraps = operations.iter().filter(|own| by_share(&own.inspection) || by_visits(&own.inspection));
        let only = scraps.next().filter(|own| scraps.next().is_none() && !by_visits(&own.inspection));
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
    if binomial.is_nan() || binomial <= 0.0 {
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

    /// The operation that is told to scrap the parts of a shop of two inspections.
    fn told(first: &str, second: &str) -> Option<String> {
        let text = format!(
            "schema = 1\n[shop]\nname = \"two\"\nhorizon = \"40 h\"\n[[machine]]\nname = \"W\"\nprocess = \"plain\"\n\
             [[part]]\nname = \"ring\"\noperation = [\n{{ name = \"a\", machines = \"W\", work = \"4 min\"{first} }},\n\
             {{ name = \"b\", machines = \"W\", work = \"4 min\"{second} }},\n]\n\
             [[arrivals]]\npart = \"ring\"\npattern = \"poisson\"\nrate = \"4 1/h\"\n"
        );
        let scenario = toolroom_scenario_file::parse("two.toml", &text, &[]).expect("a fine shop").scenario;
        let found = expected_scrap(&scenario, 10);
        assert_eq!(found.len(), 1, "{found:?}");
        found[0].operation.clone()
    }

    #[test]
    fn scrap_has_an_owner_where_one_share_alone_scraps() {
        let [scrap, back] = [
            ", outcomes = [{ share = 0.1, scrap = true }]",
            ", outcomes = [{ share = 0.2, go = \"a\" }], rework_max = 1",
        ];
        assert_eq!(told("", scrap).as_deref(), Some("b"));
        assert_eq!(told(scrap, scrap), None);
        // What comes back too often is scrapped where no share says so.
        assert_eq!(told(back, scrap), None);
        assert_eq!(told("", back), None);
    }
}
