//! The verdict at a point, for people and programs.

use super::cut::{Cut, found, prepared};
use serde_json::{Map, Value, json};
use std::f64::consts::TAU;
use toolroom_chatter::paper::{FiveDegrees, Reduced};
use toolroom_chatter::{
    Certificate, ChatterError, ChatterKind, Milling, Roughness, Settled, StabilityVerdict, StableIntervals,
};
use toolroom_form::significant;
use toolroom_lobes::Chart;
use toolroom_process::unit::convert;

/// Chip pressure by which the chuck's cutting stiffness is a depth of cut, 300 kgf/mm², Pa.
///
/// # Source
/// Zakovorotny et al., "Parametrical phenomena under on-machine process control": c0 = rho t_p.
const CHIP_PRESSURE: f64 = 300.0 * 9.80665e6;

/// Verdict at a point and its distance from the boundary.
#[derive(Clone, Debug)]
pub struct Judgement {
    /// Position on the first axis in the unit of [`Cut::axes`], SI.
    pub speed: f64,
    /// Position on the second axis, SI.
    pub depth: f64,
    /// What the stability model says.
    pub verdict: StabilityVerdict,
    /// Least unstable depth, m, or what stands for it on the second axis; `None` if there is none
    /// up to `searched`.
    pub limit: Option<f64>,
    /// Greatest depth that was searched; infinite where the limit is exact.
    pub searched: f64,
    /// Multipliers outside the unit circle, of milling and turning at constant speed; none where they are too many to be counted.
    pub unstable: Option<usize>,
    /// All depths at which the cut is stable, of milling and of turning at constant speed.
    pub intervals: Option<StableIntervals>,
    /// The motion of a milling cut at constant speed with its feed where it is stable; at a single place that of unstable
    /// cuts and of turning too.
    pub vibration: Option<Vibration>,
}

impl Cut {
    /// Verdict, limit and margin at a point; limits are searched up to the chart's greatest depth
    /// and at least to twice `depth`.
    ///
    /// # Errors
    /// [`ChatterError`] where the point lies outside the domain of the model or its search fails.
    pub fn judge(&self, speed: f64, depth: f64, chart: &Chart) -> Result<Judgement, ChatterError> {
        let searched = chart.depth.end.max(2.0 * depth);
        let mut intervals = None;
        let (verdict, limit, searched) = match self {
            Self::Milling(cut, variation) => {
                let mut at_speed = prepared(cut, *variation, speed)?;
                let found = at_speed.stable_intervals(searched)?;
                let limit = found.limit().map(|limit| limit.depth);
                intervals = Some(found);
                (at_speed.verdict(depth)?, limit, searched)
            }
            Self::Turning(cut, None) => {
                intervals = Some(cut.stable_intervals(speed, searched)?);
                (cut.verdict(speed, depth)?, found(cut.limit(speed))?, f64::INFINITY)
            }
            Self::Turning(cut, Some(variation)) => {
                let limit = cut.limit_at_varying_speed(speed, *variation, searched, chart.depth.points);
                (cut.verdict_at_varying_speed(speed, *variation, depth)?, found(limit)?, searched)
            }
            Self::Chuck(chuck) => (chuck.verdict(depth, speed)?, chuck.critical_modulation(speed, searched)?, searched),
            Self::ChipLag(chuck) => {
                let chuck = Reduced { lag: speed, cutting_stiffness: depth, ..*chuck };
                let limit = Some(chuck.cutting_stiffness_limit()).filter(|limit| limit.is_finite());
                (chuck.verdict(0.0, 1.0)?, limit, f64::INFINITY)
            }
            Self::Lathe(lathe) => {
                let spindle = speed * lathe.reference_frequency();
                let at = FiveDegrees { mu_chuck: depth, ..FiveDegrees::clone(lathe) };
                (at.verdict(spindle)?, lathe.critical_chuck_modulation(spindle, searched)?, searched)
            }
        };
        let vibration = match self {
            Self::Milling(cut, None) if verdict.stable => Vibration::of(cut, speed, depth),
            Self::Milling(..) | Self::Turning(..) | Self::Chuck(_) | Self::ChipLag(_) | Self::Lathe(_) => None,
        };
        let unstable = match self {
            Self::Milling(_, None) | Self::Turning(_, None) if verdict.stable => Some(0),
            Self::Milling(cut, None) => cut.at_speed(speed)?.unstable_multipliers(depth)?,
            Self::Turning(cut, None) => Some(cut.unstable_multipliers(speed, depth)?),
            Self::Milling(..) | Self::Turning(..) | Self::Chuck(_) | Self::ChipLag(_) | Self::Lathe(_) => None,
        };
        // The count of a verdict that is told apart by less than rounding follows it.
        let unstable = unstable.map(|count| if verdict.stable { count } else { count.max(1) });
        Ok(Judgement { speed, depth, verdict, limit, searched, unstable, intervals, vibration })
    }
}

/// Greatest difference of the forced vibration from the simulated one in the tests of milling, relative.
const BAND: f64 = 0.04;

/// The motion of a cut and the force behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vibration {
    /// Peak-to-peak displacement in feed and normal direction (m).
    pub peak_to_peak: [f64; 2],
    /// Greatest force in feed and normal direction (N).
    pub greatest_force: [f64; 2],
    /// Greatest resultant of both (N).
    pub greatest_resultant: f64,
    /// Error of the surface location (m), positive where material is left on the wall; of the series of a forced vibration, also
    /// where the rest is simulated because teeth run out.
    pub surface_location_error: Option<f64>,
    /// Roughness of the wall at its foot, of milling.
    pub roughness: Option<Roughness>,
    /// How it was found.
    pub method: VibrationMethod,
    /// Relative error of the peak-to-peak displacement.
    pub band: f64,
}

/// How a vibration was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VibrationMethod {
    /// By Fourier series, of a stable cut.
    Forced,
    /// By simulation over time with loss of contact.
    Simulated {
        /// Whether it repeats from one window to the next.
        settled: bool,
        /// Share of the time in engagement without contact.
        air_fraction: f64,
        /// Least and greatest of the greater peak-to-peak displacement (m) over windows of a long run, where it does not repeat.
        range: Option<[f64; 2]>,
    },
}

impl Vibration {
    /// Of a cut that is stable at `speed` (rad/s) and `depth` (m); none without feed or depth, and where the surfaces of the
    /// teeth overlap by runout.
    pub(super) fn of(cut: &Milling, speed: f64, depth: f64) -> Option<Self> {
        let forced = cut.forced(speed, depth).ok().filter(|_| cut.feed_per_tooth > 0.0)?;
        Some(Self {
            surface_location_error: Some(cut.material_left(&forced)),
            roughness: cut.forced_roughness(depth, &forced).ok().flatten(),
            method: VibrationMethod::Forced,
            band: BAND,
            peak_to_peak: forced.peak_to_peak,
            greatest_force: forced.greatest_force,
            greatest_resultant: forced.greatest_resultant,
        })
    }

    /// Of a settled simulation.
    pub(super) fn simulated(cut: &Cut, (speed, depth): (f64, f64), settled: &Settled) -> Self {
        let run = &settled.simulation;
        let roughness = match cut {
            Cut::Milling(cut, _) => {
                let period = TAU / (speed * cut.cutter.teeth as f64);
                cut.simulated_roughness(depth, run, (period / run.time_step).round() as usize)
            }
            Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => None,
        };
        Self {
            peak_to_peak: [run.peak_to_peak(0), run.peak_to_peak(1)],
            greatest_force: [run.greatest_force(0), run.greatest_force(1)],
            greatest_resultant: run.force.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max),
            surface_location_error: None,
            roughness,
            method: VibrationMethod::Simulated {
                settled: settled.settled,
                air_fraction: run.air_fraction,
                range: settled.range,
            },
            band: settled.band,
        }
    }

    fn json(&self) -> Value {
        let mut object = json!({
            "pp_x [um]": self.peak_to_peak[0] * 1e6,
            "pp_y [um]": self.peak_to_peak[1] * 1e6,
            "max_force [N]": self.greatest_resultant,
            "max_force_x [N]": self.greatest_force[0],
            "max_force_y [N]": self.greatest_force[1],
            "sle [um]": self.surface_location_error.map(|error| error * 1e6),
            "ra [um]": self.roughness.map(|roughness| roughness.ra * 1e6),
            "rz [um]": self.roughness.map(|roughness| roughness.rz * 1e6),
            "method": "forced",
            "band": self.band,
        });
        if let VibrationMethod::Simulated { settled, air_fraction, range } = self.method {
            object["method"] = json!("simulated");
            object["settled"] = json!(settled);
            object["air_fraction"] = json!(air_fraction);
            if let Some(range) = range {
                object["pp_range [um]"] = json!(range.map(|end| end * 1e6));
            }
        }
        object
    }
}

/// What was found out about an operating point; where the search failed, why.
pub type Judged = Result<Judgement, ChatterError>;

impl Judgement {
    /// `1 − depth/limit`; `None` without limit.
    pub fn margin(&self) -> Option<f64> {
        // A cut that is unstable at depth zero has no margin to speak of.
        self.limit.filter(|limit| *limit > 0.0).map(|limit| 1.0 - self.depth / limit)
    }

    /// The verdict on `cut` for programs.
    pub fn json(&self, cut: &Cut) -> Map<String, Value> {
        let Self { speed, depth, verdict, limit, searched, unstable, intervals, vibration } = self;
        let axes = cut.axes();
        let mut object = Map::new();
        let mut put = |key: &str, value: Value| object.insert(key.to_owned(), value);
        put("process", cut.process().word().into());
        put(&axes.speed.column(), axes.speed.shown(*speed).into());
        put(&axes.depth.column(), axes.depth.shown(*depth).into());
        put("spectral_radius", verdict.spectral_radius.into());
        put("stable", verdict.stable.into());
        put("type", word(verdict.kind).into());
        let finite = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
        // Without modulation, by Routh, as a depth of cut.
        let routh = |chuck: &Reduced| finite(chuck.cutting_stiffness_limit() / CHIP_PRESSURE * 1e3);
        match cut {
            Cut::Milling(_, variation) | Cut::Turning(_, variation) => {
                put("stability_limit [mm]", json!(limit.map(|depth| depth * 1e3)));
                put("margin", json!(self.margin()));
                put("searched [mm]", finite(searched * 1e3));
                if let Some(found) = intervals {
                    let stable = found.intervals();
                    put(
                        "stable_intervals [mm]",
                        json!(stable.iter().map(|pair| pair.map(|b| b * 1e3)).collect::<Vec<_>>()),
                    );
                    put("certificate", certificate(found.certificate).into());
                    put("unstable_multipliers", json!(unstable));
                }
                if let Some(vibration) = vibration {
                    put("vibration", vibration.json());
                }
                if let Some(variation) = variation {
                    put(
                        "speed_variation",
                        json!({ "amplitude": variation.amplitude, "revolutions": variation.revolutions }),
                    );
                }
            }
            Cut::Chuck(chuck) => {
                put("stability_limit [mm]", routh(chuck));
                put("margin", json!(verdict.margin));
                put("critical_modulation", json!(limit));
                put("modulation_margin", json!(self.margin()));
                put("spindle_speed [rpm]", convert(chuck.natural_frequency() * speed / 3.0, "rad/s", "rpm").into());
            }
            Cut::ChipLag(chuck) => {
                put("stability_limit [mm]", routh(&Reduced { lag: *speed, cutting_stiffness: *depth, ..*chuck }));
                put("critical_cutting_stiffness [N/um]", json!(limit.map(|limit| limit * 1e-6)));
                put("margin", json!(self.margin()));
            }
            Cut::Lathe(lathe) => {
                put("critical_modulation", json!(limit));
                put("modulation_margin", json!(self.margin()));
                put("spindle_speed [rpm]", convert(lathe.reference_frequency() * speed, "rad/s", "rpm").into());
            }
        }
        put("chatter_frequency [Hz]", cut.chatter_frequency(verdict).into());
        put("chatter_frequencies [Hz]", json!(verdict.chatter_frequencies(cut.greatest_frequency())));
        put("residual", verdict.residual.into());
        object
    }
}

/// How it is known that no stable interval is missing, in a word.
fn certificate(certificate: Certificate) -> String {
    match certificate {
        Certificate::Proved => "proved".to_owned(),
        Certificate::Envelope => "envelope".to_owned(),
        Certificate::Resolution(step) => format!("resolution:{} mm", significant(step * 1e3)),
    }
}

/// The kind of chatter in a word.
pub fn word(kind: ChatterKind) -> &'static str {
    match kind {
        ChatterKind::Stable => "stable",
        ChatterKind::Hopf => "hopf",
        ChatterKind::Flip => "flip",
        ChatterKind::Parametric => "parametric",
    }
}
