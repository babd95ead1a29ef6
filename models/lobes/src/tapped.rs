//! Modes of a structure file that names measured responses in their place.

use std::path::Path;
use toolroom_dynamics::{
    DynamicsError, FitOptions, Scatter, StructureText, TapOptions, fit, measure, measure_by_speed,
};

/// The text of the structure file that `toolroom modes` would write of the responses in a file, with the scatter that it assumes;
/// or why there is none.
pub(super) fn structure(name: &str, path: &Path) -> Result<String, String> {
    let file = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| format!("{file}: {error}"))?;
    let words = |error: DynamicsError| error.to_string();
    if measure_by_speed(&file, &bytes).map_err(words)?.is_some() {
        return Err(format!(
            "{file} holds responses at several spindle speeds: write their modes with `toolroom modes`, and name the table \
             beside [[speed]]"
        ));
    }
    let measured = measure(&file, &bytes, &TapOptions::default()).map_err(words)?;
    let fit = fit(&measured, &FitOptions::default()).map_err(words)?;
    if let Some(refusal) = fit.quality.refusals.first() {
        return Err(format!("{file}: refused ({}): {refusal}; {}", refusal.code(), refusal.fix()));
    }
    Ok(StructureText { name, fit: &fit, source: &file, scatter: Scatter::ASSUMED }.to_string())
}
