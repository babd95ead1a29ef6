//! How well constants of one kind are known, as the records show it.
//!
//! A file says of each programmed time that it may be off by five per cent. In a shop whose programs and machines all
//! keep their times to within a thousandth, five constants that are off by the same fifteen per cent are no chance: each is
//! within what was believed of it, all of them together are one cause. So constants of one kind share a factor on their
//! prior standard deviation, which follows from the marginal likelihood beside the effects that the data ask for most. Where
//! constants do scatter as was believed, or few of them were seen, the factor stays one and nothing changes.
//!
//! # Source
//! Hierarchical scale by marginal likelihood (empirical Bayes): Gelman et al., Bayesian Data Analysis, 3rd ed. 2013, ch. 5.

use super::basis::CANDIDATE_PRECISION;
use super::constants::{NARROWER, SCALES_OF_CONSTANTS};
use super::fit::offset_residual;
use super::gram::{factor, normal_equations, part};
use super::reframed::Reframed;
use super::{Basis, Fit, Forward};
use nalgebra::DMatrix;

/// Effects beside which the scale of constants is judged (count). Assumption: more causes at a time are rare, and each
/// would take what a constant may have moved.
const BESIDE: usize = 3;
/// Rounds through the families: each scale is chosen beside those of the others.
const ROUNDS: usize = 2;

/// A model whose constants are known better than was believed.
pub(super) struct Narrowed<'a> {
    /// The model with the smaller standard deviations.
    pub model: Reframed<'a>,
    /// Families with their factor.
    found: Vec<(&'static str, f64)>,
}

impl<'a> Narrowed<'a> {
    /// `model` with the spread of its constants as the records show it about the nominal fit `fit`, whose derivatives are
    /// those by all candidates; `None` where that is what was believed.
    pub fn new(model: &'a dyn Forward, basis: &Basis, fit: &Fit) -> Option<Self> {
        let frame = model.frame();
        let place = |name: &String| frame.surfaces.iter().position(|surface| surface.name == *name);
        let families: Vec<Vec<usize>> =
            frame.families.iter().map(|family| family.surfaces.iter().filter_map(place).collect()).collect();
        if families.iter().all(|family| family.len() < 2) {
            return None;
        }
        let tried = Tried::new(model, basis, fit, &families);
        let scales = tried.best()?;
        let mut frame = frame.clone();
        let mut found = Vec::new();
        for ((surfaces, scale), family) in families.iter().zip(scales).zip(&model.frame().families) {
            if scale < 1.0 {
                surfaces.iter().for_each(|surface| frame.surfaces[*surface].deviation *= scale);
                found.push((family.name, scale));
            }
        }
        Some(Self { model: Reframed { model, frame }, found })
    }

    /// What a reader has to know of it.
    pub fn note(&self) -> String {
        let words = |(name, scale): &(&str, f64)| format!("{name} {scale:.1}");
        let all: Vec<String> = self.found.iter().map(words).collect();
        format!("constants agree better than was believed, times their prior standard deviation: {}", all.join(", "))
    }
}

/// Normal equations about the nominal fit, with the families of its constants.
struct Tried<'a> {
    /// Constants and allowances, candidates, residual.
    total: DMatrix<f64>,
    nuisance: usize,
    two_sided: Vec<bool>,
    /// Columns of each family.
    families: &'a [Vec<usize>],
    /// First surface among the columns.
    first: usize,
}

impl<'a> Tried<'a> {
    fn new(model: &dyn Forward, basis: &Basis, fit: &Fit, families: &'a [Vec<usize>]) -> Self {
        let (frame, linear) = (model.frame(), &fit.linear);
        let columns: Vec<&[f64]> = linear.nuisance.iter().chain(linear.effects.iter()).map(Vec::as_slice).collect();
        let residual = offset_residual(model, linear, &[]);
        let gram =
            normal_equations(&frame.measured, &basis.noise, linear, &columns, &residual, &basis.local_scale, &[]);
        let two_sided = frame.candidates.iter().map(super::Candidate::two_sided).collect();
        let (nuisance, first) = (linear.nuisance.len(), frame.parameters.len());
        Self { total: gram.total, nuisance, two_sided, families, first }
    }

    /// The scales that the records ask for by more than [`NARROWER`], one a family.
    fn best(&self) -> Option<Vec<f64>> {
        let mut scales = vec![1.0; self.families.len()];
        let believed = self.density(&scales);
        let mut best = believed;
        for _ in 0..ROUNDS {
            let before = scales.clone();
            for family in (0..scales.len()).filter(|family| self.families[*family].len() > 1) {
                for scale in SCALES_OF_CONSTANTS {
                    let mut tried = scales.clone();
                    tried[family] = scale;
                    let density = self.density(&tried);
                    if density > best {
                        (scales, best) = (tried, density);
                    }
                }
            }
            if scales == before {
                break;
            }
        }
        (best > believed + NARROWER).then_some(scales)
    }

    /// Log marginal likelihood beside the effects that the records ask for most, the choice among all paid for.
    fn density(&self, scales: &[f64]) -> f64 {
        let mut precision = vec![1.0; self.nuisance];
        for (surfaces, scale) in self.families.iter().zip(scales) {
            surfaces.iter().for_each(|surface| precision[self.first + surface] = scale.powi(-2));
        }
        let nuisance: Vec<usize> = (0..self.nuisance).collect();
        let rest: Vec<usize> = (self.nuisance..self.total.nrows()).collect();
        let mut matrix = part(&self.total, &nuisance, &nuisance);
        (0..self.nuisance).for_each(|i| matrix[(i, i)] += precision[i]);
        let whole = factor(matrix);
        let cross = whole.half_solved(&part(&self.total, &nuisance, &rest));
        let mut left = part(&self.total, &rest, &rest) - cross.tr_mul(&cross);
        let residual = rest.len() - 1;
        let prior: f64 = precision.iter().map(|own| own.ln()).sum();
        let mut density = 0.5 * (prior - whole.log_determinant() - left[(residual, residual)]);
        let price = (self.two_sided.len().max(1) as f64).ln();
        for _ in 0..BESIDE {
            let gain = |candidate: usize| {
                let square = left[(candidate, candidate)] + CANDIDATE_PRECISION;
                let score = left[(candidate, residual)];
                if score < 0.0 && !self.two_sided[candidate] {
                    return f64::NEG_INFINITY;
                }
                0.5 * (score * score / square - (square / CANDIDATE_PRECISION).ln()) - price
            };
            let gains = (0..residual).map(|candidate| (candidate, gain(candidate)));
            let Some((candidate, gained)) = gains.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|best| best.1 > 0.0) else {
                break;
            };
            density += gained;
            let column = left.column(candidate).into_owned();
            left -= &column * column.transpose() / (column[candidate] + CANDIDATE_PRECISION);
        }
        density
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight programs, each timed to a tenth of what is believed of it, of which the last three are off by `together`, and
    /// each by its own of `scatter`; an effect acts on the last three.
    fn tried(together: f64, scatter: f64, families: &[Vec<usize>]) -> Tried<'_> {
        let (programs, precise) = (8, 10.0);
        let own = [0.3, -1.2, 0.9, -0.4, 1.4, -0.8, 0.1, -1.1];
        let mut columns: Vec<Vec<f64>> = (0..programs)
            .map(|program| (0..programs).map(|row| if row == program { precise } else { 0.0 }).collect())
            .collect();
        let on = |row: usize| f64::from(u8::from(row >= 5));
        columns.push((0..programs).map(|row| precise * on(row)).collect());
        columns.push((0..programs).map(|row| precise * (together * on(row) + scatter * own[row])).collect());
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum();
        let total = DMatrix::from_fn(columns.len(), columns.len(), |i, j| dot(&columns[i], &columns[j]));
        Tried { total, nuisance: programs, two_sided: vec![false], families, first: 0 }
    }

    #[test]
    fn constants_that_all_agree_but_for_one_cause_are_known_better_and_those_that_scatter_are_not() {
        let families = vec![(0..8).collect::<Vec<usize>>()];
        let least = SCALES_OF_CONSTANTS.into_iter().fold(1.0, f64::min);
        for together in [0.0, 2.0] {
            assert_eq!(tried(together, 0.0, &families).best(), Some(vec![least]), "{together}");
            assert_eq!(tried(together, 1.0, &families).best(), None, "{together}");
        }
        // Two constants say little of a spread.
        let two = vec![vec![0, 1]];
        assert_eq!(tried(0.0, 0.0, &two).best(), None);
    }
}
