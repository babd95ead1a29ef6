//! `toolroom reference DIR`: every key, key figure, effect, error code and option, from the tables that the program
//! itself reads.

use crate::args::{ReferenceArgs, Toolroom, reference};
use crate::explain;
use crate::failure::Failure;
use crate::speak::Voice;
use clap::CommandFactory;
use serde_json::json;
use std::fmt::Write;
use toolroom_gap_report::catalogue_page;
use toolroom_kinds::KINDS;
use toolroom_output::Files;
use toolroom_study::kpi;

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
        ("key-figures.md".to_owned(), kpi::reference()),
        ("effects.md".to_owned(), catalogue_page()),
        ("errors.md".to_owned(), errors()),
    ];
    for kind in KINDS {
        let _ = writeln!(index, "- [{}](file-{}.md): {}", kind.word, kind.word, kind.doc);
        pages.push((format!("file-{}.md", kind.word), kind.reference()));
    }
    pages.push(("index.md".to_owned(), index));
    pages
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
