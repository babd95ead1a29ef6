//! What the table of handles is locked with. `fmu/loom` puts loom's types in the place of these.

pub(super) use std::sync::Mutex;
pub(super) use std::sync::atomic::AtomicU64;

/// [`std::cell::UnsafeCell`] as loom offers it.
pub(super) struct UnsafeCell<T>(std::cell::UnsafeCell<T>);

impl<T> UnsafeCell<T> {
    pub const fn new(value: T) -> Self {
        Self(std::cell::UnsafeCell::new(value))
    }

    /// Hands the address on; nobody else may use what it points to meanwhile.
    #[inline]
    pub fn with_mut<R>(&self, action: impl FnOnce(*mut T) -> R) -> R {
        action(self.0.get())
    }
}
