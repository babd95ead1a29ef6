//! Names of variables by `variableNamingConvention`.
//!
//! # Source
//! FMI 2.0.5, section 2.2.9, and FMI 3.0.2, section 2.4.7.5: both have the same grammar.

use super::{Findings, Rule, Severity};
use crate::description::ModelDescription;

/// Tells names that are against the convention which the description names.
pub(super) fn check(description: &ModelDescription, findings: &mut Findings) {
    let structured = description.about.get("variableNamingConvention").is_some_and(|word| word == "structured");
    for variable in &description.variables {
        let name = &variable.name;
        let fault = if structured && !is_structured(name) {
            format!("{name} is no name of the structured naming convention")
        } else if !structured && name.contains(['\r', '\n', '\t']) {
            format!("{} has a tab or the end of a line in its name", name.escape_default())
        } else {
            continue;
        };
        findings.line(Rule::Description, Severity::Error, variable.line, fault);
    }
}

/// `name`: an identifier, or `der(identifier)` with the order of the derivative behind a comma.
fn is_structured(name: &str) -> bool {
    let Some(inside) = name.strip_prefix("der(").and_then(|rest| rest.strip_suffix(')')) else {
        return identifier(name) == Some("");
    };
    match identifier(inside) {
        Some("") => true,
        Some(rest) => rest.strip_prefix(',').is_some_and(|order| numbers(order) == Some("") && !order.contains(',')),
        None => false,
    }
}

/// What follows an identifier: names with indices, parted by points.
fn identifier(mut text: &str) -> Option<&str> {
    loop {
        text = text.strip_prefix('\'').map_or_else(|| plain(text), quoted)?;
        if let Some(indices) = text.strip_prefix('[') {
            text = numbers(indices)?.strip_prefix(']')?;
        }
        match text.strip_prefix('.') {
            Some(rest) => text = rest,
            None => return Some(text),
        }
    }
}

/// What follows a name of letters, digits and underscores.
fn plain(text: &str) -> Option<&str> {
    let rest = text.trim_start_matches(|letter: char| letter.is_ascii_alphanumeric() || letter == '_');
    (rest.len() < text.len() && !text.starts_with(|letter: char| letter.is_ascii_digit())).then_some(rest)
}

/// What follows a name in quotes, whose first quote was read.
fn quoted(text: &str) -> Option<&str> {
    let mut letters = text.char_indices();
    while let Some((at, letter)) = letters.next() {
        match letter {
            '\'' => return (at > 0).then(|| &text[at + 1..]),
            '\\' => letters.next().filter(|(_, escaped)| "'\"?\\abfnrtv".contains(*escaped)).map(drop)?,
            plain if plain.is_ascii_graphic() && !"\"`".contains(plain) || plain == ' ' => {}
            _ => return None,
        }
    }
    None
}

/// What follows whole numbers that are parted by commas.
fn numbers(mut text: &str) -> Option<&str> {
    loop {
        let rest = text.trim_start_matches(|digit: char| digit.is_ascii_digit());
        if rest.len() == text.len() {
            return None;
        }
        match rest.strip_prefix(',') {
            Some(next) => text = next,
            None => return Some(rest),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::is_structured;

    #[test]
    fn names_of_the_grammar_are_told_from_others() {
        for name in [
            "x",
            "_x1",
            "tool.flank_wear",
            "a[1]",
            "a[1,2].b",
            "der(x)",
            "der(a.b[3],2)",
            "der",
            "'any name?'",
            "a.'it\\'s'.b",
        ] {
            assert!(is_structured(name), "{name}");
        }
        for name in [
            "",
            "1",
            "1x",
            "a b",
            "a.",
            ".a",
            "a..b",
            "a[]",
            "a[x]",
            "a[1",
            "a[1]b",
            "der(x",
            "der(x)y",
            "der(x,)",
            "der(x,1,2)",
            "der(der(x))",
            "''",
            "'open",
            "'\\q'",
            "'\"'",
            "ä",
            "a-b",
        ] {
            assert!(!is_structured(name), "{name}");
        }
    }
}
