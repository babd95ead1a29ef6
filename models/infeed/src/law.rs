//! How the force grows with the depth, and how a deflection is shared out between part, wheel and machine.

use toolroom_process::Number;

/// Depth at which the process stiffness is the force over the depth whatever the exponent, 1 um.
pub(crate) const REFERENCE_DEPTH: f64 = 1e-6;

/// Force per stiffness (a length) at a depth, `h0 (h/h0)^m` with `h0` the reference; `h` itself for m = 1.
pub(crate) fn chip<N: Number>(depth: N, exponent: N, reference: f64) -> N {
    if exponent.re() == 1.0 || depth.re() <= 0.0 { depth } else { (depth / reference).powd(exponent) * reference }
}

/// The depth at which [`chip`] has this value.
pub(crate) fn depth_of_chip<N: Number>(chip: N, exponent: N, reference: f64) -> N {
    if exponent.re() == 1.0 || chip.re() <= 0.0 { chip } else { (chip / reference).powd(exponent.recip()) * reference }
}

/// Depth h and deflection by cutting of an engagement: the root of `h (1 + g) + c h0 (h/h0)^m = engagement`, g being
/// the wear and c the compliance.
///
/// The left side rises and is concave for m < 1, so that Newton's method climbs to the root from any depth below it
/// and never passes it. It starts where neither term has more than half of the engagement.
pub(crate) fn share_out<N: Number>(engagement: N, compliance: N, wear: N, exponent: N, reference: f64) -> (N, N) {
    let straight = engagement / (compliance + wear + 1.0);
    if exponent.re() == 1.0 || straight.re() <= 0.0 || reference <= 0.0 {
        return (straight, compliance * straight);
    }
    let half = engagement * 0.5;
    let by_wear = half / (wear + 1.0);
    let by_force = depth_of_chip(half / compliance, exponent, reference);
    let mut depth = if by_wear.re() < by_force.re() { by_wear } else { by_force };
    let mut last = false;
    for _ in 0..200 {
        let bent = compliance * chip(depth, exponent, reference);
        let slope = wear + 1.0 + bent * exponent / depth;
        let step = (engagement - depth * (wear + 1.0) - bent) / slope;
        depth += step;
        if last {
            break;
        }
        // One step more: with it the derivatives of dual numbers are exact too.
        last = step.re().abs() <= 1e-15 * depth.re();
    }
    (depth, compliance * chip(depth, exponent, reference))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_deflection_is_shared_out_without_a_rest(
            engagement in -18.0..-3.0f64, compliance in -6.0..6.0f64, wear in 0.0..1.0f64, exponent in 0.3..1.0f64,
        ) {
            let (engagement, compliance) = (10f64.powf(engagement), 10f64.powf(compliance));
            let (depth, deflection) = share_out(engagement, compliance, wear, exponent, REFERENCE_DEPTH);
            prop_assert!(depth > 0.0);
            prop_assert!((depth * (1.0 + wear) + deflection - engagement).abs() <= 1e-12 * engagement);
        }
    }

    #[test]
    fn derivatives_pass_through_the_root() {
        use toolroom_process::num_dual::Dual64;
        let share = |engagement: f64| share_out(engagement, 1.3, 0.1, 0.8, REFERENCE_DEPTH).0;
        let dual =
            share_out(Dual64::new(4e-6, 1.0), Dual64::from(1.3), Dual64::from(0.1), Dual64::from(0.8), REFERENCE_DEPTH);
        let difference = (share(4.0001e-6) - share(3.9999e-6)) / 2e-10;
        assert!((dual.0.eps / difference - 1.0).abs() < 1e-8);
    }
}
