//! The tables of the gap benchmark, as Markdown.

use crate::method::WHOLE;
use crate::power;
use crate::reliability;
use crate::row::{Mark, Row};
use crate::tally::{Ablation, Closed, Tally};
use std::collections::BTreeMap;
use std::fmt::Write;
use toolroom_gap::RULES;
use toolroom_truth::Set;

/// Sets in which nothing is hidden.
const NULLS: [Set; 3] = [Set::Null, Set::HeavyNull, Set::StressNull];

/// All tables.
pub(crate) fn tables(tallies: &[Tally], ablations: &[Ablation], rows: &[Row]) -> String {
    let mut text = String::from("# Rates of the gap benchmark\n");
    for tally in tallies {
        let _ = writeln!(text, "\n## {}: {} cases\n", heading(tally.process), tally.cases);
        sets(&mut text, tally);
        rates(&mut text, tally);
        failures(&mut text, tally);
        let of_process: Vec<&Ablation> =
            ablations.iter().filter(|ablation| ablation.process == tally.process).collect();
        if !of_process.is_empty() {
            reduced(&mut text, &of_process);
        }
        rules(&mut text, rows.iter().filter(|row| row.process == tally.process && row.method == WHOLE));
    }
    power::tables(&mut text, rows);
    reliability::tables(&mut text, rows);
    text
}

fn heading(process: &str) -> String {
    match process {
        "program" => "Part programs".to_owned(),
        "shop" => "Events of a shop".to_owned(),
        _ => process[..1].to_uppercase() + &process[1..],
    }
}

fn sets(text: &mut String, tally: &Tally) {
    let names: Vec<&str> = Mark::ALL.iter().map(|mark| mark.name()).collect();
    let _ = writeln!(text, "| set | cases | {} |\n|---|{}", names.join(" | "), "---|".repeat(names.len() + 1));
    for (set, marks) in &tally.marks {
        let counts: Vec<String> = marks.iter().map(usize::to_string).collect();
        let _ = writeln!(text, "| {} | {} | {} |", set.name(), marks.iter().sum::<usize>(), counts.join(" | "));
    }
}

fn kept(holds: bool) -> &'static str {
    if holds { "kept" } else { "**not kept**" }
}

fn rates(text: &mut String, tally: &Tally) {
    let _ = writeln!(text, "\n| rate | seen | | exact 95 % bounds | gate | |\n|---|---|---|---|---|---|");
    for rate in tally.rates.iter().filter(|rate| rate.of > 0) {
        let [low, high] = rate.bounds().map(|bound| 100.0 * bound);
        let _ = writeln!(
            text,
            "| {} | {} of {} | {:.1} % | {low:.1} to {high:.1} % | {} {:.0} % | {} |",
            rate.name,
            rate.count,
            rate.of,
            100.0 * rate.value(),
            rate.sign(),
            100.0 * rate.gate,
            kept(rate.holds())
        );
    }
    if let Some(closed) = &tally.closed {
        let _ = writeln!(
            text,
            "| closed on new edges: by what was named, by the hidden effect; mean of {} cases | {:.1} %, {:.1} % | {:.2} | | ≥ {} | {} |",
            closed.cases,
            100.0 * closed.named,
            100.0 * closed.hidden,
            closed.share(),
            Closed::GATE,
            kept(closed.holds())
        );
    }
}

fn failures(text: &mut String, tally: &Tally) {
    if tally.failures.is_empty() {
        return;
    }
    let mut alike: BTreeMap<&[String; 3], usize> = BTreeMap::new();
    tally.failures.iter().for_each(|failure| *alike.entry(failure).or_default() += 1);
    let _ = writeln!(text, "\nWrong, or missed though promised:\n");
    for ([hidden, set, answer], count) in alike {
        let hidden = if hidden.is_empty() { "nothing hidden" } else { hidden };
        let _ = writeln!(text, "- {count} × {hidden} ({set}): {answer}");
    }
}

/// What each rule alone decided: without it this many names would have been right, in part right, wrong.
fn rules<'a>(text: &mut String, rows: impl Iterator<Item = &'a Row>) {
    let rows: Vec<&Row> = rows.collect();
    let _ = writeln!(
        text,
        "\n| without the rule | right names more | in part right | wrong names more | shops that hide nothing, blamed |\n|---|---|---|---|---|"
    );
    for rule in RULES {
        let count = |keep: &dyn Fn(&Row, Mark) -> bool| {
            rows.iter().filter(|row| row.without(rule.id).is_some_and(|mark| keep(row, mark))).count()
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} |",
            rule.id,
            count(&|_, mark| mark == Mark::Exact),
            count(&|_, mark| mark == Mark::Partly),
            count(&|row, mark| mark == Mark::Wrong && !row.hidden.is_empty()),
            count(&|row, _| row.hidden.is_empty())
        );
    }
}

fn reduced(text: &mut String, ablations: &[&Ablation]) {
    let count = |keep: &[Set]| ablations[0].count(keep, &[])[0];
    let (effects, nulls, outside) = (count(&[Set::Effect]), count(&NULLS), count(&[Set::Outside]));
    let _ = writeln!(
        text,
        "\n| method | exact of {effects} effects | wrong or more than one | unknown | missed | blamed of {nulls} nulls | nulls answered unknown | outside named of {outside} |\n|---|---|---|---|---|---|---|---|"
    );
    for ablation in ablations {
        let count = |keep: &[Set], answers: &[Mark]| ablation.count(keep, answers)[1];
        let named = [Mark::Exact, Mark::Partly, Mark::Wrong];
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} |",
            ablation.method,
            count(&[Set::Effect], &[Mark::Exact]),
            count(&[Set::Effect], &[Mark::Wrong, Mark::Partly]),
            count(&[Set::Effect], &[Mark::Unknown]),
            count(&[Set::Effect], &[Mark::NoGap, Mark::Masked]),
            count(&NULLS, &named),
            count(&NULLS, &[Mark::Unknown]),
            count(&[Set::Outside], &named)
        );
    }
}
