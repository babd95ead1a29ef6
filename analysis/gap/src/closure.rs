//! How far the gap shrinks on groups that the fit did not see.

use super::constants::{CLOSABLE, NINETY, TOO_FEW};
use super::left_out::LeftOut;
use super::measures::{Measures, ResidualPair, apart, usual};
use super::noise::HUBER;
use super::trial::Trial;
use super::{Basis, ChannelId, Closure, Forward, Measured, OutlyingReading, Transform};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Resamples of groups for an interval.
const RESAMPLES: usize = 400;
/// Stream of random numbers of the groups that are cut next: not that of the scored ones.
const NEW_GROUPS: u64 = u64::MAX;

/// Sums of squares of the groups on which a closure is scored.
pub(super) struct Sums {
    /// Of the nominal model.
    pub before: Vec<f64>,
    /// Of the model with effects.
    pub after: Vec<f64>,
    /// Of noise alone.
    pub floor: Vec<f64>,
    /// Number of readings.
    pub count: Vec<f64>,
}

/// Fits to other groups that an interval allows for.
pub(super) const FITS: usize = 100;

/// Closure by channel and over those that are `touched` (all, if none is named); the total is in
/// units of noise.
pub fn closures(
    model: &dyn Forward,
    basis: &Basis,
    base: &LeftOut,
    chosen: &LeftOut,
    scored: &[usize],
    touched: &[ChannelId],
    seed: u64,
) -> (Closure, Vec<(ChannelId, Closure)>) {
    let measured = &model.frame().measured;
    let among = counted(measured, touched);
    let channels = measured.channels.len();
    let sums = |[base, chosen]: [&[f64]; 2]| -> Vec<Sums> {
        let closure_of = |channel: usize| {
            let counts = |i: usize| match measured.observations[i].channel {
                own if channel < channels => own == channel,
                own => among[own],
            };
            let mut sums = Sums { before: Vec::new(), after: Vec::new(), floor: Vec::new(), count: Vec::new() };
            for group in scored {
                let inside = measured.spans[*group].clone();
                let (mut before, mut after, mut floor, mut count) = (0.0, 0.0, 0.0, 0.0);
                for i in inside.filter(|i| counts(*i)) {
                    let unit = basis.noise.deviation(measured, i);
                    let square = if channel < channels { unit * unit } else { 1.0 };
                    before += huber(base[i] / unit) * square;
                    after += huber(chosen[i] / unit) * square;
                    floor += square;
                    count += 1.0;
                }
                sums.before.push(before);
                sums.after.push(after);
                sums.floor.push(floor);
                sums.count.push(count);
            }
            sums
        };
        (0..=channels).map(closure_of).collect()
    };
    let values = sums([&base.residual, &chosen.residual]);
    let fits: Vec<Vec<Sums>> = if base.moves() && chosen.moves() {
        (0..FITS).into_par_iter().map(|draw| sums([&base.drawn(seed, draw), &chosen.drawn(seed, draw)])).collect()
    } else {
        Vec::new()
    };
    let one = |place: usize| {
        let fits: Vec<&Sums> = fits.iter().map(|fit| &fit[place]).collect();
        let left: Vec<ResidualPair> = if place < channels {
            readings(model, basis, [base, chosen], scored, place).into_iter().map(|(_, own)| own).collect()
        } else {
            among_channels(model, basis, [base, chosen], scored, &among)
        };
        closure(&values[place], &fits, &left, seed)
    };
    let by_channel = measured.channels.iter().enumerate().map(|(index, channel)| (channel.id, one(index))).collect();
    (one(channels), by_channel)
}

/// What two models leave of the readings of a channel in the groups `scored`, SI, with the place of each observation.
fn readings(
    model: &dyn Forward,
    basis: &Basis,
    [base, chosen]: [&LeftOut; 2],
    scored: &[usize],
    channel: usize,
) -> Vec<(usize, ResidualPair)> {
    let measured = &model.frame().measured;
    let transform = measured.channels[channel].transform;
    let off = |i: usize, residual: &[f64]| match transform {
        Transform::Linear => residual[i],
        Transform::Log => {
            let value = measured.observations[i].value;
            value.exp() - (value - residual[i]).exp()
        }
    };
    // What is usual is that of all groups: few may be scored.
    let all: Vec<usize> = (0..measured.len()).filter(|i| measured.observations[*i].channel == channel).collect();
    let frame = model.frame();
    let row = |i: &usize| measured.observations[*i].row;
    let before: Vec<f64> = all.iter().map(|i| off(*i, &base.residual)).collect();
    let repeats: Vec<Option<usize>> = all.iter().map(|i| frame.repeats.get(row(i)).copied().flatten()).collect();
    let kinds: Vec<usize> = all.iter().map(|i| frame.kind_of(row(i))).collect();
    let mut usual_of = vec![f64::INFINITY; measured.len()];
    all.iter().zip(usual(&before, &repeats, &kinds)).for_each(|(i, own)| usual_of[*i] = own);
    let weight_of = |i: usize| {
        let deviation = basis.noise.deviation(measured, i);
        let deviation =
            if transform == Transform::Log { deviation * measured.observations[i].value.exp() } else { deviation };
        let (before, after) = (off(i, &base.residual), off(i, &chosen.residual));
        (i, ResidualPair { before, after, deviation, usual: usual_of[i] })
    };
    let places = scored.iter().flat_map(|group| measured.spans[*group].clone());
    places.filter(|i| measured.observations[*i].channel == channel).map(weight_of).collect()
}

/// The same of all channels that `count`, in standard deviations of the noise.
fn among_channels(
    model: &dyn Forward,
    basis: &Basis,
    left: [&LeftOut; 2],
    scored: &[usize],
    count: &[bool],
) -> Vec<ResidualPair> {
    let readings_of = |channel: usize| readings(model, basis, left, scored, channel);
    let all = (0..count.len()).filter(|channel| count[*channel]).flat_map(readings_of);
    all.map(|(_, reading)| reading.standardised()).collect()
}

/// What two models leave of the scored readings of the channels `touched` (all, if none is named), in standard deviations
/// of the noise.
pub(super) fn standardised(
    model: &dyn Forward,
    basis: &Basis,
    left: [&LeftOut; 2],
    touched: &[ChannelId],
) -> Vec<ResidualPair> {
    let measured = &model.frame().measured;
    among_channels(model, basis, left, &scored(measured), &counted(measured, touched))
}

/// Readings in the groups `scored` that stand apart with either model.
pub(super) fn standing_apart(
    model: &dyn Forward,
    basis: &Basis,
    left: [&LeftOut; 2],
    scored: &[usize],
) -> Vec<OutlyingReading> {
    let frame = model.frame();
    let measured = &frame.measured;
    let closed_by = |channel: usize| {
        let (places, lefts): (Vec<usize>, Vec<ResidualPair>) =
            readings(model, basis, left, scored, channel).into_iter().unzip();
        let about = &measured.channels[channel];
        let row = |at: usize| OutlyingReading {
            row: frame.record_of(measured.observations[places[at]].row),
            operation_id: String::new(),
            channel: about.id,
            excess: lefts[at].before,
            unit: about.unit,
        };
        apart(&lefts).into_iter().map(row).collect::<Vec<_>>()
    };
    (0..measured.channels.len()).flat_map(closed_by).collect()
}

/// Whether each channel counts for effects that touch some: all, if none of them is measured.
pub(super) fn counted(measured: &Measured, touched: &[ChannelId]) -> Vec<bool> {
    let is_touched: Vec<bool> = measured.channels.iter().map(|channel| touched.contains(&channel.id)).collect();
    // An effect may act where the catalogue does not list it: then everything counts.
    if is_touched.iter().any(|counts| *counts) { is_touched } else { vec![true; is_touched.len()] }
}

/// Channels that the effects of a trial touch.
pub fn touched(model: &dyn Forward, trial: &Trial) -> Vec<ChannelId> {
    touched_by(model, &trial.fit.active)
}

/// Channels that the candidates `active` touch.
pub(super) fn touched_by(model: &dyn Forward, active: &[usize]) -> Vec<ChannelId> {
    active.iter().flat_map(|index| model.frame().candidates[*index].id.channels()).collect()
}

/// Groups on which a closure is scored: those outside the fit, or all.
pub fn scored(measured: &Measured) -> Vec<usize> {
    let outside: Vec<usize> = (0..measured.groups.len())
        .filter(|group| !measured.fitted[*group] && !measured.spans[*group].is_empty())
        .collect();
    if outside.is_empty() { measured.fitted_groups().collect() } else { outside }
}

/// Square up to far outliers, then linear: a single reading does not decide about a gap.
pub(super) fn huber(standard: f64) -> f64 {
    let far = 4.0 * HUBER;
    if standard.abs() <= far { standard * standard } else { far * (2.0 * standard.abs() - far) }
}

/// `fits` are sums with fits to other groups; none where the fit counts as it is. `left` are the readings themselves.
pub(super) fn closure(sums: &Sums, fits: &[&Sums], left: &[ResidualPair], seed: u64) -> Closure {
    let groups: Vec<usize> = (0..sums.count.len()).filter(|i| sums.count[*i] > 0.0).collect();
    // Every group counts alike: else the one with the most readings would decide.
    let root = |values: &[f64], groups: &[usize]| {
        (groups.iter().map(|i| values[*i] / sums.count[*i]).sum::<f64>() / groups.len() as f64).sqrt()
    };
    let closed = |sums: &Sums, groups: &[usize]| 1.0 - root(&sums.after, groups) / root(&sums.before, groups);
    let (before, after, floor) = (root(&sums.before, &groups), root(&sums.after, &groups), root(&sums.floor, &groups));
    let value = closed(sums, &groups);
    let itself = [sums];
    let fits = if fits.is_empty() { &itself[..] } else { fits };
    // A fit to other groups is as far from the best as this one: on the whole it closes less.
    let middle = fits.iter().map(|fit| closed(fit, &groups)).sum::<f64>() / fits.len() as f64;
    let resampled = |random: &mut ChaCha8Rng| -> Vec<usize> {
        groups.iter().map(|_| groups[random.random_range(0..groups.len())]).collect()
    };
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let expected: Vec<f64> =
        (0..RESAMPLES).map(|draw| value + closed(fits[draw % fits.len()], &resampled(&mut random)) - middle).collect();
    // New groups scatter around what is expected as the scored ones do, and independently of them.
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(NEW_GROUPS);
    let new: Vec<f64> = expected.iter().map(|draw| draw + closed(sums, &resampled(&mut random)) - value).collect();
    // Resampling few groups gives intervals that are too short: those of Student against those of
    // the normal, with one degree of freedom less for the mean.
    let count = groups.len() as f64;
    let wider = toolroom_statistics::student(0.9, count - 1.0) / NINETY * (count / (count - 1.0)).sqrt();
    let stretch = |end: f64| (value + (end - value) * if wider.is_finite() { wider } else { TOO_FEW }).min(1.0);
    let interval = |mut draws: Vec<f64>| {
        draws.retain(|draw| draw.is_finite());
        draws.sort_by(f64::total_cmp);
        let place = |share: f64| ((draws.len() as f64 * share) as usize).min(draws.len().saturating_sub(1));
        [0.05, 0.95].map(|share| stretch(draws.get(place(share)).copied().unwrap_or(value)))
    };
    let closable = before * before - floor * floor;
    Closure {
        before,
        after,
        closed: value,
        ci90: interval(expected),
        pi90: interval(new),
        of_closable: if closable > CLOSABLE * before * before {
            ((before * before - after * after) / closable).min(1.0)
        } else {
            f64::NAN
        },
        measures: Measures::of(left),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight groups of ten readings, of which `after` is left.
    fn sums(after: [f64; 8]) -> Sums {
        Sums { before: vec![40.0; 8], after: after.to_vec(), floor: vec![10.0; 8], count: vec![10.0; 8] }
    }

    #[test]
    fn fits_to_other_groups_widen_an_interval_around_the_same_closure() {
        let sums_here = sums([8.0, 9.0, 10.0, 11.0, 9.5, 10.5, 12.0, 10.0]);
        let others =
            [0.5, 0.8, 1.1, 1.6].map(|factor| sums([8.0, 9.0, 10.0, 11.0, 9.5, 10.5, 12.0, 10.0].map(|x| factor * x)));
        let (narrow, wide) =
            (closure(&sums_here, &[], &[], 1), closure(&sums_here, &others.iter().collect::<Vec<_>>(), &[], 1));
        assert_eq!(narrow.closed, wide.closed);
        assert!((narrow.closed - 0.5).abs() < 1e-12);
        let width = |closure: &Closure| closure.ci90[1] - closure.ci90[0];
        assert!(width(&wide) > 3.0 * width(&narrow), "{narrow:?} {wide:?}");
        assert!(wide.ci90[0] < 0.5 && 0.5 < wide.ci90[1]);
        assert_eq!(
            closure(&sums_here, &[&sums_here], &[], 1).ci90,
            narrow.ci90,
            "a fit that does not move changes nothing"
        );
    }

    /// Shops whose groups scatter by a third in what an effect leaves of them. The mean of exp(sx) is exp(s²/2): all groups
    /// together close 1 − √(0.3 exp(0.045)).
    #[test]
    fn nine_of_ten_intervals_hold_the_closure_of_all_groups_or_that_of_as_many_new_ones() {
        const SHOPS: usize = 400;
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut shop = |groups: usize| {
            let mut normal = || -> f64 { rand_distr::Distribution::sample(&rand_distr::StandardNormal, &mut random) };
            let before: Vec<f64> = (0..groups).map(|_| 40.0 * (0.2 * normal()).exp()).collect();
            let after = before.iter().map(|before| 0.3 * before * (0.3 * normal()).exp()).collect();
            Sums { before, after, floor: vec![1.0; groups], count: vec![10.0; groups] }
        };
        let of_all = 1.0 - (0.3 * 0.045_f64.exp()).sqrt();
        let (mut expected, mut new, mut confused) = (0, 0, 0);
        for seed in 0..SHOPS as u64 {
            let (found, next) = (closure(&shop(12), &[], &[], seed), closure(&shop(12), &[], &[], seed).closed);
            let holds = |[low, high]: [f64; 2], value: f64| usize::from(low <= value && value <= high);
            expected += holds(found.ci90, of_all);
            new += holds(found.pi90, next);
            confused += holds(found.ci90, next);
        }
        // Three standard errors of a share of 0.9 among 400 are 0.045; the bootstrap of twelve groups costs some hundredths.
        for held in [expected, new] {
            assert!((0.84..=0.945).contains(&(held as f64 / SHOPS as f64)), "{expected} and {new} of {SHOPS}");
        }
        // Twelve new groups are no population: 0.755 of them by 1.645/√2 standard deviations.
        assert!((0.68..=0.83).contains(&(confused as f64 / SHOPS as f64)), "{confused} of {SHOPS}");
    }
}
