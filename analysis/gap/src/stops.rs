//! Whether time that grows with the time in cut was lost in stops or evenly.
//!
//! Short stops that nobody books and an override of the feed lengthen operations by the same share in the mean, so that a
//! fit of means cannot tell one from the other. Their scatter can: an override lengthens each operation by its share, while stops
//! come as a Poisson process whose lengths scatter too, so that some operations have none and some several. The rows that
//! the effect touches are held against both densities ([`Stopped`] is that of stops).

use super::constants::GATE;
use super::decision::Decision;
use super::diagnosing::Diagnosing;
use super::trial::Trial;
use super::{ChannelId, EffectId, Transform};
use toolroom_nominal::compound::{FOREIGN, Stopped, normal};
use toolroom_scenario::MICRO_STOP;

/// Effects that leave the same means.
const KINDS: [EffectId; 2] = [EffectId::MICRO_STOPS, EffectId::FEED_OVERRIDE];
/// Factors on the mean length of a stop that are tried (1). Assumption: stops of one shop are half to twice as long as
/// those of another.
const LENGTHS: [f64; 3] = [0.5, 1.0, 2.0];
/// Factors on the fitted mean that are tried (1): a robust fit takes some stops for outliers. Assumption.
const SHARES: [f64; 5] = [0.7, 0.85, 1.0, 1.2, 1.45];
/// Standard deviations of the rest that are tried (count), from [`LEAST`] to what all rows scatter by.
const SPREADS: usize = 10;
/// Least standard deviation of the rest, of that of the sensor (1). Assumption: as of every sensor sheet.
const LEAST: f64 = 0.5;
/// Rows that are looked at (count): as many tell the two apart for certain. Assumption.
const ROWS: usize = 400;
/// A row that the effect touches.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Touched {
    /// Recorded time beyond that of the model without the effect, s.
    excess: f64,
    /// What the effect adds in the mean, s.
    mean: f64,
    /// Standard deviation of the sensor, s.
    sensor: f64,
}

/// The model of trial `index`, or that in which the other kind of loss stands in the place of the one that the scatter of the
/// rows contradicts.
pub(super) fn settled(context: Diagnosing<'_>, decision: &mut Decision, index: usize) -> usize {
    let mut index = index;
    for candidate in decision.trials[index].fit.active.clone() {
        let trial = &decision.trials[index];
        let Some(other) = twin(context, candidate) else { continue };
        if trial.fit.active.contains(&other) || !leads(context, trial, candidate, other) {
            continue;
        }
        let kept = trial.fit.active.iter().copied().filter(|own| *own != candidate);
        let mut active: Vec<usize> = kept.chain([other]).collect();
        active.sort_unstable();
        let exchanged = context.trial(&trial.fit, &active);
        if exchanged.evidence.admissible {
            decision.trials.push(exchanged);
            index = decision.trials.len() - 1;
        }
    }
    index
}

/// Whether the scatter of the rows speaks clearly for the effect `candidate` of `trial` and against `other`, which leaves the
/// same means.
pub(super) fn tells_from(context: Diagnosing<'_>, trial: &Trial, candidate: usize, other: EffectId) -> bool {
    let twin = twin(context, candidate).filter(|twin| context.model.frame().candidates[*twin].id == other);
    twin.is_some() && leads(context, trial, candidate, candidate)
}

/// Candidates that leave the same means as an effect of `trial`, and that the scatter of the rows speaks against.
pub(super) fn contradicted(context: Diagnosing<'_>, trial: &Trial) -> Vec<usize> {
    let active = trial.fit.active.iter();
    active.filter(|own| leads(context, trial, **own, **own)).filter_map(|own| twin(context, *own)).collect()
}

/// Whether the rows that `candidate` of `trial` touches speak clearly for the kind of loss that `kind` is.
fn leads(context: Diagnosing<'_>, trial: &Trial, candidate: usize, kind: usize) -> bool {
    let stops = context.model.frame().candidates[kind].id == EffectId::MICRO_STOPS;
    lead(context, trial, candidate).is_some_and(|lead| if stops { lead > GATE } else { lead < -GATE })
}

/// The candidate that is lost time of the other kind on the same rows; `None` of any other effect, and of what is recorded.
fn twin(context: Diagnosing<'_>, candidate: usize) -> Option<usize> {
    let model = context.model;
    let candidates = &model.frame().candidates;
    let own = candidates[candidate].id;
    let written = model.written(candidate);
    if !KINDS.contains(&own) || written.recorded.is_some() {
        return None;
    }
    let alike = |index: &usize| {
        let there = model.written(*index);
        let id = candidates[*index].id;
        id != own && KINDS.contains(&id) && there.scope == written.scope && there.recorded.is_none()
    };
    (0..candidates.len()).find(alike)
}

/// Log likelihood by which stops lead over an even loss on the rows of `candidate` in `trial`; `None` where it has no rows of
/// a cycle time, or makes them shorter.
fn lead(context: Diagnosing<'_>, trial: &Trial, candidate: usize) -> Option<f64> {
    if !KINDS.contains(&context.model.frame().candidates[candidate].id) {
        return None;
    }
    let rows = touched(context, trial, candidate);
    if rows.is_empty() || rows.iter().any(|row| row.mean <= 0.0) {
        return None;
    }
    Some(by_stops(&rows) - evenly(&rows))
}

fn touched(context: Diagnosing<'_>, trial: &Trial, candidate: usize) -> Vec<Touched> {
    let frame = context.model.frame();
    let (measured, linear) = (&frame.measured, &trial.fit.linear);
    let size = linear.point.effects[candidate] / frame.candidates[candidate].typical;
    let is_time: Vec<bool> = measured
        .channels
        .iter()
        .map(|channel| channel.id == ChannelId::CycleTime && channel.transform == Transform::Linear)
        .collect();
    let row = |place: usize| {
        let mean = size * linear.effects[candidate].get(place)?;
        let observation = &measured.observations[place];
        let fitted = measured.fitted[measured.group_of_row[observation.row]];
        (is_time[observation.channel] && fitted && mean != 0.0).then(|| Touched {
            excess: linear.residual[place] + mean,
            mean,
            sensor: observation.deviation,
        })
    };
    let all: Vec<Touched> = (0..measured.len()).filter_map(row).collect();
    let every = all.len().div_ceil(ROWS).max(1);
    all.into_iter().step_by(every).collect()
}

/// Standard deviations of the rest that are tried, s, and that of what something else did to a row.
fn spreads(rows: &[Touched]) -> (Vec<f64>, f64) {
    let count = rows.len() as f64;
    let least = LEAST * rows.iter().map(|row| row.sensor).sum::<f64>() / count;
    let whole = (rows.iter().map(|row| (row.excess - row.mean).powi(2)).sum::<f64>() / count).sqrt();
    let greatest = whole.max(2.0 * least);
    let step = (greatest / least).powf(1.0 / (SPREADS - 1) as f64);
    let furthest = rows.iter().map(|row| row.excess.abs()).fold(greatest, f64::max);
    ((0..SPREADS).map(|i| least * step.powi(i as i32)).collect(), furthest)
}

/// Greatest log likelihood of rows that are all longer by their share.
fn evenly(rows: &[Touched]) -> f64 {
    greatest(rows, |row, share, spread| normal(row.excess - share * row.mean, spread))
}

/// Greatest log likelihood of rows that are longer by their stops.
fn by_stops(rows: &[Touched]) -> f64 {
    let of_length = |factor: &f64| {
        let length = factor * MICRO_STOP;
        greatest(rows, |row, share, spread| Stopped::new(row.excess, share * row.mean / length, length, spread).density)
    };
    LENGTHS.iter().map(of_length).fold(f64::NEG_INFINITY, f64::max)
}

/// Greatest log likelihood over shares and spreads of rows whose density is `density`, but for those that are foreign.
fn greatest(rows: &[Touched], density: impl Fn(&Touched, f64, f64) -> f64) -> f64 {
    let (spreads, furthest) = spreads(rows);
    let of = |share: f64, spread: f64| {
        let one = |row: &Touched| {
            let foreign = normal(row.excess, furthest);
            ((1.0 - FOREIGN) * density(row, share, spread) + FOREIGN * foreign).ln()
        };
        rows.iter().map(one).sum::<f64>()
    };
    let all = SHARES.iter().flat_map(|share| spreads.iter().map(move |spread| (*share, *spread)));
    all.map(|(share, spread)| of(share, spread)).fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Exp, Normal, Poisson, StudentT};

    const SENSOR: f64 = 0.5;

    /// Rows of `count` operations whose stops, or whose share, takes `mean` in the mean; the rest scatters by `rest`.
    fn rows(count: usize, mean: f64, stops: bool, rest: impl Fn(&mut ChaCha8Rng) -> f64, seed: u64) -> Vec<Touched> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let row = |_| {
            let mean = mean * (0.7 + 0.6 * random.random::<f64>());
            let lost = if stops {
                let number: f64 = Poisson::new(mean / MICRO_STOP).expect("positive").sample(&mut random);
                (0..number as usize).map(|_| Exp::new(1.0 / MICRO_STOP).expect("positive").sample(&mut random)).sum()
            } else {
                mean
            };
            Touched { excess: lost + rest(&mut random), mean, sensor: SENSOR }
        };
        (0..count).map(row).collect()
    }

    /// Leads of stops over an even loss in twenty samples of thirty operations.
    fn leads(mean: f64, stops: bool, rest: impl Fn(&mut ChaCha8Rng) -> f64 + Copy) -> Vec<f64> {
        let sample = |seed| rows(30, mean, stops, rest, seed);
        (0..20).map(|seed| by_stops(&sample(seed)) - evenly(&sample(seed))).collect()
    }

    #[test]
    fn thirty_operations_tell_stops_from_an_even_loss() {
        let narrow = |random: &mut ChaCha8Rng| Normal::new(0.0, 4.0).expect("finite").sample(random);
        let wide = |random: &mut ChaCha8Rng| 3.0 * StudentT::new(4.0).expect("positive").sample(random);
        let clearly = |leads: &[f64], sign: f64| leads.iter().filter(|lead| sign * **lead > GATE).count();
        // A stop an operation, a stop in three operations, and even losses as long.
        for (mean, stops, sign, least) in
            [(20.0, true, 1.0, 18), (6.0, true, 1.0, 15), (20.0, false, -1.0, 18), (6.0, false, -1.0, 0)]
        {
            for leads in [leads(mean, stops, narrow), leads(mean, stops, wide)] {
                let right = clearly(&leads, sign);
                assert!(right >= least, "{mean} s, stops {stops}: {right} of 20, {leads:?}");
                assert_eq!(clearly(&leads, -sign), 0, "{mean} s, stops {stops}: {leads:?}");
            }
        }
    }

    #[test]
    fn seconds_or_minutes_tell_the_same() {
        let narrow = |random: &mut ChaCha8Rng| Normal::new(0.0, 4.0).expect("finite").sample(random);
        let rows = rows(30, 20.0, false, narrow, 7);
        let scaled =
            |row: &Touched| Touched { excess: 60.0 * row.excess, mean: 60.0 * row.mean, sensor: 60.0 * row.sensor };
        let long: Vec<Touched> = rows.iter().map(scaled).collect();
        // Densities of an even loss scale with the unit.
        assert!((evenly(&rows) - evenly(&long) - 30.0 * 60f64.ln()).abs() < 1e-6);
    }
}
