//! Modes brought up to date by cuts of the shop that chattered or did not.
//!
//! Every natural frequency, damping ratio and stiffness, and the cutting-force coefficient, is lognormal about the value of the
//! files with its relative standard deviation. A cut says chatter with probability `e + (1 − 2 e) [unstable]`, and an observed
//! chatter frequency is normal about that of the limit at its speed. Particles go from the prior to the posterior by tempering
//! with resampling and Metropolis moves.
//!
//! # What the data cannot tell
//! A lobe moves along the speed with the natural frequency, and along the depth with `k zeta` or the coefficient alike: these two
//! have to be told apart by a tap or a force.
//!
//! # Source
//! Del Moral, Doucet and Jasra, Sequential Monte Carlo samplers (2006).

use super::particles::{Particle, Question, Values, next, surprise, tempered};
use super::update_error::UpdateError;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::fmt::Write;
use std::sync::atomic::{AtomicUsize, Ordering};
use toolroom_chart::page::Provenance;
use toolroom_chatter::Draw;
use toolroom_dynamics::{ShopCut, quoted};
use toolroom_lobes::{LobesFile, Structure};

/// Share of these below which the modes are said to have drifted.
const DRIFT: f64 = 0.01;

/// How the particles are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpdateOptions {
    /// Particles.
    pub particles: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Relative standard deviation of the cutting-force coefficient.
    pub coefficients: f64,
}

impl Default for UpdateOptions {
    /// 4096 particles, and 15 % of a coefficient from a table (assumption).
    fn default() -> Self {
        Self { particles: 4096, seed: 1, coefficients: 0.15 }
    }
}

/// A value before and after, each with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Learnt {
    /// Median and standard deviation of the prior.
    pub before: [f64; 2],
    /// Mean and standard deviation of the posterior.
    pub after: [f64; 2],
}

/// What the cuts have told.
#[derive(Clone, Debug)]
pub struct ModesUpdate {
    /// Name of the structure.
    pub name: String,
    /// Natural frequency (Hz), damping ratio and stiffness (N/m) of every mode.
    pub modes: Vec<([f64; 2], [Learnt; 3])>,
    /// Factor of the cutting-force coefficient.
    pub coefficient: Learnt,
    /// Static compliance xx, xy, yy of the modes above the range (m/N), unchanged.
    residual: [f64; 3],
    /// Logarithm of the probability of the cuts with the modes of the file over that with modes of the prior.
    pub evidence_ratio: f64,
    /// Share of data sets drawn from the prior that are less probable than the cuts.
    pub surprise: f64,
    /// The cut that would tell most: spindle speed (rad/s), depth (m), probability of chatter.
    pub next: Option<(f64, f64, f64)>,
    /// Cuts that were used.
    pub cuts: usize,
}

/// Parts of the work as they are counted: particles of the prior, their way to the posterior, the cut that would tell most. About
/// as long as these take with 4096 particles and thirty cuts (assumption: they make the time to come, nothing else).
const PARTS: u32 = 1000;
const PRIOR_PARTS: u32 = 100;
const TEMPERED_PARTS: u32 = 800;

impl ModesUpdate {
    /// Brings the modes of `structure` up to date by `cuts` with the cutter and force of `file`. `progress` is told how many
    /// parts of the work are done, of how many.
    ///
    /// # Errors
    /// [`UpdateError`]: a file of another process, exact modes, no cuts, a value that the model refuses.
    pub fn new(
        structure: &Structure,
        file: &LobesFile,
        cuts: &[ShopCut],
        options: &UpdateOptions,
        progress: &(dyn Fn(u32, u32) + Sync),
    ) -> Result<Self, UpdateError> {
        if file.variation.is_some() {
            return Err(UpdateError::Process);
        }
        if structure.by_speed.is_some() {
            return Err(UpdateError::Speeds);
        }
        if structure.along_path.is_some() {
            return Err(UpdateError::Stations);
        }
        if cuts.is_empty() {
            return Err(UpdateError::NoCuts);
        }
        let mut sds: Vec<f64> = structure.deviations.iter().flatten().copied().collect();
        if sds.iter().all(|sd| *sd == 0.0) {
            return Err(UpdateError::Exact);
        }
        sds.push(options.coefficients);
        let question = Question::new(file, structure, cuts, sds);
        let size = question.sds.len();
        let count = options.particles.max(16);
        let drawn = AtomicUsize::new(0);
        let draw = |i: usize| {
            let mut draw = Draw::new(options.seed, i as u64);
            let particle = question.particle((0..size).map(|_| draw.normal()).collect());
            let share = (drawn.fetch_add(1, Ordering::Relaxed) + 1) as f64 / count as f64;
            progress((share * f64::from(PRIOR_PARTS)) as u32, PARTS);
            particle
        };
        let prior: Vec<Particle> = (0..count).into_par_iter().map(draw).collect::<Result<_, _>>()?;
        let (posterior, evidence) = tempered(&question, prior.clone(), options.seed, &|share| {
            progress(PRIOR_PARTS + (share * f64::from(TEMPERED_PARTS)) as u32, PARTS);
        })?;
        let old = question.particle(vec![0.0; size])?;
        let values: Vec<Values> = posterior.iter().map(|particle| question.values(&particle.z)).collect();
        let learnt = |median: f64, sd: f64, of: &dyn Fn(&Values) -> f64| {
            let mean = values.iter().map(of).sum::<f64>() / values.len() as f64;
            let square = values.iter().map(|value| (of(value) - mean).powi(2)).sum::<f64>();
            Learnt { before: [median, sd * median], after: [mean, (square / values.len() as f64).sqrt()] }
        };
        let modes = structure.modes.iter().zip(&structure.deviations).enumerate().map(|(i, (mode, [f, zeta, k]))| {
            let learnt = [
                learnt(mode.natural_frequency, *f, &|value| value.0[i].natural_frequency),
                learnt(mode.damping_ratio, *zeta, &|value| value.0[i].damping_ratio),
                learnt(mode.stiffness, *k, &|value| value.0[i].stiffness),
            ];
            (mode.direction, learnt)
        });
        let above = structure.modes.iter().skip(structure.deviations.len());
        let residual = above.fold([0.0; 3], |[xx, xy, yy], mode| {
            let [x, y] = mode.direction;
            [xx + x * x / mode.stiffness, xy + x * y / mode.stiffness, yy + y * y / mode.stiffness]
        });
        Ok(Self {
            name: structure.name.clone(),
            modes: modes.collect(),
            coefficient: learnt(1.0, options.coefficients, &|value| value.1),
            residual,
            evidence_ratio: old.likelihood - evidence,
            surprise: surprise(&prior, cuts, options.seed),
            next: next(&question, &values)?,
            cuts: cuts.len(),
        })
    }

    /// Whether the cuts are hard to explain with the modes as they were known.
    pub fn drifted(&self) -> bool {
        self.surprise < DRIFT
    }

    /// For programs.
    pub fn json(&self) -> Value {
        let learnt = |learnt: &Learnt, scale: f64| {
            json!({
                "value": learnt.after[0] * scale,
                "sd": learnt.after[1] * scale,
                "before": learnt.before[0] * scale,
                "sd_before": learnt.before[1] * scale,
            })
        };
        let modes: Vec<Value> = self
            .modes
            .iter()
            .map(|(direction, [f, zeta, k])| {
                json!({
                    "direction": direction,
                    "natural_frequency [Hz]": learnt(f, 1.0),
                    "damping_ratio": learnt(zeta, 1.0),
                    "stiffness [N/um]": learnt(k, 1e-6),
                })
            })
            .collect();
        json!({
            "schema": 1,
            "name": self.name,
            "cuts": self.cuts,
            "modes": modes,
            "coefficient_factor": learnt(&self.coefficient, 1.0),
            "log_evidence_ratio": self.evidence_ratio,
            "surprise": self.surprise,
            "drift": self.drifted(),
            "next_cut": self.next.map(|(speed, depth, chatter)| json!({
                "spindle_speed [rpm]": speed * 60.0 / TAU,
                "depth_of_cut [mm]": depth * 1e3,
                "p_chatter": chatter,
            })),
        })
    }

    /// For a terminal.
    pub fn text(&self) -> String {
        let mut text = format!("{}: {} cuts\n", self.name, self.cuts);
        let mut line = |name: String, learnt: &Learnt, scale: f64, unit: &str| {
            let [value, sd, before, sd_before] =
                [learnt.after[0], learnt.after[1], learnt.before[0], learnt.before[1]].map(|value| value * scale);
            let _ =
                writeln!(text, "  {name:22} {value:>10.4} ± {sd:<9.4} {unit:5}  before {before:.4} ± {sd_before:.4}");
        };
        for (i, (_, [f, zeta, k])) in self.modes.iter().enumerate() {
            line(format!("m{} natural frequency", i + 1), f, 1.0, "Hz");
            line(format!("m{} damping ratio", i + 1), zeta, 1.0, "");
            line(format!("m{} stiffness", i + 1), k, 1e-6, "N/um");
        }
        line("coefficient, factor".to_owned(), &self.coefficient, 1.0, "");
        let _ = writeln!(
            text,
            "  {:.1} % of cuts drawn from the modes as they were known are less probable{}",
            100.0 * self.surprise,
            if self.drifted() { ": the modes have drifted, tap again" } else { "" }
        );
        if let Some((speed, depth, chatter)) = self.next {
            let _ = writeln!(
                text,
                "  most told by a cut at {:.0} rpm, {:.3} mm, which chatters with probability {chatter:.2}",
                speed * 60.0 / TAU,
                depth * 1e3
            );
        }
        let _ = write!(
            text,
            "  stiffness times damping and the coefficient act alike: cuts do not tell them apart, a tap or a force does"
        );
        text
    }

    /// The structure file with the new values, with the command and the digests of the files that it was made of.
    pub fn structure(&self, provenance: &Provenance) -> String {
        let digests = provenance.inputs.iter().map(|(name, digest)| format!("{name} ({digest})"));
        let source = quoted(&format!("{} of {}", provenance.command, digests.collect::<Vec<_>>().join(", ")));
        let mut text = format!("schema = 1\nname = \"{}\"\n\n[measurement]\nsource = {source}\n", self.name);
        for (i, ([x, y], [f, zeta, k])) in self.modes.iter().enumerate() {
            let pair = |learnt: &Learnt, unit: &str| {
                let [value, sd] = learnt.after;
                if unit.is_empty() {
                    format!("{{ value = {value:e}, sd = {sd:e} }}")
                } else {
                    format!("{{ value = \"{value:e} {unit}\", sd = \"{sd:e} {unit}\" }}")
                }
            };
            let _ = write!(
                text,
                "\n[[mode]]\nname = \"m{}\"\ndirection = [{x}, {y}]\nnatural_frequency = {}\ndamping_ratio = {}\nstiffness = {}\n",
                i + 1,
                pair(f, "Hz"),
                pair(zeta, ""),
                pair(k, "N/m")
            );
        }
        let [xx, xy, yy] = self.residual;
        let _ = write!(
            text,
            "\n[residual]\nupper_xx = \"{xx:e} m/N\"\nupper_xy = \"{xy:e} m/N\"\nupper_yy = \"{yy:e} m/N\"\n"
        );
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_chatter::{Axis, Mode, Turning};
    use toolroom_lobes::{Chart, Limits, LobesCut};

    const CUTS: [(f64, f64, bool); 10] = [
        (3400.0, 0.30, false),
        (3900.0, 0.45, false),
        (4400.0, 0.35, false),
        (5000.0, 0.55, false),
        (5600.0, 0.75, true),
        (6300.0, 0.50, true),
        (7000.0, 0.45, false),
        (8000.0, 0.70, true),
        (5800.0, 0.80, false),
        (5400.0, 0.70, true),
    ];

    fn cuts(of: &[(f64, f64, bool)]) -> Vec<ShopCut> {
        of.iter()
            .map(|(rpm, depth, chatter)| ShopCut {
                spindle_speed: rpm / 60.0 * TAU,
                depth: depth * 1e-3,
                immersion: None,
                chatter: *chatter,
                frequency: None,
            })
            .collect()
    }

    fn case() -> (Structure, LobesFile) {
        let mode = Mode { direction: [1.0, 0.0], natural_frequency: 600.0, damping_ratio: 0.03, stiffness: 10e6 };
        let structure = Structure {
            name: "lathe".to_owned(),
            modes: vec![mode],
            by_speed: None,
            along_path: None,
            table: None,
            rotations: vec![None],
            scatter: None,
            deviations: vec![[0.03, 0.25, 0.10]],
            stiffness_deviation: 0.1,
        };
        let axis = |start, end| Axis { start, end, points: 20 };
        let file = LobesFile {
            name: "lathe".to_owned(),
            title: "lathe".to_owned(),
            cut: LobesCut::Turning { cut: Turning::orthogonal(vec![mode], 1.5e9, 0.05), bar: None },
            variation: None,
            chart: Chart {
                speed: axis(300.0, 900.0),
                depth: axis(0.0, 1.5e-3),
                boundary_only: true,
                beside: Vec::new(),
            },
            points: Vec::new(),
            scatter: None,
            limits: Limits::default(),
            feed: None,
            table: None,
        };
        (structure, file)
    }

    /// Posterior of an independent grid of 193 × 49 × 65 values over four standard deviations either way; one of 25 × 13 × 13 over
    /// three gives 579.08 ± 7.15 Hz, 0.02913 ± 0.00449 and 10.54 ± 0.92 N/um.
    #[test]
    fn ten_cuts_move_the_modes_as_an_independent_grid_says() {
        let (structure, file) = case();
        let options = UpdateOptions { particles: 1500, seed: 3, coefficients: 0.0 };
        let modes_update = ModesUpdate::new(&structure, &file, &cuts(&CUTS), &options, &|_, _| ()).unwrap();
        for (learnt, [mean, sd]) in
            modes_update.modes[0].1.iter().zip([[578.79, 7.19], [0.02910, 0.00447], [10.527e6, 0.932e6]])
        {
            assert!((learnt.after[0] - mean).abs() < 0.15 * sd, "{learnt:?} {mean}");
            assert!((learnt.after[1] / sd - 1.0).abs() < 0.15, "{learnt:?} {sd}");
        }
        assert!(!modes_update.drifted(), "{}", modes_update.surprise);
        let (speed, depth, chatter) = modes_update.next.unwrap();
        assert!(speed > 300.0 && depth > 0.0 && (0.3..0.7).contains(&chatter), "{:?}", modes_update.next);
    }

    #[test]
    fn cuts_against_all_that_is_known_are_a_drift() {
        let (structure, file) = case();
        let options = UpdateOptions { particles: 400, seed: 3, coefficients: 0.0 };
        // Deep cuts far above every limit that are quiet, and shallow ones that chatter.
        let odd: Vec<(f64, f64, bool)> =
            (0..8).map(|i| (3000.0 + 500.0 * f64::from(i), if i % 2 == 0 { 1.4 } else { 0.1 }, i % 2 == 1)).collect();
        let modes_update = ModesUpdate::new(&structure, &file, &cuts(&odd), &options, &|_, _| ()).unwrap();
        assert!(modes_update.drifted(), "{}", modes_update.surprise);
        let exact = Structure { deviations: vec![[0.0; 3]], ..structure };
        assert_eq!(ModesUpdate::new(&exact, &file, &cuts(&odd), &options, &|_, _| ()).unwrap_err(), UpdateError::Exact);
    }
}
