//! The depth that each limit allows on a wheel as it is.

use super::{CycleError, CycleLimits};
use crate::load::Load;
use crate::{Infeed, Input, State};

/// The greatest depth at which `grinding` stays below `temperature_rise`, m, at most `greatest`.
///
/// # Errors
/// The least temperature rise of any depth, where that is too hot.
pub fn depth_at_temperature(
    grinding: &Infeed,
    wheel: &State,
    input: &Input,
    temperature_rise: f64,
    greatest: f64,
) -> Result<f64, f64> {
    let rise = |depth_of_cut: f64| {
        let cut = State { depth_of_cut, ..*wheel };
        grinding.output_in_cut(&cut, input).temperature_rise
    };
    deepest(rise, temperature_rise, greatest)
}

/// The greatest depth at which `value` stays below `limit`, m, at most `greatest`; the least value of any depth where
/// that is too much.
fn deepest(value: impl Fn(f64) -> f64, limit: f64, greatest: f64) -> Result<f64, f64> {
    let rise = |log_depth: f64| value(greatest * log_depth.exp());
    if rise(0.0) <= limit {
        return Ok(greatest);
    }
    // The value has one minimum over the logarithm of the depth, as a rule far below any real
    // depth: where the chips carry off much, a deeper cut may be cooler than a threshold force alone.
    let (mut low, mut high) = (-30.0, 0.0);
    for _ in 0..200 {
        let third = (high - low) / 3.0;
        if rise(low + third) < rise(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    if rise(low) > limit {
        return Err(rise(low));
    }
    high = 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if rise(middle) <= limit {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(greatest * low.exp())
}

/// The greatest depth that the limits of every revolution allow on the wheel as it is, m: power, normal force, removal
/// rate and burn margin.
pub(super) fn depth_at_loads(
    grinding: &Infeed,
    wheel: &State,
    input: &Input,
    limits: &CycleLimits,
) -> Result<(f64, &'static str), CycleError> {
    let load = |depth_of_cut: f64| grinding.load(&State { depth_of_cut, ..*wheel }, input);
    let greatest = limits.greatest_infeed;
    let capped = |limit: &'static str, value: fn(&Load) -> f64, allowed: f64, words: fn(f64) -> String| {
        deepest(|depth| value(&load(depth)), allowed, greatest)
            .map(|depth| (depth, limit))
            .map_err(|least| CycleError::NoDepth { limit, least: words(least) })
    };
    let work_speed = 0.5 * input.work_rotation_speed * grinding.parameters.work_diameter;
    let caps = [
        capped("power", |load| load.power, limits.power, |least| format!("at least {:.4} kW", least * 1e-3))?,
        capped(
            "normal_force",
            |load| load.normal_force,
            limits.normal_force,
            |least| format!("at least {least:.4} N"),
        )?,
        capped(
            "burn_margin",
            |load| -load.least_margin(),
            -limits.burn_margin,
            |least| format!("at most {:.4}", -least),
        )?,
    ];
    let removal = (limits.material_removal / work_speed, "material_removal");
    Ok(caps.into_iter().fold(removal, lesser))
}

/// The lesser depth, with the limit that it comes from.
pub(super) fn lesser(a: (f64, &'static str), b: (f64, &'static str)) -> (f64, &'static str) {
    if b.0 < a.0 { b } else { a }
}

/// Whether a revolution keeps the limits that hold for all of them.
pub(super) fn keeps(load: &Load, limits: &CycleLimits) -> bool {
    let below = |value: f64, limit: f64| value <= limit * (1.0 + super::ROUNDING);
    below(load.temperature_rise, limits.rough_temperature_rise)
        && below(load.power, limits.power)
        && below(load.normal_force, limits.normal_force)
        && below(load.removal_rate, limits.material_removal)
        && load.least_margin() >= limits.burn_margin - super::ROUNDING
}
