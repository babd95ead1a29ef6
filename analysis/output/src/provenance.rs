//! How a result came to be, as its files tell it.

use toolroom_chart::page::Provenance;
use toolroom_shards::fingerprint;

/// The command as it has to be typed, and the input files with their hashes. `arguments` follow
/// verb and files.
pub fn provenance(
    verb: &str,
    inputs: &[(String, &[u8])],
    arguments: impl IntoIterator<Item = String>,
    seed: Option<u64>,
) -> Provenance {
    let words = inputs.iter().map(|(name, _)| name.clone()).chain(arguments);
    let command = words.fold(format!("toolroom {verb}"), |command, word| command + " " + &quoted(&word));
    let inputs = inputs.iter().map(|(name, bytes)| (name.clone(), fingerprint(bytes))).collect();
    Provenance { version: env!("CARGO_PKG_VERSION").to_owned(), command, seed, inputs }
}

/// An argument as it has to be typed.
pub fn quoted(argument: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:%+,".contains(c);
    if !argument.is_empty() && argument.chars().all(plain) { argument.to_owned() } else { format!("{argument:?}") }
}
