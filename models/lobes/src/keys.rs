//! The sections of a lobes file.

use super::words::{DirectionWord, LobesProcess, PresetWord, SupportWord};
use toolroom_form::{Form, Key, Kind};

pub(super) const FREQUENCY: Kind = Kind::positive("Hz", "Hz", 1e6, "922 Hz");
/// A mode with a damping ratio of one does not vibrate.
pub(super) const DAMPING_RATIO: Kind = Kind::positive("1", "1", 0.999, "0.011");
const MASS: Kind = Kind::positive("kg", "kg", 1e6, "0.04 kg");
pub(super) const STIFFNESS: Kind = Kind::positive("N/m", "N/um", 1e12, "1.34 N/um");
pub(super) const PRESSURE: Kind = Kind::positive("Pa", "MPa", 1e12, "600 MPa");
pub(super) const PRESSURE_EITHER: Kind = Kind::quantity("Pa", "MPa", -1e12, 1e12, "200 MPa");
pub(super) const EDGE_EITHER: Kind = Kind::quantity("N/m", "N/mm", -1e9, 1e9, "30 N/mm");
const INDENTATION: Kind = Kind::quantity("N/m", "N/m", 0.0, 1e9, "6e5 N/m");
const EDGE: Kind = Kind::quantity("N/m", "N/mm", 0.0, 1e9, "28 N/mm");
const LENGTH: Kind = Kind::positive("m", "mm", 100.0, "20 mm");
const ANGLE: Kind = Kind::quantity("rad", "deg", -6.3, 6.3, "30 deg");
const DEPTH: Kind = Kind::quantity("m", "mm", 0.0, 1.0, "0.5 mm");
const SPEED: Kind = Kind::positive("rad/s", "rpm", 1e5, "5000 rpm");
const LAG: Kind = Kind::quantity("s", "s", 0.0, 1.0, "0.4e-4 s");
const SPEED_RATIO: Kind = Kind::positive("1", "1", 100.0, "1");
const CUTTING_STIFFNESS: Kind = Kind::quantity("N/m", "N/um", 0.0, 1e12, "1.96 N/um");
const SHARE: Kind = Kind::quantity("1", "1", 0.0, 1.0, "0.1");
const MODULATION: Kind = Kind::quantity("1", "1", 0.0, 10.0, "0.3");

const MILLING: &[&str] = &[LobesProcess::Milling.word()];
const TURNING: &[&str] = &[LobesProcess::Turning.word()];
const CHUCK: &[&str] = &[LobesProcess::Chuck.word()];
const CHIP_LAG: &[&str] = &[LobesProcess::ChipLag.word()];
const LATHE: &[&str] = &[LobesProcess::Lathe.word()];
const MODULATED: &[&str] = &[LobesProcess::Chuck.word(), LobesProcess::Lathe.word()];
const OF_CHUCK: &[&str] = &[LobesProcess::Chuck.word(), LobesProcess::ChipLag.word()];
const CUTTING: &[&str] = &[LobesProcess::Milling.word(), LobesProcess::Turning.word()];

/// The whole file.
pub static LOBES: Form = Form {
    title: "the lobes file",
    doc: "A stability chart with operating points, for toolroom lobes",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::required("name", Kind::Name, "Short name, also of the output folder"),
        Key::default("title", Kind::Text, "", "One line for people"),
        Key::required(
            "process",
            Kind::Choice(LobesProcess::WORDS),
            "What vibrates: a cut that meets its own surface, or work in a chuck of three jaws: one mode over speed \
             and modulation, the same at rest over lag and cutting stiffness, tool and work together",
        ),
        Key::optional("mode", Kind::Tables(&MODE), "Vibration modes of tool and workpiece").when("process", CUTTING),
        Key::optional(
            "structure",
            Kind::Text,
            "Structure file in place of [[mode]], as `toolroom modes` writes it; the path counts from this file",
        )
        .when("process", CUTTING),
        Key::required("cutter", Kind::Table(&CUTTER), "Milling cutter").when("process", MILLING),
        Key::required("engagement", Kind::Table(&ENGAGEMENT), "How the cutter meets the work").when("process", MILLING),
        Key::required("force", Kind::Table(&FORCE), "Cutting force of milling").when("process", MILLING),
        Key::required("cut", Kind::Table(&CUT), "Cutting force and diameter of turning").when("process", TURNING),
        Key::optional("bar", Kind::Table(&BAR), "Bending of a slender workpiece at the tool").when("process", TURNING),
        Key::required("chuck", Kind::Table(&CHUCK_FORM), "Workpiece in a chuck of three jaws")
            .when("process", OF_CHUCK),
        Key::required("lathe", Kind::Table(&LATHE_FORM), "Tool and workpiece in a chuck of three jaws")
            .when("process", LATHE),
        Key::optional("speed_variation", Kind::Table(&SPEED_VARIATION), "Spindle speed that varies about its mean")
            .when("process", CUTTING),
        Key::optional("limits", Kind::Table(&LIMITS), "What machine, tool and drawing allow").when("process", CUTTING),
        Key::optional(
            "scatter",
            Kind::Table(&SCATTER),
            "How well the constants are known, for probabilities; left out: what the structure file says",
        )
        .when("process", CUTTING),
        Key::required("chart", Kind::Table(&CHART), "Range and resolution of the chart"),
        Key::optional("point", Kind::Tables(&POINT), "Operating points on the chart"),
    ],
};

static MODE: Form = Form {
    title: "[[mode]]",
    doc: "One vibration mode at the point of cut",
    keys: &[
        Key::optional("name", Kind::Name, "Name, for --set mode.NAME.stiffness=…"),
        Key::required(
            "direction",
            Kind::List(&Kind::quantity("1", "1", -1e6, 1e6, "1")),
            "Two components: (feed, normal to it) in milling, (chip thickness, cutting speed) in turning",
        ),
        Key::required("natural_frequency", FREQUENCY, "Undamped natural frequency"),
        Key::required("damping_ratio", DAMPING_RATIO, "Share of critical damping"),
        Key::optional("stiffness", STIFFNESS, "Modal stiffness; or give `mass`"),
        Key::optional("mass", MASS, "Modal mass; or give `stiffness`"),
    ],
};

static CUTTER: Form = Form {
    title: "[cutter]",
    doc: "A milling cutter",
    keys: &[
        Key::required("teeth", Kind::Count { min: 1, max: 200 }, "Number of teeth"),
        Key::required("diameter", LENGTH, "Diameter"),
        Key::default("helix_angle", Kind::quantity("rad", "deg", 0.0, 1.5, "30 deg"), "0 deg", "Helix angle"),
        Key::optional(
            "pitch",
            Kind::List(&Kind::positive("rad", "deg", 6.3, "90 deg")),
            "Angle from each tooth to the one that cut before it; left out: equal",
        ),
        Key::default("runout", Kind::quantity("m", "um", 0.0, 1e-2, "10 um"), "0 um", "Offset of the cutter's axis"),
        Key::default("runout_angle", ANGLE, "0 deg", "Angle from the first tooth to the offset"),
        Key::default(
            "corner_radius",
            Kind::quantity("m", "mm", 0.0, 1.0, "2 mm"),
            "0 mm",
            "Radius of the corner: a bull nose, half the diameter a ball end",
        ),
        Key::default(
            "taper_angle",
            Kind::quantity("rad", "deg", 0.0, 1.396, "5 deg"),
            "0 deg",
            "Angle between axis and edge of a cone that is `diameter` wide at its tip; 90 deg less the lead angle of a face mill",
        ),
    ],
};

static ENGAGEMENT: Form = Form {
    title: "[engagement]",
    doc: "How the cutter meets the work",
    keys: &[
        Key::required(
            "immersion",
            Kind::positive("1", "1", 1.0, "0.5"),
            "Radial width of cut over diameter; a slot is 1",
        ),
        Key::required("direction", Kind::Choice(DirectionWord::WORDS), "Conventional (up) or climb (down) milling"),
    ],
};

/// A file in place of the coefficients.
const COEFFICIENT_FILE: Key = Key::optional(
    "coefficients",
    Kind::Text,
    "Coefficient file in place of the coefficients here, as `toolroom coefficients` writes it; the path counts from this file",
);

static FORCE: Form = Form {
    title: "[force]",
    doc: "Linear cutting force on a tooth",
    keys: &[
        COEFFICIENT_FILE,
        Key::optional("tangential", PRESSURE, "Tangential cutting-force coefficient; or give `coefficients`"),
        Key::optional("radial", PRESSURE_EITHER, "Radial cutting-force coefficient; or give `coefficients`"),
        Key::default(
            "axial",
            PRESSURE_EITHER,
            "0 MPa",
            "Axial cutting-force coefficient, which acts where a corner radius turns the edge",
        ),
        Key::default("process_damping", INDENTATION, "0 N/m", "Indentation coefficient of process damping"),
        Key::default(
            "feed_per_tooth",
            Kind::quantity("m", "mm", 0.0, 0.1, "0.1 mm/tooth"),
            "0 mm",
            "Feed per tooth, for loads and vibration; stability depends on it only with runout",
        ),
        Key::default(
            "edge_tangential",
            EDGE,
            "0 N/mm",
            "Tangential force of the edge per depth, for loads and vibration",
        ),
        Key::default(
            "edge_radial",
            EDGE_EITHER,
            "0 N/mm",
            "Radial force of the edge per depth, for loads and vibration",
        ),
    ],
};

static CUT: Form = Form {
    title: "[cut]",
    doc: "Cutting force and diameter of turning",
    keys: &[
        COEFFICIENT_FILE,
        Key::optional("cutting_coefficient", PRESSURE, "Cutting-force coefficient; or give `coefficients`"),
        Key::required("diameter", LENGTH, "Diameter of the work"),
        Key::default("force_angle", ANGLE, "0 deg", "Angle from the chip thickness to the force"),
        Key::default("process_damping", INDENTATION, "0 N/m", "Indentation coefficient of process damping"),
        Key::default(
            "chip_exponent",
            Kind::positive("1", "1", 2.0, "0.75"),
            "1",
            "Exponent of chip thickness in the force",
        ),
        Key::optional("feed_per_rev", Kind::positive("m", "mm", 0.1, "0.2 mm/rev"), "Feed, for loads and removal rate"),
    ],
};

static BAR: Form = Form {
    title: "[bar]",
    doc: "A round bar in a chuck: its bending adds a mode at the tool; the diameter is the one of [cut]",
    keys: &[
        Key::required("length", LENGTH, "Length out of the chuck"),
        Key::required("position", LENGTH, "Place of the tool from the jaws"),
        Key::required("support", Kind::Choice(SupportWord::WORDS), "How the bar is held"),
        Key::required("youngs_modulus", Kind::positive("Pa", "GPa", 2e12, "210 GPa"), "Young's modulus"),
        Key::required("density", Kind::positive("kg/m3", "kg/m3", 3e4, "7850 kg/m3"), "Density"),
        Key::required("damping_ratio", DAMPING_RATIO, "Share of critical damping"),
        Key::required("chuck_stiffness", STIFFNESS, "Stiffness of the chuck against a radial force"),
    ],
};

static SPEED_VARIATION: Form = Form {
    title: "[speed_variation]",
    doc: "Sinusoidal spindle speed; limits and verdicts are those of the varying speed",
    keys: &[
        Key::required("amplitude", Kind::quantity("1", "1", 0.0, 0.9, "0.2"), "Amplitude over the mean speed, RVA"),
        Key::required("revolutions", Kind::Count { min: 2, max: 200 }, "Mean revolutions in one period, 1/RVF"),
        Key::optional(
            "phase",
            ANGLE,
            "Angle of tooth 0, from the normal of the feed, where the speed is greatest; left out: the worst",
        )
        .when("process", MILLING),
    ],
};

static LIMITS: Form = Form {
    title: "[limits]",
    doc: "What machine, tool and drawing allow; lines on the chart, and kept by --best",
    keys: &[
        Key::optional("power", Kind::positive("W", "kW", 1e7, "12 kW"), "Mean power at the spindle"),
        Key::optional("torque", Kind::positive("N m", "N m", 1e6, "60 N m"), "Mean torque at the spindle"),
        Key::optional("max_force", Kind::positive("N", "N", 1e7, "900 N"), "Greatest resultant force on the tool"),
        Key::optional(
            "tolerance",
            Kind::positive("m", "um", 1e-2, "20 um"),
            "Greatest error of the surface location, either way, of a stable cut",
        )
        .when("process", MILLING),
    ],
};

static SCATTER: Form = Form {
    title: "[scatter]",
    doc: "Relative standard deviations; every constant is lognormal, every mode for itself",
    keys: &[
        Key::required("natural_frequency", SHARE, "Of the natural frequencies, at constant modal mass"),
        Key::required("damping_ratio", SHARE, "Of the damping ratios"),
        Key::required(
            "coefficients",
            SHARE,
            "Of the cutting-force coefficients, and of the stiffness, which acts as they do",
        ),
    ],
};

const PRESET: Key = Key::default(
    "preset",
    Kind::Choice(PresetWord::WORDS),
    PresetWord::F0_120Hz.word(),
    "Reading of the published constants",
);

static CHUCK_FORM: Form = Form {
    title: "[chuck]",
    doc: "Workpiece in a chuck of three jaws as one mode under a lagged cutting force",
    keys: &[
        PRESET,
        Key::required("lag", LAG, "Chip-formation lag").when("process", CHUCK),
        Key::optional("mass", MASS, "Modal mass; left out: the preset's"),
        Key::optional("damping", Kind::positive("N s/m", "N s/m", 1e9, "188 N s/m"), "Damping; left out: the preset's"),
        Key::optional("stiffness", STIFFNESS, "Mean stiffness of the clamping; left out: the preset's"),
        Key::optional(
            "cutting_stiffness",
            CUTTING_STIFFNESS,
            "Stiffness of the cutting process; left out: the preset's",
        )
        .when("process", CHUCK),
    ],
};

static LATHE_FORM: Form = Form {
    title: "[lathe]",
    doc: "Tool in three directions and workpiece in two, coupled by a lagged cutting force",
    keys: &[
        PRESET,
        Key::required("lag", LAG, "Chip-formation lag of every component of the force"),
        Key::required("feed_per_rev", Kind::positive("m", "mm", 20e-3, "0.1 mm/rev"), "Feed"),
        Key::optional("allowance", Kind::List(&MODULATION), "Modulation by an uneven allowance: harmonics 1, 3, 5 …"),
        Key::default(
            "workpiece_lag",
            Kind::Flag,
            "false",
            "Take the extra damping of the printed workpiece rows literally",
        ),
        Key::default("regeneration", Kind::Flag, "false", "Let the surface of the last revolution act on the force"),
    ],
};

static CHART: Form = Form {
    title: "[chart]",
    doc: "Range and resolution of the chart",
    keys: &[
        Key::required("spindle_speed", Kind::List(&SPEED), "Least and greatest spindle speed").when("process", CUTTING),
        Key::required("depth_of_cut", Kind::List(&DEPTH), "Least and greatest depth of cut").when("process", CUTTING),
        Key::required(
            "speed_ratio",
            Kind::List(&SPEED_RATIO),
            "Least and greatest speed over the natural frequency: of the modulation, three times the spindle's, for a \
             chuck; of the spindle for a lathe",
        )
        .when("process", MODULATED),
        Key::required("modulation", Kind::List(&MODULATION), "Least and greatest modulation of the stiffness")
            .when("process", MODULATED),
        Key::required("chip_lag", Kind::List(&LAG), "Least and greatest chip-formation lag").when("process", CHIP_LAG),
        Key::required("cutting_stiffness", Kind::List(&CUTTING_STIFFNESS), "Least and greatest stiffness of the cut")
            .when("process", CHIP_LAG),
        Key::optional(
            "allowance",
            Kind::List(&MODULATION),
            "Other first harmonics of the allowance whose boundaries are drawn beside",
        )
        .when("process", LATHE),
        Key::optional("lag", Kind::List(&LAG), "Other lags whose boundaries are drawn beside").when("process", CHUCK),
        Key::default("columns", Kind::Count { min: 2, max: 4000 }, "200", "Points along the speed"),
        Key::default("rows", Kind::Count { min: 2, max: 2000 }, "100", "Points along the depth"),
        Key::default("boundary_only", Kind::Flag, "false", "Trace the boundary without judging the points of the grid"),
    ],
};

static POINT: Form = Form {
    title: "[[point]]",
    doc: "An operating point on the chart",
    keys: &[
        Key::optional("name", Kind::Name, "Name in tables and pictures"),
        Key::required("spindle_speed", SPEED, "Spindle speed").when("process", CUTTING),
        Key::required("depth_of_cut", DEPTH, "Depth of cut").when("process", CUTTING),
        Key::required("speed_ratio", SPEED_RATIO, "Speed over the natural frequency").when("process", MODULATED),
        Key::required("modulation", MODULATION, "Modulation of the stiffness by the jaws").when("process", MODULATED),
        Key::required("chip_lag", LAG, "Chip-formation lag").when("process", CHIP_LAG),
        Key::required("cutting_stiffness", CUTTING_STIFFNESS, "Stiffness of the cut").when("process", CHIP_LAG),
    ],
};
