//! From bytes to text: byte order marks and encodings.

use crate::ReadError;
use toolroom_process::parameters::place;

/// Decodes a file: UTF-8, with or without byte order mark.
///
/// # Errors
/// [`ReadError::Utf16`], or [`ReadError::NotUtf8`] with line, column and the likely encoding.
pub(crate) fn decode(file: &str, bytes: &[u8]) -> Result<String, ReadError> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    if matches!(bytes, [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..]) || looks_like_utf16(bytes) {
        return Err(ReadError::Utf16 { file: file.to_owned() });
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.to_owned()),
        Err(error) => {
            let valid = String::from_utf8_lossy(&bytes[..error.valid_up_to()]);
            let (line, column) = place(&valid, valid.len());
            let byte = bytes[error.valid_up_to()];
            Err(ReadError::NotUtf8 { file: file.to_owned(), line, column, byte, likely: likely_encoding(bytes) })
        }
    }
}

/// Every second byte of the beginning zero: UTF-16 without byte order mark.
fn looks_like_utf16(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(64)];
    let zeros = |offset: usize| head.iter().skip(offset).step_by(2).filter(|byte| **byte == 0).count();
    head.len() >= 8 && (zeros(0) > head.len() / 3) != (zeros(1) > head.len() / 3)
}

/// Cyrillic letters take 0xC0 to 0xFF in Windows-1251 and come in runs (words); in Windows-1252
/// the accented letters there stand alone between Latin ones.
fn likely_encoding(bytes: &[u8]) -> &'static str {
    let high = |byte: &u8| *byte >= 0xC0;
    let runs = bytes.windows(2).filter(|pair| pair.iter().all(high)).count();
    let all = bytes.iter().filter(|byte| high(byte)).count();
    if 2 * runs > all { "Windows-1251" } else { "Windows-1252 or Latin-1" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_order_mark_is_dropped() {
        assert_eq!(decode("f", b"\xEF\xBB\xBFschema = 1").ok().as_deref(), Some("schema = 1"));
    }

    #[test]
    fn utf16_is_named_with_and_without_mark() {
        let text: Vec<u8> = "schema = 1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert!(matches!(decode("f", &text), Err(ReadError::Utf16 { .. })));
        let marked: Vec<u8> =
            [0xFE, 0xFF].into_iter().chain("schema".encode_utf16().flat_map(u16::to_be_bytes)).collect();
        assert!(matches!(decode("f", &marked), Err(ReadError::Utf16 { .. })));
    }

    #[test]
    fn cp1251_is_named_with_its_place() {
        // "title = "Цех"" in Windows-1251.
        let bytes = b"schema = 1\ntitle = \"\xD6\xE5\xF5\"";
        let error = decode("f", bytes);
        assert!(
            matches!(error, Err(ReadError::NotUtf8 { line: 2, column: 10, likely: "Windows-1251", .. })),
            "{error:?}"
        );
    }
}
