use super::*;
use crate::Point;
use std::f64::consts::PI;

/// An entity: name, layer, pairs.
type Drawn<'a> = (&'a str, &'a str, &'a [(i32, f64)]);

/// A drawing of entities on layers.
fn drawing(header: &str, list: &[Drawn<'_>]) -> String {
    let mut text = format!("{header}0\nSECTION\n2\nENTITIES\n");
    for (name, layer, pairs) in list {
        text.push_str(&format!("0\n{name}\n8\n{layer}\n"));
        for (code, value) in *pairs {
            text.push_str(&format!("{code}\n{value}\n"));
        }
    }
    text + "0\nENDSEC\n0\nEOF\n"
}

const MM: &str = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n";

/// A slot of 40 mm between centres and 20 mm across, its elements in disorder and partly against each other.
fn slot(header: &str) -> String {
    drawing(
        header,
        &[
            ("LINE", "OUTER", &[(10, 0.0), (20, -10.0), (11, 40.0), (21, -10.0)]),
            ("TEXT", "OUTER", &[(10, 0.0), (20, 0.0)]),
            ("ARC", "OUTER", &[(10, 0.0), (20, 0.0), (40, 10.0), (50, 90.0), (51, 270.0)]),
            ("LINE", "OUTER", &[(10, 0.0), (20, 10.0), (11, 40.0), (21, 10.0)]),
            ("ARC", "OUTER", &[(10, 40.0), (20, 0.0), (40, 10.0), (50, 270.0), (51, 90.0)]),
            ("CIRCLE", "HOLE", &[(10, 0.0), (20, 0.0), (40, 3.0)]),
        ],
    )
}

#[test]
fn lines_and_arcs_of_a_layer_are_joined_in_the_order_of_travel() {
    let contour = read(&slot(MM), Some("OUTER"), None, CutterSide::Left, true).expect("a contour");
    assert!((contour.length() - (0.08 + 0.02 * PI)).abs() < 1e-9, "{}", contour.length());
    assert_eq!(contour.sections.len(), 4);
    // Counterclockwise: every arc turns left.
    assert!(contour.sections.iter().all(|section| section.curvature >= 0.0), "{contour:?}");
    // In inches by its header, and by the unit that is given where it has none.
    let inch = MM.replace("\n4\n", "\n1\n");
    let inches = read(&slot(&inch), Some("OUTER"), Some(1e-3), CutterSide::Left, true).expect("a contour");
    assert!((inches.length() / contour.length() - 25.4).abs() < 1e-6);
    let given = read(&slot(""), Some("OUTER"), Some(1e-3), CutterSide::Left, true).expect("a contour");
    assert!((given.length() - contour.length()).abs() < 1e-12);
}

#[test]
fn polylines_with_bulges_are_lines_and_arcs() {
    // A square of 20 mm whose right side bulges out by a half circle, closed by its flag; drawn clockwise,
    // and milled outside.
    let corners: &[(i32, f64)] = &[
        (90, 4.0),
        (70, 1.0),
        (10, 0.0),
        (20, 0.0),
        (10, 0.0),
        (20, 20.0),
        (10, 20.0),
        (20, 20.0),
        (42, -1.0),
        (10, 20.0),
        (20, 0.0),
    ];
    let contour =
        read(&drawing(MM, &[("LWPOLYLINE", "0", corners)]), None, None, CutterSide::Right, true).expect("one");
    assert!((contour.length() - (0.06 + 0.01 * PI)).abs() < 1e-9, "{}", contour.length());
    // The old form, mirrored by its extrusion: the same length, on the other side of Y.
    let vertex: [&[(i32, f64)]; 4] = [
        &[(10, 0.0), (20, 0.0)],
        &[(10, 0.0), (20, 20.0)],
        &[(10, 20.0), (20, 20.0), (42, -1.0)],
        &[(10, 20.0), (20, 0.0)],
    ];
    let mut list: Vec<Drawn<'_>> = vec![("POLYLINE", "0", &[(70, 1.0), (230, -1.0)])];
    list.extend(vertex.iter().map(|pairs| ("VERTEX", "0", *pairs)));
    list.push(("SEQEND", "0", &[]));
    let mirrored = read(&drawing(MM, &list), None, None, CutterSide::Right, true).expect("one");
    assert!((mirrored.length() - contour.length()).abs() < 1e-9);
    assert!(mirrored.sections.iter().all(|section| section.start.x < 1e-9 && section.curvature >= 0.0), "{mirrored:?}");
}

#[test]
fn what_is_no_contour_is_refused_with_its_line() {
    let refused = |text: &str, layer: Option<&str>| {
        let error = read(text, layer, None, CutterSide::Left, true).expect_err("refused");
        (error.line, error.fault.to_string())
    };
    let (_, several) = refused(&slot(MM), None);
    assert!(several.contains("2 contours"), "{several}");
    let (_, layer) = refused(&slot(MM), Some("INNER"));
    assert!(layer.contains("HOLE, OUTER"), "{layer}");
    assert!(refused(&slot(""), Some("OUTER")).1.contains("--units"));
    let spline =
        drawing(MM, &[("LINE", "A", &[(10, 0.0), (20, 0.0), (11, 1.0), (21, 0.0)]), ("SPLINE", "A", &[(70, 8.0)])]);
    let (line, text) = refused(&spline, Some("A"));
    assert!(line == 28 && text.contains("SPLINE"), "{line}: {text}");
    let line = |to: [f64; 2]| [(10, 0.0), (20, 0.0), (11, to[0]), (21, to[1])];
    let (a, b, c) = (line([1.0, 0.0]), line([0.0, 1.0]), line([1.0, 1.0]));
    let (_, branch) = refused(&drawing(MM, &[("LINE", "0", &a), ("LINE", "0", &b), ("LINE", "0", &c)]), None);
    assert!(branch.contains("branches"), "{branch}");
    assert_eq!(refused("0\nSECTION\nX\nENTITIES\n", None).0, 3);
    assert!(refused("AutoCAD Binary DXF\r\n", None).1.contains("binary"));
    let open = drawing(MM, &[("LINE", "0", &a)]);
    assert!(
        read(&open, None, None, CutterSide::Left, false).is_ok()
            && read(&open, None, None, CutterSide::Left, true).is_err()
    );
}

/// Greatest distance of points of a contour from a curve, by a function that gives it, m.
fn strays(contour: &crate::Contour, distance: impl Fn(Point) -> f64) -> f64 {
    let points = contour
        .sections
        .iter()
        .flat_map(|section| (0..=20).map(move |i| section.at(section.length * f64::from(i) / 20.0)));
    points.map(distance).fold(0.0, f64::max)
}

#[test]
fn ellipses_are_tangent_arcs_within_a_micrometre() {
    let (a, b) = (0.03, 0.02);
    // Axes turned by 30 degrees about (5, 7) mm.
    let (sin, cos) = (PI / 6.0).sin_cos();
    let place: &[(i32, f64)] =
        &[(10, 5.0), (20, 7.0), (11, 30.0 * cos), (21, 30.0 * sin), (40, 2.0 / 3.0), (41, 0.0), (42, 2.0 * PI)];
    let drawn = drawing(MM, &[("ELLIPSE", "0", place)]);
    let ((contour, _), told) = read_placed(&drawn, (None, None, JOIN), Some(CutterSide::Left), true).expect("one");
    // Distance by the implicit equation over its slope.
    let distance = |point: Point| {
        let (x, y) = (point.x - 0.005, point.y - 0.007);
        let (u, v) = ((cos * x + sin * y) / a, (cos * y - sin * x) / b);
        (u * u + v * v - 1.0).abs() / (2.0 * (u / a).hypot(v / b))
    };
    let residual = strays(&contour, distance);
    assert!(residual < 1.05e-6 && (told / residual - 1.0).abs() < 0.1, "{residual} {told}");
    // Perimeter by the arithmetic and geometric mean.
    let (mut x, mut y, mut sum, mut power): (f64, f64, f64, f64) = (a, b, a * a, 1.0);
    for _ in 0..6 {
        let c = 0.5 * (x - y);
        (x, y) = (0.5 * (x + y), (x * y).sqrt());
        sum -= power * c * c;
        power *= 2.0;
    }
    let perimeter = 2.0 * PI * (sum - 0.5 * (a * a - b * b)) / x;
    assert!((contour.length() / perimeter - 1.0).abs() < 1e-5, "{} {perimeter}", contour.length());
    assert!(contour.corners.is_empty() && contour.sections.iter().all(|section| section.curvature > 0.0));
    assert!(contour.sections.iter().all(|section| (section.arc_angle - 2.0 * PI).abs() < 1e-3));
    // A half, closed by its axis, seen from below: its parameter runs the other way round.
    let half: &[(i32, f64)] =
        &[(10, 0.0), (20, 0.0), (11, 30.0), (21, 0.0), (40, 0.5), (41, 0.0), (42, PI), (230, -1.0)];
    let axis: &[(i32, f64)] = &[(10, -30.0), (20, 0.0), (11, 30.0), (21, 0.0)];
    let text = drawing(MM, &[("ELLIPSE", "0", half), ("LINE", "0", axis)]);
    let contour = read(&text, None, None, CutterSide::Right, true).expect("one");
    assert!(contour.sections.iter().all(|section| section.start.y < 1e-9), "{contour:?}");
    assert_eq!(contour.corners.len(), 2);
}

/// A spline: degree, knots, points and weights.
fn nurbs(degree: f64, knots: &[f64], points: &[(f64, f64)], weights: &[f64]) -> Vec<(i32, f64)> {
    let mut pairs = vec![(70, 8.0), (71, degree)];
    pairs.extend(knots.iter().map(|knot| (40, *knot)));
    pairs.extend(weights.iter().map(|weight| (41, *weight)));
    pairs.extend(points.iter().flat_map(|(x, y)| [(10, *x), (20, *y), (30, 0.0)]));
    pairs
}

#[test]
fn splines_follow_their_control_points_within_a_micrometre() {
    // A circle of 20 mm radius is a rational spline of degree 2 with nine points.
    let knots = [0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0];
    let r = 20.0;
    let points = [(r, 0.0), (r, r), (0.0, r), (-r, r), (-r, 0.0), (-r, -r), (0.0, -r), (r, -r), (r, 0.0)];
    let half = 0.5f64.sqrt();
    let weights = [1.0, half, 1.0, half, 1.0, half, 1.0, half, 1.0];
    let circle = nurbs(2.0, &knots, &points, &weights);
    let contour = read(&drawing(MM, &[("SPLINE", "0", &circle)]), None, None, CutterSide::Left, true).expect("one");
    let residual = strays(&contour, |point| (point.x.hypot(point.y) - 0.02).abs());
    assert!(residual < 1e-6, "{residual}");
    assert!((contour.length() / (0.04 * PI) - 1.0).abs() < 1e-6 && contour.corners.is_empty());
    // A cubic of two spans against de Casteljau's construction of its two halves: knots 0 and 2 fourfold, 1 single.
    let [p0, p1, p2, p3, p4] = [(0.0, 0.0), (10.0, 30.0), (30.0, 30.0), (40.0, 10.0), (60.0, 0.0)];
    let wave = nurbs(3.0, &[0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0, 2.0], &[p0, p1, p2, p3, p4], &[]);
    let back: &[(i32, f64)] = &[(10, 60.0), (20, 0.0), (11, 0.0), (21, 0.0)];
    let text = drawing(MM, &[("SPLINE", "0", &wave), ("LINE", "0", back)]);
    let contour = read(&text, None, None, CutterSide::Right, true).expect("one");
    let mean = |a: (f64, f64), b: (f64, f64)| (0.5 * (a.0 + b.0), 0.5 * (a.1 + b.1));
    // Knot insertion at 1: the Bezier points of both halves.
    let (a, b) = (mean(p1, p2), mean(p2, p3));
    let middle = mean(a, b);
    let beziers = [[p0, p1, a, middle], [middle, b, p3, p4]];
    let mut farthest: f64 = 0.0;
    for bezier in beziers {
        for i in 0..=50 {
            let t = f64::from(i) / 50.0;
            let w = [(1.0 - t).powi(3), 3.0 * t * (1.0 - t).powi(2), 3.0 * t * t * (1.0 - t), t.powi(3)];
            let sum = |of: fn(&(f64, f64)) -> f64| bezier.iter().zip(w).map(|(p, w)| 1e-3 * of(p) * w).sum::<f64>();
            let point = Point { x: sum(|p| p.0), y: sum(|p| p.1) };
            let near = contour.sections.iter().map(|section| crate::Track::new(*section).distance(point));
            farthest = farthest.max(near.fold(f64::INFINITY, f64::min));
        }
    }
    assert!(farthest < 1e-6, "{farthest}");
    assert_eq!(contour.corners.len(), 2);
    // Degree 1 is a polyline.
    let lines = nurbs(1.0, &[0.0, 0.0, 1.0, 2.0, 3.0, 3.0], &[(0.0, 0.0), (30.0, 0.0), (30.0, 40.0), (0.0, 0.0)], &[]);
    let contour = read(&drawing(MM, &[("SPLINE", "0", &lines)]), None, None, CutterSide::Right, true).expect("one");
    assert!((contour.length() - 0.12).abs() < 1e-9 && contour.sections.len() == 3, "{contour:?}");
    for (knots, what) in
        [(&[0.0, 0.0, 1.0, 1.0][..], "do not belong"), (&[0.0, 0.0, 3.0, 2.0, 4.0, 4.0][..], "do not rise")]
    {
        let bad = nurbs(1.0, knots, &[(0.0, 0.0), (30.0, 0.0), (30.0, 40.0), (0.0, 0.0)], &[]);
        let error = read(&drawing(MM, &[("SPLINE", "0", &bad)]), None, None, CutterSide::Left, true).expect_err("bad");
        assert!(error.fault.to_string().contains(what), "{}", error.fault);
    }
}

#[test]
fn blocks_are_drawn_where_they_are_inserted() {
    // A slot of two lines and two arcs on layer 0 of a block whose base is its left centre, inserted through another block.
    let block = |name: &str, base: f64, inside: &str| {
        format!("0\nBLOCK\n8\n0\n2\n{name}\n10\n{base}\n20\n0\n{inside}0\nENDBLK\n8\n0\n")
    };
    let slot = "0\nLINE\n8\n0\n10\n0\n20\n-10\n11\n40\n21\n-10\n0\nARC\n8\n0\n10\n40\n20\n0\n40\n10\n50\n270\n51\n90\n\
                0\nLINE\n8\n0\n10\n40\n20\n10\n11\n0\n21\n10\n0\nARC\n8\n0\n10\n0\n20\n0\n40\n10\n50\n90\n51\n270\n0\nCIRCLE\n8\nHOLE\n10\n0\n20\n0\n40\n3\n";
    let nested = "0\nINSERT\n8\n0\n2\nSLOT\n10\n5\n20\n0\n41\n-2\n42\n2\n50\n30\n";
    let text = |insert: &str| {
        let blocks = block("SLOT", 0.0, slot) + &block("OUTER", 5.0, nested);
        format!("{MM}0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{insert}0\nENDSEC\n0\nEOF\n")
    };
    let insert = "0\nINSERT\n8\nPART\n2\nOUTER\n10\n100\n20\n50\n50\n90\n";
    let read = |text: &str, layer: &str| read(text, Some(layer), None, CutterSide::Left, true);
    let part = read(&text(insert), "PART").expect("a contour");
    assert!((part.length() - 2.0 * (0.08 + 0.02 * PI)).abs() < 1e-9, "{}", part.length());
    let hole = read(&text(insert), "HOLE").expect("a contour on the layer of its own");
    assert!((hole.length() - 0.012 * PI).abs() < 1e-9);
    // Its two halves begin on opposite sides of the place to which base and insertions bring its centre.
    let middle = |of: fn(&Section) -> f64| hole.sections.iter().map(of).sum::<f64>() / hole.sections.len() as f64;
    let (x, y) = (middle(|section| section.start.x), middle(|section| section.start.y));
    assert!((x - 0.1).abs() < 1e-9 && (y - 0.05).abs() < 1e-9, "{x} {y}");
    let stretched = insert.replace("50\n90\n", "41\n2\n42\n1\n");
    assert!(read(&text(&stretched), "PART").expect_err("ellipses").to_string().contains("ellipses of arcs"));
    let twice = insert.replace("50\n90\n", "70\n2\n44\n300\n");
    assert!(read(&text(&twice), "PART").expect_err("two").to_string().contains("2 contours"));
    assert!(
        read(&text(&insert.replace("OUTER", "INNER")), "PART")
            .expect_err("none")
            .to_string()
            .contains("not in the file")
    );
    let itself = text(insert).replace("2\nSLOT\n10\n5", "2\nOUTER\n10\n5");
    assert!(read(&itself, "PART").expect_err("endless").to_string().contains("deep"));
}

#[test]
fn ends_within_a_given_distance_are_one_point() {
    // The slot whose lower line ends 8 um before one arc and 6 um beside the other, and whose upper line begins 5 um off.
    let text = slot(MM).replacen("10\n0\n20\n-10\n11\n40\n21\n-10\n", "10\n0\n20\n-9.994\n11\n39.992\n21\n-10\n", 1);
    let text = text.replacen("10\n0\n20\n10\n11\n40\n21\n10\n", "10\n0.003\n20\n10.004\n11\n40\n21\n10\n", 1);
    let joined = |join: f64| read_placed(&text, (Some("OUTER"), None, join), Some(CutterSide::Left), true);
    let open = joined(JOIN).expect_err("open").to_string();
    assert!(open.contains("--join") && open.contains("mm between its ends"), "{open}");
    let ((contour, _), _) = joined(10e-6).expect("a contour");
    assert_eq!(contour.sections.len(), 4);
    assert!((contour.length() - (0.08 + 0.02 * PI)).abs() < 20e-6, "{}", contour.length());
    // Nothing that met before is moved.
    let ((same, _), _) =
        read_placed(&slot(MM), (Some("OUTER"), None, 10e-6), Some(CutterSide::Left), true).expect("a contour");
    assert_eq!(same, read(&slot(MM), Some("OUTER"), None, CutterSide::Left, true).expect("a contour"));
    // Two arcs that miss each other meet halfway.
    let arcs = drawing(
        MM,
        &[
            ("ARC", "A", &[(10, 0.0), (20, 0.0), (40, 10.0), (50, 0.0), (51, 180.0)]),
            ("ARC", "A", &[(10, 0.004), (20, 0.0), (40, 10.0), (50, 180.0), (51, 0.0)]),
        ],
    );
    let ((circle, _), _) =
        read_placed(&arcs, (Some("A"), None, 10e-6), Some(CutterSide::Left), true).expect("a circle");
    assert!((circle.length() - 0.02 * PI).abs() < 20e-6 && circle.sections.len() == 2, "{circle:?}");
}

#[test]
fn ends_that_differ_by_the_digits_of_the_drawing_are_one_point() {
    // Four decimals of an inch: the lower line ends 3.6 um from the arc.
    let text = slot(MM).replacen("11\n40\n21\n-10\n", "11\n40.0025\n21\n-10.0025\n", 1);
    let contour = read(&text, Some("OUTER"), None, CutterSide::Left, true).expect("a contour");
    assert!((contour.length() - (0.08 + 0.02 * PI)).abs() < 10e-6, "{}", contour.length());
    let wide = slot(MM).replacen("11\n40\n21\n-10\n", "11\n40.006\n21\n-10\n", 1);
    let open = read(&wide, Some("OUTER"), None, CutterSide::Left, true).expect_err("open").to_string();
    assert!(open.contains("the contour is open: its end is 0.0060 mm from its start"), "{open}");
}

#[test]
fn an_outline_has_the_holes_of_its_layer() {
    let circle = |x: f64, radius: f64| ("CIRCLE", "A", [(10, x), (20, 0.0), (40, radius)]);
    let circles = [circle(0.0, 50.0), circle(20.0, 5.0), circle(-20.0, 8.0)];
    let drawn: Vec<_> = circles.iter().map(|(kind, layer, codes)| (*kind, *layer, &codes[..])).collect();
    let text = drawing(MM, &drawn);
    let length: f64 =
        read_outline(&text, Some("A"), None).expect("outlines").iter().map(|section| section.length).sum();
    assert!((length - 2.0 * PI * 0.063).abs() < 1e-9, "{length}");
    // One contour is asked for where a cutter runs.
    let several = read(&text, Some("A"), None, CutterSide::Left, true).expect_err("three").to_string();
    assert!(several.contains("3 contours"), "{several}");
}
