//! Encodings of tables that other programs write.

crate::vocabulary! {
    /// How the letters of a table are written as bytes.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Encoding {
        /// UTF-8, with or without byte order mark.
        #[default]
        Utf8 = "utf-8",
        /// UTF-16; the byte order mark says which byte is first, without one it is the lower.
        Utf16 = "utf-16",
        /// ISO 8859-1: a byte is the letter of its number.
        Latin1 = "latin-1",
        /// The Western encoding of Windows: ISO 8859-1 with letters at 0x80 to 0x9F.
        Windows1252 = "windows-1252",
    }
}

/// Letters of Windows-1252 at 0x80 to 0x9F; `\0` where there is none.
///
/// # Source
/// Unicode Consortium, mapping table CP1252.TXT, version 2.01.
const WINDOWS: [char; 32] = [
    '€', '\0', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\0', 'Ž', '\0', '\0', '‘', '’', '“', '”', '•',
    '–', '—', '˜', '™', 'š', '›', 'œ', '\0', 'ž', 'Ÿ',
];

/// Bytes that are no letter of an encoding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undecodable {
    /// Line in which they stand, from 1.
    pub line: u64,
    /// What they are and why they are no letter.
    pub reason: String,
}

impl Encoding {
    /// The text of a file in this encoding, without byte order mark. A file with the byte order mark of UTF-16 is UTF-16
    /// where UTF-8 is due: nothing else begins so.
    ///
    /// # Errors
    /// [`Undecodable`], with the line.
    pub fn decode(self, bytes: &[u8]) -> Result<String, Undecodable> {
        match self {
            Self::Utf16 => wide(marked(bytes).unwrap_or((bytes, u16::from_le_bytes))),
            Self::Utf8 => match marked(bytes) {
                Some(body) => wide(body),
                None => {
                    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
                    let text = |error: std::str::Utf8Error| {
                        let before = &bytes[..error.valid_up_to()];
                        Undecodable { line: line(before), reason: no_letter(bytes[before.len()], self) }
                    };
                    std::str::from_utf8(bytes).map(str::to_owned).map_err(text)
                }
            },
            // Of ISO 8859-1 these are control characters, which no table has.
            Self::Latin1 => self.single(bytes, &['\0'; 32]),
            Self::Windows1252 => self.single(bytes, &WINDOWS),
        }
    }

    /// The text of an encoding in which a byte is the letter of its number, but for `middle` at 0x80 to 0x9F.
    fn single(self, bytes: &[u8], middle: &[char; 32]) -> Result<String, Undecodable> {
        let letter = |(place, &byte): (usize, &u8)| {
            let found = if (0x80..=0x9F).contains(&byte) { middle[usize::from(byte - 0x80)] } else { char::from(byte) };
            let missing = || Undecodable { line: line(&bytes[..place]), reason: no_letter(byte, self) };
            if found == '\0' { Err(missing()) } else { Ok(found) }
        };
        bytes.iter().enumerate().map(letter).collect()
    }
}

/// How the two bytes of a unit are joined.
type Join = fn([u8; 2]) -> u16;

/// What is behind the byte order mark of UTF-16, and how its bytes are joined; `None` where there is none.
fn marked(bytes: &[u8]) -> Option<(&[u8], Join)> {
    match bytes {
        [0xFF, 0xFE, body @ ..] => Some((body, u16::from_le_bytes)),
        [0xFE, 0xFF, body @ ..] => Some((body, u16::from_be_bytes)),
        _ => None,
    }
}

/// Units of UTF-16; half a unit at the end is half of a letter.
fn units(body: &[u8], join: Join) -> impl Iterator<Item = u16> {
    body.chunks(2).map(move |pair| if let [first, second] = pair { join([*first, *second]) } else { 0xD800 })
}

/// The text of a file that begins with the byte order mark of UTF-16, with a mark of replacement for what is no letter; `None`
/// where it begins otherwise.
pub fn utf16_lossy(bytes: &[u8]) -> Option<String> {
    let (body, join) = marked(bytes)?;
    Some(char::decode_utf16(units(body, join)).map(|unit| unit.unwrap_or(char::REPLACEMENT_CHARACTER)).collect())
}

fn wide((body, join): (&[u8], Join)) -> Result<String, Undecodable> {
    let mut text = String::with_capacity(body.len() / 2);
    for unit in char::decode_utf16(units(body, join)) {
        match unit {
            Ok(letter) => text.push(letter),
            Err(half) => {
                let reason = format!("0x{:04X} is half of a letter of UTF-16", half.unpaired_surrogate());
                return Err(Undecodable { line: line(text.as_bytes()), reason });
            }
        }
    }
    Ok(text)
}

/// Line in which the text after this begins, from 1.
fn line(before: &[u8]) -> u64 {
    1 + before.iter().filter(|byte| **byte == b'\n').count() as u64
}

fn no_letter(byte: u8, encoding: Encoding) -> String {
    format!("the byte 0x{byte:02X} is no letter of {}", encoding.word())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_text_comes_out_of_every_encoding() {
        let text = "id;Teil\nO1;Gehäuse Größe ½";
        let latin: Vec<u8> = text.chars().map(|letter| letter as u8).collect();
        assert_eq!(Encoding::Latin1.decode(&latin).as_deref(), Ok(text));
        assert_eq!(Encoding::Windows1252.decode(&latin).as_deref(), Ok(text));
        assert_eq!(Encoding::Windows1252.decode(b"5 \x80 \x96").as_deref(), Ok("5 € –"));
        assert_eq!(Encoding::Utf8.decode(text.as_bytes()).as_deref(), Ok(text));
        assert_eq!(Encoding::Utf8.decode(format!("\u{feff}{text}").as_bytes()).as_deref(), Ok(text));
        let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = [0xFE, 0xFF].into_iter().chain(text.encode_utf16().flat_map(u16::to_be_bytes)).collect();
        assert_eq!(Encoding::Utf16.decode(&little).as_deref(), Ok(text));
        for encoding in [Encoding::Utf8, Encoding::Utf16] {
            assert_eq!(encoding.decode(&big).as_deref(), Ok(text));
        }
    }

    #[test]
    fn bytes_that_are_no_letters_are_told_with_their_line() {
        let refused = |encoding: Encoding, bytes: &[u8]| {
            let fault = encoding.decode(bytes).unwrap_err();
            (fault.line, fault.reason)
        };
        assert_eq!(refused(Encoding::Utf8, b"a\nb\nM\xFCller").0, 3);
        assert!(refused(Encoding::Utf8, b"M\xFCller").1.contains("0xFC is no letter of utf-8"));
        assert_eq!(refused(Encoding::Latin1, b"a\n5 \x80").0, 2);
        assert_eq!(refused(Encoding::Windows1252, b"a\n5 \x81").0, 2);
        assert_eq!(refused(Encoding::Utf16, b"a\0\n\0\x00\xD8b\0").0, 2);
        assert_eq!(refused(Encoding::Utf16, b"a\0b").0, 1);
    }
}
