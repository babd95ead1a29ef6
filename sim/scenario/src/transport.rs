//! Crews that repair, and vehicles that carry jobs between places.

use toolroom_form::vocabulary;

/// People who repair; the first breakdown that waits goes first.
#[derive(Clone, Debug, PartialEq)]
pub struct Crew {
    /// Name, unique.
    pub name: String,
    /// Repairs at once.
    pub count: u32,
    /// Index into [`Scenario::calendars`](super::Scenario::calendars) of when they begin repairs; `None`: always.
    pub calendar: Option<usize>,
    /// Cost of an hour of the calendar for each of them, currency per second.
    pub rate: f64,
}

/// Vehicles of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Transport {
    /// Name, unique.
    pub name: String,
    /// Number of vehicles.
    pub count: u32,
    /// Places between which they drive; the first is where they stand at the start.
    pub locations: Vec<String>,
    /// Time of the way from the place of the row to that of the column, s.
    pub times: Vec<Vec<f64>>,
    /// Where a vehicle waits.
    pub park: Parking,
    /// Which job goes next.
    pub rule: TransportRule,
    /// Most jobs that a vehicle carries at once, all of one way.
    pub capacity: u32,
}

impl Transport {
    /// Number of a place.
    pub fn location(&self, name: &str) -> Option<usize> {
        self.locations.iter().position(|own| own == name)
    }
}

vocabulary! {
    /// Where a vehicle waits for its next job.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Parking {
        /// Where it has unloaded.
        Stay = "stay",
        /// At the first of its places, to which it drives where no job waits.
        Home = "home",
    }
}

vocabulary! {
    /// Which of several jobs a free vehicle takes.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum TransportRule {
        /// The one that has waited for longest.
        Fifo = "fifo",
        /// The one that it reaches first.
        Nearest = "nearest",
    }
}
