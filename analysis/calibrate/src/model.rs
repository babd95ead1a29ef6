//! What inference needs of a statistical model.

use crate::parameter::Parameter;
use rand_chacha::ChaCha8Rng;

/// A model of readings that come edge by edge: given the parameters, edges are independent.
pub trait Model: Sync {
    /// The parameters, in the order of the working coordinates.
    fn parameters(&self) -> &[Parameter];

    /// Number of edges.
    fn edges(&self) -> usize;

    /// Indices of parameters that act on what is the same for all edges: the data tell nothing of them, and what narrows them
    /// is the prior of another parameter.
    fn untold(&self) -> Vec<usize> {
        Vec::new()
    }

    /// Whether every parameter lies in its range, which for each is an interval whatever the others are. Outside, the density is
    /// zero.
    fn possible(&self, _u: &[f64]) -> bool {
        true
    }

    /// Log density of all data of each of some edges, what is particular to an edge integrated out.
    fn ln_densities(&self, u: &[f64], edges: &[usize]) -> Vec<f64>;

    /// Sum of the log densities of some edges.
    fn ln_likelihood(&self, u: &[f64], edges: &[usize]) -> f64 {
        self.ln_densities(u, edges).iter().sum()
    }

    /// The same model, whose densities near `u` are found sooner; none where nothing is to be gained.
    fn near(&self, _u: &[f64]) -> Option<Box<dyn Model + '_>> {
        None
    }

    /// The readings of an edge, in the order of [`Model::replicate`].
    fn readings(&self, edge: usize) -> Vec<f64>;

    /// Readings of another edge that is cut and read as this one.
    fn replicate(&self, u: &[f64], edge: usize, random: &mut ChaCha8Rng) -> Vec<f64>;

    /// [`Model::replicate`] of several edges.
    fn replicate_each(&self, u: &[f64], edges: &[usize], random: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
        edges.iter().map(|edge| self.replicate(u, *edge, random)).collect()
    }

    /// Logarithm of the normalised prior density.
    fn ln_prior(&self, u: &[f64]) -> f64 {
        self.parameters().iter().zip(u).map(|(parameter, u)| parameter.prior.ln_density(*u)).sum()
    }

    /// Logarithm of prior times likelihood of some edges; minus infinity where a law cannot be evaluated.
    fn ln_posterior(&self, u: &[f64], edges: &[usize]) -> f64 {
        let density = self.ln_prior(u) + self.ln_likelihood(u, edges);
        if density.is_nan() { f64::NEG_INFINITY } else { density }
    }
}
