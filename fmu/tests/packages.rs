//! Packages are the same bytes every time.

#![cfg(target_os = "linux")]

use std::path::{Path, PathBuf};
use toolroom_fmu::{Binary, Platform, Sources, Version, package, units};

#[test]
fn a_package_is_the_same_bytes_every_time_and_holds_what_it_should() {
    let test = std::env::current_exe().expect("a path");
    let library = std::fs::read(test.with_file_name("libtoolroom_fmu.so")).expect("the library");
    let binaries = [Binary { platform: Platform::X86Linux, library }];
    for unit in units() {
        for version in [Version::Two, Version::Three] {
            let bytes = package(unit, version, &binaries, &[]).expect("a package");
            assert!(bytes == package(unit, version, &binaries, &[]).expect("a package"), "{} twice", unit.name);
            let mut zip = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("a zip file");
            let names: Vec<String> = (0..zip.len())
                .map(|i| zip.by_index(i).expect("an entry").name().expect("a name").into_owned())
                .collect();
            assert_eq!(names[0], "modelDescription.xml");
            for part in
                ["binaries/", "documentation/index.html", "documentation/licenses/", "resources/tools/", "_out.csv"]
            {
                assert!(names.iter().any(|name| name.contains(part)), "{} lacks {part}: {names:?}", unit.name);
            }
            let page = std::io::read_to_string(zip.by_name("documentation/index.html").expect("a page")).expect("text");
            for variable in &unit.describe().variables {
                assert!(page.contains(&format!("<code>{}</code>", variable.name)), "{}", variable.name);
            }
        }
    }
}

#[test]
fn libraries_that_are_given_make_a_package_for_their_platforms() {
    let folder = std::env::temp_dir().join(format!("toolroom-packages-{}", std::process::id()));
    let put = |platform: &str, name: &str, bytes: &[u8]| {
        std::fs::create_dir_all(folder.join(platform)).expect("writable");
        std::fs::write(folder.join(platform).join(name), bytes).expect("writable");
    };
    let mut arm = vec![0; 64];
    arm[..6].copy_from_slice(b"\x7fELF\x02\x01");
    arm[18] = 183;
    put("aarch64-linux", "libtoolroom_fmu.so", &arm);
    put("darwin", "libtoolroom_fmu.dylib", &[0xca, 0xfe, 0xba, 0xbe, 0, 0, 0, 2]);
    let sources = Sources { folder: Some(&folder), own: &|_| panic!("the folder has them"), say: &|_| () };
    let binaries = sources.libraries(&[]).expect("two libraries");
    let unit = units().next().expect("a unit");
    for (version, expected) in [
        (
            Version::Two,
            [
                "aarch64-linux/toolroom_turning.so",
                "darwin64/toolroom_turning.dylib",
                "aarch64-darwin/toolroom_turning.dylib",
            ],
        ),
        (
            Version::Three,
            [
                "aarch64-linux/toolroom_turning.so",
                "x86_64-darwin/toolroom_turning.dylib",
                "aarch64-darwin/toolroom_turning.dylib",
            ],
        ),
    ] {
        let bytes = package(unit, version, &binaries, &[]).expect("a package");
        let mut zip = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("a zip file");
        let names: Vec<String> = (0..zip.len())
            .map(|i| zip.by_index(i).expect("an entry").name().expect("a name").into_owned())
            .filter_map(|name| name.strip_prefix("binaries/").map(str::to_owned))
            .collect();
        assert_eq!(names, expected);
    }
    std::fs::remove_dir_all(&folder).expect("removable");
}

/// Files below `folder` that end with `ending`.
fn files(folder: &Path, ending: &str, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        if entry.is_dir() && !entry.ends_with("target") {
            files(&entry, ending, found);
        } else if entry.extension().is_some_and(|extension| extension == ending) {
            found.push(entry);
        }
    }
}

#[test]
fn every_claim_of_the_documents_names_a_test_that_is_there_or_says_that_it_is_described_only() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut sources = Vec::new();
    for folder in ["fmu", "models/infeed", "tests"] {
        files(&root.join(folder), "rs", &mut sources);
    }
    let code: String = sources.iter().map(|path| std::fs::read_to_string(path).expect("text")).collect();
    let page = std::fs::read_to_string(root.join("docs/fmu-claims.md")).expect("the page");
    let rows: Vec<&str> =
        page.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| claim |")).collect();
    assert!(rows.len() > 50, "{} rows", rows.len());
    let matrix = std::fs::read_to_string(root.join("fmu/conformance/matrix.py")).expect("the matrix");
    for row in rows {
        let held = row.trim_end_matches(" |").rsplit_once(" | ").map_or("", |(_, held)| held);
        let known = |part: &str| match part.trim_matches(['`', ' ']) {
            name if name.contains('/') => root.join(name).is_file(),
            name if name.contains('_') => {
                code.contains(&format!("fn {name}()")) || code.contains(&format!("fn {name}(\n"))
            }
            name if name.starts_with('T') => {
                matrix.contains(&format!("\"{}\"", name.split(' ').next().unwrap_or(name)))
            }
            name => name == "by hand" || name.starts_with("described only"),
        };
        let (tried, _) = held.split_once(';').unwrap_or((held, ""));
        let parts: Vec<&str> =
            if tried.starts_with("described only") { vec![tried] } else { tried.split(", ").collect() };
        for part in parts {
            assert!(known(part), "{part:?} is not there: {row}");
        }
    }
}
