//! Particles between what was known of the modes and what the cuts say.

use super::UpdateError;
use rayon::prelude::*;
use std::f64::consts::PI;
use toolroom_chatter::{ChatterError, Direction, Draw, Engagement, Milling, Mode, StabilityLimit, Turning};
use toolroom_dynamics::ShopCut;
use toolroom_lobes::{LobesCut, LobesFile, Structure};
use toolroom_records::{CHATTER_FREQUENCY_DEVIATION, WRONG_CHATTER_RECORD};

/// Modes and the factor of the force coefficients that one particle stands for.
pub(super) type Values = (Vec<Mode>, f64);

/// Share of the particles that must count in a step of the tempering.
const EFFECTIVE: f64 = 0.5;
/// Metropolis moves after each resampling.
const MOVES: u64 = 3;
/// Data sets drawn from the prior to judge how surprising the observed one is.
const DRAWN: usize = 400;
/// Speeds and depths of the next cuts that are considered, and particles that judge them.
const NEXT: ([usize; 2], usize) = ([24, 12], 200);

/// Cuts at one speed and immersion from which on their limit is worked out once, instead of a verdict for each. What is stable
/// again beyond the first limit counts as unstable then.
const MANY: usize = 4;
/// Depths up to which a limit of milling is searched, over the greatest depth that was cut, and steps of that search, as in the
/// shop: an island thinner than a step can be missed.
const SEARCHED: (f64, usize) = (2.0, 24);

/// Relative difference of speeds below which cuts have one limit: the step of speeds in the shop.
const ALIKE: f64 = 5e-4;

/// What is asked of a particle.
pub(super) struct Question<'a> {
    file: &'a LobesFile,
    structure: &'a Structure,
    cuts: &'a [ShopCut],
    /// Cuts at one speed and immersion, by number.
    groups: Vec<Vec<usize>>,
    /// The groups in the order in which they are judged: those first that can tell most against a particle.
    order: Vec<usize>,
    /// Relative standard deviations: three of every mode, one of the coefficient.
    pub sds: Vec<f64>,
}

/// A particle in standard normal coordinates, with what it says of every cut.
#[derive(Clone)]
pub(super) struct Particle {
    pub z: Vec<f64>,
    pub likelihood: f64,
    pub unstable: Vec<bool>,
}

impl<'a> Question<'a> {
    pub fn new(file: &'a LobesFile, structure: &'a Structure, cuts: &'a [ShopCut], sds: Vec<f64>) -> Self {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (number, cut) in cuts.iter().enumerate() {
            let same = |group: &&mut Vec<usize>| {
                let first = &cuts[group[0]];
                (first.spindle_speed / cut.spindle_speed - 1.0).abs() < ALIKE && first.immersion == cut.immersion
            };
            match groups.iter_mut().find(same) {
                Some(group) => group.push(number),
                None => groups.push(vec![number]),
            }
        }
        let mut order: Vec<usize> = (0..groups.len()).collect();
        order.sort_by_key(|group| std::cmp::Reverse(groups[*group].len()));
        Self { file, structure, cuts, groups, order, sds }
    }

    /// Values of the modes, and the factor of the coefficient.
    pub fn values(&self, z: &[f64]) -> (Vec<Mode>, f64) {
        let factor = |i: usize| (self.sds[i] * z[i]).exp();
        let modes = self.structure.modes.iter().enumerate();
        let known = self.structure.deviations.len();
        let modes = modes.map(|(i, mode)| {
            // Modes that stand for those above the range are kept.
            if i >= known {
                return *mode;
            }
            Mode {
                natural_frequency: mode.natural_frequency * factor(3 * i),
                damping_ratio: (mode.damping_ratio * factor(3 * i + 1)).min(0.9),
                stiffness: mode.stiffness * factor(3 * i + 2),
                ..*mode
            }
        });
        (modes.collect(), factor(3 * known))
    }

    /// Whether each cut of a group is unstable, and the frequency (Hz) of the limit where one was observed. What is not found
    /// counts as unstable and has no frequency. `many` cuts are judged by one limit.
    fn judge(&self, modes: &[Mode], factor: f64, cuts: &[&ShopCut], many: bool) -> Result<Judged, UpdateError> {
        let speed = cuts[0].spindle_speed;
        let deepest = cuts.iter().map(|cut| cut.depth).fold(0.0, f64::max);
        let observed = cuts.iter().any(|cut| cut.frequency.is_some());
        let found = |answer: Result<bool, ChatterError>| match answer {
            Err(error) if !error.is_failed_search() => Err(UpdateError::from(error)),
            answer => Ok(answer.unwrap_or(true)),
        };
        let beyond = |limit: &Result<StabilityLimit, ChatterError>, cut: &ShopCut| match limit {
            Ok(limit) => Ok(cut.depth > limit.depth),
            Err(ChatterError::NoLimit { .. }) => Ok(false),
            Err(error) => found(Err(*error)),
        };
        match &self.file.cut {
            LobesCut::Milling(milling) => {
                let mut milling =
                    Milling { modes: modes.to_vec(), by_speed: None, along_path: None, ..milling.clone() };
                milling.force.tangential *= factor;
                milling.force.radial *= factor;
                milling.force.axial *= factor;
                if let Some(immersion) = cuts[0].immersion {
                    let down = milling.engagement.entry.abs() > (PI - milling.engagement.exit).abs();
                    let direction = if down { Direction::Down } else { Direction::Up };
                    milling.engagement = Engagement::new(immersion, direction)?;
                }
                let mut at_speed = milling.at_speed(speed)?;
                let (reach, steps) = SEARCHED;
                let depths: Vec<f64> = cuts.iter().map(|cut| cut.depth).collect();
                if many && !observed {
                    let beyond = at_speed.beyond_rough_limit(&depths, reach * deepest, steps);
                    return match beyond {
                        Ok(beyond) => Ok((beyond, None)),
                        Err(error) => found(Err(error)).map(|unstable| (vec![unstable; cuts.len()], None)),
                    };
                }
                let limit = observed.then(|| at_speed.rough_limit(reach * deepest, steps));
                let unstable = match &limit {
                    Some(limit) if many => cuts.iter().map(|cut| beyond(limit, cut)).collect::<Result<_, _>>()?,
                    _ => {
                        let judged = |cut: &&ShopCut| found(at_speed.screen(cut.depth).map(|verdict| !verdict.stable));
                        cuts.iter().map(judged).collect::<Result<_, _>>()?
                    }
                };
                Ok((unstable, limit.and_then(Result::ok).map(|limit| limit.chatter_frequency)))
            }
            LobesCut::Turning { cut: turning, bar } => {
                let mut turning =
                    Turning { modes: modes.to_vec(), by_speed: None, along_path: None, ..turning.clone() };
                turning.cutting_coefficient *= factor;
                if let Some((bar, place)) = bar {
                    turning.modes.push(bar.mode_at(*place)?);
                }
                if cuts[0].immersion.is_some() {
                    return Err(UpdateError::Immersion);
                }
                let limit = (many || observed).then(|| turning.limit(speed));
                let unstable = match &limit {
                    Some(limit) if many => cuts.iter().map(|cut| beyond(limit, cut)).collect::<Result<_, _>>()?,
                    _ => {
                        let judged = |cut: &&ShopCut| found(turning.is_stable(speed, cut.depth).map(|stable| !stable));
                        cuts.iter().map(judged).collect::<Result<_, _>>()?
                    }
                };
                Ok((unstable, limit.and_then(Result::ok).map(|limit| limit.chatter_frequency)))
            }
            LobesCut::Chuck(_) | LobesCut::ChipLag(_) | LobesCut::Lathe(_) => Err(UpdateError::Process),
        }
    }

    pub fn particle(&self, z: Vec<f64>) -> Result<Particle, UpdateError> {
        Ok(self.particle_above(z, f64::NEG_INFINITY)?.expect(ABOVE_ALL))
    }

    /// The particle, if its logarithm of the likelihood is above `floor`; judged no further than to where that is out of
    /// reach, whatever the other cuts say.
    fn particle_above(&self, z: Vec<f64>, floor: f64) -> Result<Option<Particle>, UpdateError> {
        let (modes, factor) = self.values(&z);
        let mut judged: Vec<Option<Judged>> = vec![None; self.groups.len()];
        // What is left when every cut that is not judged yet is as the particle says.
        let mut most = self.cuts.len() as f64 * told(true, true).ln();
        for group in &self.order {
            if most < floor - ROUNDING * (1.0 + floor.abs()) {
                return Ok(None);
            }
            let cuts = self.cuts_of(*group);
            let answer = self.judge(&modes, factor, &cuts, cuts.len() >= MANY)?;
            most += self.told_by(&cuts, &answer) - cuts.len() as f64 * told(true, true).ln();
            judged[*group] = Some(answer);
        }
        let (mut likelihood, mut unstable) = (0.0, vec![false; self.cuts.len()]);
        for (number, answer) in judged.into_iter().enumerate() {
            let Some(answer) = answer else { continue };
            let cuts = self.cuts_of(number);
            for ((cut, place), chatters) in cuts.iter().zip(&self.groups[number]).zip(&answer.0) {
                likelihood += told(cut.chatter, *chatters).ln();
                unstable[*place] = *chatters;
            }
            likelihood += read_frequency(&cuts, answer.1);
        }
        Ok(Some(Particle { z, likelihood, unstable }))
    }

    fn cuts_of(&self, group: usize) -> Vec<&ShopCut> {
        self.groups[group].iter().map(|cut| &self.cuts[*cut]).collect()
    }

    /// Logarithm of the likelihood of the cuts of a group.
    fn told_by(&self, cuts: &[&ShopCut], answer: &Judged) -> f64 {
        let records = cuts.iter().zip(&answer.0).map(|(cut, chatters)| told(cut.chatter, *chatters).ln());
        records.sum::<f64>() + read_frequency(cuts, answer.1)
    }
}

/// Why a particle is judged to the end.
const ABOVE_ALL: &str = "no likelihood lies below minus infinity";

/// Whether each cut of a group is unstable, and the frequency (Hz) of its limit where one was observed.
type Judged = (Vec<bool>, Option<f64>);

/// Relative rounding that a sum of likelihoods can have: a thousand cuts and more (assumption, far above 1e-16 each).
const ROUNDING: f64 = 1e-9;

/// Logarithm of the likelihood of the frequencies that were read in a group whose limit has `frequency` (Hz).
fn read_frequency(cuts: &[&ShopCut], frequency: Option<f64>) -> f64 {
    // What the limit's frequency is off by is shared by all cuts at one speed: their mean is one reading.
    let read: Vec<f64> = cuts.iter().filter_map(|cut| cut.frequency).collect();
    if read.is_empty() {
        return 0.0;
    }
    let observed = read.iter().sum::<f64>() / read.len() as f64;
    // A limit that was not found is three standard deviations away.
    let apart = frequency.map_or(3.0, |frequency| (observed / frequency - 1.0) / CHATTER_FREQUENCY_DEVIATION);
    -0.5 * apart * apart
}

/// Probability of a record.
fn told(chatter: bool, unstable: bool) -> f64 {
    if chatter == unstable { 1.0 - WRONG_CHATTER_RECORD } else { WRONG_CHATTER_RECORD }
}

/// Particles of the posterior, and the logarithm of the evidence. `progress` is told which share of the way is done: the power of
/// the likelihood grows by about the same factor from stage to stage.
pub(super) fn tempered(
    question: &Question<'_>,
    mut particles: Vec<Particle>,
    seed: u64,
    progress: &dyn Fn(f64),
) -> Result<(Vec<Particle>, f64), UpdateError> {
    let mut first = None;
    let count = particles.len();
    let (mut power, mut evidence) = (0.0, 0.0);
    let mut stage = 0;
    while power < 1.0 {
        let greatest = particles.iter().map(|particle| particle.likelihood).fold(f64::NEG_INFINITY, f64::max);
        let weights = |step: f64| -> Vec<f64> {
            particles.iter().map(|particle| (step * (particle.likelihood - greatest)).exp()).collect()
        };
        let effective = |weights: &[f64]| {
            let (sum, square) = weights.iter().fold((0.0, 0.0), |(sum, square), w| (sum + w, square + w * w));
            sum * sum / square
        };
        let mut step = 1.0 - power;
        if effective(&weights(step)) < EFFECTIVE * count as f64 {
            let (mut low, mut high) = (0.0, step);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if effective(&weights(middle)) < EFFECTIVE * count as f64 { high = middle } else { low = middle }
            }
            step = low.max(1e-4);
        }
        let weights = weights(step);
        let sum: f64 = weights.iter().sum();
        evidence += (sum / count as f64).ln() + step * greatest;
        power = (power + step).min(1.0);
        // Systematic resampling.
        let mut draw = Draw::new(seed ^ 0x5DEE_CE66, stage);
        let offset = draw.uniform();
        let (mut chosen, mut below, mut i) = (Vec::with_capacity(count), weights[0], 0);
        for n in 0..count {
            let place = (n as f64 + offset) / count as f64 * sum;
            while below < place && i + 1 < count {
                i += 1;
                below += weights[i];
            }
            chosen.push(particles[i].clone());
        }
        let size = question.sds.len();
        let spread: Vec<f64> = (0..size)
            .map(|d| {
                let mean = chosen.iter().map(|particle| particle.z[d]).sum::<f64>() / count as f64;
                (chosen.iter().map(|particle| (particle.z[d] - mean).powi(2)).sum::<f64>() / count as f64).sqrt()
            })
            .collect();
        for sweep in 0..MOVES {
            let moved = |(i, particle): (usize, Particle)| {
                let mut draw = Draw::new(seed.wrapping_add(0x9E37 * (1 + stage * MOVES + sweep)), i as u64);
                let scale = 2.38 / (size as f64).sqrt();
                let z: Vec<f64> =
                    particle.z.iter().zip(&spread).map(|(z, sd)| z + scale * sd * draw.normal()).collect();
                let prior = |z: &[f64]| -0.5 * z.iter().map(|z| z * z).sum::<f64>();
                let (by_prior, level) = (prior(&z) - prior(&particle.z), draw.uniform().ln());
                // A proposal that has to be more likely than the cuts allow is not judged any further.
                let floor = particle.likelihood + (level - by_prior) / power;
                let Some(next) = question.particle_above(z, floor)? else { return Ok(particle) };
                let gain = by_prior + power * (next.likelihood - particle.likelihood);
                Ok(if level < gain { next } else { particle })
            };
            chosen = chosen.into_par_iter().enumerate().map(moved).collect::<Result<_, UpdateError>>()?;
        }
        particles = chosen;
        let first: &mut f64 = first.get_or_insert(power);
        progress(if *first < 1.0 { 1.0 - power.ln() / first.ln() } else { 1.0 });
        stage += 1;
    }
    Ok((particles, evidence))
}

/// Whether each cut chatters, 64 to a word.
fn words(records: &[bool]) -> Vec<u64> {
    let word = |part: &[bool]| part.iter().rev().fold(0, |word, bit| word << 1 | u64::from(*bit));
    records.chunks(64).map(word).collect()
}

/// Share of data sets drawn from the prior that are as probable as the cuts or less; of chatter or none alone.
pub(super) fn surprise(prior: &[Particle], cuts: &[ShopCut], seed: u64) -> f64 {
    let sets: Vec<Vec<u64>> = prior.iter().map(|particle| words(&particle.unstable)).collect();
    // Logarithm of the probability but for a constant: every record that differs costs as much.
    let cost = ((1.0 - WRONG_CHATTER_RECORD) / WRONG_CHATTER_RECORD).ln();
    let evidence = |records: &[bool]| -> f64 {
        let records = words(records);
        let differs = |set: &Vec<u64>| set.iter().zip(&records).map(|(a, b)| (a ^ b).count_ones()).sum::<u32>();
        let counts: Vec<u32> = sets.iter().map(differs).collect();
        let least = counts.iter().copied().min().unwrap_or(0);
        let sum: f64 = counts.iter().map(|count| (-cost * f64::from(count - least)).exp()).sum();
        sum.ln() - cost * f64::from(least)
    };
    let observed: Vec<bool> = cuts.iter().map(|cut| cut.chatter).collect();
    let observed = evidence(&observed);
    let drawn = |i: usize| {
        let mut draw = Draw::new(seed ^ 0xA5A5, i as u64);
        let particle = &prior[i % prior.len()];
        let records: Vec<bool> =
            particle.unstable.iter().map(|unstable| *unstable != (draw.uniform() < WRONG_CHATTER_RECORD)).collect();
        evidence(&records) <= observed + 1e-9
    };
    let fewer = (0..DRAWN).into_par_iter().filter(|i| drawn(*i)).count();
    fewer as f64 / DRAWN as f64
}

/// The cut of the chart that would tell most: where the particles agree least.
pub(super) fn next(
    question: &Question<'_>,
    values: &[(Vec<Mode>, f64)],
) -> Result<Option<(f64, f64, f64)>, UpdateError> {
    let chart = &question.file.chart;
    let ([columns, rows], judges) = NEXT;
    let step = (values.len() / judges).max(1);
    let place = |axis: &toolroom_chatter::Axis, i: usize, of: usize| {
        axis.start + (axis.end - axis.start) * (i as f64 + 0.5) / of as f64
    };
    // What the depths at one speed share is worked out once for each particle.
    let column = |i: usize| -> Result<Vec<(f64, f64, f64)>, UpdateError> {
        let speed = place(&chart.speed, i, columns);
        let cut = |j: usize| ShopCut {
            spindle_speed: speed,
            depth: place(&chart.depth, j, rows),
            immersion: None,
            chatter: false,
            frequency: None,
        };
        let cuts: Vec<ShopCut> = (0..rows).map(cut).collect();
        let asked: Vec<&ShopCut> = cuts.iter().collect();
        let (mut unstable, mut count) = (vec![0.0; rows], 0.0);
        for (modes, factor) in values.iter().step_by(step) {
            let (chatters, _) = question.judge(modes, *factor, &asked, false)?;
            unstable.iter_mut().zip(chatters).for_each(|(sum, chatters)| *sum += f64::from(u8::from(chatters)));
            count += 1.0;
        }
        Ok(cuts.iter().zip(unstable).map(|(cut, unstable)| (speed, cut.depth, unstable / count)).collect())
    };
    let found: Vec<Vec<(f64, f64, f64)>> =
        (0..columns).into_par_iter().map(column).collect::<Result<_, UpdateError>>()?;
    let found: Vec<(f64, f64, f64)> = found.into_iter().flatten().collect();
    Ok(found.into_iter().min_by(|a, b| (a.2 - 0.5).abs().total_cmp(&(b.2 - 0.5).abs())))
}
