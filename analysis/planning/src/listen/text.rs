//! What was heard, in words and as JSON.

use super::ListenStudy;
use serde_json::{Value, json};
use std::fmt::Write as _;
use toolroom_dynamics::{Chatter, Origin};
use toolroom_process::unit::convert;

/// Level below the strongest line under which a line is not printed for people, 40 dB.
const FAINT: f64 = 0.01;

impl ListenStudy {
    /// What was heard, for people.
    pub fn text(&self) -> String {
        let heard = &self.heard;
        let rpm = |speed: f64| convert(speed, "rad/s", "rpm");
        let mut text = format!("{}: the spindle turns at {:.1} rpm\n", self.source, rpm(heard.spindle_speed));
        let frequency = heard.chatter_frequency.unwrap_or(0.0);
        let since = match heard.onset.unwrap_or(0.0) {
            onset if onset > 0.0 => format!("from {onset:.2} s on"),
            _ => "from the start".to_owned(),
        };
        let _ = match heard.chatter {
            Chatter::No => writeln!(text, "no chatter: every line that matters belongs to spindle or teeth"),
            Chatter::Yes if !heard.possible_frequencies.is_empty() => {
                let each: Vec<String> = heard.possible_frequencies.iter().map(|one| format!("{one:.1} Hz")).collect();
                let each = each.join(" or at ");
                writeln!(
                    text,
                    "chatter at {each}, {since}: lines from beyond half of the sampling rate stand folded in the record, and it does \
                     not tell which; record again with a higher rate, or name the modes with --lobes"
                )
            }
            Chatter::Yes => writeln!(text, "chatter at {frequency:.1} Hz, {since}"),
            Chatter::Ambiguous => writeln!(
                text,
                "ambiguous: the line at {frequency:.1} Hz is period-doubling chatter or runout, which lie on one frequency \
                 with an even number of teeth; record again with the speed changed by 2 %"
            ),
        };
        for note in &heard.notes {
            let _ = writeln!(text, "note: {note}");
        }
        if heard.chatter == Chatter::Yes && heard.chatter_frequency.is_some() && self.suggestions.is_empty() {
            let _ = writeln!(text, "no speed in range lets the teeth keep time with it");
        }
        for suggestion in &self.suggestions {
            let _ = write!(text, "quiet speed {:>9.1} rpm", rpm(suggestion.spindle_speed));
            let _ = match &suggestion.limit {
                None => Ok(()),
                Some(Ok(Some(limit))) => write!(text, ", limit {:.3} mm by the lobes file", limit * 1e3),
                Some(Ok(None)) => write!(text, ", stable over the whole chart of the lobes file"),
                Some(Err(error)) => write!(text, ", without a verdict: {error}"),
            };
            text.push('\n');
        }
        let strongest = heard.lines.iter().map(|line| line.amplitude).fold(0.0, f64::max);
        text.push_str("\nfrequency Hz   amplitude   above floor dB   line\n");
        for line in heard.lines.iter().filter(|line| line.amplitude >= FAINT * strongest) {
            let (frequency, amplitude, level) = (line.frequency, line.amplitude, line.level);
            let _ = writeln!(text, "{frequency:>12.1}   {amplitude:>9.5}   {level:>14.1}   {}", name(line.origin));
        }
        text
    }

    /// What was heard, for programs.
    pub fn json(&self) -> Value {
        let heard = &self.heard;
        let rpm = |speed: f64| convert(speed, "rad/s", "rpm");
        let lines = heard.lines.iter().map(|line| {
            json!({
                "frequency [Hz]": line.frequency,
                "amplitude": line.amplitude,
                "level [dB]": line.level,
                "origin": name(line.origin),
            })
        });
        let speeds = self.suggestions.iter().map(|suggestion| rpm(suggestion.spindle_speed));
        let mut found = json!({
            "schema": 1,
            "speed_true [rpm]": rpm(heard.spindle_speed),
            "chatter": match heard.chatter {
                Chatter::Yes => "yes",
                Chatter::No => "no",
                Chatter::Ambiguous => "ambiguous",
            },
            "chatter_frequency [Hz]": heard.chatter_frequency,
            "possible_frequencies [Hz]": heard.possible_frequencies,
            "onset [s]": heard.onset,
            "suggested_speeds [rpm]": speeds.collect::<Vec<_>>(),
            "lines": lines.collect::<Vec<_>>(),
            "notes": heard.notes,
        });
        if self.suggestions.iter().any(|suggestion| suggestion.limit.is_some()) {
            let limits = self.suggestions.iter().map(|suggestion| match &suggestion.limit {
                Some(Ok(Some(limit))) => json!(limit * 1e3),
                Some(Ok(None) | Err(_)) | None => Value::Null,
            });
            found["limits [mm]"] = limits.collect();
        }
        found
    }
}

/// Where a line comes from, in words.
fn name(origin: Origin) -> String {
    match origin {
        Origin::Tooth(order) => format!("tooth {order}"),
        Origin::Spindle(order) => format!("spindle {order}"),
        Origin::Mains => "mains".to_owned(),
        Origin::Machine => "machine".to_owned(),
        Origin::Folded(order) => format!("tooth {order}, folded"),
        Origin::Chatter(0) => "chatter".to_owned(),
        Origin::Chatter(order) => format!("chatter {order:+} tooth"),
        Origin::Unknown => "unknown".to_owned(),
    }
}
