//! What a control adds to the words of a program.

use crate::Dialect;
use crate::kernel::FARTHEST;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toolroom_process::unit;

/// Unit of the lengths of a program that does not name one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// Millimetres, and millimetres a minute or a revolution.
    Millimetre,
    /// Inches, and inches a minute or a revolution.
    Inch,
}

impl Units {
    /// Words for files and options, in the order of the variants.
    pub const NAMES: [&'static str; 2] = ["mm", "inch"];

    const ALL: [Self; 2] = [Self::Millimetre, Self::Inch];

    /// The unit of a name of [`Units::NAMES`]; `None` for another name.
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().position(|known| *known == name).map(|index| Self::ALL[index])
    }

    /// Length of the unit, mm; an inch by its definition.
    pub fn scale(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Inch => 25.4,
        }
    }
}

/// Clearance above the last depth on LinuxCNC, mm: 0.010 in, the constant `G83_RAPID_DELTA` of the interpreter up to
/// LinuxCNC 2.9.
const LINUXCNC_CLEARANCE: f64 = 0.254;

/// The settings of a control that a program does not state.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// Language; found from the text where absent.
    pub dialect: Option<Dialect>,
    /// Ending of the file, which is a weak sign of the language.
    pub extension: Option<String>,
    /// Unit of lengths before a code names one.
    pub units: Option<Units>,
    /// Whether a number without a decimal point counts least increments, 0.001 mm or 0.0001 in, as on old Fanuc
    /// controls, instead of whole units.
    pub least_increment: bool,
    /// Switches of block skip that are on, by their number from 1 to 9; index 0 says nothing.
    pub skip: [bool; 10],
    /// Position at the start in the order and units of [`Axes`](crate::Axes), X of a lathe as a diameter; `None` is
    /// unknown.
    pub start: [Option<f64>; 9],
    /// Greatest number of blocks and statements that may run.
    pub steps: u64,
    /// Distance above the last depth at which a peck begins and by which G73 retracts, mm. Where it is not given 0.254 mm
    /// on LinuxCNC and 1 mm elsewhere, which is an assumption.
    pub peck_clearance: Option<f64>,
    /// Whether pecks of lathes (Q of G83 and G87) are drawn out to the plane R instead of back by the clearance.
    pub full_pecks: bool,
    /// Whether F is a speed of all axes together, where linear and rotary axes move at once.
    pub rotary_feed_all_axes: bool,
    /// Times of M codes, s, by their number.
    pub m: BTreeMap<u32, f64>,
    /// Times of G codes that are not understood, s, by ten times their number.
    pub g: BTreeMap<u32, f64>,
    /// Origins of work offsets, X, Y and Z in mm, by the number of their code from 54 to 59: only how they lie to each other
    /// counts, and that of G54 is 0 where it is left out. Those of other axes count as the same. Empty where they are not known:
    /// a change of offset makes places unknown then.
    pub origins: BTreeMap<u32, [f64; 3]>,
    /// Whether a program that cuts in two work offsets is refused where it is not known how they lie to each other, since what it
    /// cuts lies in one place.
    pub one_place: bool,
    /// Diameters of tools, mm, by number or by D.
    pub diameters: BTreeMap<u32, f64>,
    /// Folder of subprograms in files of their own.
    pub library: Option<PathBuf>,
    /// Feed before a program names one, mm/min; a motion at feed without one is refused else.
    pub feed: Option<f64>,
    /// Whether F holds on the contour instead of the path of the cutter's centre.
    pub feed_at_contour: bool,
    /// Letter of the turns of a helix on Fanuc, L or P. Where none is given, L: an assumption, since controls differ by option.
    pub turns: u8,
    /// Whether compensation of the radius begins and ends by type B of Fanuc: around an outer corner. Type A goes straight to and
    /// from the place beside the contour.
    pub startup_b: bool,
}

impl Default for Control {
    fn default() -> Self {
        Self {
            dialect: None,
            extension: None,
            units: None,
            least_increment: false,
            skip: [false; 10],
            start: [None; 9],
            steps: Self::STEPS,
            peck_clearance: None,
            full_pecks: false,
            rotary_feed_all_axes: false,
            m: BTreeMap::new(),
            g: BTreeMap::new(),
            origins: BTreeMap::new(),
            one_place: false,
            diameters: BTreeMap::new(),
            library: None,
            feed: None,
            feed_at_contour: false,
            turns: b'L',
            startup_b: false,
        }
    }
}

impl Control {
    /// Greatest number of blocks and statements that may run where nothing else is said: some hours at a thousand a second
    /// (assumption).
    pub const STEPS: u64 = 10_000_000;

    /// The control of a program in `file`, whose lengths are `units` where it does not say: the ending of the file is a sign
    /// of the language, and its subprograms stand beside it.
    pub fn of_file(file: &Path, units: Option<Units>) -> Self {
        Self {
            units,
            extension: file.extension().map(|extension| extension.to_string_lossy().into_owned()),
            library: file.parent().map(Path::to_path_buf),
            ..Self::default()
        }
    }

    /// The same settings for a program in `file`, as [`Control::of_file`]; `units` come before those of the settings.
    #[must_use]
    pub fn for_file(self, file: &Path, units: Option<Units>) -> Self {
        let Self { units: theirs, extension, library, .. } = Self::of_file(file, units);
        Self { units: theirs.or(self.units), extension, library, ..self }
    }

    /// A control of a language, with lengths in millimetres where a program does not say.
    pub fn of(dialect: Dialect) -> Self {
        Self { dialect: Some(dialect), ..Self::default() }
    }

    /// Starts at a position of X, Y and Z such as `0,0,100 mm`; the other axes stand at 0.
    ///
    /// # Errors
    /// What is wrong with the text.
    pub fn set_start(&mut self, text: &str) -> Result<(), String> {
        let mut places = [Some(0.0); 9];
        for (slot, place) in places.iter_mut().zip(position(text)?) {
            *slot = Some(place);
        }
        self.start = places;
        Ok(())
    }

    /// Origin of a work offset in the coordinates of G54, mm, by the number of its code. `None` where it is not known.
    pub fn origin(&self, code: u32) -> Option<[f64; 3]> {
        let (first, own) = (self.given_origin(54)?, self.given_origin(code)?);
        Some(std::array::from_fn(|axis| own[axis] - first[axis]))
    }

    /// Origin of a work offset as it is given; that of G54 is 0 where another one is given. `None` where it is not known.
    pub(crate) fn given_origin(&self, code: u32) -> Option<[f64; 3]> {
        let zero = (code == 54 && !self.origins.is_empty()).then_some([0.0; 3]);
        self.origins.get(&code).copied().or(zero)
    }

    /// Takes the diameter of a tool such as `D1=10 mm`, from 0 to 1000 mm.
    ///
    /// # Errors
    /// What is wrong with the text.
    pub fn set_tool(&mut self, text: &str) -> Result<(), String> {
        let (number, value) = text.split_once('=').ok_or("the diameter is missing")?;
        let number = number.trim_start_matches(['D', 'T']).parse().map_err(|_| format!("{number} is no tool"))?;
        let diameter = 1e3 * unit::quantity(value, "m").map_err(|error| error.to_string())?;
        if !(0.0..=1e3).contains(&diameter) {
            return Err("0 to 1000 mm is possible".to_owned());
        }
        self.diameters.insert(number, diameter);
        Ok(())
    }

    /// Clearance of pecks in force in a language, mm: that of LinuxCNC, else 1 mm, where none is set (an assumption).
    pub fn clearance(&self, dialect: Dialect) -> f64 {
        self.peck_clearance.unwrap_or(if dialect == Dialect::LinuxCnc { LINUXCNC_CLEARANCE } else { 1.0 })
    }

    /// Keys of [`Control::set`].
    pub const KEYS: &'static str =
        "units, decimal, peck_clearance, pecks, rotary_feed, feed_at, turns, startup, offset.CODE, m.NUMBER, g.NUMBER";

    /// Sets a value by its key, one of [`Control::KEYS`]: a word, or a number with its unit, a length for the clearance and a
    /// time for `m.NUMBER` and `g.NUMBER`, from 0 to 1e6 m or s; a position of X, Y and Z for `offset.G54` to `offset.G59`.
    ///
    /// # Errors
    /// What is wrong with key or value.
    ///
    /// ```
    /// let mut control = toolroom_program::Control::default();
    /// control.set("m.29", "0.3 s").unwrap();
    /// control.set("units", "inch").unwrap();
    /// control.set("offset.G55", "100,0,-5 mm").unwrap();
    /// assert_eq!(control.m[&29], 0.3);
    /// assert_eq!(control.origin(55), Some([100.0, 0.0, -5.0]));
    /// assert!(control.set("decimal", "comma").is_err());
    /// ```
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), String> {
        let choice = |words: [&str; 2]| {
            words
                .iter()
                .position(|word| *word == value)
                .ok_or_else(|| format!("control.{key} is \"{}\" or \"{}\", not \"{value}\"", words[0], words[1]))
        };
        let quantity = |unit: &'static str| {
            let number = unit::quantity(value, unit).map_err(|error| format!("control.{key}: {error}"))?;
            if (0.0..=1e6).contains(&number) {
                Ok(number)
            } else {
                Err(format!("control.{key}: {value} is out of range"))
            }
        };
        match key {
            "units" => self.units = Some(Units::ALL[choice(Units::NAMES)?]),
            "decimal" => self.least_increment = choice(["calculator", "least_increment"])? == 1,
            "pecks" => self.full_pecks = choice(["chip_breaking", "full"])? == 1,
            "rotary_feed" => self.rotary_feed_all_axes = choice(["linear_axes", "all_axes"])? == 1,
            "feed_at" => self.feed_at_contour = choice(["centre", "contour"])? == 1,
            "turns" => self.turns = [b'L', b'P'][choice(["L", "P"])?],
            "startup" => self.startup_b = choice(["A", "B"])? == 1,
            "peck_clearance" => self.peck_clearance = Some(1e3 * quantity("m")?),
            _ => {
                let (table, number) = key.split_once('.').unwrap_or((key, ""));
                if let ("offset", Some(number)) = (table, number.strip_prefix(['G', 'g'])) {
                    let code = number.parse().ok().filter(|code| (54..=59).contains(code));
                    let code = code.ok_or_else(|| format!("control.{key}: there are G54 to G59"))?;
                    let origin = position(value).map_err(|error| format!("control.{key}: {error}"))?;
                    self.origins.insert(code, origin);
                    return Ok(());
                }
                let code: Option<f64> = number.parse().ok().filter(|code| (0.0..=9999.0).contains(code));
                match (table, code) {
                    ("m", Some(code)) => self.m.insert(code as u32, quantity("s")?),
                    ("g", Some(code)) => self.g.insert((10.0 * code).round() as u32, quantity("s")?),
                    _ => return Err(format!("there is no control.{key}; there are {}", Self::KEYS)),
                };
            }
        }
        Ok(())
    }
}

/// X, Y and Z of a text such as `0,0,100 mm`, mm.
fn position(text: &str) -> Result<[f64; 3], String> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [x, y, z] = parts[..] else { return Err("three coordinates are needed".to_owned()) };
    let letter = z.find(|sign: char| sign.is_alphabetic() && !matches!(sign, 'e' | 'E'));
    let word = letter.and_then(|at| z.get(at..)).ok_or("the unit is missing, as in \"0,0,100 mm\"")?;
    let mut places = [0.0; 3];
    for (slot, part) in places.iter_mut().zip([x, y, z]) {
        let bare = part.parse::<f64>().is_ok();
        let whole = if bare { format!("{part} {word}") } else { part.to_owned() };
        let place = 1e3 * unit::quantity(&whole, "m").map_err(|error| error.to_string())?;
        if place.is_nan() || place.abs() > FARTHEST {
            return Err(format!("{whole} is farther than any machine reaches"));
        }
        *slot = place;
    }
    Ok(places)
}
