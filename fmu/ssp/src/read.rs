//! Reading XML with every fault at its line.

use roxmltree::{Document, Node};
use std::str::FromStr;
use toolroom_fmu_import::xml;

/// One thing that is wrong in an entry of a package.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Entry of the package.
    pub entry: String,
    /// Line, from 1.
    pub line: u32,
    /// What is wrong.
    pub message: String,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}: {}", self.entry, self.line, self.message)
    }
}

/// Faults of an entry, as they are found.
pub(crate) struct Reader {
    pub entry: String,
    pub faults: Vec<Fault>,
}

impl Reader {
    pub fn new(entry: &str) -> Self {
        Self { entry: entry.to_owned(), faults: Vec::new() }
    }

    /// The document of a text; a fault where it is no XML.
    pub fn parse<'t>(&mut self, text: &'t str) -> Option<Document<'t>> {
        match xml::document(text) {
            Ok(document) => Some(document),
            Err((line, message)) => {
                self.fault_at(line, message);
                None
            }
        }
    }

    pub fn line(&self, node: Node<'_, '_>) -> u32 {
        node.document().text_pos_at(node.range().start).row
    }

    pub fn fault(&mut self, node: Node<'_, '_>, message: String) {
        self.fault_at(self.line(node), message);
    }

    pub fn fault_at(&mut self, line: u32, message: String) {
        self.fault_of(&self.entry.clone(), line, message);
    }

    /// A fault of another entry of the package.
    pub fn fault_of(&mut self, entry: &str, line: u32, message: String) {
        self.faults.push(Fault { entry: entry.to_owned(), line, message });
    }

    /// An attribute that has to be there; empty where it is not.
    pub fn required(&mut self, node: Node<'_, '_>, name: &str) -> String {
        let value = node.attribute(name);
        if value.is_none() {
            self.fault(node, format!("<{}> lacks the attribute {name}", node.tag_name().name()));
        }
        value.unwrap_or_default().to_owned()
    }

    /// An attribute that is a number, if it is there.
    pub fn number<T: FromStr>(&mut self, node: Node<'_, '_>, name: &str) -> Option<T> {
        let text = node.attribute(name)?;
        let value = text.trim().parse().ok();
        if value.is_none() {
            self.fault(node, format!("{name} = \"{text}\" is no number"));
        }
        value
    }
}
