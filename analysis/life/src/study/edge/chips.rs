//! Chipping of an edge: the hazard that it gathers.

use toolroom_wear::Chipping;

/// The chipping hazard of an edge along its path.
pub(super) struct Chips {
    pub chipping: Chipping,
    /// Rate on top of the edge's own, 1/m.
    pub added: f64,
}

impl Chips {
    /// Whether edges chip at all.
    pub fn happen(&self) -> bool {
        self.rate() > 0.0
    }

    fn rate(&self) -> f64 {
        self.chipping.rate + self.added
    }

    /// `(rate·path)^shape`, the hazard of a sharp edge.
    pub fn power(&self, path: f64) -> f64 {
        let base = self.rate() * path;
        // The shape of every shipped set; a root costs a fraction of a power.
        if self.chipping.shape == 1.5 { base * base.sqrt() } else { base.powf(self.chipping.shape) }
    }

    /// Factor of a land (m) on the hazard.
    pub fn aged(&self, land: f64) -> f64 {
        1.0 + (land / self.chipping.reference_land).powi(2)
    }

    /// Hazard gathered over a stretch: exact in path; the land's factor is a parabola in the power
    /// of path. The stretch is given by the power of path and the land's factor at its start, at a
    /// point between and at its end.
    pub fn over(&self, [start, between, end]: [(f64, f64); 3]) -> f64 {
        let step = end.0 - start.0;
        if step <= 0.0 {
            return 0.0;
        }
        // Weights of the parabola; a point too near to an end would make them large.
        let place = ((between.0 - start.0) / step).clamp(0.2, 0.8);
        let (first, last) = (0.5 - 1.0 / (6.0 * place), 0.5 - 1.0 / (6.0 * (1.0 - place)));
        let middle = 1.0 / (6.0 * place * (1.0 - place));
        step * (first * start.1 + middle * between.1 + last * end.1)
    }
}

/// The share of a stretch at which a rising function of it reaches `value`.
pub(super) fn share_at(value: f64, mut function: impl FnMut(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        *(if function(middle) < value { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}
