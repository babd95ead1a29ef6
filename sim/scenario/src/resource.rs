//! People, and what a change from one setup group to another takes.

/// A person who attends to machines.
#[derive(Clone, Debug, PartialEq)]
pub struct Operator {
    /// Name, unique.
    pub name: String,
    /// What the person can do, by index into [`Scenario::skills`](super::Scenario::skills).
    pub skills: Vec<usize>,
    /// Index into [`Scenario::calendars`](super::Scenario::calendars); `None`: always there.
    pub calendar: Option<usize>,
}

/// Skills that the steps of an operation need, by index; a step without one runs by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Attendance {
    /// Changing over.
    pub setup: Option<usize>,
    /// Loading and unloading.
    pub load: Option<usize>,
    /// All that comes between them, from its beginning to its end.
    pub run: Option<usize>,
}

/// Times of changing over from one setup group to another.
#[derive(Clone, Debug, PartialEq)]
pub struct SetupMatrix {
    /// Name, unique.
    pub name: String,
    /// Setup groups, of rows and columns.
    pub groups: Vec<String>,
    /// To every group from a machine that was never set up, s; `None` where no row says it.
    pub first: Option<Vec<f64>>,
    /// From the group of the row to that of the column, s.
    pub times: Vec<Vec<f64>>,
}

impl SetupMatrix {
    /// Number of a group.
    pub fn group(&self, name: &str) -> Option<usize> {
        self.groups.iter().position(|group| group == name)
    }
}
