//! Form tolerance: the function of a named effect is no more exact than any other equation.
//!
//! A true cause grows a little faster or slower than the catalogue's function of it, and shows a
//! little more in one channel than in another. Without room for that, a strong effect drags a second
//! one along that does nothing but mend its form.

use super::constants::TOLERANCE;
use super::{Forward, Linear};

/// Columns by which the contributions of the `active` candidates may differ from those of the
/// catalogue, per prior standard deviation: `c ln |c|` of a contribution c (another exponent) and c
/// itself where several channels are touched, channel by channel. `sizes` count in ordinary sizes.
pub(super) fn columns(model: &dyn Forward, linear: &Linear, active: &[usize], sizes: &[f64]) -> Vec<Vec<f64>> {
    let measured = &model.frame().measured;
    let mut columns = Vec::new();
    for (index, size) in active.iter().zip(sizes) {
        let contribution: Vec<f64> = linear.effects[*index].iter().map(|slope| slope * size).collect();
        // An effect that is there or not has no other exponent: rows without it do not count.
        let mean_square = |channel: usize| {
            let pairs = contribution.iter().zip(&measured.observations);
            let pairs = pairs.filter(|(value, each)| each.channel == channel && **value != 0.0);
            let (sum, count) = pairs.fold((0.0, 0.0), |(sum, count), (value, _)| (sum + value * value, count + 1.0));
            if count > 0.0 { sum / count } else { 0.0 }
        };
        let levels: Vec<f64> = (0..measured.channels.len()).map(mean_square).map(f64::sqrt).collect();
        let touched: Vec<usize> = (0..levels.len()).filter(|channel| levels[*channel] > 0.0).collect();
        for channel in &touched {
            let bent = |value: f64| {
                let share = value.abs() / levels[*channel];
                if share > 0.0 { value * share.ln() } else { 0.0 }
            };
            let moments_of = |change: &dyn Fn(f64) -> f64| -> Vec<f64> {
                let pairs = contribution.iter().zip(&measured.observations);
                let inside = |(value, observation): (&f64, &super::Observation)| {
                    if observation.channel == *channel { TOLERANCE * change(*value) } else { 0.0 }
                };
                pairs.map(inside).collect()
            };
            columns.push(moments_of(&bent));
            if touched.len() > 1 {
                columns.push(moments_of(&|value| value));
            }
        }
    }
    columns
}
