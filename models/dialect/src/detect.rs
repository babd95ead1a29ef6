//! Which control a program is written for.

use std::ops::ControlFlow;
use toolroom_pages::{ReadError, Source};

/// Controls whose words differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// Fanuc milling controls.
    Fanuc,
    /// Fanuc turning controls, G code system A.
    FanucLathe,
    /// Haas mills.
    Haas,
    /// Siemens SINUMERIK 840D.
    Siemens,
    /// Heidenhain Klartext.
    Heidenhain,
    /// LinuxCNC.
    LinuxCnc,
}

impl Dialect {
    /// Words for files and options, in the order of the variants.
    pub const NAMES: [&'static str; 6] = ["fanuc", "fanuc-lathe", "haas", "siemens", "heidenhain", "linuxcnc"];
    /// Words of those that programs are written for: all but the lathe.
    pub const WRITTEN: [&'static str; 5] = ["fanuc", "haas", "siemens", "heidenhain", "linuxcnc"];
    const ALL: [Self; 6] = [Self::Fanuc, Self::FanucLathe, Self::Haas, Self::Siemens, Self::Heidenhain, Self::LinuxCnc];

    /// The word of a dialect.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// Whether it has Custom Macro of Fanuc: variables by number, bitwise AND and OR, G65.
    pub fn has_macros(self) -> bool {
        match self {
            Self::Fanuc | Self::FanucLathe | Self::Haas => true,
            Self::Siemens | Self::Heidenhain | Self::LinuxCnc => false,
        }
    }

    /// The dialect of a name of [`Dialect::NAMES`].
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().position(|known| *known == name).map(|index| Self::ALL[index])
    }

    /// The dialect that the words of a program show, with the reason; the ending of its file decides where the words
    /// show none.
    ///
    /// # Errors
    /// Two lines that stand for different controls, with both.
    ///
    /// ```
    /// use toolroom_dialect::Dialect;
    /// assert_eq!(Dialect::detect("0 BEGIN PGM A MM\n", None).unwrap().0, Dialect::Heidenhain);
    /// assert_eq!(Dialect::detect("G21\nG0 X0\n", None).unwrap().0, Dialect::Fanuc);
    /// assert!(Dialect::detect("o<a> sub\no<a> endsub\nG3 X1 Y1 CR=5\n", None).is_err());
    /// ```
    pub fn detect(text: &str, extension: Option<&str>) -> Result<(Self, String), Conflict> {
        let mut detector = Detector::default();
        for (index, line) in text.lines().enumerate() {
            if detector.line(index + 1, line)?.is_break() {
                break;
            }
        }
        Ok(detector.decide(extension))
    }
}

/// Finds the language of a program line by line.
#[derive(Default)]
pub struct Detector {
    found: Option<(Dialect, usize, &'static str)>,
    signs: Signs,
}

impl Detector {
    /// As [`Dialect::detect`], of a text that may stay in its file.
    ///
    /// # Errors
    /// A file that cannot be read; within that, two lines that stand for different controls.
    pub fn detect(text: &Source, extension: Option<&str>) -> Result<Result<(Dialect, String), Conflict>, ReadError> {
        let (mut detector, mut lines) = (Self::default(), text.lines());
        while let Some((number, line)) = lines.next()? {
            match detector.line(number, &line) {
                Ok(ControlFlow::Continue(())) => {}
                Ok(ControlFlow::Break(())) => break,
                Err(conflict) => return Ok(Err(conflict)),
            }
        }
        Ok(Ok(detector.decide(extension)))
    }

    /// Takes a line; `Break` where no more are needed.
    fn line(&mut self, number: usize, line: &str) -> Result<ControlFlow<()>, Conflict> {
        let upper = line.trim_start_matches(['\u{feff}', '\0']).to_ascii_uppercase();
        let Some((dialect, sign)) = strong(upper.trim(), &mut self.signs) else { return Ok(ControlFlow::Continue(())) };
        match self.found {
            None => self.found = Some((dialect, number, sign)),
            Some(first) if first.0 != dialect => return Err(Conflict { first, second: (dialect, number, sign) }),
            Some(_) => {}
        }
        Ok(if dialect == Dialect::Heidenhain { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    }

    fn decide(self, extension: Option<&str>) -> (Dialect, String) {
        let Self { found, signs } = self;
        if let Some((dialect, line, sign)) = found {
            return (dialect, format!("{sign} in line {line}"));
        }
        // On a mill G76 bores, and G73 and G74 drill, with P and Q as well.
        let lathe = signs.lathe.or(signs.cycle.filter(|_| !signs.mill));
        if let Some(line) = lathe.filter(|_| signs.g17.is_none()) {
            return (Dialect::FanucLathe, format!("words of a lathe in line {line}, and no G17"));
        }
        if let Some(line) =
            signs.turret.filter(|_| !signs.mill && signs.g17.is_none() && extension.is_none_or(is_plain))
        {
            return (Dialect::FanucLathe, format!("a tool with its offset in line {line}, and no word of a mill"));
        }
        let ending = match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("h") => Some(Dialect::Heidenhain),
            Some("mpf" | "spf") => Some(Dialect::Siemens),
            Some("ngc") => Some(Dialect::LinuxCnc),
            _ => None,
        };
        if let Some(dialect) = ending {
            return (dialect, "the ending of the file, since no word tells".to_owned());
        }
        if let Some(line) = signs.five {
            return (Dialect::Haas, format!("a program number of five digits in line {line}, which is a weak sign"));
        }
        (Dialect::Fanuc, "no word of another control".to_owned())
    }
}

/// Two signs of different controls.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "line {} says {} ({}), line {} says {} ({}); name the control with --dialect",
    .first.1, .first.0.name(), .first.2, .second.1, .second.0.name(), .second.2
)]
pub struct Conflict {
    /// Dialect, line and sign.
    pub first: (Dialect, usize, &'static str),
    /// Dialect, line and sign.
    pub second: (Dialect, usize, &'static str),
}

/// Whether an ending of a file says nothing of the language.
fn is_plain(extension: &str) -> bool {
    !["h", "mpf", "spf", "ngc"].contains(&extension.to_ascii_lowercase().as_str())
}

#[derive(Default)]
struct Signs {
    lathe: Option<usize>,
    /// G70 to G76 with P and Q.
    cycle: Option<usize>,
    /// A tool of four digits, two of them its offset.
    turret: Option<usize>,
    /// A tool change by M6, a length offset or an axis Y.
    mill: bool,
    g17: Option<usize>,
    five: Option<usize>,
    seen: usize,
}

/// Whether `code`, such as `M97`, stands in a line as a word.
fn has(line: &str, code: &str) -> bool {
    let mut from = 0;
    while let Some(found) = line[from..].find(code) {
        let (start, end) = (from + found, from + found + code.len());
        let before = line[..start].bytes().next_back();
        let after = line[end..].bytes().next();
        let clear = before.is_none_or(|b| !b.is_ascii_alphabetic() && b != b'_' && b != b'<')
            && after.is_none_or(|b| !b.is_ascii_digit() && b != b'.' && b != b'=');
        if clear {
            return true;
        }
        from = end;
    }
    false
}

/// A line without comments in parentheses.
fn bare(line: &str) -> String {
    let mut depth = 0_u32;
    let keep = |letter: &char| {
        match letter {
            '(' => depth += 1,
            ')' => {
                depth = depth.saturating_sub(1);
                return false;
            }
            _ => {}
        }
        depth == 0
    };
    line.chars().filter(keep).collect()
}

fn strong(line: &str, signs: &mut Signs) -> Option<(Dialect, &'static str)> {
    signs.seen += 1;
    let after_number = line.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
    if after_number.starts_with("BEGIN PGM") {
        return Some((Dialect::Heidenhain, "BEGIN PGM"));
    }
    if line.starts_with("%_N_") || line.starts_with(";$PATH") {
        return Some((Dialect::Siemens, "the header %_N_ or ;$PATH"));
    }
    let uncommented = line.split(';').next().unwrap_or_default();
    if let Some(sign) = siemens(uncalled(uncommented).trim()) {
        return Some((Dialect::Siemens, sign));
    }
    let bare = bare(uncommented);
    let bare = bare.trim();
    if let Some(rest) = bare.strip_prefix('O') {
        let rest = if let Some(named) = rest.strip_prefix('<') {
            named.split_once('>').map(|(_, rest)| rest)
        } else {
            Some(rest.trim_start().trim_start_matches(|c: char| c.is_ascii_digit()))
        };
        const WORDS: &str = "SUB ENDSUB CALL WHILE ENDWHILE DO IF \
                             ELSE ELSEIF ENDIF REPEAT ENDREPEAT BREAK RETURN";
        let word: String =
            rest.unwrap_or_default().trim_start().chars().take_while(char::is_ascii_alphabetic).collect();
        if WORDS.split(' ').any(|known| known == word) {
            return Some((Dialect::LinuxCnc, "an o-word"));
        }
        if signs.five.is_none() {
            let digits = bare[1..].trim_start().bytes().take_while(u8::is_ascii_digit).count();
            signs.five = (digits == 5).then_some(signs.seen);
        }
    }
    if bare.contains("#<") {
        return Some((Dialect::LinuxCnc, "a variable with a name"));
    }
    let compact: String = bare.chars().filter(|c| !c.is_whitespace()).collect();
    if has(&compact, "M97") || has(&compact, "G150") || has(&compact, "G187") {
        return Some((Dialect::Haas, "M97, G150 or G187"));
    }
    let pattern = ["G70", "G71", "G72"].iter().any(|code| has(&compact, code));
    if pattern && compact.contains('L') && compact.contains('I') {
        return Some((Dialect::Haas, "a hole pattern G70 to G72 with L"));
    }
    if has(&compact, "G17") {
        signs.g17 = Some(signs.seen);
    }
    signs.mill |= ["M6", "M06", "G43", "G91", "Y"].iter().any(|word| compact.contains(word));
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    if compact.match_indices('T').any(|(at, _)| digits(&compact[at + 1..]) == 4) {
        signs.turret = signs.turret.or(Some(signs.seen));
    }
    let clamp = has(&compact, "G50") && compact.contains('S');
    let contour =
        (70..=76).any(|code| has(&compact, &format!("G{code}"))) && compact.contains('P') && compact.contains('Q');
    // A letter between others is a part of a name, such as that of ROUND[2.5].
    let word = |letter: char| {
        let letters = |at: usize| compact.as_bytes().get(at).is_some_and(u8::is_ascii_alphabetic);
        compact.match_indices(letter).any(|(at, _)| !(letters(at + 1) || at > 0 && letters(at - 1)))
    };
    let increments = word('X') && (word('U') || word('W')) && !compact.contains('#');
    if clamp || has(&compact, "G96") || increments {
        signs.lathe = signs.lathe.or(Some(signs.seen));
    }
    if contour {
        signs.cycle = signs.cycle.or(Some(signs.seen));
    }
    None
}

/// A line up to a bracket that stands by itself: a comment of other controls. The brackets of a call follow its name.
fn uncalled(line: &str) -> &str {
    let own = |(at, _): &(usize, &str)| line[..*at].ends_with(char::is_whitespace);
    line.match_indices('(').find(own).map_or(line, |(at, _)| &line[..at])
}

/// Words that no other control has.
fn siemens(line: &str) -> Option<&'static str> {
    if line.starts_with('(') || line.starts_with('%') {
        return None;
    }
    let bytes = line.as_bytes();
    let word_at = |word: &str| {
        line.find(word).is_some_and(|at| at == 0 || !(bytes[at - 1].is_ascii_alphanumeric() || bytes[at - 1] == b'<'))
    };
    /// Words that stand for themselves in the reason.
    const WORDS: &str = "CR=|CYCLE8|MCALL|AC(|IC(|TURN=|GOTOF|GOTOB|ENDFOR|ATRANS|TRANS \
                         |DEF REAL|DEF INT|MSG(|SUPA|G641|G642|G450|G451|G710|G700";
    if let Some(word) = WORDS.split('|').find(|word| word_at(word) && !line.contains("(MSG(")) {
        return Some(word.trim_end());
    }
    // R1=…, and a label of at least two letters.
    for (index, _) in line.match_indices('R') {
        let digits = bytes[index + 1..].iter().take_while(|b| b.is_ascii_digit()).count();
        let clear = index == 0 || !(bytes[index - 1].is_ascii_alphanumeric() || bytes[index - 1] == b'_');
        if clear && digits > 0 && bytes.get(index + 1 + digits) == Some(&b'=') {
            return Some("R parameters");
        }
    }
    let label = line.split(':').next().unwrap_or_default();
    let named = label.len() >= 2
        && label.len() < line.len()
        && label.bytes().take(2).all(|b| b.is_ascii_alphabetic() || b == b'_')
        && label.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    named.then_some("a label")
}
