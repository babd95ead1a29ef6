//! Where a sampled function changes sign.

/// Root of `f` between `a` and `b`, where it has the values `fa` and `fb` of opposite sign, to a
/// relative `tolerance` of the interval's far end: Brent's method (1973).
pub fn root<E>(
    mut f: impl FnMut(f64) -> Result<f64, E>,
    (mut a, mut fa): (f64, f64),
    (mut b, mut fb): (f64, f64),
    tolerance: f64,
) -> Result<f64, E> {
    let absolute = tolerance * a.abs().max(b.abs());
    let (mut c, mut fc) = (a, fa);
    let mut step = b - a;
    let mut previous = step;
    for _ in 0..100 {
        if fc.abs() < fb.abs() {
            (a, fa) = (b, fb);
            (b, fb) = (c, fc);
            (c, fc) = (a, fa);
        }
        let half = 0.5 * (c - b);
        if half.abs() <= absolute || fb == 0.0 {
            break;
        }
        if previous.abs() >= absolute && fa.abs() > fb.abs() {
            let s = fb / fa;
            let (mut p, mut q) = if a == c {
                (2.0 * half * s, 1.0 - s)
            } else {
                let (u, v) = (fa / fc, fb / fc);
                (s * (2.0 * half * u * (u - v) - (b - a) * (v - 1.0)), (u - 1.0) * (v - 1.0) * (s - 1.0))
            };
            if p > 0.0 {
                q = -q;
            }
            p = p.abs();
            if 2.0 * p < (3.0 * half * q - (absolute * q).abs()).min((previous * q).abs()) {
                previous = step;
                step = p / q;
            } else {
                step = half;
                previous = half;
            }
        } else {
            step = half;
            previous = half;
        }
        (a, fa) = (b, fb);
        b += if step.abs() > absolute { step } else { absolute.copysign(half) };
        fb = f(b)?;
        if (fb > 0.0) == (fc > 0.0) {
            (c, fc) = (a, fa);
            step = b - a;
            previous = step;
        }
    }
    Ok(b)
}

/// Brackets of the sign changes of `f` on `from … to`, sampled in `steps` equal steps, starting
/// from the value `first` at `from`.
pub fn brackets<E>(
    mut f: impl FnMut(f64) -> Result<f64, E>,
    (from, first): (f64, f64),
    end: f64,
    steps: usize,
    stop_at_first: bool,
) -> Result<Vec<[(f64, f64); 2]>, E> {
    let mut found = Vec::new();
    let mut last = (from, first);
    for step in 1..=steps {
        let x = from + (end - from) * step as f64 / steps as f64;
        let here = (x, f(x)?);
        if (here.1 > 0.0) != (last.1 > 0.0) {
            found.push([last, here]);
            if stop_at_first {
                break;
            }
        }
        last = here;
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_roots_of_hard_functions() {
        type Case = (fn(f64) -> f64, f64, f64, f64);
        let cases: [Case; 3] = [
            (|x| x.cos() - x, 0.0, 1.0, 0.739_085_133_215_160_6),
            (|x| (x - 1.0).powi(9), 0.0, 3.0, 1.0),
            (|x| (x - 1e-6).signum(), 0.0, 1.0, 1e-6),
        ];
        for (f, a, b, x) in cases {
            let found = root(|x| Ok::<_, std::convert::Infallible>(f(x)), (a, f(a)), (b, f(b)), 1e-12).unwrap();
            assert!((found - x).abs() < 1e-3 * x + 1e-11, "{found}");
        }
    }
}
