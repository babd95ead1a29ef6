//! `toolroom explain CODE`.

use crate::args::ExplainArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use toolroom_form::CODES;
use toolroom_gap::program;
use toolroom_scenario_file as file;

/// Every code with its text.
pub fn codes() -> impl Iterator<Item = (&'static str, &'static str)> {
    [
        CODES,
        file::CODES,
        program::CODES,
        toolroom_effects::CODES,
        toolroom_kinds::CODES,
        toolroom_planning::CODES,
        toolroom_drives::CODES,
        toolroom_dynamics::REFUSAL_CODES,
        toolroom_output::codes::CODES,
        toolroom_shop::CODES,
        toolroom_shop_import::CODES,
        toolroom_snapshot::CODES,
        toolroom_watch::CODES,
    ]
    .into_iter()
    .flatten()
    .copied()
}

pub fn run(args: &ExplainArgs, voice: &Voice) -> Result<(), Failure> {
    let wanted: Vec<(&str, &str)> = match &args.code {
        None => codes().collect(),
        Some(code) => {
            let (_, text) = codes().find(|(known, _)| known == code).ok_or_else(|| {
                let known = codes().map(|(code, _)| code).collect::<Vec<_>>().join(", ");
                Failure::argument(format_args!("there is no error code `{code}`"), format_args!("codes: {known}"))
            })?;
            vec![(code, text)]
        }
    };
    if voice.json {
        let codes: Vec<_> = wanted.iter().map(|(code, text)| json!({ "code": code, "explanation": text })).collect();
        return voice.json(&json!({ "schema": 1, "codes": codes }));
    }
    let texts: Vec<String> = wanted.iter().map(|(code, text)| format!("{code}\n  {text}")).collect();
    voice.data(texts.join("\n\n"))
}
