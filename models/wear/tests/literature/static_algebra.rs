//! Quasi-steady algebra at one point.
//!
//! Origin: independent reference implementation of the model in Python, seven digits printed;
//! tolerance 1e-6 relative.

use toolroom_wear::{Cut, Pair};

/// Pair; feed mm, depth mm, hardness, mechanical and thermal multiplier, speed m/min, wear mm;
/// temperature K, A um/m, B um/min, J um/m, cutting force N, feed force N, power kW, EMF mV.
type Row = (&'static str, [f64; 7], [f64; 8]);

#[rustfmt::skip]
const POINTS: [Row; 9] = [
    ("ni_vk6om", [0.12, 0.75, 1.0, 1.0, 1.0, 40.0, 0.0], [883.872, 4.662087, 0.3234741, 4.670173, 530.6115, 212.2446, 0.353741, 8.307834]),
    ("ni_vk6om", [0.12, 0.75, 1.0, 1.0, 1.0, 40.0, 0.2], [1028.916, 0.249931, 10.00309, 0.5000084, 604.8577, 347.2446, 0.4032385, 8.562512]),
    ("ni_vk6om", [0.12, 0.75, 1.0, 1.0, 1.0, 30.0, 0.5], [1043.051, 0.1673841, 20.07695, 0.8366157, 716.227, 549.7446, 0.3581135, 8.484734]),
    ("ni_vk6om", [0.11, 0.5, 1.0, 1.0, 1.0, 60.0, 0.35], [1209.101, 0.01291972, 247.3975, 4.136212, 418.0141, 290.0574, 0.4180141, 10.26951]),
    ("ni_vk8", [0.11, 0.5, 1.0, 1.0, 1.0, 40.0, 0.2], [1003.24, 0.980581, 15.48176, 1.367625, 380.891, 222.5574, 0.2539273, 8.224451]),
    ("ni_vk6om_hb", [0.12, 0.75, 1.0, 1.0, 1.0, 40.0, 0.2], [1014.462, 0.3001602, 7.993021, 0.4999857, 604.8577, 347.2446, 0.4032385, 9.159013]),
    ("c45_t15k6", [0.3, 1.5, 1.0, 1.0, 1.0, 180.0, 0.2], [1140.761, 0.01950546, 1.34889, 0.02699929, 943.1376, 472.975, 2.829413, 13.56895]),
    ("ti_vk6", [0.2, 1.0, 1.0, 1.0, 1.0, 50.0, 0.2], [964.1819, 0.2443277, 6.783294, 0.3799936, 557.7076, 355.3302, 0.4647563, 7.827665]),
    ("ni_vk6om", [0.12, 0.75, 1.05, 1.2, 0.9, 40.0, 0.3], [1090.928, 0.102938, 32.05619, 0.9043427, 661.7569, 422.655, 0.4411713, 9.096282]),
];

#[test]
fn the_static_algebra_agrees_with_the_reference() {
    for (name, [feed, depth, hardness, mechanical_factor, thermal_factor, speed, wear], expected) in POINTS {
        let pair = Pair::named(name).unwrap();
        let cut = Cut {
            hardness,
            mechanical_factor,
            thermal_factor,
            ..Cut::nominal(speed / 60.0, feed * 1e-3, depth * 1e-3)
        };
        let p = pair.point(&cut, wear * 1e-3);
        let computed = [
            p.temperature,
            p.mechanical_wear_per_path * 1e6,
            p.thermal_wear_rate * 60e6,
            p.wear_intensity * 1e6,
            p.cutting_force,
            p.feed_force,
            p.spindle_power * 1e-3,
            p.thermo_emf * 1e3,
        ];
        for (i, (computed, expected)) in computed.into_iter().zip(expected).enumerate() {
            assert!((computed / expected - 1.0).abs() < 1e-6, "{name}, column {i}: {computed}, reference {expected}");
        }
    }
}
