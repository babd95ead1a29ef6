//! Records: flat lists of numbers that carry their own description.

use crate::{Field, ModelError};
use std::fmt::Debug;

/// A flat list of SI numbers described by [`Field`]s.
///
/// Declared with [`record!`](crate::record!), never by hand. Elements of array fields are
/// counted one by one, in the order of the declaration.
pub trait Record: Copy + Default + Debug + PartialEq + Send + Sync + 'static {
    /// One entry a field, in order.
    const FIELDS: &'static [Field];
    /// Number of elements, array fields counted with their length.
    const LEN: usize;
    /// Element `i`, or `None` past the end.
    fn get(&self, i: usize) -> Option<f64>;
    /// Sets element `i`; `None` past the end. Ranges are checked by [`Record::check`].
    fn set(&mut self, i: usize, value: f64) -> Option<()>;

    /// Every element against its field's range.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for the first element outside its range or not finite.
    fn check(&self) -> Result<(), ModelError> {
        if self.fits() {
            return Ok(());
        }
        let mut index = 0;
        for field in Self::FIELDS {
            for _ in 0..field.len {
                if let Some(value) = self.get(index) {
                    field.check(value)?;
                }
                index += 1;
            }
        }
        Ok(())
    }

    /// Whether every element lies in its field's range: [`Record::check`] without a reason, for
    /// whoever asks at every step.
    fn fits(&self) -> bool;

    /// Index of the first element of the field called `name`.
    fn index_of(name: &str) -> Option<usize> {
        let mut index = 0;
        for field in Self::FIELDS {
            if field.name == name {
                return Some(index);
            }
            index += field.len;
        }
        None
    }

    /// Reads elements from `values`.
    ///
    /// # Shape
    /// `values` holds [`Record::LEN`] SI numbers; missing ones keep their start value.
    fn from_slice(values: &[f64]) -> Self;

    /// Writes the elements to `values`, as many as fit.
    fn write_to(&self, values: &mut [f64]);
}

/// The object-safe face of [`Record`], for groups of parameters of different records.
pub trait AnyRecord {
    /// One entry a field, in order.
    fn fields(&self) -> &'static [Field];
    /// Element `i`, or `None` past the end.
    fn value(&self, i: usize) -> Option<f64>;
    /// Sets element `i`; `None` past the end.
    fn set_value(&mut self, i: usize, value: f64) -> Option<()>;
}

impl<R: Record> AnyRecord for R {
    fn fields(&self) -> &'static [Field] {
        R::FIELDS
    }
    fn value(&self, i: usize) -> Option<f64> {
        self.get(i)
    }
    fn set_value(&mut self, i: usize, value: f64) -> Option<()> {
        self.set(i, value)
    }
}

/// A scalar or an array as a slice; what [`record!`](crate::record!) expands to.
#[doc(hidden)]
pub trait Slots {
    fn slots(&self) -> &[f64];
    fn slots_mut(&mut self) -> &mut [f64];

    /// Takes as many elements from the front of `values` as there are, and hands back the rest.
    #[inline]
    fn read<'a>(&mut self, values: &'a [f64]) -> &'a [f64] {
        let slots = self.slots_mut();
        let count = slots.len().min(values.len());
        slots[..count].copy_from_slice(&values[..count]);
        &values[count..]
    }

    /// Writes to the front of `values` what fits, and hands back the rest.
    #[inline]
    fn write<'a>(&self, values: &'a mut [f64]) -> &'a mut [f64] {
        let slots = self.slots();
        let count = slots.len().min(values.len());
        values[..count].copy_from_slice(&slots[..count]);
        &mut values[count..]
    }
}

impl Slots for f64 {
    #[inline]
    fn slots(&self) -> &[f64] {
        std::slice::from_ref(self)
    }
    #[inline]
    fn slots_mut(&mut self) -> &mut [f64] {
        std::slice::from_mut(self)
    }
    // A number alone is the field of most records, and records are written and read within every step of a run. Where
    // nothing is inlined, the general way costs half a dozen calls a field.
    #[inline]
    fn read<'a>(&mut self, values: &'a [f64]) -> &'a [f64] {
        let [first, rest @ ..] = values else { return values };
        *self = *first;
        rest
    }
    #[inline]
    fn write<'a>(&self, values: &'a mut [f64]) -> &'a mut [f64] {
        if values.is_empty() {
            return values;
        }
        let (first, rest) = values.split_at_mut(1);
        first[0] = *self;
        rest
    }
}

impl<const L: usize> Slots for [f64; L] {
    fn slots(&self) -> &[f64] {
        self
    }
    fn slots_mut(&mut self) -> &mut [f64] {
        self
    }
}

/// Declares a [`Record`]: a struct generic over its number type (`f64` unless said otherwise,
/// a dual number where derivatives are wanted) with one documented field a line.
///
/// ```text
/// name: Real["SI unit" => "display unit"] = start, min..=max;
/// name: Real["SI unit" => "display unit"; LENGTH] = start, min..=max;   // an array
/// name: Boolean = 1.0;    name: Integer = 4.0, 1.0..=100.0;
/// ```
/// `start`, `min` and `max` are SI constants. A field without range may take any finite value.
///
/// ```
/// use toolroom_process::{Record, record};
/// record! {
///     /// What a pass commands.
///     pub struct Pass {
///         /// Cutting speed v_c (ISO 3002-1).
///         cutting_speed: Real["m/s" => "m/min"] = 0.5, 0.0..=50.0;
///         /// Whether the edge is in cut.
///         engaged: Boolean = 1.0;
///     }
/// }
/// let mut pass = Pass::default();
/// pass.cutting_speed = 1.0;
/// assert_eq!(pass.get(0), Some(1.0));
/// assert_eq!(Pass::<f64>::FIELDS[0].header(), "cutting_speed [m/min]");
/// assert!(pass.check().is_ok());
/// ```
#[macro_export]
macro_rules! record {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $(
                $(#[doc = $doc:literal])+
                $field:ident : $kind:ident $([$unit:literal => $display:literal $(; $len:literal)?])?
                    = $start:expr $(, $range:expr)? ;
            )*
        }
    ) => {
        $(#[$meta])*
        pub struct $name<N = f64> {
            $( $(#[doc = $doc])+ pub $field: $crate::__record_type!(N $($(; $len)?)?), )*
        }

        // Not derived: `derive` does not accept the macro that makes the field types.
        impl<N: Copy> Clone for $name<N> {
            #[inline]
            fn clone(&self) -> Self {
                *self
            }
        }

        impl<N: Copy> Copy for $name<N> {}

        impl<N: std::fmt::Debug> std::fmt::Debug for $name<N> {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.debug_struct(stringify!($name))$(.field(stringify!($field), &self.$field))*.finish()
            }
        }

        impl<N: PartialEq> PartialEq for $name<N> {
            fn eq(&self, other: &Self) -> bool {
                true $(&& self.$field == other.$field)*
            }
        }

        #[allow(dead_code)] // a private record may never need another number type
        impl<N: Copy> $name<N> {
            /// The same record over another number type.
            #[inline]
            pub fn map<M: Copy>(self, mut convert: impl FnMut(N) -> M) -> $name<M> {
                $name { $( $field: $crate::__record_map!(self.$field, convert $($(; $len)?)?), )* }
            }
        }

        impl Default for $name<f64> {
            fn default() -> Self {
                $name { $( $field: $crate::__record_start!($start $($(; $len)?)?), )* }
            }
        }

        impl $crate::Record for $name<f64> {
            const FIELDS: &'static [$crate::Field] = &[ $( {
                const RANGE: std::ops::RangeInclusive<f64> =
                    $crate::__record_range!($kind $($range)?);
                $crate::Field {
                    name: stringify!($field),
                    unit: $crate::__record_unit!($($unit)?),
                    display: $crate::__record_unit!($($display)?),
                    kind: $crate::Kind::$kind,
                    len: $crate::__record_len!($($($len)?)?),
                    start: $start,
                    min: *RANGE.start(),
                    max: *RANGE.end(),
                    doc: concat!($($doc),+),
                }
            } ),* ];
            const LEN: usize = 0 $( + $crate::__record_len!($($($len)?)?) )*;

            // One pass over the fields; element by element would look each one up.
            #[inline]
            fn from_slice(values: &[f64]) -> Self {
                let mut record = Self::default();
                let mut rest = values;
                $( rest = $crate::Slots::read(&mut record.$field, rest); )*
                let _ = rest;
                record
            }

            #[inline]
            fn write_to(&self, values: &mut [f64]) {
                let mut rest = values;
                $( rest = $crate::Slots::write(&self.$field, rest); )*
                let _ = rest;
            }

            #[inline]
            fn fits(&self) -> bool {
                // All at once, without a branch for each; a value that is no number is in no range.
                true $( & $crate::Slots::slots(&self.$field).iter().all(|value| {
                    const RANGE: std::ops::RangeInclusive<f64> = $crate::__record_range!($kind $($range)?);
                    (*value >= *RANGE.start()) & (*value <= *RANGE.end())
                }) )*
            }

            #[allow(unused_assignments)]
            fn get(&self, i: usize) -> Option<f64> {
                let mut at = 0;
                $(
                    let slots = $crate::Slots::slots(&self.$field);
                    if i < at + slots.len() {
                        return Some(slots[i - at]);
                    }
                    at += slots.len();
                )*
                None
            }

            #[allow(unused_assignments)]
            fn set(&mut self, i: usize, value: f64) -> Option<()> {
                let mut at = 0;
                $(
                    let slots = $crate::Slots::slots_mut(&mut self.$field);
                    if i < at + slots.len() {
                        slots[i - at] = value;
                        return Some(());
                    }
                    at += slots.len();
                )*
                None
            }
        }
    };
}

#[doc(hidden)]
#[macro_export]
macro_rules! __record_type {
    ($n:ty) => {
        $n
    };
    ($n:ty ; $len:literal) => {
        [$n; $len]
    };
}

#[doc(hidden)]
#[macro_export]
macro_rules! __record_map {
    ($value:expr, $convert:ident) => {
        $convert($value)
    };
    ($value:expr, $convert:ident ; $len:literal) => {
        $value.map(&mut $convert)
    };
}

#[doc(hidden)]
#[macro_export]
macro_rules! __record_start {
    ($start:expr) => {
        $start
    };
    ($start:expr ; $len:literal) => {
        [$start; $len]
    };
}

#[doc(hidden)]
#[macro_export]
macro_rules! __record_len {
    () => {
        1
    };
    ($len:literal) => {
        $len
    };
}

#[doc(hidden)]
#[macro_export]
macro_rules! __record_unit {
    () => {
        "1"
    };
    ($unit:literal) => {
        $unit
    };
}

#[doc(hidden)]
#[macro_export]
macro_rules! __record_range {
    (Boolean) => {
        0.0..=1.0
    };
    ($kind:ident) => {
        f64::MIN..=f64::MAX
    };
    ($kind:ident $range:expr) => {
        $range
    };
}
