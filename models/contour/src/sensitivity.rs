//! How the gains of a plan move when the conditions scatter.

use crate::{Constraint, Contour, ContourError, Models, Objective, Parameters, Pass, Planner};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, LogNormal, Normal};
use toolroom_process::record;

record! {
    /// How conditions scatter, relative to nominal; tolerance is not scattered.
    ///
    /// # Source
    /// Hardness: coefficient of variation of 5 to 8 % in lots of steel; the others are
    /// assumptions.
    pub struct ConditionScatter {
        /// Standard deviation of the allowance over the allowance (normal).
        allowance: Real = 0.1, 0.0..=1.0;
        /// Coefficient of variation of hardness (lognormal, median 1).
        hardness: Real = 0.065, 0.0..=1.0;
        /// Coefficient of variation of the table feed (lognormal, median 1): handbooks and
        /// planners differ.
        table_feed: Real = 0.2, 0.0..=1.0;
    }
}

/// One draw of the conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw {
    /// The pass as it was drawn.
    pub pass: Pass,
    /// Gain in productivity of a plan for these conditions over their handbook regime; `None`
    /// where either does not exist.
    pub productivity_gain: Option<f64>,
    /// Its change of cost.
    pub cost_change: Option<f64>,
    /// Constraints that the nominal plan breaks in these conditions.
    pub broken: Vec<Constraint>,
}

/// What many draws come to.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// Every draw, in order.
    pub draws: Vec<Draw>,
}

impl Sensitivity {
    /// Plans `draws` times in scattered conditions. Draw k depends on `seed` and k alone.
    ///
    /// # Errors
    /// Where the nominal plan does not exist, or a scatter is out of range.
    ///
    /// # Examples
    /// ```
    /// use toolroom_contour::*;
    /// let mut trace = Trace::new(Point::default(), 0.0);
    /// trace.lobed(0.1, 0.0035, 3, 18).unwrap();
    /// let hole = trace.finish(CutterSide::Left, true).unwrap();
    /// let models = Models { path_error: PathError::Empirical, ..Models::default() };
    /// let none = ConditionScatter { allowance: 0.0, hardness: 0.0, table_feed: 0.0 };
    /// let same = Sensitivity::draw(&hole, &Parameters::default(), &Pass::default(), &models, Objective::Time, &none, 2, 1);
    /// assert!((same.unwrap().productivity_gain(0.5).unwrap() - 0.1464).abs() < 1e-4);
    /// ```
    #[allow(clippy::too_many_arguments)] // the planner's four, and what is drawn how often
    pub fn draw(
        contour: &Contour,
        parameters: &Parameters,
        nominal: &Pass,
        models: &Models,
        objective: Objective,
        scatter: &ConditionScatter,
        draws: u32,
        seed: u64,
    ) -> Result<Self, ContourError> {
        use toolroom_process::Record;
        scatter.check()?;
        let planned = Planner::new(contour, parameters, nominal, models)?.optimal(objective)?;
        let settings: Vec<_> = planned.sections.iter().map(|section| section.setting).collect();
        let one = |k: u32| -> Result<Draw, ContourError> {
            let pass = scatter.pass(nominal, seed, k);
            let planner = Planner::new(contour, parameters, &pass, models)?;
            let plans = planner.handbook().ok().zip(planner.optimal(objective).ok());
            let mut broken: Vec<Constraint> = Vec::new();
            for (i, setting) in settings.iter().enumerate() {
                broken.extend(
                    planner.evaluate(i, *setting).into_iter().flat_map(|at| at.ratios.violated().collect::<Vec<_>>()),
                );
            }
            broken.sort();
            broken.dedup();
            let gain = plans.as_ref().map(|(handbook, plan)| plan.productivity_gain(handbook));
            let cost = plans.as_ref().map(|(handbook, plan)| plan.cost_change(handbook));
            Ok(Draw { pass, productivity_gain: gain, cost_change: cost, broken })
        };
        Ok(Self { draws: (0..draws).map(one).collect::<Result<_, _>>()? })
    }

    /// Quantile of the gain in productivity over the draws that have one.
    pub fn productivity_gain(&self, share: f64) -> Option<f64> {
        quantile(self.draws.iter().filter_map(|draw| draw.productivity_gain), share)
    }

    /// Quantile of the change of cost over the draws that have one.
    pub fn cost_change(&self, share: f64) -> Option<f64> {
        quantile(self.draws.iter().filter_map(|draw| draw.cost_change), share)
    }

    /// Share of draws in which the nominal plan breaks `constraint`.
    pub fn broken(&self, constraint: Constraint) -> f64 {
        let count = self.draws.iter().filter(|draw| draw.broken.contains(&constraint)).count();
        count as f64 / self.draws.len() as f64
    }

    /// Share of draws for which handbook regime or plan do not exist.
    pub fn without_plan(&self) -> f64 {
        let count = self.draws.iter().filter(|draw| draw.productivity_gain.is_none()).count();
        count as f64 / self.draws.len() as f64
    }
}

impl ConditionScatter {
    /// The pass of draw `k`.
    fn pass(&self, nominal: &Pass, seed: u64, k: u32) -> Pass {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(u64::from(k));
        // A lognormal of median 1 and coefficient of variation c has σ² = ln(1 + c²).
        let mut lognormal = |variation: f64| {
            let sigma = (1.0 + variation * variation).ln().sqrt();
            LogNormal::new(0.0, sigma).map_or(1.0, |law| law.sample(&mut rng))
        };
        let (hardness, table_feed) = (lognormal(self.hardness), lognormal(self.table_feed));
        let allowance = Normal::new(1.0, self.allowance).map_or(1.0, |law| law.sample(&mut rng));
        Pass {
            allowance: (nominal.allowance * allowance).max(1e-7),
            hardness_ratio: (nominal.hardness_ratio * hardness).clamp(0.3, 3.0),
            table_feed: (nominal.table_feed * table_feed).clamp(1e-7, 5e-3),
            ..*nominal
        }
    }
}

/// Value below which `share` of the values lie, by linear interpolation of the order statistics.
fn quantile(values: impl Iterator<Item = f64>, share: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let at = share.clamp(0.0, 1.0) * (sorted.len().checked_sub(1)? as f64);
    let (low, high) = (sorted[at.floor() as usize], sorted[at.ceil() as usize]);
    Some(low + (high - low) * at.fract())
}
