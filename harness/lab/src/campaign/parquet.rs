//! The same table as a Parquet file: what pandas, polars and R read with the types of its columns.
//!
//! A table of a campaign needs the plainest file that the format allows: one group of rows, one page a column, values
//! as they lie in memory, nothing packed. The crate `parquet` writes much more, and would be a tenth of the time that
//! the whole program takes to build.

use super::columns::{Cell, Row, columns};

/// The table as the bytes of a Parquet file: the same bytes every time.
pub fn bytes(rows: &[Row<'_>]) -> Vec<u8> {
    let columns = columns(rows);
    let cells = columns
        .iter()
        .map(|column| rows.iter().map(|row| column.of(row)).collect());
    let cells: Vec<Vec<Cell>> = cells.collect();
    let names: Vec<&str> = columns.iter().map(|column| &column.name[..]).collect();
    file(&names, &cells, rows.len())
}

const MAGIC: &[u8] = b"PAR1";

/// The numbers of the format's types, encodings and repetitions.
const INT64: i64 = 2;
const DOUBLE: i64 = 5;
const BYTE_ARRAY: i64 = 6;
const PLAIN: i64 = 0;
const RLE: i64 = 3;
const OPTIONAL: i64 = 1;

/// The type of a column, from its cells: all are alike.
fn kind(cells: &[Cell]) -> i64 {
    match cells.first() {
        Some(Cell::Whole(_)) => INT64,
        Some(Cell::Real(_)) => DOUBLE,
        _ => BYTE_ARRAY,
    }
}

/// A file: the pages of the columns, then what is known of them, then how long that is.
fn file(names: &[&str], cells: &[Vec<Cell>], rows: usize) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    let (mut schema, mut chunks) = (vec![root(names.len())], Vec::new());
    for (name, cells) in names.iter().zip(cells) {
        let begin = bytes.len();
        let page = page(cells);
        bytes.extend(page_header(page.len(), rows).done());
        bytes.extend(page);
        schema.push(element(name, kind(cells)));
        chunks.push(chunk(name, kind(cells), begin..bytes.len(), rows));
    }
    let size = bytes.len() - MAGIC.len();
    let mut group = Struct::default();
    group.list(1, STRUCT, chunks);
    group.number(2, I64, size as i64);
    group.number(3, I64, rows as i64);
    let mut known = Struct::default();
    known.number(1, I32, 1);
    known.list(2, STRUCT, schema);
    known.number(3, I64, rows as i64);
    known.list(4, STRUCT, vec![group.done()]);
    known.text(6, "bitgrain");
    let known = known.done();
    bytes.extend(&known);
    bytes.extend((known.len() as u32).to_le_bytes());
    bytes.extend(MAGIC);
    bytes
}

/// A column's cells: which of them have a value, a bit each, and those values.
fn page(cells: &[Cell]) -> Vec<u8> {
    let mut there = vec![0u8; cells.len().div_ceil(8)];
    let mut values = Vec::new();
    for (k, cell) in cells.iter().enumerate() {
        let is_there = match cell {
            Cell::Whole(value) => value.map(|x| values.extend(x.to_le_bytes())),
            Cell::Real(value) => value.map(|x| values.extend(x.to_le_bytes())),
            Cell::Text(value) => value.as_ref().map(|text| {
                values.extend((text.len() as u32).to_le_bytes());
                values.extend(text.as_bytes());
            }),
        };
        there[k / 8] |= u8::from(is_there.is_some()) << (k % 8);
    }
    // One run of packed bits: eight to a byte, which is what its head counts.
    let mut levels = Vec::new();
    varint(&mut levels, (there.len() as u64) << 1 | 1);
    levels.extend(there);
    let mut page = (levels.len() as u32).to_le_bytes().to_vec();
    page.extend(levels);
    page.extend(values);
    page
}

fn page_header(size: usize, rows: usize) -> Struct {
    let mut data = Struct::default();
    data.number(1, I32, rows as i64);
    data.number(2, I32, PLAIN);
    data.number(3, I32, RLE);
    data.number(4, I32, RLE);
    let mut header = Struct::default();
    header.number(1, I32, 0);
    header.number(2, I32, size as i64);
    header.number(3, I32, size as i64);
    header.nested(5, data);
    header
}

/// The head of the schema.
fn root(columns: usize) -> Vec<u8> {
    let mut element = Struct::default();
    element.text(4, "campaign");
    element.number(5, I32, columns as i64);
    element.done()
}

/// A column of the schema.
fn element(name: &str, kind: i64) -> Vec<u8> {
    let mut element = Struct::default();
    element.number(1, I32, kind);
    element.number(3, I32, OPTIONAL);
    element.text(4, name);
    if kind == BYTE_ARRAY {
        // Text in UTF-8, as older readers are told and as newer ones.
        element.number(6, I32, 0);
        let mut logical = Struct::default();
        logical.nested(1, Struct::default());
        element.nested(10, logical);
    }
    element.done()
}

/// Where a column lies.
fn chunk(name: &str, kind: i64, place: std::ops::Range<usize>, rows: usize) -> Vec<u8> {
    let size = place.len() as i64;
    let number = |x: i64| {
        let mut bytes = Vec::new();
        varint(&mut bytes, zigzag(x));
        bytes
    };
    let mut known = Struct::default();
    known.number(1, I32, kind);
    known.list(2, I32, vec![number(PLAIN), number(RLE)]);
    known.list(3, BINARY, vec![binary(name)]);
    known.number(4, I32, 0);
    known.number(5, I64, rows as i64);
    known.number(6, I64, size);
    known.number(7, I64, size);
    known.number(9, I64, place.start as i64);
    let mut chunk = Struct::default();
    chunk.number(2, I64, place.start as i64);
    chunk.nested(3, known);
    chunk.done()
}

/// Types of fields in Thrift's compact protocol, in which the format describes itself.
const I32: u8 = 5;
const I64: u8 = 6;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;

/// A struct of Thrift's compact protocol; its fields ascend.
#[derive(Default)]
struct Struct {
    bytes: Vec<u8>,
    last: u8,
}

impl Struct {
    fn field(&mut self, id: u8, kind: u8) {
        self.bytes.push((id - self.last) << 4 | kind);
        self.last = id;
    }

    fn number(&mut self, id: u8, kind: u8, value: i64) {
        self.field(id, kind);
        varint(&mut self.bytes, zigzag(value));
    }

    fn text(&mut self, id: u8, text: &str) {
        self.field(id, BINARY);
        self.bytes.extend(binary(text));
    }

    fn nested(&mut self, id: u8, inner: Struct) {
        self.field(id, STRUCT);
        self.bytes.extend(inner.done());
    }

    fn list(&mut self, id: u8, kind: u8, items: Vec<Vec<u8>>) {
        self.field(id, LIST);
        match u8::try_from(items.len()) {
            Ok(few @ 0..15) => self.bytes.push(few << 4 | kind),
            _ => {
                self.bytes.push(0xf0 | kind);
                varint(&mut self.bytes, items.len() as u64);
            }
        }
        self.bytes.extend(items.concat());
    }

    fn done(mut self) -> Vec<u8> {
        self.bytes.push(0);
        self.bytes
    }
}

fn binary(text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    varint(&mut bytes, text.len() as u64);
    bytes.extend(text.as_bytes());
    bytes
}

fn zigzag(value: i64) -> u64 {
    (value << 1 ^ value >> 63) as u64
}

fn varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value > 0x7f {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cells of each type, some without a value, in more rows than one byte has bits. That others read them as they
    /// were written is a test of the Python package, which has readers.
    #[test]
    fn a_file_is_its_golden() {
        let rows = 11;
        let text = |k: usize| (k % 3 != 1).then(|| "\u{b5}".repeat(k));
        let real = |k: usize| (k != 4).then(|| [0.1, -0.0, 5e-324, f64::MAX][k % 4]);
        let whole = |k: usize| (k > 0).then_some(k as i64 - 3);
        let cells = [
            (0..rows).map(|k| Cell::Text(text(k))).collect(),
            (0..rows).map(|k| Cell::Real(real(k))).collect(),
            (0..rows).map(|k| Cell::Whole(whole(k))).collect(),
            (0..rows).map(|_| Cell::Real(None)).collect(),
        ];
        let made = file(&["text", "real", "whole", "none"], &cells, rows);
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/data/cells.parquet");
        if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
            std::fs::write(path, &made).unwrap();
        }
        assert!(std::fs::read(path).unwrap() == made);
    }
}
