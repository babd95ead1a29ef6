//! A writer of small XML files.

use std::fmt::Write as _;

/// XML under construction; two blanks a level.
pub struct Xml {
    text: String,
    open: Vec<&'static str>,
}

/// Attributes in order.
pub type Attributes<'a> = &'a [(&'a str, String)];

impl Xml {
    /// An empty file.
    #[allow(clippy::new_without_default)] // a file without a root element is no file
    pub fn new() -> Self {
        Self { text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned(), open: Vec::new() }
    }

    fn start(&mut self, name: &str, attributes: Attributes) {
        let _ = write!(self.text, "{:indent$}<{name}", "", indent = 2 * self.open.len());
        for (key, value) in attributes {
            let _ = write!(self.text, " {key}=\"{}\"", escaped(value));
        }
    }

    /// An element with content.
    pub fn element(&mut self, name: &'static str, attributes: Attributes, content: impl FnOnce(&mut Self)) {
        self.start(name, attributes);
        self.text.push_str(">\n");
        self.open.push(name);
        content(self);
        self.open.pop();
        let _ = writeln!(self.text, "{:indent$}</{name}>", "", indent = 2 * self.open.len());
    }

    /// An element without content.
    pub fn leaf(&mut self, name: &str, attributes: Attributes) {
        self.start(name, attributes);
        self.text.push_str("/>\n");
    }

    /// The text.
    pub fn finish(self) -> String {
        self.text
    }
}

/// Text that may stand in an attribute.
pub(crate) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            c => escaped.push(c),
        }
    }
    escaped
}
