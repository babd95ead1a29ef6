//! The fastest cycle by exact search.

use super::CycleLimits;
use crate::{Infeed, Input, Rounded, State};
use toolroom_process::{ModelError, Process, Record};

/// A part of a cycle with constant infeed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CyclePhase {
    /// Infeed per revolution, m; 0 in spark-out.
    pub infeed_per_rev: f64,
    /// Revolutions.
    pub revolutions: u32,
}

/// One end of a revolution in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CyclePoint {
    /// Time since first contact, s.
    pub time: f64,
    /// Infeed commanded so far, m.
    pub commanded_infeed: f64,
    /// Stock removed, m.
    pub stock_removed: f64,
    /// Depth of this revolution, m.
    pub depth_of_cut: f64,
    /// Radius left above what is commanded, m.
    pub size_error: f64,
    /// Normal force, N.
    pub normal_force: f64,
    /// Temperature rise, K.
    pub temperature_rise: f64,
}

/// A cycle and what it leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Rough, finish and spark-out, as far as they have revolutions.
    pub phases: Vec<CyclePhase>,
    /// Revolutions of all phases.
    pub revolutions: u32,
    /// Duration, s.
    pub time: f64,
    /// Depth of the last revolution, m.
    pub last_depth: f64,
    /// Radius left above the commanded size, m.
    pub size_error: f64,
    /// Last step and what is left of the blank's out-of-roundness, m.
    pub roundness_error: f64,
    /// Stock removed after the rough phase, m.
    pub finish_stock: f64,
    /// Greatest temperature rise, K.
    pub peak_temperature_rise: f64,
    /// Greatest depth that the rough limit allows, m.
    pub rough_depth_limit: f64,
    /// Greatest depth that the finish limit allows, m.
    pub finish_depth_limit: f64,
    /// The cycle revolution by revolution, from first contact.
    pub course: Vec<CyclePoint>,
}

/// Why there is no cycle. Lengths are in um.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CycleError {
    /// Input, parameters or limits outside their range.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Even the coolest depth is too hot.
    #[error(
        "{limit} = {allowed} K conflicts with the heat of this wheel: no depth of cut stays below {least:.0} K; use more \
         coolant, a sharper wheel or faster work rotation"
    )]
    TooHotAtAnyDepth {
        /// The limit.
        limit: &'static str,
        /// Its value, K.
        allowed: f64,
        /// Least temperature rise at any depth, K.
        least: f64,
    },
    /// The finish limit lies below the first infeed that can be set.
    #[error(
        "finish_temperature_rise and infeed_step conflict: the finish infeed must stay below {depth_limit:.4} um, the \
         machine sets multiples of {} um", Rounded(*.step)
    )]
    FinishBelowStep {
        /// Greatest depth of the finish phase.
        depth_limit: f64,
        /// Step of the infeed.
        step: f64,
    },
    /// More finish stock than stock.
    #[error(
        "finish_stock = {} um and stock = {} um conflict: {removable:.4} um can be removed at most",
        Rounded(*.finish_stock), Rounded(*.stock)
    )]
    FinishStockBeyondStock {
        /// Finish stock asked for.
        finish_stock: f64,
        /// Stock.
        stock: f64,
        /// What a cycle can remove at most.
        removable: f64,
    },
    /// Threshold force and wheel wear alone leave more than allowed.
    #[error(
        "size_error = {} um conflicts with threshold force and wheel wear: they alone leave {threshold:.4} um and \
         {wear:.4} um however long the spark-out", Rounded(*.allowed)
    )]
    SizeBeyondReach {
        /// The limit.
        allowed: f64,
        /// Left by the threshold force.
        threshold: f64,
        /// Left by the wear of the wheel on this part.
        wear: f64,
    },
    /// A cycle exists but is absurdly long.
    #[error("{limit} needs more than {revolutions} revolutions; the lag is {lag:.6}")]
    TooLong {
        /// The limit that needs them.
        limit: &'static str,
        /// Length at which the search ends.
        revolutions: u32,
        /// Lag K.
        lag: f64,
    },
}

impl CycleError {
    /// The limits that conflict, as keys of [`CycleLimits`]; none where the fault is another one.
    pub fn limits(&self) -> &'static [&'static str] {
        match self {
            Self::Model(_) => &[],
            Self::TooHotAtAnyDepth { limit: "finish_temperature_rise", .. } => &["finish_temperature_rise"],
            Self::TooHotAtAnyDepth { .. } => &["rough_temperature_rise"],
            Self::FinishBelowStep { .. } => &["finish_temperature_rise", "infeed_step"],
            Self::FinishStockBeyondStock { .. } => &["finish_stock", "stock"],
            Self::SizeBeyondReach { .. } => &["size_error"],
            Self::TooLong { limit: "stock", .. } => &["stock", "rough_temperature_rise"],
            Self::TooLong { limit: "blank_roundness_error", .. } => &["blank_roundness_error", "roundness_error"],
            Self::TooLong { .. } => &["last_depth", "size_error", "roundness_error"],
        }
    }
}

/// Revolutions beyond which no cycle is sought.
const LONGEST: u32 = 100_000;
/// Share by which a limit may be passed in rounding.
const ROUNDING: f64 = 1e-12;

/// The greatest depth at which `grinding` stays below `temperature_rise`, m, at most `greatest`.
///
/// # Errors
/// The least temperature rise of any depth, where that is too hot.
pub fn depth_at_temperature(
    grinding: &Infeed,
    wheel: &State,
    input: &Input,
    temperature_rise: f64,
    greatest: f64,
) -> Result<f64, f64> {
    let rise = |log_depth: f64| {
        let cut = State { depth_of_cut: greatest * log_depth.exp(), ..*wheel };
        grinding.output_in_cut(&cut, input).temperature_rise
    };
    if rise(0.0) <= temperature_rise {
        return Ok(greatest);
    }
    // The rise has one minimum over the logarithm of the depth, as a rule far below any real
    // depth: where the chips carry off much, a deeper cut may be cooler than a threshold force alone.
    let (mut low, mut high) = (-30.0, 0.0);
    for _ in 0..200 {
        let third = (high - low) / 3.0;
        if rise(low + third) < rise(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    if rise(low) > temperature_rise {
        return Err(rise(low));
    }
    high = 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if rise(middle) <= temperature_rise {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(greatest * low.exp())
}

/// Runs a cycle through the process, revolution by revolution, with contact at the start.
///
/// # Errors
/// Those of [`Process::advance`].
pub fn grind_cycle(
    grinding: &Infeed,
    wheel: &State,
    input: &Input,
    phases: &[CyclePhase],
) -> Result<(State, Vec<CyclePoint>), ModelError> {
    // Contact is found anew on each part: earlier wear of the wheel does not enter its size.
    let mut part = State { wheel_wear: 0.0, ..grinding.new_part(wheel) };
    let rotation_period = std::f64::consts::TAU / input.work_rotation_speed;
    let mut course = vec![CyclePoint::default()];
    for phase in phases {
        let input = Input { infeed_per_rev: phase.infeed_per_rev, engaged: 1.0, ..*input };
        input.check()?;
        for _ in 0..phase.revolutions {
            part.commanded_infeed += phase.infeed_per_rev;
            part = grinding.revolution(&part, &input);
            let output = grinding.output(&part, &input);
            course.push(CyclePoint {
                time: part.revolutions * rotation_period,
                commanded_infeed: part.commanded_infeed,
                stock_removed: output.stock_removed,
                depth_of_cut: output.depth_of_cut,
                size_error: output.size_error,
                normal_force: output.normal_force,
                temperature_rise: output.temperature_rise,
            });
        }
    }
    Ok((part, course))
}

/// The cycle of fewest revolutions that removes the stock within the limits: `rough_revolutions`
/// of one infeed, `finish_revolutions` of an infeed on the grid of the machine, spark-out; the
/// commanded infeed adds up to the stock. Among equally fast cycles, the one of least last depth.
///
/// The search is exact: it visits every finish infeed and every number of finish and rough
/// revolutions that could beat the best cycle so far, each with its least spark-out. It takes the
/// process stiffness as it is at the start of the part; the numbers of the cycle found are those
/// of the process itself, with dulling within the part. `wheel` says how blunt the wheel is.
///
/// # Errors
/// [`CycleError`] names the limits that conflict.
///
/// ```
/// use toolroom_infeed::{CycleLimits, Infeed, Input, State, fastest_cycle};
/// let (grinding, limits) = (Infeed::default(), CycleLimits::default());
/// let cycle = fastest_cycle(&grinding, &State::default(), &Input::default(), &limits).unwrap();
/// assert_eq!(cycle.revolutions, 27);
/// ```
pub fn fastest_cycle(
    grinding: &Infeed,
    wheel: &State,
    input: &Input,
    limits: &CycleLimits,
) -> Result<Cycle, CycleError> {
    input.check()?;
    limits.check()?;
    if input.work_rotation_speed == 0.0 {
        return Err(ModelError::NoSolution { quantity: "cycle", reason: "the work does not rotate" }.into());
    }
    let law = Law::of(grinding, wheel, input);
    let search = Search::new(grinding, wheel, input, limits, law)?;
    let found = search.best()?;
    let phases: Vec<CyclePhase> =
        [(found.rough_infeed, found.rough), (found.finish_infeed, found.finish), (0.0, found.spark_out)]
            .into_iter()
            .filter(|(_, revolutions)| *revolutions > 0)
            .map(|(infeed_per_rev, revolutions)| CyclePhase { infeed_per_rev, revolutions })
            .collect();
    let (part, course) = grind_cycle(grinding, wheel, input, &phases)?;
    let last = course.last().copied().unwrap_or_default();
    let revolutions = found.revolutions();
    Ok(Cycle {
        phases,
        revolutions,
        time: last.time,
        last_depth: last.depth_of_cut,
        size_error: last.size_error,
        roundness_error: last.depth_of_cut + limits.blank_roundness_error * law.decay.powf(revolutions.into()),
        finish_stock: last.stock_removed - course[found.rough as usize].stock_removed,
        peak_temperature_rise: part.peak_temperature_rise,
        rough_depth_limit: search.rough_depth,
        finish_depth_limit: search.finish_depth,
        course,
    })
}

/// The revolution recursion in closed form: `h' = decay h + infeed/give`.
#[derive(Clone, Copy)]
struct Law {
    /// c = Cp/J.
    compliance: f64,
    /// g, wheel wear per depth.
    wear: f64,
    /// F0/J.
    threshold: f64,
    /// 1 + c + g.
    give: f64,
    /// c/(1 + c + g): the lag K where the wheel does not wear.
    decay: f64,
}

impl Law {
    fn of(grinding: &Infeed, wheel: &State, input: &Input) -> Self {
        let [compliance, wear, threshold] = grinding.shares(wheel, input);
        let give = 1.0 + compliance + wear;
        Self { compliance, wear, threshold, give, decay: compliance / give }
    }

    /// Depth after `revolutions` of infeed that starts at first contact.
    fn rough_depth(&self, infeed: f64, revolutions: u32) -> f64 {
        // Below the threshold force the wheel rubs for some revolutions first.
        let rubbing = (self.threshold / infeed).floor();
        let cutting = f64::from(revolutions) - rubbing - 1.0;
        if cutting < 0.0 {
            return 0.0;
        }
        let first = ((rubbing + 1.0) * infeed - self.threshold) / self.give;
        self.towards(first, infeed, cutting)
    }

    /// Depth `revolutions` after `depth` under another infeed.
    fn towards(&self, depth: f64, infeed: f64, revolutions: f64) -> f64 {
        let steady = infeed / (1.0 + self.wear);
        steady + (depth - steady) * self.decay.powf(revolutions)
    }
}

/// A cycle in the search.
#[derive(Clone, Copy)]
struct Candidate {
    rough_infeed: f64,
    finish_infeed: f64,
    rough: u32,
    finish: u32,
    spark_out: u32,
    last_depth: f64,
}

impl Candidate {
    fn revolutions(&self) -> u32 {
        self.rough + self.finish + self.spark_out
    }
}

struct Search<'a> {
    limits: &'a CycleLimits,
    law: Law,
    rough_depth: f64,
    finish_depth: f64,
    /// Last depth allowed by size, finish and roundness.
    last_depth: f64,
}

impl<'a> Search<'a> {
    /// The depths that the limits allow, or the limits that conflict.
    fn new(
        grinding: &Infeed,
        wheel: &State,
        input: &Input,
        limits: &'a CycleLimits,
        law: Law,
    ) -> Result<Self, CycleError> {
        const UM: f64 = 1e6;
        let coolest = |limit: &'static str, allowed: f64| {
            depth_at_temperature(grinding, wheel, input, allowed, limits.greatest_infeed)
                .map_err(|least| CycleError::TooHotAtAnyDepth { limit, allowed, least })
        };
        let rough_depth = coolest("rough_temperature_rise", limits.rough_temperature_rise)?;
        let finish_depth = coolest("finish_temperature_rise", limits.finish_temperature_rise)?.min(rough_depth);
        if limits.finish_stock > 0.0 && finish_depth * (1.0 + law.wear) < limits.infeed_step {
            let (depth_limit, step) = (finish_depth * (1.0 + law.wear) * UM, limits.infeed_step * UM);
            return Err(CycleError::FinishBelowStep { depth_limit, step });
        }
        let removable = (limits.stock - law.threshold) / (1.0 + law.wear);
        let wear = law.wear * removable;
        let left = limits.size_error - law.threshold - wear;
        if left <= 0.0 {
            let (threshold, wear) = (law.threshold * UM, wear * UM);
            return Err(CycleError::SizeBeyondReach { allowed: limits.size_error * UM, threshold, wear });
        }
        if limits.finish_stock >= removable {
            let (finish_stock, stock) = (limits.finish_stock * UM, limits.stock * UM);
            return Err(CycleError::FinishStockBeyondStock { finish_stock, stock, removable: removable * UM });
        }
        // size = (u − c h − F0/J)/(1 + g): what the last depth adds to the size error.
        let by_size = left * (1.0 + law.wear) / law.compliance;
        let last_depth = limits.last_depth.min(by_size).min(limits.roundness_error);
        let search = Self { limits, law, rough_depth, finish_depth, last_depth };
        let spark_out = (last_depth / finish_depth).ln() / law.decay.ln();
        for (limit, revolutions) in [
            ("stock", limits.stock / rough_depth),
            ("last_depth, size_error or roundness_error", spark_out),
            ("blank_roundness_error", (limits.roundness_error / limits.blank_roundness_error).ln() / law.decay.ln()),
        ] {
            if revolutions > f64::from(LONGEST) {
                return Err(CycleError::TooLong { limit, revolutions: LONGEST, lag: law.decay });
            }
        }
        Ok(search)
    }

    fn best(&self) -> Result<Candidate, CycleError> {
        let mut best: Option<Candidate> = None;
        let step = self.limits.infeed_step;
        let greatest = (self.finish_depth * (1.0 + self.law.wear)).min(self.limits.greatest_infeed);
        let settings = (greatest / step * (1.0 + ROUNDING)).floor().min(1e6) as u32;
        // From the coarsest: it gives a good bound at once.
        for setting in (1..=settings).rev() {
            self.with_finish_infeed(f64::from(setting) * step, &mut best);
        }
        if settings == 0 {
            self.with_finish_infeed(0.0, &mut best);
        }
        best.ok_or(CycleError::TooLong { limit: "the cycle", revolutions: LONGEST, lag: self.law.decay })
    }

    /// Every cycle with this finish infeed that could beat the best.
    fn with_finish_infeed(&self, finish_infeed: f64, best: &mut Option<Candidate>) {
        let (law, limits) = (&self.law, self.limits);
        let mut finish = 0;
        loop {
            let rough_stock = limits.stock - f64::from(finish) * finish_infeed;
            if rough_stock <= 0.0 {
                return;
            }
            // The rough depth never passes infeed/(1 + g), and comes close to it.
            let steady_limit = (self.rough_depth * (1.0 + law.wear)).min(limits.greatest_infeed);
            let least = self.fewest_rough(rough_stock, steady_limit);
            let most = self.most_rough(rough_stock, f64::from(finish) * finish_infeed);
            let bound = |best: &Option<Candidate>| best.map_or(LONGEST, |best| best.revolutions());
            if least.saturating_add(finish) > bound(best) {
                return;
            }
            let mut rough = least;
            while rough <= most && rough + finish <= bound(best) {
                // A block of lengths at a time: passed over if its shortest cycle is too long.
                let end = (rough + rough / 32).min(most);
                if rough + finish + self.least_spark_out(rough_stock, finish_infeed, end, finish) <= bound(best) {
                    for rough in rough..=end {
                        self.consider(self.complete(rough_stock, finish_infeed, rough, finish), best);
                    }
                }
                rough = end + 1;
            }
            if finish_infeed == 0.0 {
                return;
            }
            finish += 1;
        }
    }

    fn consider(&self, found: Option<Candidate>, best: &mut Option<Candidate>) {
        let better = |found: &Candidate| {
            best.is_none_or(|best| {
                let (new, old) = (found.revolutions(), best.revolutions());
                new < old || (new == old && found.last_depth < best.last_depth)
            })
        };
        if let Some(found) = found.filter(|found| found.revolutions() <= LONGEST && better(found)) {
            *best = Some(found);
        }
    }

    /// A number of spark-out revolutions that no cycle of up to `rough` rough revolutions goes below.
    fn least_spark_out(&self, rough_stock: f64, finish_infeed: f64, rough: u32, finish: u32) -> u32 {
        let law = &self.law;
        // Of one stock, more revolutions leave less depth; a threshold force takes threshold/give
        // from it at most.
        let infeed = rough_stock / f64::from(rough);
        let depth = law.towards(0.0, infeed, rough.into()) - law.threshold / law.give;
        let finish_depth = law.towards(depth.max(0.0), finish_infeed, finish.into());
        // One less for rounding.
        let exact = (self.last_depth / finish_depth).ln() / law.decay.ln() - 1.0;
        exact.clamp(0.0, f64::from(LONGEST)) as u32
    }

    /// Fewest rough revolutions that keep the rough depth below its limit.
    fn fewest_rough(&self, rough_stock: f64, steady_limit: f64) -> u32 {
        // A transient that does not come to its end may use a greater infeed than the steady one.
        let mut rough = (rough_stock / steady_limit).ceil().clamp(1.0, f64::from(LONGEST) + 1.0) as u32;
        while rough > 1 && self.rough_is_cool(rough_stock, rough - 1) {
            rough -= 1;
        }
        rough
    }

    fn rough_is_cool(&self, rough_stock: f64, rough: u32) -> bool {
        let infeed = rough_stock / f64::from(rough);
        infeed <= self.limits.greatest_infeed * (1.0 + ROUNDING)
            && self.law.rough_depth(infeed, rough) <= self.rough_depth * (1.0 + ROUNDING)
    }

    /// Most rough revolutions that leave enough deflection for the finish stock.
    fn most_rough(&self, rough_stock: f64, finish_infeeds: f64) -> u32 {
        let wanted = self.limits.finish_stock * (1.0 + self.law.wear) - finish_infeeds;
        let infeed = wanted * (1.0 + self.law.wear) / self.law.compliance;
        if infeed <= 0.0 { LONGEST } else { (rough_stock / infeed).floor().min(f64::from(LONGEST)) as u32 }
    }

    /// The cycle with the least spark-out, where these revolutions can make one.
    fn complete(&self, rough_stock: f64, finish_infeed: f64, rough: u32, finish: u32) -> Option<Candidate> {
        let (law, limits) = (&self.law, self.limits);
        let rough_infeed = rough_stock / f64::from(rough);
        if rough_infeed < finish_infeed || !self.rough_is_cool(rough_stock, rough) {
            return None;
        }
        let rough_depth = law.rough_depth(rough_infeed, rough);
        let finish_depth = law.towards(rough_depth, finish_infeed, finish.into());
        // (n_f S_f + c (h_rough − h_last))/(1 + g) ≥ finish stock.
        let in_finish = f64::from(finish) * finish_infeed - limits.finish_stock * (1.0 + law.wear);
        let by_finish_stock = rough_depth + in_finish / law.compliance;
        let allowed = self.last_depth.min(by_finish_stock);
        if allowed <= 0.0 || finish_depth <= 0.0 {
            return None;
        }
        let exact = ((allowed / finish_depth).ln() / law.decay.ln()).ceil();
        let mut spark_out = exact.clamp(0.0, f64::from(LONGEST)) as u32;
        // The logarithm may be off by one revolution either way.
        let depth_after = |spark_out: u32| finish_depth * law.decay.powf(spark_out.into());
        let enough = |spark_out: u32| {
            let depth = depth_after(spark_out);
            let revolutions = f64::from(rough + finish + spark_out);
            depth <= allowed
                && depth + limits.blank_roundness_error * law.decay.powf(revolutions) <= limits.roundness_error
        };
        while spark_out > 0 && enough(spark_out - 1) {
            spark_out -= 1;
        }
        while spark_out < LONGEST && !enough(spark_out) {
            spark_out += 1;
        }
        let last_depth = depth_after(spark_out);
        Some(Candidate { rough_infeed, finish_infeed, rough, finish, spark_out, last_depth })
    }
}
