//! Quotes of delimited text that no reader can understand as they were meant.

/// A quoted cell that does not end where a cell ends: a lenient reader would swallow the rows after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BrokenQuote {
    /// There is no second quote.
    #[error("the quote that opens in line {line} is never closed; close it, or write \"\" for a quote within a cell")]
    Open {
        /// Line of the first quote, from 1.
        line: usize,
    },
    /// More text follows the second quote.
    #[error(
        "the cell whose quote opens in line {line} goes on after its closing quote in line {closed}; write \"\" for a \
         quote within a cell"
    )]
    Continued {
        /// Line of the first quote, from 1.
        line: usize,
        /// Line of the second.
        closed: usize,
    },
    /// Spaces stand before the first quote, which is then no quote but a letter.
    #[error("a quote of line {line} stands after a space; take the space away")]
    Indented {
        /// Line of the quote, from 1.
        line: usize,
    },
}

impl BrokenQuote {
    /// Line of the quote, from 1.
    pub fn line(&self) -> usize {
        match self {
            Self::Open { line } | Self::Continued { line, .. } | Self::Indented { line } => *line,
        }
    }
}

/// The first quote of delimited text that cannot be read; lines that start with `#` are comments. A quote
/// within a cell that does not start with one is a letter.
///
/// ```
/// use toolroom_process::table::broken_quote;
/// assert_eq!(broken_quote("a,b\n\"1, \"\"2\"\"\",3 \"in\n", b','), None);
/// assert_eq!(broken_quote("a,b\n\"1,2\n3,4\n", b',').map(|fault| fault.line()), Some(2));
/// ```
pub fn broken_quote(text: &str, delimiter: u8) -> Option<BrokenQuote> {
    let bytes = text.as_bytes();
    let is_space = |byte: u8| byte != delimiter && matches!(byte, b' ' | b'\t');
    let is_end = |byte: u8| byte == delimiter || matches!(byte, b'\n' | b'\r');
    let (mut index, mut line, mut starts_line) = (0, 1, true);
    while index < bytes.len() {
        if starts_line && bytes[index] == b'#' {
            index += bytes[index..].iter().position(|byte| *byte == b'\n').unwrap_or(bytes.len() - index);
        }
        let cell = index;
        while index < bytes.len() && is_space(bytes[index]) {
            index += 1;
        }
        if index < bytes.len() && bytes[index] == b'"' {
            if index > cell {
                return Some(BrokenQuote::Indented { line });
            }
            let opened = line;
            index += 1;
            loop {
                match bytes.get(index) {
                    None => return Some(BrokenQuote::Open { line: opened }),
                    Some(b'"') if bytes.get(index + 1) == Some(&b'"') => index += 2,
                    Some(b'"') => break,
                    Some(b'\n') => {
                        line += 1;
                        index += 1;
                    }
                    Some(_) => index += 1,
                }
            }
            index += 1;
            while index < bytes.len() && is_space(bytes[index]) {
                index += 1;
            }
            if index < bytes.len() && !is_end(bytes[index]) {
                return Some(BrokenQuote::Continued { line: opened, closed: line });
            }
        }
        while index < bytes.len() && !is_end(bytes[index]) {
            index += 1;
        }
        starts_line = bytes.get(index).is_some_and(|byte| *byte != delimiter);
        line += usize::from(bytes.get(index) == Some(&b'\n'));
        index += 1;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_that_readers_understand_pass() {
        for text in [
            "",
            "a,b\n1,2\n",
            "\"a\",\"b\"\r\n\"1\n2\",\"\"\r\n",
            "a;b\n\"x;\"\"y\"\"\" ;2",
            "a,b\n5\" drill,it's\n",
            "# \"a comment\n#\"\na\n1\n",
        ] {
            let delimiter = if text.contains(';') { b';' } else { b',' };
            assert_eq!(broken_quote(text, delimiter), None, "{text}");
        }
    }

    #[test]
    fn a_broken_quote_is_told_with_its_line() {
        let broken = |text: &str| broken_quote(text, b',');
        assert_eq!(broken("a,b\n1,\"2\n3,4\n"), Some(BrokenQuote::Open { line: 2 }));
        assert_eq!(broken("a,b\n\"1,2\n\"3\",4\n"), Some(BrokenQuote::Continued { line: 2, closed: 3 }));
        assert_eq!(broken("a,b\n1,2\n\"5\" drill\",4\n"), Some(BrokenQuote::Continued { line: 3, closed: 3 }));
        assert_eq!(broken("a,b\n1, \"2\"\n"), Some(BrokenQuote::Indented { line: 2 }));
        assert_eq!(broken("# \"\n\"a\nb\",\"c\n"), Some(BrokenQuote::Open { line: 3 }));
    }
}
