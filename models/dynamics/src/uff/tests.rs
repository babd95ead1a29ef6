//! Data sets written by hand and what is read of them.

use super::read_uff as read_file;
use crate::error::DynamicsError;
use crate::frf::Measurement;
use crate::hammer::HammerOptions;
use nalgebra::Complex;
use proptest::prelude::*;

fn read_uff(file: &str, bytes: &[u8]) -> Result<Measurement, DynamicsError> {
    read_file(file, bytes, &HammerOptions::default())
}

fn records(kind: i64, directions: [i64; 2], data_type: i64, spacing: i64) -> String {
    format!(
        "tap test\nNONE\n22-Nov-26\nNONE\nNONE\n{kind:5}{:10}{:5}{:10} {:<10}{:10}{:4} {:<10}{:10}{:4}\n\
         {data_type:10}{:10}{spacing:10}{:13.5E}{:13.5E}{:13.5E}\n{:10}    0    0    0 Frequency            Hz\n\
         {:10}    0    0    0 Response             m/s^2\n{:10}    0    0    0 Excitation           N\n\
         {:10}    0    0    0 NONE                 NONE\n",
        1, 1, 0, "TIP", 1, directions[0], "TIP", 1, directions[1], 3, 100.0, 2.0, 0.0, 18, 12, 13, 0
    )
}

const UNITS: &str = "    -1\n   164\n         1SI: Meter (newton)           2\n  1.0000000000000000D+00  \
                     1.0000000000000000D+00  1.0000000000000000D+00\n  2.7314999999999998D+02\n    -1\n";
const VALUES: [[f64; 2]; 3] = [[-1.0, 0.5], [-2.0, 0.25], [-3.0, 0.125]];

fn accelerance(measurement: &Measurement) -> Vec<Complex<f64>> {
    let w = |frequency: f64| std::f64::consts::TAU * frequency;
    let pairs = measurement.functions[0].receptance.iter().zip(&measurement.frequencies);
    pairs.map(|(value, frequency)| -value * w(*frequency).powi(2)).collect()
}

fn same(measurement: &Measurement, sign: f64) {
    assert_eq!(measurement.frequencies, [100.0, 102.0, 104.0]);
    for (value, [re, im]) in accelerance(measurement).iter().zip(VALUES) {
        assert!((value - Complex::new(re, im) * sign).norm() < 1e-5, "{value}");
    }
}

#[test]
fn ascii_numbers_may_touch_and_lines_end_as_they_like() {
    let values = " -1.00000E+00  5.00000E-01 -2.00000E+00  2.50000E-01\n -3.00000E+00  1.25000E-01\n";
    let touching = "-1.000000E+00  5.00000E-01-2.000000E+00  2.50000E-01\n-3.000000E+00  1.25000E-01\n";
    for values in [values, touching] {
        let text = format!("{UNITS}    -1\n    58\n{}{values}    -1\n", records(4, [1, 1], 5, 1));
        same(&read_uff("a", text.as_bytes()).unwrap(), 1.0);
        same(&read_uff("a", text.replace('\n', "\r\n").as_bytes()).unwrap(), 1.0);
        let turned = text.replace(&format!("{:4}\n", 1), &format!("{:4}\n", -1));
        same(&read_uff("a", turned.as_bytes()).unwrap(), -1.0);
    }
}

#[test]
fn binary_blocks_of_both_orders_are_read_whatever_count_they_promise() {
    for order in [1, 2] {
        // Uneven doubles come with an abscissa of single and of double precision.
        for (data_type, spacing, long) in [(5, 1, false), (6, 1, false), (5, 0, false), (6, 0, false), (6, 0, true)] {
            let header = format!("    58b{order:6}{:6}{:12}{:12}", 2, 11, 12);
            let mut bytes = format!("{UNITS}    -1\n{header}\n{}", records(4, [2, 2], data_type, spacing)).into_bytes();
            let mut put = |value: f64, double: bool| {
                let mut raw = if double { value.to_le_bytes().to_vec() } else { (value as f32).to_le_bytes().to_vec() };
                if order == 2 {
                    raw.reverse();
                }
                bytes.extend(raw);
            };
            for (i, pair) in VALUES.iter().enumerate() {
                if spacing == 0 {
                    put(100.0 + 2.0 * i as f64, long);
                }
                pair.iter().for_each(|value| put(*value, data_type == 6));
            }
            bytes.extend(b"\n    -1\n");
            let found = read_uff("a", &bytes).unwrap();
            same(&found, 1.0);
            assert_eq!(found.functions[0].name(), "yy");
            bytes.truncate(bytes.len() - 12);
            assert!(matches!(read_uff("a", &bytes), Err(DynamicsError::Universal { .. })));
        }
    }
}

#[test]
fn what_a_file_promises_and_what_it_holds_must_agree() {
    let values = " -1.00000E+00  5.00000E-01 -2.00000E+00  2.50000E-01\n -3.00000E+00  1.25000E-01\n";
    let response = format!("{UNITS}    -1\n    58\n{}{values}    -1\n", records(4, [1, 1], 5, 1));
    let fault = |text: &str| read_uff("a.uff", text.as_bytes()).unwrap_err().to_string();
    let fewer = response.replacen("         3         1", "         1         1", 1);
    assert!(fault(&fewer).contains("promises 1 values and goes on after them"), "{}", fault(&fewer));
    let more = response.replacen("         3         1", "         4         1", 1);
    assert!(fault(&more).starts_with("a.uff:"), "{}", fault(&more));
    let set = |records: &str, values: &str| format!("{response}    -1\n    58\n{records}{values}\n    -1\n");
    let coherence = records(6, [1, 1], 2, 1);
    let read = |values: &str| read_uff("a.uff", set(&coherence, values).as_bytes());
    let good = read("  1.00000E+00  9.00000E-01  1.00001E+00").unwrap();
    assert_eq!(good.functions[0].coherence.as_deref(), Some(&[1.0, 0.9, 1.0][..]));
    let beyond = read("  1.00000E+00  9.00000E-01  1.50000E+00").unwrap_err().to_string();
    assert!(beyond.contains("coherence at 104 Hz is 1.5"), "{beyond}");
    let elsewhere = coherence.replacen("1.00000E2", "2.00000E2", 1);
    let refused = fault(&set(&elsewhere, "  1.00000E+00  9.00000E-01  1.00000E+00"));
    assert!(refused.contains("the coherence of xx has other frequencies"), "{refused}");
    let upright = response.replace(&format!("{:4}\n", 1), &format!("{:4}\n", 3));
    assert!(fault(&upright).contains("out of the plane of x and y"), "{}", fault(&upright));
}

#[test]
fn a_file_without_units_is_refused() {
    let values = " -1.00000E+00  5.00000E-01 -2.00000E+00  2.50000E-01\n -3.00000E+00  1.25000E-01\n";
    let text = format!("    -1\n    58\n{}{values}    -1\n", records(4, [1, 1], 5, 1)).replace("m/s^2", "V");
    let refused = read_uff("a.uff", text.as_bytes()).unwrap_err().to_string();
    assert!(refused.starts_with("a.uff:2: no data set 164"), "{refused}");
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(noise in prop::collection::vec(any::<u8>(), 0..200), cut in 0usize..900, kind in 0i64..8) {
        let mut bytes = format!("{UNITS}    -1\n    58b     1     2\n{}", records(kind, [1, 2], 5, 1)).into_bytes();
        bytes.truncate(cut);
        bytes.extend(noise);
        let _ = read_uff("a", &bytes);
    }
}
