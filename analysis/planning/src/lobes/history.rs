//! The vibration at one point over time: record, spectrum with its lines named, and one sample a tooth.

use super::LobesFile;
use super::cut::Cut;
use super::place::interval;
use crate::tables::table;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use toolroom_chart::page::{Figure, Provenance, Report, Section, Tile};
use toolroom_chart::{Axis, Chart, Colour, Dash, Marker, Plot, ResultFiles, Style, png};
use toolroom_chatter::{ChatterError, Probability, Settled, StabilityVerdict};
use toolroom_process::table::Cell;

/// Files of a history.
pub const HISTORY_NAMES: &[&str] = &[
    "history.csv",
    "spectrum.csv",
    "history.svg",
    "history.png",
    "spectrum.svg",
    "spectrum.png",
    "section.svg",
    "section.png",
    "history.json",
    "report.html",
];

const PIXELS: u32 = 1600;
/// Share of the greatest line below which a line of the spectrum is not told.
const FAINT: f64 = 0.02;
/// Bins on either side that belong to a line: the main lobe of the window of Hann.
const WIDE: usize = 2;

/// Why the vibration at a point cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HistoryError {
    /// A cut that is not simulated.
    #[error("a vibration over time is simulated of milling and turning at constant speed")]
    Process,
    /// Forces need a feed.
    #[error("a vibration over time needs the feed: {key}")]
    NoFeed {
        /// The key that is missing.
        key: &'static str,
    },
    /// The model refused a value.
    #[error(transparent)]
    Refused(#[from] ChatterError),
}

/// A line of a spectrum.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralLine {
    /// Frequency (Hz).
    pub frequency: f64,
    /// Amplitude of the displacement in feed direction and normal to it (m).
    pub amplitude: [f64; 2],
    /// `tooth 2`, `spindle 3`, `chatter` or `other`.
    pub origin: String,
}

/// The vibration at one point over time.
#[derive(Clone, Debug)]
pub struct History<'a> {
    file: &'a LobesFile,
    /// Spindle speed (rad/s) and depth (m).
    pub place: (f64, f64),
    /// The settled vibration.
    pub final_state: Settled,
    /// Samples in a tooth period, or a revolution in turning.
    steps: usize,
    /// Frequencies (Hz) and amplitudes (m) up to twice the highest mode.
    spectrum: Vec<(f64, [f64; 2])>,
    /// The lines that stand out.
    pub lines: Vec<SpectralLine>,
    /// Directions that are shown: one in turning.
    directions: usize,
    /// How probably the cut is stable there, where the file says how well its constants are known.
    probability: Option<Probability>,
}

impl LobesFile {
    /// The settled vibration at `speed` (rad/s) and `depth` (m), by simulation.
    ///
    /// # Errors
    /// [`HistoryError`]: a cut that is not simulated, no feed, a value that the model refuses.
    pub fn settled(&self, speed: f64, depth: f64) -> Result<Settled, HistoryError> {
        match (&self.cut, self.feed) {
            (Cut::Milling(cut, None), Some(_)) => Ok(cut.settled(speed, depth)?),
            (Cut::Turning(cut, None), Some(feed)) => Ok(cut.settled(speed, depth, feed)?),
            (Cut::Milling(_, None), None) => Err(HistoryError::NoFeed { key: "feed_per_tooth of [force]" }),
            (Cut::Turning(_, None), None) => Err(HistoryError::NoFeed { key: "feed_per_rev of [cut]" }),
            (Cut::Milling(..) | Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_), _) => {
                Err(HistoryError::Process)
            }
        }
    }

    /// The vibration at a place over time.
    ///
    /// # Errors
    /// As [`LobesFile::settled`], and as the verdict there.
    pub fn history(&self, place: (f64, f64)) -> Result<History<'_>, HistoryError> {
        let (speed, depth) = place;
        let settled = self.settled(speed, depth)?;
        let verdict = self.cut.judge(speed, depth, &self.chart)?.verdict;
        let (teeth, directions) = match &self.cut {
            Cut::Milling(cut, _) => (cut.cutter.teeth, 2),
            Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => (1, 1),
        };
        let period = TAU / (speed * teeth as f64);
        let steps = (period / settled.simulation.time_step).round() as usize;
        let spectrum = spectrum(&settled, self.cut.greatest_frequency());
        let lines = lines(&spectrum, &verdict, speed / TAU, teeth, period);
        let probability = self.stability_probability(place)?;
        Ok(History { file: self, place, final_state: settled, steps, spectrum, lines, directions, probability })
    }
}

/// Amplitudes by the discrete Fourier transform with the window of Hann, up to `highest` (Hz).
fn spectrum(settled: &Settled, highest: f64) -> Vec<(f64, [f64; 2])> {
    let samples = &settled.simulation.displacement;
    let count = samples.len();
    let mean = samples.iter().fold([0.0; 2], |sum, u| [sum[0] + u[0], sum[1] + u[1]]).map(|sum| sum / count as f64);
    let window = |n: usize| 1.0 - (TAU * n as f64 / count as f64).cos();
    let resolution = 1.0 / (count as f64 * settled.simulation.time_step);
    let bins = ((highest / resolution).ceil() as usize).min(count / 2);
    // A sample in so many still has eight to the highest frequency.
    let stride = ((1.0 / (8.0 * highest * settled.simulation.time_step)) as usize).max(1);
    let amplitude = |bin: usize| {
        let mut sum = [[0.0; 2]; 2];
        for n in (0..count).step_by(stride) {
            let (sine, cosine) = (TAU * ((bin * n) % count) as f64 / count as f64).sin_cos();
            for direction in 0..2 {
                let value = (samples[n][direction] - mean[direction]) * window(n);
                sum[direction][0] += value * cosine;
                sum[direction][1] += value * sine;
            }
        }
        let scale = 2.0 / count.div_ceil(stride) as f64;
        sum.map(|[re, im]| re.hypot(im) * scale)
    };
    (1..=bins).map(|bin| (bin as f64 * resolution, amplitude(bin))).collect()
}

/// The peaks of a spectrum with their names.
fn lines(
    spectrum: &[(f64, [f64; 2])],
    verdict: &StabilityVerdict,
    spindle: f64,
    teeth: usize,
    period: f64,
) -> Vec<SpectralLine> {
    let size = |i: usize| spectrum[i].1[0].hypot(spectrum[i].1[1]);
    let greatest = (0..spectrum.len()).map(size).fold(0.0, f64::max);
    let resolution = spectrum.first().map_or(1.0, |(frequency, _)| *frequency);
    let highest = spectrum.last().map_or(0.0, |(frequency, _)| *frequency);
    let chatter = if verdict.stable { Vec::new() } else { verdict.chatter_frequencies(1.1 * highest) };
    let near = |frequency: f64, of: f64| (frequency - of).abs() <= 1.5 * resolution;
    let name = |frequency: f64| {
        let tooth = (frequency * period).round();
        let turn = (frequency / spindle).round();
        if tooth >= 1.0 && near(frequency, tooth / period) {
            return format!("tooth {tooth}");
        }
        // Vibration that has settled moves a little from the frequency at which it sets in.
        if let Some(line) =
            chatter.iter().find(|line| (frequency - **line).abs() <= (0.1 / period).max(2.0 * resolution))
        {
            return format!("chatter, {line:.1} Hz by the linear theory");
        }
        if teeth > 1 && turn >= 1.0 && near(frequency, turn * spindle) {
            return format!("spindle {turn}");
        }
        "other".to_owned()
    };
    let peak = |i: usize| {
        let around = i.saturating_sub(WIDE)..(i + WIDE + 1).min(spectrum.len());
        size(i) >= FAINT * greatest && around.clone().all(|k| k == i || size(k) < size(i))
    };
    let line =
        |i: usize| SpectralLine { frequency: spectrum[i].0, amplitude: spectrum[i].1, origin: name(spectrum[i].0) };
    (0..spectrum.len()).filter(|i| peak(*i)).map(line).collect()
}

const NAMES: [&str; 2] = ["feed direction", "normal direction"];

impl History<'_> {
    /// Names of the directions that are shown.
    fn directions(&self) -> impl Iterator<Item = (usize, &'static str)> {
        let names = if self.directions == 1 { ["chip thickness", ""] } else { NAMES };
        names.into_iter().take(self.directions).enumerate()
    }

    /// For programs.
    pub fn json(&self) -> Value {
        let lines: Vec<Value> = self
            .lines
            .iter()
            .map(|line| {
                json!({
                    "frequency [Hz]": line.frequency,
                    "x [um]": line.amplitude[0] * 1e6,
                    "y [um]": line.amplitude[1] * 1e6,
                    "origin": line.origin,
                })
            })
            .collect();
        let Settled { periods, change, settled, band, .. } = self.final_state;
        json!({
            "schema": 1,
            "name": self.file.name,
            "spindle_speed [rpm]": self.place.0 * 60.0 / TAU,
            "depth_of_cut [mm]": self.place.1 * 1e3,
            "periods": periods,
            "settled": settled,
            "change": change,
            "band": band,
            "pp_x [um]": self.final_state.simulation.peak_to_peak(0) * 1e6,
            "pp_y [um]": self.final_state.simulation.peak_to_peak(1) * 1e6,
            "p_stable": self.probability.map(|probability| probability.value),
            "p_stable_band": self.probability.map(interval),
            "lines": lines,
        })
    }

    /// Tables, pictures and the report.
    pub fn files(&self, provenance: Provenance) -> ResultFiles {
        let (history, spectrum, section) = (self.over_time(), self.over_frequency(), self.once_a_period());
        let mut files = ResultFiles::default();
        files.push("history.csv", self.samples());
        files.push("spectrum.csv", self.amplitudes());
        for (name, picture) in [("history", &history), ("spectrum", &spectrum), ("section", &section)] {
            files.push(format!("{name}.svg"), picture.svg());
            files.push(format!("{name}.png"), png(picture, PIXELS));
        }
        files.push("history.json", format!("{:#}\n", self.json()));
        let axes = self.file.cut.axes();
        let (speed, depth) = (axes.speed.shown(self.place.0), axes.depth.shown(self.place.1));
        let range = |direction: usize| format!("{:.1} um", self.final_state.simulation.peak_to_peak(direction) * 1e6);
        let settled = if self.final_state.settled {
            format!(
                "It repeats within {:.1} % after {} periods.",
                100.0 * self.final_state.change,
                self.final_state.periods
            )
        } else {
            format!(
                "It still changes by {:.0} % after {} periods: it has two frequencies that do not fit, or grows on.",
                100.0 * self.final_state.change,
                self.final_state.periods
            )
        };
        let mut report = Report::new(format!("{}: vibration at {speed:.0} rpm and {depth:.3} mm", self.file.title))
            .lead(format!("Simulated with surfaces that earlier teeth left and loss of contact. {settled}"));
        for (direction, name) in self.directions() {
            report = report.tile(Tile::new(name, range(direction), "peak to peak"));
        }
        if let Some(probability) = self.probability {
            let [low, high] = interval(probability).map(|end| 100.0 * end);
            let share = format!("{:.0} %", 100.0 * probability.value);
            let note =
                format!("{low:.0} to {high:.0} % by the number of samples; the constants scatter as the file says");
            report = report.tile(Tile::new("probability of stability", share, note));
        }
        let figures = Section::new("Vibration")
            .figure(Figure::new(&history, "The last periods.").data_in("history.csv"))
            .figure(
                Figure::new(&spectrum, "Amplitudes with harmonics of the teeth and chatter named.")
                    .data_in("spectrum.csv"),
            )
            .figure(Figure::new(
                &section,
                "One sample a period over the one before: a stable cut is one point, period doubling two, chatter at a \
                 frequency of its own a closed curve.",
            ));
        files.push("report.html", report.section(figures).provenance(provenance).html());
        files
    }

    /// The samples of the last 20 periods.
    fn samples(&self) -> String {
        let run = &self.final_state.simulation;
        let first = run.displacement.len().saturating_sub(20 * self.steps);
        let rows = (first..run.displacement.len()).map(|i| -> [Cell<'_>; 5] {
            let (u, f) = (run.displacement[i], run.force[i]);
            [
                ((i - first) as f64 * run.time_step).into(),
                (u[0] * 1e6).into(),
                (u[1] * 1e6).into(),
                f[0].into(),
                f[1].into(),
            ]
        });
        table(["time [s]", "x [um]", "y [um]", "force_x [N]", "force_y [N]"], rows)
    }

    fn amplitudes(&self) -> String {
        let rows = self.spectrum.iter().map(|(frequency, amplitude)| -> [Cell<'_>; 3] {
            [(*frequency).into(), (amplitude[0] * 1e6).into(), (amplitude[1] * 1e6).into()]
        });
        table(["frequency [Hz]", "x [um]", "y [um]"], rows)
    }

    fn over_time(&self) -> Plot {
        let run = &self.final_state.simulation;
        let shown = (10 * self.steps).min(run.displacement.len());
        let first = run.displacement.len() - shown;
        let mut plot = Plot::new(
            format!("{}: displacement", self.file.title),
            Axis::linear("Time", "ms"),
            Axis::linear("Displacement", "um"),
        );
        for (direction, name) in self.directions() {
            let points = (first..run.displacement.len())
                .map(|i| ((i - first) as f64 * run.time_step * 1e3, run.displacement[i][direction] * 1e6));
            plot = plot.line(name, points, Style::nth(direction));
        }
        plot.describe("Displacement of the tool over the last ten periods.")
    }

    fn over_frequency(&self) -> Plot {
        let greatest = self.spectrum.iter().flat_map(|(_, a)| a).fold(0.0, |a: f64, b| a.max(*b)) * 1e6;
        let mut plot = Plot::new(
            format!("{}: spectrum", self.file.title),
            Axis::linear("Frequency", "Hz"),
            Axis::linear("Amplitude", "um").include(0.0),
        );
        for (direction, name) in self.directions() {
            let points = self.spectrum.iter().map(|(frequency, amplitude)| (*frequency, amplitude[direction] * 1e6));
            plot = plot.line(name, points, Style::nth(direction));
        }
        let groups =
            [("teeth", "tooth", Colour::Grey, Dash::Dotted), ("chatter", "chatter", Colour::Purple, Dash::DashDot)];
        for (label, word, colour, dash) in groups {
            let mut label = label.to_owned();
            for line in self.lines.iter().filter(|line| line.origin.starts_with(word)) {
                let points = [(line.frequency, 0.0), (line.frequency, 1.05 * greatest)];
                let style = Style::nth(0).colour(colour).dash(dash);
                plot = plot.line(std::mem::take(&mut label), points, style);
            }
        }
        plot.describe("Spectrum of the displacement, lines of teeth and chatter marked.")
    }

    fn once_a_period(&self) -> Plot {
        let run = &self.final_state.simulation;
        let mut plot = Plot::new(
            format!("{}: once a period", self.file.title),
            Axis::linear("Displacement a period before", "um"),
            Axis::linear("Displacement", "um"),
        );
        for (direction, name) in self.directions() {
            let samples: Vec<f64> =
                run.displacement.iter().step_by(self.steps.max(1)).map(|u| u[direction] * 1e6).collect();
            let style = Style::nth(direction).marker([Marker::Circle, Marker::Plus][direction.min(1)]);
            plot = plot.scatter(name, samples.windows(2).map(|pair| (pair[0], pair[1])), style);
        }
        plot.describe("One sample of the displacement a period over the one before.")
    }
}
