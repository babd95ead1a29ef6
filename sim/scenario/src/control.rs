//! How work is let into a shop and chosen in it: cards, release, what the keys of dispatching rules are made of.

use super::{DispatchRule, Distribution, Schedule};
use toolroom_form::vocabulary;

/// What controls the flow of work beside the rules of queues.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Control {
    /// Loops of cards.
    pub loops: Vec<CardLoop>,
    /// When jobs that have come are let into the shop.
    pub release: ReleaseRule,
    /// What the keys of the rules of queues are made of.
    pub keys: KeyOptions,
    /// When it is settled which machine does an operation.
    pub assign: Assignment,
    /// Which queue a job joins, with [`Assignment::AtArrival`].
    pub queue_choice: QueueChoice,
    /// The schedule that machines follow in the place of their rules; `None`: they go by their rules.
    pub schedule: Option<Schedule>,
}

/// A limited number of jobs between two stations: CONWIP over several of them, kanban over one.
///
/// A job, or all of an order, takes a card before its first operation in the loop and returns it when it has left the last
/// one. Who waits for a card stands in the backlog of the loop.
///
/// # Source
/// M. L. Spearman, D. L. Woodruff, W. J. Hopp, International Journal of Production Research 28 (1990) 879.
#[derive(Clone, Debug, PartialEq)]
pub struct CardLoop {
    /// Name, unique.
    pub name: String,
    /// Cards.
    pub cards: u32,
    /// Rules of the backlog; empty: those of the shop.
    pub rules: Vec<DispatchRule>,
    /// First and last operation in the loop, by part; `None` for parts that do not pass it.
    pub spans: Vec<Option<(usize, usize)>>,
}

/// Most loops of one shop: a set of loops is the bits of a word.
pub const MOST_LOOPS: usize = 64;

/// When jobs that have come are let into the shop.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum ReleaseRule {
    /// At once.
    #[default]
    Immediate,
    /// This time before they are due, s.
    AtDate {
        /// Time from the release to the due date, s.
        lead: f64,
    },
    /// When the corrected aggregate load of no station on their routing would go beyond a norm: of each operation that is not
    /// done yet its time over its place in the routing.
    ///
    /// # Source
    /// B. Oosterman, M. Land, G. Gaalman, International Journal of Production Economics 68 (2000) 107.
    Workload {
        /// Greatest load of a station for each of its machines, s.
        norm: f64,
        /// Time between decisions, s.
        every: f64,
        /// In which order jobs are looked at.
        sequence: Vec<DispatchRule>,
    },
}

/// What the keys of dispatching rules are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyOptions {
    /// Look-ahead of `atc`, in mean processing times.
    pub atc_k: f64,
    /// Look-ahead of `atcs` for slack, in mean processing times, and for setups, in mean setups.
    pub atcs_k: [f64; 2],
    /// Expected waiting time of `covert` over the work left, and the share of slack over it in which the cost falls to nothing.
    pub covert_kb: [f64; 2],
    /// Which times of plain work rules know.
    pub time: KeyTime,
    /// Whether the setup that a machine would need is part of the time of the operation.
    pub setup: bool,
    /// Of what `atc`, `atcs` and `covert` take the slack.
    pub slack_by: SlackBy,
    /// What counts as work in the next queue.
    pub next_queue: NextQueue,
}

impl KeyOptions {
    /// Look-ahead of `atc`, in mean processing times.
    ///
    /// # Source
    /// A. P. J. Vepsalainen, T. E. Morton, Management Science 33 (1987) 1035.
    pub const ATC_K: f64 = 3.0;
    /// Look-aheads of `atcs`: that of `atc`, and one mean setup (assumption: Lee, Bhaskaran and Pinedo fit both to the shop).
    pub const ATCS_K: [f64; 2] = [3.0, 1.0];
    /// Waiting time and look-ahead of `covert`.
    ///
    /// # Source
    /// A. P. J. Vepsalainen, T. E. Morton, Management Science 33 (1987) 1035.
    pub const COVERT_KB: [f64; 2] = [2.0, 2.0];

    /// Whether keys of a rule are those of the default options, for which queues have faster ways than looking at all jobs.
    pub fn are_usual_for(&self, rule: DispatchRule) -> bool {
        let usual = Self::default();
        let by_job = self.slack_by == SlackBy::Job;
        let constants = (rule != DispatchRule::Atc || by_job && self.atc_k == usual.atc_k)
            && (rule != DispatchRule::Covert || by_job && self.covert_kb == usual.covert_kb);
        constants && rule != DispatchRule::AtcWithSetups && !(self.setup && rule.looks_at_time())
    }
}

impl Default for KeyOptions {
    fn default() -> Self {
        let (atc_k, atcs_k, covert_kb) = (Self::ATC_K, Self::ATCS_K, Self::COVERT_KB);
        let (time, slack_by, next_queue) = (KeyTime::Drawn, SlackBy::Job, NextQueue::Waiting);
        Self { atc_k, atcs_k, covert_kb, time, setup: false, slack_by, next_queue }
    }
}

vocabulary! {
    /// Which times of plain work the rules of queues know.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum KeyTime {
        /// Those that were drawn, as rules of the literature do.
        #[default]
        Drawn = "drawn",
        /// The means of their distributions, as a planner does.
        Expected = "expected",
    }
}

vocabulary! {
    /// Of what `atc`, `atcs` and `covert` take the slack.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum SlackBy {
        /// Of the job: its due date and all work left.
        #[default]
        Job = "job",
        /// Of the operation: when it is due, and its time.
        Operation = "operation",
    }
}

vocabulary! {
    /// What counts as the work W in the next queue, at which `winq`, `pt_winq`, `pt_winq_npt` and `pt_winq_sl` look.
    ///
    /// # Source
    /// Waiting jobs alone: O. Holthaus, C. Rajendran, International Journal of Production Economics 48 (1997) 87. With what is
    /// left of started work: the simulator jasima (`WorkStation.workContent`), after R. Haupt, OR Spektrum 11 (1989) 3.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum NextQueue {
        /// The operations that wait.
        #[default]
        Waiting = "waiting",
        /// These and what is left of the operations in work.
        Started = "started",
    }
}

vocabulary! {
    /// When it is settled which of several machines does an operation.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Assignment {
        /// When one of them takes it: they have one queue together.
        #[default]
        AtStart = "at_start",
        /// When the job comes: each has its own queue.
        AtArrival = "at_arrival",
    }
}

vocabulary! {
    /// Which of the queues of an operation a job joins; ties go to the first machine of the file.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum QueueChoice {
        /// The one with the fewest jobs, that in work included.
        #[default]
        ShortestQueue = "shortest_queue",
        /// The one with the least work, what is left of the operation in work included.
        LeastWork = "least_work",
    }
}

/// When jobs of a source are due.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum DueRule {
    /// The part's allowance after they came.
    #[default]
    Allowance,
    /// A multiple of their total work after they came.
    TotalWork {
        /// The multiple.
        k: f64,
    },
    /// Their total work and a constant slack after they came.
    Slack {
        /// The slack, s.
        slack: f64,
    },
    /// A time after they came that is drawn for each of them.
    Random(Distribution),
}
