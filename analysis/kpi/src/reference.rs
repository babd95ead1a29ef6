//! Key figures as a page of the reference.

use crate::{Better, definitions};
use std::fmt::Write;

/// The page of the reference on every key figure, as Markdown.
pub fn reference() -> String {
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
