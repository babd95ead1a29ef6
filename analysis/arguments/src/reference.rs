//! The command line as a page of reference and as manual pages, from what clap knows of it.

use clap::{Arg, Command};
use std::fmt::Write;

/// Verbs below a command with their whole names, in order; those of people only.
fn verbs(command: &Command) -> Vec<(String, &Command)> {
    let mut all = Vec::new();
    for verb in command.get_subcommands().filter(|verb| !verb.is_hide_set() && verb.get_name() != "help") {
        let name = format!("{} {}", command.get_bin_name().unwrap_or(command.get_name()), verb.get_name());
        let inner = verbs(verb);
        // `modes FILE` is a verb, and so is `modes update`.
        if inner.is_empty() || verb.get_positionals().next().is_some() {
            all.push((name, verb));
        }
        all.extend(inner);
    }
    all
}

/// Arguments that a verb shows, those of every verb last.
fn arguments(command: &Command) -> Vec<&Arg> {
    let shown = |arg: &&Arg| !arg.is_hide_set() && !["help", "version"].contains(&arg.get_id().as_str());
    let mut all: Vec<&Arg> = command.get_arguments().filter(shown).collect();
    all.sort_by_key(|arg| (arg.is_global_set(), !arg.is_positional()));
    all
}

/// `--set <KEY=VALUE>`, `FILE`.
fn spelled(arg: &Arg) -> String {
    let names = arg.get_value_names().unwrap_or_default();
    let values: Vec<String> = names.iter().map(|name| format!("<{name}>")).collect();
    let takes = arg.get_action().takes_values();
    let values = if takes { values.join(" ") } else { String::new() };
    let short = arg.get_short().map(|short| format!("-{short}, ")).unwrap_or_default();
    match arg.get_long() {
        Some(long) if values.is_empty() => format!("{short}--{long}"),
        Some(long) => format!("{short}--{long} {values}"),
        None => match arg.get_short() {
            Some(short) => format!("-{short} {values}"),
            None => values,
        },
    }
}

/// What an argument means, with its words and default.
fn meant(arg: &Arg) -> String {
    let mut text = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let words: Vec<String> = arg.get_possible_values().iter().map(|word| word.get_name().to_owned()).collect();
    if arg.get_action().takes_values() && !words.is_empty() {
        let _ = write!(text, " ({})", words.join(", "));
    }
    let defaults: Vec<_> = arg.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    if arg.get_action().takes_values() && !defaults.is_empty() {
        let _ = write!(text, ". Default: {}", defaults.join(" "));
    }
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The examples of a verb, without their heading.
fn examples(command: &Command) -> Option<String> {
    let text = command.get_before_help()?.to_string();
    Some(text.strip_prefix("Examples:\n").unwrap_or(&text).trim_end().to_owned())
}

/// Every verb with its arguments, as a page.
pub fn page(command: &Command) -> String {
    let mut text = "# Commands and options\n\n".to_owned();
    for (name, verb) in verbs(command) {
        let about = verb.get_about().map(ToString::to_string).unwrap_or_default();
        let _ = write!(text, "## {name}\n\n{about}.\n\n");
        if let Some(examples) = examples(verb) {
            let _ = write!(text, "```text\n{examples}\n```\n\n");
        }
        text.push_str("| argument | meaning |\n|---|---|\n");
        for arg in arguments(verb) {
            let cell = |text: String| text.replace('|', "\\|");
            let _ = writeln!(text, "| `{}` | {} |", cell(spelled(arg)), cell(meant(arg)).replace('<', "&lt;"));
        }
        text.push('\n');
    }
    let codes = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let _ = write!(text, "## Exit codes\n\n```text\n{}\n```\n", codes.strip_prefix("Exit codes:\n").unwrap_or(&codes));
    text
}

/// A manual page for the program and for each verb, by file name.
pub fn manual(command: &Command) -> Vec<(String, String)> {
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    let mut whole = head("toolroom", &about);
    whole.push_str(".SH SYNOPSIS\n\\fBtoolroom\\fR \\fIVERB\\fR [\\fIARGUMENTS\\fR]\n.SH VERBS\n");
    let mut pages = Vec::new();
    for (name, verb) in verbs(command) {
        let about = verb.get_about().map(ToString::to_string).unwrap_or_default();
        let dashed = name.replace(' ', "-");
        let _ = write!(whole, ".TP\n\\fB{}\\fR(1)\n{}\n", escaped(&dashed), escaped(&about));
        let mut page = head(&dashed, &about);
        let _ = write!(page, ".SH SYNOPSIS\n\\fB{}\\fR", escaped(&name));
        for arg in arguments(verb).iter().filter(|arg| arg.is_positional()) {
            let spelled = escaped(&spelled(arg));
            let _ = if arg.is_required_set() { write!(page, " {spelled}") } else { write!(page, " [{spelled}]") };
        }
        page.push_str(" [\\fIOPTIONS\\fR]\n.SH ARGUMENTS\n");
        for arg in arguments(verb) {
            let _ = write!(page, ".TP\n\\fB{}\\fR\n{}\n", escaped(&spelled(arg)), escaped(&meant(arg)));
        }
        if let Some(examples) = examples(verb) {
            let _ = write!(page, ".SH EXAMPLES\n.nf\n{}\n.fi\n", escaped(&examples));
        }
        page.push_str(".SH SEE ALSO\n\\fBtoolroom\\fR(1)\n");
        pages.push((format!("{dashed}.1"), page));
    }
    let codes = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let codes = codes.strip_prefix("Exit codes:\n").unwrap_or(&codes).to_owned();
    let _ = write!(whole, ".SH EXIT STATUS\n.nf\n{}\n.fi\n", escaped(&codes));
    pages.push(("toolroom.1".to_owned(), whole));
    pages
}

fn head(name: &str, about: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    format!(
        ".TH {} 1 \"\" \"toolroom {version}\"\n.SH NAME\n{} \\- {}\n",
        name.to_uppercase(),
        escaped(name),
        escaped(about)
    )
}

/// A text that roff prints as it is, line by line; letters beyond ASCII by their number, which every roff knows.
fn escaped(text: &str) -> String {
    let letter = |letter: char| match letter {
        '\\' => "\\\\".to_owned(),
        '-' => "\\-".to_owned(),
        letter if letter.is_ascii() => letter.to_string(),
        letter => format!("\\[u{:04X}]", u32::from(letter)),
    };
    let line = |line: &str| {
        let line: String = line.chars().map(letter).collect();
        if line.starts_with(['.', '\'']) { format!("\\&{line}") } else { line }
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}
