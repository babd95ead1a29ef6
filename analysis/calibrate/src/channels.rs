//! Every channel of a calibration, fitted around the wear of the edges.

use crate::base::Base;
use crate::channel::{Channel, ChannelModel, ChannelReading};
use crate::edge::{Edge, Stretch};
use crate::identify::Identifiability;
use crate::left_out::leave_edges_out;
use crate::model::Model;
use crate::request::Request;
use crate::sample::{Posterior, maxima, sample};
use crate::treatment::Measured;
use crate::wear_model::WearModel;
use toolroom_wear::{Cut, EnergyBalance, Pair, TakeyamaMurata, Usui, WearLaw};

/// Points of a cut of which the mean of a channel is taken, as in what `run --records` writes.
const POINTS: usize = 8;

/// When a channel was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// At the end of the operation, as its flank wear.
    End,
    /// All through the operation: the reading is the mean over the cut.
    OverCut,
}

impl When {
    /// Word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::End => "end",
            Self::OverCut => "mean_over_cut",
        }
    }
}

/// A channel against wear, fitted.
#[derive(Clone, Debug)]
pub struct ChannelFit {
    /// The model.
    pub model: ChannelModel,
    /// When it was read, as far as the data say.
    pub when: When,
    /// By how many logarithms of the posterior density at the maximum that is more probable than the other.
    pub lead: f64,
    /// Its posterior.
    pub posterior: Posterior,
    /// What the data determine of it.
    pub identifiability: Identifiability,
    /// By how many logarithms the land predicts readings of edges left out better than a model that knows no wear, and the
    /// standard error from the differences edge by edge.
    pub gain: (f64, f64),
}

/// The set with the temperatures that were measured, and their fits. The wear of the edges is that of the model whose curves follow the
/// readings best under the temperatures of the set. Rates of wear that a law states at a reference temperature stay with the cuts
/// that had it, so that this temperature moves with the others.
pub(crate) fn heat(
    base: &Base,
    measured: &Measured,
    request: &Request,
    models: &[WearModel],
) -> (Base, Vec<ChannelFit>) {
    let nothing = || (base.clone(), Vec::new());
    let heated = |channel: &Channel| {
        let place = place(*channel);
        channel.heats() && measured.loads.iter().any(|loads| loads[place].iter().any(Option::is_some))
    };
    let Base::Turning { pair, others } = base else { return nothing() };
    if !Channel::ALL.iter().any(heated) || measured.readings() == 0 {
        return nothing();
    }
    let all: Vec<usize> = (0..measured.edges.len()).collect();
    let fits = models.iter().filter_map(|model| Some((model, maxima(model, &all, request.seed)?.0)));
    let best = fits.max_by(|a, b| a.1.ln_density.total_cmp(&b.1.ln_density));
    let Some((model, maximum)) = best else { return nothing() };
    let (before, mut pair) = (pair, pair.as_ref().clone());
    let mut found: Vec<ChannelFit> = Vec::new();
    for channel in Channel::ALL.into_iter().filter(|channel| channel.heats()) {
        let known = !found.is_empty();
        if let Some(fit) = fitted(channel, (model, maximum.u.as_slice()), measured, (&pair, known), request) {
            pair = fit.model.at(fit.posterior.map.u.as_slice());
            found.push(fit);
        }
    }
    (with_reference((pair, others), before, request.limit), found)
}

/// A set whose reference temperatures belong to the same cut as before.
fn with_reference((mut pair, others): (Pair, &[WearLaw]), before: &Pair, limit: f64) -> Base {
    let rise = |pair: &Pair| {
        let half_worn = 0.5e-3 * limit;
        pair.point(&before.reference_cut(), half_worn).temperature - pair.temperature.ambient_temperature
    };
    let room = pair.temperature.ambient_temperature;
    let hotter = rise(&pair) / rise(before);
    let moved = |law: WearLaw| {
        let at = |reference: f64| room + hotter * (reference - room);
        match law {
            WearLaw::EnergyBalance(law) => {
                WearLaw::EnergyBalance(EnergyBalance { reference_temperature: at(law.reference_temperature), ..law })
            }
            WearLaw::TakeyamaMurata(law) => {
                WearLaw::TakeyamaMurata(TakeyamaMurata { reference_temperature: at(law.reference_temperature), ..law })
            }
            WearLaw::Usui(law) => WearLaw::Usui(Usui { reference_temperature: at(law.reference_temperature), ..law }),
            WearLaw::ExtendedTaylor(_) => law,
        }
    };
    pair.law = moved(pair.law);
    Base::Turning { pair: Box::new(pair), others: others.iter().map(|law| moved(*law)).collect() }
}

/// Every force and power that was measured, each around what those before it have told of the force group. Power is left out
/// where the cutting force was measured.
pub(crate) fn forces(
    model: &WearModel,
    u: &[f64],
    measured: &Measured,
    base: &Pair,
    request: &Request,
) -> Vec<ChannelFit> {
    let mut found: Vec<ChannelFit> = Vec::new();
    let mut base = base.clone();
    for channel in Channel::ALL.into_iter().filter(|channel| !channel.heats()) {
        let told = found.iter().any(|fit| fit.model.channel() == Channel::CuttingForce);
        if channel == Channel::SpindlePower && told {
            continue;
        }
        if let Some(fit) = fitted(channel, (model, u), measured, (&base, false), request) {
            base = fit.model.at(fit.posterior.map.u.as_slice());
            found.push(fit);
        }
    }
    found
}

/// Where a channel stands among all.
pub(crate) fn place(channel: Channel) -> usize {
    Channel::ALL.iter().position(|known| *known == channel).expect("one of all channels")
}

/// One channel of all edges against their fitted wear; `None` with fewer readings than the model has parameters.
fn fitted(
    channel: Channel,
    (wear_model, u): (&WearModel, &[f64]),
    measured: &Measured,
    (base, temperatures_known): (&Pair, bool),
    request: &Request,
) -> Option<ChannelFit> {
    let model_of = |when: When| {
        let edges = readings(channel, (wear_model, u), measured, when);
        let mut model = ChannelModel::from_channel(channel, base, edges, None, temperatures_known);
        request.priors.iter().for_each(|(name, prior)| model.set_prior(name, *prior));
        model
    };
    let end = model_of(When::End);
    let all: Vec<usize> = (0..end.edges()).collect();
    if all.iter().map(|edge| end.readings(*edge).len()).sum::<usize>() <= end.parameters().len() {
        return None;
    }
    // Both are as good beforehand: the data say when the channel was read.
    let over = model_of(When::OverCut);
    let density = |model: &ChannelModel| Some(maxima(model, &all, request.seed)?.0.ln_density);
    let lead = density(&over)? - density(&end)?;
    let (when, model) = if lead > 0.0 { (When::OverCut, over) } else { (When::End, end) };
    let posterior = sample(&model, &all, request.draws, request.seed)?;
    let identifiability = Identifiability::from_model(&model, &posterior);
    let blind = model.without_land();
    let (with, (without, _)) = (&posterior.map, maxima(&blind, &all, request.seed)?);
    let with = leave_edges_out(&model, with, request.seed, &|| ());
    let without = leave_edges_out(&blind, &without, request.seed, &|| ());
    let differences: Vec<f64> = with.iter().zip(&without).map(|(with, without)| with.score - without.score).collect();
    let gain = differences.iter().sum::<f64>();
    let mean = gain / differences.len() as f64;
    let error = differences.iter().map(|difference| (difference - mean).powi(2)).sum::<f64>().sqrt();
    Some(ChannelFit { model, when, lead: lead.abs(), posterior, identifiability, gain: (gain, error) })
}

/// Readings of a channel with the fitted wear that belongs to them, edge by edge.
fn readings(
    channel: Channel,
    (wear_model, u): (&WearModel, &[f64]),
    measured: &Measured,
    when: When,
) -> Vec<Vec<ChannelReading>> {
    let mut edges = Vec::new();
    for (edge, loads) in measured.edges.iter().zip(&measured.loads).filter(|(edge, _)| edge.readings() > 0) {
        let loads = &loads[place(channel)];
        if loads.is_empty() {
            continue;
        }
        // Where the wear is asked for, and how many of these points belong to each reading.
        let (mut stretches, mut counts) = (Vec::with_capacity(edge.stretches.len()), Vec::new());
        for (stretch, load) in edge.stretches.iter().zip(loads) {
            let single = stretch.block.is_none_or(|block| block.count <= 1.0);
            match (load, when) {
                (None, _) => stretches.push(Stretch { wear: None, ..*stretch }),
                // Blocks of many readings stand for the mean of short stretches already.
                (Some(_), When::OverCut) if single => {
                    let piece = stretch.time / POINTS as f64;
                    for point in 0..POINTS {
                        let time = if point == 0 { 0.5 * piece } else { piece };
                        stretches.push(Stretch::read(stretch.condition, time, 0.0));
                    }
                    stretches.push(Stretch::unread(stretch.condition, 0.5 * piece));
                    counts.push(POINTS);
                }
                (Some(_), When::OverCut | When::End) => {
                    stretches.push(Stretch { wear: Some(0.0), ..*stretch });
                    counts.push(1);
                }
            }
        }
        let read = Edge { stretches, ..edge.clone() };
        let course = wear_model.course(u, &read, wear_model.level(u, edge));
        let mut rest = course.as_slice();
        let mut mean = |count: usize| {
            let (own, others) = rest.split_at(count.min(rest.len()));
            rest = others;
            own.iter().sum::<f64>() / own.len() as f64
        };
        let reading = |((cut, value), count): (&(Cut, f64), usize)| ChannelReading {
            cut: *cut,
            wear: mean(count),
            value: *value,
        };
        let readings: Vec<ChannelReading> = loads.iter().flatten().zip(counts).map(reading).collect();
        if !readings.is_empty() {
            edges.push(readings);
        }
    }
    edges
}
