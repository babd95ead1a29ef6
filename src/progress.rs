//! A progress bar on standard error: only on a terminal, only after the first second.

use crate::speak::Voice;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::OnceLock;
use std::time::{Duration, Instant};
use toolroom_study::study::Progress;

pub struct Bar {
    bar: ProgressBar,
    start: Instant,
    wanted: bool,
    shown: OnceLock<()>,
}

impl Bar {
    pub fn new(voice: &Voice) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} runs  {per_sec}  {eta} left") {
            bar.set_style(style);
        }
        Self { bar, start: Instant::now(), wanted: voice.progress(), shown: OnceLock::new() }
    }

    pub fn at(&self, progress: Progress) {
        if self.wanted && self.start.elapsed() > Duration::from_secs(1) {
            self.shown.get_or_init(|| self.bar.set_draw_target(ProgressDrawTarget::stderr()));
        }
        self.bar.set_length(u64::from(progress.total));
        self.bar.set_position(u64::from(progress.done));
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
