//! The next experiment: which runs would tell apart what the records so far cannot.
//!
//! Every block of a menu is added to the records; the score that each suspect would reach, `z`, and
//! the cosine of each pair follow from the model alone, since the statistics of a linear model do not
//! ask for the values to be measured. Of a pair, `T_ab = z_a² (1 − cos²)` is what would separate it
//! (Atkinson & Fedorov 1975, T-optimality); it counts up to the score that an effect needs to be
//! named. The block that adds most per minute of machine time wins.

use super::constants::{CONFUSED, DETECTABLE};
use super::noise::unstated_scales;
use super::{
    Basis, ChannelId, Diagnosis, EffectId, Fit, Forward, GapVerdict, Linear, Method, NominalModel, Point, Trial,
};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_records::Records;

mod menu;

/// Edges of a block: groups have to agree on an effect, so one edge names nothing.
pub const REPLICATES: usize = 3;
/// Suspects that a plan looks at, worst seen first.
const SUSPECTS: usize = 8;

/// What a pair would reach.
#[derive(Clone, Debug, PartialEq)]
pub struct PairSeparation {
    /// The suspect.
    pub a: EffectId,
    /// The other suspect that it is mistaken for; `None` where calibration and scatter take it up.
    pub b: Option<EffectId>,
    /// Score that separates them in the records so far.
    pub before: f64,
    /// Score with the block.
    pub after: f64,
}

impl PairSeparation {
    /// What the suspect is mistaken for, in words.
    fn other(&self) -> &'static str {
        self.b.map_or("calibration and scatter", EffectId::word)
    }
}

/// One block of the menu with what it would do.
#[derive(Clone, Debug)]
pub struct Block {
    /// What to run.
    pub design: String,
    /// Operations.
    pub operations: usize,
    /// Machine time, min.
    pub minutes: f64,
    /// Pairs of the plan.
    pub pairs: Vec<PairSeparation>,
    /// Gain in separation per minute.
    pub worth: f64,
    /// The runs, channels left to be measured.
    pub runs: Records,
}

/// Blocks by falling worth.
#[derive(Clone, Debug)]
pub struct Plan {
    /// All of the menu that these records allow.
    pub blocks: Vec<Block>,
    /// What tells most apart and is in no menu, in words; empty where nothing is open.
    pub by_hand: String,
}

/// Plans the next experiment after `records`, of which `diagnosis` says what is open.
pub fn plan(model: &NominalModel, records: &Records, group: Option<&str>, diagnosis: &Diagnosis) -> Plan {
    let (before, scatter) = seen(model, records, group, None, None);
    let open = open(diagnosis, &before);
    let by_hand = diagnosis.next.design.clone();
    if open.is_empty() {
        return Plan { blocks: Vec::new(), by_hand };
    }
    let asked: Vec<EffectId> = open.iter().flat_map(|(a, b)| std::iter::once(*a).chain(*b)).collect();
    let block = |offered: menu::Offered| {
        // Runs that are only planned have no readings: they scatter as the records do.
        let (mut after, _) = seen(model, &records.followed_by(&offered.runs), group, Some(&asked), Some(&scatter));
        after.at_sizes_of(&before);
        let pairs: Vec<PairSeparation> = open
            .iter()
            .map(|(a, b)| PairSeparation {
                a: *a,
                b: *b,
                before: separation(&before, *a, *b),
                after: separation(&after, *a, *b),
            })
            .collect();
        let capped = |z: f64| z.min(DETECTABLE).powi(2);
        let gained: f64 = pairs.iter().map(|pair| (capped(pair.after) - capped(pair.before)).max(0.0)).sum();
        let mut runs = offered.runs;
        let channels: Vec<&str> = menu::channels(&runs);
        channels.iter().for_each(|channel| runs.remove(channel));
        Block {
            design: offered.design,
            operations: runs.len(),
            minutes: offered.minutes,
            pairs,
            worth: gained / offered.minutes,
            runs,
        }
    };
    let mut blocks: Vec<Block> = menu::blocks(records).into_par_iter().map(block).collect();
    blocks.sort_by(|a, b| b.worth.total_cmp(&a.worth));
    Plan { blocks, by_hand }
}

impl SeenEffects {
    /// Scores at the ordinary sizes of `other`: more runs may call another size ordinary.
    fn at_sizes_of(&mut self, other: &Self) {
        for (id, typical) in other.ids.iter().zip(&other.typical) {
            if let Some(place) = self.ids.iter().position(|known| known == id) {
                self.scores[place] *= typical / self.typical[place];
                self.typical[place] = *typical;
            }
        }
    }
}

/// Score at ordinary size of every suspect and the cosines among them, by the best shape.
struct SeenEffects {
    ids: Vec<EffectId>,
    scores: Vec<f64>,
    /// Ordinary size of each, SI.
    typical: Vec<f64>,
    cosines: Vec<Vec<f64>>,
}

/// Factors on the sensors of channels.
type Scatter = Vec<(ChannelId, f64)>;

/// What records like these would show of the effects `asked` for, of all if `None`, and how channels scatter of which nobody
/// states it: by `scatter`, or as the records show it.
fn seen(
    model: &NominalModel,
    records: &Records,
    group: Option<&str>,
    asked: Option<&[EffectId]>,
    scatter: Option<&Scatter>,
) -> (SeenEffects, Scatter) {
    let parts = model.asked(records, group, |_, _| false).parts;
    let each = parts.iter().map(|part| part_seen(part.as_ref(), asked, scatter));
    let (mut all, scatter): (Vec<SeenEffects>, Vec<Scatter>) = each.unzip();
    let mut seen = all.swap_remove(0);
    for other in all {
        // Channels that know nothing of each other add up, and tell no pair apart by their signature.
        seen.cosines.clear();
        for ((id, score), typical) in other.ids.into_iter().zip(other.scores).zip(other.typical) {
            match seen.ids.iter().position(|known| *known == id) {
                Some(place) => seen.scores[place] = seen.scores[place].hypot(score * seen.typical[place] / typical),
                None => {
                    seen.ids.push(id);
                    seen.scores.push(score);
                    seen.typical.push(typical);
                }
            }
        }
    }
    (seen, scatter.concat())
}

/// Ids, scores and cosines of the best shape of each candidate of one model, nought for those not `asked` for; and how its
/// channels scatter.
fn part_seen(model: &dyn Forward, asked: Option<&[EffectId]>, scatter: Option<&Scatter>) -> (SeenEffects, Scatter) {
    let candidates = model.frame().candidates.iter().enumerate();
    let asked = candidates.filter(|(_, own)| asked.is_none_or(|asked| asked.contains(&own.id)));
    let asked: Vec<usize> = asked.map(|(i, _)| i).collect();
    let linear = Linear::with(model, Point::nominal(model), &asked);
    let measured = &model.frame().measured;
    let scale = match scatter {
        Some(known) => {
            let factor = |id: ChannelId| known.iter().find(|(own, _)| *own == id).map_or(1.0, |(_, factor)| *factor);
            measured.channels.iter().map(|channel| factor(channel.id)).collect()
        }
        None => unstated_scales(measured, &linear.residual),
    };
    let basis = Basis::unmeasured(model, Method::default(), linear.clone()).scaled(measured, &scale);
    let trial = Trial::of(model, &basis, &[], Fit::at(linear, 0.0));
    let scores = trial.scores();
    let mut best: Vec<usize> = Vec::new();
    for (i, candidate) in model.frame().candidates.iter().enumerate() {
        match best.iter_mut().find(|other| model.frame().candidates[**other].id == candidate.id) {
            Some(other) if scores.length[i] > scores.length[*other] => *other = i,
            Some(_) => {}
            None => best.push(i),
        }
    }
    let ids = best.iter().map(|i| model.frame().candidates[*i].id).collect();
    let cosines = best.iter().map(|a| best.iter().map(|b| scores.cosine[(*a, *b)]).collect()).collect();
    let typical = best.iter().map(|i| model.frame().candidates[*i].typical).collect();
    let seen = SeenEffects { ids, typical, scores: best.iter().map(|i| scores.length[*i]).collect(), cosines };
    (seen, measured.channels.iter().map(|channel| channel.id).zip(scale).collect())
}

/// `√T_ab`, or the score of `a` alone.
fn separation(seen_effects: &SeenEffects, a: EffectId, b: Option<EffectId>) -> f64 {
    let place = |id: EffectId| seen_effects.ids.iter().position(|known| *known == id);
    let Some(i) = place(a) else { return 0.0 };
    let cosine = b.and_then(place).and_then(|j| seen_effects.cosines.get(i)?.get(j).copied()).unwrap_or(0.0);
    seen_effects.scores[i] * (1.0 - cosine * cosine).max(0.0).sqrt()
}

/// What is open: the class of a named effect; else every effect that the records could hardly show,
/// and pairs of those that they could.
fn open(diagnosis: &Diagnosis, seen_effects: &SeenEffects) -> Vec<(EffectId, Option<EffectId>)> {
    let mut open: Vec<(EffectId, Option<EffectId>)> = Vec::new();
    for effect in &diagnosis.effects {
        let others = effect.class.iter().filter(|other| **other != effect.id);
        open.extend(others.map(|other| (effect.id, Some(*other))));
    }
    if !open.is_empty() {
        return open;
    }
    let mut order: Vec<usize> = (0..seen_effects.ids.len()).collect();
    order.sort_by(|a, b| seen_effects.scores[*a].total_cmp(&seen_effects.scores[*b]));
    if diagnosis.verdict == GapVerdict::Unknown {
        for (a, b) in pairs(seen_effects) {
            open.push((seen_effects.ids[a], Some(seen_effects.ids[b])));
        }
    }
    let hidden = order.iter().filter(|i| seen_effects.scores[**i] < DETECTABLE);
    open.extend(hidden.map(|i| (seen_effects.ids[*i], None)));
    open.truncate(SUSPECTS);
    open
}

/// Pairs with nearly the same signature.
fn pairs(seen_effects: &SeenEffects) -> Vec<(usize, usize)> {
    let count = seen_effects.ids.len();
    let close = |a: usize, b: usize| {
        seen_effects.cosines.get(a).and_then(|row| row.get(b)).is_some_and(|cosine| *cosine > CONFUSED)
    };
    (0..count).flat_map(|a| (a + 1..count).filter(move |b| close(a, *b)).map(move |b| (a, b))).collect()
}

impl Plan {
    /// The best block as the next experiment of a diagnosis.
    pub fn best(&self) -> Option<&Block> {
        self.blocks.first().filter(|block| block.worth > 0.0)
    }

    /// For programs.
    pub fn json(&self) -> Value {
        let pair = |pair: &PairSeparation| json!({ "a": pair.a.word(), "b": pair.other(), "z_before": pair.before, "z_after": pair.after });
        let block = |block: &Block| {
            json!({
                "design": block.design, "edges": REPLICATES, "operations": block.operations,
                "minutes": block.minutes, "worth": block.worth,
                "separates": block.separates(), "pairs": block.pairs.iter().map(pair).collect::<Vec<_>>(),
            })
        };
        json!({ "schema": 1, "next": self.best().map(block), "by_hand": self.by_hand, "menu": self.blocks.iter().map(block).collect::<Vec<_>>() })
    }

    /// For people.
    pub fn text(&self) -> String {
        let Some(best) = self.best() else {
            let none = "no experiment of the menu would show more than these records do".to_owned();
            return if self.by_hand.is_empty() { none } else { format!("{none}; by hand: {}", self.by_hand) };
        };
        let mut text = format!("next     {}\n", best.design);
        let _ = writeln!(text, "         {} operations, {:.0} min of machine time", best.operations, best.minutes);
        for pair in best.pairs.iter().filter(|pair| pair.after > pair.before + 0.1) {
            let _ = writeln!(
                text,
                "  {:22} from {:24} score {:5.1} → {:5.1}",
                pair.a,
                pair.other(),
                pair.before,
                pair.after
            );
            if pair.after < DETECTABLE && !pair.a.entry().separating_test.is_empty() {
                let _ = writeln!(text, "    not enough yet: {}", pair.a.entry().separating_test);
            }
        }
        let _ = writeln!(text, "else");
        for block in self.blocks.iter().skip(1) {
            let shown = block.separates().len();
            let _ = writeln!(text, "  {:62} {:4.0} min, shows {shown} more", block.design, block.minutes);
        }
        text.trim_end().to_owned()
    }
}

impl Block {
    /// Pairs that it would bring over the score that an effect needs.
    pub fn separates(&self) -> Vec<[String; 2]> {
        let brought = self.pairs.iter().filter(|pair| pair.before < DETECTABLE && pair.after >= DETECTABLE);
        brought.map(|pair| [pair.a.to_string(), pair.other().to_owned()]).collect()
    }
}
