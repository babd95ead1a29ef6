//! The examples of the library run, and name nothing but the library.

#[path = "../examples/compare.rs"]
mod compare;
#[path = "../examples/diagnose.rs"]
mod diagnose;
#[path = "../examples/export.rs"]
mod export;
#[path = "../examples/life.rs"]
mod life;
#[path = "../examples/point.rs"]
mod point;
#[path = "../examples/run.rs"]
mod run;

use std::fs;
use std::path::Path;

#[test]
fn every_example_runs() {
    run::main().expect("one replication");
    compare::main().expect("a comparison");
    life::main().expect("a fit");
    diagnose::main().expect("a diagnosis");
    point::main().expect("operating points");
    export::main().expect("a unit");
}

#[test]
fn examples_are_short_and_name_the_library_only() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let files: Vec<_> = fs::read_dir(folder)
        .expect("the examples")
        .map(|entry| entry.expect("a file").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect();
    assert_eq!(files.len(), 6);
    for file in files {
        let text = fs::read_to_string(&file).expect("text");
        assert!(text.lines().count() < 40, "{} is long", file.display());
        assert!(!text.contains("toolroom_"), "{} names a crate behind the library", file.display());
    }
}
