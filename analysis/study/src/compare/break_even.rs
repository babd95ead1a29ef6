//! Prices at which a decision turns.
//!
//! Prices enter the cost of a part in proportion to what is used up, so that the cost at another price follows from the same
//! replications without a new run: `Δ(p) = a + b·p`, which is zero at `p = −ā/b̄`. The settings of the policies are held:
//! tuned again at every price, the loser would lose less.
//!
//! # Source
//! E. C. Fieller, Journal of the Royal Statistical Society B 16 (1954) 175: the interval of a ratio of two means.

use crate::figure::plain;
use crate::study::Study;
use toolroom_process::unit::convert;
use toolroom_scenario::Scenario;
use toolroom_statistics::{Interval, student, t_interval};

/// Confidence of the interval of a price at which a decision turns.
const CONFIDENCE: f64 = 0.90;
/// Greatest factor on a price that is looked at: beyond, a price does not turn the decision (assumption).
const GREATEST: f64 = 20.0;
/// Factors on a price at which the difference is told beside the present one (assumption: a shop knows its prices to a
/// factor of two).
pub(crate) const SWING: [f64; 2] = [0.5, 2.0];
/// A kind of prices, all of which enter the cost of a part in proportion.
struct Price {
    /// Key in files.
    key: &'static str,
    /// What is paid for.
    title: &'static str,
    /// Figure of what is paid at them.
    figure: &'static str,
    /// All prices of the kind in a scenario, in the unit of files.
    of: fn(&Scenario) -> Vec<f64>,
    /// That unit without its currency.
    per: &'static str,
}

const PRICES: [Price; 3] = [
    Price {
        key: "edge_cost",
        title: "edges and dressings",
        figure: "edge_cost_per_part",
        of: |scenario| scenario.tools.iter().map(|tool| tool.edge_cost).collect(),
        per: "",
    },
    Price {
        key: "rate",
        title: "machine time",
        figure: "machine_cost_per_part",
        of: |scenario| scenario.machines.iter().map(|machine| convert(machine.rate, "1/s", "1/h")).collect(),
        per: "/h",
    },
    Price {
        key: "material_cost",
        title: "blanks",
        figure: "scrap_cost_per_part",
        of: |scenario| scenario.parts.iter().map(|part| part.material_cost).collect(),
        per: "",
    },
];

impl Price {
    /// The price with its unit, where it is the same wherever something is paid.
    fn now(&self, scenario: &Scenario) -> Option<(f64, String)> {
        let mut paid = (self.of)(scenario).into_iter().filter(|price| *price > 0.0);
        let first = paid.next()?;
        paid.all(|price| price == first).then(|| (first, format!("{}{}", scenario.currency, self.per)))
    }
}

/// Where `a + b·p` crosses zero on average.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// `−ā/b̄`; NaN where the means do not say.
    pub at: f64,
    /// Ends of its interval; `None` where it is unbounded, because `b̄` may be zero.
    pub interval: Option<(f64, f64)>,
}

impl Crossing {
    /// From pairs of replications.
    ///
    /// # Shape
    /// `a` and `b` of one length, in the order of replications; two pairs or more.
    ///
    /// # Examples
    /// ```
    /// use toolroom_study::compare::Crossing;
    /// let a = [-1.2, -0.8, -1.5, -0.6, -1.0, -1.3];
    /// let b = [0.05, 0.04, 0.06, 0.03, 0.05, 0.045];
    /// let crossing = Crossing::of(&a, &b, 0.90);
    /// assert!((crossing.at - 23.27273).abs() < 1e-5);
    /// let (low, high) = crossing.interval.unwrap();
    /// assert!((low - 20.12457).abs() < 1e-5 && (high - 26.01482).abs() < 1e-5);
    /// ```
    pub fn of(a: &[f64], b: &[f64], confidence: f64) -> Self {
        let pairs: Vec<(f64, f64)> =
            a.iter().copied().zip(b.iter().copied()).filter(|(a, b)| a.is_finite() && b.is_finite()).collect();
        let count = pairs.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
        let (mean_a, mean_b) = (mean(|pair| pair.0), mean(|pair| pair.1));
        let moment = |of: &dyn Fn(f64, f64) -> f64| {
            pairs.iter().map(|(a, b)| of(a - mean_a, b - mean_b)).sum::<f64>() / (count - 1.0) / count
        };
        let t2 = student(confidence, count - 1.0).powi(2);
        // (ā + p b̄)² ≤ t² Var(ā + p b̄), a parabola in p.
        let square = mean_b * mean_b - t2 * moment(&|_, b| b * b);
        let half = mean_a * mean_b - t2 * moment(&|a, b| a * b);
        let rest = mean_a * mean_a - t2 * moment(&|a, _| a * a);
        let root = (half * half - square * rest).sqrt();
        let interval = (square > 0.0 && root.is_finite()).then(|| ((-half - root) / square, (-half + root) / square));
        Self { at: -mean_a / mean_b, interval }
    }
}

/// How far a price is from turning a decision.
#[derive(Clone, Debug, PartialEq)]
pub struct BreakEven {
    /// Key of the price in files.
    pub key: &'static str,
    /// What is paid for.
    pub title: &'static str,
    /// The factor on all prices of this kind at which both policies cost the same; now 1.
    pub factor: Crossing,
    /// Difference of the cost of a part at half and at twice these prices, settings held, with its 90 % interval.
    pub swing: [Interval; 2],
    /// The price itself, where the scenario has one of this kind: what it is and the unit in which it is told.
    pub now: Option<(f64, String)>,
}

impl BreakEven {
    /// For two policies of a study, by position.
    pub fn all(scenario: &Scenario, study: &Study, one: usize, other: usize) -> Vec<Self> {
        let difference = |id: &str| -> Option<Vec<f64>> {
            let kpi = study.index(id)?;
            Some(study.samples(one, kpi).iter().zip(study.samples(other, kpi)).map(|(a, b)| a - b).collect())
        };
        let Some(whole) = difference("cost_per_part") else { return Vec::new() };
        let price = |price: &Price| {
            let part = difference(price.figure)?;
            let rest: Vec<f64> = whole.iter().zip(&part).map(|(whole, part)| whole - part).collect();
            let at = |factor: f64| {
                let whole: Vec<f64> = rest.iter().zip(&part).map(|(rest, part)| rest + factor * part).collect();
                t_interval(&whole, CONFIDENCE)
            };
            let (factor, swing) = (Crossing::of(&rest, &part, CONFIDENCE), SWING.map(at));
            Some(Self { key: price.key, title: price.title, factor, swing, now: price.now(scenario) })
        };
        if study.replications < 2 { Vec::new() } else { PRICES.iter().filter_map(price).collect() }
    }

    /// Whether a price of this kind turns the decision: a factor above zero that is not absurd.
    pub fn flips(&self) -> bool {
        self.factor.at > 0.0 && self.factor.at <= GREATEST
    }

    /// In words.
    pub fn describe(&self) -> String {
        let title = self.title;
        if !self.flips() {
            let up_to = self
                .now
                .as_ref()
                .map_or_else(String::new, |(now, unit)| format!(" ({} {unit})", plain(GREATEST * now, 2)));
            return format!("no price of {title} up to {GREATEST} times the present one{up_to} turns the difference");
        }
        let interval = match self.factor.interval {
            Some((low, high)) => format!("90 % {} … {}", plain(low, 2), plain(high, 2)),
            None => "90 % unbounded".to_owned(),
        };
        let price = self.now.as_ref().map_or_else(String::new, |(now, unit)| {
            format!(", {} {unit} in place of {}", plain(self.factor.at * now, 2), plain(*now, 2))
        });
        format!(
            "the difference turns where {title} cost {} times as much{price} ({interval})",
            plain(self.factor.at, 2)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_that_may_be_zero_has_no_bounded_interval() {
        let crossing = Crossing::of(&[1.0, 1.1, 0.9, 1.0], &[0.1, -0.2, 0.2, -0.05], 0.90);
        assert_eq!(crossing.interval, None);
    }

    #[test]
    fn a_price_that_always_favours_the_same_policy_turns_nothing() {
        let factor = Crossing::of(&[1.0, 1.1, 0.9], &[0.5, 0.6, 0.4], 0.90);
        let swing = SWING.map(|factor| t_interval(&[1.0 + 0.5 * factor, 1.1 + 0.6 * factor], CONFIDENCE));
        let price = BreakEven { key: "edge_cost", title: "edges", factor, swing, now: Some((8.0, "EUR".to_owned())) };
        assert!(!price.flips() && price.describe().starts_with("no price of edges"));
        assert!(price.describe().contains("(160.00 EUR)"), "{}", price.describe());
    }
}
