//! What a calibration is to do.

use crate::parameter::Prior;
use crate::shape::Candidate;

/// What a calibration is to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Laws and shapes of the wear curve to be compared; one is taken as given.
    pub candidates: Vec<Candidate>,
    /// Flank wear at which an edge is worn out, mm.
    pub limit: f64,
    /// Column of the words that tell groups of edges.
    pub by: Option<String>,
    /// Parameters fixed at values in their units, by name.
    pub fixed: Vec<(String, f64)>,
    /// Priors in working coordinates, by name; a mean of NaN keeps the one that the set gives.
    pub priors: Vec<(String, Prior)>,
    /// Draws of the posterior.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Correlation time in min of a wear rate that wanders within lives; it does not if none.
    pub life_noise: Option<f64>,
    /// Names of edges that take no part and are predicted.
    pub held_out: Vec<String>,
    /// Whether profile intervals are worked out.
    pub profile: bool,
}

impl Default for Request {
    fn default() -> Self {
        Self {
            candidates: Vec::new(),
            limit: 0.3,
            by: None,
            fixed: Vec::new(),
            priors: Vec::new(),
            draws: 2000,
            seed: 1,
            life_noise: None,
            held_out: Vec::new(),
            profile: false,
        }
    }
}
