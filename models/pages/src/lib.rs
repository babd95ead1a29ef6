//! Items read from the lines of long texts, in pages that are dropped and read again.
//!
//! A part program of a CAM system has millions of lines, of which each runs once. What is made of them is kept for as long as a
//! window of pages is wide; a jump back reads its page again from the text, which stays in its file.
//!
//! | item | what it is |
//! |---|---|
//! | [`Source`], [`Lines`], [`Mark`] | a text in memory or in a file, its lines, and a place to go on from |
//! | [`Reader`] | what makes items of lines |
//! | [`Pages`], [`At`], [`PageWindow`] | the items of several texts by their index, and while they are read |
//! | [`ReadError`] | the text could not be read, or is another one than before |

#![deny(clippy::wildcard_enum_match_arm)]

mod pages;
mod source;

pub use pages::{At, PageWindow, Pages, Reader};
pub use source::{Lines, Mark, ReadError, Source};
