//! What differs from edge to edge and from piece to piece in a run of the scenario.

use super::{Local, Ports};
use crate::features;
use toolroom_process::Record;
use toolroom_records::Records;
use toolroom_wear::Scatter;

/// Place of the local factor by which thermal wear differs from mechanical wear.
pub(super) const KIND: usize = 2;
/// Prior standard deviation of the mean land of new edges, relative. Assumption: edges of another make may be honed
/// otherwise, or not at all.
pub(super) const NEW_LAND: f64 = 0.5;

/// Scatter of the scenario, as far as records of operations show it.
///
/// Not modelled: that chipped edges leave early, that an edge is changed on a reading of its wear, and that pieces of
/// one lot on two edges share their hardness (a draw of the null knows of it, the covariance does not).
pub(super) struct Scattered {
    /// Standard deviations of the scenario.
    pub scatter: Scatter,
    /// Mean land of a new edge, m.
    pub land: f64,
    /// Lot of each row.
    pub lots: Vec<usize>,
    /// Standard deviation of ln(thermal/mechanical wear factor), and the share of it that mechanical wear bears.
    kinds: Option<(f64, f64)>,
}

impl Scattered {
    pub fn new(scatter: Scatter, records: &Records, sizes: &[(String, u32)], ports: &Ports) -> Self {
        let spread = scatter.initial_wear_scatter;
        let (mechanical, thermal) = (scatter.mechanical_wear.powi(2), scatter.thermal_wear.powi(2));
        let both = mechanical + thermal;
        let told_apart = ports.mechanical.is_some() && ports.thermal.is_some() && both > 0.0;
        Self {
            scatter,
            land: scatter.initial_wear * (0.5 * spread * spread).exp(),
            lots: features::lots(records, sizes),
            kinds: told_apart.then(|| (both.sqrt(), mechanical / both)),
        }
    }

    /// Sets the deviations of the factors of edges to those of the scenario.
    ///
    /// The logarithms M and T of the two kinds of wear are `c + s − αd` and `c + s + (1 − α)d` with d = T − M and
    /// α = σM²/(σM² + σT²), by which s and d are independent and s has the variance σM²σT²/(σM² + σT²).
    pub fn set_locals(&self, locals: &mut Vec<Local>) {
        let Scatter { common_wear, mechanical_wear, thermal_wear, .. } = self.scatter;
        let shared = match self.kinds {
            Some((both, _)) => mechanical_wear * thermal_wear / both,
            None => 0.0,
        };
        locals[0].deviation = common_wear.hypot(shared);
        locals[0].estimated = false;
        if let Some((deviation, _)) = self.kinds {
            let name = "thermal against mechanical wear of the edge";
            locals.push(Local { name, deviation, estimated: false, scatter: true });
        }
    }

    /// Writes the factors of both kinds of wear where their logarithms differ by `difference`.
    pub fn set_kinds<R: Record>(&self, ports: &Ports, difference: f64, input: &mut R) {
        let Some((_, share)) = self.kinds else { return };
        for (port, weight) in [(ports.mechanical, -share), (ports.thermal, 1.0 - share)] {
            if let Some(port) = port {
                input.set(port, (weight * difference).exp());
            }
        }
    }

    /// Standard deviation of the land of new edges, m: that of a lognormal number.
    pub fn land_deviation(&self) -> f64 {
        self.land * self.scatter.initial_wear_scatter.powi(2).exp_m1().sqrt()
    }
}
