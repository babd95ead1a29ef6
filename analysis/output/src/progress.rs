//! How far long work is: a bar on a terminal after the first second, elsewhere one line that says how long it will take. Work
//! whose amount nobody knows beforehand shows on a terminal how long it has taken.

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Time over which the pace is measured before it is said how long the work will take (assumption).
const MEASURED: Duration = Duration::from_secs(5);
/// Least time to come that is worth a line (assumption: nobody plans by less).
const LONG: Duration = Duration::from_secs(60);
/// Time after which a bar is drawn.
const PATIENCE: Duration = Duration::from_secs(1);
/// Silence after which work without a bar shows that it goes on.
const SILENCE: Duration = Duration::from_secs(2);

/// A bar of work that is counted.
#[derive(Debug)]
pub struct Bar {
    bar: ProgressBar,
    what: &'static str,
    wanted: bool,
    start: Instant,
    shown: OnceLock<Counted>,
    /// When the first report came, and what was done by then: what was kept of earlier work took no time.
    first: OnceLock<(Instant, u32)>,
    announced: OnceLock<()>,
}

impl Bar {
    /// Of what is counted, in the plural; drawn where it is `wanted`.
    pub fn new(what: &'static str, wanted: bool) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let template = format!("{{bar:30}} {{pos}}/{{len}} {what}  {{pace}}  {{eta}} left");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            let pace = |state: &ProgressState, out: &mut dyn Write| {
                let _ = write!(out, "{}", pace(state.per_sec()));
            };
            bar.set_style(style.with_key("pace", pace));
        }
        let (shown, first, announced) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
        Self { bar, what, wanted, start: Instant::now(), shown, first, announced }
    }

    /// Takes how much is done; a line to be said, once, where the bar is not drawn and there is much to come.
    pub fn at(&self, done: u32, total: u32) -> Option<String> {
        if self.wanted && self.start.elapsed() > PATIENCE {
            self.shown.get_or_init(|| {
                let counted = Counted::begin();
                self.bar.set_draw_target(ProgressDrawTarget::stderr());
                counted
            });
        }
        self.bar.set_length(u64::from(total));
        self.bar.set_position(u64::from(done));
        let (first, known) = *self.first.get_or_init(|| (Instant::now(), done));
        let left = left(first.elapsed(), done.saturating_sub(known), total.saturating_sub(done));
        let left = left.filter(|_| !self.wanted && self.announced.set(()).is_ok())?;
        Some(format!("about {} to go: {done} of {total} {} are done", HumanDuration(left), self.what))
    }

    /// The work has ended.
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
fn left(elapsed: Duration, done: u32, to_come: u32) -> Option<Duration> {
    if done == 0 || elapsed < MEASURED {
        return None;
    }
    let left = elapsed.mul_f64(f64::from(to_come) / f64::from(done));
    (left >= LONG).then_some(left)
}

/// What is shown where nothing is counted.
static SILENT: Mutex<Silent> = Mutex::new(Silent { since: None, begun: None, spinner: None, bars: 0 });

struct Silent {
    /// When something was last said.
    since: Option<Instant>,
    begun: Option<Instant>,
    spinner: Option<ProgressBar>,
    /// Bars on the screen.
    bars: u32,
}

impl Silent {
    fn locked() -> MutexGuard<'static, Self> {
        // A thread that panicked leaves what can be read.
        SILENT.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn clear(&mut self) {
        self.since = self.since.map(|_| Instant::now());
        if let Some(spinner) = self.spinner.take() {
            spinner.finish_and_clear();
        }
    }

    /// Draws the time that the work has taken where nothing was said for long and no bar tells it.
    fn look(&mut self) {
        let silent = self.since.is_some_and(|since| since.elapsed() >= SILENCE);
        if !silent || self.bars > 0 || self.spinner.is_some() {
            return;
        }
        let spinner = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        let begun = self.begun.map_or(Duration::ZERO, |begun| begun.elapsed());
        if let Ok(style) = ProgressStyle::with_template("{spinner} working for {elapsed}") {
            spinner.set_style(style);
        }
        let spinner = spinner.with_elapsed(begun);
        spinner.enable_steady_tick(Duration::from_millis(200));
        self.spinner = Some(spinner);
    }
}

/// A bar on the screen, as long as it is there.
#[derive(Debug)]
struct Counted(());

impl Counted {
    fn begin() -> Self {
        let mut silent = Silent::locked();
        silent.clear();
        silent.bars += 1;
        Self(())
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        let mut silent = Silent::locked();
        silent.bars = silent.bars.saturating_sub(1);
        silent.clear();
    }
}

/// From now on work that says nothing for two seconds and counts nothing shows the time that it has taken, on the terminal
/// of standard error, where that is `wanted`.
pub fn watch_silence(wanted: bool) {
    if !wanted {
        return;
    }
    let now = Instant::now();
    let mut silent = Silent::locked();
    (silent.since, silent.begun) = (Some(now), Some(now));
    drop(silent);
    let look = || {
        loop {
            std::thread::sleep(Duration::from_millis(250));
            Silent::locked().look();
        }
    };
    // Without the thread nothing is shown, and the work is the same.
    let _ = std::thread::Builder::new().name("silence".to_owned()).spawn(look);
}

/// Takes what is shown off the screen, because something is going to be written there.
pub fn clear() {
    Silent::locked().clear();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_to_come_follows_from_the_pace_and_is_said_where_it_is_long() {
        let seconds = Duration::from_secs;
        // 10 runs in 20 s, 400 left.
        assert_eq!(left(seconds(20), 10, 400), Some(seconds(800)));
        assert_eq!(left(seconds(4), 10, 430), None, "too early");
        assert_eq!(left(seconds(20), 0, 410), None, "nothing was done but what was kept");
        assert_eq!(left(seconds(20), 10, 10), None, "20 s are no news");
        assert_eq!([pace(2.7528), pace(27.4), pace(0.05)], ["2.8/s", "27/s", "3.0/min"]);
    }

    #[test]
    fn the_time_is_shown_in_silence_only_and_not_beside_a_bar() {
        let mut silent = Silent { since: None, begun: None, spinner: None, bars: 0 };
        silent.look();
        assert!(silent.spinner.is_none(), "nobody watches");
        silent.since = Instant::now().checked_sub(SILENCE);
        silent.bars = 1;
        silent.look();
        assert!(silent.spinner.is_none(), "a bar tells it");
        silent.bars = 0;
        silent.look();
        assert!(silent.spinner.is_some());
        silent.clear();
        silent.look();
        assert!(silent.spinner.is_none(), "something was just said");
    }
}
