//! The fastest cycle by exact search.

use super::candidate::{Candidate, LONGEST, Task};
use super::caps::{depth_at_loads, depth_at_temperature, lesser};
use super::law::Law;
use super::run::Run;
use super::{CycleError, CycleLimits, ROUNDING};

pub(super) struct Search<'a> {
    task: Task<'a>,
    limits: &'a CycleLimits,
    law: Law,
    /// Depth that the limits allow at the start of the part.
    pub rough_depth: f64,
    /// Depth that the finish limit allows at the start of the part.
    pub finish_depth: f64,
    /// Last depth allowed by size, finish and roundness.
    last_depth: f64,
    /// Runs candidates through the process, where the closed form does not hold.
    run: Option<Run<'a>>,
}

impl<'a> Search<'a> {
    /// The depths that the limits allow, or the limits that conflict. Cycles follow `law`.
    pub fn new(task: Task<'a>, law: Law) -> Result<Self, CycleError> {
        const UM: f64 = 1e6;
        let Task { grinding, wheel, input, limits, roughness } = task;
        let coolest = |limit: &'static str, allowed: f64| {
            depth_at_temperature(grinding, wheel, input, allowed, limits.greatest_infeed)
                .map(|depth| (depth, limit))
                .map_err(|least| CycleError::TooHotAtAnyDepth { limit, allowed, least })
        };
        let loads = depth_at_loads(grinding, wheel, input, limits)?;
        let rough = lesser(coolest("rough_temperature_rise", limits.rough_temperature_rise)?, loads);
        let finish = lesser(coolest("finish_temperature_rise", limits.finish_temperature_rise)?, rough);
        let ((rough_depth, _), (finish_depth, limit)) = (rough, finish);
        if limits.finish_stock > 0.0 && finish_depth * (1.0 + law.wear) < limits.infeed_step {
            let (depth_limit, step) = (finish_depth * (1.0 + law.wear) * UM, limits.infeed_step * UM);
            return Err(CycleError::FinishBelowStep { limit, depth_limit, step });
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
        if limits.asks_for_roughness() {
            let roughness = roughness.ok_or(CycleError::NoRoughness)?;
            let finest = limits.infeed_step / (1.0 + law.wear);
            let least = roughness.in_spark_out(task.roughness_under(finest), 0.0);
            if least > limits.roughness {
                return Err(CycleError::TooRough { allowed: limits.roughness * UM, least: least * UM });
            }
        }
        // size = (u − c h − F0/J)/(1 + g): what the last depth adds to the size error.
        let by_size = left * (1.0 + law.wear) / law.compliance;
        let last_depth = limits.last_depth.min(by_size).min(limits.roundness_error);
        let search = Self { task, limits, law, rough_depth, finish_depth, last_depth, run: None };
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

    /// A search that runs every candidate through the process: each limit holds at each revolution with the process
    /// stiffness of that revolution.
    pub fn running(task: Task<'a>) -> Result<Self, CycleError> {
        let law = Law::of(task.grinding, task.wheel, task.input);
        let mut search = Self::new(task, law)?;
        search.run = Some(Run::new(task, law, search.rough_depth));
        Ok(search)
    }

    /// Whether the run went through as many revolutions as it may.
    fn spent(&self) -> bool {
        self.run.as_ref().is_some_and(Run::spent)
    }

    /// The fastest cycle of the wheel as blunt as it gets, if the process grinds it within the limits.
    fn first_bound(&self) -> Option<Candidate> {
        let run = self.run.as_ref()?;
        let (task, law) = run.blunt();
        let found = Search::new(task, law).ok()?.best().ok()?;
        run.complete(found, LONGEST)
    }

    /// The fastest cycle.
    pub fn best(&self) -> Result<Candidate, CycleError> {
        // A cycle for the wheel as blunt as it gets is a good bound at once.
        let mut best = self.first_bound();
        let step = self.limits.infeed_step;
        let greatest = (self.finish_depth * (1.0 + self.law.wear))
            .min(self.limits.greatest_infeed)
            .min(self.limits.greatest_finish_infeed);
        let settings = (greatest / step * (1.0 + ROUNDING)).floor().min(1e6) as u32;
        // From the coarsest: it gives a good bound at once.
        for setting in (1..=settings).rev() {
            let infeed = f64::from(setting) * step;
            // What the finish infeed leaves falls to a share of it at most.
            let smooth = self.task.roughness.is_none_or(|roughness| {
                let under_infeed = self.task.roughness_under(infeed / (1.0 + self.law.wear));
                roughness.in_spark_out(under_infeed, 0.0) <= self.limits.roughness
            });
            if smooth && !self.spent() {
                self.with_finish_infeed(infeed, &mut best);
            }
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
            let least = match &self.run {
                Some(run) => run.fewest_rough(rough_stock),
                None => self.fewest_rough(rough_stock, steady_limit),
            };
            let mut most = match &self.run {
                Some(_) => LONGEST,
                None => self.most_rough(rough_stock, f64::from(finish) * finish_infeed),
            };
            if finish_infeed > 0.0 {
                // The rough infeed is not below the finish infeed.
                most = most.min((rough_stock / finish_infeed).min(f64::from(LONGEST)) as u32 + 1);
            }
            let bound = |best: &Option<Candidate>| best.map_or(LONGEST, |best| best.revolutions());
            if least.saturating_add(finish) > bound(best) || self.spent() {
                return;
            }
            let mut rough = least;
            while rough <= most && rough + finish <= bound(best) {
                // A block of lengths at a time: passed over if its shortest cycle is too long.
                let end = (rough + rough / 32).min(most);
                if rough + finish + self.least_spark_out(rough_stock, finish_infeed, end, finish) <= bound(best) {
                    for rough in rough..=end {
                        let longest = bound(best);
                        self.consider(self.complete(rough_stock, finish_infeed, rough, finish, longest), best);
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
        let law = match &self.run {
            None => &self.law,
            Some(run) => match &run.below {
                Some(law) => law,
                None => return 0,
            },
        };
        // Of one stock, more revolutions leave less depth; a threshold force takes threshold/give
        // from it at most.
        let infeed = rough_stock / f64::from(rough);
        let depth = law.towards(0.0, infeed, rough.into()) - law.threshold / law.give;
        let finish_depth = law.towards(depth.max(0.0), finish_infeed, finish.into());
        // One less for rounding.
        let last_depth = if self.run.is_some() { self.limits.last_depth } else { self.last_depth };
        let exact = (last_depth / finish_depth).ln() / law.decay.ln() - 1.0;
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

    /// The cycle with the least spark-out, where these revolutions can make one of up to `longest` revolutions.
    fn complete(
        &self,
        rough_stock: f64,
        finish_infeed: f64,
        rough: u32,
        finish: u32,
        longest: u32,
    ) -> Option<Candidate> {
        let (law, limits) = (&self.law, self.limits);
        let rough_infeed = rough_stock / f64::from(rough);
        if let Some(run) = &self.run {
            let candidate = Candidate { rough_infeed, finish_infeed, rough, finish, spark_out: 0, last_depth: 0.0 };
            return (rough_infeed >= finish_infeed).then(|| run.complete(candidate, longest)).flatten();
        }
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
        let infed = self.task.roughness.map(|roughness| (roughness, self.task.roughness_under(finish_depth)));
        if infed.is_some_and(|(roughness, infed)| roughness.in_spark_out(infed, 0.0) > limits.roughness) {
            return None;
        }
        let exact = ((allowed / finish_depth).ln() / law.decay.ln()).ceil();
        let mut spark_out = exact.clamp(0.0, f64::from(LONGEST)) as u32;
        // The logarithm may be off by one revolution either way.
        let depth_after = |spark_out: u32| finish_depth * law.decay.powf(spark_out.into());
        let enough = |spark_out: u32| {
            let depth = depth_after(spark_out);
            let revolutions = f64::from(rough + finish + spark_out);
            let left = law.decay.powf(spark_out.into());
            let smooth = infed.is_none_or(|(roughness, infed)| {
                roughness.in_spark_out(infed, left) <= limits.roughness * (1.0 + ROUNDING)
            });
            smooth
                && depth <= allowed
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
