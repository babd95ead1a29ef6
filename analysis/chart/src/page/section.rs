//! Sections of a report and what they hold.

use crate::{Cell, Chart, Table, escape};
use std::fmt::Write;

/// Rows of a chart's data that the report holds; the rest is in the files of the run.
const ROWS: usize = 200;

/// A chart with its caption and the data under it.
#[derive(Clone, Debug)]
pub struct Figure {
    svg: String,
    caption: String,
    data: Table,
    file: Option<String>,
}

impl Figure {
    /// A chart with a caption: what to see in it.
    #[must_use]
    pub fn new(chart: &dyn Chart, caption: impl Into<String>) -> Self {
        Self { svg: chart.svg(), caption: caption.into(), data: chart.data(), file: None }
    }

    /// Names the file that holds all data, for the note under a shortened table.
    #[must_use]
    pub fn data_in(mut self, file: impl Into<String>) -> Self {
        self.file = Some(file.into());
        self
    }

    fn write(&self, text: &mut String, number: usize) {
        let _ = write!(
            text,
            "<figure id=\"figure-{number}\"><div class=\"chart\">{}</div><figcaption><b>Figure {number}.</b> {}</figcaption>",
            self.svg,
            escape(&self.caption)
        );
        let total = self.data.rows().len();
        if total > 0 {
            text.push_str("<details><summary>Data</summary>");
            write_table(text, &self.data, None, ROWS, plain);
            if total > ROWS {
                let rest = self.file.as_ref().map_or_else(
                    || "the others are in the result files of the run".to_owned(),
                    |f| format!("all of them are in {}", escape(f)),
                );
                let _ = write!(text, "<p>The first {ROWS} of {total} rows; {rest}.</p>");
            }
            text.push_str("</details>");
        }
        text.push_str("</figure>\n");
    }
}

/// Figures that a [`Section::choice`] offers at most; the style sheet has a rule for each.
pub(super) const CHOICES: usize = 24;

/// Columns from which a table needs the whole width of the page.
const WIDE: usize = 10;

#[derive(Clone, Debug)]
enum Item {
    Paragraph(String),
    List(Vec<String>),
    Folded(String, Vec<String>),
    Note(String),
    Warning(String),
    Table(String, Table),
    Figure(Figure),
    Choice(Vec<(String, Figure)>),
}

impl Item {
    /// Whether the item is a block: blocks that follow one another stand side by side on a wide screen.
    fn is_block(&self) -> bool {
        match self {
            Self::Table(..) | Self::Figure(_) | Self::Choice(_) => true,
            Self::Paragraph(_) | Self::List(_) | Self::Folded(..) | Self::Note(_) | Self::Warning(_) => false,
        }
    }

    fn write(&self, out: &mut String, figures: &mut usize) {
        match self {
            Self::Paragraph(text) => {
                let _ = write!(out, "<p>{}</p>", escape(text));
            }
            Self::List(entries) => write_list(out, entries),
            Self::Folded(title, entries) => write_folded(out, title, entries),
            Self::Note(text) => {
                let _ = write!(out, "<p class=\"remark\"><b>Note.</b> {}</p>", escape(text));
            }
            Self::Warning(text) => {
                let _ = write!(out, "<p class=\"remark warning\"><b>Warning.</b> {}</p>", escape(text));
            }
            Self::Table(caption, table) => write_table(out, table, Some(caption), usize::MAX, readable),
            Self::Figure(figure) => {
                *figures += 1;
                figure.write(out, *figures);
            }
            Self::Choice(choices) => write_choice(out, choices, figures),
        }
    }
}

fn write_list(text: &mut String, entries: &[String]) {
    if entries.is_empty() {
        return;
    }
    text.push_str("<ul>");
    for entry in entries {
        let _ = write!(text, "<li>{}</li>", escape(entry));
    }
    text.push_str("</ul>");
}

/// A button and the list that it shows. A page on paper shows the list; a closed `<details>` would not be printed.
fn write_folded(text: &mut String, title: &str, entries: &[String]) {
    if entries.is_empty() {
        return;
    }
    let id = format!("fold-{}", text.len());
    let _ = write!(
        text,
        "<div class=\"fold\"><input type=\"checkbox\" id=\"{id}\"/><label for=\"{id}\">{}</label>",
        escape(title)
    );
    write_list(text, entries);
    text.push_str("</div>");
}

/// Radio buttons with the names, then the figures; the style sheet shows the figure of the button that is set. A page
/// on paper shows all of them.
fn write_choice(text: &mut String, choices: &[(String, Figure)], figures: &mut usize) {
    let group = *figures + 1;
    let _ = write!(text, "<div class=\"choice\" role=\"group\">");
    for (index, (name, _)) in choices.iter().enumerate() {
        let checked = if index == 0 { " checked=\"checked\"" } else { "" };
        let id = format!("choice-{group}-{}", index + 1);
        let _ = write!(
            text,
            "<input type=\"radio\" name=\"choice-{group}\" id=\"{id}\"{checked}/><label for=\"{id}\">{}</label>",
            escape(name)
        );
    }
    for (_, figure) in choices {
        *figures += 1;
        text.push_str("<div class=\"panel\">");
        figure.write(text, *figures);
        text.push_str("</div>");
    }
    text.push_str("</div>\n");
}

/// A heading with paragraphs, tables, figures, notes and warnings below, in the order of the calls.
#[derive(Clone, Debug)]
pub struct Section {
    heading: String,
    items: Vec<Item>,
}

impl Section {
    /// A section with nothing but a heading.
    #[must_use]
    pub fn new(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), items: Vec::new() }
    }

    fn with(mut self, item: Item) -> Self {
        self.items.push(item);
        self
    }

    /// Adds a paragraph.
    #[must_use]
    pub fn paragraph(self, text: impl Into<String>) -> Self {
        self.with(Item::Paragraph(text.into()))
    }

    /// Adds a list.
    #[must_use]
    pub fn list<S: Into<String>>(self, items: impl IntoIterator<Item = S>) -> Self {
        self.with(Item::List(items.into_iter().map(Into::into).collect()))
    }

    /// Adds a list for reference under its title: a click shows it, paper always does.
    #[must_use]
    pub fn folded<S: Into<String>>(self, title: impl Into<String>, items: impl IntoIterator<Item = S>) -> Self {
        self.with(Item::Folded(title.into(), items.into_iter().map(Into::into).collect()))
    }

    /// Adds a remark that the reader should not miss.
    #[must_use]
    pub fn note(self, text: impl Into<String>) -> Self {
        self.with(Item::Note(text.into()))
    }

    /// Adds a warning: a reason to doubt what stands around it.
    #[must_use]
    pub fn warning(self, text: impl Into<String>) -> Self {
        self.with(Item::Warning(text.into()))
    }

    /// Adds a table with all its rows.
    #[must_use]
    pub fn table(self, caption: impl Into<String>, table: Table) -> Self {
        self.with(Item::Table(caption.into(), table))
    }

    /// Adds a figure; figures are numbered through the report.
    #[must_use]
    pub fn figure(self, figure: Figure) -> Self {
        self.with(Item::Figure(figure))
    }

    /// Adds figures of one kind, of which the reader picks one by its name; on paper all of them are shown. The first
    /// is shown at once. Beyond 24 the figures stand one after another.
    #[must_use]
    pub fn choice(self, figures: impl IntoIterator<Item = (String, Figure)>) -> Self {
        let mut figures: Vec<_> = figures.into_iter().collect();
        match figures.len() {
            0 => self,
            1 => self.with(Item::Figure(figures.remove(0).1)),
            2..=CHOICES => self.with(Item::Choice(figures)),
            _ => figures.into_iter().fold(self, |section, (_, figure)| section.figure(figure)),
        }
    }

    /// Whether there is nothing below the heading.
    pub(super) fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    pub(super) fn heading(&self) -> &str {
        &self.heading
    }

    pub(super) fn write(&self, text: &mut String, number: usize, figures: &mut usize) {
        let _ = write!(
            text,
            "<section id=\"section-{number}\"><h2><span class=\"n\">{number}</span>{}</h2>",
            escape(&self.heading)
        );
        for items in self.items.chunk_by(|one, next| one.is_block() && next.is_block()) {
            let is_grid = items[0].is_block();
            if is_grid {
                text.push_str("<div class=\"blocks\">");
            }
            for item in items {
                item.write(text, figures);
            }
            if is_grid {
                text.push_str("</div>");
            }
        }
        text.push_str("</section>\n");
    }
}

fn write_table(out: &mut String, table: &Table, caption: Option<&str>, rows: usize, print: impl Fn(f64) -> String) {
    // A column is aligned like its first number.
    let numeric: Vec<bool> =
        (0..table.columns().len()).map(|i| table.rows().iter().any(|row| matches!(row[i], Cell::Number(_)))).collect();
    let class = |i: usize| if numeric[i] { " class=\"num\"" } else { "" };
    let wide = if table.columns().len() >= WIDE { " wide" } else { "" };
    let _ = write!(out, "<div class=\"scroll{wide}\"><table>");
    if let Some(caption) = caption.filter(|c| !c.is_empty()) {
        let _ = write!(out, "<caption><span>{}</span></caption>", escape(caption));
    }
    out.push_str("<thead><tr>");
    for (i, column) in table.columns().iter().enumerate() {
        let _ = write!(out, "<th scope=\"col\"{}>{}</th>", class(i), escape(column));
    }
    out.push_str("</tr></thead><tbody>");
    for row in table.rows().iter().take(rows) {
        out.push_str("<tr>");
        for (i, cell) in row.iter().enumerate() {
            let text = match cell {
                Cell::Text(text) => escape(text),
                Cell::Number(value) => print(*value),
            };
            let _ = write!(out, "<td{}>{text}</td>", class(i));
        }
        out.push_str("</tr>");
    }
    out.push_str("</tbody></table></div>");
}

/// A number in a table of results: four significant digits, a count in full, the typographic minus.
fn readable(value: f64) -> String {
    let is_count = value.fract() == 0.0 && value.abs() < 1e6;
    crate::number(value, if is_count { 6 } else { 4 })
}

/// A number that a spreadsheet understands when the table is copied: six significant digits.
fn plain(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let short: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if short == 0.0 || (1e-4..1e15).contains(&short.abs()) { format!("{}", short + 0.0) } else { format!("{short:e}") }
}
