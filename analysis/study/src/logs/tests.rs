use super::*;
use crate::fixture;
use toolroom_records::RawTable;

/// A directory of its own for each test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("toolroom-logs-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn write(folder: &Folder, format: Format) {
    let scenario = fixture::scenario();
    let mut writer = LogWriter::create(&folder.0, &scenario, format).expect("files");
    for replication in 0..2 {
        for policy in 0..2 {
            writer.write(policy, replication, &fixture::log()).expect("rows");
        }
    }
    writer.finish().expect("a footer");
}

fn read(folder: &Folder, table: &str) -> RawTable {
    toolroom_parquet::read_cells(&folder.0.join(table).with_extension("parquet")).expect("a frame")
}

/// Cells of a column.
fn column<'a>(table: &'a RawTable, header: &str) -> Vec<&'a str> {
    let index = table.header.iter().position(|each| each == header).expect("a column");
    table.rows.iter().map(|(_, cells)| cells[index].as_str()).collect()
}

fn empty(cells: &[&str]) -> usize {
    cells.iter().filter(|cell| cell.is_empty()).count()
}

#[test]
fn parquet_is_read_back_in_display_units() {
    let folder = Folder::new("parquet");
    write(&folder, Format::Parquet);
    let operations = read(&folder, "operations");
    assert_eq!(operations.rows.len(), 4 * 4);
    let speed = column(&operations, "cutting_speed_start [m/min]");
    assert_eq!((speed[0].parse(), speed[2]), (Ok(30.0), ""), "a wheel has no cutting speed");
    let feed: f64 = column(&operations, "feed [mm]")[0].parse().expect("a feed");
    assert!((feed - 0.1).abs() < 1e-15);
    assert_eq!(empty(&column(&operations, "flank_wear_estimate [mm]")), 16, "not a number is null");
    let operation = column(&operations, "operation");
    assert_eq!((operation[0], operation[2]), ("turn", "grind"));
    let policy = column(&operations, "policy");
    assert_eq!((policy[3], policy[4]), ("constant", "adaptive"));
    assert_eq!(column(&read(&folder, "tools"), "edge")[..4], ["0", "1", "2", "0"]);
    assert_eq!(read(&folder, "states").rows.len(), 4 * fixture::log().states.len());
    assert_eq!(empty(&column(&read(&folder, "events"), "job")), 4);
}

#[test]
fn both_formats_have_the_same_columns_and_cells() {
    let folder = Folder::new("both");
    write(&folder, Format::Parquet);
    write(&folder, Format::Csv);
    for table in ["operations", "tools", "jobs", "states", "events"] {
        let frame = read(&folder, table);
        let mut csv = csv::Reader::from_path(folder.0.join(table).with_extension("csv")).expect("a file");
        let header: Vec<String> = csv.headers().expect("a header").iter().map(str::to_owned).collect();
        assert_eq!(frame.header, header, "{table}");
        let records: Vec<Vec<String>> =
            csv.records().map(|record| record.expect("a record").iter().map(str::to_owned).collect()).collect();
        let rows: Vec<Vec<String>> = frame.rows.into_iter().map(|(_, cells)| cells).collect();
        assert_eq!(rows, records, "{table}");
    }
}

#[test]
fn the_same_runs_give_the_same_bytes() {
    let (first, second) = (Folder::new("first"), Folder::new("second"));
    write(&first, Format::Parquet);
    write(&second, Format::Parquet);
    for table in ["operations", "tools", "jobs", "states", "events"] {
        let bytes = |folder: &Folder| std::fs::read(folder.0.join(table).with_extension("parquet")).expect("a file");
        assert_eq!(bytes(&first), bytes(&second), "{table}");
    }
}

#[test]
fn every_column_has_a_unit_that_converts_and_a_name_of_its_own() {
    let log = fixture::log();
    let names = Names::of(&fixture::scenario());
    let headers: Vec<String> = columns::operations().iter().map(Column::header).collect();
    assert!(headers.iter().all(|name| headers.iter().filter(|other| *other == name).count() == 1));
    let row = Row { names: &names, policy: 0, replication: 0, index: 0, row: &log.passes[0] };
    // No observer, no structure and no wheel here: these are not defined.
    let defined =
        |column: &&Column<_>| !["estimate", "margin", "normal_force"].iter().any(|word| column.header().contains(word));
    for column in columns::operations().iter().filter(defined) {
        assert_ne!(column.value(&row), Value::Real(None), "{}", column.header());
    }
}

#[test]
fn an_unwritable_folder_is_named() {
    let missing = Path::new("/nonexistent/toolroom");
    match LogWriter::create(missing, &fixture::scenario(), Format::Csv) {
        Err(error) => assert!(error.to_string().contains("/nonexistent/toolroom/operations.csv"), "{error}"),
        Ok(_) => panic!("wrote into a folder that does not exist"),
    }
}

#[test]
fn rows_taken_over_give_the_bytes_of_rows_written() {
    let scenario = fixture::scenario();
    let mut long = fixture::log();
    // More rows than a row group of Parquet has.
    long.events = fixture::log().events.into_iter().cycle().take(70_000).collect();
    for format in [Format::Parquet, Format::Csv] {
        let folder = |name: &str| Folder::new(&format!("{name}-{}", format.extension()));
        let (whole, part, rest) = (folder("whole"), folder("part"), folder("rest"));
        let writer = |folder: &Folder| LogWriter::create(&folder.0, &scenario, format).expect("files");
        let (mut one, mut two, mut three) = (writer(&whole), writer(&part), writer(&rest));
        one.write(0, 0, &long).expect("rows");
        one.write(1, 0, &long).expect("rows");
        one.finish().expect("a footer");
        two.write(0, 0, &long).expect("rows");
        two.finish().expect("a footer");
        three.take_over(&part.0).expect("rows");
        three.write(1, 0, &long).expect("rows");
        three.finish().expect("a footer");
        for table in ["operations", "tools", "jobs", "states", "events"] {
            let bytes = |folder: &Folder| {
                std::fs::read(folder.0.join(table).with_extension(format.extension())).expect("a table")
            };
            assert!(bytes(&whole) == bytes(&rest), "{table}");
        }
        let mut lost = writer(&rest);
        let missing = lost.take_over(Path::new("/nonexistent"));
        assert!(matches!(missing, Err(LogError::Earlier { .. })));
    }
}
