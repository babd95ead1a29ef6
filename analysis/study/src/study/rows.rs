//! Numbers of many replications: the last ones in memory, those before in a temporary file.
//!
//! A study of ten thousand replications takes as much memory as one of a few hundred. The file has no name: it is gone with
//! the study, however the process ends.

use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::sync::{Arc, Mutex, PoisonError};

/// Rows that go to the file at once, one column after the other, so that a column is read without the others.
const BLOCK: usize = 256;

/// Size of a number in the file, bytes.
const NUMBER: usize = size_of::<f64>();

/// Rows of equally many numbers, to the bit.
#[derive(Clone, Default)]
pub(super) struct Rows {
    /// Numbers in a row.
    width: usize,
    /// Rows in all.
    count: usize,
    /// Rows in the file: a whole number of blocks.
    stored: usize,
    /// The rows after those, one after the other.
    recent: Vec<f64>,
    file: Place,
}

/// Where rows go that are not recent.
#[derive(Clone, Default)]
enum Place {
    /// There were none so far.
    #[default]
    Unused,
    /// A file without a name.
    File(Arc<Mutex<File>>),
    /// No file could be made or written: rows stay in memory.
    Memory,
}

impl Rows {
    /// Adds a row, as wide as those before it.
    pub fn push(&mut self, row: &[f64]) {
        assert!(self.count == 0 || row.len() == self.width, "a row of {} beside {} numbers", row.len(), self.width);
        self.width = row.len();
        self.count += 1;
        self.recent.extend_from_slice(row);
        if self.count - self.stored == BLOCK && self.width > 0 {
            self.store();
        }
    }

    /// Moves the recent rows, a block, to the file. Where that fails they stay, and so do all that follow.
    fn store(&mut self) {
        // What shares a file with another study must not write to it.
        if matches!(&self.file, Place::File(file) if Arc::strong_count(file) > 1) {
            let earlier: Vec<f64> = self.iter().take(self.stored).flatten().collect();
            let recent = std::mem::take(&mut self.recent);
            (self.recent, self.file) = ([earlier, recent].concat(), Place::Memory);
            self.stored = 0;
        }
        if matches!(self.file, Place::Unused) {
            self.file = tempfile::tempfile().map_or(Place::Memory, |file| Place::File(Arc::new(Mutex::new(file))));
        }
        let Place::File(file) = &self.file else { return };
        let columns = (0..self.width).flat_map(|column| self.recent.iter().skip(column).step_by(self.width));
        let bytes: Vec<u8> = columns.flat_map(|number| number.to_le_bytes()).collect();
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        let written = file.seek(SeekFrom::Start(self.at(self.stored, 0))).and_then(|_| file.write_all(&bytes));
        drop(file);
        if written.is_ok() {
            self.stored = self.count;
            self.recent.clear();
        }
        // Otherwise the block is not full again: what is in memory stays there.
    }

    /// Where a column of the block that begins with row `first` stands in the file, bytes.
    fn at(&self, first: usize, column: usize) -> u64 {
        ((first * self.width + column * BLOCK) * NUMBER) as u64
    }

    /// Numbers of the file.
    ///
    /// # Panics
    /// Where the temporary file cannot be read back, which only happens to a computer that loses its disk.
    fn read(&self, place: u64, count: usize) -> Vec<f64> {
        let Place::File(file) = &self.file else { return Vec::new() };
        let mut bytes = vec![0; count * NUMBER];
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        let read: io::Result<()> = file.seek(SeekFrom::Start(place)).and_then(|_| file.read_exact(&mut bytes));
        read.expect("what was written to a temporary file is read back");
        bytes.as_chunks::<NUMBER>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
    }

    /// A number of every row.
    pub fn column(&self, column: usize) -> Vec<f64> {
        let blocks = (0..self.stored).step_by(BLOCK).flat_map(|first| self.read(self.at(first, column), BLOCK));
        blocks.chain(self.recent.iter().skip(column).step_by(self.width.max(1)).copied()).collect()
    }

    /// Every row in order.
    pub fn iter(&self) -> impl Iterator<Item = Vec<f64>> + '_ {
        let blocks = (0..self.stored).step_by(BLOCK).flat_map(move |first| {
            let block = self.read(self.at(first, 0), BLOCK * self.width);
            (0..BLOCK).map(move |row| block.iter().skip(row).step_by(BLOCK).copied().collect())
        });
        let recent = (self.stored..self.count).map(move |row| {
            let first = (row - self.stored) * self.width;
            self.recent[first..first + self.width].to_vec()
        });
        blocks.chain(recent)
    }
}

impl std::fmt::Debug for Rows {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(replication: usize) -> Vec<f64> {
        (0..3)
            .map(|column| if column == 1 && replication == 300 { f64::NAN } else { (replication * 3 + column) as f64 })
            .collect()
    }

    fn bits<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> Vec<u64> {
        numbers.into_iter().map(|number| number.to_bits()).collect()
    }

    fn assert_holds(rows: &Rows, count: usize) {
        assert_eq!(rows.count, count);
        let expected: Vec<Vec<f64>> = (0..count).map(row).collect();
        assert_eq!(bits(rows.iter().collect::<Vec<_>>().iter().flatten()), bits(expected.iter().flatten()));
        for column in 0..3 {
            assert_eq!(bits(&rows.column(column)), bits(expected.iter().map(|row| &row[column])));
        }
    }

    #[test]
    fn rows_come_back_to_the_bit_wherever_they_are_and_few_stay_in_memory() {
        let mut rows = Rows::default();
        for count in 0..2 * BLOCK + 10 {
            if [0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK].contains(&count) {
                assert_holds(&rows, count);
            }
            rows.push(&row(count));
            assert!(rows.recent.len() <= 3 * BLOCK);
        }
        assert_holds(&rows, 2 * BLOCK + 10);
    }

    #[test]
    fn a_copy_goes_on_by_itself() {
        let mut rows = Rows::default();
        (0..BLOCK + 5).for_each(|replication| rows.push(&row(replication)));
        let mut copy = rows.clone();
        (BLOCK + 5..3 * BLOCK).for_each(|replication| copy.push(&row(replication)));
        (BLOCK + 5..2 * BLOCK).for_each(|replication| rows.push(&row(replication)));
        assert_holds(&copy, 3 * BLOCK);
        assert_holds(&rows, 2 * BLOCK);
    }

    #[test]
    fn without_a_file_rows_stay_in_memory() {
        let mut rows = Rows { file: Place::Memory, ..Rows::default() };
        (0..2 * BLOCK + 1).for_each(|replication| rows.push(&row(replication)));
        assert_holds(&rows, 2 * BLOCK + 1);
    }
}
