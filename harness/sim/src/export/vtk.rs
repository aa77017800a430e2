//! Pieces of VTK's legacy text format.

/// The longest title that the format allows is 256 characters with its line end.
const TITLE: usize = 200;

pub(super) fn vtk_head(title: &str) -> String {
    let printable = |c: char| if c.is_ascii_graphic() { c } else { ' ' };
    let title: String = title.chars().map(printable).take(TITLE).collect();
    format!("# vtk DataFile Version 3.0\n{title}\nASCII\nDATASET POLYDATA\n")
}

pub(super) fn push_rows(out: &mut String, rows: impl Iterator<Item = [f64; 3]>) {
    rows.for_each(|[x, y, z]| out.push_str(&format!("{x:?} {y:?} {z:?}\n")));
}

pub(super) fn push_vectors(out: &mut String, name: &str, rows: impl Iterator<Item = [f64; 3]>) {
    out.push_str(&format!("VECTORS {name} double\n"));
    push_rows(out, rows);
}

pub(super) fn push_reals(out: &mut String, name: &str, values: impl Iterator<Item = f64>) {
    out.push_str(&format!("SCALARS {name} double 1\nLOOKUP_TABLE default\n"));
    values.for_each(|x| out.push_str(&format!("{x:?}\n")));
}

/// `kind` is the format's name of the type: ids reach beyond signed 32 bits.
pub(super) fn push_whole(
    out: &mut String,
    name: &str,
    kind: &str,
    values: impl Iterator<Item = i64>,
) {
    out.push_str(&format!("SCALARS {name} {kind} 1\nLOOKUP_TABLE default\n"));
    values.for_each(|k| out.push_str(&format!("{k}\n")));
}
