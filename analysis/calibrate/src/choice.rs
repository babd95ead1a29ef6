//! Which wear law the data speak for, if any.

use crate::law::Law;
use crate::left_out::LeftOut;
use crate::normal::ln_sum;
use crate::shape::Candidate;

/// Least margin in logarithms of predictive density that names a law: below four the normal standard error of a difference
/// is not reliable (Sivula, Magnusson, Vehtari, arXiv 2008.10296).
const MARGIN: f64 = 4.0;
/// Standard errors that a margin has to exceed, the normal quantile of 95 %.
const ERRORS: f64 = 1.645;
/// Ratio of two cutting speeds that count as two. A law is chosen to predict at other speeds, and readings at one speed
/// would choose it by the shape of the wear curve.
const APART: f64 = 1.2;
/// Edges below which the differences edge by edge have no standard error worth the name (assumption: two degrees of freedom).
const FEWEST: usize = 3;

/// What the left-out scores say of the laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// One law predicts edges left out clearly better than every other.
    Chosen,
    /// Several laws are within the margin, or the design cannot tell them apart.
    CannotTell,
    /// A single law was considered.
    Given,
}

impl Verdict {
    /// Word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Chosen => "chosen",
            Self::CannotTell => "cannot_tell",
            Self::Given => "given",
        }
    }
}

/// A law with its score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// The law and its shape.
    pub candidate: Candidate,
    /// Sum over edges of the log predictive density of an edge left out.
    pub elpd: f64,
    /// How far the law is behind the best.
    pub margin: f64,
    /// Standard error of that margin, √(n·variance) of the differences edge by edge.
    pub error: f64,
    /// Weight of the law in the best mixture of predictions (stacking).
    pub weight: f64,
}

/// The choice between laws.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The verdict.
    pub verdict: Verdict,
    /// The law that the parameter set carries: the best one, or the simplest of those that cannot be told apart.
    pub carried: Candidate,
    /// Laws that cannot be told from the best, the best first.
    pub class: Vec<Candidate>,
    /// Scores, the best first.
    pub scores: Vec<Score>,
    /// Why no law is named although the scores differ.
    pub reason: Option<String>,
}

impl Choice {
    /// The choice by predictions of edges left out, the same edges under each law; `speeds` are the cutting speeds of
    /// the data in any unit.
    ///
    /// # Panics
    /// Without any law.
    pub fn of<C: Copy + Into<Candidate>>(candidates: &[(C, Vec<LeftOut>)], speeds: &[f64]) -> Self {
        let named = |index: usize| -> Candidate { candidates[index].0.into() };
        let sum = |left: &[LeftOut]| left.iter().map(|edge| edge.score).sum::<f64>();
        let mut order: Vec<usize> = (0..candidates.len()).collect();
        order.sort_by(|a, b| sum(&candidates[*b].1).total_cmp(&sum(&candidates[*a].1)));
        let best = &candidates[order[0]].1;
        let weights = stacking(candidates);
        let score = |index: &usize| {
            let left = &candidates[*index].1;
            let differences: Vec<f64> = best.iter().zip(left).map(|(best, left)| best.score - left.score).collect();
            let count = differences.len() as f64;
            let margin = differences.iter().sum::<f64>();
            let squares = differences.iter().map(|difference| (difference - margin / count).powi(2)).sum::<f64>();
            let error = squares.sqrt();
            Score { candidate: named(*index), elpd: sum(left), margin, error, weight: weights[*index] }
        };
        let scores: Vec<Score> = order.iter().map(score).collect();
        let within = |score: &&Score| score.margin <= MARGIN.max(ERRORS * score.error);
        let class: Vec<Candidate> = scores.iter().filter(within).map(|score| score.candidate).collect();
        let (low, high) = speeds.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), speed| (a.min(*speed), b.max(*speed)));
        let simplest = |class: &[Candidate]| {
            let place =
                |candidate: &&Candidate| (Law::ALL.iter().position(|law| *law == candidate.law), candidate.shape);
            class.iter().min_by_key(place).copied().unwrap_or(class[0])
        };
        // Laws differ in what they say of other speeds; shapes of one law do not.
        let laws = scores.iter().any(|score| score.candidate.law != scores[0].candidate.law);
        if candidates.len() == 1 {
            return Self { verdict: Verdict::Given, carried: named(0), class, scores, reason: None };
        }
        if best.len() < FEWEST {
            let carried = simplest(&class);
            let reason =
                format!("{} edge(s) do not tell how far scores differ by chance: measure {FEWEST} or more", best.len());
            return Self { verdict: Verdict::CannotTell, carried, class, scores, reason: Some(reason) };
        }
        if laws && high < APART * low {
            let carried = simplest(&class);
            let reason = format!(
                "there are no two cutting speeds a factor of {APART} apart: measure edges at a second speed; until then the shape \
                 of the wear curve would choose a law that is needed for other speeds"
            );
            return Self { verdict: Verdict::CannotTell, carried, class, scores, reason: Some(reason) };
        }
        let verdict = if class.len() == 1 { Verdict::Chosen } else { Verdict::CannotTell };
        Self { verdict, carried: simplest(&class), class, scores, reason: None }
    }

    /// The choice where no edge was read near the limit (mm): Taylor's law gives the time to the limit and has its wear curve
    /// scaled by it, other laws give a rate of wear and know no limit, so that a limit that is not that of the edges would choose.
    pub(crate) fn short_of_limit(self, greatest: f64, limit: f64) -> Self {
        let has = |taylor: bool| self.scores.iter().any(|score| (score.candidate.law == Law::ExtendedTaylor) == taylor);
        if self.verdict != Verdict::Chosen || !(has(true) && has(false)) {
            return self;
        }
        let reason = format!(
            "wear was read up to {greatest:.3} mm and the limit is {limit:.3} mm, by which Taylor's law scales its curve: give the limit at \
             which edges are changed (--limit), or name the law (--law)"
        );
        Self { verdict: Verdict::CannotTell, reason: Some(reason), ..self }
    }
}

/// Weights of the mixture of predictions that has the best left-out score (Yao et al., Bayesian Analysis 13 (2018) 917), by
/// the expectation-maximisation step.
fn stacking<C>(candidates: &[(C, Vec<LeftOut>)]) -> Vec<f64> {
    let laws = candidates.len();
    let mut weights = vec![1.0 / laws as f64; laws];
    for _ in 0..500 {
        let mut next = vec![0.0; laws];
        for edge in 0..candidates[0].1.len() {
            let terms: Vec<f64> =
                candidates.iter().zip(&weights).map(|((_, left), weight)| weight.ln() + left[edge].score).collect();
            let sum = ln_sum(&terms);
            next.iter_mut().zip(&terms).for_each(|(next, term)| *next += (term - sum).exp());
        }
        let edges: f64 = next.iter().sum();
        weights = next.iter().map(|next| next / edges).collect();
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left(scores: &[f64]) -> Vec<LeftOut> {
        scores.iter().map(|score| LeftOut { score: *score, ranks: Vec::new(), bands: Vec::new() }).collect()
    }

    #[test]
    fn a_law_is_named_only_with_a_clear_margin_and_two_speeds() {
        let clear = [(Law::Usui, left(&[1.0, 2.0, 1.5])), (Law::ExtendedTaylor, left(&[4.0, 5.2, 4.4]))];
        let choice = Choice::of(&clear, &[180.0, 320.0]);
        assert_eq!((choice.verdict, choice.carried.law), (Verdict::Chosen, Law::ExtendedTaylor));
        assert!((choice.scores[1].margin - 9.1).abs() < 1e-12 && choice.scores[0].weight > 0.9);
        let slow = Choice::of(&clear, &[200.0, 220.0]);
        assert_eq!((slow.verdict, slow.class.len()), (Verdict::CannotTell, 1));
        assert!(slow.reason.is_some());
        // What is extrapolated to a limit that may be another one chooses between laws that scale by it and others only.
        let short = Choice::of(&clear, &[180.0, 320.0]).short_of_limit(0.3, 0.8);
        assert_eq!(short.verdict, Verdict::CannotTell);
        assert!(short.reason.is_some_and(|reason| reason.contains("--limit")));
        let rates = [(Law::Usui, left(&[1.0, 2.0, 1.5])), (Law::TakeyamaMurata, left(&[4.0, 5.2, 4.4]))];
        assert_eq!(Choice::of(&rates, &[180.0, 320.0]).short_of_limit(0.3, 0.8).verdict, Verdict::Chosen);
        let close = [(Law::Usui, left(&[1.0, 2.0, 1.5])), (Law::ExtendedTaylor, left(&[2.0, 3.0, 2.4]))];
        let choice = Choice::of(&close, &[180.0, 320.0]);
        assert_eq!((choice.verdict, choice.carried.law), (Verdict::CannotTell, Law::Usui));
        assert_eq!(Choice::of(&clear[..1], &[180.0]).verdict, Verdict::Given);
    }
}
