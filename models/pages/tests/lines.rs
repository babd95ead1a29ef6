//! How lines end, and which encodings are no text of a program.

use std::path::{Path, PathBuf};
use toolroom_pages::Source;

/// A file of a test.
fn place(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("pages-{name}.nc"))
}

/// The lines of a text with their numbers, from memory and from a file.
fn lines(text: &str) -> Vec<(usize, String)> {
    let path = place("lines");
    std::fs::write(&path, text).expect("written");
    let [memory, file] = [Source::from(text), Source::open(&path).expect("opened")].map(|source| {
        let (mut lines, mut found) = (source.lines(), Vec::new());
        while let Some((number, line)) = lines.next().expect("read") {
            found.push((number, line.into_owned()));
        }
        found
    });
    assert_eq!(memory, file, "{text:?}");
    memory
}

#[test]
fn lines_end_as_controls_end_them() {
    let two = vec![(1, "G21".to_owned()), (2, "X1".to_owned())];
    for text in ["G21\nX1", "G21\r\nX1\r\n", "G21\rX1\r", "G21\rX1"] {
        assert_eq!(lines(text), two, "{text:?}");
    }
    // A carriage return within a text of line feeds is a sign of its line.
    assert_eq!(lines("G21\rX1\n"), [(1, "G21\rX1".to_owned())]);
}

#[test]
fn utf_16_is_named_and_a_tape_of_zeros_is_none() {
    let path = place("utf-16");
    let open = |bytes: &[u8]| {
        std::fs::write(&path, bytes).expect("written");
        Source::open(&path)
    };
    let wide: Vec<u8> = "G21 X1".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let marked: Vec<u8> = [0xfe, 0xff].into_iter().chain("G21 X1".encode_utf16().flat_map(u16::to_be_bytes)).collect();
    for bytes in [wide, marked] {
        assert!(open(&bytes).expect_err("refused").to_string().contains("UTF-16"));
    }
    let picture = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x03\x20\0\0\x02\x58\x08\x02\0\0\0\x15\x14\x15\x27";
    let archive = b"PK\x03\x04\x14\0\0\0\x08\0\x21\x5a\x9c\x4d\x07\0\0\0\x05\0\0\0\x05\0\0\0\x61.txt";
    for bytes in [&picture[..], archive] {
        assert!(open(bytes).expect_err("refused").to_string().contains("no text"));
    }
    // Feed holes, marks of a tape, comments of another code page and in Cyrillic letters are programs.
    assert!(open(b"\0\0\0\0\0\0G21\nX1\n").is_ok());
    assert!(open(b"\x12%\nG21 (R\xfcckzug \x84alt\x94)\nX1\n%\x14\0\0").is_ok());
    assert!(open("G21 (обработка контура)\nX1\n".as_bytes()).is_ok());
    assert!(open(b"").is_ok());
}
