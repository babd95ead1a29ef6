//! How far long work is: a bar on a terminal after the first second, elsewhere one line that says how long it will take.

use crate::speak::Voice;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::sync::OnceLock;
use std::time::{Duration, Instant};
use toolroom_study::study::Progress;

/// Time over which the pace is measured before it is said how long the work will take (assumption).
const MEASURED: Duration = Duration::from_secs(5);
/// Least time to come that is worth a line (assumption: nobody plans by less).
const LONG: Duration = Duration::from_secs(60);

pub struct Bar {
    bar: ProgressBar,
    what: &'static str,
    start: Instant,
    voice: Voice,
    shown: OnceLock<()>,
    /// When the first report came, and what was done by then: what was kept of earlier work took no time.
    first: OnceLock<(Instant, u32)>,
    announced: OnceLock<()>,
}

impl Bar {
    /// Of runs.
    pub fn new(voice: &Voice) -> Self {
        Self::of(voice, "runs")
    }

    /// Of what is counted, in the plural.
    pub fn of(voice: &Voice, what: &'static str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let template = format!("{{bar:30}} {{pos}}/{{len}} {what}  {{pace}}  {{eta}} left");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            let pace = |state: &ProgressState, out: &mut dyn Write| {
                let _ = write!(out, "{}", pace(state.per_sec()));
            };
            bar.set_style(style.with_key("pace", pace));
        }
        let [shown, announced] = [OnceLock::new(), OnceLock::new()];
        Self { bar, what, start: Instant::now(), voice: *voice, shown, first: OnceLock::new(), announced }
    }

    pub fn at(&self, progress: Progress) {
        let wanted = self.voice.progress();
        if wanted && self.start.elapsed() > Duration::from_secs(1) {
            self.shown.get_or_init(|| self.bar.set_draw_target(ProgressDrawTarget::stderr()));
        }
        self.bar.set_length(u64::from(progress.total));
        self.bar.set_position(u64::from(progress.done));
        let (first, known) = *self.first.get_or_init(|| (Instant::now(), progress.done));
        if !wanted && let Some(left) = left(first.elapsed(), progress.done.saturating_sub(known), progress) {
            self.announced.get_or_init(|| {
                let Progress { done, total } = progress;
                self.voice.say(format_args!(
                    "about {} to go: {done} of {total} {} are done",
                    HumanDuration(left),
                    self.what
                ));
            });
        }
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Runs per second, or per minute where they are fewer.
fn pace(per_second: f64) -> String {
    let (count, unit) = if per_second < 1.0 { (60.0 * per_second, "min") } else { (per_second, "s") };
    let digits = if count < 10.0 { 1 } else { 0 };
    format!("{count:.digits$}/{unit}")
}

/// The time to come at the pace of `done` runs in `elapsed`, where that is known and long enough to be said.
fn left(elapsed: Duration, done: u32, progress: Progress) -> Option<Duration> {
    if done == 0 || elapsed < MEASURED {
        return None;
    }
    let left = elapsed.mul_f64(f64::from(progress.total.saturating_sub(progress.done)) / f64::from(done));
    (left >= LONG).then_some(left)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_to_come_follows_from_the_pace_and_is_said_where_it_is_long() {
        let at = |done, total| Progress { done, total };
        let seconds = Duration::from_secs;
        // 10 runs in 20 s, 400 left.
        assert_eq!(left(seconds(20), 10, at(40, 440)), Some(seconds(800)));
        assert_eq!(left(seconds(4), 10, at(10, 440)), None, "too early");
        assert_eq!(left(seconds(20), 0, at(30, 440)), None, "nothing was done but what was kept");
        assert_eq!(left(seconds(20), 10, at(10, 20)), None, "20 s are no news");
        assert_eq!([pace(2.7528), pace(27.4), pace(0.05)], ["2.8/s", "27/s", "3.0/min"]);
    }
}
