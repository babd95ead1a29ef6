//! Whether the effects of a model are large enough to be named.

use super::Forward;
use super::Trial;
use super::basis::Basis;
use super::channel_scale::ChannelScale;
use super::constants::LEAST_SIZE;

/// What stands against the size of an effect of a model: a small part of an ordinary one that moves no channel by as much as has to be
/// left of one before a gap counts as one that matters.
pub(super) fn too_small(model: &dyn Forward, basis: &Basis, trial: &Trial) -> Option<String> {
    let small = |(index, size): (&usize, f64)| size.abs() < LEAST_SIZE && !moves(model, basis, trial, *index, size);
    let sizes = trial.sizes(model);
    let smallest = trial.fit.active.iter().zip(sizes).filter(|each| small(*each)).map(|(_, size)| size.abs());
    let least = smallest.fold(f64::INFINITY, f64::min);
    least.is_finite().then(|| format!("its size is {least:.2} of an ordinary one, too small to matter"))
}

/// Whether an effect of `size` ordinary sizes moves a channel by more than what matters of it, in root mean square over all its
/// readings.
fn moves(model: &dyn Forward, basis: &Basis, trial: &Trial, index: usize, size: f64) -> bool {
    let (measured, linear) = (&model.frame().measured, &trial.fit.linear);
    (0..measured.channels.len()).any(|channel| {
        let of_channel = |i: &usize| measured.observations[*i].channel == channel;
        let places: Vec<usize> = (0..linear.residual.len()).filter(of_channel).collect();
        if places.is_empty() {
            return false;
        }
        let square = |i: &usize| linear.effects[index].get(*i).map_or(0.0, |slope| (slope * size).powi(2));
        let moved = (places.iter().map(square).sum::<f64>() / places.len() as f64).sqrt();
        ChannelScale::new(measured, &basis.noise, &linear.raw, channel, &places).matters(moved)
    })
}
