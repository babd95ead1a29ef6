//! Dynamic programming over the sections.

use crate::plan::Extras;
use crate::wall::Candidate;
use crate::{ContourError, Plan, Planner, Setting};

/// What a plan makes least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Objective {
    /// Operative time, ties by cost.
    Time,
    /// Cost of time and edges, ties by time.
    Cost,
    /// `(1 − cost_share)·time + cost_share·cost/machine_rate`.
    Weighted {
        /// Weight of the cost, 0 to 1.
        cost_share: f64,
    },
}

/// Weight of the other criterion in ties.
const TIE: f64 = 1e-9;

/// Weights of time and of cost in machine time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Weights {
    time: f64,
    cost: f64,
    /// Price of an edge in machine time, s.
    edge: f64,
}

impl Weights {
    /// Value of a second that uses no edge.
    pub fn second(&self) -> f64 {
        self.time + self.cost
    }

    /// Value of a second whose cost something else contains.
    pub fn time_only(&self) -> f64 {
        self.time
    }

    /// Value of an edge life.
    pub fn edge(&self) -> f64 {
        self.cost * self.edge
    }

    /// Value of a candidate per length of centre path.
    pub fn value(&self, candidate: &Candidate) -> f64 {
        self.second() * candidate.time + self.edge() * candidate.life
    }
}

impl Objective {
    pub(crate) fn weights(self, planner: &Planner) -> Weights {
        let economics = &planner.parameters.economics;
        let (time, cost) = match self {
            Self::Time => (1.0, TIE),
            Self::Cost => (TIE, 1.0),
            Self::Weighted { cost_share } => (1.0 - cost_share, cost_share),
        };
        Weights { time, cost, edge: economics.edge_price() / economics.machine_rate }
    }
}

impl Planner<'_> {
    /// The best plan: a spindle speed and a feed for every section, changes of spindle speed
    /// counted with their time.
    ///
    /// `W_i(n) = min_f c_i(n, f) + min(W_{i−1}(n), min_n' W_{i−1}(n') + τ)` over the gears n and
    /// the admissible feeds f.
    ///
    /// # Errors
    /// [`ContourError::EmptyFeasibleSet`] for the first section on which nothing is admissible,
    /// with the constraints that conflict there.
    ///
    /// # Source
    /// Lukin, eq. (17). There the sections are independent; the time of a speed change couples
    /// them here.
    pub fn optimal(&self, objective: Objective) -> Result<Plan, ContourError> {
        let weights = objective.weights(self);
        let gears = self.speeds.len();
        let best = self.best_of_walls(&weights);
        let switch = weights.second() * self.parameters.machine.speed_change_time;
        let mut value = vec![0.0; gears];
        let mut from: Vec<Vec<usize>> = Vec::with_capacity(self.len());
        for i in 0..self.len() {
            let (changed, least) = least(&value);
            let row: Vec<usize> =
                (0..gears).map(|gear| if i == 0 || value[gear] <= least + switch { gear } else { changed }).collect();
            let entered: Vec<f64> =
                (0..gears).map(|gear| if row[gear] == gear { value[gear] } else { least + switch }).collect();
            for gear in 0..gears {
                let section = best[self.wall_of(i)][gear].map_or(f64::INFINITY, |(value, _)| value);
                value[gear] = entered[gear] + section * self.centre_length(i);
            }
            if value.iter().all(|value| value.is_infinite()) {
                return Err(self.empty_set(i));
            }
            from.push(row);
        }
        let (mut gear, _) = least(&value);
        let mut settings = Vec::with_capacity(self.len());
        for i in (0..self.len()).rev() {
            let feed = best[self.wall_of(i)][gear].map_or(0, |(_, feed)| feed);
            settings.push(self.setting(gear, feed));
            gear = from[i][gear];
        }
        settings.reverse();
        Ok(self.assemble(&settings, Extras::default()))
    }

    /// For every wall and gear the best value per length and its feed.
    fn best_of_walls(&self, weights: &Weights) -> Vec<Vec<Option<(f64, usize)>>> {
        let best = |wall: usize, gear: usize| {
            let mut best: Option<(f64, usize)> = None;
            for candidate in self.efficient(wall, gear) {
                let value = weights.value(&candidate);
                if best.is_none_or(|(least, _)| value < least) {
                    best = Some((value, candidate.feed));
                }
            }
            best
        };
        (0..self.wall_count()).map(|wall| (0..self.speeds.len()).map(|gear| best(wall, gear)).collect()).collect()
    }

    pub(crate) fn setting(&self, gear: usize, feed: usize) -> Setting {
        Setting { spindle_speed: self.speeds[gear], feed_per_tooth: self.feeds[feed] }
    }

    /// Plans on the convex hull of what time and cost can be had together, fastest first.
    ///
    /// # Errors
    /// As [`Planner::optimal`].
    pub fn pareto(&self) -> Result<Vec<Plan>, ContourError> {
        let fastest = self.optimal(Objective::Time)?;
        let cheapest = self.optimal(Objective::Cost)?;
        let mut plans = vec![fastest];
        self.between(&plans[0].clone(), &cheapest, &mut plans)?;
        if cheapest.time > plans[plans.len() - 1].time {
            plans.push(cheapest);
        }
        Ok(plans)
    }

    /// The supported plans strictly between two of them (Aneja & Nair 1979): the weights under
    /// which both are equal either find a better one or prove that there is none.
    fn between(&self, fast: &Plan, cheap: &Plan, plans: &mut Vec<Plan>) -> Result<(), ContourError> {
        let rate = self.parameters.economics.machine_rate;
        let (slower, saved) = (cheap.time - fast.time, (fast.cost - cheap.cost) / rate);
        if slower <= 0.0 || saved <= 0.0 {
            return Ok(());
        }
        let cost_share = slower / (slower + saved);
        let middle = self.optimal(Objective::Weighted { cost_share })?;
        let value = |plan: &Plan| (1.0 - cost_share) * plan.time + cost_share * plan.cost / rate;
        if value(&middle) < value(fast) * (1.0 - 1e-9) {
            self.between(fast, &middle, plans)?;
            plans.push(middle.clone());
            self.between(&middle, cheap, plans)?;
        }
        Ok(())
    }
}

/// Index and value of the least, the first of equals.
fn least(values: &[f64]) -> (usize, f64) {
    let mut best = (0, f64::INFINITY);
    for (i, value) in values.iter().enumerate() {
        if *value < best.1 {
            best = (i, *value);
        }
    }
    best
}
