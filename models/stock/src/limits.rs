//! What bounds the feed of a cutter that is engaged: each limit as a share of what it allows.

use crate::engaged::{Engaged, Layer};
use crate::load::{Tool, forces};
use std::f64::consts::TAU;
use toolroom_contour::{MillLife, Parameters};

toolroom_form::vocabulary! {
    /// A limit of the feed.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum FeedLimit {
        /// Path feed at most that of the machine.
        HighestFeed = "highest_feed",
        /// Cutting power within that of the spindle.
        Power = "power",
        /// Force on the cutter within that of the feed mechanism.
        FeedForce = "feed_force",
        /// Bending of a tooth within its strength.
        ToothStrength = "tooth_strength",
        /// Bending and torsion of the body within its strength.
        BodyStrength = "body_strength",
        /// Chips of a tooth within its flute.
        ChipSpace = "chip_space",
        /// Thickest chip.
        ChipThickness = "chip_thickness",
        /// Deflection of the tip across the path.
        Deflection = "deflection",
        /// Life of the edges under these conditions at least the nominal one.
        ToolLife = "tool_life",
        /// Roughness of the wall.
        Roughness = "roughness",
    }
}

impl FeedLimit {
    /// All of them, in order.
    pub const ALL: [Self; 10] = [
        Self::HighestFeed,
        Self::Power,
        Self::FeedForce,
        Self::ToothStrength,
        Self::BodyStrength,
        Self::ChipSpace,
        Self::ChipThickness,
        Self::Deflection,
        Self::ToolLife,
        Self::Roughness,
    ];
}

/// What the feed of one tool has to keep; `None` where nothing is limited.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FeedLimits {
    /// m/s.
    pub highest_feed: Option<f64>,
    /// Least feed that a plan commands, m/s.
    pub lowest_feed: f64,
    /// Feed where no material is near, m/s; `None` is the highest feed.
    pub air_feed: Option<f64>,
    /// At the cutter, W.
    pub power: Option<f64>,
    /// N.
    pub feed_force: Option<f64>,
    /// Force per width of a tooth's edge, N/m.
    pub tooth_force: Option<f64>,
    /// Overhang, m, and moment, N·m, of bending and torsion together.
    pub body: Option<(f64, f64)>,
    /// Section of a chip of a tooth, m².
    pub chip_section: Option<f64>,
    /// m.
    pub chip_thickness: Option<f64>,
    /// Thickness below which chips count as thin, m; reported, never kept by more feed.
    pub least_chip_thickness: f64,
    /// m.
    pub deflection: Option<f64>,
    /// s.
    pub tool_life: Option<f64>,
    /// Roughness Rz and the part of it that no feed takes away, m.
    pub roughness: Option<(f64, f64)>,
    /// Rate of the machine, 1/s, and price of an edge, in one currency, for the objective `cost`.
    pub economics: Option<(f64, f64)>,
}

impl FeedLimits {
    /// The limits of a parameter set for a tool of this diameter and length, m: those that do not depend on the work at hand. The size
    /// of a tooth is known only where the diameter is that of the set.
    pub fn from_parameters(set: &Parameters, diameter: f64, overhang: f64) -> Self {
        let (machine, cutter) = (&set.machine, &set.cutter);
        let radius = 0.5 * diameter;
        let same = (diameter / cutter.diameter - 1.0).abs() < 1e-9;
        let tooth = cutter.tooth_thickness.powi(2) * cutter.tooth_strength / (6.0 * cutter.tooth_height);
        Self {
            highest_feed: Some(machine.highest_feed),
            lowest_feed: machine.lowest_feed,
            power: Some(machine.power * machine.efficiency),
            feed_force: Some(machine.feed_force),
            tooth_force: same.then_some(tooth),
            body: Some((overhang, cutter.section_modulus_ratio * radius.powi(3) * cutter.body_strength)),
            chip_section: Some(cutter.chip_space_ratio * diameter * diameter / cutter.chip_packing),
            tool_life: Some(set.life.nominal_life),
            economics: Some((set.economics.machine_rate, set.economics.edge_price())),
            ..Self::default()
        }
    }

    /// Without the limits that are not named; all stay where none is.
    #[must_use]
    pub fn only(mut self, names: &[FeedLimit]) -> Self {
        if names.is_empty() {
            return self;
        }
        for limit in FeedLimit::ALL.into_iter().filter(|limit| !names.contains(limit)) {
            match limit {
                // A plan needs an end even in air.
                FeedLimit::HighestFeed => {}
                FeedLimit::Power => self.power = None,
                FeedLimit::FeedForce => self.feed_force = None,
                FeedLimit::ToothStrength => self.tooth_force = None,
                FeedLimit::BodyStrength => self.body = None,
                FeedLimit::ChipSpace => self.chip_section = None,
                FeedLimit::ChipThickness => self.chip_thickness = None,
                FeedLimit::Deflection => self.deflection = None,
                FeedLimit::ToolLife => self.tool_life = None,
                FeedLimit::Roughness => self.roughness = None,
            }
        }
        self
    }
}

/// A force that grows evenly with the feed per tooth: at none, N, and per feed, N/m.
type Linear = (f64, f64);

/// What is engaged at one place, as functions of the feed per tooth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Demand {
    along: Linear,
    across: Linear,
    tangential: Linear,
    /// Greatest sine of the angle of immersion: chip thickness over feed per tooth.
    pub chip: f64,
    /// Greatest radial width of cut, m.
    width: f64,
    /// Mean radial width and whole depth of cut, m, for the life.
    mean_width: f64,
    depth: f64,
    /// Greatest radius that is engaged, m, for the life.
    radius: f64,
    /// Whether the forces of the tool are known.
    pub known: bool,
}

/// Feed per tooth by which slopes are worked out, m: forces are linear in it.
const UNIT_FEED: f64 = 1e-4;
/// Least width and depth, m, that count for the life of an edge (assumption).
const RUBS: f64 = 1e-6;

impl Demand {
    pub fn from_engaged(engaged: &Engaged, tool: &Tool) -> Self {
        // The chip is thickest where the tooth moves across the direction of travel: at the front.
        let thickest = |(from, to): &(f64, f64)| {
            if *from <= 0.0 && *to >= 0.0 { 1.0 } else { from.cos().max(to.cos()) }
        };
        let chip = |layer: &Layer| layer.slope * layer.angles.iter().map(thickest).fold(0.0, f64::max);
        let chip = engaged.layers.iter().map(chip).fold(0.0, f64::max);
        let width = |layer: &Layer| layer.angles.iter().map(|(a, b)| b.sin() - a.sin()).sum::<f64>() * layer.radius;
        let widest = engaged.layers.iter().map(width).fold(0.0, f64::max);
        let depth = engaged.depth();
        let mean_width = if depth > RUBS { engaged.area() / depth } else { 0.0 };
        let mut demand = Self { chip, width: widest, mean_width, depth, radius: engaged.radius(), ..Self::default() };
        if let Some(force) = &tool.force {
            let [edge, ahead] = [0.0, UNIT_FEED].map(|feed| forces(engaged, &force.edge, tool, feed));
            let line = |i: usize| (edge[i], (ahead[i] - edge[i]) / UNIT_FEED);
            (demand.along, demand.across, demand.tangential) = (line(0), line(1), line(2));
            demand.known = true;
        }
        demand
    }

    /// The sample that bends the cutter most, along its path and across it. Forces in one direction do not grow with the engagement
    /// everywhere, so that the bound of the engagement is none of theirs; between samples they are taken to be greater by a quarter
    /// of what they differ (an assumption that a test on a pocket holds to a part in a thousand).
    pub fn heaviest(samples: &[Self; 3]) -> Self {
        let size = |(edge, slope): Linear| (edge + slope * UNIT_FEED).abs();
        let greatest = |of: fn(&Self) -> Linear| {
            let most = samples.iter().map(of).fold((0.0, 0.0), |a, b| if size(b) > size(a) { b } else { a });
            let least = samples.iter().map(|demand| size(of(demand))).fold(f64::INFINITY, f64::min);
            let more = if size(most) > 0.0 { 1.25 - 0.25 * least / size(most) } else { 1.0 };
            (most.0 * more, most.1 * more)
        };
        let (along, across) = (greatest(|demand| demand.along), greatest(|demand| demand.across));
        let heavier = |a: Self, b: Self| if size(b.across) > size(a.across) { b } else { a };
        Self { along, across, ..samples.iter().copied().fold(Self::default(), heavier) }
    }
}

/// A cutter at work: what turns feeds into shares of its limits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AtWork<'a> {
    pub tool: &'a Tool,
    pub limits: &'a FeedLimits,
    /// Spindle speed, rad/s, above 0.
    pub speed: f64,
}

/// Feed that stands for the slowest, m/s: a millimetre in a quarter of an hour.
const SLOWEST: f64 = 1e-6;
/// Halvings of the range in which a limit is met: to a part in 10⁹.
const HALVINGS: u32 = 30;

impl AtWork<'_> {
    fn feed_per_tooth(&self, feed: f64) -> f64 {
        feed * TAU / (self.speed * self.tool.teeth)
    }

    fn life(&self, demand: &Demand, feed: f64) -> Option<(f64, MillLife)> {
        let life = self.tool.force?.life;
        if demand.depth < RUBS || demand.mean_width < RUBS || feed <= 0.0 {
            return None;
        }
        let (teeth, diameter) = (self.tool.teeth, 2.0 * demand.radius);
        let lasts =
            life.tool_life(self.speed, self.feed_per_tooth(feed), demand.mean_width, demand.depth, teeth, diameter);
        Some((lasts, life))
    }

    /// Edges that a second uses up at a feed, m/s, 1/s; 0 where their life is not known.
    pub fn edge_rate(&self, demand: &Demand, feed: f64) -> f64 {
        self.life(demand, feed).map_or(0.0, |(lasts, _)| 1.0 / lasts)
    }

    /// What a limit is used by at a feed, m/s, above 0, over what it allows; `None` where it does not limit.
    pub fn ratio(&self, limit: FeedLimit, demand: &Demand, feed: f64) -> Option<f64> {
        let (limits, radius) = (self.limits, self.tool.radius);
        let fz = self.feed_per_tooth(feed);
        let at = |(edge, slope): Linear| edge + slope * fz;
        let known = |value: Option<f64>| value.filter(|_| demand.known);
        Some(match limit {
            FeedLimit::HighestFeed => feed / limits.highest_feed?,
            FeedLimit::Power => at(demand.tangential) * self.speed * radius / known(limits.power)?,
            FeedLimit::FeedForce => at(demand.along).hypot(at(demand.across)) / known(limits.feed_force)?,
            FeedLimit::ToothStrength => self.tool.force?.edge.on_tooth(fz * demand.chip) / limits.tooth_force?,
            FeedLimit::BodyStrength => {
                let (overhang, moment) = limits.body.filter(|_| demand.known)?;
                let bending = at(demand.along).hypot(at(demand.across)) * overhang;
                bending.hypot(at(demand.tangential) * radius) / moment
            }
            FeedLimit::ChipSpace => fz * demand.width / limits.chip_section?,
            FeedLimit::ChipThickness => fz * demand.chip / limits.chip_thickness?,
            FeedLimit::Deflection => {
                let stiffness = self.tool.force.map(|force| force.stiffness).filter(|stiffness| *stiffness > 0.0)?;
                at(demand.across).abs() / stiffness / limits.deflection?
            }
            FeedLimit::ToolLife => limits.tool_life? / self.life(demand, feed)?.0,
            FeedLimit::Roughness => {
                // Run-out makes one cusp a revolution on a straight wall.
                let (roughness, floor) = limits.roughness?;
                (floor + (fz * self.tool.teeth).powi(2) / (8.0 * radius)) / roughness
            }
        })
    }

    /// The greatest feed, m/s, up to `highest` at which a limit is kept, with every slower one: all of them grow with the feed or
    /// curve upwards. `None` where not even the slowest keeps it.
    fn kept(&self, limit: FeedLimit, demand: &Demand, highest: f64) -> Option<f64> {
        let keeps = |feed: f64| self.ratio(limit, demand, feed).is_none_or(|ratio| ratio <= 1.0);
        if keeps(highest) && keeps(SLOWEST) {
            return Some(highest);
        }
        if !keeps(SLOWEST) {
            return None;
        }
        let (mut low, mut high) = (SLOWEST, highest);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if keeps(middle) { low = middle } else { high = middle }
        }
        Some(low)
    }

    /// The greatest feed, m/s, up to `highest` that keeps every limit at all `demands`, and the limit that binds. Nothing binds at
    /// `highest`. Where not even the slowest feed keeps a limit, it is no greater than the `programmed` one.
    pub fn greatest(&self, demands: &[Demand], highest: f64, programmed: f64) -> (f64, Option<FeedLimit>) {
        let mut best = (highest, None);
        for limit in FeedLimit::ALL {
            for demand in demands {
                let feed = self.kept(limit, demand, best.0).unwrap_or(programmed);
                if feed < best.0 {
                    best = (feed, Some(limit));
                }
            }
        }
        best
    }

    /// The feed, m/s, of least cost on a way: what the machine costs falls with the feed, what the edges cost grows with it where the
    /// life falls faster than the feed grows. `None` where faster is always cheaper.
    ///
    /// # Source
    /// The cost of a way is (rate + price/T)/feed; with T = T₁·feed^(−p) it is least at feed^p = rate·T₁/(price·(p − 1)).
    pub fn cheapest(&self, demand: &Demand) -> Option<f64> {
        let (rate, price) = self.limits.economics?;
        let (at_one, life) = self.life(demand, 1.0)?;
        let power = life.feed_exponent / life.life_exponent;
        (power > 1.0 && price > 0.0).then(|| (rate * at_one / (price * (power - 1.0))).powf(1.0 / power))
    }
}
