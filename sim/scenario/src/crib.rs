//! Tool cribs: a limited number of edges that go round between machines and regrinding, or are bought.

use super::Distribution;

/// The edges of a tool, where they are limited. A tool without a crib has as many as are needed.
#[derive(Clone, Debug, PartialEq)]
pub struct Crib {
    /// Tool, by index.
    pub tool: usize,
    /// Edges at the start, those that machines mount first included.
    pub edges: u32,
    /// Time to bring an edge to a machine, s, beside the machine's own change.
    pub fetch: f64,
    /// What becomes of worn and broken edges; `None`: they are thrown away.
    pub regrind: Option<Regrind>,
    /// When new ones are bought; `None`: never.
    pub buy: Option<Purchase>,
}

/// How worn edges are ground anew.
#[derive(Clone, Debug, PartialEq)]
pub struct Regrind {
    /// Part, by index, whose one operation is the regrinding of this tool on machines of the shop; `None`: it is done
    /// elsewhere, for as many as there are at once.
    pub part: Option<usize>,
    /// Time of one edge on such a machine, or until edges that are sent away together come back.
    pub time: Distribution,
    /// How often an edge is ground before it is thrown away; `None`: without limit.
    pub times: Option<u32>,
    /// Life after a regrinding over the life before.
    pub life_factor: f64,
    /// Cost of grinding one edge, currency: an edge that was ground costs this in the place of a new one.
    pub cost: f64,
    /// Edges that are sent together.
    pub batch: u32,
}

/// How new edges are bought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Purchase {
    /// They are ordered as soon as fewer than this are in the crib or on order.
    pub below: u32,
    /// Edges of an order.
    pub lot: u32,
    /// Time until they come, s.
    pub lead: f64,
}
