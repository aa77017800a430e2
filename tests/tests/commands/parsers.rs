//! Property tests of writing and reading: the numbers come back to the last bit.

use std::io::Write;
use std::path::Path;

use bitgrain::case::{self, BoxSpec, Case, CaseLaw, GrainSpec, MotionSpec, ObstacleSpec};
use bitgrain::flow::{FLOW, FlowRow, flow_text};
use bitgrain::lammps::{
    Atom, DataFile, DumpFrame, data_text, dump_text, parse_atoms, parse_data, parse_dump,
    read_atoms,
};
use bitgrain::scenario;
use bitgrain::series::{BodyRow, Columns, SeriesRow, read_series, series_text};
use bitgrain_tests::fuzzing::assert_same_bits;
use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
use proptest::prelude::*;

use crate::any_law::case_law;

/// Every finite number: both signs, zeros and subnormals too.
fn finite() -> impl Strategy<Value = f64> {
    POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO
}

fn vector() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(finite())
}

/// Positive numbers whose double and half lose nothing.
fn size() -> impl Strategy<Value = f64> {
    (POSITIVE | NORMAL).prop_filter("a size", |x| *x > 1e-307 && *x < 1e307)
}

fn atom() -> impl Strategy<Value = Atom> {
    let image = prop::array::uniform3(any::<i32>());
    let sphere = (1..=u32::MAX, size(), POSITIVE | SUBNORMAL | NORMAL);
    let motion = (vector(), image, vector(), vector());
    (sphere, motion).prop_map(
        |((kind, diameter, density), (position, image, velocity, spin))| Atom {
            id: 0,
            kind,
            diameter,
            density,
            position,
            image,
            velocity,
            spin,
        },
    )
}

/// Up to 20 atoms with gaps between their ids, and a box.
fn data() -> impl Strategy<Value = DataFile> {
    let atoms = prop::collection::vec((1..1000u32, atom()), 0..20);
    let edges = prop::array::uniform3((-1e6..1e6f64, size()));
    let edges = edges.prop_filter("edges in order", |e| {
        e.iter()
            .all(|(lo, length)| *length < 1e300 && lo + length > *lo)
    });
    (atoms, edges).prop_map(|(atoms, edges)| {
        let mut id = 0;
        let named = |(gap, atom): (u32, Atom)| {
            id += gap;
            Atom { id, ..atom }
        };
        DataFile {
            lo: edges.map(|(lo, _)| lo),
            hi: edges.map(|(lo, length)| lo + length),
            periodic: None,
            atoms: atoms.into_iter().map(named).collect(),
        }
    })
}

fn frame(data: DataFile, step: u64, periodic: [bool; 3]) -> DumpFrame {
    DumpFrame {
        step,
        lo: data.lo,
        hi: data.hi,
        periodic,
        atoms: data.atoms,
    }
}

/// The word of an atom in a column.
fn word(atom: &Atom, column: &str) -> String {
    let at = |v: [f64; 3]| {
        format!(
            "{:e}",
            v[usize::from(column.ends_with('y')) + 2 * usize::from(column.ends_with('z'))]
        )
    };
    match column {
        "id" => atom.id.to_string(),
        "type" => atom.kind.to_string(),
        "diameter" => atom.diameter.to_string(),
        "radius" => (0.5 * atom.diameter).to_string(),
        "density" => format!("{:e}", atom.density),
        "ix" => atom.image[0].to_string(),
        "iy" => atom.image[1].to_string(),
        "iz" => atom.image[2].to_string(),
        "x" | "y" | "z" => at(atom.position),
        "vx" | "vy" | "vz" => at(atom.velocity),
        "omegax" | "omegay" | "omegaz" => at(atom.spin),
        _ => "none".into(),
    }
}

/// Columns in any order, some unknown ones among them.
fn columns() -> impl Strategy<Value = Vec<&'static str>> {
    let size = prop::sample::select(vec!["radius", "diameter"]);
    let strange =
        prop::collection::vec(prop::sample::select(vec!["fx", "c_1[2]", "element"]), 0..4);
    (size, strange).prop_flat_map(|(size, strange)| {
        let known = "id type density x y z ix iy iz vx vy vz omegax omegay omegaz";
        let all: Vec<&str> = known.split(' ').chain([size]).chain(strange).collect();
        Just(all).prop_shuffle()
    })
}

fn row() -> impl Strategy<Value = SeriesRow> {
    let vectors = (vector(), vector(), vector());
    let perhaps = (prop::option::of(finite()), prop::option::of(finite()));
    let whole = (any::<u64>(), any::<u32>(), perhaps);
    (whole, finite(), finite(), vectors).prop_map(|(whole, time, distance, vectors)| SeriesRow {
        step: whole.0,
        time,
        distance,
        force: vectors.0,
        force_mean: vectors.1,
        torque: vectors.2,
        contacts: whole.1,
        angle: whole.2.0,
        coordination: whole.2.1,
        body: Some(BodyRow {
            place: vectors.2,
            velocity: vectors.0,
            spin: vectors.1,
        }),
    })
}

fn flow_row() -> impl Strategy<Value = FlowRow> {
    let forces = prop::array::uniform4(finite());
    let states = prop::array::uniform6(finite());
    (any::<u64>(), any::<u64>(), forces, states).prop_map(|(step, floating, forces, states)| {
        let [drag, lift, base, lid] = forces;
        let [distance, far_field, momentum, pressure, packing, lid_height] = states;
        FlowRow {
            step,
            distance,
            drag,
            lift,
            base,
            lid,
            far_field,
            momentum,
            pressure,
            packing,
            lid_height,
            floating,
        }
    })
}

fn grain() -> impl Strategy<Value = GrainSpec> {
    let sphere = (1e-3..1e3f64, 1e-3..1e3f64, vector());
    (sphere, vector(), vector(), 0..6).prop_map(|(sphere, velocity, spin, motion)| {
        let (zero, [x, y, z]) = ([0.0; 3], velocity);
        let (velocity, spin, motion) = match motion {
            0 => (velocity, spin, MotionSpec::Free),
            1 => (zero, zero, MotionSpec::Frozen),
            2 => (zero, zero, MotionSpec::Carried(velocity)),
            3 => (velocity, spin, MotionSpec::Weightless),
            // With the velocity that it is carried at, or without.
            4 => (velocity, spin, MotionSpec::Lid([x, y])),
            _ => ([0.0, 0.0, z], spin, MotionSpec::Lid([x, y])),
        };
        GrainSpec {
            id: 0,
            diameter: sphere.0,
            density: sphere.1,
            position: sphere.2,
            velocity,
            spin,
            motion,
            material: None,
        }
    })
}

fn obstacle() -> impl Strategy<Value = ObstacleSpec> {
    let numbers = (vector(), vector(), size(), prop::option::of(size()));
    (0..3, prop::array::uniform3(0.1..1.0f64), numbers).prop_map(|(shape, direction, numbers)| {
        let (point, velocity, diameter, density) = numbers;
        match shape {
            0 => ObstacleSpec {
                velocity,
                ..ObstacleSpec::plane(point, direction)
            },
            1 => ObstacleSpec {
                density,
                velocity,
                ..ObstacleSpec::sphere(point, diameter)
            },
            _ => ObstacleSpec {
                velocity,
                ..ObstacleSpec::cylinder(point, direction, diameter)
            },
        }
    })
}

fn any_case() -> impl Strategy<Value = Case> {
    let bodies = (
        prop::collection::vec(grain(), 1..6),
        prop::collection::vec(obstacle(), 0..4),
    );
    let bounds = prop::option::of((vector(), vector(), any::<[bool; 3]>()));
    // Below a fifth of the Rayleigh time of the smallest, lightest grain in the stiffest law.
    let dt = 1e-300..1e-9f64;
    (case_law(), bounds, vector(), dt, bodies).prop_map(|(law, bounds, gravity, dt, bodies)| {
        let (mut grains, mut obstacles) = bodies;
        (1..).zip(&mut grains).for_each(|(id, grain)| grain.id = id);
        if let CaseLaw::Pairs(_) = law {
            let mut names = ["glass", "steel"].into_iter().cycle().map(str::to_owned);
            grains
                .iter_mut()
                .for_each(|grain| grain.material = names.next());
            obstacles
                .iter_mut()
                .for_each(|body| body.material = names.next());
        }
        Case {
            law,
            bounds: bounds.map(|(lo, hi, periodic)| BoxSpec { lo, hi, periodic }),
            gravity,
            dt,
            obstacles,
            grains,
        }
    })
}

/// The text of a scenario with arbitrary numbers in every place that takes them.
fn scenario_text() -> impl Strategy<Value = String> {
    let bed = (
        1e-3..1e-2f64,
        1.0..1.2f64,
        1e3..1e4f64,
        1.0..20.0f64,
        any::<u32>(),
    );
    let law = (1e5..1e7f64, 0.0..1e7f64, 0.0..1e5f64, 0.0..1.0f64);
    let drag = (
        1.5..4.0f64,
        4.0..5.0f64,
        0.1..9.0f64,
        1e-8..1e-7f64,
        1..50u64,
    );
    (bed, law, drag, any::<[bool; 3]>()).prop_map(|(bed, law, drag, flags)| {
        let (d, wider, density, gravity, seed) = bed;
        let (kn, kt, gamma, mu) = law;
        let (diameter, height, froude, dt, every) = drag;
        let size = [12.0 * d, 11.0 * d, 13.0 * d];
        let speed = ["speed", "froude"][usize::from(flags[0])];
        let (diameter, height, distance) = (diameter * d, height * d, 9.0 * d);
        format!(
            "name = 'any'\nunits = 'si'\nseed = {seed}\ngravity = {gravity:?}\n\
             [bed]\nbox = {size:?}\ngrains = 900\ndiameters = [{d:?}, {:?}]\n\
             density = {density:?}\nbase = {:?}\nfloor = {}\n\
             [law]\nkind = 'hertz_history'\nkn = {kn:?}\nkt = {kt:?}\ngamma_n = {gamma:?}\n\
             gamma_t = {gamma:?}\nmu = {mu:?}\n\
             [intruder]\ndiameter = {diameter:?}\ndensity = {density:?}\nheight = {height:?}\n\
             {speed} = [{froude:?}, {:?}]\n\
             [drag]\ndt = {dt:?}\ndistance = {distance:?}\n\
             [measure]\nevery = {every}\ntorque = {}\n",
            d * wider,
            0.6 * d,
            flags[1],
            froude / 3.0,
            flags[2]
        )
    })
}

fn write(path: &std::path::Path, text: &str, packed: bool) {
    let file = std::fs::File::create(path).unwrap();
    if packed {
        let mut gzip = flate2::write::GzEncoder::new(file, flate2::Compression::fast());
        gzip.write_all(text.as_bytes()).unwrap();
        gzip.finish().unwrap();
    } else {
        (&file).write_all(text.as_bytes()).unwrap();
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

    #[test]
    fn data_files(data in data(), title in "\\PC{0,300}") {
        let back = parse_data(&data_text(&data, &title), "data").unwrap();
        assert_same_bits(&back, &data);
        prop_assert_eq!(back.periodic, None);
    }

    #[test]
    fn dumps(data in data(), other in data(), step: u64, periodic: [bool; 3]) {
        let frames = [frame(data, step, periodic), frame(other.clone(), 0, [false; 3])];
        let forces: Vec<[f64; 3]> = other.atoms.iter().map(|a| a.spin).collect();
        let text = dump_text(&frames[0], None) + &dump_text(&frames[1], Some(&forces));
        prop_assert_eq!(&parse_dump(&text, "dump").unwrap()[..], &frames[..]);
        assert_same_bits(&parse_atoms(&text, "dump").unwrap(), &other);
    }

    #[test]
    fn columns_of_a_dump_in_any_order(data in data(), columns in columns(), first in 0..20usize) {
        let mut text = dump_text(&frame(data.clone(), 3, [true; 3]), None);
        text.truncate(text.find("ITEM: ATOMS").unwrap());
        text.push_str(&format!("ITEM: ATOMS {} \n", columns.join(" ")));
        let mut rows = data.atoms.clone();
        let count = rows.len();
        rows.rotate_left(first % count.max(1));
        for atom in &rows {
            let words: Vec<String> = columns.iter().map(|c| word(atom, c)).collect();
            text.push_str(&format!("{} \n", words.join(" ")));
        }
        assert_same_bits(&parse_atoms(&text, "dump").unwrap(), &data);
    }

    #[test]
    fn packed_files(data in data(), dump: bool, packed: bool) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bed");
        let text = if dump {
            dump_text(&frame(data.clone(), 0, [true, true, false]), None)
        } else {
            data_text(&data, "a bed")
        };
        write(&path, &text, packed);
        let back = read_atoms(&path).unwrap();
        assert_same_bits(&back, &data);
        prop_assert_eq!(back.periodic, dump.then_some([true, true, false]));
    }

    #[test]
    fn series(rows in prop::collection::vec(row(), 0..10)) {
        let units = scenario::load("quick", &[]).unwrap().units();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("series.csv");
        write(&path, &series_text(&units, Columns::ALL, &rows), false);
        let back = read_series(&path).unwrap();
        prop_assert_eq!(&back, &rows);
        let bits = |rows: &[SeriesRow]| -> Vec<u64> {
            let vectors = rows.iter().flat_map(|r| [r.force, r.force_mean, r.torque]);
            vectors.flatten().map(f64::to_bits).collect()
        };
        prop_assert_eq!(bits(&back), bits(&rows));
    }

    #[test]
    fn flows(rows in prop::collection::vec(flow_row(), 0..10)) {
        let units = scenario::load("guillard-small", &[]).unwrap().units();
        let back = FLOW.parse(&flow_text(&units, &rows)).unwrap();
        prop_assert_eq!(format!("{back:?}"), format!("{rows:?}"));
    }

    #[test]
    fn cases(case in any_case()) {
        let back = case::parse(&serde_json::to_string(&case).unwrap(), "case").unwrap();
        // The debug form distinguishes the two zeros, which equality does not.
        prop_assert_eq!(format!("{back:?}"), format!("{case:?}"));
    }

    #[test]
    fn scenarios(text in scenario_text()) {
        let read = scenario::parse(&text, "text", &[], Path::new("")).unwrap();
        let dt = text.split("dt = ").nth(1).and_then(|t| t.lines().next());
        let dt = dt.map(|word| word.parse::<f64>().unwrap());
        prop_assert_eq!(dt, Some(read.drag.dt));
        let back = scenario::parse(&read.to_toml(), "written", &[], Path::new("")).unwrap();
        prop_assert_eq!(format!("{back:?}"), format!("{read:?}"));
    }
}
