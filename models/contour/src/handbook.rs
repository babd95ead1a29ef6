//! The handbook's power law of the milling force, and the linear model that stands for it.

use toolroom_process::record;

record! {
    /// Handbook force of end milling:
    /// `force = constant·t^x·f^y·B^u·z / (D^q·n^w)` with t, f, B, D in mm and n in rpm.
    ///
    /// # Source
    /// Kosilova & Meshcheryakov, table 41 (steel, carbide end mill), recalled:
    /// 10·12.5·t^0.85·f^0.75·B·z/(D^0.73·n^−0.13) N.
    pub struct HandbookForce {
        /// Force where every factor is 1.
        constant: Real["N" => "N"] = 125.0, 1e-3..=1e6;
        /// Exponent of the radial immersion, x.
        immersion_exponent: Real = 0.85, 0.0..=2.0;
        /// Exponent of the feed per tooth, y.
        feed_exponent: Real = 0.75, 0.0..=2.0;
        /// Exponent of the width of edge, u.
        depth_exponent: Real = 1.0, 0.0..=2.0;
        /// Exponent of the diameter, q.
        diameter_exponent: Real = 0.73, 0.0..=2.0;
        /// Exponent of the spindle speed, w.
        speed_exponent: Real = -0.13, -2.0..=2.0;
    }
}

/// The linear edge-force model fitted to the handbook.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Tangential force per chip section K_tc, Pa.
    pub tangential_cutting: f64,
    /// Tangential force per width of edge K_te, N/m.
    pub tangential_edge: f64,
    /// Root mean square of the relative difference.
    pub rms: f64,
    /// Greatest relative difference.
    pub greatest: f64,
}

const MM: f64 = 1e-3;

impl HandbookForce {
    /// Tangential force, N, at `spindle_speed` in rad/s.
    ///
    /// # Examples
    /// ```
    /// use toolroom_contour::HandbookForce;
    /// let force = HandbookForce::default().tangential(0.5e-3, 0.08e-3, 0.03, 4.0, 0.032, 104.72);
    /// assert!((force - 244.779).abs() < 0.001);
    /// ```
    pub fn tangential(
        &self,
        immersion: f64,
        feed_per_tooth: f64,
        depth_of_cut: f64,
        teeth: f64,
        diameter: f64,
        spindle_speed: f64,
    ) -> f64 {
        let rpm = spindle_speed * 60.0 / std::f64::consts::TAU;
        self.constant
            * (immersion / MM).powf(self.immersion_exponent)
            * (feed_per_tooth / MM).powf(self.feed_exponent)
            * (depth_of_cut / MM).powf(self.depth_exponent)
            * teeth
            / ((diameter / MM).powf(self.diameter_exponent) * rpm.powf(self.speed_exponent))
    }

    /// Least squares of the relative difference between `a·[Ktc·f·(1 − cos ψ) + Kte·ψ]` and the
    /// handbook force on a straight wall, over every pair of `immersions` and `feeds`.
    ///
    /// `None` where the pairs do not determine two coefficients.
    pub fn calibrate(
        &self,
        immersions: &[f64],
        feeds: &[f64],
        diameter: f64,
        spindle_speed: f64,
    ) -> Option<Calibration> {
        let rows: Vec<[f64; 2]> = (immersions.iter())
            .flat_map(|t| feeds.iter().map(move |f| (*t, *f)))
            .map(|(t, f)| {
                let cos = 1.0 - 2.0 * t / diameter;
                // Width and teeth cancel for an exponent of width of 1; one of each is taken.
                let handbook = self.tangential(t, f, MM, 1.0, diameter, spindle_speed) / (MM / std::f64::consts::TAU);
                [f * (1.0 - cos) / handbook, cos.acos() / handbook]
            })
            .collect();
        let dot = |i: usize, j: usize| rows.iter().map(|row| row[i] * row[j]).sum::<f64>();
        let sum = |i: usize| rows.iter().map(|row| row[i]).sum::<f64>();
        let determinant = dot(0, 0) * dot(1, 1) - dot(0, 1) * dot(0, 1);
        if determinant.is_nan() || determinant <= 1e-9 * dot(0, 0) * dot(1, 1) {
            return None;
        }
        let cutting = (sum(0) * dot(1, 1) - sum(1) * dot(0, 1)) / determinant;
        let edge = (sum(1) * dot(0, 0) - sum(0) * dot(0, 1)) / determinant;
        let differences = || rows.iter().map(|row| (row[0] * cutting + row[1] * edge - 1.0).abs());
        let mean_square = differences().map(|d| d * d).sum::<f64>() / rows.len() as f64;
        Some(Calibration {
            tangential_cutting: cutting,
            tangential_edge: edge,
            rms: mean_square.sqrt(),
            greatest: differences().fold(0.0, f64::max),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_pair_does_not_determine_two_coefficients() {
        assert_eq!(HandbookForce::default().calibrate(&[1e-3], &[1e-4], 0.032, 100.0), None);
    }
}
