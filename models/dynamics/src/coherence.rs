//! Coherence from a file of its own: many analysers export responses and coherence apart.

use crate::error::DynamicsError;
use crate::frf::{Direction, Measurement};

/// Relative difference up to which two frequencies are one line (assumption: both files are written with six digits at least).
const SAME_LINE: f64 = 1e-5;

/// Coherence of one or several functions.
#[derive(Clone, Debug, PartialEq)]
pub struct CoherenceTable {
    /// The file, as messages call it.
    pub(crate) source: String,
    /// Frequencies (Hz).
    pub(crate) frequencies: Vec<f64>,
    /// Directions of response and force, and the coherence over all frequencies.
    pub(crate) functions: Vec<([Direction; 2], Vec<f64>)>,
    /// Half of the last digit as it was written.
    pub(crate) digit: f64,
}

impl Measurement {
    /// The measurement with the coherence of each function from a table that has all of its lines.
    ///
    /// # Errors
    /// [`DynamicsError`]: a function or a line that is not in the table, a coherence outside 0 … 1.
    pub fn with_coherence(mut self, table: &CoherenceTable) -> Result<Self, DynamicsError> {
        let place = |frequency: &f64| {
            let same = |other: &f64| (other - frequency).abs() <= SAME_LINE * frequency;
            table.frequencies.iter().position(same)
        };
        let places: Option<Vec<usize>> = self.frequencies.iter().map(place).collect();
        for function in &mut self.functions {
            let name = function.name();
            let found = table.functions.iter().find(|(pair, _)| *pair == [function.response, function.force]);
            let file = || table.source.clone();
            let (_, values) =
                found.ok_or_else(|| DynamicsError::NoCoherenceOf { file: file(), function: name.clone() })?;
            let places = places.as_ref().ok_or_else(|| DynamicsError::OtherFrequencies {
                file: file(),
                function: format!("the coherence of {name}"),
            })?;
            let coherence: Vec<f64> = places.iter().map(|place| values[*place]).collect();
            let outside = coherence.iter().position(|value| !(0.0..=1.0).contains(value));
            if let Some(i) = outside {
                let (frequency, value) = (self.frequencies[i], coherence[i]);
                return Err(DynamicsError::Coherence { file: file(), frequency, value });
            }
            function.coherence = Some(coherence);
        }
        self.coherence_digit = table.digit;
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use crate::csv::read_csv;
    use crate::read::read_coherence;

    #[test]
    fn coherence_comes_from_a_file_of_its_own() {
        let measured = || {
            let rows = "100,0.5,-0.1,0.2,-0.1\n102,0.6,-0.2,0.3,-0.2\n";
            let header = "frequency [Hz],xx.real [um/N],xx.imag [um/N],yy.real [um/N],yy.imag [um/N]\n";
            read_csv("tap.csv", &format!("{header}{rows}")).unwrap()
        };
        let fault = |text: &str| {
            let table = read_coherence("c.csv", text.as_bytes()).unwrap();
            measured().with_coherence(&table).unwrap_err().to_string()
        };
        let both = "frequency [Hz],yy.coherence,xx.coherence\n";
        let table = read_coherence("c.csv", format!("{both}0,0,0\n100,0.8,0.9\n102,0.81,0.91\n").as_bytes()).unwrap();
        let with = measured().with_coherence(&table).unwrap();
        assert_eq!(with.functions[0].coherence, Some(vec![0.9, 0.91]));
        assert_eq!(with.functions[1].coherence, Some(vec![0.8, 0.81]));
        assert_eq!(with.coherence_digit, 0.005);
        assert!(fault(&format!("{both}100,0.8,0.9\n104,0.8,0.9\n")).contains("other frequencies"));
        assert!(fault("frequency [Hz],coherence\n100,0.8\n102,0.9\n").contains("no coherence of yy"));
        assert!(fault(&format!("{both}100,0.8,98\n102,0.8,99\n")).contains("coherence at 100 Hz is 98"));
        let none = read_coherence("c.csv", b"frequency [Hz],real [um/N]\n1,2\n").unwrap_err().to_string();
        assert!(none.contains("`coherence` must be there once"), "{none}");
    }
}
