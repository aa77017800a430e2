//! The same table as a Parquet file: what pandas, polars and R read with the types of its columns.

use std::io;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{Type, TypePtr};

use super::columns::{Cell, Column, Row, columns};

/// The table as the bytes of a Parquet file, packed with Snappy: the same bytes every time.
///
/// # Errors
/// The error of the encoder.
pub fn bytes(rows: &[Row<'_>]) -> io::Result<Vec<u8>> {
    let columns = columns(rows);
    let cells: Vec<Vec<Cell>> = columns
        .iter()
        .map(|column| rows.iter().map(|row| column.of(row)).collect())
        .collect();
    write(&columns, &cells).map_err(io::Error::other)
}

/// The type of a column, from its cells: all are alike.
fn kind(name: &str, cells: &[Cell]) -> parquet::errors::Result<TypePtr> {
    let (physical, logical) = match cells.first() {
        Some(Cell::Whole(_)) => (Physical::INT64, None),
        Some(Cell::Real(_)) => (Physical::DOUBLE, None),
        _ => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
    };
    let field = Type::primitive_type_builder(name, physical)
        .with_repetition(Repetition::OPTIONAL)
        .with_logical_type(logical);
    Ok(Arc::new(field.build()?))
}

fn write(columns: &[Column], cells: &[Vec<Cell>]) -> parquet::errors::Result<Vec<u8>> {
    let fields = columns
        .iter()
        .zip(cells)
        .map(|(column, cells)| kind(&column.name, cells));
    let fields: Vec<TypePtr> = fields.collect::<parquet::errors::Result<_>>()?;
    let schema = Type::group_type_builder("campaign")
        .with_fields(fields)
        .build()?;
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by("bitgrain".into())
        .build();
    let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for cells in cells {
        let Some(mut column) = group.next_column()? else {
            break;
        };
        // 1 for a value, 0 for none.
        let (mut there, mut texts, mut wholes, mut reals) = (vec![], vec![], vec![], vec![]);
        for cell in cells {
            there.push(match cell {
                Cell::Text(x) => note(x.as_ref().map(|x| ByteArray::from(&x[..])), &mut texts),
                Cell::Whole(x) => note(*x, &mut wholes),
                Cell::Real(x) => note(*x, &mut reals),
            });
        }
        match cells.first() {
            Some(Cell::Whole(_)) => {
                column
                    .typed::<Int64Type>()
                    .write_batch(&wholes, Some(&there), None)?
            }
            Some(Cell::Real(_)) => {
                column
                    .typed::<DoubleType>()
                    .write_batch(&reals, Some(&there), None)?
            }
            _ => column
                .typed::<ByteArrayType>()
                .write_batch(&texts, Some(&there), None)?,
        };
        column.close()?;
    }
    group.close()?;
    writer.into_inner()
}

/// Keeps a value if there is one, and returns whether there was.
fn note<T>(value: Option<T>, values: &mut Vec<T>) -> i16 {
    let there = value.is_some();
    values.extend(value);
    i16::from(there)
}
