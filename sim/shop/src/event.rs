//! What the calendar of the shop holds.

use toolroom_kernel::Class;

/// One calendar event; everything it refers to is named by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The step that a machine is in ends.
    StepEnd {
        /// Machine.
        machine: u32,
    },
    /// A failure mode strikes.
    Failure {
        /// Index into the failures of the scenario.
        mode: u32,
    },
    /// A repair ends.
    Repair {
        /// Index into the failures of the scenario.
        mode: u32,
    },
    /// A source releases jobs.
    Arrival {
        /// Index into the arrivals of the scenario.
        source: u32,
    },
    /// An order enters the shop.
    Release {
        /// Index into the orders of the scenario.
        order: u32,
    },
    /// A job may have waited for too long for others of its batch.
    BatchDue {
        /// Machine.
        machine: u32,
    },
    /// It is time to look at the jobs that are not let in yet.
    Pool,
    /// A vehicle comes to where it drives.
    Delivery {
        /// Index into the transports of the scenario.
        transport: u16,
        /// Vehicle among those of its kind.
        vehicle: u16,
    },
    /// A vehicle comes to where jobs wait for it.
    PickUp {
        /// Index into the transports of the scenario.
        transport: u16,
        /// Vehicle among those of its kind.
        vehicle: u16,
    },
    /// A job has moved to where its next operation is done.
    Moved {
        /// Where the job is kept.
        slot: u32,
    },
    /// A lot that was ordered for a stock comes or is let in.
    Restock {
        /// Index into the stocks of the scenario.
        stock: u32,
    },
    /// Pieces begin anew for those of an order that were lost.
    MakeUp {
        /// Index into the orders of the scenario.
        order: u32,
    },
    /// The pace of work on a machine changes.
    Pace {
        /// Machine.
        machine: u32,
    },
    /// Edges come to a crib that were bought or ground elsewhere.
    Edges {
        /// Index into the cribs of the scenario.
        crib: u16,
        /// Number of the consignment.
        number: u32,
    },
    /// Worn edges of a crib may be sent to be ground.
    Regrind {
        /// Index into the cribs of the scenario.
        crib: u32,
    },
    /// Maintenance is due.
    Maintenance {
        /// Index into the maintenance of the scenario.
        plan: u32,
    },
    /// The window of maintenance that waits opens.
    Window {
        /// Index into the maintenance of the scenario.
        plan: u32,
    },
    /// Maintenance is over.
    Maintained {
        /// Index into the maintenance of the scenario.
        plan: u32,
    },
    /// Whoever attended to the first time of a piece leaves its machine alone.
    Alone {
        /// Machine.
        machine: u32,
    },
    /// A person has walked to a machine.
    Walked {
        /// Machine.
        machine: u32,
    },
    /// A planned operation may begin from now on.
    Planned {
        /// Machine.
        machine: u32,
    },
    /// A crew comes to its shift.
    Crew {
        /// Index into the crews of the scenario.
        crew: u32,
    },
    /// A person comes to work or leaves.
    Operator {
        /// Index into the operators of the scenario.
        operator: u32,
        /// Whether the person comes.
        comes: bool,
    },
    /// A shift begins.
    ShiftStart {
        /// Machine.
        machine: u32,
    },
    /// A shift ends.
    ShiftEnd {
        /// Machine.
        machine: u32,
    },
}

impl Event {
    /// Its place within an instant.
    #[inline]
    pub(super) fn class(self) -> Class {
        match self {
            Self::StepEnd { .. }
            | Self::Failure { .. }
            | Self::Repair { .. }
            | Self::Maintenance { .. }
            | Self::Maintained { .. }
            | Self::Alone { .. } => Class::Finish,
            Self::Arrival { .. }
            | Self::Release { .. }
            | Self::BatchDue { .. }
            | Self::Pool
            | Self::Edges { .. }
            | Self::Regrind { .. }
            | Self::Walked { .. }
            | Self::Planned { .. }
            | Self::PickUp { .. }
            | Self::Moved { .. }
            | Self::Restock { .. }
            | Self::MakeUp { .. }
            | Self::Delivery { .. } => Class::Arrive,
            Self::ShiftStart { .. }
            | Self::ShiftEnd { .. }
            | Self::Operator { .. }
            | Self::Window { .. }
            | Self::Pace { .. }
            | Self::Crew { .. } => Class::Shift,
        }
    }

    /// Its content for the digest.
    #[inline]
    pub(super) fn word(self) -> u64 {
        let (kind, index) = match self {
            Self::StepEnd { machine } => (0, machine),
            Self::Failure { mode } => (1, mode),
            Self::Repair { mode } => (2, mode),
            Self::Arrival { source } => (3, source),
            Self::ShiftStart { machine } => (4, machine),
            Self::ShiftEnd { machine } => (5, machine),
            Self::Release { order } => (6, order),
            Self::BatchDue { machine } => (9, machine),
            Self::Pool => (11, 0),
            Self::Edges { crib, number } => (12, u32::from(crib) << 24 ^ number),
            Self::Regrind { crib } => (13, crib),
            Self::Maintenance { plan } => (14, plan),
            Self::Window { plan } => (15, plan),
            Self::Maintained { plan } => (16, plan),
            Self::Alone { machine } => (17, machine),
            Self::Walked { machine } => (18, machine),
            Self::Planned { machine } => (19, machine),
            Self::Crew { crew } => (20, crew),
            Self::PickUp { transport, vehicle } => (21, u32::from(transport) << 16 | u32::from(vehicle)),
            Self::Moved { slot } => (25, slot),
            Self::Restock { stock } => (22, stock),
            Self::MakeUp { order } => (23, order),
            Self::Pace { machine } => (24, machine),
            Self::Delivery { transport, vehicle } => (10, u32::from(transport) << 16 | u32::from(vehicle)),
            Self::Operator { operator, comes } => (7 + u64::from(comes), operator),
        };
        kind << 32 | u64::from(index)
    }
}
