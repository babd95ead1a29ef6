//! `toolroom effects`.

use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::fmt::Write;
use toolroom_effects::{CatalogueEntry, Effect, Sign, Touched};
use toolroom_gap::EMPIRICAL_EFFECTS;
use toolroom_scenario::effects::SHOP_EFFECTS;

pub fn run(voice: &Voice) -> Result<(), Failure> {
    if voice.json {
        let effects: Vec<_> = catalogue().map(as_json).collect();
        return voice.json(&json!({ "schema": 1, "effects": effects }));
    }
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
    voice.data(text.trim_end())?;
    voice.say("\nswitch one on in a tool: effects = [{ id = \"wear_force\", size = 0.2 }]");
    Ok(())
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

fn as_json(entry: &CatalogueEntry) -> serde_json::Value {
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
