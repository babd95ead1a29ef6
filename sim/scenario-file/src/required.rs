//! Values that an operation or its pass has to give.

use toolroom_form::{Fault, Section, Walk};

/// A value of the pass, or else of its operation; NaN only where a problem is noted.
pub(super) fn due(
    walk: &mut Walk,
    pass: &Section<'_>,
    operation: &Section<'_>,
    key: &'static str,
    example: &str,
) -> f64 {
    if pass.got(key).or_else(|| operation.got(key)).is_none() {
        let fault =
            Fault::MissingKey { section: operation.form.title.to_owned(), key, example: format!("\"{example}\"") };
        walk.fault(pass.span.clone(), fault);
    }
    pass.si(key).or_else(|| operation.si(key)).unwrap_or(f64::NAN)
}
