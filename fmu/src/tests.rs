//! Tests through the C interfaces.
