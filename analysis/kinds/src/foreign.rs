//! Files without keys: measurements, packages, logs and programs, each told by how it begins, with the verb that looks at it.

use std::path::Path;

/// One kind of such files.
struct Foreign {
    /// Whether a file with this name and these bytes is one.
    is: fn(&Path, &[u8]) -> bool,
    /// The verb that looks at it.
    reader: &'static str,
}

/// Kinds in the order in which they are tried; the last takes whatever is left.
const FOREIGN: &[Foreign] = &[
    Foreign {
        is: |_, bytes| first_line(bytes) == b"-1",
        reader: "universal files (58, 58b) are looked at by toolroom modes FILE --read",
    },
    Foreign {
        is: |_, bytes| bytes.starts_with(b"RIFF"),
        reader: "sound of a cut is looked at by toolroom listen FILE --teeth COUNT --speed SPEED, hits in a WAV file by toolroom \
                 modes FILE --scale force=… --read",
    },
    Foreign {
        is: |path, _| ends(path, &["fmu"]),
        reader: "units are looked at by toolroom fmu info FILE and toolroom fmu check FILE",
    },
    Foreign { is: |path, _| ends(path, &["ssp"]), reader: "packages of units are looked at by toolroom ssp info FILE" },
    Foreign {
        is: |_, bytes| bytes.starts_with(b"PK\x03\x04"),
        reader: "workbooks of an order system (XLSX, ODS) are looked at by toolroom import shop --map MAP --check; units end in \
                 .fmu, packages of units in .ssp",
    },
    Foreign { is: |path, _| ends(path, &["trs"]), reader: "a snapshot goes on by toolroom run --from FILE" },
    Foreign {
        is: |path, _| ends(path, &["dxf"]),
        reader: "drawings are looked at by toolroom contour FILE --dxf DRAWING; the first file is that of a contour or a setup",
    },
    Foreign {
        is: |path, bytes| ends(path, &["shdr"]) || first_line(bytes).iter().filter(|byte| **byte == b'|').count() > 1,
        reader: "logs of MTConnect adapters (time|key|value) are looked at by toolroom import mtconnect FILE --out DIR",
    },
    Foreign {
        is: |_, bytes| first_line(bytes).to_ascii_lowercase().windows(9).any(|word| word == b"frequency"),
        reader: "frequency responses are looked at by toolroom modes FILE --read",
    },
    Foreign {
        is: |path, _| ends(path, &["csv", "tsv", "txt"]),
        reader: "a measured table becomes records by a mapping: toolroom import csv FILE --map MAP; tables of an order system are \
                 looked at by toolroom import shop --map MAP --check; `toolroom schema records` lists the columns of records; hits \
                 over time are looked at by toolroom modes FILE --read; --kind names the kind of a file of keys",
    },
    Foreign {
        is: |_, _| true,
        reader: "part programs are looked at by toolroom program FILE; --kind names the kind of a file of keys",
    },
];

/// The verb that looks at a text that is no file of keys.
pub fn reader(path: &Path, bytes: &[u8]) -> &'static str {
    FOREIGN.iter().find(|kind| (kind.is)(path, bytes)).map_or("", |kind| kind.reader)
}

/// The verb that looks at bytes that are no text; `None` where the file may be a text in another encoding.
pub fn reader_of_bytes(path: &Path, bytes: &[u8]) -> Option<&'static str> {
    let (_, told) = FOREIGN.split_last()?;
    let text = ends(path, &["toml", "csv", "tsv", "txt"]);
    told.iter().find(|kind| !text && (kind.is)(path, bytes)).map(|kind| kind.reader)
}

/// Whether the name of a file ends so, in whatever case.
pub fn ends(path: &Path, endings: &[&str]) -> bool {
    path.extension().is_some_and(|own| endings.iter().any(|ending| own.eq_ignore_ascii_case(ending)))
}

/// The first line that is not empty, without spaces around it.
fn first_line(bytes: &[u8]) -> &[u8] {
    bytes.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii).find(|line| !line.is_empty()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use crate::FileKind;

    #[test]
    fn a_file_without_keys_is_sent_to_the_verb_that_looks_at_it() {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, bytes, verb) in [
            ("hits.uff", &b"    -1\n    58\nhits\n"[..], "modes FILE --read"),
            ("hits.unv", b"    -1\n    58b     1\n\x80\xFF\n    -1\n", "modes FILE --read"),
            ("cut.wav", b"RIFF\xA4\x01\0\0WAVEfmt ", "listen FILE"),
            ("turning.fmu", b"PK\x03\x04\xFF", "fmu check"),
            ("orders.xlsx", b"PK\x03\x04\xFF", "import shop"),
            ("plate.dxf", b"0\nSECTION\n", "contour FILE --dxf"),
            ("mill.shdr", b"2026-01-05T08:00:00Z|execution|ACTIVE\n", "import mtconnect"),
            ("tap.csv", b"frequency [Hz],real [um/N],imag [um/N]\n100,1,2\n", "modes FILE --read"),
            ("log.csv", b"Zeit;Spindel\n1,5;2\n", "import csv FILE --map"),
            ("plate.nc", b"%\nG1 X1\n", "program FILE"),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).expect("written");
            let fix = FileKind::from_path(&path).expect_err(name).fix();
            assert!(fix.contains(verb), "{name}: {fix}");
        }
        // A file of keys in another encoding is not a measurement.
        let path = folder.path().join("shop.toml");
        std::fs::write(&path, b"title = \"\xD6\xE5\xF5\"\n").expect("written");
        assert!(FileKind::from_path(&path).expect_err("refused").to_string().contains("Windows-1251"));
    }
}
