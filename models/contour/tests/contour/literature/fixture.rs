//! The reference contours and how numbers are compared.

use std::f64::consts::TAU;
use toolroom_contour::{Contour, CornerPolicy, CutterSide, Models, PathError, Point, Setting, Trace};

pub const RPM: f64 = TAU / 60.0;
pub const MM_PER_MIN: f64 = 1e-3 / 60.0;

/// The same number in six significant digits.
#[track_caller]
pub fn six(what: &str, computed: f64, expected: f64) {
    let print = |value: f64| format!("{value:.5e}");
    assert_eq!(print(computed), print(expected), "{what}");
}

/// Agreement within half a unit of the last of `decimals`.
#[track_caller]
pub fn decimals(what: &str, computed: f64, expected: f64, decimals: i32) {
    let half = 0.5 * 10f64.powi(-decimals) * (1.0 + 1e-9);
    assert!((computed - expected).abs() <= half, "{what}: {computed}, reference {expected}");
}

/// MC-1: an external contour of lines and arcs of 30 and 22 mm with four sharp corners.
pub fn mc1() -> Contour {
    let (mm, deg) = (1e-3, TAU / 360.0);
    let mut trace = Trace::new(Point::default(), 0.0);
    let corner = 90.0 * deg - (20.0f64 / 30.0).atan();
    trace.line(120.0 * mm).unwrap();
    trace.turn(90.0 * deg);
    trace.line(50.0 * mm).unwrap();
    trace.arc(30.0 * mm, 90.0 * deg).unwrap();
    trace.line(6.0 * mm).unwrap();
    trace.arc(22.0 * mm, -90.0 * deg).unwrap();
    trace.arc(22.0 * mm, 180.0 * deg).unwrap();
    trace.arc(22.0 * mm, -90.0 * deg).unwrap();
    trace.line(16.0 * mm).unwrap();
    trace.turn(90.0 * deg);
    trace.line(50.0 * mm).unwrap();
    trace.turn(90.0 * deg - corner);
    trace.line(1300f64.sqrt() * mm).unwrap();
    trace.finish(CutterSide::Right, true).unwrap()
}

/// The first sections of a contour.
pub fn beginning(contour: &Contour, sections: usize) -> Contour {
    let corners = contour.corners.iter().copied().filter(|corner| corner.after + 1 < sections).collect();
    Contour { sections: contour.sections[..sections].to_vec(), corners, closed: false, ..contour.clone() }
}

/// RK-3: a hole of equal width with three lobes, cut into `sections`.
pub fn rk3(eccentricity: f64, sections: u32) -> Contour {
    let mut trace = Trace::new(Point::default(), 0.0);
    trace.lobed(0.1, eccentricity, 3, sections).unwrap();
    trace.finish(CutterSide::Left, true).unwrap()
}

/// Empirical path error and loops of 2 mm radius at 0.05 mm, as the reference tables take them.
pub fn models() -> Models {
    Models {
        path_error: PathError::Empirical,
        corners: CornerPolicy::Loop { radius: 2e-3, tolerance: Some(0.05e-3) },
        ..Models::default()
    }
}

/// A setting in rpm and mm.
pub fn setting(rpm: f64, feed: f64) -> Setting {
    Setting { spindle_speed: rpm * RPM, feed_per_tooth: feed * 1e-3 }
}
