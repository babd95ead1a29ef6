//! How the gains of a plan move when the conditions scatter.

use crate::{Constraint, ContourError, Objective, Pass, Planner, Setting};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, LogNormal, Normal};
use rayon::prelude::*;
use toolroom_numerics::order_quantile;
use toolroom_process::{Record, record};

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

/// Who keeps draws as they end, from any thread, so that work that was interrupted goes on.
pub trait DrawKeeper: Sync {
    /// The draw of this number where earlier work has come to it; its pass is `pass`.
    fn kept(&self, number: u32, pass: &Pass) -> Option<Draw>;
    /// A draw that has ended.
    fn ended(&self, number: u32, draw: &Draw);
}

/// Nothing is kept.
impl DrawKeeper for () {
    fn kept(&self, _: u32, _: &Pass) -> Option<Draw> {
        None
    }

    fn ended(&self, _: u32, _: &Draw) {}
}

/// What many draws come to.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// Every draw, in order.
    pub draws: Vec<Draw>,
}

impl Planner<'_> {
    /// Plans `draws` times in scattered conditions, each time against the handbook regime of the
    /// same conditions, and tries the nominal plan in them. Draw k depends on `seed` and k alone. `keeper` is told each draw as it
    /// ends, and asked for those of earlier work.
    ///
    /// # Errors
    /// Where the nominal plan does not exist, or a scatter is out of range.
    ///
    /// # Examples
    /// ```
    /// use toolroom_contour::{ConditionScatter, ContourFile, Objective};
    /// let file = ContourFile::parse("rk3.toml", include_str!("../../../scenarios/contour/rk3.toml"), &[]).unwrap().content;
    /// let (_, finish) = &file.planners().unwrap()[1];
    /// let none = ConditionScatter { allowance: 0.0, hardness: 0.0, table_feed: 0.0 };
    /// let same = finish.sensitivity(Objective::Time, &none, 2, 1, &()).unwrap();
    /// assert!((same.productivity_gain(0.5).unwrap() - 0.1464).abs() < 1e-4);
    /// ```
    pub fn sensitivity(
        &self,
        objective: Objective,
        scatter: &ConditionScatter,
        draws: u32,
        seed: u64,
        keeper: &dyn DrawKeeper,
    ) -> Result<Sensitivity, ContourError> {
        scatter.check()?;
        let nominal = self.optimal(objective)?;
        let settings: Vec<Setting> = nominal.sections.iter().map(|section| section.setting).collect();
        let one = |k: u32| -> Result<Draw, ContourError> {
            let pass = scatter.pass(self.pass, seed, k);
            if let Some(draw) = keeper.kept(k, &pass) {
                return Ok(draw);
            }
            let planner = Planner::new(self.drawn(), self.parameters, &pass, self.models)?;
            let plans = planner.handbook().ok().zip(planner.optimal(objective).ok());
            let broken = planner.violated_by(self, &settings);
            let productivity_gain = plans.as_ref().map(|(handbook, plan)| plan.productivity_gain(handbook));
            let cost_change = plans.as_ref().map(|(handbook, plan)| plan.cost_change(handbook));
            let draw = Draw { pass, productivity_gain, cost_change, broken };
            keeper.ended(k, &draw);
            Ok(draw)
        };
        Ok(Sensitivity { draws: (0..draws).into_par_iter().map(one).collect::<Result<_, _>>()? })
    }
}

impl Sensitivity {
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
    (!sorted.is_empty()).then(|| order_quantile(&sorted, share.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CutterSide, Models, Parameters, PathError, Point, Trace};

    #[test]
    fn draws_depend_on_seed_and_number_alone_and_gains_spread() {
        let mut trace = Trace::new(Point::default(), 0.0);
        trace.lobed(0.1, 0.0035, 3, 18).unwrap();
        let hole = trace.finish(CutterSide::Left, true).unwrap();
        let models = Models { path_error: PathError::Empirical, ..Models::default() };
        let (parameters, pass, scatter) = (Parameters::default(), Pass::default(), ConditionScatter::default());
        let planner = Planner::new(&hole, &parameters, &pass, &models).unwrap();
        let draw = |draws, seed| planner.sensitivity(Objective::Time, &scatter, draws, seed, &()).unwrap();
        let many = draw(40, 7);
        assert_eq!(draw(5, 7).draws, many.draws[..5]);
        assert_ne!(draw(5, 8).draws, many.draws[..5]);
        // The override of 10 % makes the gain jump: from a few per cent to several tens.
        let (low, high) = (many.productivity_gain(0.1).unwrap(), many.productivity_gain(0.9).unwrap());
        assert!(low > 0.0 && high > low + 0.1, "{low} {high}");
        assert!(many.cost_change(0.5).unwrap() < 0.0);
        // A plan at the edge of the tolerance does not hold in half of the conditions.
        assert!((0.2..0.8).contains(&many.broken(Constraint::Accuracy)), "{}", many.broken(Constraint::Accuracy));
        assert_eq!(many.without_plan(), 0.0);
    }

    #[test]
    fn quantiles_interpolate() {
        let quantile_of = |share| quantile([3.0, 1.0, 2.0].into_iter(), share);
        assert_eq!((quantile_of(0.0), quantile_of(0.25), quantile_of(1.0)), (Some(1.0), Some(1.5), Some(3.0)));
        assert_eq!(quantile(std::iter::empty(), 0.5), None);
    }
}
