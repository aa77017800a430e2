//! Tables in CSV files: a comment that begins with `#`, a line of column names, a line for each row. One list of
//! columns writes a table and reads it again.

use crate::files::{bits, finite};

/// What a row holds in one column. Numbers are printed as the shortest decimals that read back to the same
/// bits; one that is not finite is not read.
pub enum Cell<'a> {
    /// A count.
    Whole(&'a mut u64),
    /// A small count.
    Count(&'a mut u32),
    /// A number.
    Real(&'a mut f64),
    /// A number, or nothing.
    Optional(&'a mut Option<f64>),
    /// A number in single precision, or nothing.
    Single(&'a mut Option<f64>),
    /// A number with three decimals.
    Thousandths(&'a mut f64),
    /// One of a few words.
    Word(&'a mut dyn Word),
}

/// One of a few words, as written in tables.
pub trait Word {
    /// The word.
    fn word(&self) -> &'static str;
    /// Becomes what the word stands for; `None` if it stands for nothing.
    fn take(&mut self, word: &str) -> Option<()>;
}

impl Cell<'_> {
    fn text(&self) -> String {
        match self {
            Self::Whole(n) => n.to_string(),
            Self::Count(n) => n.to_string(),
            Self::Real(x) => x.to_string(),
            Self::Optional(x) => x.map_or(String::new(), |x| x.to_string()),
            Self::Single(x) => x.map_or(String::new(), |x| (x as f32).to_string()),
            Self::Thousandths(x) => format!("{x:.3}"),
            Self::Word(word) => word.word().into(),
        }
    }

    fn take(self, text: &str) -> Option<()> {
        match self {
            Self::Whole(n) => *n = text.parse().ok()?,
            Self::Count(n) => *n = text.parse().ok()?,
            Self::Real(x) | Self::Thousandths(x) => *x = finite(text)?,
            Self::Optional(x) | Self::Single(x) if text.is_empty() => *x = None,
            Self::Optional(x) | Self::Single(x) => *x = Some(finite(text)?),
            Self::Word(word) => word.take(text)?,
        }
        Some(())
    }
}

/// A column: its name, and where a row holds its cell.
pub struct Column<R> {
    name: &'static str,
    cell: for<'a> fn(&'a mut R) -> Cell<'a>,
    optional: bool,
}

/// A column that every file has.
pub const fn column<R>(name: &'static str, cell: for<'a> fn(&'a mut R) -> Cell<'a>) -> Column<R> {
    let optional = false;
    Column {
        name,
        cell,
        optional,
    }
}

/// A column that a file may leave out.
pub const fn optional<R>(name: &'static str, cell: for<'a> fn(&'a mut R) -> Cell<'a>) -> Column<R> {
    let optional = true;
    Column {
        name,
        cell,
        optional,
    }
}

/// The columns of a table, in the order of the file.
pub struct Table<R: 'static>(pub &'static [Column<R>]);

impl<R: Clone + Default> Table<R> {
    /// Names of the columns, as the file has them.
    pub fn head(&self) -> String {
        let names: Vec<&str> = self.0.iter().map(|column| column.name).collect();
        names.join(",")
    }

    /// The line of a row, with its end.
    pub fn line(&self, row: &R) -> String {
        lines(self.0.iter(), std::slice::from_ref(row))
    }

    /// The text of a file: what `comment` says of it, the arithmetic, names, rows.
    pub fn text(&self, comment: &str, rows: &[R]) -> String {
        self.text_without(&[], comment, rows)
    }

    /// The same without the columns of these names.
    pub fn text_without(&self, left_out: &[&str], comment: &str, rows: &[R]) -> String {
        let kept = self.0.iter().filter(|c| !left_out.contains(&c.name));
        let names: Vec<&str> = kept.clone().map(|column| column.name).collect();
        let of = if comment.is_empty() { "" } else { "; " };
        format!(
            "# {comment}{of}{}\n{}\n{}",
            bits(),
            names.join(","),
            lines(kept, rows)
        )
    }

    /// The rows of a file; a column that is left out has the value of a default row.
    ///
    /// # Errors
    /// The line, counted from 1, that is not a row of these columns, or does not name them.
    pub fn parse(&self, text: &str) -> Result<Vec<R>, usize> {
        let rows = self.numbered(text)?;
        Ok(rows.into_iter().map(|(_, row)| row).collect())
    }

    /// The rows of a file, each with its line; as [`Table::parse`].
    pub(crate) fn numbered(&self, text: &str) -> Result<Vec<(usize, R)>, usize> {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .has_headers(false)
            .flexible(true)
            .from_reader(text.as_bytes());
        let line = |at: Option<&csv::Position>| at.map_or(1, |at| at.line() as usize);
        let mut records = reader
            .records()
            .map(|record| record.map_err(|e| line(e.position())));
        let head = records.next().ok_or(1_usize)??;
        let columns = self.named(&head).ok_or_else(|| line(head.position()))?;
        let row = |record: csv::StringRecord| {
            let mut row = R::default();
            let fits = record.len() == columns.len();
            let mut cells = columns.iter().zip(&record);
            let whole = fits && cells.all(|(c, text)| (c.cell)(&mut row).take(text).is_some());
            let line = line(record.position());
            whole.then_some((line, row)).ok_or(line)
        };
        records.map(|record| record.and_then(row)).collect()
    }

    /// The columns that a line names: all in their order, but for those that may be left out.
    fn named(&self, head: &csv::StringRecord) -> Option<Vec<&Column<R>>> {
        let mut names = head.iter().peekable();
        let mut found = Vec::new();
        for column in self.0 {
            match names.next_if_eq(&column.name) {
                Some(_) => found.push(column),
                None if column.optional => {}
                None => return None,
            }
        }
        names.next().is_none().then_some(found)
    }
}

fn lines<'a, R: Clone + 'a>(
    columns: impl Iterator<Item = &'a Column<R>> + Clone,
    rows: &[R],
) -> String {
    let mut out = String::new();
    for row in rows {
        let mut row = row.clone();
        for (k, column) in columns.clone().enumerate() {
            let comma = if k == 0 { "" } else { "," };
            out += comma;
            out += &(column.cell)(&mut row).text();
        }
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    struct Row {
        step: u64,
        force: f64,
        angle: Option<f64>,
        single: Option<f64>,
    }

    const TABLE: Table<Row> = Table(&[
        column("step", |r| Cell::Whole(&mut r.step)),
        column("force", |r| Cell::Real(&mut r.force)),
        optional("angle", |r| Cell::Optional(&mut r.angle)),
        optional("single", |r| Cell::Single(&mut r.single)),
    ]);

    #[test]
    fn numbers_are_the_shortest_that_read_back() {
        let row = Row {
            step: 7,
            force: -0.0,
            angle: None,
            single: Some(0.1),
        };
        let other = Row {
            force: 1.0,
            angle: Some(0.1 + 0.2),
            ..row
        };
        let text = TABLE.text("force N", &[row, other]);
        let (head, rows) = text.split_once('\n').unwrap();
        assert_eq!(head, format!("# force N; {}", bits()));
        assert_eq!(
            rows,
            "step,force,angle,single\n7,-0,,0.1\n7,1,0.30000000000000004,0.1\n"
        );
        let again = TABLE.parse(&text).unwrap();
        assert_eq!(again, [row, other]);
        assert!(again[0].force.is_sign_negative());
        assert_eq!(
            TABLE.text_without(&["angle", "single"], "", &[row]),
            format!("# {}\nstep,force\n7,-0\n", bits())
        );
    }

    #[test]
    fn a_line_that_is_no_row_is_named() {
        let found = |text: &str| TABLE.parse(text).map(|rows| rows.len());
        assert_eq!(found("# a\nstep,force\n1,2\n3,4\n"), Ok(2));
        assert_eq!(found("step,force,single\r\n1,2,\r\n"), Ok(1));
        for (wrong, line) in [
            ("", 1),
            ("1,2\n", 1),
            ("step,single\n", 1),
            ("step,force,depth\n", 1),
            ("force,step\n", 1),
            ("step,force\n1,2\n3\n", 3),
            ("step,force\n1,2\n3,4,5\n", 3),
            ("step,force\n1,2\n3,nan\n", 3),
            ("step,force\n1,2\n3,\n", 3),
            ("step,force\n-1,2\n", 2),
            ("step,force\n1.5,2\n", 2),
        ] {
            assert_eq!(found(wrong), Err(line), "{wrong}");
        }
    }
}
