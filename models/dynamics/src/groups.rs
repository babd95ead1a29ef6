//! Specific cutting forces of work materials by group, where no force was measured.

/// A group of work materials after VDI 3323.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialGroup {
    /// Number of the group in VDI 3323.
    pub number: u32,
    /// Letter of ISO 513: P, M, K, N, S or H.
    pub letter: char,
    /// Materials and condition.
    pub material: &'static str,
    /// Specific cutting force of a chip of 1 mm² that is 1 mm thick, k_c1.1 (Pa).
    pub pressure: f64,
    /// Exponent m_c of Kienzle's law `k_c = k_c1.1 (h/1 mm)^−m_c`.
    pub exponent: f64,
}

/// Where [`MATERIAL_GROUPS`] comes from.
pub const GROUPS_SOURCE: &str = "Iscar, turning tools catalogue 2017, page 558, material groups according to DIN/ISO 513 and VDI 3323, \
     k_c1 and m_c for a rake angle of 0 degrees";

const fn group(number: u32, letter: char, material: &'static str, megapascal: f64, exponent: f64) -> MaterialGroup {
    MaterialGroup { number, letter, material, pressure: megapascal * 1e6, exponent }
}

/// Specific cutting forces by group. Groups 29 and 30 (plastics, rubber) have no values there; 38 to 41 (hardened) have no
/// exponent and are left out.
///
/// # Source
/// [`GROUPS_SOURCE`].
pub const MATERIAL_GROUPS: &[MaterialGroup] = &[
    group(1, 'P', "non-alloy steel, below 0.25 % C, annealed", 1350.0, 0.21),
    group(2, 'P', "non-alloy steel, 0.25 % C and more, annealed", 1500.0, 0.22),
    group(3, 'P', "non-alloy steel, below 0.55 % C, quenched and tempered", 1675.0, 0.24),
    group(4, 'P', "non-alloy steel, 0.55 % C and more, annealed", 1700.0, 0.24),
    group(5, 'P', "non-alloy steel, 0.55 % C and more, quenched and tempered", 1900.0, 0.24),
    group(6, 'P', "low-alloy steel, annealed", 1775.0, 0.24),
    group(7, 'P', "low-alloy steel, quenched and tempered, 275 HB", 1675.0, 0.24),
    group(8, 'P', "low-alloy steel, quenched and tempered, 300 HB", 1725.0, 0.24),
    group(9, 'P', "low-alloy steel, quenched and tempered, 350 HB", 1800.0, 0.24),
    group(10, 'P', "high-alloy and tool steel, annealed", 2450.0, 0.23),
    group(11, 'P', "high-alloy and tool steel, quenched and tempered", 2500.0, 0.23),
    group(12, 'P', "stainless steel, ferritic and martensitic", 1875.0, 0.21),
    group(13, 'P', "stainless steel, martensitic", 1875.0, 0.21),
    group(14, 'M', "stainless steel, austenitic", 2150.0, 0.20),
    group(15, 'K', "nodular cast iron, ferritic and pearlitic", 1150.0, 0.20),
    group(16, 'K', "nodular cast iron, pearlitic", 1350.0, 0.28),
    group(17, 'K', "grey cast iron, ferritic", 1225.0, 0.25),
    group(18, 'K', "grey cast iron, pearlitic", 1350.0, 0.28),
    group(19, 'K', "malleable cast iron, ferritic", 1225.0, 0.25),
    group(20, 'K', "malleable cast iron, pearlitic", 1420.0, 0.30),
    group(21, 'N', "wrought aluminium, not hardenable", 700.0, 0.25),
    group(22, 'N', "wrought aluminium, hardened", 800.0, 0.25),
    group(23, 'N', "cast aluminium up to 12 % Si, not hardenable", 700.0, 0.25),
    group(24, 'N', "cast aluminium up to 12 % Si, hardened", 700.0, 0.25),
    group(25, 'N', "cast aluminium above 12 % Si", 750.0, 0.25),
    group(26, 'N', "copper alloys, free-cutting", 700.0, 0.27),
    group(27, 'N', "brass", 700.0, 0.27),
    group(28, 'N', "electrolytic copper", 700.0, 0.27),
    group(31, 'S', "high-temperature alloys, iron based, annealed", 2600.0, 0.24),
    group(32, 'S', "high-temperature alloys, iron based, hardened", 3100.0, 0.24),
    group(33, 'S', "high-temperature alloys, nickel or cobalt based, annealed", 3300.0, 0.24),
    group(34, 'S', "high-temperature alloys, nickel or cobalt based, hardened", 3300.0, 0.24),
    group(35, 'S', "high-temperature alloys, nickel or cobalt based, cast", 3300.0, 0.24),
    group(36, 'S', "titanium", 1700.0, 0.23),
    group(37, 'S', "titanium alloys, alpha and beta, hardened", 2110.0, 0.22),
];

impl MaterialGroup {
    /// The group of a number of VDI 3323, such as `22`.
    pub fn numbered(number: u32) -> Option<Self> {
        MATERIAL_GROUPS.iter().find(|group| group.number == number).copied()
    }

    /// Slope (Pa) and intercept (N/m) of the force per width over the chip at thickness `chip` (m): Kienzle's force
    /// `k_c1.1 h (h/1 mm)^−m` as the straight line that touches it there.
    ///
    /// # Examples
    /// ```
    /// let steel = toolroom_dynamics::MaterialGroup::numbered(6).unwrap();
    /// let [slope, edge] = steel.touching(0.1e-3);
    /// // 1775 MPa · 0.1^−0.24 = 3085 MPa; the line holds 76 % of it as slope.
    /// assert!((slope * 1e-6 - 0.76 * 3084.6).abs() < 1.0 && (edge * 1e-3 - 0.24 * 308.46).abs() < 0.1);
    /// ```
    pub fn touching(&self, chip: f64) -> [f64; 2] {
        let pressure = self.pressure_at(chip);
        [(1.0 - self.exponent) * pressure, self.exponent * pressure * chip]
    }

    /// Specific cutting force k_c (Pa) at the chip thickness `chip` (m).
    pub fn pressure_at(&self, chip: f64) -> f64 {
        self.pressure * (chip * 1e3).powf(-self.exponent)
    }
}
