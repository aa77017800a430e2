//! Numbers with standard errors, and combinations of several.

use serde::{Deserialize, Serialize};

use crate::fit::{Datum, Parameter};

/// A number with its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Value {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

impl From<&Parameter> for Value {
    fn from(fitted: &Parameter) -> Self {
        Value::new(fitted.value, fitted.error)
    }
}

impl Value {
    /// Both.
    pub fn new(value: f64, error: f64) -> Self {
        Self { value, error }
    }

    /// The error over the number.
    pub fn relative(&self) -> f64 {
        (self.error / self.value).abs()
    }

    /// Both over a number that is known.
    pub fn divided(self, by: f64) -> Value {
        Value::new(self.value / by, self.error / by.abs())
    }

    /// Both times a number that is known.
    pub fn times(self, by: f64) -> Value {
        Value::new(self.value * by, self.error * by.abs())
    }

    /// As a point to be fitted.
    pub fn at(self, x: f64) -> Datum {
        let (y, error) = (self.value, self.error);
        Datum { x, y, error }
    }

    /// This over another, independent of it.
    pub fn over(self, other: Value) -> Value {
        let value = self.value / other.value;
        // Zero has no relative error.
        let error = match self.value == 0.0 {
            true => self.error / other.value.abs(),
            false => value.abs() * both(self.relative(), other.relative()),
        };
        Value::new(value, error)
    }

    /// This less another, independent of it.
    pub fn less(self, other: Value) -> Value {
        Value::new(self.value - other.value, both(self.error, other.error))
    }

    /// Mean weighted by the errors, from which alone its own follows; `None` of no values.
    pub fn mean(values: impl Iterator<Item = Value>) -> Option<Value> {
        let (mut weights, mut sum) = (0.0, 0.0);
        for v in values {
            weights += v.weight();
            sum += v.weight() * v.value;
        }
        let mean = Value::new(sum / weights, 1.0 / weights.sqrt());
        (weights > 0.0 && mean.value.is_finite()).then_some(mean)
    }

    /// Its weight in a mean.
    pub fn weight(&self) -> f64 {
        1.0 / (self.error * self.error)
    }
}

/// Two independent errors together.
fn both(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of quotients are those of both, in proportion; that of zero over something is its own.
    #[test]
    fn quotients_have_the_errors_of_both() {
        let two = Value::new(-2.0, 0.2);
        assert_eq!(Value::new(0.0, 0.5).over(two), Value::new(-0.0, 0.25));
        let over = Value::new(6.0, 0.3).over(two);
        assert_eq!(over.value, -3.0);
        assert!((over.error - 3.0 * 0.05_f64.hypot(0.1)).abs() < 1e-15);
    }
}
