//! What importers should not do and some do: no call may take the host down, a refused call
//! changes nothing.

mod importer;

use importer::*;
use std::ffi::{CString, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::ScopedJoinHandle;
use toolroom_fmu::units;

const OK: i32 = 0;
const ERROR: i32 = 3;

fn speed() -> u32 {
    reference("turning", "process.cutting_speed")
}

#[test]
fn a_unit_without_name_or_right_token_is_not_made() {
    let token = token("turning");
    // SAFETY: NULL is what is being tested; the rest is what the standards ask for.
    unsafe {
        for (name, guid) in [(null(), token.as_ptr()), (c"".as_ptr(), token.as_ptr()), (c"x".as_ptr(), null())] {
            assert!(fmi2Instantiate(name, 1, guid, null(), null(), 0, 0).is_null());
            assert!(fmi3InstantiateModelExchange(name, guid, null(), 0, 0, null_mut(), null()).is_null());
        }
        assert!(fmi2Instantiate(c"x".as_ptr(), 1, c"{another}".as_ptr(), null(), null(), 0, 0).is_null());
        assert!(fmi2Instantiate(c"x".as_ptr(), 7, token.as_ptr(), null(), null(), 0, 0).is_null());
        let scheduled = fmi3InstantiateScheduledExecution(
            c"x".as_ptr(),
            token.as_ptr(),
            null(),
            0,
            1,
            null_mut(),
            null(),
            null(),
            null(),
            null(),
        );
        assert!(scheduled.is_null());
    }
    assert!(make2("infeed", 0).is_null(), "grinding has no Model Exchange");
}

#[test]
fn null_freed_and_foreign_instances_are_refused() {
    let freed = ready2("turning");
    // SAFETY: the handle is not followed, which is what is being tested.
    unsafe { fmi2FreeInstance(freed) };
    let mut place = 0u64;
    let foreign = std::ptr::from_mut(&mut place).cast::<c_void>();
    for unit in [null_mut(), freed, foreign, usize::MAX as Handle, 1 as Handle, 0xdead_beef as Handle] {
        let mut value = 0.0;
        // SAFETY: as above.
        unsafe {
            assert_eq!(fmi2DoStep(unit, 0.0, 0.1, 1), ERROR);
            assert_eq!(fmi2GetReal(unit, &speed(), 1, &mut value), ERROR);
            assert_eq!(fmi2Terminate(unit), ERROR);
            assert_eq!(fmi3Terminate(unit), ERROR);
            assert_eq!(step3(unit, 0.0, 0.1).0, ERROR);
            fmi2FreeInstance(unit);
            fmi3FreeInstance(unit);
        }
    }
    // A place that is used again does not bring the old handle back.
    let next = ready2("turning");
    // SAFETY: as above.
    unsafe {
        assert_eq!(fmi2DoStep(freed, 0.0, 0.1, 1), ERROR);
        assert_eq!(fmi2DoStep(next, 0.0, 0.1, 1), OK);
        fmi2FreeInstance(next);
    }
}

/// Makes, initialises and frees instances by `live` while another thread resets and frees, by `reset`
/// and `free`, what is no instance: NULL and the addresses beside it.
fn undisturbed(live: impl Fn(), reset: unsafe extern "C" fn(Handle) -> i32, free: unsafe extern "C" fn(Handle)) {
    let done = AtomicBool::new(false);
    // Instances are made in microseconds: none is before the other thread is at work.
    let both = std::sync::Barrier::new(2);
    std::thread::scope(|scope| {
        let resets = scope.spawn(|| {
            let mut answers = [0u32; 2];
            both.wait();
            loop {
                for handle in 0..8 {
                    // SAFETY: the handle is not followed, which is what is being tested.
                    let status = unsafe { reset(handle as Handle) };
                    answers[usize::from(status == ERROR)] += 1;
                    // SAFETY: as above.
                    unsafe { free(handle as Handle) };
                }
                if done.load(Ordering::Relaxed) {
                    break answers;
                }
            }
        });
        both.wait();
        let lives = catch_unwind(AssertUnwindSafe(|| (0..2000).for_each(|_| live())));
        done.store(true, Ordering::Relaxed);
        let [others, errors] = resets.join().expect("no panic");
        assert!(lives.is_ok(), "a fresh instance was refused");
        assert!(others == 0 && errors > 0, "{others} answers were no error");
    });
}

#[test]
fn null_in_one_thread_does_not_disturb_instances_of_fmi_2_made_in_another() {
    // SAFETY: the handle is that of `ready2`.
    undisturbed(|| unsafe { fmi2FreeInstance(ready2("turning")) }, fmi2Reset, fmi2FreeInstance);
}

#[test]
fn null_in_one_thread_does_not_disturb_instances_of_fmi_3_made_in_another() {
    let token = token("turning");
    // SAFETY: the handle is that of `ready3`.
    undisturbed(|| unsafe { fmi3FreeInstance(ready3(&token)) }, fmi3Reset, fmi3FreeInstance);
}

#[test]
fn an_instance_called_and_freed_in_many_threads_is_freed_once_and_brings_none_down() {
    let token = token("turning");
    for _ in 0..50 {
        let unit = ready3(&token) as usize;
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..20 {
                        // SAFETY: what is in use or freed is refused, which is what is being tested.
                        let status = unsafe { fmi3Reset(unit as Handle) };
                        assert!(status == OK || status == ERROR);
                    }
                    // SAFETY: as above.
                    unsafe { fmi3FreeInstance(unit as Handle) };
                });
            }
        });
        // Freed under a call it lives on.
        // SAFETY: as above.
        unsafe { fmi3FreeInstance(unit as Handle) };
        // SAFETY: as above.
        assert_eq!(unsafe { fmi3Reset(unit as Handle) }, ERROR, "freed");
    }
}

#[test]
fn null_arrays_and_strings_are_refused() {
    let unit = ready2("turning");
    let three = ready3(&token("turning"));
    let set = reference("turning", "tool.set");
    let nowhere: *const c_char = null();
    // SAFETY: NULL is what is being tested.
    unsafe {
        assert_eq!(fmi2GetReal(unit, null(), 1, &mut 0.0), ERROR);
        assert_eq!(fmi2GetReal(unit, &speed(), 1, null_mut()), ERROR);
        assert_eq!(fmi2SetReal(unit, null(), 2, null()), ERROR);
        assert_eq!(fmi2SetString(unit, &set, 1, &nowhere), ERROR);
        assert_eq!(fmi2GetFMUstate(unit, null_mut()), ERROR);
        assert_eq!(fmi2SerializedFMUstateSize(unit, null_mut(), null_mut()), ERROR);
        assert_eq!(fmi2NewDiscreteStates(unit, null_mut()), ERROR);
        assert_eq!(fmi2SetDebugLogging(unit, 1, 2, null()), ERROR);
        assert_eq!(fmi2GetReal(unit, null(), 0, null_mut()), OK, "nothing is asked for");
        assert_eq!(fmi3GetFloat64(three, null(), 1, &mut 0.0, 1), ERROR);
        assert_eq!(fmi3GetFloat64(three, &speed(), 1, null_mut(), 1), ERROR);
        assert_eq!(fmi3SetString(three, &set, 1, &nowhere, 1), ERROR);
        assert_eq!(fmi3GetDirectionalDerivative(three, null(), 1, null(), 1, null(), 1, null_mut(), 1), ERROR);
        assert_eq!(fmi3FreeFMUState(three, null_mut()), OK, "as free(NULL)");
        assert_eq!(
            fmi3DoStep(three, 0.0, 0.1, 0, null_mut(), null_mut(), null_mut(), null_mut()),
            OK,
            "an importer may not care"
        );
        fmi2FreeInstance(unit);
        fmi3FreeInstance(three);
    }
}

#[test]
fn numbers_that_are_none_are_refused_and_change_nothing() {
    let (two, three) = (ready2("turning"), ready3(&token("turning")));
    let speed = speed();
    let before = get3(three, speed);
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 1e9] {
        // SAFETY: the arguments are what the standards ask for.
        unsafe {
            assert_eq!(fmi2SetReal(two, &speed, 1, &value), ERROR, "{value}");
            assert_eq!(fmi3SetFloat64(three, &speed, 1, &value, 1), ERROR, "{value}");
        }
    }
    assert_eq!(get3(three, speed), before);
    for step in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        // SAFETY: as above.
        unsafe { assert_eq!(fmi2DoStep(two, 0.0, step, 1), ERROR, "{step}") };
        assert_eq!(step3(three, 0.0, step).0, ERROR, "{step}");
    }
    for time in [5.0, -1.0, f64::NAN] {
        assert_eq!(step3(three, time, 0.1).0, ERROR, "a step from {time}");
    }
    assert_eq!(step3(three, 0.0, 0.1), (OK, false, false, 0.1), "the unit goes on");
    // SAFETY: as above.
    unsafe {
        fmi2FreeInstance(two);
        fmi3FreeInstance(three);
    }
}

#[test]
fn references_that_do_not_exist_or_have_another_type_are_refused() {
    let (two, three) = (ready2("turning"), ready3(&token("turning")));
    let change = reference("turning", "tool.change");
    for wrong in [999_999, 1_999, 4_999, u32::MAX, change] {
        // SAFETY: the arguments are what the standards ask for.
        unsafe {
            assert_eq!(fmi2GetReal(two, &wrong, 1, &mut 0.0), ERROR, "{wrong}");
            assert_eq!(fmi2SetReal(two, &wrong, 1, &0.0), ERROR, "{wrong}");
            assert_eq!(fmi3GetFloat64(three, &wrong, 1, &mut 0.0, 1), ERROR, "{wrong}");
            assert_eq!(fmi3GetInt32(three, &wrong, 1, &mut 0, 1), ERROR, "{wrong}");
        }
    }
    // All or nothing: the first value of two is not taken where the second is refused.
    let before = get3(three, speed());
    // SAFETY: as above.
    unsafe {
        assert_eq!(fmi3SetFloat64(three, [speed(), 999_999].as_ptr(), 2, [1.0, 1.0].as_ptr(), 2), ERROR);
        assert_eq!(fmi3SetFloat64(three, [speed()].as_ptr(), 1, [1.0, 1.0].as_ptr(), 2), ERROR);
    }
    assert_eq!(get3(three, speed()), before);
    // SAFETY: as above.
    unsafe {
        fmi2FreeInstance(two);
        fmi3FreeInstance(three);
    }
}

#[test]
fn enumerations_are_integers_of_64_bits_in_fmi_3_and_plain_ones_in_fmi_2() {
    let (two, three) = (ready2("turning"), ready3(&token("turning")));
    let (mode, count) = (reference("turning", "adaptive.mode"), reference("turning", "tool.count"));
    let (mut narrow, mut wide) = (0, 0);
    // SAFETY: the arguments are what the standards ask for.
    unsafe {
        assert_eq!((fmi2GetInteger(two, &mode, 1, &mut narrow), narrow), (OK, 1));
        assert_eq!((fmi3GetInt64(three, &mode, 1, &mut wide, 1), wide), (OK, 1));
        assert_eq!(fmi3SetInt64(three, &mode, 1, &3, 1), OK);
        assert_eq!((fmi3GetInt64(three, &mode, 1, &mut wide, 1), wide), (OK, 3));
        assert_eq!(fmi3SetInt64(three, &mode, 1, &4, 1), ERROR, "there are three modes");
        assert_eq!(fmi3GetInt32(three, &mode, 1, &mut narrow, 1), ERROR);
        assert_eq!(fmi3GetInt64(three, &count, 1, &mut wide, 1), ERROR);
        assert_eq!((fmi3GetInt32(three, &count, 1, &mut narrow, 1), narrow), (OK, 1));
        fmi2FreeInstance(two);
        fmi3FreeInstance(three);
    }
    let turning = units().next().expect("turning").describe();
    for (xml, items) in [(turning.fmi2(), 3), (turning.fmi3(), 3)] {
        assert_eq!(xml.matches("<Item name=").count(), items, "{xml}");
        assert!(xml.contains("declaredType=\"Choice of adaptive.mode\""));
    }
}

#[test]
fn functions_out_of_order_are_refused() {
    let two = make2("turning", 1);
    // SAFETY: the arguments are what the standards ask for.
    unsafe {
        assert_eq!(fmi2DoStep(two, 0.0, 0.1, 1), ERROR, "before initialisation");
        assert_eq!(fmi2ExitInitializationMode(two), ERROR);
        assert_eq!(fmi2EnterEventMode(two), ERROR);
        assert_eq!(fmi2Terminate(two), ERROR);
        assert_eq!(fmi2EnterInitializationMode(two), OK);
        assert_eq!(fmi2EnterInitializationMode(two), ERROR);
        assert_eq!(fmi2ExitInitializationMode(two), OK);
        assert_eq!(fmi2SetTime(two, 1.0), ERROR, "Model Exchange only");
        assert_eq!(fmi2GetContinuousStates(two, [0.0; 10].as_mut_ptr(), 10), ERROR);
        assert_eq!(fmi2SetReal(two, &reference("turning", "process.flank_wear"), 1, &0.0), ERROR, "an output");
        assert_eq!(fmi2DoStep(two, 0.0, 0.1, 1), OK);
        assert_eq!(fmi2Terminate(two), OK);
        assert_eq!(fmi2Terminate(two), ERROR);
        assert_eq!(fmi2DoStep(two, 0.1, 0.1, 1), ERROR);
        assert_eq!(fmi2Reset(two), OK);
        assert_eq!(fmi2EnterInitializationMode(two), OK);
        fmi2FreeInstance(two);
    }
}

#[test]
fn functions_of_fmi_3_out_of_order_are_refused() {
    let token = token("turning");
    let three = make3(&token, false);
    let begin = |unit| {
        // SAFETY: the arguments are what the standard asks for.
        unsafe { fmi3EnterInitializationMode(unit, 0, 0.0, 0.0, 0, 0.0) }
    };
    // SAFETY: as above.
    unsafe {
        assert_eq!(step3(three, 0.0, 0.1).0, ERROR, "before initialisation");
        assert_eq!(fmi3ExitInitializationMode(three), ERROR);
        assert_eq!(fmi3EnterStepMode(three), ERROR);
        assert_eq!(fmi3Terminate(three), ERROR);
        assert_eq!(begin(three), OK);
        assert_eq!(begin(three), ERROR);
        assert_eq!(step3(three, 0.0, 0.1).0, ERROR, "during initialisation");
        assert_eq!(fmi3ExitInitializationMode(three), OK);
        assert_eq!(fmi3EnterEventMode(three), ERROR, "made without Event Mode");
        let wear = reference("turning", "process.flank_wear");
        assert_eq!(fmi3SetFloat64(three, &wear, 1, &0.0, 1), ERROR, "an output");
        assert_eq!(step3(three, 0.0, 0.1).0, OK);
        assert_eq!(fmi3Terminate(three), OK);
        assert_eq!(fmi3Terminate(three), ERROR);
        assert_eq!(step3(three, 0.1, 0.1).0, ERROR);
        assert_eq!(fmi3Reset(three), OK);
        assert_eq!(begin(three), OK);
        fmi3FreeInstance(three);
    }
    let with_events = make3(&token, true);
    // SAFETY: as above.
    unsafe {
        assert_eq!((begin(with_events), fmi3ExitInitializationMode(with_events)), (OK, OK));
        assert_eq!(step3(with_events, 0.0, 0.1).0, ERROR, "Event Mode comes first");
        let (mut again, mut none) = (0, [0; 4]);
        let [end, nominals, values, defined] = &mut none;
        assert_eq!(fmi3UpdateDiscreteStates(with_events, &mut again, end, nominals, values, defined, &mut 0.0), OK);
        assert_eq!(fmi3EnterStepMode(with_events), OK);
        assert_eq!(step3(with_events, 0.0, 0.1).0, OK);
        fmi3FreeInstance(with_events);
    }
}

#[test]
fn saved_states_of_fmi_2_are_refused_where_broken_or_freed() {
    let (one, other) = (ready2("turning"), ready2("turning"));
    let (mut state, mut copy, mut size) = (null_mut(), null_mut(), 0);
    // SAFETY: the arguments are what the standard asks for.
    unsafe {
        assert_eq!(fmi2GetFMUstate(one, &mut state), OK);
        assert_eq!(fmi2SetFMUstate(other, 77 as Handle), ERROR);
        assert_eq!(fmi2SetFMUstate(one, null_mut()), ERROR);
        assert_eq!(fmi2SerializedFMUstateSize(one, state, &mut size), OK);
        let mut bytes = vec![0; size];
        assert_eq!(fmi2SerializeFMUstate(one, state, bytes.as_mut_ptr(), size - 1), ERROR, "too small");
        assert_eq!(fmi2SerializeFMUstate(one, state, bytes.as_mut_ptr(), size), OK);
        assert_eq!(fmi2DeSerializeFMUstate(other, null(), size, &mut copy), ERROR);
        for offset in [0, 5, 20, 30, size / 2, size - 1] {
            bytes[offset] ^= 1;
            assert_eq!(fmi2DeSerializeFMUstate(other, bytes.as_ptr(), size, &mut copy), ERROR, "byte {offset}");
            bytes[offset] ^= 1;
        }
        for length in [0, 3, 27, size - 1] {
            assert_eq!(fmi2DeSerializeFMUstate(other, bytes.as_ptr(), length, &mut copy), ERROR, "{length} bytes");
        }
        assert_eq!(fmi2DeSerializeFMUstate(other, bytes.as_ptr(), size, &mut copy), OK);
        assert_eq!(fmi2SetFMUstate(other, copy), OK);
        let freed = copy;
        assert_eq!(fmi2FreeFMUstate(other, &mut copy), OK);
        assert_eq!(fmi2SetFMUstate(other, freed), ERROR, "a freed state");
        fmi2FreeInstance(one);
        fmi2FreeInstance(other);
    }
}

#[test]
fn saved_states_of_others_and_broken_bytes_are_refused() {
    let token = token("turning");
    let (one, other) = (ready3(&token), ready3(&token));
    let mut state = null_mut();
    let mut size = 0;
    // SAFETY: the arguments are what the standard asks for.
    unsafe {
        assert_eq!(fmi3GetFMUState(one, &mut state), OK);
        assert_eq!(fmi3SetFMUState(other, 77 as Handle), ERROR);
        assert_eq!(fmi3SetFMUState(one, null_mut()), ERROR);
        assert_eq!(fmi3SerializedFMUStateSize(one, state, &mut size), OK);
        let mut bytes = vec![0; size];
        assert_eq!(fmi3SerializeFMUState(one, state, bytes.as_mut_ptr(), size - 1), ERROR, "too small");
        assert_eq!(fmi3SerializeFMUState(one, state, bytes.as_mut_ptr(), size), OK);
        let mut copy = null_mut();
        for offset in [0, 5, 20, 30, size / 2, size - 1] {
            bytes[offset] ^= 1;
            assert_eq!(fmi3DeserializeFMUState(other, bytes.as_ptr(), size, &mut copy), ERROR, "byte {offset}");
            bytes[offset] ^= 1;
        }
        for length in [0, 3, 27, size - 1] {
            assert_eq!(fmi3DeserializeFMUState(other, bytes.as_ptr(), length, &mut copy), ERROR, "{length} bytes");
        }
        bytes.push(0);
        assert_eq!(fmi3DeserializeFMUState(other, bytes.as_ptr(), size + 1, &mut copy), ERROR, "a byte more");
        assert_eq!(fmi3DeserializeFMUState(other, bytes.as_ptr(), size, &mut copy), OK);
        assert_eq!(fmi3SetFMUState(other, copy), OK);
        let freed = copy;
        assert_eq!(fmi3FreeFMUState(other, &mut copy), OK);
        assert!(copy.is_null());
        assert_eq!(fmi3SetFMUState(other, freed), ERROR, "a freed state");
        fmi3FreeInstance(one);
        fmi3FreeInstance(other);
    }
}

#[test]
fn a_saved_state_of_another_instance_is_refused_though_both_have_one() {
    let (one, other) = (ready2("turning"), ready2("turning"));
    let (mut of_one, mut of_other) = (null_mut(), null_mut());
    // SAFETY: the arguments are what the standard asks for, but for whose they are.
    unsafe {
        assert_eq!((fmi2GetFMUstate(one, &mut of_one), fmi2GetFMUstate(other, &mut of_other)), (OK, OK));
        assert_eq!(fmi2SetFMUstate(other, of_one), ERROR);
        assert_eq!(fmi2GetFMUstate(other, &mut of_one), ERROR, "nor is it written over");
        assert_eq!(fmi2FreeFMUstate(other, &mut of_one), ERROR);
        assert_eq!((fmi2SetFMUstate(one, of_one), fmi2SetFMUstate(other, of_other)), (OK, OK));
        fmi2FreeInstance(one);
        fmi2FreeInstance(other);
    }
}

#[test]
fn as_many_states_as_there_are_places_can_be_kept_and_a_freed_place_is_used_again() {
    let unit = ready3(&token("turning"));
    let save = |state: &mut Handle| {
        // SAFETY: the arguments are what the standard asks for.
        unsafe { fmi3GetFMUState(unit, state) }
    };
    let mut states = vec![null_mut(); 1 << 16];
    assert!(states.iter_mut().all(|state| save(state) == OK));
    let (mut more, freed) = (null_mut(), states[777]);
    assert_eq!(save(&mut more), ERROR, "all places are taken");
    assert_eq!(save(&mut states[5]), OK, "but for one's own");
    // SAFETY: as above.
    unsafe {
        assert_eq!(fmi3FreeFMUState(unit, &mut states[777]), OK);
        assert_eq!((save(&mut more), save(&mut null_mut())), (OK, ERROR), "one place was free");
        assert_eq!(fmi3SetFMUState(unit, freed), ERROR, "what comes after a state is another one");
        assert_eq!((fmi3SetFMUState(unit, more), fmi3SetFMUState(unit, states[776])), (OK, OK));
        fmi3FreeInstance(unit);
    }
}

#[test]
fn an_unknown_parameter_set_is_refused_and_names_no_file_outside() {
    let unit = make2("turning", 1);
    let set = reference("turning", "tool.set");
    for name in [c"steel", c"../../../etc/passwd", c""] {
        // SAFETY: the arguments are what the standard asks for.
        assert_eq!(unsafe { fmi2SetString(unit, &set, 1, &name.as_ptr()) }, ERROR, "{name:?}");
    }
    // SAFETY: as above.
    unsafe {
        assert_eq!(fmi2SetString(unit, &set, 1, &c"c45_t15k6".as_ptr()), OK);
        let mut read = null();
        assert_eq!(fmi2GetString(unit, &set, 1, &mut read), OK);
        assert_eq!(std::ffi::CStr::from_ptr(read), c"c45_t15k6");
        fmi2FreeInstance(unit);
    }
}

/// What a logger was told: status, category, text.
type Heard = Vec<(i32, String, String)>;

unsafe extern "C" fn remember(environment: *mut c_void, status: i32, category: *const c_char, text: *const c_char) {
    // SAFETY: the environment is the list of the test, the texts are the unit's.
    unsafe {
        let words = |pointer| std::ffi::CStr::from_ptr(pointer).to_str().expect("UTF-8").to_owned();
        (*environment.cast::<Heard>()).push((status, words(category), words(text)));
    }
}

#[test]
fn a_logger_hears_why_with_its_own_environment_and_only_when_it_wants() {
    let mut heard = Heard::new();
    let make = |heard: &mut Heard, logging: u8| {
        let (token, environment) = (token("turning"), std::ptr::from_mut(heard).cast());
        let logger = remember as *const c_void;
        // SAFETY: the arguments are what the standard asks for.
        unsafe { fmi3InstantiateModelExchange(c"x".as_ptr(), token.as_ptr(), null(), 0, logging, environment, logger) }
    };
    let (loud, silent) = (make(&mut heard, 1), make(&mut heard, 0));
    // SAFETY: as above.
    unsafe {
        assert_eq!(fmi3Terminate(silent), ERROR);
        assert_eq!(fmi3Terminate(loud), ERROR);
        assert_eq!(fmi3SetFloat64(loud, &speed(), 1, &-1.0, 1), ERROR);
    }
    let expected = [
        "fmi3Terminate: Terminate may not be called in the instantiated state",
        "fmi3SetFloat64: process.cutting_speed: cutting_speed = -60 m/min is outside 0 to 3000 m/min",
    ];
    let texts: Vec<&str> = heard.iter().map(|(_, _, text)| text.as_str()).collect();
    assert_eq!(texts, expected);
    assert!(heard.iter().all(|(status, category, _)| (*status, category.as_str()) == (ERROR, "logStatusError")));
    // SAFETY: as above.
    unsafe {
        fmi3FreeInstance(loud);
        fmi3FreeInstance(silent);
    }
}

/// Wear after a hundred steps of a turning unit of FMI 2.0.
fn worn2(wear: u32) -> u64 {
    let (unit, mut value) = (ready2("turning"), f64::NAN);
    // SAFETY: the arguments are what the standard asks for.
    unsafe {
        for i in 0..100 {
            assert_eq!(fmi2DoStep(unit, f64::from(i) * 0.5, 0.5, 1), OK);
        }
        assert_eq!(fmi2GetReal(unit, &wear, 1, &mut value), OK);
        fmi2FreeInstance(unit);
    }
    value.to_bits()
}

/// Wear after a hundred steps of a turning unit of FMI 3.0.
fn worn(token: &CString, wear: u32) -> u64 {
    let unit = ready3(token);
    for i in 0..100 {
        assert_eq!(step3(unit, f64::from(i) * 0.5, 0.5).0, OK);
    }
    let worn = get3(unit, wear).to_bits();
    // SAFETY: the handle is that of `ready3`.
    unsafe { fmi3FreeInstance(unit) };
    worn
}

#[test]
fn sixty_four_instances_in_eight_threads_agree() {
    let (token, wear) = (token("turning"), reference("turning", "process.flank_wear"));
    let alone = worn(&token, wear);
    std::thread::scope(|scope| {
        let runs: Vec<ScopedJoinHandle<'_, Vec<u64>>> =
            (0..8).map(|_| scope.spawn(|| (0..4).flat_map(|_| [worn(&token, wear), worn2(wear)]).collect())).collect();
        for run in runs {
            assert!(run.join().expect("a thread").iter().all(|each| *each == alone));
        }
    });
}

#[test]
fn one_instance_in_two_threads_gives_errors_and_no_races() {
    let unit = ready3(&token("turning")) as usize;
    let wear = reference("turning", "process.flank_wear");
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(move || {
                for _ in 0..2000 {
                    let mut value = 0.0;
                    // SAFETY: the unit refuses a call while another is under way.
                    let status = unsafe { fmi3GetFloat64(unit as Handle, &wear, 1, &mut value, 1) };
                    assert!(status == OK || status == ERROR);
                }
            });
        }
    });
    assert_eq!(step3(unit as Handle, 0.0, 0.1).0, OK);
    // SAFETY: the handle is that of `ready3`.
    unsafe { fmi3FreeInstance(unit as Handle) };
}

#[test]
fn every_shipped_unit_can_be_made_through_both_interfaces() {
    for unit in units() {
        let two = ready2(unit.name);
        let three = ready3(&token(unit.name));
        // SAFETY: the arguments are what the standards ask for.
        unsafe {
            assert_eq!(fmi2DoStep(two, 0.0, 0.1, 1), OK, "{}", unit.name);
            assert_eq!(step3(three, 0.0, 0.1).0, OK, "{}", unit.name);
            fmi2FreeInstance(two);
            fmi3FreeInstance(three);
        }
    }
}
