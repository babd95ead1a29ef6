//! All that is worked out of one part program.

use super::{CycleTime, drawing};
use crate::engagement::Engagement;
use crate::explain::Explanation;
use crate::feeds::{FeedRequest, Feeds};
use crate::motions::motion_table;
use serde_json::Value;
use toolroom_drives::Drives;
use toolroom_post::{Drawing, Form, Post, post};
use toolroom_program::{Control, ProgramError, Source};
use toolroom_stock::{FollowError, Setup};

/// A part program and the machine that runs it.
#[derive(Clone, Debug)]
pub struct ProgramOnMachine {
    /// The program.
    pub source: Source,
    /// How its words are read.
    pub control: Control,
    /// How the axes follow.
    pub drives: Drives,
    /// Stock and tools, where they are known.
    pub setup: Option<Setup>,
}

/// What is asked of it beside its time.
#[derive(Clone, Debug, Default)]
pub struct ProgramRequest {
    /// A row for every block.
    pub blocks: bool,
    /// A row for every motion.
    pub motions: bool,
    /// The line, from 1, that is explained.
    pub explain: Option<usize>,
    /// Use of the limits, and feeds that keep them.
    pub feeds: Option<FeedRequest>,
}

/// A part program with its time, and what else was asked.
#[derive(Clone, Debug)]
pub struct ProgramStudy {
    /// What was studied.
    pub of: ProgramOnMachine,
    /// Its nominal time.
    pub cycle: CycleTime,
    /// What it does to the stock.
    pub engagement: Option<Engagement>,
    /// Its use of limits, and planned feeds.
    pub feeds: Option<Feeds>,
    explanation: Option<Explanation>,
}

impl ProgramStudy {
    /// How often `progress` is called.
    const STEPS: u32 = 4;

    /// Works out what is asked. `progress` is told the steps that are done and how many there are; the last one is writing.
    ///
    /// # Errors
    /// [`FollowError`]: the program is refused, or cuts with a tool that the setup does not have.
    pub fn new(
        of: ProgramOnMachine,
        request: &ProgramRequest,
        progress: &dyn Fn(u32, u32),
    ) -> Result<Self, FollowError> {
        let ProgramOnMachine { source, control, drives, setup } = &of;
        let cycle = CycleTime::new(source.clone(), control, drives, request.blocks)?;
        progress(1, Self::STEPS);
        let explain = |line| Explanation::new(source, control, drives, line);
        let explanation = request.explain.map(explain).transpose()?;
        let timed = request.motions.then_some(drives);
        let follow = |setup: &Setup| Engagement::new(source.clone(), control, setup, timed);
        let engagement = setup.as_ref().map(follow).transpose()?;
        progress(2, Self::STEPS);
        let plan = |(setup, asked)| Feeds::new(source, control, drives, setup, asked);
        let feeds = setup.as_ref().zip(request.feeds.as_ref()).map(plan).transpose()?;
        progress(3, Self::STEPS);
        Ok(Self { cycle, engagement, feeds, explanation, of })
    }

    /// A table of its motions as CSV, with loads where a setup is known.
    ///
    /// # Errors
    /// [`ProgramError`]: the program is refused.
    pub fn motions(&self) -> Result<String, ProgramError> {
        let of = &self.of;
        self.engagement
            .as_ref()
            .map_or_else(|| motion_table(&of.source, &of.control, &of.drives), |followed| Ok(followed.table()))
    }

    /// Its path as a drawing.
    ///
    /// # Errors
    /// [`ProgramError`]: the program is refused.
    pub fn drawing(&self) -> Result<Drawing, ProgramError> {
        drawing(&self.of.source, &self.of.control)
    }

    /// The program for another control, with the planned feeds where there are some.
    ///
    /// # Errors
    /// [`ProgramError`]: a word that the form cannot say.
    pub fn post(&self, form: Form) -> Result<Post, ProgramError> {
        let (source, control) = (self.of.source.clone(), &self.of.control);
        match &self.feeds {
            Some(feeds) => feeds.post(source, control, form),
            None => post(source, control, form),
        }
    }

    /// All that was worked out, as JSON.
    pub fn json(&self) -> Value {
        let mut result = self.cycle.json();
        if let Some(engagement) = &self.engagement {
            result["engagement"] = engagement.json();
        }
        if let Some(feeds) = &self.feeds {
            let mut of_feeds = feeds.json();
            result["engagement"]["limits"] = of_feeds["limits"].take();
            result["planned"] = of_feeds["planned"].take();
        }
        if let Some(explanation) = &self.explanation {
            result["explained"] = explanation.json();
        }
        result
    }

    /// The same as tables to read, one after the other.
    pub fn texts(&self) -> Vec<String> {
        let followed = self.engagement.as_ref().map(Engagement::text);
        let planned = self.feeds.as_ref().map(Feeds::text);
        let explained = self.explanation.as_ref().map(Explanation::text);
        [Some(self.cycle.text()), followed, planned, explained].into_iter().flatten().collect()
    }

    /// The first thing that must not happen on a machine, with its line: a limit that is exceeded, a crash, a plunge of a tool that cannot, a
    /// gouge.
    pub fn fault(&self) -> Option<(usize, String)> {
        if let Some((limit, ratio, line)) = self.feeds.iter().flat_map(Feeds::broken).next() {
            return Some((line, format!("{} is {ratio:.2} times what is allowed", limit.word())));
        }
        let engagement = self.engagement.as_ref()?;
        let faults = [
            (engagement.crashes().first(), "a rapid motion meets material"),
            (engagement.holders().first(), "the holder of the tool meets material"),
            (engagement.hollow_plunges().first(), "a tool that does not cut at its centre plunges"),
            (engagement.gouges().first().map(|(line, _)| line), "the motion cuts into the part"),
        ];
        faults.into_iter().find_map(|(line, fault)| Some((*line?, fault.to_owned())))
    }
}
