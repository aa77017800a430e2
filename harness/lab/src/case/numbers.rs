//! Checks of the numbers of a case.

/// Nothing, or the key that is wrong and what is wrong with it.
pub(super) type Check = Result<(), (String, String)>;

pub(super) fn positive(key: &str, value: f64) -> Check {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err((
        key.into(),
        format!("is {value}; expected a positive number"),
    ))
}

pub(super) fn finite(key: &str, v: &[f64; 3]) -> Check {
    if v.iter().all(|x| x.is_finite()) {
        return Ok(());
    }
    Err((key.into(), "has a component that is not finite".into()))
}

pub(super) fn direction(key: &str, v: &[f64; 3]) -> Check {
    finite(key, v)?;
    let squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if squared.is_normal() {
        return Ok(());
    }
    Err((
        key.into(),
        "has no length; expected a direction such as [0, 0, 1]".into(),
    ))
}
