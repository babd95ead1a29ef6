//! `toolroom import shop`: tables of an order system as a scenario.

use crate::args::ImportShopArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::path::Path;
use toolroom_kinds::FileKind;
use toolroom_output::Files;
use toolroom_shop_import::import_shop;

pub fn run(args: &ImportShopArgs, voice: &Voice) -> Result<(), Failure> {
    let imported = import_shop(&args.map, &args.out)?;
    let inputs = imported.inputs.iter().map(AsRef::as_ref).chain([args.map.as_path() as &Path]);
    let files = Files::new(inputs, voice.force);
    files.check(&args.out)?;
    files.put(&args.out, imported.text.as_bytes())?;
    let checked = match FileKind::named("scenario").and_then(|kind| kind.read).filter(|_| args.check) {
        Some(read) => Some(read(&args.out, &[])?),
        None => None,
    };
    let scenario = &imported.file.scenario;
    let written = args.out.display();
    if voice.json {
        let mut value = json!({
            "schema": 1,
            "written": written.to_string(),
            "tables": imported.notes,
            "orders": scenario.orders.len(),
            "parts": scenario.parts.len(),
            "machines": scenario.machines.len(),
            "operators": scenario.operators.len(),
        });
        for key in ["load", "warnings", "warning_codes"] {
            if let Some(found) = checked.as_ref().and_then(|checked| checked.result.get(key)) {
                value[key] = found.clone();
            }
        }
        return voice.json(&value);
    }
    for note in &imported.notes {
        voice.data(note)?;
    }
    if let Some(checked) = checked {
        voice.data(checked.summary)?;
    }
    voice.say(format_args!("wrote {written}   next: toolroom check {written}"));
    Ok(())
}
