//! Instances leave nothing behind. Alone in its process, so that no other test takes memory.

#![cfg(target_os = "linux")]

mod importer;

use importer::*;
use std::ptr::null_mut;

/// Resident memory, bytes.
fn resident() -> usize {
    let pages = std::fs::read_to_string("/proc/self/statm").expect("statm");
    4096 * pages.split(' ').nth(1).and_then(|pages| pages.parse::<usize>().ok()).expect("a number of pages")
}

#[test]
fn three_thousand_cycles_leave_nothing_behind() {
    let token = token("milling");
    let cycle = || {
        let unit = ready3(&token);
        assert_eq!(step3(unit, 0.0, 0.1).0, 0);
        let mut state = null_mut();
        // SAFETY: the arguments are what the standard asks for; the saved state goes with the unit.
        unsafe {
            assert_eq!(fmi3GetFMUState(unit, &mut state), 0);
            fmi3FreeInstance(unit);
        }
    };
    (0..300).for_each(|_| cycle());
    let before = resident();
    (0..3000).for_each(|_| cycle());
    let growth = resident().saturating_sub(before);
    assert!(growth < 1 << 20, "{growth} bytes more after 3000 cycles");
}
