//! Steel against cemented carbide, in other equations than those of common simulators.

/// Kelvin at the freezing point of water plus 20.
pub(crate) const ROOM: f64 = 293.15;
/// Molar gas constant.
const GAS: f64 = 8.314_462_618;

/// A cut in the trade's units: m/min, mm, mm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut {
    pub speed: f64,
    pub feed: f64,
    pub depth: f64,
}

/// What differs between the ordinary and the stress world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct World {
    /// Edge force, N/mm.
    edge: f64,
    /// Specific force, N/mm², and its exponent.
    specific: f64,
    exponent: f64,
    /// Exponent of temperature in speed, and its level.
    warm: f64,
    level: f64,
    /// Activation of diffusion, kJ/mol.
    activation: f64,
}

impl World {
    pub fn new(stress: bool) -> Self {
        if stress {
            Self { edge: 60.0, specific: 1320.0, exponent: 0.104, warm: 0.50, level: 0.6267, activation: 250.0 }
        } else {
            Self { edge: 20.0, specific: 1265.0, exponent: 0.207, warm: 0.553, level: 0.6267, activation: 270.1 }
        }
    }

    /// Cutting and feed force of an edge with a land of `wear` mm, N.
    pub fn forces(&self, cut: Cut, wear: f64) -> (f64, f64) {
        let width = cut.depth / std::f64::consts::FRAC_PI_4.sin();
        let chip = cut.feed * std::f64::consts::FRAC_PI_4.sin();
        let fast = 1.0 - 0.16 * (cut.speed - 200.0) / 200.0;
        let main = width * (self.specific * chip.powf(1.0 - self.exponent) * fast + self.edge + 250.0 * wear);
        let feed = width * (452.0 * chip.powf(0.849) * fast + 15.0 + 424.0 * wear);
        (main, feed)
    }

    /// Rise of the contact temperature, K.
    pub fn rise(&self, cut: Cut, wear: f64) -> f64 {
        let load = self.level
            * (cut.speed / 200.0).powf(self.warm)
            * (cut.feed / 0.3).powf(0.346)
            * (cut.depth / 1.5).powf(0.145);
        1600.0 * -(-load).exp_m1() + 272.0 * (cut.speed / 200.0).sqrt() * (wear + 0.03).powf(0.437)
    }

    /// Abrasion and diffusion, mm/min.
    pub fn wear_rates(&self, cut: Cut, wear: f64, rise: f64) -> (f64, f64) {
        let abrasion = 3.07e-3
            * (cut.speed / 200.0).powf(-0.616)
            * (cut.feed / 0.3).powf(-0.78)
            * (1.0 + 3.4 * (-wear / 0.07).exp());
        let hot = ROOM + rise;
        let diffusion = (-7.263_f64).exp()
            * (1.0 + 0.65 * wear)
            * (-self.activation * 1000.0 / GAS * (1.0 / hot - 1.0 / 1140.8)).exp();
        (abrasion, diffusion)
    }
}
