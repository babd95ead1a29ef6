//! Why measured dynamics were not understood.

mod record;

pub use record::RecordProblem;

use crate::selection::SelectionProblem;
use toolroom_location::{Located, Location};

/// Why a file with measured dynamics, or a question about it, was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DynamicsError {
    /// A file without content.
    #[error("{file}: the file is empty; export or copy it again")]
    Nothing {
        /// The file.
        file: String,
    },
    /// A table without rows, or a file without any response.
    #[error("{file}: there is no frequency response in this file")]
    Empty {
        /// The file.
        file: String,
    },
    /// A file of which everything is left out.
    #[error("{file}: there is no frequency response in this file that can be used: {notes}")]
    LeftOut {
        /// The file.
        file: String,
        /// What was left out and why.
        notes: String,
    },
    /// A response that is the same on every line.
    #[error("{file}: {function} is {value} on every line, which no structure answers; check sensor, cable and export")]
    Constant {
        /// The file.
        file: String,
        /// Directions of response and force.
        function: String,
        /// The value as it was read, SI.
        value: String,
    },
    /// Text in another encoding.
    #[error("{file}: the text is UTF-16; save it as UTF-8, which spreadsheets call CSV UTF-8")]
    Encoding {
        /// The file.
        file: String,
    },
    /// A table of responses at several spindle speeds where one is wanted.
    #[error("{file}: the table holds responses at several spindle speeds, and one is wanted here")]
    BySpeed {
        /// The file.
        file: String,
    },
    /// A spindle speed that is none.
    #[error("{file}: a spindle speed must be positive, is {value}")]
    Speed {
        /// The file.
        file: String,
        /// The value as written.
        value: f64,
    },
    /// A column without its unit.
    #[error("{file}:{line}: the column `{column}` has no unit; write for example `{example}`")]
    MissingUnit {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The column as it is written.
        column: String,
        /// A header that would do.
        example: &'static str,
    },
    /// A unit that is none of those that are known.
    #[error("{file}:{line}: the unit `{unit}` of the column `{column}` is not known; write one of {accepted}")]
    UnknownUnit {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The column.
        column: String,
        /// Its unit as written.
        unit: String,
        /// Units that would do.
        accepted: &'static str,
    },
    /// A column of no known meaning.
    #[error(
        "{file}:{line}: the column `{column}` is not known; columns are `frequency [Hz]`, `real [um/N]`, `imag [um/N]`, \
         `magnitude [um/N]`, `phase [deg]` and `coherence`, of several functions with `xx.`, `xy.`, `yx.` or `yy.` before"
    )]
    UnknownColumn {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The column.
        column: String,
    },
    /// A column that is needed and missing, or there twice.
    #[error("{file}:{line}: the column `{column}` must be there once")]
    ColumnCount {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The column.
        column: String,
    },
    /// A cell that holds no number.
    #[error("{file}:{line}: `{text}` in the column `{column}` is no number")]
    NotANumber {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The column, or the place in a record.
        column: String,
        /// The cell.
        text: String,
    },
    /// A row with more or fewer cells than the header.
    #[error("{file}:{line}: the row has {cells} cells, the header {columns}")]
    UnevenRow {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Cells of the row.
        cells: usize,
        /// Cells of the header.
        columns: usize,
    },
    /// Frequencies that do not ascend.
    #[error("{file}: the frequencies must ascend; {value} Hz follows {before} Hz")]
    Order {
        /// The file.
        file: String,
        /// The frequency before (Hz).
        before: f64,
        /// The frequency after (Hz).
        value: f64,
    },
    /// A coherence outside its range.
    #[error("{file}: the coherence at {frequency} Hz is {value}; it must lie in 0 … 1")]
    Coherence {
        /// The file.
        file: String,
        /// Where (Hz).
        frequency: f64,
        /// What was read.
        value: f64,
    },
    /// A file of coherence that holds none.
    #[error("{file}: there is no coherence in this file; write a column `coherence`, or functions of type 6")]
    NoCoherence {
        /// The file.
        file: String,
    },
    /// A function without coherence where a file gives that of the others.
    #[error("{file}: there is no coherence of {function} in this file, for which `{function}.coherence` stands")]
    NoCoherenceOf {
        /// The file.
        file: String,
        /// Directions of response and force.
        function: String,
    },
    /// A universal file that breaks off or contradicts itself.
    #[error("{file}:{line}: {problem}")]
    Universal {
        /// The file.
        file: String,
        /// Line of the data set, from 1.
        line: usize,
        /// What is wrong.
        problem: UniversalProblem,
    },
    /// A column of a record over time that has no known meaning.
    #[error(
        "{file}:{line}: the column `{column}` is not known; columns are `time [s]`, `force [N]`, `displacement [um]`, \
         `velocity [m/s]`, `acceleration [m/s2]` and `sound [Pa]`, with `x.` or `y.` before where the direction is not x"
    )]
    UnknownChannel {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The column.
        column: String,
    },
    /// A sound file that cannot be read.
    #[error("{file}: {problem}")]
    Wave {
        /// The file.
        file: String,
        /// What is wrong.
        problem: WaveProblem,
    },
    /// A record over time that cannot be used.
    #[error("{file}: {problem}")]
    Record {
        /// The file.
        file: String,
        /// What is wrong.
        problem: RecordProblem,
    },
    /// Two functions of the same directions.
    #[error("{file}: there are two responses {function}; keep one of them in the file")]
    Duplicate {
        /// The file.
        file: String,
        /// Directions of response and force.
        function: String,
    },
    /// Functions over different frequencies.
    #[error("{file}: {function} has other frequencies than the functions before it; measure all over the same lines")]
    OtherFrequencies {
        /// The file.
        file: String,
        /// Directions of response and force.
        function: String,
    },
    /// No response is measured where and in the direction in which the force acts.
    #[error("{file}: no function has its response in the direction of its force; stiffness needs `xx` or `yy`")]
    NoDirect {
        /// The file.
        file: String,
    },
    /// Too few lines for a fit.
    #[error("{file}: {lines} lines are too few for a fit, at least {least} are needed")]
    TooFewLines {
        /// The file.
        file: String,
        /// Lines with information.
        lines: usize,
        /// Lines that are needed.
        least: usize,
    },
    /// Modes that were asked for and cannot be fitted.
    #[error("{file}: {problem}")]
    Selection {
        /// The file.
        file: String,
        /// What is wrong with them.
        problem: SelectionProblem,
    },
    /// No resonance stands out, and one does with a mistake about the columns undone.
    #[error("{file}: no resonance stands out of the noise as the file is written; {mistake}")]
    Mistaken {
        /// The file.
        file: String,
        /// With what a fit succeeds, and what that says of the file.
        mistake: String,
    },
    /// No resonance stands out of the noise.
    #[error("{file}: no resonance stands out of the noise; tap harder, average more, or measure a wider range")]
    NoModes {
        /// The file.
        file: String,
    },
}

impl Located for DynamicsError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::MissingUnit { file, line, .. }
            | Self::UnknownUnit { file, line, .. }
            | Self::UnknownColumn { file, line, .. }
            | Self::ColumnCount { file, line, .. }
            | Self::NotANumber { file, line, .. }
            | Self::UnevenRow { file, line, .. }
            | Self::Universal { file, line, .. }
            | Self::UnknownChannel { file, line, .. } => Some(Location::line(file, *line)),
            Self::Nothing { file, .. }
            | Self::Empty { file, .. }
            | Self::LeftOut { file, .. }
            | Self::Constant { file, .. }
            | Self::Encoding { file, .. }
            | Self::BySpeed { file, .. }
            | Self::Speed { file, .. }
            | Self::Order { file, .. }
            | Self::Coherence { file, .. }
            | Self::Wave { file, .. }
            | Self::Record { file, .. }
            | Self::Duplicate { file, .. }
            | Self::OtherFrequencies { file, .. }
            | Self::NoDirect { file, .. }
            | Self::TooFewLines { file, .. }
            | Self::NoCoherence { file }
            | Self::NoCoherenceOf { file, .. }
            | Self::Mistaken { file, .. }
            | Self::Selection { file, .. }
            | Self::NoModes { file, .. } => Some(Location::of(file)),
        }
    }
}

/// What is wrong with a data set of a universal file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UniversalProblem {
    /// The file ends within a data set.
    #[error("the data set breaks off; export the file again")]
    BrokenOff,
    /// A field that holds no number.
    #[error("`{0}` is no number")]
    NotANumber(String),
    /// A number of points that is none.
    #[error("{0} points are promised; export the file again")]
    Points(i64),
    /// A count that no file can hold.
    #[error("{0} values are promised, more than the file can hold")]
    TooMany(usize),
    /// Values beyond those that are promised.
    #[error("the data set promises {0} values and goes on after them; export the file again")]
    MoreThanPromised(usize),
    /// A number format that is not read.
    #[error("the data type {0} is not known; 2, 4, 5 and 6 are read")]
    DataType(i64),
    /// A binary format that is not read.
    #[error("the binary format with byte order {0} and number format {1} is not read; export IEEE numbers or ASCII")]
    Binary(i64, i64),
    /// The units are not told.
    #[error("no data set 164 and no label `{0}` tells the units; export the file with units")]
    Units(String),
    /// The response is not over force.
    #[error(
        "the ordinate is of type {0} over {1}; displacement (8), velocity (11) or acceleration (12) over force (13) is read"
    )]
    Ordinate(i64, i64),
    /// A cross spectrum without the auto spectrum that the estimator needs.
    #[error(
        "the auto spectrum of the {0} that belongs to this cross spectrum is not in the file; export it too, or the frequency response"
    )]
    Spectrum(String),
    /// Two auto spectra of one channel: nobody knows to which series of hits each belongs.
    #[error(
        "a second auto spectrum of this channel; put every series of hits into a file of its own, or export frequency responses"
    )]
    TwoSpectra,
    /// A signal over time that is neither force nor motion.
    #[error(
        "a signal over time of ordinate type {0}; force (13), displacement (8), velocity (11) and acceleration (12) are read"
    )]
    Signal(i64),
    /// A signal over time that is not in the plane.
    #[error("the signal is out of the plane of x and y; leave this channel out of the file")]
    OutOfPlane,
    /// A signal over time that differs from those before it in rate or number of samples.
    #[error(
        "the signal has another sampling rate or number of samples than those before it; export all channels alike"
    )]
    OtherTime,
}

/// What is wrong with a sound file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WaveProblem {
    /// A chunk `fmt` that is missing, too short or empty.
    #[error("the sound file does not say how its samples are written; export it again as WAV")]
    Format,
    /// Samples of another kind.
    #[error(
        "samples of format {code} with {bits} bits are not read; export whole numbers of 8 to 32 bits or floating-point numbers"
    )]
    Samples {
        /// Code of the format.
        code: u16,
        /// Bits of a sample.
        bits: u16,
    },
    /// A sample that is no number.
    #[error("a sample is no number; export the sound again")]
    NotANumber,
    /// No data.
    #[error("the sound file holds no samples")]
    NoSamples,
    /// A file that ends before its samples do.
    #[error(
        "the sound file breaks off: its header promises {promised} bytes of samples, {held} are there; copy or export it again"
    )]
    BrokenOff {
        /// Bytes of samples by the header.
        promised: usize,
        /// Bytes of samples in the file.
        held: usize,
    },
}
