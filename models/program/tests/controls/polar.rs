//! Polar coordinates of Fanuc and Haas (G16), absolute and by steps, worked out by hand.

use super::{does, refused};
use std::f64::consts::SQRT_2;
use toolroom_program::Dialect::{Fanuc, Haas};

#[test]
fn an_angle_by_steps_goes_on_about_the_same_pole() {
    // Chords of 60 and of 30 degrees on a circle of 10 mm, then 10 mm along the radius.
    let text = "G21 G90 G0 X10. Y0 Z0\nG16\nG1 X10. Y0 F600\nG91 Y60.\nY30.\nG90 X20.\nG15";
    let way = 10.0 + 20.0 * 15f64.to_radians().sin() + 10.0;
    does(Fanuc, text, (way / 10.0, 0.2, 0.0, [0.0, 20.0, 0.0]));
}

#[test]
fn a_radius_by_steps_is_measured_from_where_the_tool_stands() {
    // From (10, 0) 5 mm at 90 deg, then a step of 90 deg about (10, 0): a chord of 5 √2 to (5, 0).
    let text = "G21 G90 G0 X10. Y0 Z0\nG16\nG91 G1 X5. Y90. F600\nY90.\nG15";
    does(Haas, text, (0.5 + 0.5 * SQRT_2, 0.2, 0.0, [5.0, 0.0, 0.0]));
    // An absolute radius is measured from the origin again.
    let back = text.replace("\nG15", "\nG90 X20. Y90.\nG15");
    let way = 5.0 + 5.0 * SQRT_2 + 20f64.hypot(5.0);
    does(Haas, &back, (way / 10.0, 0.2, 0.0, [0.0, 20.0, 0.0]));
    assert!(
        refused(Fanuc, "G21 G90 G0 Z0\nG28 X0 Y0\nG16\nG91 G1 X5. Y90. F600").message.contains("begins at a place")
    );
}

#[test]
fn holes_by_steps_of_the_angle_stand_on_their_circle() {
    // Four holes of 7 mm at 100 mm/min; from hole to hole a quarter of the circle in rapid motion, 20 mm of the longest axis.
    let holes = |repeats: &str| {
        format!("G21 G90 G0 X0 Y0 Z5.\nG16\nG81 X20. Y0 Z-5. R2. F100\nG91 {repeats}\nG80 G15 G90\nM30")
    };
    let rapid = (95.0 + 20.0 + 4.0 * (3.0 + 10.0) + 3.0 * 20.0) / 500.0;
    does(Fanuc, &holes("Y90.\nY90.\nY90."), (4.0 * 4.2, rapid, 0.0, [0.0, -20.0, 5.0]));
    does(Fanuc, &holes("Y90. K3"), (4.0 * 4.2, rapid, 0.0, [0.0, -20.0, 5.0]));
    does(Haas, &holes("Y90. L3"), (4.0 * 4.2, rapid, 0.0, [0.0, -20.0, 5.0]));
}
