//! What a radial offset of the cutter axis does to the chip of each tooth.
//!
//! The teeth lie at the offsets `ρ·sin(2π(j + ½)/z)`: the orientation that loads a tooth most.
//! Tooth j cuts what the k-th tooth before it has left, whichever left least:
//! `h_j = min over k of k f_z sin φ + offset_j − offset_{j−k}`, and nothing where that is
//! negative. Chip passes from tooth to tooth; the sum over the teeth stays.
//!
//! Source: Kline & DeVor 1983, parallel offset.

use super::least;
use std::f64::consts::{PI, TAU};
use toolroom_process::Number;

/// Offset of a tooth relative to the runout.
fn offset(tooth: u32, teeth: u32) -> f64 {
    (TAU * (f64::from(tooth) + 0.5) / f64::from(teeth)).sin()
}

/// Runout over feed per tooth, times this, is the sine of the angle below which the tooth does
/// not touch; not positive where it touches from the start.
fn lift(tooth: u32, teeth: u32) -> f64 {
    let by = |back: u32| (offset(tooth + teeth - back, teeth) - offset(tooth, teeth)) / f64::from(back);
    (1..=teeth).map(by).fold(f64::NEG_INFINITY, f64::max)
}

/// Whether all teeth cut alike, so that one stands for all: the same bits, far fewer sines. A
/// dual number keeps the general way, its slope in the runout is wanted.
fn runs_true<N: Number>(runout: N) -> bool {
    N::NDERIV == 0 && runout.re() == 0.0
}

/// Integrals over the contact of all teeth, from 0 to the engagement angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact<N> {
    /// ∫ dφ
    pub angle: N,
    /// ∫ sin φ dφ
    pub sine: N,
    /// ∫ cos φ dφ
    pub cosine: N,
}

impl<N: Number> Contact<N> {
    /// Contact of `teeth` teeth at `runout` relative to the feed per tooth.
    pub(super) fn new(teeth: u32, runout: N, engagement: N) -> Self {
        let zero = N::from(0.0);
        let mut sum = Self { angle: zero, sine: zero, cosine: zero };
        if runs_true(runout) {
            let last = least(engagement, N::from(PI));
            let (sine, cosine) = (-last.cos() + 1.0, last.sin());
            for _ in 0..teeth {
                sum = Self { angle: sum.angle + last, sine: sum.sine + sine, cosine: sum.cosine + cosine };
            }
            return sum;
        }
        for tooth in 0..teeth {
            let lift = lift(tooth, teeth);
            let touch = if lift > 0.0 { runout * lift } else { zero };
            if touch.re() >= 1.0 {
                continue;
            }
            let first = touch.asin();
            let last = least(engagement, -first + PI);
            if first.re() < last.re() {
                sum.angle += last - first;
                sum.sine += first.cos() - last.cos();
                sum.cosine += last.sin() - first.sin();
            }
        }
        sum
    }
}

/// Thickest chip of the heaviest tooth, where the nominal chip is `nominal` thick.
pub(super) fn heaviest<N: Number>(teeth: u32, runout: N, nominal: N) -> N {
    if runs_true(runout) {
        return nominal;
    }
    let left = |back: u32| {
        let excess = offset(0, teeth) - offset(teeth - back, teeth);
        nominal * f64::from(back) + runout * excess
    };
    (2..=teeth).map(left).fold(left(1), least)
}
