//! Receptance coupling, cutting-force coefficients and limits from responses beside independent computations.

use std::f64::consts::{PI, TAU};
use toolroom_dynamics::{
    BaseMode, DynamicsError, FitOptions, ForceTestError, Joint, Material, Receptance, Segment, TestedCut, base, chain,
    fit, read_csv, read_forces,
};
use toolroom_process::Claim;

const BEAM: &str = "independent computation: Timoshenko beam with the shear coefficient of Cowper";
const LEAST_SQUARES: &str = "independent computation: ordinary least squares on shipped synthetic slot tests";
const LIKELIHOOD: &str = "independent computation: greatest likelihood on a shipped synthetic tap test";
/// The tap test that is shipped.
const TAP: &str = include_str!("../../../scenarios/data/tap-tool.csv");
/// The slot tests that are shipped.
const SLOT: &str = include_str!("../../../scenarios/data/slot-al7075.csv");

/// Why a claim cannot be computed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum DynamicsClaimError {
    /// A model refused its values.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// A force test refused its values.
    #[error(transparent)]
    Forces(#[from] ForceTestError),
}

/// What independent computations say of measured dynamics, and what the model computes.
pub(crate) fn claims() -> Result<Vec<Claim>, DynamicsClaimError> {
    let mut claims = Vec::new();
    let mut tell = |claim: &str, source: &str, published: f64, computed: f64, tolerance: f64| {
        claims.push(Claim { claim: claim.to_owned(), source: source.to_owned(), published, computed, tolerance });
    };
    let steel = Material { youngs_modulus: 200e9, density: 7800.0, poisson_ratio: 0.29, loss_factor: 0.01 };
    let rod = [Segment::rod(0.125, 0.01, 1.0, steel)];
    let tip = |w: f64| {
        let end = chain(&rod, w).and_then(|rod| rod.on(&Receptance::zeros(), None));
        end.map_or(f64::NAN, |end| end[(0, 0)].re * 1e6)
    };
    tell("clamped steel rod 10 x 125 mm: real receptance at 500 Hz, um/N", BEAM, -28.45019, tip(TAU * 500.0), 1e-6);
    tell("clamped steel rod 10 x 125 mm: static compliance, um/N", BEAM, 6.65340, tip(TAU * 0.5), 1e-4);
    let carbide = Material { youngs_modulus: 580e9, density: 14_500.0, poisson_ratio: 0.24, loss_factor: 0.004 };
    let tool = [Segment::rod(0.026, 0.012, 0.8, carbide), Segment::rod(0.029, 0.012, 1.0, carbide)];
    let mode = |natural_frequency, damping_ratio, stiffness, rotation| BaseMode {
        natural_frequency,
        damping_ratio,
        stiffness,
        rotation,
    };
    let spindle = [mode(680.0, 0.045, 4.2e7, -9.0), mode(1420.0, 0.03, 6.5e7, -14.0), mode(2950.0, 0.025, 9e7, -22.0)];
    let joint = Joint { radial: 2e8, angular: 2.5e4, loss_factor: 0.02 };
    let w = TAU * 1000.0;
    for (name, joint, published) in [("rigid", None, 0.276570), ("with a joint", Some(&joint), 0.502866)] {
        let end = chain(&tool, w).and_then(|tool| tool.on(&base(&spindle, w), joint));
        let computed = end.map_or(f64::NAN, |end| end[(0, 0)].re * 1e6);
        let claim = format!("carbide tool, overhang 55 mm, {name}, on a spindle: real receptance at 1000 Hz, um/N");
        tell(&claim, BEAM, published, computed, 1e-5);
    }
    let cut = TestedCut { teeth: 2, depth: 2e-3, entry: 0.0, exit: PI };
    let found = read_forces("slot-al7075.csv", SLOT)?.identify(&cut)?;
    for (name, coefficient, published, scale) in [
        ("tangential coefficient, MPa", found.chip[0], 791.341, 1e-6),
        ("radial coefficient, MPa", found.chip[1], 188.342, 1e-6),
        ("tangential edge force, N/mm", found.edge[0], 27.9944, 1e-3),
    ] {
        let claim = format!("slot tests in aluminium: {name}");
        let computed = coefficient.map_or(f64::NAN, |coefficient| coefficient.value * scale);
        tell(&claim, LEAST_SQUARES, published, computed, 1e-5);
    }
    claims.extend(tapped()?);
    Ok(claims)
}

/// Natural frequency (Hz), damping ratio and stiffness (N/um) of the modes in the tap test by another fit, each with its
/// standard deviation.
const TAPPED: [[(f64, f64); 3]; 3] = [
    [(612.611, 0.146), (0.030878, 0.000325), (22.493, 0.163)],
    [(1184.689, 0.011), (0.018707, 0.000013), (9.5976, 0.0048)],
    [(2360.995, 0.018), (0.024107, 0.000011), (30.989, 0.011)],
];
/// Share of a standard deviation by which two fits of greatest likelihood may differ: starts and rounding differ, the optimum
/// is one.
const OF_DEVIATION: f64 = 0.2;

/// Modes of a tap test with noise, whose number is not given.
fn tapped() -> Result<Vec<Claim>, DynamicsError> {
    let measured = read_csv("tap-tool.csv", TAP)?;
    let found = fit(&measured, &FitOptions { averages: Some(5), ..FitOptions::default() })?;
    let claim = |what: &str, published, computed, tolerance| Claim {
        claim: format!("tap test of a tool with the noise of an accelerometer: {what}"),
        source: LIKELIHOOD.to_owned(),
        published,
        computed,
        tolerance,
    };
    let mut claims = vec![claim("number of modes", TAPPED.len() as f64, found.modes.len() as f64, 0.0)];
    for (i, expected) in TAPPED.iter().enumerate() {
        let mode = found.modes.get(i);
        let values = mode.map_or([f64::NAN; 3], |mode| {
            [mode.natural_frequency.value, mode.damping_ratio.value, mode.stiffness.value * 1e-6]
        });
        for ((name, (published, sd)), computed) in
            ["natural frequency, Hz", "damping ratio", "stiffness, N/um"].into_iter().zip(expected).zip(values)
        {
            let what = format!("{name} of mode {}", i + 1);
            claims.push(claim(&what, *published, computed, OF_DEVIATION * sd / published));
        }
    }
    Ok(claims)
}
