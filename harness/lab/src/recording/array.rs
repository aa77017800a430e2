//! An array as it is recorded: what its elements are, its shape, and its bytes.

pub use bitgrain_kernel::record::Element;
use bitgrain_kernel::record::{AXES_MAX, Refusal, length};
use safetensors::tensor::Dtype;

/// An array that is lent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArrayRef<'a> {
    /// What the elements are.
    pub element: Element,
    /// Lengths of the axes; empty for a single number.
    pub shape: &'a [usize],
    /// The elements, little-endian, row by row (the last index runs fastest).
    pub bytes: &'a [u8],
}

/// An array with its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Array {
    /// 1 to 64 letters, digits, `_ . - /`.
    pub name: String,
    /// What the elements are.
    pub element: Element,
    /// Lengths of the axes; empty for a single number.
    pub shape: Vec<usize>,
    /// The elements, little-endian, row by row.
    pub bytes: Vec<u8>,
}

impl Array {
    /// The array, lent.
    pub fn lent(&self) -> ArrayRef<'_> {
        ArrayRef {
            element: self.element,
            shape: &self.shape,
            bytes: &self.bytes,
        }
    }
}

/// The bytes of numbers in double precision, as a recording takes them.
///
/// ```
/// assert_eq!(bitgrain_lab::recording::array::little_endian(&[1.0])[6..], [0xf0, 0x3f]);
/// ```
pub fn little_endian(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A shape as a recording writes it: `100x3`; empty for a single number.
pub fn shape_text(shape: &[usize]) -> String {
    let axes: Vec<String> = shape.iter().map(usize::to_string).collect();
    axes.join("x")
}

/// A shape from its text, and how many bytes an array of this kind has.
///
/// # Errors
/// What is wrong, in words.
pub fn read_shape(element: Element, text: &str) -> Result<(Vec<usize>, usize), String> {
    let wrong = || {
        format!(
            "`{text}` is no shape: at most {AXES_MAX} whole numbers with x between them, as 100x3, or nothing"
        )
    };
    let axes = text.split('x').take(AXES_MAX + 1);
    let axes = axes.filter(|_| !text.is_empty()).map(|axis| {
        let digits = axis.bytes().all(|b| b.is_ascii_digit());
        let number = axis.parse().ok().filter(|_| digits);
        number.ok_or_else(wrong)
    });
    let shape: Vec<usize> = axes.collect::<Result<_, _>>()?;
    let bytes = length(element, &shape).map_err(|refusal: Refusal| refusal.to_string())?;
    Ok((shape, bytes))
}

/// An element type from its name.
///
/// # Errors
/// What there is, in words.
pub fn read_element(text: &str) -> Result<Element, String> {
    let names = || Element::ALL.map(Element::name).join(", ");
    Element::of(text)
        .ok_or_else(|| format!("`{text}` is no type of elements: there are {}", names()))
}

/// What safetensors calls an element.
pub(super) fn dtype(element: Element) -> Dtype {
    match element {
        Element::F64 => Dtype::F64,
        Element::F32 => Dtype::F32,
        Element::F16 => Dtype::F16,
        Element::Bf16 => Dtype::BF16,
        Element::I64 => Dtype::I64,
        Element::I32 => Dtype::I32,
        Element::I16 => Dtype::I16,
        Element::I8 => Dtype::I8,
        Element::U64 => Dtype::U64,
        Element::U32 => Dtype::U32,
        Element::U16 => Dtype::U16,
        Element::U8 => Dtype::U8,
        Element::Bool => Dtype::BOOL,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_read_back() {
        for shape in [
            vec![],
            vec![0],
            vec![7],
            vec![100, 3],
            vec![1, 2, 3, 4, 5, 6, 7, 8],
        ] {
            let text = shape_text(&shape);
            let bytes = 8 * shape.iter().product::<usize>();
            assert_eq!(read_shape(Element::F64, &text), Ok((shape, bytes)));
        }
        for wrong in [
            "x",
            "3x",
            "-1",
            "+1",
            "a",
            "1 x 2",
            "1,2",
            "1x1x1x1x1x1x1x1x1",
            "99999999999999999999",
        ] {
            assert!(
                read_shape(Element::F64, wrong)
                    .unwrap_err()
                    .contains("shape"),
                "{wrong}"
            );
        }
        let many = format!("{}x2", usize::MAX);
        assert!(
            read_shape(Element::U8, &many)
                .unwrap_err()
                .contains("counted")
        );
    }
}
