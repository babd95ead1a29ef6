//! FMI 3.0: reading and setting variables of every type.
//!
//! Units have Float64, Int32, Boolean, String and Enumeration variables. The functions of the other types
//! exist and refuse every value reference.

use super::pointer::{slice, slice_mut, text};
use super::{call, read_reals};
use crate::component::Component;
use crate::fault::{Fault, Outcome};
use crate::log::Status;
use crate::variable::ValueType;
use std::ffi::{c_char, c_void};

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut f64,
    length: usize,
) -> Status {
    // SAFETY: as the standard demands of the importer.
    unsafe { read_reals(instance, "fmi3GetFloat64", (references, count), (values, length)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const f64,
    length: usize,
) -> Status {
    call(instance, "fmi3SetFloat64", |unit| {
        // SAFETY: as the standard demands of the importer.
        let (references, values) =
            unsafe { (slice(references, count, "valueReferences")?, slice(values, length, "values")?) };
        unit.write(ValueType::Real, references, values)
    })
}

/// Reads scalars into an array of another type.
///
/// # Safety
/// As the standard demands of the importer.
unsafe fn read<T>(
    unit: &mut dyn Component,
    value_type: ValueType,
    (references, count): (*const u32, usize),
    (values, length): (*mut T, usize),
    convert: impl Fn(f64) -> T,
) -> Outcome {
    // SAFETY: the caller's promise.
    let (references, values) =
        unsafe { (slice(references, count, "valueReferences")?, slice_mut(values, length, "values")?) };
    let mut numbers = vec![0.0; length];
    let status = unit.read(value_type, references, &mut numbers)?;
    for (value, number) in values.iter_mut().zip(numbers) {
        *value = convert(number);
    }
    Ok(status)
}

/// Sets scalars from an array of another type.
///
/// # Safety
/// As the standard demands of the importer.
unsafe fn write<T: Copy>(
    unit: &mut dyn Component,
    value_type: ValueType,
    (references, count): (*const u32, usize),
    (values, length): (*const T, usize),
    convert: impl Fn(T) -> f64,
) -> Outcome {
    // SAFETY: the caller's promise.
    let (references, values) =
        unsafe { (slice(references, count, "valueReferences")?, slice(values, length, "values")?) };
    let numbers: Vec<f64> = values.iter().copied().map(convert).collect();
    unit.write(value_type, references, &numbers)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt32(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut i32,
    length: usize,
) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(instance, "fmi3GetInt32", |unit| unsafe {
        are_enumerations(unit, (references, count), false)?;
        read(unit, ValueType::Integer, (references, count), (values, length), |value| value as i32)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetInt32(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const i32,
    length: usize,
) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(instance, "fmi3SetInt32", |unit| unsafe {
        are_enumerations(unit, (references, count), false)?;
        write(unit, ValueType::Integer, (references, count), (values, length), f64::from)
    })
}

/// That all variables are enumerations, or none is: those are 64-bit integers in FMI 3.0, all others here have 32 bits.
///
/// # Safety
/// As the standard demands of the importer.
unsafe fn are_enumerations(
    unit: &dyn Component,
    (references, count): (*const u32, usize),
    wanted: bool,
) -> Outcome<()> {
    // SAFETY: the caller's promise.
    let references = unsafe { slice(references, count, "valueReferences") }?;
    match references.iter().find(|reference| unit.is_enumeration(**reference) != wanted) {
        Some(&reference) => Err(Fault::Reference { reference }.into()),
        None => Ok(()),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt64(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut i64,
    length: usize,
) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(instance, "fmi3GetInt64", |unit| unsafe {
        are_enumerations(unit, (references, count), true)?;
        read(unit, ValueType::Integer, (references, count), (values, length), |value| value as i64)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetInt64(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const i64,
    length: usize,
) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(instance, "fmi3SetInt64", |unit| unsafe {
        are_enumerations(unit, (references, count), true)?;
        write(unit, ValueType::Integer, (references, count), (values, length), |value: i64| value as f64)
    })
}

// Booleans are read as bytes: a C importer may hand over a byte that is neither 0 nor 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetBoolean(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut u8,
    length: usize,
) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(instance, "fmi3GetBoolean", |unit| unsafe {
        read(unit, ValueType::Boolean, (references, count), (values, length), |value| u8::from(value > 0.5))
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetBoolean(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const u8,
    length: usize,
) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(instance, "fmi3SetBoolean", |unit| unsafe {
        write(unit, ValueType::Boolean, (references, count), (values, length), |value: u8| f64::from(value != 0))
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetString(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut *const c_char,
    length: usize,
) -> Status {
    call(instance, "fmi3GetString", |unit| {
        // SAFETY: as the standard demands of the importer.
        let (references, values) =
            unsafe { (slice(references, count, "valueReferences")?, slice_mut(values, length, "values")?) };
        if values.len() != references.len() {
            return Err(Fault::Length { values: values.len(), expected: references.len() }.into());
        }
        for (reference, value) in references.iter().zip(values) {
            *value = unit.read_text(*reference)?.as_ptr();
        }
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetString(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const *const c_char,
    length: usize,
) -> Status {
    call(instance, "fmi3SetString", |unit| {
        // SAFETY: as the standard demands of the importer.
        let (references, values) =
            unsafe { (slice(references, count, "valueReferences")?, slice(values, length, "values")?) };
        if values.len() != references.len() {
            return Err(Fault::Length { values: values.len(), expected: references.len() }.into());
        }
        for (reference, value) in references.iter().zip(values) {
            // SAFETY: as the standard demands of the importer.
            let value = unsafe { text(*value) }.ok_or(Fault::Null { argument: "values" })?;
            unit.write_text(*reference, value)?;
        }
        Ok(Status::Ok)
    })
}

/// Refuses the first value reference of a type that no variable has.
///
/// # Safety
/// As the standard demands of the importer.
unsafe fn none(instance: *mut c_void, name: &str, references: *const u32, count: usize) -> Status {
    call(instance, name, |_| {
        // SAFETY: the caller's promise.
        match unsafe { slice(references, count, "valueReferences") }?.first() {
            Some(&reference) => Err(Fault::Reference { reference }.into()),
            None => Ok(Status::Ok),
        }
    })
}

/// The functions of types that no variable has.
macro_rules! absent {
    ($($name:ident($($argument:ident: $type:ty),*);)+) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            instance: *mut c_void,
            references: *const u32,
            count: usize,
            $($argument: $type),*
        ) -> Status {
            $(let _ = $argument;)*
            // SAFETY: as the standard demands of the importer.
            unsafe { none(instance, stringify!($name), references, count) }
        }
    )+};
}

absent! {
    fmi3GetFloat32(values: *mut f32, length: usize);
    fmi3GetInt8(values: *mut i8, length: usize);
    fmi3GetUInt8(values: *mut u8, length: usize);
    fmi3GetInt16(values: *mut i16, length: usize);
    fmi3GetUInt16(values: *mut u16, length: usize);
    fmi3GetUInt32(values: *mut u32, length: usize);
    fmi3GetUInt64(values: *mut u64, length: usize);
    fmi3GetBinary(sizes: *mut usize, values: *mut *const u8, length: usize);
    fmi3GetClock(values: *mut u8);
    fmi3SetFloat32(values: *const f32, length: usize);
    fmi3SetInt8(values: *const i8, length: usize);
    fmi3SetUInt8(values: *const u8, length: usize);
    fmi3SetInt16(values: *const i16, length: usize);
    fmi3SetUInt16(values: *const u16, length: usize);
    fmi3SetUInt32(values: *const u32, length: usize);
    fmi3SetUInt64(values: *const u64, length: usize);
    fmi3SetBinary(sizes: *const usize, values: *const *const u8, length: usize);
    fmi3SetClock(values: *const u8);
    fmi3GetIntervalDecimal(intervals: *mut f64, qualifiers: *mut i32);
    fmi3GetIntervalFraction(counters: *mut u64, resolutions: *mut u64, qualifiers: *mut i32);
    fmi3GetShiftDecimal(shifts: *mut f64);
    fmi3GetShiftFraction(counters: *mut u64, resolutions: *mut u64);
    fmi3SetIntervalDecimal(intervals: *const f64);
    fmi3SetIntervalFraction(counters: *const u64, resolutions: *const u64);
    fmi3SetShiftDecimal(shifts: *const f64);
    fmi3SetShiftFraction(counters: *const u64, resolutions: *const u64);
}
