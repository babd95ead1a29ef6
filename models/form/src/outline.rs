//! What a TOML text has at its top, from which the kind of a file is told before a reader is chosen.

use crate::{ReadError, syntax};
use std::path::Path;
use toml::de::DeValue;

/// The top of a parsed TOML text: its keys, and the texts one table below.
///
/// ```
/// use toolroom_form::Outline;
/// let outline = Outline::of("title = \"\"\"\n[shop]\n\"\"\"\n[ gap ] # priors\nprocess = 'program'\n");
/// assert!(outline.has("gap") && !outline.has("shop"));
/// assert_eq!(outline.text("gap", "process"), Some("program"));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outline {
    keys: Vec<String>,
    texts: Vec<[String; 3]>,
    broken: bool,
}

impl Outline {
    /// The outline of a text; of a text that is not TOML, as far as it can be understood.
    pub fn of(text: &str) -> Self {
        let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
        let (root, errors) = syntax::tree(text);
        let mut outline = Self { broken: !errors.is_empty(), ..Self::default() };
        for (key, value) in root.get_ref() {
            let key = key.get_ref().to_string();
            for (inner, text) in value.get_ref().as_table().into_iter().flatten() {
                if let DeValue::String(text) = text.get_ref() {
                    outline.texts.push([key.clone(), inner.get_ref().to_string(), text.to_string()]);
                }
            }
            outline.keys.push(key);
        }
        outline
    }

    /// The outline of a file.
    ///
    /// # Errors
    /// [`ReadError`]: the file cannot be opened or decoded.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        Ok(Self::of(&crate::text(path)?))
    }

    /// Whether the key or table `key` stands at the top.
    pub fn has(&self, key: &str) -> bool {
        self.keys.iter().any(|own| own == key)
    }

    /// The text of `key` in the table `table`.
    pub fn text(&self, table: &str, key: &str) -> Option<&str> {
        self.texts.iter().find(|[outer, inner, _]| outer == table && inner == key).map(|[_, _, text]| text.as_str())
    }

    /// Whether the text breaks the rules of TOML.
    pub fn is_broken(&self) -> bool {
        self.broken
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_found_however_they_are_written() {
        for text in [
            "[shop] # comment",
            "[ shop ]",
            "[\"shop\"]",
            "['shop']",
            "shop.name = \"a\"",
            "shop = {}",
            "\u{FEFF}[shop]",
        ] {
            assert!(Outline::of(text).has("shop"), "{text}");
        }
        for text in
            ["a = \"\"\"\n[shop]\n\"\"\"", "a = '''\n[shop]\n'''", "# [shop]", "[a]\n[a.shop]", "[[a]]\nshop = 1"]
        {
            assert!(!Outline::of(text).has("shop"), "{text}");
        }
    }

    #[test]
    fn a_broken_text_shows_what_can_be_understood() {
        let outline = Outline::of("[shop]\nname = \n");
        assert!(outline.is_broken() && outline.has("shop"));
    }
}
