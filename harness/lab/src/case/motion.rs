//! How a grain of a case moves, as its file spells it: a word, or a word with a velocity.

use std::fmt;

use serde::de::{Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// How a grain moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MotionSpec {
    /// By forces and gravity.
    #[default]
    Free,
    /// Not at all; infinitely heavy in a contact.
    Frozen,
    /// At this velocity, without spin.
    Carried([f64; 3]),
    /// By forces alone, without gravity.
    Weightless,
    /// At this velocity along x and y, by forces and gravity along z, and free to spin: a lid's grain.
    Lid([f64; 2]),
}

const WORDS: [&str; 5] = ["free", "frozen", "weightless", "carried", "lid"];

// By hand, because the errors of a derived reader speak of units and variants.
impl<'de> Deserialize<'de> for MotionSpec {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Spelling)
    }
}

struct Spelling;

impl<'de> Visitor<'de> for Spelling {
    type Value = MotionSpec;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "\"free\", \"frozen\", \"weightless\", {\"carried\": [vx, vy, vz]} or {\"lid\": [vx, vy]}",
        )
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<MotionSpec, E> {
        match word {
            "free" => Ok(MotionSpec::Free),
            "frozen" => Ok(MotionSpec::Frozen),
            "weightless" => Ok(MotionSpec::Weightless),
            "carried" | "lid" => Err(E::invalid_value(Unexpected::Str(word), &self)),
            _ => Err(E::unknown_variant(word, &WORDS)),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<MotionSpec, A::Error> {
        let wrong = Err(A::Error::invalid_value(
            Unexpected::Other("this object"),
            &self,
        ));
        let Some(word) = map.next_key::<String>()? else {
            return wrong;
        };
        let motion = match word.as_str() {
            "carried" => MotionSpec::Carried(map.next_value()?),
            "lid" => MotionSpec::Lid(map.next_value()?),
            "free" | "frozen" | "weightless" => return wrong,
            _ => return Err(A::Error::unknown_variant(&word, &WORDS)),
        };
        match map.next_key::<String>()? {
            Some(_) => wrong,
            None => Ok(motion),
        }
    }
}
