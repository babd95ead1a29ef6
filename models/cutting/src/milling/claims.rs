//! Published numbers that milling reproduces.

use super::{Milling, MillingInput};
use toolroom_process::{Claim, Process};

/// Published numbers beside those of the default cutter.
///
/// # Examples
/// ```
/// assert!(toolroom_cutting::milling::claims().iter().all(|claim| claim.pass()));
/// ```
pub fn claims() -> Vec<Claim> {
    let milling = Milling::default();
    let mut claims = Vec::new();
    let mut claim = |claim: &str, source: &str, published: f64, computed: f64, tolerance: f64| {
        claims.push(Claim { claim: claim.to_owned(), source: source.to_owned(), published, computed, tolerance });
    };
    let force = milling.force;
    // 2160 N/mm2 at 68 deg and 50 N/mm on the edge: 250.3 N/mm at a chip of 0.1 mm.
    claim(
        "milling force per depth of a 12 mm cutter in steel at 0.1 mm chip [N/mm]",
        "identified by acornel5, Bayesian-stability-and-cutting-force (four teeth, steel)",
        250.3,
        1e-3 * (force.tangential_cutting * 0.1e-3 + force.tangential_edge),
        0.1,
    );
    let life = |depth_of_cut: f64, feed_per_rev: f64| {
        let input = MillingInput { depth_of_cut, feed_per_tooth: feed_per_rev / 6.0, ..MillingInput::default() };
        milling.output(&milling.initial(), &input).tool_life
    };
    // (6.2 · 4.1)^½ min at 1.5 mm, 0.5 mm/rev over (14.2 · 15.3)^½ min at 0.75 mm, 0.25 mm/rev;
    // replicates differ by 20 %.
    claim(
        "milling life ratio, twice the depth and twice the feed",
        "NASA/UC Berkeley milling set, steel, two replicates each",
        0.342,
        life(1.5e-3, 0.5e-3) / life(0.75e-3, 0.25e-3),
        0.2,
    );
    claims
}
