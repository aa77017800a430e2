//! The lines of a recording: digests of named arrays by step, each chained to the line before, so that two programs
//! can be compared anywhere and no line can be changed without notice. Nothing in here is of grains: any program
//! that has arrays can record them.
//!
//! A recording is the text [`HEAD`], one line for each array, and the line of [`Chain::end`]. The line of an array is
//! `STEP,NAME,TYPE,SHAPE,DIGEST,LINK`: the digest is the BLAKE3 hash of the array's bytes, little-endian and row by
//! row; the link is the BLAKE3 hash of the text `BEFORE,STEP,NAME,TYPE,SHAPE,DIGEST`, and `BEFORE` the link of the line
//! before, for the first one 64 zeros. Shapes are written as `100x3`; that of a single number is empty.
//!
//! ```
//! use bitgrain_kernel::record::{Chain, Element, HEAD};
//!
//! let mut chain = Chain::new();
//! let mut text = HEAD.to_string();
//! for step in 0..2u64 {
//!     let bytes: Vec<u8> = [0.5f64, step as f64].iter().flat_map(|x| x.to_le_bytes()).collect();
//!     text += chain.add(step, "positions", Element::F64, &[1, 2], &bytes).unwrap().text();
//! }
//! text += chain.end().text();
//! assert_eq!(text.lines().count(), 5);
//! assert!(text.lines().nth(2).unwrap().starts_with("0,positions,f64,1x2,"));
//! ```

use core::fmt;

use crate::blake3::Hasher;
pub use crate::digest::element::Element;

/// How a recording begins.
pub const HEAD: &str = "# bitgrain recording 1\nstep,array,type,shape,digest,link\n";

/// Most bytes of an array's name.
pub const NAME_MAX: usize = 64;

/// Most axes of an array.
pub const AXES_MAX: usize = 8;

/// Most bytes of a line: a step of 20 digits, a name, a type of 4, 8 axes of 20 digits, two hashes.
const LINE: usize = 400;

/// Why an array cannot be recorded. The chain is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refusal {
    /// The name is empty, longer than [`NAME_MAX`], has other characters than ASCII letters, digits and `_ . - /`, or
    /// is `__metadata__`, which files of kept arrays keep for themselves.
    BadName,
    /// The shape has more than [`AXES_MAX`] axes, or more elements than can be counted.
    BadShape,
    /// There are not as many bytes as the shape says.
    BadLength {
        /// Bytes that an array of this shape has.
        expected: usize,
        /// Bytes that there are.
        found: usize,
    },
    /// An element of [`Element::Bool`] is neither 0 nor 1.
    BadBool {
        /// The byte.
        found: u8,
    },
    /// The step is below that of the line before.
    BadStep {
        /// The step of the line before.
        last: u64,
    },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadName => f.write_str(
                "the name of an array has 1 to 64 characters, which are letters (a to z, A to Z), digits, _ . - or /, \
                 and is not __metadata__, which safetensors files keep for themselves",
            ),
            Self::BadShape => f.write_str("the shape has more than 8 axes, or more elements than can be counted"),
            Self::BadLength { expected, found } => {
                write!(f, "has {found} bytes, and by its type and shape {expected}")
            }
            Self::BadBool { found } => {
                write!(f, "an element of bool is {found}, and is 0 or 1")
            }
            Self::BadStep { last } => {
                write!(f, "the step is below {last}, the one before: steps ascend")
            }
        }
    }
}

impl core::error::Error for Refusal {}

/// Bytes of an array of this type and shape; 1 element without axes.
///
/// # Errors
/// [`Refusal::BadShape`].
pub fn length(element: Element, shape: &[usize]) -> Result<usize, Refusal> {
    if shape.len() > AXES_MAX {
        return Err(Refusal::BadShape);
    }
    let mut bytes = element.size();
    for axis in shape {
        bytes = bytes.checked_mul(*axis).ok_or(Refusal::BadShape)?;
    }
    Ok(bytes)
}

/// Checks that an array of this type and shape can have these bytes.
///
/// # Errors
/// [`Refusal::BadShape`]; [`Refusal::BadLength`]; [`Refusal::BadBool`].
pub fn check(element: Element, shape: &[usize], bytes: &[u8]) -> Result<(), Refusal> {
    let expected = length(element, shape)?;
    let found = bytes.len();
    if found != expected {
        return Err(Refusal::BadLength { expected, found });
    }
    match bytes.iter().find(|byte| **byte > 1) {
        Some(&found) if element == Element::Bool => Err(Refusal::BadBool { found }),
        _ => Ok(()),
    }
}

/// A line of a recording.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    bytes: [u8; LINE],
    length: usize,
}

impl Line {
    /// The line with its line feed; at most 400 bytes, all ASCII.
    pub fn text(&self) -> &str {
        let bytes = self.bytes.get(..self.length).unwrap_or_default();
        core::str::from_utf8(bytes).unwrap_or_default()
    }

    const EMPTY: Self = Self {
        bytes: [0; LINE],
        length: 0,
    };

    fn put(&mut self, text: &[u8]) {
        for byte in text {
            if let Some(slot) = self.bytes.get_mut(self.length) {
                *slot = *byte;
                self.length += 1;
            }
        }
    }

    fn put_number(&mut self, number: u64) {
        let mut digits = [b'0'; 20];
        let mut left = number;
        let mut used = 0;
        for slot in digits.iter_mut().rev() {
            if left == 0 && used > 0 {
                break;
            }
            *slot = b'0' + (left % 10) as u8;
            left /= 10;
            used += 1;
        }
        let begin = digits.len().saturating_sub(used);
        self.put(digits.get(begin..).unwrap_or_default());
    }

    fn put_hash(&mut self, hash: &[u8; 32]) {
        for byte in hash {
            self.put(&[hexadecimal(byte >> 4), hexadecimal(byte & 15)]);
        }
    }
}

const fn hexadecimal(digit: u8) -> u8 {
    if digit < 10 {
        b'0' + digit
    } else {
        b'a' + digit - 10
    }
}

/// The links of a recording as it grows: 48 bytes, whatever is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chain {
    link: [u8; 32],
    step: u64,
}

impl Default for Chain {
    fn default() -> Self {
        Self::new()
    }
}

impl Chain {
    /// The chain of an empty recording.
    pub const fn new() -> Self {
        Self {
            link: [0; 32],
            step: 0,
        }
    }

    /// The chain that has come to this step and link: for a host that keeps them in a form of its own.
    pub const fn at(step: u64, link: [u8; 32]) -> Self {
        Self { link, step }
    }

    /// The step of the line before; 0 before the first.
    pub const fn step(&self) -> u64 {
        self.step
    }

    /// The last link; zeros before the first.
    pub const fn link(&self) -> &[u8; 32] {
        &self.link
    }

    /// The line of an array at a step. `bytes` are those of its elements, little-endian, row by row. Steps do not
    /// descend; the arrays of one step come one after the other, and each has a name of its own (a reader checks that).
    ///
    /// # Errors
    /// [`Refusal`].
    pub fn add(
        &mut self,
        step: u64,
        name: &str,
        element: Element,
        shape: &[usize],
        bytes: &[u8],
    ) -> Result<Line, Refusal> {
        check(element, shape, bytes)?;
        let digest = Hasher::new().finish_with(bytes);
        self.add_digest(step, name, element, shape, &digest)
    }

    /// The same with the digest of the array's bytes, for a host that has a faster hash or has the array in pieces.
    ///
    /// # Errors
    /// [`Refusal`].
    pub fn add_digest(
        &mut self,
        step: u64,
        name: &str,
        element: Element,
        shape: &[usize],
        digest: &[u8; 32],
    ) -> Result<Line, Refusal> {
        if step < self.step {
            return Err(Refusal::BadStep { last: self.step });
        }
        let allowed = |byte: u8| byte.is_ascii_alphanumeric() || b"_.-/".contains(&byte);
        let safe = name.bytes().all(allowed) && name != "__metadata__";
        if name.is_empty() || name.len() > NAME_MAX || !safe {
            return Err(Refusal::BadName);
        }
        length(element, shape)?;
        let mut row = Line::EMPTY;
        row.put_number(step);
        row.put(b",");
        row.put(name.as_bytes());
        row.put(b",");
        row.put(element.name().as_bytes());
        row.put(b",");
        for (k, axis) in shape.iter().enumerate() {
            if k > 0 {
                row.put(b"x");
            }
            row.put_number(*axis as u64);
        }
        row.put(b",");
        row.put_hash(digest);

        let mut line = Line::EMPTY;
        line.put_hash(&self.link);
        line.put(b",");
        line.put(row.text().as_bytes());
        self.link = Hasher::new().finish_with(line.text().as_bytes());
        self.step = step;

        row.put(b",");
        row.put_hash(&self.link);
        row.put(b"\n");
        Ok(row)
    }

    /// The last line of a recording: `# end LINK`, with the last link. Without it a recording is not whole.
    pub fn end(&self) -> Line {
        let mut line = Line::EMPTY;
        line.put(b"# end ");
        line.put_hash(&self.link);
        line.put(b"\n");
        line
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::format;
    use std::string::String;

    type Entry<'a> = (u64, &'a str, Element, &'a [usize], &'a [u8]);

    /// Written out with the published crate, as the guide says it is done.
    #[test]
    fn lines_are_as_the_guide_says() {
        let mut chain = Chain::new();
        let mut link = "0".repeat(64);
        let arrays: [Entry<'_>; 4] = [
            (0, "x", Element::F64, &[], &[1, 2, 3, 4, 5, 6, 7, 8]),
            (0, "a/b_c.d-9", Element::U8, &[7], b"seven b"),
            (10, "none", Element::F32, &[0, 3], b""),
            (u64::MAX, "m", Element::I16, &[1, 2, 1], &[255, 0, 0, 1]),
        ];
        for (step, name, element, shape, bytes) in arrays {
            let shape_text: std::vec::Vec<String> = shape.iter().map(|n| format!("{n}")).collect();
            let digest = ::blake3::hash(bytes).to_hex();
            let row = format!(
                "{step},{name},{},{},{digest}",
                element.name(),
                shape_text.join("x")
            );
            link = ::blake3::hash(format!("{link},{row}").as_bytes())
                .to_hex()
                .as_str()
                .into();
            let line = chain.add(step, name, element, shape, bytes).unwrap();
            assert_eq!(line.text(), format!("{row},{link}\n"));
        }
        assert_eq!(chain.end().text(), format!("# end {link}\n"));
    }

    /// The longest line that there can be is whole.
    #[test]
    fn the_longest_line_fits() {
        let name = "n".repeat(NAME_MAX);
        let shape = [
            usize::MAX,
            1,
            0,
            usize::MAX,
            usize::MAX,
            usize::MAX,
            usize::MAX,
            usize::MAX,
        ];
        let mut chain = Chain::new();
        // More elements than can be counted, until there are none.
        assert!(
            chain
                .add_digest(0, &name, Element::Bf16, &shape, &[0; 32])
                .is_err()
        );
        let shape = [
            0,
            usize::MAX,
            usize::MAX,
            usize::MAX,
            usize::MAX,
            usize::MAX,
            usize::MAX,
            usize::MAX,
        ];
        let line = chain
            .add_digest(u64::MAX, &name, Element::Bf16, &shape, &[9; 32])
            .unwrap();
        assert!(line.text().len() < LINE - 2 && line.text().ends_with('\n'));
    }

    #[test]
    fn what_cannot_be_recorded_changes_nothing() {
        let mut chain = Chain::new();
        chain.add(5, "x", Element::U8, &[1], &[0]).unwrap();
        let before = chain;
        let long = "n".repeat(NAME_MAX + 1);
        for name in ["", "a b", "a,b", "a\n", "\u{e9}", "\"", &long] {
            assert_eq!(
                chain.add(5, name, Element::U8, &[1], &[0]).unwrap_err(),
                Refusal::BadName
            );
        }
        let short = chain
            .add(5, "y", Element::F64, &[2, 2], &[0; 31])
            .unwrap_err();
        let expected = Refusal::BadLength {
            expected: 32,
            found: 31,
        };
        assert_eq!(short, expected);
        let seven = chain
            .add(5, "y", Element::Bool, &[3], &[0, 1, 7])
            .unwrap_err();
        assert_eq!(seven, Refusal::BadBool { found: 7 });
        let many = chain
            .add(5, "y", Element::F64, &[usize::MAX, 2], &[])
            .unwrap_err();
        assert_eq!(many, Refusal::BadShape);
        assert_eq!(
            chain.add(5, "y", Element::U8, &[1; 9], &[0]).unwrap_err(),
            Refusal::BadShape
        );
        assert_eq!(
            chain.add(4, "y", Element::U8, &[1], &[0]).unwrap_err(),
            Refusal::BadStep { last: 5 }
        );
        assert_eq!(chain, before);
    }
}
