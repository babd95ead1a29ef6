//! Texts in memory and in files.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

/// A text: in memory, or in a file that is read line by line. Bytes that are no UTF-8 become the sign of replacement. Lines
/// end with a line feed, with or without a carriage return before it; in a text without any line feed, as old controls send
/// it, with a carriage return.
#[derive(Clone, Debug)]
pub struct Source {
    text: Kind,
    /// The byte that ends a line.
    end: u8,
}

#[derive(Clone, Debug)]
enum Kind {
    Memory(Arc<str>),
    File(Arc<File>),
}

impl Source {
    /// A file. What is no regular file, such as a pipe, is read into memory, since there is no way back in it.
    ///
    /// # Errors
    /// The file cannot be opened, is UTF-16, or is no text.
    pub fn open(path: &Path) -> io::Result<Self> {
        let mut file = File::open(path)?;
        let mut bytes = Vec::new();
        if file.metadata()?.is_file() {
            (&mut file).take(BUFFER as u64).read_to_end(&mut bytes)?;
            refuse_foreign(&bytes)?;
            return Ok(Self { text: Kind::File(Arc::new(file)), end: line_end(&bytes) });
        }
        file.read_to_end(&mut bytes)?;
        refuse_foreign(&bytes)?;
        Ok(Self::from(&*String::from_utf8_lossy(&bytes)))
    }

    /// The lines from the beginning.
    pub fn lines(&self) -> Lines {
        let text = match &self.text {
            Kind::Memory(text) => Reading::Memory(Arc::clone(text)),
            Kind::File(file) => {
                Reading::File(BufReader::with_capacity(BUFFER, Shared { file: Arc::clone(file), at: 0 }))
            }
        };
        Lines { text, next: Mark { byte: 0, line: 1 }, bytes: Vec::new(), end: self.end }
    }
}

impl From<&str> for Source {
    fn from(text: &str) -> Self {
        Self { text: Kind::Memory(Arc::from(text)), end: line_end(text.as_bytes()) }
    }
}

impl From<&String> for Source {
    fn from(text: &String) -> Self {
        Self::from(text.as_str())
    }
}

/// Bytes that are read from a file at once.
const BUFFER: usize = 1 << 16;

/// What ends the lines of a text that begins with these bytes.
fn line_end(start: &[u8]) -> u8 {
    if start.contains(&b'\r') && !start.contains(&b'\n') { b'\r' } else { b'\n' }
}

/// Share of signs that no text has above which a file is none (1). Assumption: tapes have a few at their ends.
const FOREIGN: f64 = 0.1;

/// Refuses what is no text, a picture or an archive, by the share of signs at its beginning that no text has.
fn refuse_foreign(start: &[u8]) -> io::Result<()> {
    refuse_utf16(&start[..start.len().min(64)])?;
    // Feed holes, marks of tapes, ends of files and rubouts stand in programs that were punched or sent.
    let start = start.trim_ascii_start();
    let mut head: Vec<u8> = start.iter().copied().skip_while(|byte| *byte == 0).take(512).collect();
    head.truncate(head.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1));
    let wide = std::str::from_utf8(&head).map_or_else(|error| error.error_len().is_none(), |_| true);
    let foreign = |byte: &&u8| match **byte {
        b'\t' | b'\n' | b'\r' | 0x02..=0x04 | 0x11..=0x14 | 0x1a => false,
        0x80..=0x9f => !wide,
        byte => byte < b' ',
    };
    if head.iter().filter(foreign).count() as f64 > FOREIGN * head.len() as f64 {
        return Err(io::Error::new(
            io::ErrorKind::InvalidData,
            "the file is no text but a picture, an archive or the like",
        ));
    }
    Ok(())
}

/// Refuses UTF-16, by its mark of the byte order or by every second byte of the beginning being zero. A tape that begins with
/// zeros alone is none.
fn refuse_utf16(start: &[u8]) -> io::Result<()> {
    let marked = start.starts_with(&[0xff, 0xfe]) || start.starts_with(&[0xfe, 0xff]);
    let zeros = |from: usize| start.iter().skip(from).step_by(2).all(|byte| *byte == 0);
    let letters = |from: usize| start.iter().skip(from).step_by(2).all(|byte| *byte != 0);
    if marked || start.len() >= 4 && (zeros(0) && letters(1) || zeros(1) && letters(0)) {
        let message = "the text is UTF-16 (\"Unicode\" in some editors); save it as UTF-8";
        return Err(io::Error::new(io::ErrorKind::InvalidData, message));
    }
    Ok(())
}

/// A file whose place belongs to one reader, though the file belongs to several.
#[derive(Debug)]
struct Shared {
    file: Arc<File>,
    at: u64,
}

impl Read for Shared {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut file = &*self.file;
        file.seek(SeekFrom::Start(self.at))?;
        let count = file.read(buffer)?;
        self.at += count as u64;
        Ok(count)
    }
}

impl Seek for Shared {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let mut file = &*self.file;
        // A step from here begins where this reader stands.
        file.seek(SeekFrom::Start(self.at))?;
        self.at = file.seek(to)?;
        Ok(self.at)
    }
}

/// A place at the beginning of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    byte: u64,
    /// The line, from 1.
    pub line: usize,
}

/// Why a text could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The system refused.
    #[error("the text cannot be read: {0}")]
    Io(#[from] io::Error),
    /// A page has other items than when it was read first.
    #[error("the file has changed while it was read; read it again")]
    Changed,
}

#[derive(Debug)]
enum Reading {
    Memory(Arc<str>),
    File(BufReader<Shared>),
}

/// Lines of a text, one after the other.
///
/// ```
/// use toolroom_pages::Source;
/// let mut lines = Source::from("G21\r\nX1").lines();
/// let second = {
///     assert_eq!(lines.next().unwrap().unwrap().1, "G21");
///     lines.mark()
/// };
/// assert_eq!(lines.next().unwrap().unwrap(), (2, "X1".into()));
/// assert!(lines.next().unwrap().is_none());
/// lines.go(second).unwrap();
/// assert_eq!(lines.next().unwrap().unwrap().0, 2);
/// ```
#[derive(Debug)]
pub struct Lines {
    text: Reading,
    next: Mark,
    bytes: Vec<u8>,
    end: u8,
}

impl Lines {
    /// Where the next line begins.
    pub fn mark(&self) -> Mark {
        self.next
    }

    /// Goes on from a place of this text.
    ///
    /// # Errors
    /// The system refused.
    pub fn go(&mut self, to: Mark) -> Result<(), ReadError> {
        if let Reading::File(file) = &mut self.text
            && self.next.byte != to.byte
        {
            file.seek(SeekFrom::Start(to.byte))?;
        }
        self.next = to;
        Ok(())
    }

    /// The next line with its number, from 1, without its end; `None` at the end of the text.
    ///
    /// # Errors
    /// The system refused.
    // A line borrows the buffer of the file, so that this is no `Iterator`.
    #[allow(clippy::should_implement_trait)]
    pub fn next(&mut self) -> Result<Option<(usize, Cow<'_, str>)>, ReadError> {
        let number = self.next.line;
        match &mut self.text {
            Reading::Memory(text) => {
                let start = self.next.byte as usize;
                let rest = text.get(start..).unwrap_or_default();
                if rest.is_empty() {
                    return Ok(None);
                }
                let length = rest.find(char::from(self.end)).map_or(rest.len(), |end| end + 1);
                self.next = Mark { byte: (start + length) as u64, line: number + 1 };
                Ok(Some((number, Cow::Borrowed(ended(&rest[..length])))))
            }
            Reading::File(file) => {
                self.bytes.clear();
                let length = file.read_until(self.end, &mut self.bytes)?;
                if length == 0 {
                    return Ok(None);
                }
                self.next = Mark { byte: self.next.byte + length as u64, line: number + 1 };
                let line = match String::from_utf8_lossy(&self.bytes) {
                    Cow::Borrowed(line) => Cow::Borrowed(ended(line)),
                    Cow::Owned(line) => Cow::Owned(ended(&line).to_owned()),
                };
                Ok(Some((number, line)))
            }
        }
    }
}

/// A line without what ends it, as [`str::lines`] does.
fn ended(line: &str) -> &str {
    let line = line.strip_suffix('\n').unwrap_or(line);
    line.strip_suffix('\r').unwrap_or(line)
}
