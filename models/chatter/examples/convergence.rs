//! Prints how the methods of the spectral radius converge, the table of docs/chatter.md:
//! `cargo run --release -p toolroom-chatter --example convergence`.

use std::f64::consts::TAU;
use std::io::Write;
use toolroom_chatter::discretised::{Discretisation, collocated_radius, spectral_radius};
use toolroom_chatter::{ChatterError, Cutter, Direction, Engagement, Milling, MillingForce, Mode};

/// Nodes of the collocation.
pub const NODES: [usize; 7] = [20, 24, 28, 32, 36, 40, 48];
/// Steps of the discretisations.
pub const STEPS: [usize; 6] = [20, 40, 80, 160, 320, 640];

/// Relative errors of the spectral radius of the standard slot against the collocation with 60
/// nodes.
pub struct Convergence {
    /// For [`NODES`].
    pub collocation: Vec<f64>,
    /// For [`STEPS`].
    pub semi: Vec<f64>,
    /// For [`STEPS`].
    pub full: Vec<f64>,
}

/// The standard slot: two teeth, one mode of 922 Hz along the feed, 5000 rpm, 0.5 mm.
pub fn convergence() -> Result<Convergence, ChatterError> {
    let slot = Milling {
        modes: vec![Mode::from_mass([1.0, 0.0], 922.0, 0.011, 0.03993)],
        cutter: Cutter::straight(2, 0.02),
        engagement: Engagement::new(1.0, Direction::Down)?,
        force: MillingForce::new(6e8, 2e8),
        feed_per_tooth: 0.1e-3,
        by_speed: None,
        along_path: None,
    };
    let (speed, depth) = (5000.0 / 60.0 * TAU, 0.5e-3);
    let truth = collocated_radius(&slot, speed, depth, 60)?;
    let error = |radius: f64| (radius / truth - 1.0).abs();
    let collocated = |nodes: &usize| collocated_radius(&slot, speed, depth, *nodes).map(error);
    let discretised = |method| {
        let radius = |steps: &usize| spectral_radius(&slot, speed, depth, *steps, method);
        STEPS.iter().map(|steps| radius(steps).map(error)).collect::<Result<_, _>>()
    };
    Ok(Convergence {
        collocation: NODES.iter().map(collocated).collect::<Result<_, _>>()?,
        semi: discretised(Discretisation::Semi)?,
        full: discretised(Discretisation::Full)?,
    })
}

/// The table in Markdown: one row a resolution, with the order between a row and the one before.
pub fn table(errors: &Convergence) -> String {
    let mut text =
        "| nodes | collocation | | steps | semi-discretisation | order | full discretisation | order |\n".to_owned();
    text.push_str("|---|---|---|---|---|---|---|---|\n");
    let order = |errors: &[f64], i: usize| match i {
        0 => String::new(),
        i => format!("{:.2}", (errors[i - 1] / errors[i]).ln() / (STEPS[i] as f64 / STEPS[i - 1] as f64).ln()),
    };
    for (i, nodes) in NODES.iter().enumerate() {
        // What is left at the end is the rounding of the eigenvalue.
        let error = errors.collocation[i];
        let error = if error < 1e-10 { "< 1e-10".to_owned() } else { format!("{error:.0e}") };
        text.push_str(&format!("| {nodes} | {error} | |"));
        match STEPS.get(i) {
            Some(steps) => text.push_str(&format!(
                " {steps} | {:.1e} | {} | {:.1e} | {} |\n",
                errors.semi[i],
                order(&errors.semi, i),
                errors.full[i],
                order(&errors.full, i)
            )),
            None => text.push_str(" | | | | |\n"),
        }
    }
    text
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    Ok(write!(std::io::stdout(), "{}", table(&convergence()?))?)
}
