//! Other units of length, time, mass and money change no ratio.

use proptest::prelude::*;
use toolroom_contour::{
    Contour, Corner, CornerPolicy, CutterSide, Models, Objective, Parameters, Pass, PathError, Planner, Point, Section,
    Setting, Trace, VelocityLoop,
};
use toolroom_process::{AnyRecord, unit};

/// Size of the new units in old ones.
#[derive(Clone, Copy, Debug)]
struct Units {
    length: f64,
    mass: f64,
    time: f64,
    money: f64,
}

impl Units {
    fn rescale(&self, record: &mut dyn AnyRecord) {
        for (i, field) in record.fields().iter().enumerate() {
            let [length, mass, time, _, _, _, _, money] = unit::parse(field.unit).unwrap().dimension;
            let factor = self.length.powi(length.into())
                * self.mass.powi(mass.into())
                * self.time.powi(time.into())
                * self.money.powi(money.into());
            let value = record.value(i).unwrap() / factor;
            record.set_value(i, value);
        }
    }

    fn contour(&self, contour: &Contour) -> Contour {
        let l = self.length;
        let section = |s: &Section| Section {
            start: Point { x: s.start.x / l, y: s.start.y / l },
            length: s.length / l,
            curvature: s.curvature * l,
            ..*s
        };
        Contour { sections: contour.sections.iter().map(section).collect(), ..contour.clone() }
    }
}

proptest! {
    #[test]
    fn ratios_and_plans_do_not_depend_on_the_units(
        length in 0.8..1.25f64, mass in 0.8..1.25f64, time in 0.8..1.25f64, money in 0.8..1.25f64,
    ) {
        let units = Units { length, mass, time, money };
        let mut trace = Trace::new(Point::default(), 0.0);
        trace.line(0.05).unwrap();
        trace.arc(0.04, -1.0).unwrap();
        trace.turn(0.5);
        trace.arc(0.03, 1.0).unwrap();
        let contour = trace.finish(CutterSide::Right, false).unwrap();
        let (parameters, pass) = (Parameters::default(), Pass::default());
        let models = |length: f64, time: f64| Models {
            path_error: PathError::Servo { velocity_loop: Some(VelocityLoop { frequency: 120.0 * time, damping: 0.7 }) },
            corners: CornerPolicy::Loop { radius: 2e-3 / length, tolerance: None },
            ..Models::default()
        };
        let (mut other, mut other_pass) = (parameters.clone(), pass);
        for (_, record) in other.parameters_mut() {
            units.rescale(record);
        }
        units.rescale(&mut other_pass);
        // The handbook's life is an equation in millimetres and minutes: its constant takes up
        // the powers that the ratios to those leave over.
        let life = &parameters.life;
        let powers = life.diameter_exponent - life.immersion_exponent - life.feed_exponent - life.depth_exponent;
        other.life.speed_constant *= length.powf(powers) * time.powf(-life.life_exponent);
        let (here, there) = (models(1.0, 1.0), models(length, time));
        let moved = units.contour(&contour);
        let planner = Planner::new(&contour, &parameters, &pass, &here).unwrap();
        let rescaled = Planner::new(&moved, &other, &other_pass, &there).unwrap();
        let setting = Setting { spindle_speed: 150.0, feed_per_tooth: 0.07e-3 };
        let same = Setting { spindle_speed: 150.0 * time, feed_per_tooth: 0.07e-3 / length };
        for i in 0..3 {
            let (a, b) = (planner.evaluate(i, setting).unwrap(), rescaled.evaluate(i, same).unwrap());
            for ((constraint, one), (_, another)) in a.ratios.iter().zip(b.ratios.iter()) {
                prop_assert!((one / another - 1.0).abs() < 1e-9, "{constraint}: {one} {another}");
            }
            prop_assert!((a.wall_error() / (b.wall_error() * length) - 1.0).abs() < 1e-9);
        }
        for (a, b) in planner.corner_moves().iter().zip(rescaled.corner_moves()) {
            let Corner { interior_angle, .. } = a.corner;
            prop_assert!((a.time / (b.time * time) - 1.0).abs() < 1e-9, "{interior_angle}");
        }
        // One setting for all: gear series are preferred numbers in rpm and do not rescale.
        let (a, b) = (planner.plan(&[setting; 3]).unwrap(), rescaled.plan(&[same; 3]).unwrap());
        prop_assert!((a.time / (b.time * time) - 1.0).abs() < 1e-9);
        prop_assert!((a.cost / (b.cost * money) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn questionable_models_and_cutters_are_warned_of() {
    use toolroom_contour::Warning;
    let mut trace = Trace::new(Point::default(), 0.0);
    trace.arc(0.05, 1.0).unwrap();
    let hollow = trace.finish(CutterSide::Left, false).unwrap();
    let (parameters, pass) = (Parameters::default(), Pass::default());
    let warnings = |path_error: PathError| {
        let models = Models { path_error, ..Models::default() };
        Planner::new(&hollow, &parameters, &pass, &models).unwrap().optimal(Objective::Time).unwrap().warnings
    };
    let usual = warnings(PathError::default());
    assert!(usual.iter().any(|w| matches!(w, Warning::CutterRadius { ratio } if (ratio - 0.32).abs() < 1e-12)));
    assert!(!usual.iter().any(|w| matches!(w, Warning::ExplicitEuler { .. } | Warning::EmpiricalPathError)));
    // The wall over its height is 20 % worse than the average force says.
    assert!(usual.iter().any(|w| matches!(w, Warning::MeanForce { excess } if *excess > 5e-6)), "{usual:?}");
    assert!(warnings(PathError::ExplicitEuler { step: 0.005 }).contains(&Warning::ExplicitEuler { step: 0.005 }));
    assert!(warnings(PathError::Empirical).contains(&Warning::EmpiricalPathError));
}
