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
    /// Cost of an hour of the calendar, currency per second.
    pub rate: f64,
    /// How long the person walks from machine to machine; `None`: no time.
    pub walk: Option<Ways>,
}

/// Times of the ways between places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ways {
    /// Places, by [`MachineType::location`](super::MachineType::location); the first is where one stands at the start.
    pub locations: Vec<String>,
    /// Time of the way from the place of the row to that of the column, s.
    pub times: Vec<Vec<f64>>,
}

impl Ways {
    /// Number of a place.
    pub fn location(&self, name: &str) -> Option<usize> {
        self.locations.iter().position(|own| own == name)
    }
}

/// Skills that the steps of an operation need, by index; a step without one runs by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attendance {
    /// Changing over.
    pub setup: Option<usize>,
    /// Loading and unloading.
    pub load: Option<usize>,
    /// All that comes between them, from its beginning to its end.
    pub run: Option<usize>,
    /// How much of a person that takes.
    pub presence: Presence,
}

/// How much of a person the run of an operation takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Presence {
    /// All of one, from its beginning to its end.
    #[default]
    Whole,
    /// This share of one, who tends as many machines at once as fit, 0 to 1.
    Share(f64),
    /// All of one for the first time of each piece, s; then the machine goes on alone.
    First(f64),
}

impl Presence {
    /// Share of a person that it takes while somebody is there.
    pub fn share(self) -> f64 {
        match self {
            Self::Whole | Self::First(_) => 1.0,
            Self::Share(share) => share,
        }
    }
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
