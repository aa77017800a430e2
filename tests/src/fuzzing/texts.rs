//! Input that comes as text: cases, scenarios, tables of a run's folder, data files and dumps of LAMMPS.

use std::path::Path;

use bitgrain::case;
use bitgrain::chain::Chain;
use bitgrain::coarse_graining::grid::Grid;
use bitgrain::coarse_graining::read::plane;
use bitgrain::energy_budget::{ENERGY, energy_text};
use bitgrain::flow::{FLOW, PROFILE, flow_text};
use bitgrain::lammps::{Atom, DataFile, data_text, dump_text, parse_atoms, parse_data, parse_dump};
use bitgrain::scenario;
use bitgrain::series::{Columns, parse_series, series_text};
use bitgrain::units::Units;

use super::finite::assert_finite;

/// Steps of a case.
const CASE_STEPS: u64 = 20;
/// Larger cases are read and written but not stepped, so that an input takes milliseconds.
const CASE_GRAINS: usize = 64;

/// A case file: read, started and stepped if it is sound, and written and read again.
pub fn case(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    let Ok(read) = case::parse(text, "fuzz") else {
        return false;
    };
    let again = serde_json::to_string(&read).expect("a case can be written");
    assert_eq!(
        case::parse(&again, "fuzz").expect("a case reads back"),
        read
    );
    if read.grains.len() > CASE_GRAINS || read.obstacles.len() > CASE_GRAINS {
        return false;
    }
    let Ok(mut sim) = read.start("fuzz", |_| {}) else {
        return false;
    };
    assert_finite(&sim);
    for step in 0..CASE_STEPS {
        if sim.steps(1).is_err() {
            return step > 0;
        }
        assert_finite(&sim);
    }
    true
}

/// A scenario: its plan can be made, and written out it reads back equal.
pub fn scenario(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    let Ok(read) = scenario::parse(text, "fuzz", &[], Path::new("")) else {
        return false;
    };
    let (beds, runs) = (read.beds(), read.drags());
    assert!(!beds.is_empty() && !runs.is_empty(), "nothing to do");
    assert!(runs.iter().all(|run| run.bed < beds.len()));
    let again = scenario::parse(&read.to_toml(), "fuzz", &[], Path::new(""));
    assert_eq!(again.expect("a scenario reads back"), read);
    true
}

/// A table of a run's folder, the force series, the flow series, the energy series, the profile, the plane's
/// fields or the chain of digests: read, every number is finite, and the two series give the same rows when they
/// are written and read again.
pub fn series(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    let mut sound = false;
    if let Ok(rows) = FLOW.parse(text) {
        let again = FLOW.parse(&flow_text(&units(), &rows));
        let again = again.expect("a flow series reads back");
        assert_same_rows(&again, &rows);
        sound |= !rows.is_empty();
    }
    if let Ok(rows) = parse_series(text, "fuzz") {
        let columns = Columns {
            body: rows.iter().any(|row| row.body.is_some()),
            ..Columns::ALL
        };
        let again = series_text(&units(), columns, &rows);
        let again = parse_series(&again, "fuzz").expect("a force series reads back");
        assert_same_rows(&again, &rows);
        sound |= !rows.is_empty();
    }
    if let Ok(rows) = ENERGY.parse(text) {
        let again = ENERGY.parse(&energy_text(&units(), &rows));
        let again = again.expect("an energy series reads back");
        assert_same_rows(&again, &rows);
        sound |= !rows.is_empty();
    }
    if let Ok(chain) = Chain::parse(text, "fuzz") {
        let again = Chain::parse(&chain.text(), "fuzz").expect("a chain reads back");
        assert_eq!(again, chain);
        sound = true;
    }
    if let Ok(layers) = PROFILE.parse(text) {
        let finite = |&(low, high, speed): &(f64, f64, f64)| {
            [low, high, speed].iter().all(|x| x.is_finite())
        };
        assert!(layers.iter().all(finite), "{layers:?}");
        sound |= !layers.is_empty();
    }
    let grid = Grid {
        counts: [2, 1, 2],
        size: [1.0; 3],
    };
    if let Ok(fields) = plane(text, grid) {
        assert_eq!([fields.points.len(), fields.flags.len()], [4, 4]);
        let text = format!("{:?}", fields.points);
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        sound = true;
    }
    sound
}

fn units() -> Units {
    let unit = || String::from("1");
    Units {
        length: unit(),
        time: unit(),
        speed: unit(),
        force: unit(),
        torque: unit(),
        energy: unit(),
    }
}

/// The debug form distinguishes the two zeros, which equality does not, and shows what is not finite.
fn assert_same_rows<T: std::fmt::Debug>(got: &[T], want: &[T]) {
    let text = format!("{want:?}");
    assert_eq!(format!("{got:?}"), text);
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
}

/// A data file or dump: written and read again it gives the same bits.
pub fn lammps(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    let Ok(read) = parse_atoms(text, "fuzz") else {
        return false;
    };
    let written = data_text(&read, "fuzz");
    let again = parse_data(&written, "written").expect("a data file reads back");
    assert_same_bits(&again, &read);
    if !text.starts_with("ITEM:") {
        return true;
    }
    let frames = parse_dump(text, "fuzz").expect("its last frame was read");
    let written: String = frames.iter().map(|f| dump_text(f, None)).collect();
    let again = parse_dump(&written, "written").expect("a dump reads back");
    assert_eq!(again, frames);
    let last = parse_atoms(&written, "written").expect("a dump reads back");
    assert_same_bits(&last, &read);
    assert_eq!(last.periodic, read.periodic);
    true
}

/// Equal numbers are not enough: zero has two signs.
pub fn assert_same_bits(got: &DataFile, want: &DataFile) {
    let edges = |d: &DataFile| [d.lo, d.hi].map(|e| e.map(f64::to_bits));
    assert_eq!(edges(got), edges(want));
    assert_eq!(got.atoms.len(), want.atoms.len());
    let bits = |a: &Atom| {
        let vectors = [a.position, a.velocity, a.spin].map(|v| v.map(f64::to_bits));
        (a.diameter.to_bits(), a.density.to_bits(), vectors)
    };
    for (a, b) in got.atoms.iter().zip(&want.atoms) {
        assert_eq!((a.id, a.kind, a.image), (b.id, b.kind, b.image));
        assert_eq!(bits(a), bits(b), "{a:?} is not {b:?}");
    }
}
