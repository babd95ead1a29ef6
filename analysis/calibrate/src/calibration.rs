//! A calibration from data to answers.

use crate::base::{Base, Condition};
use crate::channels::{ChannelFit, forces, heat};
use crate::chipping::{ChippingFit, Exposure};
use crate::choice::{Choice, Verdict};
use crate::end::End;
use crate::fit::Maximum;
use crate::identify::Identifiability;
use crate::left_out::{Coverage, LeftOut, fits_without, leave_edges_out, left_out};
use crate::model::Model;
use crate::profile::profiles;
use crate::request::Request;
use crate::sample::{Method, Posterior, maxima, sample_around};
use crate::shape::{Candidate, Shape};
use crate::treatment::{Clock, Measured};
use crate::wear_model::{EDGE_SCATTER, READING_NOISE, WearModel};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::sync::atomic::{AtomicU32, Ordering};
use toolroom_form::nearest;
use toolroom_numerics::order_quantile;

/// Least edges at which the coverage of left-out readings is judged.
const JUDGED: usize = 8;
/// Coverage of the 90 % band that is no reason for a warning.
const COVERED: std::ops::RangeInclusive<f64> = 0.75..=0.99;

/// Ratio of the fastest to the slowest speed below which speeds count as one, so that other conditions are listed.
const ONE_SPEED: f64 = 1.02;
/// Speeds at which lives are listed where more were cut.
const LISTED: usize = 8;

/// Edges that took no part in a calibration, predicted by it.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldOut {
    /// Their names.
    pub names: Vec<String>,
    /// What was predicted of each.
    pub left_out: Vec<LeftOut>,
    /// How often the predictions hold.
    pub coverage: Coverage,
}

/// Why nothing could be calibrated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// A parameter that no law has.
    #[error("no parameter `{name}`{}; there are {known}", near.as_ref().map_or_else(String::new, |near| format!(", did you mean `{near}`?")))]
    Parameter {
        /// What was read.
        name: String,
        /// What may have been meant.
        near: Option<String>,
        /// What there is.
        known: String,
    },
    /// A value at which no law has the parameter.
    #[error("--fix {name}={value}: {reason}")]
    Fixed {
        /// The parameter.
        name: String,
        /// The value.
        value: f64,
        /// Why not.
        reason: String,
    },
    /// An edge to be held out that the data do not have, or too few others.
    #[error("--holdout: {0}")]
    HeldOut(String),
    /// The density of no start is finite.
    #[error("the law {0} cannot describe these data at any start; check units and times")]
    NoDensity(&'static str),
}

/// A law fitted to all edges.
#[derive(Clone, Debug)]
pub struct LawFit {
    /// The model.
    pub model: WearModel,
    /// Its maximum.
    pub maximum: Maximum,
    /// Its predictions of edges left out.
    pub left_out: Vec<LeftOut>,
}

/// Life at a cut, min.
#[derive(Clone, Debug, PartialEq)]
pub struct LifeAt {
    /// The cut.
    pub condition: Condition,
    /// Median over the draws of the life of an edge of median level.
    pub median: f64,
    /// 5 % and 95 % points of the same.
    pub ci90: [f64; 2],
    /// 5 % and 95 % points of the life of the next edge.
    pub next_edge90: [f64; 2],
    /// Whether edges were cut at such a speed.
    pub tested: bool,
}

/// The result of a calibration.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The set as it was given.
    pub(crate) stated: Base,
    /// The data.
    pub measured: Measured,
    /// What was wanted.
    pub request: Request,
    /// The choice of the law.
    pub choice: Choice,
    /// Every law.
    pub fits: Vec<LawFit>,
    /// The posterior of the law that the set carries.
    pub posterior: Posterior,
    /// What the data determine of it.
    pub identifiability: Identifiability,
    /// How often its predictions of edges left out hold.
    pub coverage: Coverage,
    /// Temperatures, forces and power against wear, for each channel that was measured and told something: temperature and
    /// thermo-EMF, then cutting force, or else spindle power, then feed force.
    pub channels: Vec<ChannelFit>,
    /// The rate of chipping, where it is reported how edges ended.
    pub chipping: Option<ChippingFit>,
    /// Edges that took no part.
    pub held_out: Option<HeldOut>,
    /// 90 % profile intervals of the working coordinates, where they were requested.
    pub profiles: Option<Vec<[f64; 2]>>,
    /// Lives at the tested speeds and between them.
    pub lives: Vec<LifeAt>,
    /// Speed in m/min at which the life is known best, with the standard deviation of its logarithm there.
    pub best_known: (f64, f64),
}

/// Parts of the work after the fits: draws of the posterior, lives and channels, edges held out.
const LAST_PARTS: u32 = 3;

impl Calibration {
    /// Calibrates on measured edges; what the law does not say is taken from `base`.
    ///
    /// # Errors
    /// [`CalibrationError`]: an unknown parameter, data that no law can describe.
    ///
    /// # Panics
    /// Where the request names no law.
    pub fn new(measured: Measured, base: impl Into<Base>, request: Request) -> Result<Self, CalibrationError> {
        Self::with_progress(measured, base, request, &|_, _| ())
    }

    /// As [`new`](Self::new), with its errors; `progress` is told how many parts of the work are done, of how many.
    pub fn with_progress(
        measured: Measured,
        base: impl Into<Base>,
        request: Request,
        progress: &(dyn Fn(u32, u32) + Sync),
    ) -> Result<Self, CalibrationError> {
        let stated = base.into().referred_to(&usual_cut(&measured));
        let (measured, whole) = if request.held_out.is_empty() {
            (measured, None)
        } else {
            (measured.without(&request.held_out).map_err(CalibrationError::HeldOut)?, Some(measured))
        };
        let by = request.by.as_deref().unwrap_or("group");
        let groups: Vec<String> = measured.groups.iter().skip(1).map(|word| format!("{by}={word}")).collect();
        let conditions = measured.conditions.clone();
        let models = |base: &Base| -> Result<Vec<WearModel>, CalibrationError> {
            let model = |candidate: &Candidate| {
                let (base, edges) = (base.clone(), measured.edges.clone());
                let model = WearModel::new(*candidate, base, conditions.clone(), edges, request.limit);
                let model = model.with_groups(&groups);
                match request.life_noise {
                    Some(correlation) => model.with_life_noise(correlation),
                    None => model,
                }
            };
            let mut models: Vec<WearModel> = request.candidates.iter().map(model).collect();
            apply(&mut models, &request)?;
            if measured.clock == Clock::Operations {
                let (life, usual) = (measured.usual_life(request.limit), usual_cut(&measured));
                models = models.into_iter().map(|model| model.by_operations(life, &usual)).collect();
            }
            Ok(models)
        };
        // Wear depends on temperatures, so that these come first.
        let (base, mut channels) = heat(&stated, &measured, &request, &models(&stated)?);
        let models = models(&base)?;
        let all: Vec<usize> = (0..measured.edges.len()).collect();
        let total = models.iter().map(|model| 1 + fits_without(model)).sum::<usize>() as u32 + LAST_PARTS;
        let count = AtomicU32::new(0);
        let part = || progress(count.fetch_add(1, Ordering::Relaxed) + 1, total);
        let (mut fits, mut around) = (Vec::new(), Vec::new());
        for model in models {
            let found = maxima(&model, &all, request.seed);
            let (maximum, modes) = found.ok_or(CalibrationError::NoDensity(model.law.group()))?;
            around.push(modes);
            part();
            let left_out = leave_edges_out(&model, &maximum, request.seed, &part);
            fits.push(LawFit { model, maximum, left_out });
        }
        let candidates: Vec<(Candidate, Vec<LeftOut>)> =
            fits.iter().map(|fit| (fit.model.candidate(), fit.left_out.clone())).collect();
        let mut choice = Choice::of(&candidates, &measured.speeds());
        if measured.ends_short_of(request.limit) {
            choice = choice.short_of_limit(measured.greatest(), request.limit);
        }
        let place = fits.iter().position(|fit| fit.model.candidate() == choice.carried);
        let place = place.expect("the choice is one of the laws");
        let carried = &fits[place];
        let maxima = (carried.maximum.clone(), std::mem::take(&mut around[place]));
        let posterior = sample_around(&carried.model, &all, maxima, request.draws, request.seed);
        part();
        let identifiability = Identifiability::from_model(&carried.model, &posterior);
        let coverage = Coverage::from_left_outs(&carried.left_out);
        let lives = lives(&carried.model, &posterior, &measured, request.seed);
        if let Base::Turning { pair, .. } = &base {
            channels.extend(forces(&carried.model, posterior.map.u.as_slice(), &measured, pair, &request));
        }
        part();
        let best_known = best_known(&carried.model, &posterior, &measured);
        let chipping = chipping(&carried.model, &posterior, &measured, &base);
        let held_out = whole.map(|whole| held_out(&carried.model, &carried.maximum, &whole, &request));
        part();
        let profiles = request.profile.then(|| profiles(&carried.model, &all, &posterior.map));
        Ok(Self {
            stated,
            measured,
            request,
            choice,
            fits,
            posterior,
            identifiability,
            coverage,
            channels,
            chipping,
            held_out,
            profiles,
            lives,
            best_known,
        })
    }

    /// The fit of the law that the set carries.
    pub fn carried(&self) -> &LawFit {
        self.fits
            .iter()
            .find(|fit| fit.model.candidate() == self.choice.carried)
            .expect("the choice is one of the laws")
    }

    /// Whether the law or a parameter of the carried law is undetermined.
    pub fn undetermined(&self) -> bool {
        let parameters = 0..self.carried().model.parameters().len();
        self.choice.verdict == Verdict::CannotTell
            || parameters.into_iter().any(|i| !self.identifiability.determined(i))
    }

    /// Remarks on the result that a reader must not miss.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.coverage.edges >= JUDGED && !COVERED.contains(&self.coverage.inside90) {
            let inside = 100.0 * self.coverage.inside90;
            // Few readings are all inside by chance alone.
            let by_chance = inside > 90.0 && 0.9_f64.powi(self.coverage.readings as i32) > 0.05;
            let what =
                if inside > 90.0 { "the bands are wider than they say" } else { "the intervals cannot be relied on" };
            if !by_chance {
                warnings
                    .push(format!("{inside:.0} % of the readings of edges left out lie in their 90 % bands: {what}"));
            }
        }
        warnings.extend(self.far_from_priors());
        warnings.extend(self.unfitted());
        if !self.posterior.modes.is_empty() {
            let count = self.posterior.modes.len();
            let how = match self.posterior.method {
                Method::Ensemble => "the ensemble was used",
                Method::ResampledLaplace | Method::MomentMatched => "the draws meet all of them",
            };
            warnings.push(format!("{count} more maximum(s) of the posterior within 5 logarithms: {how}"));
        }
        if self.posterior.split_r > 1.01 {
            warnings.push(format!(
                "the ensemble has not converged (split R-hat {:.3}): take more data",
                self.posterior.split_r
            ));
        }
        warnings
    }
}

/// Whether a parameter is one of a channel and none of wear.
fn of_channel(name: &str) -> bool {
    ["force.", "temperature.", "emf."].iter().any(|group| name.starts_with(group))
}

fn apply(models: &mut [WearModel], request: &Request) -> Result<(), CalibrationError> {
    let unknown = |name: &str, mut known: Vec<String>| {
        known.sort();
        known.dedup();
        // The group may be left out, in what was read as in what is meant.
        let keys = known.iter().map(|known| known.split_once('.').map_or(known.as_str(), |(_, key)| key));
        let near = nearest(name, known.iter().map(String::as_str)).or_else(|| nearest(name, keys)).map(str::to_owned);
        CalibrationError::Parameter { name: name.to_owned(), near, known: known.join(", ") }
    };
    for (name, prior) in request.priors.iter().filter(|(name, _)| !of_channel(name) && name != READING_NOISE) {
        let mut found = false;
        for model in models.iter_mut() {
            found |= model.set_prior(name, *prior) || model.fixed(name);
        }
        if !found {
            let free =
                models.iter().flat_map(|model| model.parameters().iter().map(|parameter| parameter.name.clone()));
            return Err(unknown(name, free.collect()));
        }
    }
    // Without readings of wear they have no error.
    for (_, prior) in request.priors.iter().filter(|(name, _)| name == READING_NOISE) {
        for model in models.iter_mut() {
            model.set_prior(READING_NOISE, *prior);
        }
    }
    for (name, value) in &request.fixed {
        let refused = |reason: String| CalibrationError::Fixed { name: name.clone(), value: *value, reason };
        if [EDGE_SCATTER, READING_NOISE].contains(&name.as_str()) {
            return Err(refused(format!(
                "this is no parameter of a wear law, which --fix holds; a file with [prior] {name} = {{ factor = 1.01 }} for --prior \
                 holds it all but there"
            )));
        }
        let mut found = false;
        for model in models.iter_mut() {
            let names = [name.clone(), format!("{}.{name}", model.law.group())];
            let Some(own) = names.iter().find(|name| model.has(name)) else { continue };
            let straight = model.candidate().shape == Shape::Straight;
            if straight && *value != 0.0 && own.contains(".stage_") {
                return Err(refused("a straight wear curve has no stages; name other shapes".to_owned()));
            }
            found = true;
            model.fix(own, *value);
            if let Some(reason) = model.fault() {
                return Err(refused(reason));
            }
        }
        if !found {
            return Err(unknown(name, models.iter().flat_map(WearModel::names).collect()));
        }
    }
    Ok(())
}

/// The rate of chipping of edges of which it is reported how they ended.
fn chipping(model: &WearModel, posterior: &Posterior, measured: &Measured, base: &Base) -> Option<ChippingFit> {
    if !measured.ends_told || measured.clock == Clock::Operations {
        return None;
    }
    let exposure = |(edge, end): (&crate::edge::Edge, &End)| Exposure {
        course: model.exposure(posterior.map.u.as_slice(), edge),
        chipped: matches!(end, End::Chipped | End::Broken),
    };
    // Of edges that were not new the path is not known.
    let edges = measured.edges.iter().zip(&measured.ends).filter(|(edge, _)| edge.begun.is_none());
    let edges: Vec<Exposure> = edges.map(exposure).collect();
    let hazard = base.chipping();
    ChippingFit::from_exposures(&edges, hazard.shape, hazard.reference_land * 1e3)
}

/// Edges that took no part, predicted by the others.
fn held_out(model: &WearModel, maximum: &Maximum, whole: &Measured, request: &Request) -> HeldOut {
    let all = model.measuring(whole.edges.clone());
    let place = |edge: &crate::edge::Edge| request.held_out.contains(&edge.name);
    let group: Vec<usize> = (0..whole.edges.len()).filter(|index| place(&whole.edges[*index])).collect();
    let left_out = left_out(&all, maximum, &group, 0, request.seed);
    let coverage = Coverage::from_left_outs(&left_out);
    HeldOut { names: group.iter().map(|index| whole.edges[*index].name.clone()).collect(), left_out, coverage }
}

/// Lives at every tested speed and at the middle between neighbours, at the feed and depth cut most often. Of many speeds
/// [`LISTED`] stand for all. Where there is one speed, the lives of all conditions.
fn lives(model: &WearModel, posterior: &Posterior, measured: &Measured, seed: u64) -> Vec<LifeAt> {
    let reference = usual_cut(measured);
    let mut speeds: Vec<f64> = measured.conditions.iter().map(|condition| condition.cut.cutting_speed).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let (low, high) = (speeds[0], speeds[speeds.len() - 1]);
    let at = |condition: &Condition, tested| life_at(model, posterior, *condition, tested, seed);
    if high < ONE_SPEED * low && measured.conditions.len() <= LISTED {
        let mut conditions: Vec<Condition> = measured.conditions.clone();
        conditions.sort_by(|a, b| {
            let key = |condition: &Condition| condition.quantities();
            let order = a.group.cmp(&b.group);
            order.then(key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal))
        });
        return conditions.iter().map(|condition| at(condition, true)).collect();
    }
    if speeds.len() > LISTED {
        let place = |step: usize| low * (high / low).powf(step as f64 / (LISTED - 1) as f64);
        return (0..LISTED).map(|step| at(&reference.at_speed(place(step)), true)).collect();
    }
    let between: Vec<f64> = speeds.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let mut wanted: Vec<f64> = speeds.iter().chain(&between).copied().collect();
    wanted.sort_by(f64::total_cmp);
    wanted.iter().map(|speed| at(&reference.at_speed(*speed), speeds.contains(speed))).collect()
}

/// Life at a condition over the draws of a posterior.
pub fn life_at(
    model: &WearModel,
    posterior: &Posterior,
    condition: impl Into<Condition>,
    tested: bool,
    seed: u64,
) -> LifeAt {
    let condition = condition.into();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let scatter = model.parameters().iter().position(|parameter| parameter.name == EDGE_SCATTER);
    let mut levels: Vec<f64> = posterior.draws.iter().map(|draw| model.life(draw.as_slice(), condition)).collect();
    let mut next: Vec<f64> = posterior
        .draws
        .iter()
        .zip(&levels)
        .map(|(draw, life)| {
            let z: f64 = StandardNormal.sample(&mut random);
            life * (z * scatter.map_or(0.0, |index| draw[index].exp())).exp()
        })
        .collect();
    levels.sort_by(f64::total_cmp);
    next.sort_by(f64::total_cmp);
    LifeAt {
        condition,
        median: order_quantile(&levels, 0.5),
        ci90: [order_quantile(&levels, 0.05), order_quantile(&levels, 0.95)],
        next_edge90: [order_quantile(&next, 0.05), order_quantile(&next, 0.95)],
        tested,
    }
}

/// The feed, depth and width of most edges, in group 0.
fn usual_cut(measured: &Measured) -> Condition {
    let condition = |edge: &crate::edge::Edge| {
        edge.stretches.first().map(|stretch| stretch.condition).or(edge.life.map(|(condition, _)| condition))
    };
    let mut best = (0, 0);
    for (index, known) in measured.conditions.iter().enumerate() {
        let same = |other: &Condition| other.quantities()[1..] == known.quantities()[1..];
        let count = measured
            .edges
            .iter()
            .filter(|edge| condition(edge).is_some_and(|at| same(&measured.conditions[at])))
            .count();
        if count > best.1 {
            best = (index, count);
        }
    }
    Condition { group: 0, ..measured.conditions[best.0] }
}

/// The speed within a factor 1.5 of the tested range at which the life is known best.
fn best_known(model: &WearModel, posterior: &Posterior, measured: &Measured) -> (f64, f64) {
    let cut = usual_cut(measured);
    let speeds = measured.speeds();
    let (low, high) = speeds.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), speed| (a.min(*speed), b.max(*speed)));
    let (low, high) = (low / 1.5, high * 1.5);
    let few = &posterior.draws[..posterior.draws.len().min(200)];
    let spread = |speed: f64| {
        let cut = cut.at_speed(speed / 60.0);
        let lives: Vec<f64> = few.iter().map(|draw| model.life(draw.as_slice(), cut).ln()).collect();
        let mean = lives.iter().sum::<f64>() / lives.len() as f64;
        (lives.iter().map(|life| (life - mean).powi(2)).sum::<f64>() / (lives.len() - 1) as f64).sqrt()
    };
    let steps = (0..=24).map(|step| low * (high / low).powf(f64::from(step) / 24.0));
    steps.map(|speed| (speed, spread(speed))).min_by(|a, b| a.1.total_cmp(&b.1)).expect("there are steps")
}
