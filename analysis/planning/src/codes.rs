//! Longer texts for the codes of trials, cycles and contours.

/// Every code that trials, cycles and contours add to those of their files, with its explanation.
pub const CODES: &[(&str, &str)] = &[
    (
        "table",
        "A measured table has a header `name [unit]` and one record a line, each with as many cells as the header. Comma, semicolon or tab separate; with decimal commas, separate by semicolons. Lines that start with # are comments.",
    ),
    (
        "too-few-revolutions",
        "The lag is the deflection that a work revolution leaves to the next. A trial of one revolution holds nothing that could be told from the infeed; count whole revolutions from first contact.",
    ),
    (
        "stock-beyond-infeed",
        "A machine that gives way grinds less than it is told to, so the stock removed is below revolutions times infeed. Where it is not, the revolutions were counted from another moment than first contact, the stock is a diameter, or the feed is not what the dial says.",
    ),
    (
        "force-grows",
        "In spark-out the infeed stands still and the force falls; a force that grows belongs to another trial or another column.",
    ),
    (
        "no-lag",
        "The lag is taken from stock (with infeed and revolutions), from the 95 % rise of the force, from the force that spark-out leaves, or from a recorded force with a rise or decay in it. A trial needs one of them; --basis restricts which count.",
    ),
    (
        "limits-conflict",
        "No cycle, or no spindle speed and feed, meets all the limits that the message names. They are the fewest that already conflict: relaxing one of them is necessary, others may follow.",
    ),
    ("empty-contour", "A contour needs at least one section of some length, and a contour file at least one [[pass]]."),
    ("no-length", "Lines, arcs and splines need a length; two successive points of a spline must differ."),
    (
        "open-contour",
        "`closed = true`, the default, says that the end is the start, within 0.005 mm. Move the last point, or write `closed = false` for a contour with two ends.",
    ),
    (
        "arc-misses-end",
        "Start and end of an arc lie at the same distance from its centre, within 0.005 mm; an arc given by its radius cannot reach farther than its diameter. The usual causes are rounded coordinates and a centre given as a point where an offset is due (I and J are offsets from the start).",
    ),
    (
        "unreachable-corner",
        "At a sharp inside corner the cutter would have to touch both walls at once; draw an arc larger than the cutter there. A path that comes back on itself leaves no material. Both also appear where the cutter is on the wrong side: see cutter_side, or G41 and G42.",
    ),
    (
        "cutter-too-large",
        "On a concave section the cutter's centre runs on a radius smaller by that of the cutter, which must stay above zero. Lukin's system (4) recommends 0.70 to 0.75 of the smallest concave radius.",
    ),
    (
        "section-form",
        "A [[section]] is one of: line; line_to; arc with radius; arc_to with direction and center or radius; spline_to; lobed. `turn` may stand beside any of them.",
    ),
    (
        "gcode",
        "A contour is what a part program moves at feed in the plane XY behind its last rapid motion there. The program is read in the language of its control, as by `toolroom program`; a word that is not understood is refused, because passing it over could change the contour. The unit has to be named (G20, G21, --units), and the compensation of the radius or cutter_side has to say on which side the cutter runs.",
    ),
    (
        "dxf",
        "A contour is what the lines, arcs, circles and polylines of one layer of an ASCII DXF file draw when they are joined end to end, within a thousandth of a millimetre. A spline, an ellipse or a block on that layer is refused, because passing it over could change the contour; texts, dimensions and hatches are passed over. Where several contours are drawn, each is told with its line: name the layer of one. The unit is that of $INSUNITS, or --units.",
    ),
    (
        "no-ramp",
        "With --ramps a feed changes within half of the faster section. Where sections are very short or the acceleration is low, no admissible feed can be reached from the one before; join sections, or raise the acceleration or the range of feeds.",
    ),
    (
        "edge-too-short",
        "One section alone uses up more than a whole edge life at every admissible setting; divide the section, so that the edge can be changed on the way.",
    ),
];
