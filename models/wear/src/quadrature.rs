//! Adaptive Gauss–Kronrod quadrature of several integrands at once.

/// Nodes of the 15-point Kronrod rule, positive half, outermost first.
const NODE: [f64; 8] = [
    0.991455371120812639206854697526329,
    0.949107912342758524526189684047851,
    0.864864423359769072789712788640926,
    0.741531185599394439863864773280788,
    0.586087235467691130294144691838259,
    0.405845151377397166906606412076961,
    0.207784955007898467600689403773245,
    0.0,
];
/// Kronrod weights.
const KRONROD: [f64; 8] = [
    0.022935322010529224963732008058970,
    0.063092092629978553290700663189204,
    0.104790010322250183839876322541518,
    0.140653259715525918745189590510238,
    0.169004726639267902826583426598550,
    0.190350578064785409913256402421014,
    0.204432940075298892414161999234649,
    0.209482141084727828012999174891714,
];
/// Weights of the embedded 7-point Gauss rule, at every second node.
const GAUSS: [f64; 4] = [
    0.129484966168869693270611432679082,
    0.279705391489276667901467771423780,
    0.381830050505118944950369775488975,
    0.417959183673469387755102040816327,
];

/// Deepest halving of an interval; reached at a jump only.
const DEPTH: u32 = 40;

/// Integrals of the components of `f` over `[from, to]`, each to `relative` of its size.
///
/// The difference of the two rules, which far overstates the error of the better one on a
/// smooth integrand, is held to the tolerance on every interval.
///
/// # Source
/// Nodes and weights of QUADPACK (Piessens et al. 1983), routine `qk15`.
pub(crate) fn integrate<const D: usize>(
    mut f: impl FnMut(f64) -> [f64; D],
    from: f64,
    to: f64,
    relative: f64,
) -> [f64; D] {
    let middle = 0.5 * (from + to);
    let halves = [(from, middle), (middle, to)].map(|(a, b)| (a, b, rule(&mut f, a, b)));
    let scale: [f64; D] = std::array::from_fn(|i| relative * halves.iter().map(|half| half.2.0[i].abs()).sum::<f64>());
    let mut total = [0.0; D];
    for (a, b, estimate) in halves {
        refine(&mut f, a, b, estimate, &scale, DEPTH, &mut total);
    }
    total
}

fn refine<const D: usize>(
    f: &mut impl FnMut(f64) -> [f64; D],
    from: f64,
    to: f64,
    (value, error): ([f64; D], [f64; D]),
    scale: &[f64; D],
    depth: u32,
    total: &mut [f64; D],
) {
    // A value that is not finite can not be refined to one that is.
    let settled = (0..D).all(|i| error[i] <= scale[i] || !value[i].is_finite());
    if settled || depth == 0 {
        for (sum, part) in total.iter_mut().zip(value) {
            *sum += part;
        }
        return;
    }
    let middle = 0.5 * (from + to);
    for (a, b) in [(from, middle), (middle, to)] {
        let estimate = rule(f, a, b);
        refine(f, a, b, estimate, scale, depth - 1, total);
    }
}

/// Kronrod estimate and its distance from the Gauss estimate.
fn rule<const D: usize>(f: &mut impl FnMut(f64) -> [f64; D], from: f64, to: f64) -> ([f64; D], [f64; D]) {
    let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut kronrod, mut gauss) = ([0.0; D], [0.0; D]);
    let mut add = |node: usize, value: [f64; D]| {
        for i in 0..D {
            kronrod[i] += KRONROD[node] * value[i];
            if node % 2 == 1 {
                gauss[i] += GAUSS[node / 2] * value[i];
            }
        }
    };
    for (node, at) in NODE.iter().enumerate().take(7) {
        add(node, f(centre - half * at));
        add(node, f(centre + half * at));
    }
    add(7, f(centre));
    (kronrod.map(|sum| half * sum), std::array::from_fn(|i| (half * (kronrod[i] - gauss[i])).abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_up_to_degree_22_are_exact() {
        // One interval: two halves of a symmetric range share the rule.
        for degree in 0..=22 {
            let [value] = rule(&mut |x: f64| [x.powi(degree)], 0.0, 1.0).0;
            let exact = 1.0 / f64::from(degree + 1);
            assert!((value / exact - 1.0).abs() < 1e-14, "degree {degree}: {value}");
        }
    }

    #[test]
    fn a_kink_and_a_sharp_peak_are_resolved() {
        let [kink, peak] = integrate(|x| [(x - 0.3).abs(), 1.0 / (1e-4 + x * x)], -1.0, 1.0, 1e-9);
        assert!((kink - 1.09).abs() < 1e-9);
        assert!((peak / (200.0 * 100.0f64.atan()) - 1.0).abs() < 1e-9);
    }
}
