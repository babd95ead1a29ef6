//! Specific cutting force by material group.

/// Letters of ISO 513.
pub const ISO_513: &[&str] = &["P", "M", "K", "N", "S", "H"];

/// A row of the table: what VDI 3323 calls the group, its ISO 513 letter, hardness HB, kc1.1 in
/// N/mm², mc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialGroup {
    /// VDI 3323 group, from 1.
    pub group: u32,
    /// ISO 513 letter.
    pub iso513: &'static str,
    /// Materials of the group.
    pub materials: &'static str,
    /// Specific cutting force of a chip of 1 mm by 1 mm, Pa.
    pub kc11: f64,
    /// Exponent of chip thickness.
    pub exponent: f64,
}

/// Number of VDI 3323 groups with values here.
pub const MATERIAL_GROUPS: usize = 41;

/// Where the table comes from.
const TABLE: &str =
    "assumption: table of VDI 3323 groups with kc1.1 and mc as tool makers' catalogues print it, recalled";

/// Relative uncertainty of a force that only its material group tells (assumption).
pub const FORCE_DEVIATION: f64 = 0.25;

#[rustfmt::skip]
const ROWS: [(&str, &str, f64, f64); MATERIAL_GROUPS] = [
    ("P", "unalloyed steel, below 0.25 % C, annealed", 1350.0, 0.21),
    ("P", "unalloyed steel, 0.25 % C and more, annealed", 1500.0, 0.22),
    ("P", "unalloyed steel, below 0.55 % C, quenched and tempered", 1675.0, 0.24),
    ("P", "unalloyed steel, 0.55 % C and more, annealed", 1700.0, 0.24),
    ("P", "unalloyed steel, 0.55 % C and more, quenched and tempered", 1900.0, 0.24),
    ("P", "low-alloy steel, annealed", 1775.0, 0.24),
    ("P", "low-alloy steel, quenched and tempered, 275 HB", 1675.0, 0.24),
    ("P", "low-alloy steel, quenched and tempered, 300 HB", 1725.0, 0.24),
    ("P", "low-alloy steel, quenched and tempered, 350 HB", 1800.0, 0.24),
    ("P", "high-alloy steel and tool steel, annealed", 2450.0, 0.23),
    ("P", "high-alloy steel and tool steel, quenched and tempered", 2500.0, 0.23),
    ("P", "stainless steel, ferritic and martensitic, annealed", 1875.0, 0.21),
    ("P", "stainless steel, martensitic, quenched and tempered", 1875.0, 0.21),
    ("M", "stainless steel, austenitic", 2150.0, 0.20),
    ("K", "grey cast iron, pearlitic and ferritic", 1150.0, 0.20),
    ("K", "grey cast iron, pearlitic and martensitic", 1350.0, 0.28),
    ("K", "nodular cast iron, ferritic", 1225.0, 0.25),
    ("K", "nodular cast iron, pearlitic", 1350.0, 0.28),
    ("K", "malleable cast iron, ferritic", 1225.0, 0.25),
    ("K", "malleable cast iron, pearlitic", 1420.0, 0.30),
    ("N", "wrought aluminium, not curable", 700.0, 0.25),
    ("N", "wrought aluminium, cured", 800.0, 0.25),
    ("N", "cast aluminium, up to 12 % Si, not curable", 700.0, 0.25),
    ("N", "cast aluminium, up to 12 % Si, cured", 700.0, 0.25),
    ("N", "cast aluminium, above 12 % Si", 750.0, 0.25),
    ("N", "copper alloy, free cutting", 700.0, 0.27),
    ("N", "brass and red bronze", 700.0, 0.27),
    ("N", "bronze and electrolytic copper", 700.0, 0.27),
    ("N", "duroplastics and fibre plastics", 150.0, 0.20),
    ("N", "hard rubber", 150.0, 0.20),
    ("S", "heat-resistant alloy, Fe based, annealed", 2600.0, 0.24),
    ("S", "heat-resistant alloy, Fe based, cured", 3100.0, 0.24),
    ("S", "heat-resistant alloy, Ni or Co based, annealed", 3300.0, 0.24),
    ("S", "heat-resistant alloy, Ni or Co based, cured", 3300.0, 0.24),
    ("S", "heat-resistant alloy, Ni or Co based, cast", 3200.0, 0.24),
    ("S", "titanium, pure", 1700.0, 0.23),
    ("S", "titanium alloy, alpha and beta, cured", 2110.0, 0.22),
    ("H", "hardened steel, 55 HRC", 4600.0, 0.24),
    ("H", "hardened steel, 60 HRC", 4700.0, 0.24),
    ("H", "chilled cast iron, 400 HB", 4600.0, 0.24),
    ("H", "hardened cast iron, 55 HRC", 4500.0, 0.24),
];

/// VDI 3323 groups that stand for an ISO 513 letter where nothing else is known (assumption: a common
/// material of the letter).
const USUAL: [(&str, u32); 6] = [("P", 6), ("M", 14), ("K", 16), ("N", 22), ("S", 33), ("H", 38)];

impl MaterialGroup {
    /// The row of a VDI 3323 group, from 1.
    pub fn of_group(group: u32) -> Option<Self> {
        let row = ROWS.get(usize::try_from(group).ok()?.checked_sub(1)?)?;
        let (iso513, materials, kc11, exponent) = *row;
        Some(Self { group, iso513, materials, kc11: kc11 * 1e6, exponent })
    }

    /// The row that stands for an ISO 513 letter.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::MaterialGroup;
    /// assert_eq!(MaterialGroup::of_letter("M").unwrap().kc11, 2150e6);
    /// ```
    pub fn of_letter(letter: &str) -> Option<Self> {
        let (_, group) = USUAL.iter().find(|(known, _)| *known == letter)?;
        Self::of_group(*group)
    }

    /// The row of the table as a source.
    pub fn source(&self) -> String {
        format!("VDI 3323 group {} ({}): {TABLE}", self.group, self.materials)
    }
}
