//! XML of others, within bounds.

use roxmltree::Document;

/// Most attributes of an element (assumption: those of FMI and SSP have some thirty at most). The parser compares each attribute
/// with all before it: an element of a hundred thousand, a few kilobytes in an archive, would take minutes.
const MOST_ATTRIBUTES: usize = 1000;

/// What is read past as a whole: how it begins and how it ends. Equals signs in it are no attributes.
const WHOLES: [(&str, &str); 3] = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];

/// The document of a text, which may begin with a byte order mark.
///
/// # Errors
/// The line, from 1, and what is wrong there: no well-formed XML, or an element with more than 1000 attributes.
///
/// # Examples
/// ```
/// assert!(toolroom_fmu_import::xml::document("<a b='1'/>").is_ok());
/// let crowded: String = (0..2000).map(|i| format!(" b{i}='1'")).collect();
/// let (line, why) = toolroom_fmu_import::xml::document(&format!("<a>\n<b{crowded}/></a>")).unwrap_err();
/// assert!(line == 2 && why.contains("more than 1000 attributes"), "{why}");
/// ```
pub fn document(text: &str) -> Result<Document<'_>, (u32, String)> {
    let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
    if let Some(start) = crowded(text) {
        let line = text[..start].matches('\n').count() as u32 + 1;
        return Err((line, format!("an element has more than {MOST_ATTRIBUTES} attributes, which no description has")));
    }
    Document::parse(text).map_err(|error| (error.pos().row, format!("not well-formed XML: {error}")))
}

/// Where an element with too many attributes starts. A text that is no XML is answered by the parser.
fn crowded(text: &str) -> Option<usize> {
    let mut passed = 0;
    while let Some(open) = text[passed..].find('<') {
        let start = passed + open;
        let rest = &text[start..];
        let length = match WHOLES.iter().find(|(opening, _)| rest.starts_with(opening)) {
            Some((_, closing)) => rest.find(closing)? + closing.len(),
            None => {
                let (length, attributes) = tag(rest);
                if attributes > MOST_ATTRIBUTES {
                    return Some(start);
                }
                length
            }
        };
        passed = start + length;
    }
    None
}

/// Length of the tag at the start of a text, and how many equals signs stand in it outside quotes.
fn tag(text: &str) -> (usize, usize) {
    let (mut quote, mut attributes) = (None, 0);
    for (i, byte) in text.bytes().enumerate() {
        match (quote, byte) {
            (Some(opened), _) if opened == byte => quote = None,
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'=') => attributes += 1,
            (None, b'>') => return (i + 1, attributes),
            (Some(_) | None, _) => {}
        }
    }
    (text.len(), attributes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_attributes_of_one_element_count() {
        let many = |attribute: &str| attribute.repeat(2 * MOST_ATTRIBUTES);
        for sound in [
            format!("<a>{}</a>", many("<b c='1'/>")),
            format!("<a>{}</a>", many("=")),
            format!("<a b='{}'/>", many("=")),
            format!("<!--{}--><a/>", many("=>")),
            format!("<a><![CDATA[{}]]></a>", many("<= ")),
        ] {
            assert!(document(&sound).is_ok(), "{sound:.40}");
        }
        let names: String = (0..MOST_ATTRIBUTES).map(|i| format!(" b{i}=\"1\"")).collect();
        assert!(document(&format!("\u{FEFF}<a{names}/>")).is_ok());
        assert!(document(&format!("<a{names} c=\"1\"/>")).is_err());
        assert!(document(&many("<")).is_err() && document(&many("<!--")).is_err());
    }
}
