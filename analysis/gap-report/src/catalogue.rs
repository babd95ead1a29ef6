//! The catalogue of effects for people and for programs.

use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_effects::{CatalogueEntry, Effect, Sign, Touched};
use toolroom_gap::EMPIRICAL_EFFECTS;
use toolroom_scenario::effects::SHOP_EFFECTS;

/// Every effect with what it is, acts on, and is told apart by; a few lines each.
pub fn catalogue_text() -> String {
    let mut text = String::new();
    for entry in catalogue() {
        let unit = if entry.size.display == "1" { String::new() } else { format!(" [{}]", entry.size.display) };
        let _ = writeln!(text, "{}  {}", entry.id, entry.title);
        let _ = writeln!(text, "  size{unit}: {}", entry.size.doc.trim());
        let _ = writeln!(
            text,
            "  acts on {}; moves {}",
            entry.process_names().collect::<Vec<_>>().join(", "),
            channels(entry.channels)
        );
        let _ = writeln!(text, "  shows {}; mistaken for {}", entry.regime, entry.confounder);
        let _ = writeln!(text, "  told apart by {}", entry.separating_test);
        let _ = writeln!(text, "  source: {}\n", entry.source);
    }
    text.truncate(text.trim_end().len());
    text
}

/// Every effect, for programs.
pub fn catalogue_json() -> Value {
    json!({ "schema": 1, "effects": catalogue().map(entry).collect::<Vec<_>>() })
}

/// Effects of the processes, then those of the shop and of empirical responses.
fn catalogue() -> impl Iterator<Item = &'static CatalogueEntry> {
    Effect::CATALOGUE.iter().chain(SHOP_EFFECTS).chain(EMPIRICAL_EFFECTS)
}

fn channels(touched: &[Touched]) -> String {
    touched.iter().map(|each| format!("{} {}", each.channel, arrow(each.sign))).collect::<Vec<_>>().join(", ")
}

fn arrow(sign: Sign) -> &'static str {
    match sign {
        Sign::Rises => "up",
        Sign::Falls => "down",
    }
}

fn entry(entry: &CatalogueEntry) -> Value {
    let channels: Vec<_> =
        entry.channels.iter().map(|each| json!({ "channel": each.channel, "direction": arrow(each.sign) })).collect();
    json!({
        "id": entry.id,
        "title": entry.title,
        "size": {
            "unit": entry.size.display,
            "min": entry.size.to_display(entry.size.min),
            "max": entry.size.to_display(entry.size.max),
            "meaning": entry.size.doc.trim(),
        },
        "processes": entry.process_names().collect::<Vec<_>>(),
        "channels": channels,
        "regime": entry.regime,
        "confounder": entry.confounder,
        "separating_test": entry.separating_test,
        "source": entry.source,
    })
}
