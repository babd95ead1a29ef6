//! The table `[gap.applied]`, by which a later `gap apply` knows the models that it wrote.

use toolroom_shards::fingerprint;

const TABLE: &str = "[gap.applied]";
/// How the lines of the mark begin.
const MINE: [&str; 2] = [TABLE, "data = "];

/// A model with the mark at its end; `data` are hashes of the records that its calibration has seen.
pub fn marked(model: &str, data: &[String]) -> String {
    let (text, _) = parted(model);
    let hash = fingerprint(text.as_bytes());
    let data = data.iter().map(|own| format!("\"{own}\"")).collect::<Vec<_>>().join(", ");
    format!(
        "{text}\n\n{TABLE} # what `toolroom gap apply` wrote: the next one replaces it as long as nobody edits it\ntext = \"{hash}\"\ndata = [{data}]\n"
    )
}

/// Whether `gap apply` wrote a model and nobody changed it since.
pub fn is_marked(model: &str) -> bool {
    let (text, hash) = parted(model);
    hash.is_some_and(|hash| hash == fingerprint(text.as_bytes()))
}

/// A model without its mark, and the hash in it.
fn parted(model: &str) -> (String, Option<String>) {
    let (mut lines, mut hash, mut within) = (Vec::new(), None, false);
    for line in model.lines() {
        if line.trim_start().starts_with('[') {
            within = line.trim_start().starts_with(TABLE);
        }
        if let Some(value) = line.trim().strip_prefix("text = \"").filter(|_| within) {
            hash = Some(value.trim_end_matches('"').to_owned());
        } else if !within || !MINE.iter().any(|own| line.trim_start().starts_with(own)) {
            // What somebody has written behind the mark is no part of it.
            lines.push(line);
        }
    }
    (lines.join("\n").trim_end().to_owned(), hash)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_that_somebody_edits_loses_its_mark() {
        let model = marked("schema = 1\n[gap]\nforce = 0.1\n", &["0a".to_owned()]);
        assert!(is_marked(&model));
        assert!(is_marked(&marked(&model, &[])) && marked(&model, &["0a".to_owned()]) == model);
        assert!(!is_marked(&model.replace("0.1", "0.2")));
        assert!(!is_marked(&format!("{model}[output]\nlogs = false\n")));
        assert!(!is_marked(&format!("{model}# ask Ann about the wear\n")));
        assert!(is_marked(&format!("{model}\n\n")));
        assert!(!is_marked("schema = 1\n"));
    }
}
