//! Which arrays of two steps differ, and how two of one name do: their kind, or the first element, to the bit.

use std::collections::BTreeMap;
use std::fmt;

use super::array::{Array, Element, shape_text};

/// How an array differs between two sides.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Difference {
    /// Only one side has it: the first, or the second.
    Missing {
        /// Whether it is the first that has it.
        first_has: bool,
    },
    /// Its type or shape.
    Kind {
        /// Type and shape of the first side's, as `f64 100x3`.
        first: String,
        /// Of the second side's.
        second: String,
    },
    /// An element, at least.
    Elements(Elements),
}

/// The first element that differs, in the order of the bytes, and how many do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Elements {
    /// What the elements are.
    pub element: Element,
    /// Which element: a number for each axis of the shape, from 0.
    pub index: Vec<usize>,
    /// The bits of the first side's element, as a number.
    pub first: u64,
    /// Of the second side's.
    pub second: u64,
    /// How many elements differ.
    pub differing: usize,
    /// How many there are.
    pub count: usize,
}

/// Type and shape in words.
pub fn kind(element: Element, shape: &[usize]) -> String {
    match shape {
        [] => format!("{}, a single number", element.name()),
        _ => format!("{} {}", element.name(), shape_text(shape)),
    }
}

/// Names of what is not the same on both sides, in the order of the first; then of what only the second has. On each
/// side every name is there once.
pub(super) fn differing<T: PartialEq>(a: &[T], b: &[T], name: fn(&T) -> &str) -> Vec<String> {
    let by_name = |side: &'_ [T]| -> BTreeMap<String, usize> {
        let places = side.iter().enumerate();
        places
            .map(|(k, item)| (name(item).to_string(), k))
            .collect()
    };
    let (in_a, in_b) = (by_name(a), by_name(b));
    let differs = |item: &&T| in_b.get(name(item)).is_none_or(|k| b[*k] != **item);
    let changed = a.iter().filter(differs);
    let added = b.iter().filter(|item| !in_a.contains_key(name(item)));
    let differing = changed.chain(added);
    differing.map(|item| name(item).to_string()).collect()
}

/// How two arrays differ; `None` if they have the same type, shape and bits.
///
/// ```
/// use bitgrain_lab::recording::array::{Array, Element, little_endian};
/// use bitgrain_lab::recording::difference::difference;
///
/// let array = |x: [f64; 4]| Array {
///     name: "x".into(),
///     element: Element::F64,
///     shape: vec![2, 2],
///     bytes: little_endian(&x),
/// };
/// let told = difference(&array([0.0, 1.0, 0.3, 2.0]), &array([0.0, 1.0, 0.1 + 0.2, 2.0])).unwrap();
/// assert_eq!(
///     told.to_string(),
///     "[1, 0]: 0.3 (0x3fd3333333333333) against 0.30000000000000004 (0x3fd3333333333334)\n  \
///      bits: 3 differ, the lowest is bit 0, the highest bit 2; 1 ulp apart\n  \
///      elements: 1 of 4 differ"
/// );
/// ```
pub fn difference(first: &Array, second: &Array) -> Option<Difference> {
    if (first.element, &first.shape) != (second.element, &second.shape) {
        return Some(Difference::Kind {
            first: kind(first.element, &first.shape),
            second: kind(second.element, &second.shape),
        });
    }
    let size = first.element.size();
    let pairs = || first.bytes.chunks(size).zip(second.bytes.chunks(size));
    let at = pairs().position(|(a, b)| a != b)?;
    let (a, b) = pairs().nth(at)?;
    Some(Difference::Elements(Elements {
        element: first.element,
        index: index(at, &first.shape),
        first: word(a),
        second: word(b),
        differing: pairs().filter(|(a, b)| a != b).count(),
        count: pairs().count(),
    }))
}

/// The place of an element among all, as a number for each axis.
fn index(place: usize, shape: &[usize]) -> Vec<usize> {
    let mut left = place;
    let mut index: Vec<usize> = Vec::new();
    for axis in shape.iter().rev() {
        index.push(left % axis);
        left /= axis;
    }
    index.reverse();
    index
}

/// Up to eight bytes, the lowest first, as a number.
fn word(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .rev()
        .fold(0, |word, byte| word << 8 | u64::from(*byte))
}

impl Elements {
    /// An element's bits as a decimal number, as short as reads back to the same bits.
    fn decimal(&self, bits: u64) -> String {
        match self.element {
            Element::F64 => format!("{:?}", f64::from_bits(bits)),
            Element::F32 => format!("{:?}", f32::from_bits(bits as u32)),
            Element::F16 => format!("{:?}", half(bits as u16)),
            Element::Bf16 => format!("{:?}", f32::from_bits((bits as u32) << 16)),
            Element::I64 => format!("{}", bits as i64),
            Element::I32 => format!("{}", bits as i32),
            Element::I16 => format!("{}", bits as i16),
            Element::I8 => format!("{}", bits as i8),
            Element::U64 | Element::U32 | Element::U16 | Element::U8 | Element::Bool => {
                format!("{bits}")
            }
        }
    }

    /// How many numbers of the type lie from one element to the other; `None` for whole numbers and NaN.
    pub fn ulps(&self) -> Option<u64> {
        // Sign, exponent and the rest: infinity is the exponent alone.
        let (width, infinity) = match self.element {
            Element::F64 => (64, 0x7ff0_0000_0000_0000),
            Element::F32 => (32, 0x7f80_0000),
            Element::F16 => (16, 0x7c00),
            Element::Bf16 => (16, 0x7f80),
            _ => return None,
        };
        let sign = 1u64 << (width - 1);
        // Numbers of one sign are in the order of their bits; both zeros are 0.
        let place = |bits: u64| {
            let size = bits & (sign - 1);
            let place = i128::from(size);
            (size <= infinity).then_some(if bits & sign == 0 { place } else { -place })
        };
        let apart = place(self.first)?.abs_diff(place(self.second)?);
        u64::try_from(apart).ok()
    }
}

/// A number of half precision.
fn half(bits: u16) -> f32 {
    let (exponent, rest) = (u32::from(bits >> 10) & 31, f32::from(bits & 0x3ff));
    let power = |exponent: u32| f32::from_bits((exponent + 127 - 25) << 23);
    let size = match exponent {
        0 => rest * power(1),
        31 if rest == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (rest + 1024.0) * power(exponent),
    };
    if bits & 0x8000 == 0 { size } else { -size }
}

impl fmt::Display for Elements {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (a, b) = (self.first, self.second);
        let digits = 2 * self.element.size();
        let (one, other) = (self.decimal(a), self.decimal(b));
        if !self.index.is_empty() {
            let index: Vec<String> = self.index.iter().map(usize::to_string).collect();
            write!(f, "[{}]", index.join(", "))?;
        }
        write!(
            f,
            ": {one} (0x{a:0digits$x}) against {other} (0x{b:0digits$x})"
        )?;
        let bits = a ^ b;
        let (lowest, highest) = (bits.trailing_zeros(), 63 - bits.leading_zeros());
        match bits.count_ones() {
            1 => write!(f, "\n  bits: one differs, bit {lowest}")?,
            many => write!(
                f,
                "\n  bits: {many} differ, the lowest is bit {lowest}, the highest bit {highest}"
            )?,
        }
        match self.ulps() {
            Some(0) => f.write_str("; the two zeros")?,
            Some(ulps) => write!(f, "; {ulps} ulp apart")?,
            None if one == "NaN" && other == "NaN" => f.write_str("; two kinds of NaN")?,
            None => {}
        }
        write!(
            f,
            "\n  elements: {} of {} differ",
            self.differing, self.count
        )
    }
}

impl fmt::Display for Difference {
    /// What follows the array's name.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Difference::Missing { first_has: true } => f.write_str(": only the first has it"),
            Difference::Missing { first_has: false } => f.write_str(": only the second has it"),
            Difference::Kind { first, second } => write!(f, ": {first} against {second}"),
            Difference::Elements(elements) => elements.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(element: Element, first: u64, second: u64) -> Elements {
        Elements {
            element,
            index: vec![],
            first,
            second,
            differing: 1,
            count: 1,
        }
    }

    #[test]
    fn ulps_are_counted_through_zero() {
        let ulps = |a: f64, b: f64| of(Element::F64, a.to_bits(), b.to_bits()).ulps();
        assert_eq!(ulps(1.0, 1.0f64.next_up()), Some(1));
        assert_eq!(ulps(0.0, -0.0), Some(0));
        assert_eq!(ulps(f64::from_bits(3), -f64::from_bits(2)), Some(5));
        assert_eq!(ulps(f64::MAX, f64::INFINITY), Some(1));
        assert_eq!(ulps(f64::NAN, 1.0), None);
        assert_eq!(
            ulps(f64::NEG_INFINITY, f64::INFINITY),
            Some(2 * 0x7ff0_0000_0000_0000)
        );
        assert_eq!(of(Element::F32, 0x3f80_0000, 0x3f80_0007).ulps(), Some(7));
        assert_eq!(of(Element::U64, 1, 2).ulps(), None);
    }

    #[test]
    fn numbers_are_shown_in_their_type() {
        let shown = |element, bits: u64| of(element, bits, 0).decimal(bits);
        assert_eq!(shown(Element::F32, 0x3dcc_cccd), "0.1");
        assert_eq!(
            shown(Element::F64, f64::MAX.to_bits()),
            "1.7976931348623157e308"
        );
        assert_eq!(shown(Element::I8, 255), "-1");
        assert_eq!(shown(Element::U16, 65_535), "65535");
        assert_eq!(shown(Element::Bf16, 0xbf80), "-1.0");
        // 1, the least subnormal number, the largest number, infinity and NaN of half precision (IEEE 754).
        let halves = [0x3c00, 0x0001, 0xfbff, 0x7c00, 0x7e00];
        let told = halves.map(|bits| shown(Element::F16, bits));
        assert_eq!(told, ["1.0", "5.9604645e-8", "-65504.0", "inf", "NaN"]);
    }

    /// Bits count, not values: kinds of NaN and the two zeros differ.
    #[test]
    fn bits_that_compare_equal_differ() {
        let array = |bits: u64| Array {
            name: "x".into(),
            element: Element::F64,
            shape: vec![2, 3],
            bytes: [0, 0, 0, 0, bits, 0]
                .iter()
                .flat_map(|x: &u64| x.to_le_bytes())
                .collect(),
        };
        let told = |a, b| difference(&array(a), &array(b)).map(|d| d.to_string());
        assert_eq!(told(0, 0), None);
        let zeros = told(0, 1 << 63).unwrap();
        assert!(
            zeros.starts_with("[1, 1]: 0.0 (0x0000000000000000) against -0.0 (0x8"),
            "{zeros}"
        );
        assert!(
            zeros.contains("one differs, bit 63; the two zeros"),
            "{zeros}"
        );
        let nans = told(0x7ff8_0000_0000_0000, 0x7ff8_0000_0000_0010).unwrap();
        assert!(nans.contains("bit 4; two kinds of NaN"), "{nans}");
    }
}
