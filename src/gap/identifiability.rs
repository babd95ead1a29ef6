//! `toolroom gap identifiability`.

use super::{nominal, recorded};
use crate::args::IdentifiabilityArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::fmt::Write;
use toolroom_chart::number;
use toolroom_gap::{EffectId, Identifiable, identifiability};
use toolroom_gap_study::usable;

pub fn run(args: &IdentifiabilityArgs, voice: &Voice) -> Result<(), Failure> {
    let model = nominal(&args.data)?;
    let records = recorded(&args.data.data, &model, voice)?;
    let asked = model.asked(&records, args.data.group.as_deref(), |_, _| false);
    usable(&asked, &records)?;
    let parts = asked.parts;
    let mut list = Vec::new();
    for part in &parts {
        let channel = part.frame().measured.channels.first().filter(|_| parts.len() > 1);
        for mut row in identifiability(part.as_ref()) {
            if let Some(channel) = channel {
                row.shape = format!("{}, {}", channel.id, row.shape).trim_end_matches(", ").to_owned();
            }
            list.push(row);
        }
    }
    if voice.json {
        let rows: Vec<_> = list
            .iter()
            .map(|row| {
                json!({
                    "id": row.id.word(), "shape": row.shape, "masking": row.masking, "unit": row.unit,
                    "minimal_detectable": row.minimal_detectable.is_finite().then_some(row.minimal_detectable),
                    "confused_with": EffectId::words(&row.confused), "calibration_bias": row.bias,
                    "separating_test": row.separating_test,
                })
            })
            .collect();
        return voice.json(&json!({ "schema": 1, "effects": rows }));
    }
    let mut text = String::from(
        "least size that these runs would show (nineteen times of twenty), and what it is confused with\n",
    );
    let name = |row: &Identifiable| {
        if row.shape.is_empty() { row.id.to_string() } else { format!("{} ({})", row.id, row.shape) }
    };
    let least = |row: &Identifiable| {
        if row.minimal_detectable.is_finite() {
            format!("{} {}", number(row.minimal_detectable, 3), row.unit)
        } else {
            "never".to_owned()
        }
    };
    let lines: Vec<[String; 2]> = list.iter().map(|row| [name(row), least(row)]).collect();
    let width = |place: usize| lines.iter().map(|line| line[place].chars().count()).max().unwrap_or(0);
    let [names, sizes] = [0, 1].map(width);
    for (row, [name, least]) in list.iter().zip(&lines) {
        let confused = if row.confused.is_empty() {
            String::new()
        } else {
            format!("; confused with {}", EffectId::words(&row.confused).join(", "))
        };
        let _ = writeln!(text, "  {name:names$}  {least:>sizes$}{confused}");
    }
    voice.data(text.trim_end())
}
