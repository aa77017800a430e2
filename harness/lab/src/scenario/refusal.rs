//! What is wrong with a scenario: the key, and what was expected of it.

pub(crate) type Check = std::result::Result<(), (String, String)>;

pub(super) fn refuse(key: &str, problem: impl Into<String>) -> Check {
    Err((key.to_string(), problem.into()))
}

pub(super) fn positive(key: &str, value: f64) -> Check {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    refuse(key, format!("is {value}; expected a positive number"))
}

pub(super) fn not_negative(key: &str, value: f64) -> Check {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    refuse(
        key,
        format!("is {value}; expected zero or a positive number"),
    )
}
