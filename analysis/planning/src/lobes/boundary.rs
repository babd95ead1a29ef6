//! The boundaries on a chart.

use super::cut::{Cut, found};
use super::file::Chart;
use rayon::prelude::*;
use toolroom_chatter::paper::{FiveDegrees, Reduced};
use toolroom_chatter::{Axis, Boundary, BoundaryColumn, BoundaryCurve, ChatterError, Milling, SpeedVariation, Turning};
use toolroom_form::significant;

/// One boundary of a chart: (speed, depth) in the units of [`Chart`].
#[derive(Clone, Debug)]
pub struct Curve {
    /// What it bounds, for legends.
    pub label: String,
    /// Least unstable depth at each speed; NaN where there is none on the chart.
    pub limit: Vec<(f64, f64)>,
    /// Where the cut becomes stable again or unstable once more.
    pub further: Vec<(f64, f64)>,
    /// The same ends joined to curves, of milling and of turning at constant speed.
    pub pieces: Vec<BoundaryCurve>,
    /// Speeds at which the search for the limit failed, and why.
    pub holes: Vec<(f64, String)>,
}

/// The boundary of the cut first, then what it is compared with: other lags, other allowances, the
/// same cut at constant speed.
///
/// # Errors
/// [`ChatterError`] where the chart lies outside the domain of the model.
pub fn boundaries(cut: &Cut, chart: &Chart) -> Result<Vec<Curve>, ChatterError> {
    match cut {
        Cut::Milling(cut, variation) => compared(*variation, |variation| milling(cut, variation, chart)),
        Cut::Turning(cut, variation) => compared(*variation, |variation| turning(cut, variation, chart)),
        Cut::Chuck(chuck) => {
            let others = chart.beside.iter().copied().filter(|lag| *lag != chuck.lag);
            let curve = |lag: f64| {
                let chuck = Reduced { lag, ..*chuck };
                let at = |eta: f64| chuck.critical_modulation(eta, chart.depth.end);
                sampled(format!("limit at lag {} us", significant(lag * 1e6)), &finer(&chart.speed), at)
            };
            std::iter::once(chuck.lag).chain(others).map(curve).collect()
        }
        Cut::ChipLag(chuck) => {
            let at = |lag: f64| Ok(on_chart(Some(Reduced { lag, ..*chuck }.cutting_stiffness_limit()), chart));
            Ok(vec![sampled("Routh limit".to_owned(), &finer(&chart.speed), at)?])
        }
        Cut::Lathe(lathe) => {
            let reference = lathe.reference_frequency();
            let first = lathe.mu_allowance.first().copied().unwrap_or(0.0);
            let others = chart.beside.iter().copied().filter(|allowance| *allowance != first);
            let curve = |allowance: f64| {
                let mut lathe = FiveDegrees::clone(lathe);
                lathe.mu_allowance.resize(lathe.mu_allowance.len().max(1), 0.0);
                lathe.mu_allowance[0] = allowance;
                let at = |ratio: f64| lathe.critical_chuck_modulation(ratio * reference, chart.depth.end);
                let label = format!("limit at allowance harmonic {}", significant(allowance));
                sampled(label, &chart.speed, at)
            };
            std::iter::once(first).chain(others).map(curve).collect()
        }
    }
}

/// The boundary at varying speed with that at constant speed beside it, or the latter alone.
fn compared(
    variation: Option<SpeedVariation>,
    mut boundary: impl FnMut(Option<SpeedVariation>) -> Result<Curve, ChatterError>,
) -> Result<Vec<Curve>, ChatterError> {
    let mut curves = vec![boundary(variation)?];
    if variation.is_some() {
        curves.push(Curve { label: "limit at constant speed".to_owned(), ..boundary(None)? });
    }
    Ok(curves)
}

fn milling(cut: &Milling, variation: Option<SpeedVariation>, chart: &Chart) -> Result<Curve, ChatterError> {
    let (speed, greatest) = (&chart.speed, chart.depth.end);
    Ok(traced(match variation {
        Some(variation) => cut.boundary_at_varying_speed(speed, variation, greatest)?,
        None => cut.boundary(speed, greatest)?,
    }))
}

fn turning(cut: &Turning, variation: Option<SpeedVariation>, chart: &Chart) -> Result<Curve, ChatterError> {
    let (greatest, steps) = (chart.depth.end, chart.depth.points);
    match variation {
        Some(variation) => {
            let at = |speed| found(cut.limit_at_varying_speed(speed, variation, greatest, steps));
            sampled("stability limit".to_owned(), &chart.speed, at)
        }
        None => Ok(traced(cut.boundary(&finer(&chart.speed), greatest)?)),
    }
}

/// The first ends of the stable intervals, the further ones, and the curves that they form.
fn traced(boundary: Boundary) -> Curve {
    let pieces = boundary.curves();
    let Boundary { columns, holes, .. } = boundary;
    let first = |column: &BoundaryColumn| column.crossings.first().map_or(f64::NAN, |crossing| crossing.limit.depth);
    // A line is not drawn across a hole.
    let gaps = holes.iter().map(|hole| (hole.speed, f64::NAN));
    let mut limit: Vec<_> = columns.iter().map(|column| (column.speed, first(column))).chain(gaps).collect();
    limit.sort_by(|a, b| a.0.total_cmp(&b.0));
    let further = columns.iter().flat_map(|column| {
        let depths = column.crossings.iter().skip(1).map(|crossing| crossing.limit.depth);
        depths.map(|depth| (column.speed, depth))
    });
    let holes = holes.into_iter().map(|hole| (hole.speed, hole.reason)).collect();
    Curve { label: "stability limit".to_owned(), limit, further: further.collect(), pieces, holes }
}

/// The limit at every value of the axis, in parallel; where the search for it fails there is a hole.
fn sampled(
    label: String,
    axis: &Axis,
    limit: impl Fn(f64) -> Result<Option<f64>, ChatterError> + Sync,
) -> Result<Curve, ChatterError> {
    let at = |at: f64| match limit(at) {
        Err(error) if !error.is_failed_search() => Err(error),
        outcome => Ok((at, outcome)),
    };
    let outcomes: Result<Vec<_>, _> = axis.values("speed")?.into_par_iter().map(at).collect();
    let mut curve = Curve { label, limit: Vec::new(), further: Vec::new(), pieces: Vec::new(), holes: Vec::new() };
    for (at, outcome) in outcomes? {
        if let Err(error) = &outcome {
            curve.holes.push((at, error.to_string()));
        }
        curve.limit.push((at, outcome.ok().flatten().unwrap_or(f64::NAN)));
    }
    Ok(curve)
}

fn on_chart(limit: Option<f64>, chart: &Chart) -> Option<f64> {
    limit.filter(|depth| *depth <= chart.depth.end)
}

/// Four times as many steps: lobes and tongues are a few percent of the speed wide.
fn finer(axis: &Axis) -> Axis {
    Axis { points: 4 * axis.points - 3, ..*axis }
}
