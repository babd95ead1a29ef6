//! Lines of delimited text.

/// Tells in which line of a text a record begins. A reader of delimited text counts a record from where the one before ended, so
/// that its own count is too small by blank lines and comments before the record, and by one where lines end in `\r\n`.
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    bytes: &'a [u8],
    /// Bytes that have been counted, and the line that they end in.
    counted: usize,
    line: usize,
}

impl<'a> Lines<'a> {
    /// Of this text; lines that start with `#` are comments.
    pub fn new(text: &'a str) -> Self {
        Self { bytes: text.as_bytes(), counted: 0, line: 1 }
    }

    /// The line, from 1, of the record that a reader found at this byte of the text. Records in the order of the text take a
    /// single way through it.
    ///
    /// # Examples
    /// ```
    /// use toolroom_process::table::Lines;
    /// let mut lines = Lines::new("# lives\r\na,b\r\n1,2\r\n\r\n3,4\r\n");
    /// assert_eq!([0, 14, 19].map(|byte| lines.at(byte)), [2, 3, 5]);
    /// ```
    pub fn at(&mut self, byte: u64) -> usize {
        let mut place = usize::try_from(byte).unwrap_or(usize::MAX).min(self.bytes.len());
        if place < self.counted {
            (self.counted, self.line) = (0, 1);
        }
        loop {
            match self.bytes.get(place) {
                Some(b'\r' | b'\n') => place += 1,
                Some(b'#') => {
                    let rest = &self.bytes[place..];
                    place += rest.iter().position(|byte| matches!(byte, b'\r' | b'\n')).unwrap_or(rest.len());
                }
                Some(_) | None => break,
            }
        }
        let ends = |at: &usize| match self.bytes[*at] {
            b'\n' => true,
            b'\r' => self.bytes.get(at + 1) != Some(&b'\n'),
            _ => false,
        };
        self.line += (self.counted..place).filter(ends).count();
        self.counted = self.counted.max(place);
        self.line
    }
}
