//! The report: one HTML file that opens from disk, needs no script and no network, and prints.
//!
//! ```
//! use toolroom_chart::page::{Report, Section};
//! let page = Report::new("Constant against <adaptive> speed")
//!     .section(Section::new("Result").paragraph("Adaptive makes 17 parts more per shift."))
//!     .html();
//! assert!(page.contains("Constant against &lt;adaptive&gt; speed"));
//! ```

mod css;
mod section;

pub use section::{Figure, Section};

use crate::escape;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A report cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// The file system refused; a previous report at this path is untouched.
    #[error("cannot write the report {path}: {source}")]
    Write {
        /// The file that was to be written.
        path: PathBuf,
        /// What the file system said.
        source: std::io::Error,
    },
}

/// A key figure at the head of the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tile {
    /// What it is, for example `parts / shift`.
    pub label: String,
    /// The value with its unit.
    pub value: String,
    /// What stands below: the interval, the baseline.
    pub note: String,
}

impl Tile {
    /// A key figure.
    #[must_use]
    pub fn new(label: impl Into<String>, value: impl Into<String>, note: impl Into<String>) -> Self {
        Self { label: label.into(), value: value.into(), note: note.into() }
    }
}

/// Where the numbers come from: enough to compute them again.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// The command line.
    pub command: String,
    /// Seed of the random numbers, if any were drawn.
    pub seed: Option<u64>,
    /// Name and hash of each input file.
    pub inputs: Vec<(String, String)>,
}

/// A report being put together.
#[derive(Clone, Debug)]
pub struct Report {
    title: String,
    lead: Vec<String>,
    tiles: Vec<Tile>,
    sections: Vec<Section>,
    provenance: Option<Provenance>,
}

impl Report {
    /// A report with nothing but a title.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), lead: Vec::new(), tiles: Vec::new(), sections: Vec::new(), provenance: None }
    }

    /// Adds a paragraph under the title: the decision, in one or two sentences.
    #[must_use]
    pub fn lead(mut self, text: impl Into<String>) -> Self {
        self.lead.push(text.into());
        self
    }

    /// Adds a key figure.
    #[must_use]
    pub fn tile(mut self, tile: Tile) -> Self {
        self.tiles.push(tile);
        self
    }

    /// Adds a section; one with nothing below its heading is left out.
    #[must_use]
    pub fn section(mut self, section: Section) -> Self {
        if !section.is_empty() {
            self.sections.push(section);
        }
        self
    }

    /// Sets the footer.
    #[must_use]
    pub fn provenance(mut self, provenance: Provenance) -> Self {
        self.provenance = Some(provenance);
        self
    }

    /// The report as HTML, which is also well-formed XML. The same report gives the same bytes.
    #[must_use]
    pub fn html(&self) -> String {
        let title = escape(&self.title);
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\"/>\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\
             <meta name=\"color-scheme\" content=\"light dark\"/>\
             <title>{title}</title><style>{}</style></head>\n<body><header><h1>{title}</h1>",
            css::sheet()
        );
        for text in &self.lead {
            let _ = write!(out, "<p class=\"lead\">{}</p>", escape(text));
        }
        out.push_str("</header>\n<main>");
        self.write_tiles(&mut out);
        self.write_contents(&mut out);
        let mut figures = 0;
        for (i, section) in self.sections.iter().enumerate() {
            section.write(&mut out, i + 1, &mut figures);
        }
        out.push_str("</main>\n");
        if let Some(p) = &self.provenance {
            write_footer(&mut out, p);
        }
        out.push_str("</body></html>\n");
        out
    }

    fn write_tiles(&self, text: &mut String) {
        if self.tiles.is_empty() {
            return;
        }
        text.push_str("<dl class=\"tiles\">");
        for t in &self.tiles {
            let _ = write!(
                text,
                "<div><dt>{}</dt><dd>{}</dd><dd class=\"note\">{}</dd></div>",
                escape(&t.label),
                escape(&t.value),
                escape(&t.note)
            );
        }
        text.push_str("</dl>\n");
    }

    fn write_contents(&self, text: &mut String) {
        if self.sections.len() <= 4 {
            return;
        }
        text.push_str("<nav aria-label=\"Contents\"><h2>Contents</h2><ol>");
        for (i, section) in self.sections.iter().enumerate() {
            let _ = write!(text, "<li><a href=\"#section-{}\">{}</a></li>", i + 1, escape(section.heading()));
        }
        text.push_str("</ol></nav>\n");
    }

    /// Writes the report: first beside its place, then renamed into it, so that whoever opens
    /// `path` finds the old report or the new one, never a part.
    ///
    /// # Errors
    /// [`PageError::Write`] when the file system refuses; nothing is left behind.
    pub fn write(&self, path: &Path) -> Result<(), PageError> {
        let refused = |source| PageError::Write { path: path.to_owned(), source };
        let name = path.file_name().ok_or_else(|| refused(std::io::ErrorKind::InvalidInput.into()))?;
        let mut part = std::ffi::OsString::from(".");
        part.push(name);
        part.push(format!(".{}.part", std::process::id()));
        let part = path.with_file_name(part);
        let written = std::fs::File::create(&part).and_then(|mut file| {
            file.write_all(self.html().as_bytes())?;
            file.sync_all()
        });
        written.and_then(|()| std::fs::rename(&part, path)).map_err(|source| {
            // The reason for the failure matters more than whether the remains could be removed.
            let _ = std::fs::remove_file(&part);
            refused(source)
        })
    }
}

fn write_footer(text: &mut String, p: &Provenance) {
    text.push_str("<footer><h2>Provenance</h2><table><tbody>");
    let mut row = |name: &str, value: &str| {
        let _ = write!(text, "<tr><th scope=\"row\">{}</th><td><code>{}</code></td></tr>", escape(name), escape(value));
    };
    row("Version", &p.version);
    row("Command", &p.command);
    if let Some(seed) = p.seed {
        row("Seed", &seed.to_string());
    }
    for (name, hash) in &p.inputs {
        row(name, hash);
    }
    text.push_str("</tbody></table></footer>");
}

#[cfg(test)]
mod tests;
