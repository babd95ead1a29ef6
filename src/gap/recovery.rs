//! `toolroom gap recovery`: whether what simulated shops hide is found again.

use crate::args::RecoveryArgs;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::speak::Voice;
use serde_json::json;
use std::path::Path;
use toolroom_gap_study::{RecoveredLog, RecoveryRate, RecoveryRequest, rates, rates_table, recovery};
use toolroom_output::Files;
use toolroom_study::study::Progress;

pub fn run(args: &RecoveryArgs, voice: &Voice) -> Result<(), Failure> {
    let inputs = std::iter::once(&args.model).chain(&args.truth).map(AsRef::as_ref);
    let files = Files::new(inputs, voice.force);
    let path = args.out.join("recovery.json");
    files.check(&path)?;
    let request = RecoveryRequest {
        model: &args.model,
        truth: args.truth.as_deref(),
        set: &args.set,
        seed: args.seed,
        logs: args.logs,
        fresh: args.fresh,
        figures: args.figures,
        folder: &args.out,
    };
    let bar = Bar::new(voice);
    let put = |path: &Path, bytes: &[u8]| files.put(path, bytes).map_err(Failure::from);
    let found = recovery(&request, &put, &|done, total| bar.at(Progress { done, total }));
    bar.finish();
    let (hidden, logs) = found?;
    let entry = |hidden: &toolroom_gap_study::HiddenEntry| json!({ "id": hidden.id.word(), "scope": hidden.scope.words(), "size": hidden.size, "unit": hidden.unit });
    let document = json!({
        "schema": 1, "model": args.model.display().to_string(),
        "truth": args.truth.as_ref().map(|path| path.display().to_string()), "set": args.set, "seed": args.seed,
        "hidden": hidden.iter().map(entry).collect::<Vec<_>>(),
        "rates": rates(&hidden, &logs).iter().map(RecoveryRate::json).collect::<Vec<_>>(),
        "logs": logs.iter().map(RecoveredLog::json).collect::<Vec<_>>(),
    });
    files.put(&path, format!("{document:#}\n").as_bytes())?;
    if voice.json { voice.json(&document) } else { voice.data(rates_table(&hidden, &logs)) }
}
