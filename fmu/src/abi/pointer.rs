//! Arrays and strings that importers point to.

use crate::fault::{Fault, Outcome};
use std::ffi::{CStr, c_char};
use std::path::PathBuf;

/// `count` elements at `data`; an empty slice may have any address.
///
/// # Safety
/// A pointer that is not NULL points to `count` elements that nobody else writes.
pub(super) unsafe fn slice<'a, T>(data: *const T, count: usize, argument: &'static str) -> Outcome<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    if data.is_null() || !data.is_aligned() || count > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(Fault::Null { argument }.into());
    }
    // SAFETY: the caller's promise, checked as far as it can be.
    Ok(unsafe { std::slice::from_raw_parts(data, count) })
}

/// As [`slice`], to be written.
///
/// # Safety
/// As [`slice`], and nobody else reads.
pub(super) unsafe fn slice_mut<'a, T>(data: *mut T, count: usize, argument: &'static str) -> Outcome<&'a mut [T]> {
    if count == 0 {
        return Ok(&mut []);
    }
    if data.is_null() || !data.is_aligned() || count > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(Fault::Null { argument }.into());
    }
    // SAFETY: the caller's promise, checked as far as it can be.
    Ok(unsafe { std::slice::from_raw_parts_mut(data, count) })
}

/// What `target` points to, to be written.
///
/// # Safety
/// A pointer that is not NULL points to a value of its type.
pub(super) unsafe fn target<'a, T>(target: *mut T, argument: &'static str) -> Outcome<&'a mut T> {
    // SAFETY: the caller's promise.
    unsafe { slice_mut(target, 1, argument) }.map(|one| &mut one[0])
}

/// Writes where the importer wants the value at all.
///
/// # Safety
/// As [`target`].
pub(super) unsafe fn put<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: the caller's promise.
        unsafe { place.write(value) };
    }
}

/// Text of a C string; `None` for NULL and for what is not UTF-8.
///
/// # Safety
/// A pointer that is not NULL points to a string with its terminating zero.
pub(super) unsafe fn text<'a>(text: *const c_char) -> Option<&'a str> {
    // SAFETY: the caller's promise.
    (!text.is_null()).then(|| unsafe { CStr::from_ptr(text) })?.to_str().ok()
}

/// Texts of an array of C strings.
///
/// # Safety
/// As [`slice`] and [`text`].
pub(super) unsafe fn texts<'a>(data: *const *const c_char, count: usize) -> Outcome<Vec<&'a str>> {
    // SAFETY: the caller's promise.
    let pointers = unsafe { slice(data, count, "categories") }?;
    // SAFETY: the caller's promise.
    pointers
        .iter()
        .map(|each| unsafe { text(*each) }.ok_or_else(|| Fault::Null { argument: "category" }.into()))
        .collect()
}

/// Folder of a `file:` URI, percent signs decoded.
pub(super) fn folder_of_uri(uri: &str) -> Option<PathBuf> {
    let path = uri.strip_prefix("file:")?;
    let path = path.strip_prefix("//").map_or(path, |rest| rest.strip_prefix("localhost").unwrap_or(rest));
    let mut bytes = Vec::with_capacity(path.len());
    let mut rest = path.as_bytes();
    while let [first, after @ ..] = rest {
        let hex = after.get(..2).and_then(|two| std::str::from_utf8(two).ok());
        match (first, hex.and_then(|two| u8::from_str_radix(two, 16).ok())) {
            (b'%', Some(byte)) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            _ => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    let path = String::from_utf8(bytes).ok()?;
    // file:///C:/folder
    let drive = path.get(1..3).is_some_and(|two| two.as_bytes()[0].is_ascii_alphabetic() && two.ends_with(':'));
    Some(PathBuf::from(if drive { &path[1..] } else { &path[..] }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_lead_to_folders() {
        for (uri, folder) in [
            ("file:///tmp/a%20b/resources", "/tmp/a b/resources"),
            ("file:/tmp/resources", "/tmp/resources"),
            ("file://localhost/tmp/r", "/tmp/r"),
            ("file:///C:/unit/resources/", "C:/unit/resources/"),
            ("file:///tmp/100%", "/tmp/100%"),
        ] {
            assert_eq!(folder_of_uri(uri), Some(PathBuf::from(folder)), "{uri}");
        }
        assert_eq!(folder_of_uri("http://x/y"), None);
    }
}
