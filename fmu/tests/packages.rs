//! Packages are the same bytes every time.

#![cfg(target_os = "linux")]

use toolroom_fmu::{Binary, Platform, Version, package, units};

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
