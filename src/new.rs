//! `toolroom new [KIND] DIR`.

use crate::args::NewArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};
use toolroom_kinds::{FileKind, KINDS};

pub fn run(args: &NewArgs, voice: &Voice) -> Result<(), Failure> {
    let kind = args.kind.unwrap_or(&KINDS[0]);
    let sample = kind.sample();
    let schema = args.dir.join(format!("{}.schema.json", kind.word));
    let schema_text = format!("{:#}\n", kind.schema());
    let files: Vec<(PathBuf, String)> = sample
        .files
        .iter()
        .enumerate()
        .map(|(index, (name, text))| {
            let text = if index == 0 && name.ends_with(".toml") { described(kind, text) } else { (*text).to_owned() };
            (args.dir.join(name), text)
        })
        .collect();
    if let Some((there, _)) = files.iter().find(|(path, _)| path.exists()) {
        let message = format!("{} is there already", there.display());
        return Err(Failure::argument(message, "choose another directory; nothing was changed"));
    }
    if !voice.force && fs::read(&schema).is_ok_and(|there| there != schema_text.as_bytes()) {
        let message = format!("{} is there already and is another one", schema.display());
        return Err(Failure::argument(message, "choose another directory, or replace it with --force"));
    }
    let unwritable = |path: &Path| {
        let path = path.to_owned();
        |source| Failure::Unwritable { path, source }
    };
    fs::create_dir_all(&args.dir).map_err(unwritable(&args.dir))?;
    fs::write(&schema, schema_text).map_err(unwritable(&schema))?;
    for (path, text) in &files {
        fs::write(path, text).map_err(unwritable(path))?;
    }
    let names: Vec<String> = files.iter().map(|(path, _)| path.display().to_string()).collect();
    if voice.json {
        voice.json(
            &json!({ "schema": 1, "kind": kind.word, kind.word: names[0], "files": names, "next": sample.next }),
        )?;
    }
    let next: Vec<String> = sample.next.iter().map(|command| format!("\n  {command}")).collect();
    voice.say(format_args!("wrote {}   next: cd {}{}", names.join(", "), args.dir.display(), next.concat()));
    if args.kind.is_none() && FileKind::named(&args.dir.display().to_string()).is_some() {
        let word = args.dir.display();
        voice.say(format_args!(
            "a scenario in the directory {word}; an example of the kind {word}: toolroom new {word} DIR"
        ));
    }
    Ok(())
}

/// The text with a first line that tells editors the schema beside it.
fn described(kind: &FileKind, text: &str) -> String {
    let rest = match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("#:schema") => rest,
        _ => text,
    };
    format!("#:schema ./{}.schema.json\n{rest}", kind.word)
}
