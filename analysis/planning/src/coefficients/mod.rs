//! Cutting-force coefficients: identified from mean forces, or of a group of work materials; text, JSON and file.

mod text;

use serde_json::{Value, json};
use toolroom_chatter::{Direction, Engagement};
use toolroom_dynamics::{
    Coefficients, ForceTest, ForceTestError, GROUPS_SOURCE, MATERIAL_GROUPS, MaterialGroup, TestedCut,
};
use toolroom_process::unit;

/// Radial over tangential coefficient where only the specific cutting force is known (assumption: 0.3 for sharp tools in
/// aluminium to 0.5 in steel are usual).
pub const RADIAL_RATIO: f64 = 0.4;
/// Relative standard deviation of a coefficient from a table (assumption, as for lobes files).
const TABLE_DEVIATION: f64 = 0.15;

/// Least and greatest feed per tooth (mm) within which shops mill (assumption: what tables of tool makers span, widened by a
/// factor of about two). A value outside is admitted; its usual cause is a slip of the unit.
pub const USUAL_FEED_PER_TOOTH: [f64; 2] = [0.005, 1.0];
/// Factor beyond the specific cutting forces of the groups of VDI 3323 at which a tangential coefficient is unusual
/// (assumption: the groups span what is milled, wear and rake change the force by less than this).
const BEYOND_GROUPS: f64 = 3.0;

/// An argument that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct CoefficientRequestError {
    message: String,
    /// What would do.
    pub fix: &'static str,
}

fn refused(message: String, fix: &'static str) -> CoefficientRequestError {
    CoefficientRequestError { message, fix }
}

/// The cut of a force test, as it is written on a command line.
#[derive(Clone, Copy, Debug)]
pub struct ForceTestRequest<'a> {
    /// Teeth of the cutter.
    pub teeth: u32,
    /// Axial depth of cut with its unit.
    pub depth: &'a str,
    /// Radial width of cut over diameter; a slot is 1.
    pub immersion: f64,
    /// `up` or `down`.
    pub up: bool,
    /// Which of the columns x, y and z of the table act along feed, normal and axis, with their signs, such as `-y,x,z`.
    pub axes: Option<&'a str>,
}

impl ForceTestRequest<'_> {
    /// The cut.
    ///
    /// # Errors
    /// [`CoefficientRequestError`]: a depth or an immersion that is none.
    pub fn cut(&self) -> Result<TestedCut, CoefficientRequestError> {
        const DEPTH: &str = "write for example --depth \"2 mm\"";
        let depth = unit::quantity(self.depth, "m").map_err(|error| refused(format!("--depth: {error}"), DEPTH))?;
        if !(depth > 0.0 && depth.is_finite()) {
            return Err(refused(format!("--depth: {} is no depth of cut", self.depth), DEPTH));
        }
        let direction = if self.up { Direction::Up } else { Direction::Down };
        let Engagement { entry, exit } = Engagement::new(self.immersion, direction).map_err(|_| {
            let message = format!("--immersion: {} is not within 0 … 1", self.immersion);
            refused(message, "write the radial width of cut over the diameter; a slot is 1")
        })?;
        Ok(TestedCut { teeth: self.teeth, depth, entry, exit })
    }

    /// The axes of the dynamometer: the column of feed, normal and axis, and its sign.
    ///
    /// # Errors
    /// [`CoefficientRequestError`]: not three different columns.
    pub fn axes(&self) -> Result<[(usize, f64); 3], CoefficientRequestError> {
        const FIX: &str = "write the columns along feed, normal and axis with their signs, for example --axes=-y,x,z";
        let Some(text) = self.axes else { return Ok([(0, 1.0), (1, 1.0), (2, 1.0)]) };
        let wrong = || refused(format!("--axes: `{text}` does not name x, y and z once each"), FIX);
        let axis = |word: &str| {
            let word = word.trim();
            let (sign, name) = word.strip_prefix('-').map_or((1.0, word), |name| (-1.0, name));
            let column = ["x", "y", "z"].iter().position(|known| *known == name.trim_start_matches('+'));
            column.map(|column| (column, sign))
        };
        let found: Option<Vec<(usize, f64)>> = text.split(',').map(axis).collect();
        let axes: [(usize, f64); 3] = found.and_then(|axes| axes.try_into().ok()).ok_or_else(wrong)?;
        let mut columns = axes.map(|(column, _)| column);
        columns.sort_unstable();
        if columns == [0, 1, 2] { Ok(axes) } else { Err(wrong()) }
    }
}

/// Coefficients that were found, with where they come from.
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientStudy {
    /// Short name.
    pub name: String,
    /// Work material or file.
    pub material: String,
    /// Where they come from.
    pub source: String,
    /// What was found.
    pub origin: CoefficientOrigin,
}

/// How coefficients were found.
#[derive(Clone, Debug, PartialEq)]
pub enum CoefficientOrigin {
    /// From mean forces over the feed.
    Test(Box<Coefficients>),
    /// From a group of work materials.
    Group {
        /// The group.
        group: MaterialGroup,
        /// Chip thickness at which Kienzle's law is touched (m).
        chip: f64,
        /// Radial over tangential coefficient.
        radial_ratio: f64,
    },
}

impl CoefficientStudy {
    /// Identifies coefficients from a test.
    ///
    /// # Errors
    /// As [`ForceTest::identify`].
    pub fn of_test(
        name: String,
        source: String,
        test: ForceTest,
        cut: &TestedCut,
        axes: [(usize, f64); 3],
    ) -> Result<Self, ForceTestError> {
        let material = format!("identified from {}", test.source);
        let mut found = test.turned(axes).identify(cut)?;
        found.warnings.extend(unusual(&found));
        Ok(Self { name, material, source, origin: CoefficientOrigin::Test(Box::new(found)) })
    }

    /// Coefficients of group `number` of VDI 3323 at a chip thickness with its unit.
    ///
    /// # Errors
    /// [`CoefficientRequestError`]: a group without values, a thickness or a ratio that is none.
    pub fn of_group(
        name: String,
        number: u32,
        chip: &str,
        radial_ratio: Option<f64>,
    ) -> Result<Self, CoefficientRequestError> {
        const GROUP: &str = "see toolroom coefficients --list";
        const CHIP: &str = "write for example --chip-thickness \"0.08 mm\", between 0.001 and 3 mm";
        let group = MaterialGroup::numbered(number)
            .ok_or_else(|| refused(format!("--group: there are no values for group {number}"), GROUP))?;
        let thickness =
            unit::quantity(chip, "m").map_err(|error| refused(format!("--chip-thickness: {error}"), CHIP))?;
        if !(1e-6..=3e-3).contains(&thickness) {
            return Err(refused(format!("--chip-thickness: {chip} is out of range"), CHIP));
        }
        let radial_ratio = radial_ratio.unwrap_or(RADIAL_RATIO);
        if !(0.0..=3.0).contains(&radial_ratio) {
            let message = format!("--radial-ratio: {radial_ratio} is not within 0 … 3");
            return Err(refused(message, "write the radial over the tangential coefficient, such as 0.4"));
        }
        Ok(Self {
            name,
            material: format!("{}: {}", group.letter, group.material),
            source: GROUPS_SOURCE.to_owned(),
            origin: CoefficientOrigin::Group { group, chip: thickness, radial_ratio },
        })
    }
}

/// What is admitted and rarely meant: feeds or forces of another unit.
fn unusual(coefficients: &Coefficients) -> Vec<String> {
    let mut warnings = Vec::new();
    let [from, to] = coefficients.range.map(|feed| feed * 1e3);
    let [least, most] = USUAL_FEED_PER_TOOTH;
    if from < least || to > most {
        warnings.push(format!(
            "unusual: the feeds per tooth are {from:.4} to {to:.4} mm; shops mill with {least} to {most} mm; is the unit of \
             the column right?"
        ));
    }
    // At the least and the greatest usual feed, because a specific force grows as the chip becomes thin.
    let pressures = MATERIAL_GROUPS.iter().flat_map(|group| USUAL_FEED_PER_TOOTH.map(|f| group.pressure_at(f * 1e-3)));
    let (low, high) = pressures.fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    let usual = low / BEYOND_GROUPS..=high * BEYOND_GROUPS;
    if let Some(tangential) = coefficients.chip[0].filter(|coefficient| !usual.contains(&coefficient.value)) {
        warnings.push(format!(
            "unusual: the tangential coefficient is {:.4} MPa; the groups of VDI 3323 have {:.0} to {:.0} MPa; are the units \
             of feed, force and depth right?",
            tangential.value * 1e-6,
            low * 1e-6,
            high * 1e-6
        ));
    }
    warnings
}

/// The groups of work materials as a table of a terminal.
pub fn group_list() -> String {
    let mut text = format!("{GROUPS_SOURCE}\n\n  VDI 3323  ISO 513  k_c1.1 MPa   m_c   material\n");
    for group in MATERIAL_GROUPS {
        let MaterialGroup { number, letter, material, pressure, exponent } = group;
        text += &format!("  {number:>8}  {letter:>7}  {:>10}  {exponent:.2}   {material}\n", pressure * 1e-6);
    }
    text.truncate(text.trim_end().len());
    text
}

/// The groups of work materials as a document.
pub fn group_list_json() -> Value {
    let groups = MATERIAL_GROUPS.iter().map(|group| {
        let MaterialGroup { number, letter, material, pressure, exponent } = group;
        json!({
            "vdi_3323": number, "iso_513": letter, "material": material,
            "k_c1.1 [MPa]": pressure * 1e-6, "m_c": exponent,
        })
    });
    json!({ "schema": 1, "source": GROUPS_SOURCE, "groups": groups.collect::<Vec<_>>() })
}
