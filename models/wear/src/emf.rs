//! The tool–work thermocouple.

use toolroom_process::{Number, record};

record! {
    /// Thermo-EMF of the tool–work pair, averaged over rake and flank contact by area.
    ///
    /// `emf = offset + sensitivity·(theta_E - celsius_zero)`,
    /// `theta_E = (c·theta_rake + (h + h0)·theta)/(c + h + h0)`, rake contact `c = rake_contact_ratio·a`,
    /// `theta_rake = ambient + rake_heating_ratio·chip`.
    ///
    /// # Source
    /// The contact areas b·(h + c) of Postnov & Shafikov, eq. (5); constants are assumptions.
    /// Defaults are the set `ni_vk6om`.
    pub struct Emf {
        /// EMF at 0 °C, e0.
        offset: Real["V" => "mV"] = 0.0, -1.0..=1.0;
        /// Slope of the characteristic, e1.
        sensitivity: Real["V/K" => "mV/K"] = 11.5e-6, 0.0..=1e-2;
        /// Rake temperature rise against that of the edge, r_K.
        rake_heating_ratio: Real = 1.35, 0.0..=5.0;
        /// Rake contact length against chip thickness, k_c.
        rake_contact_ratio: Real = 2.5, 0.1..=20.0;
        /// Temperature of 0 °C.
        celsius_zero: Real["K" => "K"] = 273.15, 0.0..=1000.0;
    }
}

/// What the thermocouple sees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Junction<N> {
    pub ambient: N,
    pub chip: N,
    pub temperature: N,
    pub chip_thickness: N,
    /// Land that conducts, flank wear plus the offset of a new edge.
    pub land: N,
}

impl<N: Number> Emf<N> {
    /// Thermo-EMF, V.
    pub(crate) fn value(&self, junction: Junction<N>) -> N {
        let rake = junction.ambient + self.rake_heating_ratio * junction.chip;
        let contact = self.rake_contact_ratio * junction.chip_thickness;
        let mean = (contact * rake + junction.land * junction.temperature) / (contact + junction.land);
        self.offset + self.sensitivity * (mean - self.celsius_zero)
    }
}
