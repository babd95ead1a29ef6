//! Published numbers beside those that this crate computes.

use crate::{
    ContourError, Cutter, CutterSide, EdgeForce, Engagement, HandbookForce, HelicalCut, Milling, Models, Objective,
    Parameters, Pass, PathError, Planner, Point, Shape, Trace,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use toolroom_process::Claim;

const PAPER: &str = "Lukin, contour milling on NC machines (dissertation abstract, 1998)";
const HANDBOOK: &str = "Kosilova & Meshcheryakov handbook, recalled";
const REFERENCE: &str = "independent implementation of the same equations in Python";
const THEORY: &str = "feed-drive theory";

/// Every claim about contour milling, computed now.
///
/// # Errors
/// [`ContourError`] where a contour or a plan fails.
///
/// # Examples
/// ```
/// let claims = toolroom_contour::claims().unwrap();
/// assert!(claims.len() > 12 && claims.iter().all(|claim| claim.pass()));
/// ```
pub fn claims() -> Result<Vec<Claim>, ContourError> {
    let mut table = paper()?;
    table.extend(plans()?);
    table.extend(mechanics());
    Ok(table)
}

fn claim(claim: &str, source: &str, published: f64, computed: f64, tolerance: f64) -> Claim {
    Claim { claim: claim.to_owned(), source: source.to_owned(), published, computed, tolerance }
}

/// Gain in productivity and change of cost of the plan of an RK-3-like finishing pass.
fn gains(edge_cost: f64, path_error: PathError, objective: Objective) -> Result<(f64, f64), ContourError> {
    let mut trace = Trace::new(Point::default(), 0.0);
    trace.lobed(0.1, 0.0035, 3, 18)?;
    let contour = trace.finish(CutterSide::Left, true)?;
    let mut parameters = Parameters::default();
    parameters.economics.edge_cost = edge_cost;
    let (pass, models) = (Pass::default(), Models { path_error, ..Models::default() });
    let planner = Planner::new(&contour, &parameters, &pass, &models)?;
    let (handbook, plan) = (planner.handbook()?, planner.optimal(objective)?);
    Ok((plan.productivity_gain(&handbook), plan.cost_change(&handbook)))
}

fn paper() -> Result<Vec<Claim>, ContourError> {
    let (productivity, cost) = gains(16.0, PathError::Empirical, Objective::Cost)?;
    let law = |feed: f64, angle: f64| PathError::Empirical.magnitude(feed / 60e3, 0.05, angle, 1.0);
    // Errors in mm as the paper has them.
    let around = law(1.0, 1.0) * 1e3 * (PI / 180.0).powf(0.34);
    Ok(vec![
        claim(
            "profile hole: productivity 10 to 14 % above handbook regimes, here the cost optimum of an RK-3-like finishing pass, edges 13.5 % of the cost (demonstration: conditions chosen among plausible ones)",
            PAPER,
            0.12,
            productivity,
            0.02 / 0.12,
        ),
        claim("profile hole: cost 15 to 18 % lower (demonstration, as above)", PAPER, -0.165, cost, 0.015 / 0.165),
        claim(
            "eq. (14) with the arc of a loop gives the second accuracy limit's 9e-7 (180 + alpha)^0.34",
            PAPER,
            9e-7,
            around,
            0.05,
        ),
        claim(
            "eq. (14): 40 % more error per tenth of the range from 60 to 590 mm/min (reading of the scan)",
            PAPER,
            0.40,
            (law(590.0, 1.0) / law(60.0, 1.0)).powf(0.1) - 1.0,
            0.05,
        ),
    ])
}

fn plans() -> Result<Vec<Claim>, ContourError> {
    let (time, _) = gains(20.0, PathError::Empirical, Objective::Time)?;
    let (_, cost) = gains(20.0, PathError::Empirical, Objective::Cost)?;
    let (off, _) = gains(20.0, PathError::Off, Objective::Time)?;
    let (servo, _) = gains(20.0, PathError::default(), Objective::Time)?;
    Ok(vec![
        claim("RK-3 finish, time optimum: productivity", REFERENCE, 0.1464, time, 5e-4),
        claim("RK-3 finish, cost optimum with edges at 16 % of the cost: cost", REFERENCE, -0.1660, cost, 5e-4),
        claim("RK-3 finish without path error, time optimum: productivity", REFERENCE, 1.2812, off, 5e-4),
        claim("RK-3 finish with servo lag, time optimum: productivity", REFERENCE, 1.1508, servo, 5e-4),
    ])
}

fn mechanics() -> Vec<Claim> {
    let immersions: Vec<f64> = (1..=8).map(|i| 0.5e-3 * f64::from(i)).collect();
    let feeds: Vec<f64> = (2..=10).map(|i| 0.02e-3 * f64::from(i)).collect();
    let fit = HandbookForce::default().calibrate(&immersions, &feeds, 32e-3, 1000.0 / 60.0 * TAU);
    let (cutter, force) = (Cutter::default(), EdgeForce::default());
    let engagement = Engagement::new(Shape::Straight, cutter.radius(), 0.5e-3);
    let cut = HelicalCut {
        force: &force,
        milling: Milling::Down,
        engagement_angle: engagement.angle,
        depth_of_cut: 30e-3,
        teeth: cutter.teeth,
        lag: cutter.helix_lag(),
    };
    let life = Parameters::default().life;
    let (gain, feed) = (16.667, 590.0 / 60e3);
    let euler = |step: f64| PathError::ExplicitEuler { step }.magnitude(feed, 0.05, FRAC_PI_2, gain);
    vec![
        claim(
            "two force coefficients reproduce the handbook force: rms",
            REFERENCE,
            0.043_851,
            fit.map_or(f64::NAN, |fit| fit.rms),
            1e-4,
        ),
        claim(
            "handbook life of 120 min at 161.025 m/min, 3 mm, 0.08 mm",
            HANDBOOK,
            120.0,
            life.tool_life(161.025 / 60.0 / 16e-3, 0.08e-3, 3e-3, 30e-3, 4.0, 32e-3) / 60.0,
            1e-4,
        ),
        claim(
            "a hollow of 22 mm deepens a 3 mm allowance [mm]",
            REFERENCE,
            10.25,
            Engagement::new(Shape::Concave(22e-3), 16e-3, 3e-3).immersion * 1e3,
            1e-6,
        ),
        claim(
            "helical form error at half height, 0.5 mm down, 0.08 mm (the reference resolves the engagement by 115 slices, 0.9 % each) [um]",
            REFERENCE,
            14.9667,
            cut.finishing_force(0.08e-3, 15e-3) / cutter.stiffness() * 1e6,
            9e-3,
        ),
        claim(
            "servo lag on an arc tends to V²/(2 K² R): 590 mm/min, 50 mm [um]",
            THEORY,
            feed * feed / (2.0 * gain * gain * 0.05) * 1e6,
            PathError::default().magnitude(feed, 0.05, FRAC_PI_2, gain) * 1e6,
            1e-3,
        ),
        claim("explicit Euler at 10 ms, 590 mm/min [um]", REFERENCE, 49.1747, euler(0.01) * 1e6, 1e-5),
        claim("its error halves with the step", THEORY, 2.0, euler(0.01) / euler(0.005), 1e-3),
    ]
}
