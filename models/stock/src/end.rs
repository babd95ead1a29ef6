//! The form of a cutter's end.

/// What the end of a rotating cutter looks like from the side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum End {
    /// A plane.
    #[default]
    Flat,
    /// A plane with a rounded corner of this radius, m; a ball where it is the radius of the cutter.
    Corner(f64),
    /// A cone that grows from the radius of its tip, m, to that of the cutter; half its angle, rad.
    Taper(f64, f64),
}

impl End {
    /// Whether everything happens at one radius.
    pub fn is_flat(self) -> bool {
        self == Self::Flat
    }

    /// Height, m, above the tip at which a cutter of `radius` has its whole radius.
    pub fn height(self, radius: f64) -> f64 {
        match self {
            Self::Flat => 0.0,
            Self::Corner(corner) => corner.min(radius),
            Self::Taper(tip, half) => ((radius - tip) / half.tan()).max(0.0),
        }
    }

    /// Radius at a height above the tip, m, and the sine of the angle between the axis and the normal of the surface there: 1 on a
    /// cylinder, 0 on a plane.
    pub fn at(self, radius: f64, height: f64) -> (f64, f64) {
        match self {
            Self::Flat => (radius, 1.0),
            Self::Corner(corner) if height < corner => {
                let cosine = 1.0 - height / corner;
                let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
                (radius - corner + corner * sine, sine)
            }
            Self::Taper(tip, half) if tip + height * half.tan() < radius => (tip + height * half.tan(), half.cos()),
            Self::Corner(_) | Self::Taper(..) => (radius, 1.0),
        }
    }

    /// Height of the surface above the tip, m, at a distance from the axis; `None` beyond the radius.
    pub fn above(self, radius: f64, distance: f64) -> Option<f64> {
        (distance <= radius).then(|| match self {
            Self::Flat => 0.0,
            Self::Corner(corner) => {
                let out = (distance - (radius - corner)).max(0.0);
                corner - (corner * corner - out * out).max(0.0).sqrt()
            }
            Self::Taper(tip, half) => (distance - tip).max(0.0) / half.tan(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_and_radii_of_an_end_are_each_other_s_inverse() {
        for (end, whole) in
            [(End::Corner(5e-3), 5e-3), (End::Corner(1e-3), 1e-3), (End::Taper(2e-3, 0.3), 3e-3 / 0.3f64.tan())]
        {
            assert!((end.height(5e-3) - whole).abs() < 1e-12, "{end:?}");
            for share in [0.05, 0.3, 0.7, 0.99] {
                let height = share * whole;
                let (radius, _) = end.at(5e-3, height);
                let back = end.above(5e-3, radius).expect("inside");
                assert!((back - height).abs() < 1e-12, "{end:?} {share}: {back} {height}");
            }
            assert_eq!(end.at(5e-3, 2.0 * whole), (5e-3, 1.0), "{end:?}");
            assert_eq!(end.above(5e-3, 5.1e-3), None);
        }
        // Half way up a ball the normal leans by 60° from the axis.
        let (radius, sine) = End::Corner(4e-3).at(4e-3, 2e-3);
        assert!((radius - 4e-3 * 0.75f64.sqrt()).abs() < 1e-12 && (sine - 0.75f64.sqrt()).abs() < 1e-12);
    }
}
