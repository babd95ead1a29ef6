//! From a line of text to words: letters with numbers, and nothing else.

use super::ProgramFault;

/// Words with a number that stand at most once in a block.
const LETTERS: &str = "XYZIJKRPQFSLHDOABCUVWE";

/// A fault and its byte offset in the program.
pub(super) type At<T> = Result<T, (usize, ProgramFault)>;

/// What a block says.
#[derive(Clone, Debug, Default)]
pub(super) struct Words {
    /// Byte offset of its line.
    pub start: usize,
    /// G codes with tenths (`G54.1` is 541) and their place.
    pub general: Vec<(u32, usize)>,
    /// M codes and their place.
    pub auxiliary: Vec<(u32, usize)>,
    /// Tool that is called.
    pub tool: Option<u32>,
    numbers: [Option<Word>; LETTERS.len()],
}

/// A number behind a letter.
#[derive(Clone, Copy, Debug)]
struct Word {
    value: f64,
    /// Byte offset of the letter.
    place: usize,
    /// Whether it was written with a decimal point.
    pointed: bool,
}

impl Words {
    /// The words of a line that starts at byte `start` of the program. `comments` says whether parentheses hold
    /// comments.
    pub(super) fn of(line: &str, start: usize, comments: bool) -> At<Self> {
        let mut words = Self { start, ..Self::default() };
        let mut rest = Rest { line, at: 0 };
        while let Some(sign) = rest.next_sign() {
            let place = start + rest.at;
            match sign {
                ';' => break,
                // A mark of the tape's start and end, or the name of a Siemens program.
                '%' if rest.at == rest.line.len() - rest.line.trim_start().len() => break,
                '(' if comments => {
                    let close = rest.line[rest.at..].find(')');
                    let close = close.ok_or((place, ProgramFault::not_words("a comment is not closed: add `)`")))?;
                    rest.at += close + 1;
                }
                '/' => {
                    let reason = "whether a block with a slash runs is set at the machine; take the slash out where it runs, the block where it does not";
                    return Err((place, ProgramFault::Unsupported { word: "/".to_owned(), reason }));
                }
                '#' | '[' => {
                    let message = "variables and expressions are not followed: write their values, or post the program as plain G-code";
                    return Err((place, ProgramFault::not_words(message)));
                }
                letter if letter.is_ascii_alphabetic() => words.word(&mut rest, letter.to_ascii_uppercase())?,
                other => {
                    let message =
                        format!("`{other}` is not understood: words are a letter with a number, comments stand in ( )");
                    return Err((place, ProgramFault::Syntax { message }));
                }
            }
        }
        Ok(words)
    }

    fn word(&mut self, rest: &mut Rest<'_>, letter: char) -> At<()> {
        let begin = rest.at;
        let place = self.start + begin;
        rest.at += 1;
        let number = match rest.next_sign() {
            Some('#' | '[' | '=' | '"' | '<') => return Err((place, ProgramFault::Variable { letter })),
            Some(sign) if sign.is_ascii_alphabetic() || sign == '_' => {
                let named = |sign: &char| sign.is_ascii_alphanumeric() || *sign == '_';
                let word = rest.line[begin..].chars().filter(|sign| !sign.is_whitespace()).take_while(named);
                let reason = "words of a programming language are not followed: write the motions out, or post the program as plain G-code";
                return Err((place, ProgramFault::Unsupported { word: word.take(24).collect(), reason }));
            }
            _ => rest.number(),
        };
        let text = &rest.line[begin..rest.at];
        let written = || text.chars().filter(|sign| !sign.is_whitespace()).collect::<String>();
        let pointed = number.contains('.');
        let value: f64 = match number.parse() {
            Ok(value) => value,
            Err(_) => {
                let message = format!("`{}` has no number that can be read behind its letter", written());
                return Err((place, ProgramFault::Syntax { message }));
            }
        };
        // Another value, or an expression, would go on with one of these.
        if let Some(sign @ ('=' | '[' | '#')) = rest.next_sign() {
            let message = format!("`{}` goes on with `{sign}`: only plain numbers can be read", written());
            return Err((place, ProgramFault::Syntax { message }));
        }
        let refuse = |reason| Err((place, ProgramFault::Unsupported { word: written(), reason }));
        let tenths = (value * 10.0).round();
        let whole = value >= 0.0 && value.fract() == 0.0 && value < 1e6;
        match letter {
            'N' => {}
            'G' if value >= 0.0 && tenths < 1e6 && (tenths - value * 10.0).abs() < 1e-6 => {
                self.general.push((tenths as u32, place));
            }
            'M' if whole => self.auxiliary.push((value as u32, place)),
            'T' if whole && self.tool.is_none() => self.tool = Some(value as u32),
            'T' if whole => return refuse("it is the second tool in its block: write one"),
            'G' | 'M' | 'T' => return refuse("there is no such number"),
            _ => match LETTERS.find(letter) {
                Some(slot) if self.numbers[slot].is_none() => {
                    self.numbers[slot] = Some(Word { value, place, pointed });
                }
                Some(_) => return refuse("the letter stands twice in its block, and which counts differs by control"),
                None => return refuse("the letter is not understood"),
            },
        }
        Ok(())
    }

    /// The number behind `letter`.
    pub(super) fn number(&self, letter: char) -> Option<f64> {
        self.get(letter).map(|word| word.value)
    }

    /// Whether the number behind `letter` was written with a decimal point.
    pub(super) fn pointed(&self, letter: char) -> bool {
        self.get(letter).is_some_and(|word| word.pointed)
    }

    fn get(&self, letter: char) -> Option<Word> {
        LETTERS.find(letter).and_then(|slot| self.numbers[slot])
    }

    /// Whether any of `letters` is there.
    pub(super) fn any(&self, letters: &str) -> bool {
        letters.chars().any(|letter| self.get(letter).is_some())
    }

    /// Whether it is nothing but a line number, a comment or a mark.
    pub(super) fn is_empty(&self) -> bool {
        self.general.is_empty() && self.auxiliary.is_empty() && self.tool.is_none() && !self.any(LETTERS)
    }

    /// Letters with their numbers, in the order of [`LETTERS`].
    pub(super) fn letters(&self) -> impl Iterator<Item = (char, f64, usize)> + '_ {
        let words = LETTERS.chars().zip(&self.numbers);
        words.filter_map(|(letter, word)| word.map(|word| (letter, word.value, word.place)))
    }
}

/// What is left of a line.
struct Rest<'l> {
    line: &'l str,
    at: usize,
}

impl<'l> Rest<'l> {
    /// Goes over blanks; the sign behind them.
    fn next_sign(&mut self) -> Option<char> {
        let rest = &self.line[self.at..];
        let blank = |sign: char| sign.is_whitespace() || sign == '\0';
        self.at += rest.len() - rest.trim_start_matches(blank).len();
        self.line[self.at..].chars().next()
    }

    /// Goes over sign, digits and point.
    fn number(&mut self) -> &'l str {
        let rest = &self.line[self.at..];
        let signed = rest.strip_prefix(['+', '-']).unwrap_or(rest);
        let end = signed.find(|sign: char| !sign.is_ascii_digit() && sign != '.').unwrap_or(signed.len());
        let length = rest.len() - signed.len() + end;
        self.at += length;
        &rest[..length]
    }
}
