//! Rules of queues.

use toolroom_form::vocabulary;

vocabulary! {
    /// Which waiting job a free machine takes: the one with the least key; ties by arrival at the queue, then
    /// job number.
    ///
    /// Keys are made of t, the time; p, the time of the operation; R, that of this and all later
    /// operations; m, their number; d, when the job is due; o, when the operation is due (the allowance
    /// divided in proportion to work); s, the setup that the machine would need; w, the weight of its order; W, the time of all operations that wait for the machines of the next
    /// one. Times are those drawn for plain work and the programmed ones of passes, with mean handling on
    /// the first machine and without setup.
    ///
    /// # Source
    /// O. Holthaus, C. Rajendran, International Journal of Production Economics 48 (1997) 87;
    /// A. P. J. Vepsalainen, T. E. Morton, Management Science 33 (1987) 1035; `atcs`: Y. H. Lee, K. Bhaskaran, M. Pinedo,
    /// IIE Transactions 29 (1997) 45.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum DispatchRule {
        /// First in, first out.
        Fifo = "fifo",
        /// Last in, first out.
        Lifo = "lifo",
        /// In random order.
        Random = "random",
        /// First released to the shop.
        FirstReleased = "fasfs",
        /// Most urgent order: least priority.
        Priority = "priority",
        /// Shortest processing time p.
        ShortestProcessingTime = "spt",
        /// Weighted shortest processing time p/w.
        WeightedShortestTime = "wspt",
        /// Longest processing time p.
        LongestProcessingTime = "lpt",
        /// Shortest remaining processing time R.
        ShortestRemaining = "srpt",
        /// Longest remaining processing time R.
        LongestRemaining = "lrpt",
        /// Earliest due date d.
        EarliestDueDate = "edd",
        /// Earliest operation due date o.
        EarliestOperationDue = "odd",
        /// Least slack d - t - R.
        Slack = "slack",
        /// Fewest operations left.
        FewestOperations = "fewest_operations",
        /// Most operations left.
        MostOperations = "most_operations",
        /// Least slack per operation, (d - t - R)/m.
        SlackPerOperation = "s_ro",
        /// Least critical ratio (d - t)/R.
        CriticalRatio = "cr",
        /// Least modified due date max(t + R, d).
        ModifiedDueDate = "mdd",
        /// Least modified operation due date max(t + p, o).
        ModifiedOperationDue = "mod",
        /// Least work in the next queue, W.
        WorkInNextQueue = "winq",
        /// Least p + W.
        TimeAndNextQueue = "pt_winq",
        /// Least 2 p + W + p of the next operation.
        TimesAndNextQueue = "pt_winq_npt",
        /// Least p + W + min(d - t - R, 0).
        TimeNextQueueAndSlack = "pt_winq_sl",
        /// Greatest apparent tardiness cost w exp(-max(0, d - t - R)/(3 mean p of the queue))/p.
        Atc = "atc",
        /// Greatest cost over time w max(0, 1 - max(0, d - t - R)/(4 R))/p.
        Covert = "covert",
        /// The same with setups: w exp(-max(0, d - t - R)/(k1 mean p of the queue)) exp(-s/(k2 mean s of the queue))/p.
        AtcWithSetups = "atcs",
        /// Least setup of the machine.
        LeastSetup = "least_setup",
    }
}

/// Most rules of one queue, each deciding where the ones before are equal.
pub const MOST_RULES: usize = 3;

impl DispatchRule {
    /// Other words for some of the rules.
    const LONG: [(&'static str, Self); 5] = [
        ("shortest_processing_time", Self::ShortestProcessingTime),
        ("earliest_due_date", Self::EarliestDueDate),
        ("critical_ratio", Self::CriticalRatio),
        ("sst", Self::LeastSetup),
        ("mwkr", Self::LongestRemaining),
    ];

    /// All words in files.
    pub const NAMES: &'static [&'static str] = &{
        let mut names = [""; Self::WORDS.len() + Self::LONG.len()];
        let mut i = 0;
        while i < names.len() {
            names[i] = if i < Self::WORDS.len() { Self::WORDS[i] } else { Self::LONG[i - Self::WORDS.len()].0 };
            i += 1;
        }
        names
    };

    /// The rule of a word, short or long.
    ///
    /// # Examples
    /// ```
    /// use toolroom_scenario::DispatchRule;
    /// assert_eq!(DispatchRule::named("earliest_due_date"), DispatchRule::named("edd"));
    /// assert!(DispatchRule::NAMES.iter().all(|name| DispatchRule::named(name).is_some()));
    /// ```
    pub fn named(word: &str) -> Option<Self> {
        let long = Self::LONG.iter().find(|(long, _)| *long == word).map(|(_, rule)| *rule);
        long.or_else(|| Self::from_word(word))
    }

    /// Whether the order of two jobs stays as it is while both wait.
    pub fn stands(self) -> bool {
        match self {
            Self::Fifo
            | Self::Lifo
            | Self::Random
            | Self::FirstReleased
            | Self::Priority
            | Self::ShortestProcessingTime
            | Self::WeightedShortestTime
            | Self::LongestProcessingTime
            | Self::ShortestRemaining
            | Self::LongestRemaining
            | Self::EarliestDueDate
            | Self::EarliestOperationDue
            | Self::Slack
            | Self::FewestOperations
            | Self::MostOperations => true,
            Self::SlackPerOperation
            | Self::CriticalRatio
            | Self::ModifiedDueDate
            | Self::ModifiedOperationDue
            | Self::WorkInNextQueue
            | Self::TimeAndNextQueue
            | Self::TimesAndNextQueue
            | Self::TimeNextQueueAndSlack
            | Self::Atc
            | Self::Covert
            | Self::AtcWithSetups
            | Self::LeastSetup => false,
        }
    }

    /// Whether it looks at the time of the operation.
    pub fn looks_at_time(self) -> bool {
        match self {
            Self::ShortestProcessingTime
            | Self::WeightedShortestTime
            | Self::LongestProcessingTime
            | Self::ShortestRemaining
            | Self::LongestRemaining
            | Self::Slack
            | Self::SlackPerOperation
            | Self::CriticalRatio
            | Self::ModifiedDueDate
            | Self::ModifiedOperationDue
            | Self::TimeAndNextQueue
            | Self::TimesAndNextQueue
            | Self::TimeNextQueueAndSlack
            | Self::Atc
            | Self::AtcWithSetups
            | Self::Covert => true,
            Self::Fifo
            | Self::Lifo
            | Self::Random
            | Self::FirstReleased
            | Self::Priority
            | Self::EarliestDueDate
            | Self::EarliestOperationDue
            | Self::FewestOperations
            | Self::MostOperations
            | Self::WorkInNextQueue
            | Self::LeastSetup => false,
        }
    }

    /// Whether it looks at the work that waits for the next operation.
    pub fn looks_ahead(self) -> bool {
        matches!(
            self,
            Self::WorkInNextQueue | Self::TimeAndNextQueue | Self::TimesAndNextQueue | Self::TimeNextQueueAndSlack
        )
    }
}

vocabulary! {
    /// What becomes of plain work in a machine when a waiting job of strictly better priority needs that machine.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Preemption {
        /// It is finished first.
        #[default]
        None = "none",
        /// Its job waits again, and later needs what was left.
        Resume = "resume",
        /// Its job waits again, and later needs the same time once more.
        Repeat = "repeat",
        /// Its job is lost.
        Scrap = "scrap",
    }
}
