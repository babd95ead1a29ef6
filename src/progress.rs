//! How far long work is.

use crate::speak::Voice;
use toolroom_study::study::Progress;

/// A bar, or where none is drawn a line about the time to come.
pub struct Bar(toolroom_output::Bar, Voice);

impl Bar {
    /// Of runs.
    pub fn new(voice: &Voice) -> Self {
        Self::of(voice, "runs")
    }

    /// Of what is counted, in the plural.
    pub fn of(voice: &Voice, what: &'static str) -> Self {
        Self(toolroom_output::Bar::new(what, voice.progress()), *voice)
    }

    pub fn at(&self, progress: Progress) {
        self.part(progress.done, progress.total);
    }

    /// So much of the whole is done.
    pub fn part(&self, done: u32, total: u32) {
        self.0.at(done, total).into_iter().for_each(|line| self.1.say(line));
    }

    pub fn finish(&self) {
        self.0.finish();
    }
}
