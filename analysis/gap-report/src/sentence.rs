//! The answer in words.

use crate::minutes::Minutes;
use crate::readings::{Readings, label};
use toolroom_chart::number;
use toolroom_gap::{Diagnosis, GapVerdict, NamedEffect};

/// The answer of a diagnosis in a few sentences: what, since what cause, what it costs, what to do next. Every verdict
/// has one.
pub fn sentence(diagnosis: &Diagnosis, readings: &Readings, minutes: Option<&Minutes>) -> String {
    let mut parts = match diagnosis.verdict {
        GapVerdict::Effect => effects(diagnosis, readings, minutes),
        GapVerdict::Constant => {
            let constant = diagnosis.constant().map(|words| format!(" {}.", capital(&words)));
            vec![format!("The file has another constant than the shop.{}", constant.unwrap_or_default())]
        }
        GapVerdict::Unknown => vec![unknown(diagnosis, minutes)],
        GapVerdict::Masked => vec![masked(diagnosis)],
        GapVerdict::Small => vec!["Shop and model differ, but by nothing that matters in practice.".to_owned()],
        GapVerdict::NoGap => vec![no_gap(diagnosis)],
        GapVerdict::CannotTell => {
            vec![format!("Too little was measured for any answer: {}.", diagnosis.notes.join("; "))]
        }
    };
    parts.extend(diagnosis.findings.iter().map(|finding| format!("{}.", capital(&finding.words))));
    if !diagnosis.next.design.is_empty() {
        let minutes = diagnosis.next.minutes;
        let time = if minutes > 0.0 { format!(" ({minutes:.0} min of machine time)") } else { String::new() };
        parts.push(format!("Next: {}{time}.", diagnosis.next.design));
    }
    parts.join(" ")
}

/// The first letter as a capital.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().collect::<String>() + letters.as_str())
}

/// Words of a column name.
pub(crate) fn words(channel: &str) -> String {
    channel.replace('_', " ")
}

/// The same with its verb.
fn being(channel: &str) -> String {
    format!("{} {}", words(channel), if channel.ends_with("revolutions") { "are" } else { "is" })
}

fn effects(diagnosis: &Diagnosis, readings: &Readings, minutes: Option<&Minutes>) -> Vec<String> {
    let one = |(index, effect): (usize, &NamedEffect)| {
        let shape = if effect.shape.is_empty() { String::new() } else { format!(", {}", effect.shape) };
        let others = match &effect.class[1.min(effect.class.len())..] {
            [] => String::new(),
            others => {
                let others: Vec<&str> = others.iter().map(|id| id.entry().title).collect();
                format!(" The data do not distinguish it from this: {}.", others.join("; "))
            }
        };
        let cost = minutes.and_then(|minutes| minutes.effect(&label(effect, &diagnosis.effects)));
        let cost = cost.map_or_else(String::new, |cost| format!(" {cost}"));
        format!(
            "{}{}: {}{} ({}{shape}; {} {}, 90 %: {} … {}; probability {:.2}).{others}{cost}",
            moved(readings, index),
            match (effect.empirical, effect.id.is_wear_rate()) {
                (true, _) => "No cause, but what describes it (empirical)",
                (false, true) => "No cause, but a constant that is another one there",
                (false, false) => "Cause",
            },
            effect.title,
            // Titles are those of sizes above zero.
            if effect.size < 0.0 { ", here the other way round" } else { "" },
            effect.id,
            number(effect.size, 3),
            if effect.unit == "1" { "" } else { effect.unit },
            number(effect.ci90[0], 3),
            number(effect.ci90[1], 3),
            effect.probability
        )
        .replace(" ,", ",")
    };
    diagnosis.effects.iter().enumerate().map(one).collect()
}

/// What the effect `index` moves most of the operations on which it acts, compared with what the channel leaves.
fn moved(readings: &Readings, index: usize) -> String {
    let stage = index + 2;
    let mut best: Option<(f64, String)> = None;
    for (channel, about) in readings.channels.iter().enumerate() {
        let (mut sum, mut change, mut count) = (0.0_f64, 0.0_f64, 0.0_f64);
        for reading in readings.of(channel).filter(|reading| reading.stages.len() > stage) {
            let [before, after] = [stage - 1, stage].map(|stage| reading.stages[stage]);
            if before != after {
                sum += before;
                change += after - before;
                count += 1.0;
            }
        }
        let [_, rms] = readings.residuals(channel, readings.stages.len());
        let weight = (change / if about.relative { sum } else { count }).abs() / rms;
        if count > 0.0 && change != 0.0 && weight.is_finite() && best.as_ref().is_none_or(|(most, _)| weight > *most) {
            let mean = change / count;
            let more = if mean > 0.0 { "more" } else { "less" };
            let text = if about.unit == "s" {
                format!("The {} {} s {more} an operation. ", being(&about.name), number(mean.abs(), 2))
            } else {
                format!("The {} {} % {more}. ", being(&about.name), number(100.0 * (change / sum).abs(), 2))
            };
            best = Some((weight, text));
        }
    }
    best.map_or_else(String::new, |(_, text)| text)
}

fn unknown(diagnosis: &Diagnosis, minutes: Option<&Minutes>) -> String {
    let place = diagnosis.cells.first().map_or_else(
        || "no channel by itself shows where".to_owned(),
        |cell| {
            let follows = if cell.group == "all" { &cell.regime } else { &cell.group };
            let much = if cell.rms_before.is_finite() {
                format!(", {} % off there", number(100.0 * cell.rms_before, 2))
            } else {
                String::new()
            };
            format!("{} follows {follows} (score {:.1}{much})", words(&cell.channel), cell.score)
        },
    );
    let cost = minutes.and_then(|minutes| minutes.cost("unexplained"));
    let cost = cost.map_or_else(String::new, |cost| format!(" Unexplained: {cost}."));
    format!("There is a gap, and its cause is unknown: {place}.{cost}")
}

fn masked(diagnosis: &Diagnosis) -> String {
    if let Some(suspected) = &diagnosis.suspected {
        return format!("Calibration may have taken up a cause. {}.", capital(suspected));
    }
    let hidden: Vec<&str> = diagnosis.masked.iter().take(3).map(|row| row.id.entry().title).collect();
    let hidden = if hidden.is_empty() { "nothing in particular".to_owned() } else { hidden.join("; ") };
    format!("What may be missing cannot be seen in such data, since calibration takes it up: {hidden}.")
}

fn no_gap(diagnosis: &Diagnosis) -> String {
    let seen: Vec<String> = diagnosis
        .masked
        .iter()
        .filter(|row| row.minimal_detectable.is_finite())
        .take(3)
        .map(|row| format!("{} from {} {} on", row.id, number(row.minimal_detectable, 3), row.unit))
        .collect();
    let seen = if seen.is_empty() { String::new() } else { format!(" Seen would have been {}.", seen.join(", ")) };
    format!("Shop and model agree within calibration and noise.{seen}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_effects::parse_definitions;
    use toolroom_facts::{Fact, FactDetail, Finding, Quantity};
    use toolroom_gap::{Cell, EffectId, NextExperiment, WEAR_RATE, WrittenEffect};

    fn diagnosis(verdict: GapVerdict) -> Diagnosis {
        let mut diagnosis = Diagnosis::cannot_tell("two edges were measured".to_owned());
        diagnosis.verdict = verdict;
        diagnosis
    }

    #[test]
    fn every_verdict_has_a_sentence_of_its_own() {
        let all = [
            (GapVerdict::Effect, "Cause: forces grow with flank wear (wear_force; 0.2"),
            (GapVerdict::Constant, "another constant than the shop. Time between failures of L1: 16.0 h recorded"),
            (GapVerdict::Unknown, "its cause is unknown: cutting force follows machine=L1 (score 6.2, 4 % off there)."),
            (GapVerdict::Masked, "calibration takes it up"),
            (GapVerdict::Small, "by nothing that matters"),
            (GapVerdict::NoGap, "agree within calibration and noise"),
            (GapVerdict::CannotTell, "Too little was measured for any answer: two edges were measured."),
        ];
        for (verdict, words) in all {
            let mut example = diagnosis(verdict);
            example.next =
                NextExperiment { design: "two speeds on one edge".to_owned(), minutes: 60.0, separates: vec![] };
            if verdict == GapVerdict::Effect {
                example.effects.push(NamedEffect {
                    id: EffectId::WEAR_FORCE,
                    title: "forces grow with flank wear",
                    empirical: false,
                    shape: String::new(),
                    written: WrittenEffect::default(),
                    size: 0.2,
                    unit: "1",
                    ci90: [0.17, 0.23],
                    probability: 0.96,
                    z: 9.0,
                    gain: [20.0, 10.0],
                    class: vec![EffectId::WEAR_FORCE, EffectId::named("chipping").expect("an effect of the catalogue")],
                    class_reason: "same signature".to_owned(),
                });
            }
            if verdict == GapVerdict::Constant {
                let fact = Fact {
                    quantity: Quantity::TimeBetweenFailures,
                    place: "L1".to_owned(),
                    pooled: false,
                    told: FactDetail::default(),
                    count: 10,
                    expected: 20.0,
                    p: 1e-4,
                    tests: vec![("level", 1e-4)],
                    model: 28800.0,
                    estimate: 57600.0,
                    ci90: [33958.0, 106167.0],
                    least_seen: [0.1, 2.6],
                };
                example.findings.push(Finding { fact: 0, constant: true, words: fact.words() });
                example.facts.push(fact);
            }
            example.cells.push(Cell {
                channel: "cutting_force".to_owned(),
                group: "machine=L1".to_owned(),
                regime: "all".to_owned(),
                score: 6.2,
                rms_before: 0.04,
                rms_after: 0.04,
            });
            if verdict == GapVerdict::Masked {
                example.suspected = Some("stock_offset would explain the records better (gain 9.0)".to_owned());
                let text = sentence(&example, &Readings::default(), None);
                let words = "a cause. Stock_offset would explain the records better (gain 9.0). Next";
                assert!(text.contains(words), "{text}");
                example.suspected = None;
            }
            if let Some(named) = example.effects.first_mut() {
                let text = format!(
                    "[[effect]]\nid = \"{WEAR_RATE}\"\ntitle = \"edges wear at another rate\"\nprocess = [\"turning\"]\n\
                     size = {{ unit = \"1\", ordinary = 0.3, range = [0.0, 9.0] }}\n\
                     changes = [{{ term = \"wear_rate\", factor = \"1 + size\" }}]\nsource = \"assumption\"\n"
                );
                let wear_rate = parse_definitions("test", &text).expect("a definition")[0];
                let known = std::mem::replace(&mut named.id, EffectId::from(wear_rate));
                let text = sentence(&example, &Readings::default(), None);
                assert!(text.contains("No cause, but a constant that is another one there"), "{text}");
                example.effects[0].id = known;
            }
            let text = sentence(&example, &Readings::default(), None);
            assert!(text.to_lowercase().contains(&words.to_lowercase()), "{verdict:?}: {text}");
            assert!(text.ends_with("Next: two speeds on one edge (60 min of machine time)."), "{text}");
        }
    }
}
