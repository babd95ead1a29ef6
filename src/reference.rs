//! `toolroom reference DIR`: every key, key figure, effect, error code and option, from the tables that the program
//! itself reads.

use crate::args::{ReferenceArgs, Toolroom, reference};
use crate::explain;
use crate::failure::Failure;
use crate::speak::Voice;
use clap::CommandFactory;
use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_gap_report::catalogue_json;
use toolroom_kinds::KINDS;
use toolroom_output::Files;
use toolroom_study::kpi::{Better, definitions};

pub fn run(args: &ReferenceArgs, voice: &Voice) -> Result<(), Failure> {
    let mut command = Toolroom::command();
    command.build();
    let pages = if args.man { reference::manual(&command) } else { pages(&command) };
    let files = Files::new([], voice.force);
    for (name, _) in &pages {
        files.check(&args.dir.join(name))?;
    }
    std::fs::create_dir_all(&args.dir).map_err(|source| Failure::Unwritable { path: args.dir.clone(), source })?;
    for (name, text) in &pages {
        files.put(&args.dir.join(name), text.as_bytes())?;
    }
    if voice.json {
        let names: Vec<&str> = pages.iter().map(|(name, _)| name.as_str()).collect();
        voice.json(&json!({ "schema": 1, "files": names }))?;
    }
    voice.say(format_args!("wrote {} pages into {}", pages.len(), args.dir.display()));
    Ok(())
}

/// Name and text of every page of the reference.
fn pages(command: &clap::Command) -> Vec<(String, String)> {
    let mut index = "# Reference\n\nMade by `toolroom reference` from the tables that the program reads.\n\n\
        - [Commands and options](commands.md)\n- [Key figures](key-figures.md)\n- [Effects](effects.md)\n\
        - [Error codes and warnings](errors.md)\n\nKeys of files:\n\n"
        .to_owned();
    let mut pages = vec![
        ("commands.md".to_owned(), reference::page(command)),
        ("key-figures.md".to_owned(), key_figures()),
        ("effects.md".to_owned(), effects()),
        ("errors.md".to_owned(), errors()),
    ];
    for kind in KINDS {
        let _ = writeln!(index, "- [{}](file-{}.md): {}", kind.word, kind.word, kind.doc);
        pages.push((format!("file-{}.md", kind.word), kind.reference()));
    }
    pages.push(("index.md".to_owned(), index));
    pages
}

fn key_figures() -> String {
    let mut text =
        "# Key figures\n\nWords and time elements follow ISO 22400-2. Statistics cover the time from the end \
        of the warm-up to the horizon. Files name a figure by its id, with its unit in brackets.\n"
            .to_owned();
    for (title, of_machine) in [("Of the shop", false), ("Of each machine", true)] {
        let _ = write!(text, "\n## {title}\n\n| id | unit | better | what it is |\n|---|---|---|---|\n");
        for (definition, _) in definitions().filter(|(_, machine)| *machine == of_machine) {
            let better = match definition.better {
                Better::More => "more",
                Better::Less => "less",
                Better::Neither => "–",
            };
            let _ =
                writeln!(text, "| `{}` | {} | {better} | {} |", definition.id, definition.file_unit(), definition.doc);
        }
    }
    text
}

fn effects() -> String {
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

fn errors() -> String {
    let mut text = "# Error codes and warnings\n\nThe same texts are printed by `toolroom explain CODE`.\n\n\
        | code | what it means |\n|---|---|\n"
        .to_owned();
    for (code, meaning) in explain::codes() {
        let _ = writeln!(text, "| `{code}` | {} |", meaning.replace('|', "\\|"));
    }
    text
}
