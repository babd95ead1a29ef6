//! Between the ends of a step.

/// A quantity over one step: the cubic through its ends with their slopes (per step).
#[derive(Clone, Copy)]
pub(super) struct Cubic {
    pub ends: [f64; 2],
    pub slopes: [f64; 2],
}

impl Cubic {
    pub fn at(&self, share: f64) -> f64 {
        let ([start, end], [first, last]) = (self.ends, self.slopes);
        let rise = end - start;
        start + share * (first + share * (3.0 * rise - 2.0 * first - last + share * (first + last - 2.0 * rise)))
    }

    /// Share of the step at which a growing quantity reaches `value`, by Newton's method.
    pub fn share_at(&self, value: f64) -> f64 {
        let ([start, end], [first, last]) = (self.ends, self.slopes);
        let rise = end - start;
        let mut share = ((value - start) / rise).clamp(0.0, 1.0);
        for _ in 0..3 {
            let slope =
                first + share * (2.0 * (3.0 * rise - 2.0 * first - last) + share * 3.0 * (first + last - 2.0 * rise));
            if slope <= 0.0 {
                break;
            }
            share = (share - (self.at(share) - value) / slope).clamp(0.0, 1.0);
        }
        share
    }
}
