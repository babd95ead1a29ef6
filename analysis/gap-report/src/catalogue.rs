//! The catalogue of effects for people and for programs.

use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_effects::{CatalogueEntry, Definition, Effect, Named, Sign, Touched, vocabulary};
use toolroom_gap::EMPIRICAL_EFFECTS;
use toolroom_scenario::effects::{PROGRAM_EFFECTS, SHOP_EFFECTS};

/// Every effect, those of a user behind the others, with what it is, acts on, and is told apart by; a few lines each.
pub fn catalogue_text(defined: &[&'static Definition]) -> String {
    let mut text = String::new();
    for entry in catalogue(defined) {
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

/// Every effect, those of a user behind the others, for programs.
pub fn catalogue_json(defined: &[&'static Definition]) -> Value {
    json!({ "schema": 1, "effects": catalogue(defined).map(entry).collect::<Vec<_>>() })
}

/// The page of the reference on every effect, as Markdown.
pub fn catalogue_page() -> String {
    let mut text = "# Effects\n\nWhat a nominal model may leave out. A tool of a scenario switches one on by \
        `effects = [{ id = \"wear_force\", size = 0.2 }]`; the diagnosis looks for those of the process.\n\n\
        | id | what it is | size | processes | shows in | source |\n|---|---|---|---|---|---|\n"
        .to_owned();
    let word = |value: &Value| value.as_str().unwrap_or_default().replace('|', "\\|");
    for effect in catalogue_json(&[])["effects"].as_array().into_iter().flatten() {
        let list = |value: &Value, word_of: &dyn Fn(&Value) -> String| {
            value.as_array().into_iter().flatten().map(word_of).collect::<Vec<_>>().join(", ")
        };
        let size = &effect["size"];
        let unit = if size["unit"] == "1" { String::new() } else { format!(" {}", word(&size["unit"])) };
        let _ = writeln!(
            text,
            "| `{}` | {}; {} | {} to {}{unit} | {} | {} | {} |",
            word(&effect["id"]),
            word(&effect["title"]),
            word(&size["meaning"]),
            size["min"],
            size["max"],
            list(&effect["processes"], &word),
            list(&effect["channels"], &|channel| format!(
                "{} {}",
                word(&channel["channel"]),
                word(&channel["direction"])
            )),
            word(&effect["source"]),
        );
    }
    text
}

/// Effects of the processes, then those of the shop, of part programs, of empirical responses, and of a user.
fn catalogue<'a>(defined: &'a [&'static Definition]) -> impl Iterator<Item = &'static CatalogueEntry> + 'a {
    let defined_entries = defined.iter().map(|effect| effect.entry());
    Effect::CATALOGUE.iter().chain(SHOP_EFFECTS).chain(PROGRAM_EFFECTS).chain(EMPIRICAL_EFFECTS).chain(defined_entries)
}

/// What the formulas of effects of one's own may name: quantities of the context, then terms.
pub fn vocabulary_text() -> String {
    let mut text = String::from("quantities that a formula may read\n");
    let mut terms = false;
    for quantity in vocabulary() {
        if quantity.factor.is_some() && !terms {
            terms = true;
            text.push_str("\nterms that an effect may change\n");
        }
        let unit = if quantity.field.unit == "1" { "a number" } else { quantity.field.unit };
        let how = quantity.factor.map_or("", |factor| if factor { ", by a factor" } else { ", by a summand" });
        let processes = quantity.processes.iter().flatten().copied().collect::<Vec<_>>().join(", ");
        let doc = quantity.field.doc.split_whitespace().collect::<Vec<_>>().join(" ");
        let _ = writeln!(text, "  {:24} {unit}{how}; {processes}\n    {doc}", quantity.field.name);
    }
    text
}

/// The same for programs.
pub fn vocabulary_json() -> Value {
    let one = |own: Named| {
        json!({
            "name": own.field.name, "unit": own.field.unit, "display": own.field.display,
            "min": own.field.min, "max": own.field.max, "meaning": own.field.doc.trim(),
            "processes": own.processes.iter().flatten().collect::<Vec<_>>(),
            "change": own.factor.map(|factor| if factor { "factor" } else { "summand" }),
        })
    };
    let (context, terms): (Vec<Named>, Vec<Named>) = vocabulary().partition(|own| own.factor.is_none());
    let list = |all: Vec<Named>| all.into_iter().map(one).collect::<Vec<_>>();
    json!({ "schema": 1, "context": list(context), "terms": list(terms) })
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
