//! The level of an edge: where it is most probable, and the density of the edge's data with it integrated out.

use crate::normal::ln_sum;

/// Nodes and weights of 9-point Gauss–Hermite quadrature for the weight exp(-x²), positive half (Abramowitz and Stegun,
/// table 25.10).
const HERMITE: [(f64, f64); 5] = [
    (0.0, 7.202_352_156_060_51e-1),
    (0.723_551_018_752_837_6, 4.326_515_590_025_558e-1),
    (1.468_553_289_216_668, 8.847_452_739_437_657e-2),
    (2.266_580_584_531_843, 4.943_624_275_536_947e-3),
    (3.190_993_201_781_527_6, 3.960_697_726_326_438e-5),
];
/// The level of an edge is looked for from nine starts over three deviations either side: from its mean alone the search
/// fails for edges that are far off (number: assumption).
const STARTS: usize = 9;
/// Starts for edges with very many readings: the density then falls evenly to both sides, and the search finds its way
/// (assumption).
const FEW_STARTS: usize = 3;
/// Farthest start, in standard deviations of the level, beyond which 0.3 % of edges lie (assumption).
const FARTHEST: f64 = 3.0;
/// Distance from the most probable level, in its own standard deviations, at which the search ends (assumption): the
/// density is off by half its square.
const CLOSE: f64 = 1e-4;
/// The same where the covariance of readings depends on the level: it enters the density to first order (assumption).
const SETTLED: f64 = 1e-8;
/// Logarithms of density by which a step goes uphill beyond doubt (assumption): far above its rounding.
const UPHILL: f64 = 1e-3;
/// Readings by which the starts are compared (assumption): which of them is nearest shows already in a few readings spread
/// over the life, and an edge of a recorded shop has hundreds.
const COMPARED: usize = 16;

/// Log density, its derivative and its Gauss–Newton curvature at a standardised level.
pub(crate) type Joint = (f64, f64, f64);

/// Middle and positive half of the 3-point rule, from the same table: for edges with so many readings that their level is
/// all but known.
const FEW_NODES: [(f64, f64); 2] = [(0.0, 1.181_635_900_603_677), (1.224_744_871_391_589, 0.295_408_975_150_919_4)];
/// Nodes of the greater rule beside the one in the middle.
pub(crate) const SIDES: usize = 2 * (HERMITE.len() - 1);

/// How many nodes integrate over the level of an edge.
#[derive(Clone, Copy)]
pub(crate) enum Nodes {
    /// Nine.
    Nine,
    /// Three.
    Three,
}

/// Logarithm of the integral of a density over the standardised level around its top, by adaptive Gauss–Hermite quadrature.
/// `far` takes levels away from the top and leaves the logarithms of the density there in their place.
pub(crate) fn ln_integral(
    nodes: Nodes,
    (z, (density, _, curvature)): (f64, Joint),
    far: impl FnOnce(&mut [f64]),
) -> f64 {
    let half: &[(f64, f64)] = match nodes {
        Nodes::Nine => &HERMITE,
        Nodes::Three => &FEW_NODES,
    };
    let width = std::f64::consts::SQRT_2 / curvature.sqrt();
    let side = half.len() - 1;
    let mut values = [0.0; SIDES];
    for (place, (node, _)) in half[1..].iter().enumerate() {
        (values[place], values[side + place]) = (z + width * node, z - width * node);
    }
    far(&mut values[..2 * side]);
    let mut terms = [0.0; SIDES + 1];
    terms[0] = density + half[0].1.ln();
    for (place, density) in values[..2 * side].iter().enumerate() {
        let (node, weight) = half[1 + place % side];
        terms[1 + place] = density + node * node + weight.ln();
    }
    width.ln() + ln_sum(&terms[..=2 * side])
}

/// Where the search for the level of an edge begins.
#[derive(Clone, Copy)]
pub(crate) enum Start {
    /// At the best of nine levels over three deviations either side.
    Many,
    /// At the best of three.
    Few,
    /// At a standardised level.
    At(f64),
}

/// The best of some starts, and the density there.
fn begun(at: &mut dyn FnMut(f64, usize) -> Joint, readings: usize, start: Start) -> (f64, Joint) {
    let grid = |count: usize, reach: f64| -> Vec<f64> {
        (0..count).map(|start| reach * (2.0 * start as f64 / (count - 1) as f64 - 1.0)).collect()
    };
    let (starts, stride) = match start {
        Start::Many => (grid(STARTS, FARTHEST), readings.div_ceil(COMPARED).max(1)),
        Start::Few => (grid(FEW_STARTS, 0.5 * FARTHEST), readings.div_ceil(COMPARED).max(1)),
        Start::At(z) => (vec![z], 1),
    };
    let mut best = (0.0, (f64::NEG_INFINITY, 0.0, 1.0));
    for z in starts {
        let there = at(z, stride);
        if there.0 > best.1.0 {
            best = (z, there);
        }
    }
    if stride > 1 {
        best.1 = at(best.0, 1);
    }
    best
}

/// The most probable standardised level of an edge, and the density there.
pub(crate) fn mode(at: &mut dyn FnMut(f64, usize) -> Joint, readings: usize, start: Start) -> (f64, Joint) {
    let (mut z, mut here) = begun(at, readings, start);
    for _ in 0..20 {
        let mut step = here.1 / here.2;
        if step.abs() * here.2.sqrt() < CLOSE {
            break;
        }
        let mut moved = false;
        for _ in 0..12 {
            let next = at(z + step, 1);
            if next.0.is_finite() && next.0 >= here.0 {
                z += step;
                here = next;
                moved = true;
                break;
            }
            step *= 0.5;
        }
        if !moved {
            break;
        }
    }
    (z, here)
}

/// The standardised level at which readings that noise within the life joins are most probable if it makes of them what it
/// does at that level: there the derivative is zero that holds their covariance. Steps of the secant method.
pub(crate) fn settled(at: &mut dyn FnMut(f64, usize) -> Joint, readings: usize, start: Start) -> (f64, Joint) {
    let (mut z, mut here) = begun(at, readings, start);
    // How much of a step the next one takes back.
    let mut share = 1.0;
    for _ in 0..40 {
        let whole = here.1 / here.2;
        if whole.abs() * here.2.sqrt() < SETTLED {
            break;
        }
        let mut step = whole / share;
        let mut moved = None;
        for _ in 0..8 {
            let next = at(z + step, 1);
            let left = next.1 / next.2;
            if next.0.is_finite() && (left.abs() < 0.9 * whole.abs() || next.0 > here.0 + UPHILL) {
                moved = Some((next, left));
                break;
            }
            step *= 0.5;
        }
        let Some((next, left)) = moved else { break };
        share = ((whole - left) / step).clamp(0.3, 3.0);
        z += step;
        here = next;
    }
    (z, here)
}
