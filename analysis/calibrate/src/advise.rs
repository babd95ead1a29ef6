//! What to measure next, by what it is worth to a decision between two speeds.
//!
//! Parameters that matter to no decision need not be known: tests are ranked by how much they narrow the difference of
//! cost between the two speeds.

use crate::base::Condition;
use crate::calibration::Calibration;
use crate::model::Model;
use crate::parameter::Parameter;
use crate::sample::Posterior;
use crate::wear_model::{EDGE_SCATTER, READING_NOISE, WearModel};
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{Continuous, ContinuousCDF, Normal};
use toolroom_chart::Table;
use toolroom_chart::page::Section;

/// Step of the differences by a working coordinate.
const STEP: f64 = 1e-4;
/// Speeds that are looked at between the ends of what may be tested.
const SPEEDS: usize = 9;
/// Factor beyond the tested speeds that a test may go (assumption: further out another cause may end an edge).
const BEYOND: f64 = 1.4;
/// Numbers of edges of a test.
const EDGES: [usize; 3] = [1, 2, 4];
/// Readings of an edge of a test.
const READINGS: f64 = 5.0;
/// Least share by which a test has to narrow the decision to be listed.
const NARROWS: f64 = 0.01;
/// Tests that are listed.
const LISTED: usize = 3;
/// Path in km within which a test has to pay for itself (assumption: a machine that cuts at 200 m/min for 4000 h a year).
const WITHIN: f64 = 50_000.0;
/// m of a km.
const KM: f64 = 1e3;

/// What cutting costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs {
    /// Machine and operator, currency per minute.
    pub machine: f64,
    /// Changing an edge, min.
    pub change: f64,
    /// An edge, currency.
    pub edge: f64,
}

impl Costs {
    /// Cost of a km of cutting path at a speed in m/min with edges that last so many min: of the machine while it cuts and
    /// while edges are changed, and of the edges. Parts, queues and scrap are left out.
    ///
    /// # Examples
    /// ```
    /// let costs = toolroom_calibrate::Costs { machine: 1.0, change: 1.0, edge: 2.5 };
    /// // Taylor, 60 min at 222 m/min, p = 5: least at a life of (p - 1)·3.5 = 14 min.
    /// let cost = |v: f64| costs.per_km(v, 60.0 * (v / 222.0_f64).powi(-5));
    /// assert!(cost(297.0008) < cost(296.0) && cost(297.0008) < cost(298.0));
    /// ```
    pub fn per_km(&self, speed: f64, life: f64) -> f64 {
        KM * self.machine / speed * (1.0 + (self.change + self.edge / self.machine) / life)
    }

    /// Price of an edge at which a km costs the same at two speeds in m/min with lives in min; `None` where no price above zero
    /// does.
    ///
    /// # Examples
    /// ```
    /// let costs = toolroom_calibrate::Costs { machine: 1.0, change: 1.0, edge: 2.5 };
    /// let at = |v: f64| (v, 60.0 * (v / 222.0_f64).powi(-5));
    /// assert!((costs.price_of_equal([at(222.0), at(297.0)]).unwrap() - 5.876_362).abs() < 1e-5);
    /// assert_eq!(costs.price_of_equal([at(222.0), at(222.0)]), None);
    /// ```
    pub fn price_of_equal(&self, at: [(f64, f64); 2]) -> Option<f64> {
        let [time, edges] = [
            at.map(|(speed, life)| self.machine / speed * (1.0 + self.change / life)),
            at.map(|(speed, life)| 1.0 / (speed * life)),
        ];
        Some((time[0] - time[1]) / (edges[1] - edges[0])).filter(|price| price.is_finite() && *price > 0.0)
    }
}

/// Standard deviation of a decision before and after observations.
///
/// `covariance` is that of the parameters, `gradient` of the decision by them; each observation has its row of derivatives and its
/// variance. All is to first order.
///
/// # Examples
/// ```
/// use nalgebra::{DMatrix, DVector};
/// use toolroom_calibrate::deviation_after;
/// // ln T = ln T_r - p·ln(v/222), cost at 250 less cost at 300 m/min, one edge with a scatter of 0.25.
/// let prior = DMatrix::from_row_slice(2, 2, &[0.04, 0.06, 0.06, 1.0]);
/// let life = |v: f64| 60.0 * (v / 222.0_f64).powi(-5);
/// let by_life = |v: f64| 1000.0 / v * 3.5 / life(v); // minus the derivative of a cost by ln T
/// let gradient = DVector::from_vec(vec![
///     by_life(300.0) - by_life(250.0),
///     by_life(250.0) * (250.0_f64 / 222.0).ln() - by_life(300.0) * (300.0_f64 / 222.0).ln(),
/// ]);
/// assert!((deviation_after(&prior, &gradient, &[]) - 0.205_545_7).abs() < 1e-6);
/// for (speed, after) in [(160.0, 0.172_566_7), (260.0, 0.176_344_3), (340.0, 0.106_744_8)] {
///     let row = DVector::from_vec(vec![1.0, -(speed / 222.0_f64).ln()]);
///     assert!((deviation_after(&prior, &gradient, &[(row, 0.0625)]) - after).abs() < 1e-6);
/// }
/// ```
pub fn deviation_after(covariance: &DMatrix<f64>, gradient: &DVector<f64>, observed: &[(DVector<f64>, f64)]) -> f64 {
    let mut left = covariance.clone();
    for (row, variance) in observed {
        let gain = &left * row;
        let total = variance + row.dot(&gain);
        left -= &gain * gain.transpose() / total;
    }
    gradient.dot(&(&left * gradient)).max(0.0).sqrt()
}

/// A test of new edges until they are worn out.
#[derive(Clone, Debug, PartialEq)]
pub struct Test {
    /// What the edges meet.
    pub condition: Condition,
    /// How many.
    pub edges: usize,
    /// Time in cut, min.
    pub minutes: f64,
    /// Machine time, changes and edges, currency.
    pub cost: f64,
    /// Standard deviation of the difference of cost after the test, currency per km.
    pub deviation_after: f64,
    /// What the test is worth, currency per km that will be cut (expected value of sample information).
    pub worth: f64,
    /// Standard deviation of the parameter of [`Advice::parameter`] after the test, in its working coordinate.
    pub parameter_after: f64,
}

impl Test {
    /// Path in km from which on the test pays for itself; infinite where it is worth nothing.
    pub fn pays_from(&self) -> f64 {
        if self.worth > 0.0 { self.cost / self.worth } else { f64::INFINITY }
    }
}

/// A decision between two speeds, and the tests that would tell more.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// The two conditions.
    pub between: [Condition; 2],
    /// Whether both lie within the speeds that were cut.
    pub tested: bool,
    /// Lives there at the most probable parameters, min.
    pub lives: [f64; 2],
    /// Cost of the first less that of the second, currency per km, mean over the draws.
    pub difference: f64,
    /// Its standard deviation over the draws.
    pub deviation: f64,
    /// Share of the draws under which the second costs less.
    pub second_better: f64,
    /// Expected value of perfect information, currency per km.
    pub perfect: f64,
    /// The best tests, by what they are worth against what they cost.
    pub tests: Vec<Test>,
    /// Price of an edge at which both cost the same at the most probable parameters; `None` where none does.
    pub equal_at: Option<f64>,
    /// Index of the least known parameter that speeds determine, with the test that tells most of it for each unit of cost.
    pub parameter: Option<(usize, Test)>,
}

/// What is gained by deciding after the deviation has shrunk from `previous` to `after`, with the mean difference `mean`.
fn worth(mean: f64, previous: f64, after: f64) -> f64 {
    let spread = (previous * previous - after * after).max(0.0).sqrt();
    let normal = Normal::standard();
    if spread == 0.0 {
        return 0.0;
    }
    let z = mean.abs() / spread;
    spread * normal.pdf(z) - mean.abs() * normal.cdf(-z)
}

impl Calibration {
    /// The decision between two conditions, and what to measure next for it. `range` holds the speeds in m/s that may be tested.
    pub fn advise(&self, costs: &Costs, between: [Condition; 2], range: (f64, f64)) -> Advice {
        let (model, posterior) = (&self.carried().model, &self.posterior);
        let parameters = model.parameters();
        let difference = |u: &[f64]| {
            let [a, b] = between.map(|at| costs.per_km(at.cut.cutting_speed * 60.0, model.life(u, at)));
            a - b
        };
        let map = &posterior.map.u;
        let differences: Vec<f64> = posterior.draws.iter().map(|draw| difference(draw.as_slice())).collect();
        let count = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / count;
        let deviation = (differences.iter().map(|own| (own - mean).powi(2)).sum::<f64>() / count).sqrt();
        let second_better = differences.iter().filter(|own| **own > 0.0).count() as f64 / count;
        // What the better of the two saves in each case, against the one that is better on average.
        let perfect = differences.iter().map(|own| own.max(0.0)).sum::<f64>() / count - mean.max(0.0);
        let gradient = derivative(map, parameters, &difference);
        let tests = self.tests(costs, &between[1], range, &gradient, mean);
        let now = deviation_now(posterior, &gradient);
        let pays = |test: &&Test| test.deviation_after < (1.0 - NARROWS) * now && test.pays_from() <= WITHIN;
        let mut ranked: Vec<Test> = tests.iter().filter(pays).cloned().collect();
        ranked.sort_by(|a, b| a.pays_from().total_cmp(&b.pays_from()));
        ranked.truncate(LISTED);
        let place = self.least_known();
        let parameter = place.and_then(|place| {
            let now = posterior.deviation(place);
            let gain = |test: &Test| (now - test.parameter_after) / test.cost;
            tests.into_iter().max_by(|a, b| gain(a).total_cmp(&gain(b))).map(|test| (place, test))
        });
        let lives = between.map(|at| model.life(map.as_slice(), at));
        let speeds = self.measured.speeds();
        let within = |speed: f64| {
            let slower = speeds.iter().any(|own| *own <= speed * 1.001);
            slower && speeds.iter().any(|own| *own >= speed * 0.999)
        };
        let tested = between.iter().all(|at| within(at.cut.cutting_speed * 60.0));
        let place = |which: usize| (between[which].cut.cutting_speed * 60.0, lives[which]);
        Advice {
            between,
            tested,
            lives,
            difference: mean,
            deviation,
            second_better,
            perfect,
            tests: ranked,
            equal_at: costs.price_of_equal([place(0), place(1)]),
            parameter,
        }
    }

    /// Index of the parameter that other speeds would tell and of which most of the prior is left.
    fn least_known(&self) -> Option<usize> {
        let parameters = self.carried().model.parameters();
        let by_speed = (0..parameters.len()).filter(|place| parameters[*place].lift.starts_with("vary cutting_speed"));
        let shrink = &self.identifiability.shrink;
        by_speed.max_by(|a, b| shrink[*a].total_cmp(&shrink[*b]))
    }

    fn tests(&self, costs: &Costs, at: &Condition, range: (f64, f64), gradient: &DVector<f64>, mean: f64) -> Vec<Test> {
        let (model, posterior) = (&self.carried().model, &self.posterior);
        let parameters = model.parameters();
        let (map, covariance) = (&posterior.map.u, &posterior.covariance);
        let speeds = self.measured.speeds();
        let (slow, fast) =
            speeds.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), speed| (a.min(speed / 60.0), b.max(speed / 60.0)));
        let (low, high) = ((slow / BEYOND).max(range.0), (fast * BEYOND).min(range.1));
        if low >= high {
            return Vec::new();
        }
        let now = deviation_now(posterior, gradient);
        // What an edge tells is averaged over what is known of the scatter: at the maximum of a skewed density it is too small.
        let mean_square = |name: &str| {
            let place = parameters.iter().position(|parameter| parameter.name == name)?;
            let squares = posterior.draws.iter().map(|draw| (2.0 * draw[place]).exp());
            Some(squares.sum::<f64>() / posterior.draws.len() as f64)
        };
        let scatter = mean_square(EDGE_SCATTER).unwrap_or(0.0);
        let noise = mean_square(READING_NOISE).unwrap_or(0.0) / self.request.limit.powi(2);
        let least_known =
            self.least_known().map(|place| DVector::from_fn(map.len(), |i, _| f64::from(u8::from(i == place))));
        let mut tests = Vec::new();
        for step in 0..SPEEDS {
            let speed = low * (high / low).powf(step as f64 / (SPEEDS - 1) as f64);
            let condition = at.at_speed(speed);
            let life = model.life(map.as_slice(), condition);
            let row = derivative(map, parameters, &|u| model.life(u, condition).ln());
            // Readings on one edge share its level: more of them never tell more than the level allows.
            let variance = scatter + noise / READINGS;
            for edges in EDGES {
                let observed = vec![(row.clone(), variance); edges];
                let after = deviation_after(covariance, gradient, &observed);
                let minutes = edges as f64 * life;
                tests.push(Test {
                    condition,
                    edges,
                    minutes,
                    cost: costs.machine * (minutes + edges as f64 * costs.change) + edges as f64 * costs.edge,
                    deviation_after: after,
                    worth: worth(mean, now, after),
                    parameter_after: least_known
                        .as_ref()
                        .map_or(f64::NAN, |least_known| deviation_after(covariance, least_known, &observed)),
                });
            }
        }
        tests
    }

    /// The speed in m/s within a range at which a km of path costs least at the most probable parameters.
    pub fn cheapest(&self, costs: &Costs, condition: &Condition, range: (f64, f64)) -> f64 {
        let (model, u) = (&self.carried().model, self.posterior.map.u.as_slice());
        let (low, high) = range;
        let speeds = (0..=200).map(|step| low * (high / low).powf(f64::from(step) / 200.0));
        let cost = |speed: &f64| costs.per_km(speed * 60.0, model.life(u, condition.at_speed(*speed)));
        speeds.min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(low)
    }
}

fn deviation_now(posterior: &Posterior, gradient: &DVector<f64>) -> f64 {
    deviation_after(&posterior.covariance, gradient, &[])
}

/// Derivatives by the working coordinates, by central differences.
fn derivative(at: &DVector<f64>, parameters: &[Parameter], of: &dyn Fn(&[f64]) -> f64) -> DVector<f64> {
    let mut u = at.clone();
    DVector::from_fn(at.len(), |place, _| {
        let step = STEP * parameters[place].prior.deviation;
        u[place] = at[place] + step;
        let above = of(u.as_slice());
        u[place] = at[place] - step;
        let below = of(u.as_slice());
        u[place] = at[place];
        (above - below) / (2.0 * step)
    })
}

impl Advice {
    /// The decision and the tests for people.
    pub fn text(&self, model: &WearModel) -> String {
        use std::fmt::Write as _;
        let [a, b] = self.between.map(|at| at.cut.cutting_speed * 60.0);
        let (better, share) =
            if self.difference > 0.0 { (b, self.second_better) } else { (a, 1.0 - self.second_better) };
        let beyond = if self.tested { "" } else { "; not both within the tested speeds" };
        let mut text = format!(
            "\ndecision between {a:.0} and {b:.0} m/min (edges last {:.1} and {:.1} min{beyond}): {better:.0} m/min costs {:.3} less a km \
             of path (± {:.3}), in {:.0} % of what your data allow; to know for certain is worth {:.4} a km\n",
            self.lives[0],
            self.lives[1],
            self.difference.abs(),
            self.deviation,
            100.0 * share,
            self.perfect
        );
        if let Some(price) = self.equal_at {
            let _ = writeln!(text, "both cost the same where an edge costs {price:.2}");
        }
        for (place, test) in self.tests.iter().enumerate() {
            let _ = writeln!(
                text,
                "next test {}: {} at {:.0} m/min until worn ({:.0} min, costs {:.2}): leaves ± {:.3}, worth {:.4} a km, pays \
                 from {:.0} km of path",
                place + 1,
                edges(test.edges),
                test.condition.cut.cutting_speed * 60.0,
                test.minutes,
                test.cost,
                test.deviation_after,
                test.worth,
                test.pays_from()
            );
        }
        if self.tests.is_empty() {
            let _ =
                writeln!(text, "no test of new edges pays for itself within {WITHIN} km of path: do not test, decide");
        }
        if let (Some((place, test)), Some(first)) = (&self.parameter, self.tests.first()) {
            let (speed, other) = (test.condition.cut.cutting_speed, first.condition.cut.cutting_speed);
            if (speed / other - 1.0).abs() > 0.02 {
                let name = &model.parameters()[*place].name;
                let _ = writeln!(
                    text,
                    "{name} alone is determined best at {:.0} m/min, but the decision needs another test",
                    speed * 60.0
                );
            }
        }
        text
    }

    /// The tests as a section of a report.
    pub fn section(&self, model: &WearModel) -> Section {
        let mut table = Table::new([
            "test",
            "speed, m/min",
            "minutes",
            "costs",
            "deviation before",
            "deviation after",
            "worth a km",
            "pays from km",
        ]);
        for test in &self.tests {
            table.push([
                edges(test.edges).into(),
                (test.condition.cut.cutting_speed * 60.0).into(),
                test.minutes.into(),
                test.cost.into(),
                self.deviation.into(),
                test.deviation_after.into(),
                test.worth.into(),
                test.pays_from().into(),
            ]);
        }
        let mut section = Section::new("What to measure next");
        let text = self.text(model);
        for line in text.trim().lines().filter(|line| !line.starts_with("next test")) {
            let (first, rest) = line.split_at(line.chars().next().map_or(0, char::len_utf8));
            section = section.paragraph(format!("{}{rest}.", first.to_uppercase()));
        }
        if self.tests.is_empty() {
            return section;
        }
        section.table(
            "Tests of new edges, those first that pay for themselves soonest; costs are those of the scenario.",
            table,
        )
    }

    /// The tests for programs.
    pub fn json(&self, model: &WearModel) -> serde_json::Value {
        let speed = |condition: &Condition| condition.cut.cutting_speed * 60.0;
        let test = |test: &Test| {
            serde_json::json!({
                "cutting_speed [m/min]": speed(&test.condition), "edges": test.edges, "minutes": test.minutes,
                "cost": test.cost, "sd_decision_before": self.deviation, "sd_decision_after": test.deviation_after,
                "worth_per_km": test.worth, "pays_from_km": Some(test.pays_from()).filter(|km| km.is_finite()),
            })
        };
        let parameter = self.parameter.as_ref().map(|(place, own)| {
            let mut value = test(own);
            value["parameter"] = serde_json::json!(model.parameters()[*place].name);
            value["sd_parameter_after"] = serde_json::json!(own.parameter_after);
            value
        });
        serde_json::json!({
            "between [m/min]": self.between.each_ref().map(speed), "life [min]": self.lives, "tested": self.tested,
            "difference_per_km": self.difference, "sd": self.deviation, "second_better": self.second_better,
            "evpi_per_km": self.perfect, "edge_cost_of_equal": self.equal_at, "next_experiment": self.tests.iter().map(test).collect::<Vec<_>>(),
            "best_for_parameter": parameter,
        })
    }
}

fn edges(count: usize) -> String {
    if count == 1 { "one edge".to_owned() } else { format!("{count} edges") }
}
