//! `toolroom validate`: published numbers beside computed ones.

use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::fmt::Write;
use toolroom_form::significant;
use toolroom_process::Claim;

pub fn run(voice: &Voice) -> Result<(), Failure> {
    let mut claims: Vec<(&str, Claim)> = Vec::new();
    let wear = toolroom_wear::claims().map_err(|error| Failure::Work { message: format!("wear: {error}") })?;
    claims.extend(wear.into_iter().map(|claim| ("wear", claim)));
    claims.extend(toolroom_cutting::milling::claims().into_iter().map(|claim| ("milling", claim)));
    let infeed = toolroom_infeed::claims().map_err(|error| Failure::Work { message: format!("infeed: {error}") })?;
    claims.extend(infeed.into_iter().map(|claim| ("infeed", claim)));
    let contour = toolroom_contour::claims().map_err(|error| Failure::Work { message: format!("contour: {error}") })?;
    claims.extend(contour.into_iter().map(|claim| ("contour", claim)));
    let life = toolroom_life::claims().map_err(|error| Failure::Work { message: format!("life: {error}") })?;
    claims.extend(life.into_iter().map(|claim| ("life", claim)));
    let shop = toolroom_shop::claims().map_err(|error| Failure::Work { message: format!("shop: {error}") })?;
    claims.extend(shop.into_iter().map(|claim| ("shop", claim)));
    let failed = claims.iter().filter(|(_, claim)| !claim.pass()).count();
    if voice.json {
        let rows: Vec<_> = claims
            .iter()
            .map(|(model, claim)| {
                json!({
                    "model": model,
                    "claim": claim.claim,
                    "source": claim.source,
                    "published": claim.published,
                    "computed": claim.computed,
                    "tolerance": claim.tolerance,
                    "pass": claim.pass(),
                })
            })
            .collect();
        voice.json(&rows)?;
    } else {
        voice.data(table(&claims))?;
    }
    voice.say(format_args!("{} of {} claims hold", claims.len() - failed, claims.len()));
    if failed == 0 { Ok(()) } else { Err(Failure::Work { message: format!("{failed} claims do not hold") }) }
}

fn table(claims: &[(&str, Claim)]) -> String {
    let mut text = format!("{:>12} {:>12} {:>9}  claim", "published", "computed", "within");
    let mut last = "";
    for (model, claim) in claims {
        if *model != last {
            let _ = write!(text, "\n{model}");
        }
        last = model;
        let within = if claim.published == 0.0 {
            significant(claim.tolerance)
        } else {
            format!("{} %", significant(100.0 * claim.tolerance))
        };
        let mark = if claim.pass() { "" } else { "   DOES NOT HOLD" };
        let _ = write!(
            text,
            "\n{:>12} {:>12} {within:>9}  {}{mark}\n{:37}{}",
            significant(claim.published),
            significant(claim.computed),
            claim.claim,
            "",
            claim.source,
        );
    }
    text
}
