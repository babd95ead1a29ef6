//! A tool on a spindle whose modes are known: the modes at the tip of the tool, by receptance coupling.

use super::swap_error::SwapError;
use super::tip::Tip;
use super::tool::Tool;
use toolroom_dynamics::{BaseMode, Direction, Frf, Measurement, Motion};
use toolroom_lobes::Structure;

/// Step of the frequencies (Hz) at which the tip is computed: a half-power band of 1 % damping at 250 Hz has five lines.
const STEP: f64 = 1.0;

/// Receptance at the tip of `tool` on the spindle `spindle` from `range[0]` to `range[1]` (Hz), with the line along which
/// the modes of the spindle move.
///
/// # Errors
/// [`SwapError`]: modes without slope, along different lines or by speed, an undamped tool at a frequency of its own.
pub fn tip(spindle: &Structure, tool: &Tool, range: [f64; 2]) -> Result<(Measurement, [f64; 2]), SwapError> {
    let [x, y] = spindle.modes.first().map_or([1.0, 0.0], |mode| mode.direction);
    let modes = based(spindle, [x, y])?;
    let lines = ((range[1] - range[0]) / STEP).floor() as usize;
    let frequencies: Vec<f64> = (0..=lines).map(|i| range[0] + STEP * i as f64).collect();
    let receptance = Tip::of_modes(&modes, tool, frequencies.clone())?.all(tool.joint.as_ref())?;
    let function = Frf {
        response: Direction::X,
        force: Direction::X,
        motion: Motion::Displacement,
        receptance,
        coherence: None,
        noise: None,
    };
    let measured = Measurement {
        source: format!("{} on {}", tool.name, spindle.name),
        frequencies,
        functions: vec![function],
        averages: None,
        coherence_digit: 0.0,
        window_decay: 0.0,
        notes: Vec::new(),
    };
    let length = x.hypot(y);
    Ok((measured, [x / length, y / length]))
}

/// The tip of `tool` on the spindle `spindle` at some frequencies (Hz), ascending.
///
/// # Errors
/// As [`tip`].
pub fn tip_at(spindle: &Structure, tool: &Tool, frequencies: Vec<f64>) -> Result<Tip, SwapError> {
    let line = spindle.modes.first().map_or([1.0, 0.0], |mode| mode.direction);
    Tip::of_modes(&based(spindle, line)?, tool, frequencies)
}

/// The modes of a spindle with their slopes, which move along the line of the first.
fn based(spindle: &Structure, [x, y]: [f64; 2]) -> Result<Vec<BaseMode>, SwapError> {
    if spindle.by_speed.is_some() {
        return Err(SwapError::Speeds);
    }
    if spindle.along_path.is_some() {
        return Err(SwapError::Stations);
    }
    let mut modes = Vec::new();
    // The stiff modes of a residual have no slope, and follow those of the file.
    for (i, (mode, rotation)) in spindle.modes.iter().zip(&spindle.rotations).enumerate() {
        let rotation = rotation.ok_or(SwapError::NoRotation { mode: i + 1 })?;
        let [a, b] = mode.direction;
        if (a * y - b * x).abs() > 1e-6 * a.hypot(b) * x.hypot(y) {
            return Err(SwapError::Directions { mode: i + 1 });
        }
        let (natural_frequency, damping_ratio, stiffness) =
            (mode.natural_frequency, mode.damping_ratio, mode.stiffness);
        modes.push(BaseMode { natural_frequency, damping_ratio, stiffness, rotation });
    }
    Ok(modes)
}
