use super::*;
use crate::fixture;
use crate::study::study_with;
use std::collections::BTreeMap;
use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

/// All files of a study on so many threads, without `run.json`.
fn files(threads: usize, format: Format) -> BTreeMap<String, Vec<u8>> {
    // Tests of one process run side by side.
    static FOLDERS: AtomicUsize = AtomicUsize::new(0);
    let number = FOLDERS.fetch_add(1, Ordering::Relaxed);
    let directory = std::env::temp_dir().join(format!("toolroom-results-{}-{number}", std::process::id()));
    fs::create_dir_all(&directory).expect("a folder");
    let scenario = fixture::scenario();
    let options = StudyOptions { replications: 22, threads, logged: 6, ..StudyOptions::of(&scenario) };
    let simulate = |policy: usize, replication: u32| {
        let mut log = fixture::log();
        log.digest = 1 + u64::from(replication);
        log.jobs[0].finish += f64::from(replication * replication) + policy as f64;
        // Late replications first: whatever depends on the order of finishing shows.
        std::thread::sleep(Duration::from_millis(u64::from(3 - replication % 4)));
        Ok(log)
    };
    let mut logs = LogWriter::create(&directory, &scenario, format).expect("files");
    let stop = AtomicBool::new(false);
    let study = study_with(&scenario, &options, Some(&mut logs), &|_| {}, &stop, &simulate).expect("a study");
    logs.finish().expect("a footer");
    let comparison = Comparison::new(&scenario, &study);
    write_files(&directory, &scenario, &study, &comparison, &RunInfo::default()).expect("files");
    let read = |entry: io::Result<fs::DirEntry>| {
        let entry = entry.expect("an entry");
        (entry.file_name().into_string().expect("a name"), fs::read(entry.path()).expect("a file"))
    };
    let files = fs::read_dir(&directory).expect("a folder").map(read).collect();
    fs::remove_dir_all(&directory).expect("a folder to remove");
    files
}

#[test]
fn one_and_two_threads_write_the_same_bytes() {
    for format in [Format::Parquet, Format::Csv] {
        let (one, two) = (files(1, format), files(2, format));
        assert_eq!(one.keys().collect::<Vec<_>>(), two.keys().collect::<Vec<_>>());
        assert_eq!(one.len(), 12);
        for (name, bytes) in one {
            assert!(bytes == two[&name], "{name} differs");
            assert!(!bytes.is_empty(), "{name} is empty");
        }
    }
}

#[test]
fn kpi_rows_name_policy_replication_machine_and_unit() {
    let files = files(2, Format::Csv);
    let mut csv = csv::Reader::from_reader(files["kpi.csv"].as_slice());
    let rows: Vec<csv::StringRecord> = csv.records().map(|row| row.expect("a row")).collect();
    let per_run = crate::kpi::kpis(&fixture::scenario()).len();
    assert_eq!(rows.len(), 2 * 22 * per_run);
    let lead =
        rows.iter().find(|row| &row[0] == "adaptive" && &row[1] == "3" && &row[3] == "lead_time").expect("a row");
    assert_eq!((&lead[2], &lead[4]), ("", "min"));
    assert!((lead[5].parse::<f64>().expect("a number") - (540.0 + 9.0 + 1.0) / 60.0).abs() < 1e-12);
    assert!(rows.iter().any(|row| &row[2] == "G1" && &row[3] == "load"));
    assert!(rows.iter().any(|row| &row[3] == "cost_per_part" && &row[4] == "EUR"));
}

#[test]
fn only_the_logged_replications_are_in_the_tables() {
    let files = files(2, Format::Csv);
    let mut csv = csv::Reader::from_reader(files["jobs.csv"].as_slice());
    let replications: Vec<u32> = csv.records().map(|row| row.expect("a row")[1].parse().expect("a number")).collect();
    assert_eq!(replications.len(), 6 * 2 * 2);
    assert!(replications.is_sorted() && replications.last() == Some(&5));
}

#[test]
fn run_json_tells_how_the_study_was_made() {
    let scenario = fixture::scenario();
    let options = StudyOptions { replications: 2, ..StudyOptions::of(&scenario) };
    let simulate = |_, _| Ok(fixture::log());
    let study = study_with(&scenario, &options, None, &|_| {}, &AtomicBool::new(false), &simulate).expect("a study");
    let info = RunInfo {
        version: "0.1.0".to_owned(),
        command: "toolroom compare a.toml --threads 2".to_owned(),
        inputs: vec![("a.toml".to_owned(), toolroom_shards::fingerprint(b"text"))],
        ..RunInfo::default()
    };
    let json = run_json(&scenario, &study, &info, 2, Duration::from_millis(1500));
    assert_eq!((&json["threads"], &json["wall_time [s]"], &json["complete"]), (&json!(2), &json!(1.5), &json!(true)));
    assert_eq!(json["inputs"][0]["hash"], json!(toolroom_shards::fingerprint(b"text")));
    assert_eq!(json["policies"], json!(["constant", "adaptive"]));
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let scenario = fixture::scenario();
    let stop = AtomicBool::new(false);
    let options = StudyOptions::of(&scenario);
    let missing = Path::new("/nonexistent/toolroom");
    let error = record(missing, &scenario, &options, Some(Format::Csv), &RunInfo::default(), &|_| {}, &stop);
    assert_eq!(error.err().and_then(|error| error.path().map(Path::to_owned)), Some(missing.join("operations.csv")));
}
