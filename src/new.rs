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
    let mut files: Vec<(PathBuf, String)> = Vec::new();
    let mut kinds = vec![kind];
    for (index, (name, text)) in sample.files.iter().enumerate() {
        let own = if index == 0 && name.ends_with(".toml") { Some(kind) } else { schema_of(text) };
        let text = own.map_or_else(|| (*text).to_owned(), |own| described(own, text));
        kinds.extend(own.filter(|own| kinds.iter().all(|known| known.word != own.word)));
        files.push((args.dir.join(name), text));
    }
    if let Some((there, _)) = files.iter().find(|(path, _)| path.exists()) {
        let message = format!("{} is there already", there.display());
        return Err(Failure::argument(message, "choose another directory; nothing was changed"));
    }
    let schema = |kind: &&FileKind| (args.dir.join(schema_name(kind)), format!("{:#}\n", kind.schema()));
    let schemas: Vec<(PathBuf, String)> = kinds.iter().map(schema).collect();
    let another = |(path, text): &&(PathBuf, String)| fs::read(path).is_ok_and(|there| there != text.as_bytes());
    if let Some((there, _)) = schemas.iter().find(another).filter(|_| !voice.force) {
        let message = format!("{} is there already and is another one", there.display());
        return Err(Failure::argument(message, "choose another directory, or replace it with --force"));
    }
    let unwritable = |path: &Path| {
        let path = path.to_owned();
        |source| Failure::Unwritable { path, source }
    };
    fs::create_dir_all(&args.dir).map_err(unwritable(&args.dir))?;
    for (path, text) in schemas.iter().chain(&files) {
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

/// Name of the file with the schema of a kind.
fn schema_name(kind: &FileKind) -> String {
    format!("{}.schema.json", kind.word)
}

/// The kind whose schema the first line of a file names.
fn schema_of(text: &str) -> Option<&'static FileKind> {
    let named = text.strip_prefix("#:schema ")?.lines().next()?;
    KINDS.iter().find(|kind| named.ends_with(&format!("/{}", schema_name(kind))))
}

/// The text with a first line that tells editors the schema beside it.
fn described(kind: &FileKind, text: &str) -> String {
    let rest = match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("#:schema") => rest,
        _ => text,
    };
    format!("#:schema ./{}\n{rest}", schema_name(kind))
}
