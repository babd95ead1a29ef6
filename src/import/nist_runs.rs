//! `toolroom import nist-runs`.

use crate::args::NistRunsArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use std::fs;
use std::time::Instant;
use toolroom_output::provenance;
use toolroom_records::mtconnect::run_table;
use toolroom_records::{ReadReport, RecordKind};

pub fn run(args: &NistRunsArgs, voice: &Voice) -> Result<(), Failure> {
    let began = Instant::now();
    let name = args.file.display().to_string();
    let dir = super::create(&args.out, RecordKind::Program, &[&args.file], voice)?;
    let bytes = fs::read(&args.file).map_err(Failure::unread(&args.file))?;
    let (records, passed) = run_table(&bytes, args.machine.as_deref(), args.program.as_deref())
        .map_err(|error| Failure::of_file(&args.file, error, "give the table of runs of the NIST test bed"))?;
    let columns = ["machine", "day", "prog", "act", "nom", "tc"].map(str::to_owned).to_vec();
    let unused = ["hour", "hold", "nhold"].map(str::to_owned).to_vec();
    let mut report = ReadReport { file: name.clone(), rows: records.len(), columns, unused, ..ReadReport::default() };
    if passed > 0 {
        report.notes.push(format!("{passed} runs in another mode, of an unknown program or without time left out"));
    }
    let machine = args.machine.iter().flat_map(|name| ["--machine".to_owned(), name.clone()]);
    let program = args.program.iter().flat_map(|name| ["--program".to_owned(), name.clone()]);
    let provenance = provenance("import nist-runs", &[(name, &bytes)], machine.chain(program), None);
    super::write(&records, &report, dir, &provenance, began, voice)
}
