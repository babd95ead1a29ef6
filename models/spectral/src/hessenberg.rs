//! Eigenvalues of small real upper Hessenberg matrices.

use nalgebra::Complex;

/// Sweeps to one eigenvalue before the matrix is given up.
const MAX_SWEEPS: usize = 60;

/// Eigenvalues of the upper Hessenberg matrix `h` (row-major, `n` × `n`, overwritten) in
/// `values`; `None` if the iteration stalls.
///
/// Entries below the share `negligible` of the matrix norm count as zero: the great eigenvalues
/// matter, and the many that are nearly zero would cost most sweeps.
///
/// Francis's double-shift QR, values only (EISPACK's `hqr`, Martin, Peters and Wilkinson 1970).
pub(crate) fn eigenvalues(h: &mut [f64], n: usize, negligible: f64, values: &mut Vec<Complex<f64>>) -> Option<()> {
    values.clear();
    values.resize(n, Complex::new(0.0, 0.0));
    let norm: f64 =
        (0..n).map(|i| h[i * n + i.saturating_sub(1)..(i + 1) * n].iter().map(|v| v.abs()).sum::<f64>()).sum();
    let mut shift = 0.0;
    let mut end = n; // rows `end..` are done
    let mut sweeps = 0;
    while end > 0 {
        let last = end - 1;
        let start = deflate(h, n, last, negligible * norm);
        let x = h[last * n + last];
        if start == last {
            values[last] = Complex::new(x + shift, 0.0);
            end -= 1;
            sweeps = 0;
            continue;
        }
        let y = h[(last - 1) * n + last - 1];
        let w = h[last * n + last - 1] * h[(last - 1) * n + last];
        if start + 1 == last {
            (values[last - 1], values[last]) = pair(x, y, w, shift);
            end -= 2;
            sweeps = 0;
            continue;
        }
        if sweeps == MAX_SWEEPS {
            return None;
        }
        let mut shifts = (x, y, w);
        if sweeps % 10 == 9 {
            // An exceptional shift breaks the rare cycles.
            shift += x;
            for i in 0..=last {
                h[i * n + i] -= x;
            }
            let s = h[last * n + last - 1].abs() + h[(last - 1) * n + last - 2].abs();
            shifts = (0.75 * s, 0.75 * s, -0.4375 * s * s);
        }
        sweeps += 1;
        sweep(h, n, start, last, shifts);
    }
    Some(())
}

/// First row of the unreduced block that ends at `last`; zeroes the negligible entry before it.
fn deflate(h: &mut [f64], n: usize, last: usize, negligible: f64) -> usize {
    for l in (1..=last).rev() {
        let s = h[(l - 1) * n + l - 1].abs() + h[l * n + l].abs();
        if h[l * n + l - 1].abs() <= f64::EPSILON * s + negligible {
            h[l * n + l - 1] = 0.0;
            return l;
        }
    }
    0
}

/// Eigenvalues of the trailing 2 × 2 block.
fn pair(x: f64, y: f64, w: f64, shift: f64) -> (Complex<f64>, Complex<f64>) {
    let p = 0.5 * (y - x);
    let q = p * p + w;
    let z = q.abs().sqrt();
    let x = x + shift;
    if q >= 0.0 {
        let z = p + z.copysign(p);
        let second = if z == 0.0 { x } else { x - w / z };
        (Complex::new(x + z, 0.0), Complex::new(second, 0.0))
    } else {
        (Complex::new(x + p, z), Complex::new(x + p, -z))
    }
}

/// One implicit double-shift sweep over rows `start..=last`.
fn sweep(h: &mut [f64], n: usize, start: usize, last: usize, (sx, sy, sw): (f64, f64, f64)) {
    let at = |i: usize, j: usize| i * n + j;
    let (mut p, mut q, mut r);
    let mut m = last - 2;
    loop {
        let z = h[at(m, m)];
        let (a, b) = (sx - z, sy - z);
        p = (a * b - sw) / h[at(m + 1, m)] + h[at(m, m + 1)];
        q = h[at(m + 1, m + 1)] - z - a - b;
        r = h[at(m + 2, m + 1)];
        let s = p.abs() + q.abs() + r.abs();
        (p, q, r) = (p / s, q / s, r / s);
        if m == start {
            break;
        }
        let small = h[at(m, m - 1)].abs() * (q.abs() + r.abs());
        let large = p.abs() * (h[at(m - 1, m - 1)].abs() + z.abs() + h[at(m + 1, m + 1)].abs());
        if small <= f64::EPSILON * large {
            break;
        }
        m -= 1;
    }
    for i in m..last - 1 {
        h[at(i + 2, i)] = 0.0;
        if i != m {
            h[at(i + 2, i - 1)] = 0.0;
        }
    }
    for k in m..last {
        let inner = k + 1 != last;
        let mut scale = 0.0;
        if k != m {
            p = h[at(k, k - 1)];
            q = h[at(k + 1, k - 1)];
            r = if inner { h[at(k + 2, k - 1)] } else { 0.0 };
            scale = p.abs() + q.abs() + r.abs();
            if scale == 0.0 {
                continue;
            }
            let inverse = 1.0 / scale;
            (p, q, r) = (p * inverse, q * inverse, r * inverse);
        }
        let s = (p * p + q * q + r * r).sqrt().copysign(p);
        if s == 0.0 {
            continue;
        }
        if k != m {
            h[at(k, k - 1)] = -s * scale;
        } else if start != m {
            h[at(k, k - 1)] = -h[at(k, k - 1)];
        }
        p += s;
        let (inverse_s, inverse_p) = (1.0 / s, 1.0 / p);
        let (x, y, z) = (p * inverse_s, q * inverse_s, r * inverse_s);
        let (qp, rp) = (q * inverse_p, r * inverse_p);
        for j in k..=last {
            let mut t = h[at(k, j)] + qp * h[at(k + 1, j)];
            if inner {
                t += rp * h[at(k + 2, j)];
                h[at(k + 2, j)] -= t * z;
            }
            h[at(k + 1, j)] -= t * y;
            h[at(k, j)] -= t * x;
        }
        for i in start..=(k + 3).min(last) {
            let mut t = x * h[at(i, k)] + y * h[at(i, k + 1)];
            if inner {
                t += z * h[at(i, k + 2)];
                h[at(i, k + 2)] -= t * rp;
            }
            h[at(i, k + 1)] -= t * qp;
            h[at(i, k)] -= t;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sorted(mut values: Vec<Complex<f64>>) -> Vec<f64> {
        values.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        values.iter().map(|v| v.norm()).collect()
    }

    proptest! {
        #[test]
        fn agrees_with_the_schur_form(entries in prop::collection::vec(-1.0f64..1.0, 81), n in 1usize..=9) {
            let mut h: Vec<f64> =
                (0..n * n).map(|at| if at / n > at % n + 1 { 0.0 } else { entries[at] }).collect();
            let reference = nalgebra::DMatrix::from_row_slice(n, n, &h).complex_eigenvalues();
            let mut values = Vec::new();
            eigenvalues(&mut h, n, 0.0, &mut values).unwrap();
            for (a, b) in sorted(values).iter().zip(sorted(reference.iter().copied().collect())) {
                prop_assert!((a - b).abs() < 1e-6, "{a} {b}");
            }
        }
    }

    #[test]
    fn cyclic_shift_has_roots_of_unity() {
        let n = 8;
        let mut h = vec![0.0; n * n];
        for i in 0..n {
            h[((i + 1) % n) * n + i] = 1.0;
        }
        h[n - 1] = 1.0;
        let mut values = Vec::new();
        eigenvalues(&mut h, n, 0.0, &mut values).unwrap();
        assert!(values.iter().all(|v| (v.norm() - 1.0).abs() < 1e-12), "{values:?}");
    }
}
