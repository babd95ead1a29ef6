//! What the keys of an adapter mean.

/// What a key tells of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Whether the machine is connected.
    Availability,
    /// Execution state of the controller.
    Execution,
    /// Program that runs.
    Program,
    /// Tool in the spindle.
    Tool,
    /// Block or line of the program.
    Block,
    /// Feed override, %.
    FeedOverride,
    /// Rapid override, %.
    RapidOverride,
    /// Spindle override, %.
    SpindleOverride,
    /// Parts made.
    PartCount,
    /// Feed of the path as it is, in any unit.
    Feed,
}

impl Role {
    /// Every role with the words by which it is reported on the command line.
    pub const ALL: [(Self, &'static str); 10] = [
        (Self::Availability, "availability"),
        (Self::Execution, "execution"),
        (Self::Program, "program"),
        (Self::Tool, "tool"),
        (Self::Block, "block"),
        (Self::FeedOverride, "feed_override"),
        (Self::RapidOverride, "rapid_override"),
        (Self::SpindleOverride, "spindle_override"),
        (Self::PartCount, "part_count"),
        (Self::Feed, "feed"),
    ];

    /// The role called `word`.
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, name)| *name == word).map(|(role, _)| *role)
    }

    /// The role and the key of `ROLE=KEY`, as on the command line.
    ///
    /// # Errors
    /// [`RoleError`]: no role, or no key.
    pub fn assigned(text: &str) -> Result<(Self, String), RoleError> {
        let (word, key) = text.split_once('=').unwrap_or((text, ""));
        let role =
            Self::named(word).ok_or_else(|| RoleError::Unknown { text: text.to_owned(), word: word.to_owned() })?;
        if key.is_empty() { Err(RoleError::NoKey { text: text.to_owned() }) } else { Ok((role, key.to_owned())) }
    }
}

/// A text that assigns no key to a role.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RoleError {
    /// No role has the word.
    #[error("--key {text}: no role `{word}`")]
    Unknown {
        /// What was read.
        text: String,
        /// The word before the `=`.
        word: String,
    },
    /// Nothing stands behind the `=`.
    #[error("--key {text} names no key")]
    NoKey {
        /// What was read.
        text: String,
    },
}

impl RoleError {
    /// The likely fix.
    pub fn fix(&self) -> String {
        match self {
            Self::Unknown { .. } => format!("roles are {}", Role::ALL.map(|(_, name)| name).join(", ")),
            Self::NoKey { .. } => "write --key ROLE=KEY".to_owned(),
        }
    }
}

/// Names that adapters give to a role, in lower case without separators and without a path prefix;
/// where several are logged the first of a list is used. The names are those of the MTConnect
/// device files of the NIST test bed and of the agent's demonstrations.
const NAMES: [(Role, &[&str]); 10] = [
    (Role::Availability, &["avail", "availability"]),
    (Role::Execution, &["execution", "exec", "programstatus"]),
    (Role::Program, &["program", "programname", "programnamerunning", "activeprog"]),
    (Role::Tool, &["currenttool", "toolid", "toolnumber", "toolnum", "tool"]),
    (Role::Block, &["blocknumber", "linenumber", "line", "unitnum"]),
    (Role::FeedOverride, &["fovr", "feedoverride", "feedovr", "pathfeedrateovr"]),
    (Role::RapidOverride, &["rovr", "frapidovr", "rapidoverride", "rapidovr"]),
    (Role::SpindleOverride, &["s1ovr", "sovr", "spindleoverride", "spindleovr"]),
    (Role::PartCount, &["partcountact", "partcount"]),
    (Role::Feed, &["feedrate", "pathfeedrate", "fact", "frtactual"]),
];

/// Rank of a key for each role that it may have: smaller is better.
pub(super) fn roles(key: &str) -> impl Iterator<Item = (Role, usize)> + '_ {
    // `device:key` names the machine too.
    let plain = key.rsplit(':').next().unwrap_or(key).to_ascii_lowercase().replace(['_', '-', ' ', '.'], "");
    // Path data items are numbered: p1Fact, pexecution, P1PartCount.
    let path = plain.strip_prefix('p').map(|rest| rest.trim_start_matches(|sign: char| sign.is_ascii_digit()));
    let path = path.map(str::to_owned);
    NAMES.iter().filter_map(move |(role, names)| {
        let rank = |word: &str| names.iter().position(|name| *name == word);
        rank(&plain).or_else(|| path.as_deref().and_then(rank)).map(|rank| (*role, rank))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn role(key: &str) -> Option<Role> {
        roles(key).next().map(|(role, _)| role)
    }

    #[test]
    fn names_of_known_adapters_are_understood() {
        assert_eq!(role("Program_Status"), Some(Role::Execution));
        assert_eq!(role("pexecution"), Some(Role::Execution));
        assert_eq!(role("p1CurrentTool"), Some(Role::Tool));
        assert_eq!(role("mazak:Fovr"), Some(Role::FeedOverride));
        assert_eq!(role("program"), Some(Role::Program));
        assert_eq!(role("PartCountAct"), Some(Role::PartCount));
        assert_eq!(role("X1load"), None);
        assert_eq!(role("Program_Name_Editing"), None);
    }
}
