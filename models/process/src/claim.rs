//! A published number beside the one that the code computes today.

/// One line of a validation table.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// What is claimed, in one sentence; says so where a set was chosen to meet it.
    pub claim: String,
    /// Where it is published.
    pub source: String,
    /// The published number.
    pub published: f64,
    /// The number computed now.
    pub computed: f64,
    /// Admissible difference as a share of the published number (absolute where that is 0).
    pub tolerance: f64,
}

impl Claim {
    /// Whether the computed number agrees.
    ///
    /// ```
    /// use toolroom_process::Claim;
    /// let claim = Claim {
    ///     claim: "light crosses a metre in 3.3 ns".into(),
    ///     source: "SI".into(),
    ///     published: 3.3e-9,
    ///     computed: 1.0 / 299_792_458.0,
    ///     tolerance: 0.02,
    /// };
    /// assert!(claim.pass());
    /// ```
    pub fn pass(&self) -> bool {
        let scale = if self.published == 0.0 { 1.0 } else { self.published.abs() };
        (self.computed - self.published).abs() <= self.tolerance * scale
    }
}
