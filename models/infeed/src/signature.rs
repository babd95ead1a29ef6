//! What hidden effects leave in plunge trials, and which of them can be told apart.

use crate::cycle::CyclePhase;
use crate::identify::least;
use crate::infeed::positive;
use crate::law::{REFERENCE_DEPTH, share_out};
use crate::{Infeed, Input, MeasurementErrors, State, stock_after};
use toolroom_process::{Number, record};

record! {
    /// Deviations of a plunge from the nominal model, each of which is neutral at zero.
    pub struct PlungeDeviations {
        /// Wheel volume worn per work volume ground, 1/G, beside that of the parameters.
        wheel_wear_ratio: Real = 0.0, 0.0..=10.0;
        /// Threshold force beside that of the parameters.
        threshold_force: Real["N" => "N"] = 0.0, 0.0..=1e5;
        /// Relative error of the infeed scale; negative where the machine feeds less.
        infeed_error: Real = 0.0, -0.5..=0.5;
        /// Revolutions by which contact begins late: infeed that is commanded and not there.
        late_start: Real = 0.0, -10.0..=10.0;
        /// Relative growth of the process stiffness each revolution.
        dulling_per_revolution: Real = 0.0, 0.0..=10.0;
        /// Growth of the work radius by heat, while grinding and when it is gauged.
        thermal_growth: Real["m" => "um"] = 0.0, -1e-3..=1e-3;
        /// Time constant of that growth.
        thermal_time_constant: Real["s" => "s"] = 2.0, 1e-3..=1e4;
        /// What lacks of one in the exponent of the force: `F_n = Cp S (h/S)^(1 − loss)` with S the
        /// first infeed of the plunge.
        force_exponent_loss: Real = 0.0, 0.0..=0.9;
        /// Share of the last depth that the gauge does not see: 0.5 where it averages the spiral.
        unseen_depth: Real = 0.0, 0.0..=1.0;
    }
}

/// Force and stock at the end of a revolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungeReading<N = f64> {
    /// Normal force, N.
    pub normal_force: N,
    /// Radial stock that the gauge would read, m.
    pub stock_removed: N,
}

impl<N: Number> Infeed<N> {
    /// Readings of a plunge, revolution by revolution, under deviations.
    pub fn plunge(
        &self,
        u: &Input<N>,
        phases: &[CyclePhase],
        deviations: &PlungeDeviations<N>,
    ) -> Vec<PlungeReading<N>> {
        let (p, d) = (&self.parameters, deviations);
        let first_infeed = phases.first().map_or(0.0, |phase| phase.infeed_per_rev);
        let rotation_period = u.work_rotation_speed.recip() * std::f64::consts::TAU;
        let mut part = State::<f64>::default().map(N::from);
        part.commanded_infeed = -d.late_start * first_infeed;
        let mut readings = Vec::new();
        for phase in phases {
            for _ in 0..phase.revolutions {
                part.revolutions += 1.0;
                part.commanded_infeed += (d.infeed_error + 1.0) * phase.infeed_per_rev;
                let [compliance, wear, threshold] = self.shares(&part, u);
                let compliance = compliance * (d.dulling_per_revolution * part.revolutions + 1.0);
                let wear = wear + d.wheel_wear_ratio * p.work_diameter / p.wheel_diameter;
                let threshold = threshold + d.threshold_force / p.system_stiffness;
                let warm = -(-part.revolutions * rotation_period / d.thermal_time_constant).exp() + 1.0;
                let growth = d.thermal_growth * warm;
                let engagement =
                    positive(part.commanded_infeed + growth - part.wheel_wear - threshold - part.stock_removed);
                // The parameters know the force at 1 um, the deviation at the first infeed.
                let whole = p.force_exponent;
                let compliance = if whole.re() == 1.0 || first_infeed <= 0.0 {
                    compliance
                } else {
                    compliance * N::from(first_infeed / REFERENCE_DEPTH).powd(whole - 1.0)
                };
                let exponent = whole - d.force_exponent_loss;
                let loaded = threshold - self.start_offset(&part, u);
                let (depth, deflection) = share_out(engagement, compliance, wear, exponent, first_infeed);
                part.stock_removed += depth;
                part.wheel_wear += wear * depth;
                part.removed_volume += p.work_diameter * depth * std::f64::consts::PI;
                readings.push(PlungeReading {
                    normal_force: (loaded + deflection) * p.system_stiffness,
                    stock_removed: part.stock_removed - growth - depth * d.unseen_depth,
                });
            }
        }
        readings
    }
}

/// The shape of plunge trials of constant infeed with a spark-out: what a nominal model fitted
/// to them says, and what it leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungeShape {
    /// Lag fitted to the stock, K_P.
    pub stock_lag: f64,
    /// Lag fitted to the rise of the force, with its end free, K_F.
    pub force_lag: f64,
    /// What the fit leaves of the stock, root mean square, m.
    pub stock_residual: f64,
    /// Trend of that over the revolutions, m.
    pub residual_per_revolution: f64,
    /// Force at the end of infeed over that after a third of the revolutions.
    pub late_rise: f64,
    /// Force at the end of spark-out over that at the end of infeed.
    pub floor: f64,
}

impl PlungeShape {
    /// Shape of `stock`, pairs of revolutions and stock of trials with the same infeed per
    /// revolution, and of a force read at each of `rise` revolutions of infeed and after that in
    /// spark-out. None where no lag fits.
    ///
    /// | seen | says |
    /// |---|---|
    /// | K_P ≠ K_F | start of contact, definition of stock, or a threshold force |
    /// | a floor after spark-out | threshold force |
    /// | a trend of the residual | wheel wear or infeed scale, which cannot be told apart |
    /// | a late rise | dulling |
    pub fn from_stock(stock: &[(f64, f64)], infeed_per_rev: f64, force: &[f64], rise: usize) -> Option<Self> {
        let rising = force.get(..rise).filter(|rising| rising.len() > 2)?;
        if stock.len() < 2 {
            return None;
        }
        let residual = |lag: f64, (n, stock): (f64, f64)| stock - stock_after(infeed_per_rev, n, lag);
        let misfit = |lag: f64| stock.iter().map(|pair| (residual(lag, *pair) / infeed_per_rev).powi(2)).sum::<f64>();
        let stock_lag = least(misfit)?;
        let force_lag = least(|lag| {
            let (mut xx, mut xy, mut yy, mut power) = (0.0, 0.0, 0.0, 1.0);
            for force in rising {
                power *= lag;
                let x = 1.0 - power;
                xx += x * x;
                xy += x * force;
                yy += force * force;
            }
            yy - xy * xy / xx
        })?;
        let n = stock.len() as f64;
        let mean = stock.iter().map(|(revolutions, _)| revolutions).sum::<f64>() / n;
        let residuals = || stock.iter().map(|pair| residual(stock_lag, *pair));
        let mean_residual = residuals().sum::<f64>() / n;
        let spread = stock.iter().map(|(revolutions, _)| (revolutions - mean).powi(2)).sum::<f64>();
        let tilt = stock.iter().zip(residuals()).map(|((n, _), residual)| (n - mean) * (residual - mean_residual));
        Some(Self {
            stock_lag,
            force_lag,
            stock_residual: (residuals().map(|residual| residual * residual).sum::<f64>() / n).sqrt(),
            residual_per_revolution: tilt.sum::<f64>() / spread,
            late_rise: rising[rise - 1] / rising[(rise / 3).max(1) - 1],
            floor: force[force.len() - 1] / rising[rise - 1],
        })
    }
}

/// A plunge whose force is recorded at every revolution and whose stock is gauged after some.
#[derive(Clone, Debug, PartialEq)]
pub struct PlungeDesign {
    /// Phases of the plunge.
    pub phases: Vec<CyclePhase>,
    /// Revolutions after which the stock is gauged.
    pub gauged: Vec<u32>,
    /// Errors of force and stock.
    pub errors: MeasurementErrors,
}

impl Default for PlungeDesign {
    /// 16 revolutions at 4.43 um, 6 at 1 um, 8 of spark-out, gauged after 6, 16, 22 and 30.
    fn default() -> Self {
        let phase = |infeed_per_rev, revolutions| CyclePhase { infeed_per_rev, revolutions };
        Self {
            phases: vec![phase(4.43e-6, 16), phase(1e-6, 6), phase(0.0, 8)],
            gauged: vec![6, 16, 22, 30],
            errors: MeasurementErrors::default(),
        }
    }
}

impl PlungeDesign {
    /// Readings in units of their errors: every force, then the gauged stocks.
    pub fn whitened<N: Number>(&self, grinding: &Infeed<N>, u: &Input<N>, deviations: &PlungeDeviations<N>) -> Vec<N> {
        let readings = grinding.plunge(u, &self.phases, deviations);
        let force = readings.iter().map(|reading| reading.normal_force / self.errors.force);
        let gauged = self.gauged.iter().filter_map(|at| readings.get((*at as usize).checked_sub(1)?));
        force.chain(gauged.map(|reading| reading.stock_removed / self.errors.stock)).collect()
    }

    /// What a deviation adds to the whitened readings.
    pub fn signature(&self, grinding: &Infeed, u: &Input, deviations: &PlungeDeviations) -> Vec<f64> {
        let nominal = self.whitened(grinding, u, &PlungeDeviations::default());
        self.whitened(grinding, u, deviations).iter().zip(nominal).map(|(with, without)| with - without).collect()
    }

    /// Exact derivatives of the whitened readings by the logarithms of Cp and J: what refitting
    /// the nominal model can take up.
    pub fn baseline(&self, grinding: &Infeed, u: &Input) -> [Vec<f64>; 2] {
        use toolroom_process::num_dual::Dual64;
        let by = |process: f64, system: f64| {
            let mut dual = grinding.map(Dual64::from);
            let p = &mut dual.parameters;
            p.process_stiffness.eps = process * p.process_stiffness.re;
            p.system_stiffness.eps = system * p.system_stiffness.re;
            let readings = self.whitened(&dual, &u.map(Dual64::from), &PlungeDeviations::default().map(Dual64::from));
            readings.iter().map(|reading| reading.eps).collect()
        };
        [by(1.0, 0.0), by(0.0, 1.0)]
    }
}

/// Which of several signatures can be told apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Separability {
    /// Size of each signature, in standard deviations of the noise.
    pub size: Vec<f64>,
    /// Size after the nominal model has been refitted: what remains to be seen.
    pub size_after_refit: Vec<f64>,
    /// cos² of each pair after the refit: the share of the gap that the one would close if the
    /// other were true.
    pub cos2: Vec<Vec<f64>>,
}

/// Separability of whitened `signatures`, the span of `baseline` being projected out.
///
/// ```
/// use toolroom_infeed::{Infeed, Input, PlungeDesign, PlungeDeviations, separability};
/// let (design, grinding, input) = (PlungeDesign::default(), Infeed::default(), Input::default());
/// let signature = |deviations| design.signature(&grinding, &input, &deviations);
/// let wear = signature(PlungeDeviations { wheel_wear_ratio: 0.05, ..Default::default() });
/// let feed = signature(PlungeDeviations { infeed_error: -0.01, ..Default::default() });
/// let told = separability(&design.baseline(&grinding, &input), &[wear, feed]);
/// assert!(told.cos2[0][1] > 0.999); // wheel wear and infeed scale cannot be told apart
/// ```
pub fn separability(baseline: &[Vec<f64>], signatures: &[Vec<f64>]) -> Separability {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let norm = |a: &[f64]| dot(a, a).sqrt();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let without = |basis: &[Vec<f64>], vector: &[f64]| {
        let mut rest = vector.to_vec();
        // The second pass removes what rounding left of the first.
        for direction in basis.iter().chain(basis) {
            let along = dot(direction, &rest);
            rest.iter_mut().zip(direction).for_each(|(rest, direction)| *rest -= along * direction);
        }
        rest
    };
    for vector in baseline {
        let rest = without(&basis, vector);
        let length = norm(&rest);
        if length > f64::EPSILON * norm(vector) {
            basis.push(rest.iter().map(|value| value / length).collect());
        }
    }
    let rests: Vec<Vec<f64>> = signatures.iter().map(|signature| without(&basis, signature)).collect();
    let cos2 = |a: &[f64], b: &[f64]| {
        let both = dot(a, a) * dot(b, b);
        if both > 0.0 { dot(a, b).powi(2) / both } else { 0.0 }
    };
    Separability {
        size: signatures.iter().map(|signature| norm(signature)).collect(),
        size_after_refit: rests.iter().map(|rest| norm(rest)).collect(),
        cos2: rests.iter().map(|a| rests.iter().map(|b| cos2(a, b)).collect()).collect(),
    }
}

impl Separability {
    /// The signatures that cannot be told from signature `index`, itself included: those with a
    /// cos² above `threshold`.
    pub fn confusion_set(&self, index: usize, threshold: f64) -> Vec<usize> {
        let row = self.cos2.get(index).into_iter().flatten().enumerate();
        row.filter(|(other, cos2)| *other == index || **cos2 > threshold).map(|(other, _)| other).collect()
    }
}
