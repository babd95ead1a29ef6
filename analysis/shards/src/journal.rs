//! Journals: pieces of work that are finished, one a line, for going on after any end of the process.
//!
//! ```text
//!  HASH HEAD          what the work is: a journal of other work is refused
//!  HASH ENTRY         one finished piece, in the order in which they ended
//! ```
//! Every line begins with the hash of its JSON. A line that a dying process left half written ends the journal; the next
//! process writes in its place.

use crate::{ShardError, at, fingerprint};
use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// A journal of pieces of one kind. Threads may add to it at the same time.
///
/// The file comes into being with its first piece. A piece is handed to the system before [`add`](Self::add) returns, so
/// that it outlives the process; it is not forced to the disk, so that a loss of power may cost the last ones.
#[derive(Debug)]
pub struct Journal<T> {
    path: PathBuf,
    head: String,
    state: Mutex<State>,
    pieces: PhantomData<fn(T)>,
}

#[derive(Debug)]
struct State {
    file: Option<File>,
    /// Length of the lines that are whole, bytes.
    whole: u64,
    /// Why nothing more is written.
    failed: Option<io::Error>,
}

impl<T: Serialize + DeserializeOwned> Journal<T> {
    /// The journal in the file `path` of the work that `head` tells, and the pieces that it holds already.
    ///
    /// # Errors
    /// [`ShardError::File`] where the file cannot be read, [`ShardError::OtherWork`] where it is of other work.
    pub fn open(path: &Path, head: &Value) -> Result<(Self, Vec<T>), ShardError> {
        let text = match fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(at(path)(error)),
        };
        let (mut whole, mut pieces) = (0, Vec::new());
        let mut lines = Lines(&text).peekable();
        let head = head.to_string();
        if lines.peek().is_some_and(|there| *there != head.as_bytes()) {
            return Err(ShardError::OtherWork { path: path.to_owned() });
        }
        for (number, line) in lines.enumerate() {
            if number > 0 {
                let Ok(piece) = serde_json::from_slice(line) else { break };
                pieces.push(piece);
            }
            whole += (HASH + 1 + line.len() + 1) as u64;
        }
        let state = Mutex::new(State { file: None, whole, failed: None });
        Ok((Self { path: path.to_owned(), head, state, pieces: PhantomData }, pieces))
    }

    /// Adds a finished piece. After the first failure nothing more is written, and the work goes on without.
    pub fn add(&self, piece: &T) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if state.failed.is_none()
            && let Err(error) = self.write(&mut state, piece)
        {
            state.failed = Some(error);
        }
    }

    /// Why pieces could not be written, where that is so.
    pub fn failure(&self) -> Option<String> {
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.failed.as_ref().map(|error| format!("{}: {error}", self.path.display()))
    }

    fn write(&self, state: &mut State, piece: &T) -> io::Result<()> {
        let mut lines = String::new();
        let file = match &mut state.file {
            Some(file) => file,
            none => {
                if let Some(folder) = self.path.parent() {
                    fs::create_dir_all(folder)?;
                }
                let mut file = OpenOptions::new().create(true).truncate(false).write(true).open(&self.path)?;
                file.set_len(state.whole)?;
                io::Seek::seek(&mut file, io::SeekFrom::End(0))?;
                if state.whole == 0 {
                    lines = line(&self.head);
                }
                none.insert(file)
            }
        };
        lines += &line(&serde_json::to_string(piece)?);
        file.write_all(lines.as_bytes())
    }
}

/// Digits of a hash.
const HASH: usize = 16;

fn line(json: &str) -> String {
    format!("{} {json}\n", fingerprint(json.as_bytes()))
}

/// The JSON of the lines that are whole, up to the first that is not.
struct Lines<'a>(&'a [u8]);

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let end = self.0.iter().position(|byte| *byte == b'\n')?;
        let (line, rest) = (&self.0[..end], &self.0[end + 1..]);
        let (hash, json) = (line.get(..HASH)?, line.get(HASH + 1..)?);
        if line[HASH] != b' ' || hash != fingerprint(json).as_bytes() {
            return None;
        }
        self.0 = rest;
        Some(json)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn open(path: &Path) -> (Journal<u64>, Vec<u64>) {
        Journal::open(path, &json!({ "seed": 1 })).expect("readable")
    }

    #[test]
    fn what_was_finished_is_there_again_wherever_a_process_died() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("journal/runs");
        let (journal, there) = open(&path);
        assert!(there.is_empty() && !path.exists(), "no file before its first piece");
        (10..15).for_each(|piece| journal.add(&piece));
        assert_eq!(journal.failure(), None);
        let text = fs::read(&path).expect("written");
        let lines = |bytes: &[u8]| bytes.iter().filter(|byte| **byte == b'\n').count();
        for length in 0..=text.len() {
            fs::write(&path, &text[..length]).expect("writable");
            let (journal, there) = open(&path);
            let whole = lines(&text[..length]).saturating_sub(1);
            assert_eq!(there, (10..10 + whole as u64).collect::<Vec<_>>(), "cut at {length}");
            journal.add(&99);
            drop(journal);
            assert_eq!(open(&path).1, [there, vec![99]].concat(), "cut at {length}");
        }
    }

    #[test]
    fn a_changed_line_and_other_work_are_told() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("runs");
        let (journal, _) = open(&path);
        (10..15).for_each(|piece| journal.add(&piece));
        let text = fs::read_to_string(&path).expect("written");
        fs::write(&path, text.replace(" 12\n", " 13\n")).expect("writable");
        assert_eq!(open(&path).1, [10, 11], "what follows a changed line is not trusted");
        let other = Journal::<u64>::open(&path, &json!({ "seed": 2 }));
        assert!(matches!(other, Err(ShardError::OtherWork { .. })));
    }

    #[test]
    fn work_goes_on_where_its_journal_cannot_be_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let journal = Journal::<u64>::open(&folder.path().join("other/runs"), &json!(1)).expect("nothing there").0;
        fs::write(folder.path().join("other"), "no folder").expect("writable");
        journal.add(&1);
        assert!(journal.failure().expect("told").contains("runs"));
    }
}
