//! What has to be known of an ODS workbook before its sheets are unfolded: how many cells they come to, and the first cell
//! that spans several. A run of equal cells or rows is one element of the file, so a small file can have more cells than
//! any machine has memory.

use crate::bounds::{Extent, MOST_NODES, contents};
use crate::source::cell_name;
use roxmltree::{Document, Node, ParsingOptions};
use std::path::Path;

/// The first cell of a sheet of an ODS workbook that spans several; calamine does not tell.
///
/// # Errors
/// A file that cannot be read, or more cells than are read.
pub(crate) fn merged(path: &Path, sheet: &str) -> Result<Option<String>, String> {
    let text = contents(path, "content.xml")?;
    let document = document(&text)?;
    let table = tables(&document).find(|table| attribute(table, "name") == Some(sheet));
    let Some(table) = table else { return Ok(None) };
    for (row, line) in counted(&table, "table-row", "number-rows-repeated") {
        for (column, cell) in counted(&line, "table-cell", "number-columns-repeated") {
            let spans = |name: &str| repeats(&cell, name) > 1;
            if spans("number-columns-spanned") || spans("number-rows-spanned") {
                return Ok(Some(cell_name(row, column)));
            }
        }
    }
    Ok(None)
}

/// Refuses a workbook whose sheets have more cells together than are read; a reader of ODS unfolds all of them.
///
/// # Errors
/// A file that cannot be read, or more cells than are read.
pub(crate) fn bounded(path: &Path) -> Result<(), String> {
    let text = contents(path, "content.xml")?;
    let document = document(&text)?;
    let mut cells = 0;
    for table in tables(&document) {
        let mut extent = Extent::default();
        for (row, line) in counted(&table, "table-row", "number-rows-repeated") {
            for (column, cell) in counted(&line, "table-cell", "number-columns-repeated") {
                if attribute(&cell, "value-type").is_some()
                    || attribute(&cell, "formula").is_some()
                    || cell.has_children()
                {
                    extent.take(row, column);
                    let last = |first: u32, count: u32| first.saturating_add(count.saturating_sub(1));
                    extent.take(
                        last(row, repeats(&line, "number-rows-repeated")),
                        last(column, repeats(&cell, "number-columns-repeated")),
                    );
                }
            }
        }
        cells = extent.checked(cells)?;
    }
    Ok(())
}

fn document(text: &str) -> Result<Document<'_>, String> {
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| {
        if matches!(error, roxmltree::Error::NodesLimitReached) {
            return format!("it has more than {MOST_NODES} cells and texts; save the sheet as CSV");
        }
        error.to_string()
    })
}

fn tables<'a>(document: &'a Document<'_>) -> impl Iterator<Item = Node<'a, 'a>> {
    document.descendants().filter(|node| node.tag_name().name() == "table")
}

/// Elements of this name below another one, each with its number from 0 in the sheet; of cells those that are covered by
/// others count, too.
fn counted<'a>(
    parent: &Node<'a, 'a>,
    name: &'static str,
    repeated: &'static str,
) -> impl Iterator<Item = (u32, Node<'a, 'a>)> {
    let wanted = move |node: &Node<'_, '_>| node.tag_name().name().ends_with(name);
    // Rows lie in groups; the children of a row are its cells.
    let nodes = parent.descendants().filter(wanted);
    nodes.scan(0_u32, move |next, node| {
        let number = *next;
        *next = next.saturating_add(repeats(&node, repeated));
        Some((number, node))
    })
}

fn attribute<'a>(node: &Node<'a, 'a>, name: &str) -> Option<&'a str> {
    node.attributes().find(|attribute| attribute.name() == name).map(|attribute| attribute.value())
}

/// How often a cell or a row stands there, or how many it spans.
fn repeats(node: &Node<'_, '_>, name: &str) -> u32 {
    let count = node.attributes().find(|attribute| attribute.name() == name).map(|attribute| attribute.value());
    count.map_or(1, |count| count.parse().unwrap_or(u32::MAX))
}
