//! Keys of contour files.

use crate::{
    ConditionScatter, Cutter, CutterSide, Economics, EdgeForce, EngagementModel, FormError, Machine, MillLife, Milling,
    Pass,
};
use toolroom_form::{Form, Key, Kind, joined, record_keys};
use toolroom_process::Record;

/// A kilometre, beyond every machine (assumption).
const FARTHEST: f64 = 1e3;

const LENGTH: Kind = Kind::quantity("m", "mm", -FARTHEST, FARTHEST, "50 mm");
/// Up to some sixteen revolutions: beyond every arc (assumption).
const ANGLE: Kind = Kind::quantity("rad", "deg", -100.0, 100.0, "90 deg");
const POINT: Kind = Kind::List(&LENGTH);

toolroom_form::vocabulary! {
    /// Which way an arc turns.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum Direction {
        /// Counter-clockwise.
        Left = "left",
        /// Clockwise.
        Right = "right",
    }
}

toolroom_form::vocabulary! {
    /// Laws of the drives.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum PathErrorWord {
        /// Drives of first or third order.
        Servo = "servo",
        /// Lukin's regression.
        Empirical = "empirical",
        /// Steps of an interpolator.
        ExplicitEuler = "explicit_euler",
        /// None.
        Off = "off",
    }
}

toolroom_form::vocabulary! {
    /// Ways past a sharp corner.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum CornerWord {
        /// Around it.
        Loop = "loop",
        /// Standing still at it.
        ExactStop = "exact_stop",
        /// Slower.
        SlowDown = "slow_down",
    }
}

static PATH_ERROR: Form = Form {
    title: "path_error",
    doc: "Error of the drives",
    keys: &[
        Key::required("model", Kind::Choice(PathErrorWord::WORDS), "Law of the drives"),
        Key::required("step", Kind::positive("s", "ms", 10.0, "10 ms"), "Step of the interpolator")
            .when("model", &["explicit_euler"]),
        Key::optional(
            "velocity_loop_frequency",
            Kind::positive("rad/s", "rad/s", 1e6, "120 rad/s"),
            "Natural frequency of the velocity loop; left out, the loop is ideal",
        )
        .when("model", &["servo"]),
        Key::optional(
            "velocity_loop_damping",
            Kind::positive("1", "1", 100.0, "0.7"),
            "Damping ratio of the velocity loop",
        )
        .when("model", &["servo"]),
    ],
};

static CORNERS: Form = Form {
    title: "corners",
    doc: "How sharp outside corners are passed",
    keys: &[
        Key::required("policy", Kind::Choice(CornerWord::WORDS), "Way past the corner"),
        Key::required("radius", Kind::positive("m", "mm", FARTHEST, "2 mm"), "Radius of the loop")
            .when("policy", &["loop"]),
        Key::optional(
            "tolerance",
            Kind::positive("m", "mm", FARTHEST, "0.05 mm"),
            "Deviation that is admitted at the corner",
        )
        .when("policy", &["loop", "slow_down"]),
    ],
};

static MACHINE: Form = Form {
    title: "[machine]",
    doc: "Deviations of the machine from the parameter set",
    keys: &record_keys::<{ Machine::<f64>::FIELDS.len() }>(Machine::FIELDS),
};

static CUTTER: Form = Form {
    title: "[cutter]",
    doc: "Deviations of the cutter from the parameter set",
    keys: &record_keys::<{ Cutter::<f64>::FIELDS.len() }>(Cutter::FIELDS),
};

static FORCE: Form = Form {
    title: "[force]",
    doc: "Deviations of the edge forces from the parameter set",
    keys: &record_keys::<{ EdgeForce::<f64>::FIELDS.len() }>(EdgeForce::FIELDS),
};

static LIFE: Form = Form {
    title: "[life]",
    doc: "Deviations of the edge life from the parameter set",
    keys: &record_keys::<{ MillLife::<f64>::FIELDS.len() }>(MillLife::FIELDS),
};

static ECONOMICS: Form = Form {
    title: "[economics]",
    doc: "Deviations of times and costs from the parameter set",
    keys: &record_keys::<{ Economics::<f64>::FIELDS.len() }>(Economics::FIELDS),
};

static SCATTER: Form = Form {
    title: "[scatter]",
    doc: "How conditions scatter in a sensitivity study",
    keys: &record_keys::<{ ConditionScatter::<f64>::FIELDS.len() }>(ConditionScatter::FIELDS),
};

static PASS: Form = Form {
    title: "[[pass]]",
    doc: "A pass along the contour",
    keys: &joined::<{ 1 + Pass::<f64>::FIELDS.len() }>(&[
        &[Key::required("name", Kind::Name, "Name, such as finish")],
        &record_keys::<{ Pass::<f64>::FIELDS.len() }>(Pass::FIELDS),
    ]),
};

toolroom_form::vocabulary! {
    /// Arcs that stand for a curve.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum Approximation {
        /// Pairs of arcs that meet the curve in its own directions.
        Biarc = "biarc",
        /// One arc of the mean radius a section, as in the paper: off by hundreds of micrometres.
        MeanRadius = "mean_radius",
    }
}

static LOBED: Form = Form {
    title: "lobed",
    doc: "A whole profile of equal width",
    keys: &[
        Key::required("diameter", LENGTH, "Mean diameter"),
        Key::required("eccentricity", LENGTH, "Amplitude of the support function"),
        Key::required("lobes", Kind::Count { min: 0, max: u32::MAX as u64 }, "Lobes"),
        Key::default("approximation", Kind::Choice(Approximation::WORDS), "biarc", "Arcs that stand for the profile"),
        Key::required("sections", Kind::Count { min: 0, max: u32::MAX as u64 }, "Arcs into which it is divided")
            .when("approximation", &["mean_radius"]),
        Key::optional(
            "sections",
            Kind::Count { min: 0, max: u32::MAX as u64 },
            "Pairs of arcs into which it is divided; the fewest within the tolerance where left out",
        )
        .when("approximation", &["biarc"]),
        Key::default(
            "tolerance",
            Kind::positive("m", "um", FARTHEST, "1 um"),
            "1 um",
            "Greatest distance of the arcs from the profile",
        )
        .when("approximation", &["biarc"]),
    ],
};

static SECTION: Form = Form {
    title: "[[section]]",
    doc: "A section of the contour: line, arc, spline or a whole profile",
    keys: &[
        Key::optional("turn", ANGLE, "A corner before the section, positive to the left"),
        Key::optional("line", LENGTH, "Straight on, by this length"),
        Key::optional("line_to", POINT, "Straight to this point"),
        Key::optional("arc", ANGLE, "Arc by this angle, positive to the left; with radius"),
        Key::optional("arc_to", POINT, "Arc to this point; with direction and with center or radius"),
        Key::optional("radius", LENGTH, "Radius of the arc"),
        Key::optional("center", POINT, "Centre of the arc"),
        Key::optional("direction", Kind::Choice(Direction::WORDS), "Side to which the arc turns"),
        Key::optional("spline_to", Kind::List(&POINT), "Smooth curve through these points"),
        Key::optional("lobed", Kind::Table(&LOBED), "A whole profile of equal width"),
    ],
};

/// What stands in a contour file whoever draws the contour.
const SETUP_KEYS: [Key; 17] = [
    Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
    Key::required("name", Kind::Name, "Name"),
    Key::required("title", Kind::Text, "One line for people"),
    Key::optional("parameter_set", Kind::Text, "Shipped set of machine, cutter, forces, life and economics"),
    Key::default("closed", Kind::Flag, "true", "Whether the contour ends where it starts"),
    Key::optional("cutter_side", Kind::Choice(CutterSide::WORDS), "Side of the path on which the cutter runs"),
    Key::optional("milling", Kind::Choice(Milling::WORDS), "Down or up milling"),
    Key::optional("path_error", Kind::Table(&PATH_ERROR), "Error of the drives"),
    Key::optional("form_error", Kind::Choice(FormError::WORDS), "Which deflection the accuracy sees"),
    Key::optional("corners", Kind::Table(&CORNERS), "How sharp outside corners are passed"),
    Key::optional(
        "engagement",
        Kind::Choice(EngagementModel::WORDS),
        "Whether limits hold along the path (where left out) or for one engagement a section",
    ),
    Key::optional("machine", Kind::Table(&MACHINE), "Deviations of the machine from the parameter set"),
    Key::optional("cutter", Kind::Table(&CUTTER), "Deviations of the cutter from the parameter set"),
    Key::optional("force", Kind::Table(&FORCE), "Deviations of the edge forces from the parameter set"),
    Key::optional("life", Kind::Table(&LIFE), "Deviations of the edge life from the parameter set"),
    Key::optional("economics", Kind::Table(&ECONOMICS), "Deviations of times and costs from the parameter set"),
    Key::optional("scatter", Kind::Table(&SCATTER), "How conditions scatter in a sensitivity study"),
];

const PASSES: [Key; 1] = [Key::optional("pass", Kind::Tables(&PASS), "Passes, at least one")];

/// What draws the contour.
const DRAWING: [Key; 3] = [
    Key::optional("start", POINT, "Where the contour begins, the origin if left out"),
    Key::optional("heading", ANGLE, "Direction at the start, from X"),
    Key::optional("section", Kind::Tables(&SECTION), "Sections of the contour, in order"),
];

/// Keys of a contour file.
pub static CONTOUR: Form = Form {
    title: "the contour file",
    doc: "A contour to be milled, its passes, and how both are modelled",
    keys: &joined::<21>(&[&SETUP_KEYS, &PASSES, &DRAWING]),
};

/// Keys of a setup file: a contour file whose contour a part program draws.
pub static SETUP: Form = Form {
    title: "the setup file",
    doc: "Passes around a contour that a part program draws, and how they are modelled",
    keys: &joined::<18>(&[&SETUP_KEYS, &PASSES]),
};
