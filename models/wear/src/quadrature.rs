//! Adaptive Gauss–Kronrod quadrature of several integrands at once.

/// Nodes of the 15-point Kronrod rule, positive half, outermost first.
const NODE: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_5,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_48,
    0.0,
];
/// Kronrod weights.
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_56,
    0.104_790_010_322_250_19,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_42,
    0.204_432_940_075_298_89,
    0.209_482_141_084_727_82,
];
/// Weights of the embedded 7-point Gauss rule, at every second node.
const GAUSS: [f64; 4] =
    [0.129_484_966_168_869_7, 0.279_705_391_489_276_64, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];

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
    start: f64,
    end: f64,
    relative: f64,
) -> [f64; D] {
    let middle = 0.5 * (start + end);
    let halves = [(start, middle), (middle, end)].map(|(a, b)| (a, b, rule(&mut f, a, b)));
    let scale: [f64; D] = std::array::from_fn(|i| relative * halves.iter().map(|half| half.2.0[i].abs()).sum::<f64>());
    let mut total = [0.0; D];
    for (a, b, estimate) in halves {
        refine(&mut f, a, b, estimate, &scale, DEPTH, &mut total);
    }
    total
}

fn refine<const D: usize>(
    f: &mut impl FnMut(f64) -> [f64; D],
    start: f64,
    end: f64,
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
    let middle = 0.5 * (start + end);
    for (a, b) in [(start, middle), (middle, end)] {
        let estimate = rule(f, a, b);
        refine(f, a, b, estimate, scale, depth - 1, total);
    }
}

/// Kronrod estimate and its distance from the Gauss estimate.
fn rule<const D: usize>(f: &mut impl FnMut(f64) -> [f64; D], start: f64, end: f64) -> ([f64; D], [f64; D]) {
    let (centre, half) = (0.5 * (start + end), 0.5 * (end - start));
    let (mut kronrod, mut gauss) = ([0.0; D], [0.0; D]);
    let mut add = |node: usize, value: [f64; D]| {
        for i in 0..D {
            kronrod[i] += KRONROD[node] * value[i];
            if node % 2 == 1 {
                gauss[i] += GAUSS[node / 2] * value[i];
            }
        }
    };
    for (node, abscissa) in NODE.iter().enumerate().take(7) {
        add(node, f(centre - half * abscissa));
        add(node, f(centre + half * abscissa));
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
