//! Files that LAMMPS wrote, read back: the same atoms to the last bit.
//!
//! `golden/peers/roundtrip.data.gz` is [`sent`] as this crate writes it (the ignored test below
//! puts it there). LAMMPS (29 Sep 2021, Debian) read it, unpacked, and wrote
//! `roundtrip_lammps.data.gz` and `roundtrip_lammps.dump.gz` with this input:
//!
//! ```text
//! units lj
//! atom_style sphere
//! boundary p p f
//! read_data roundtrip.data
//! write_data roundtrip_lammps.data
//! reset_timestep 12
//! write_dump all custom roundtrip_lammps.dump type omegaz omegay omegax xu yu zu id radius mass &
//!   vx vy vz ix iy iz xs ys zs x y z diameter xsu ysu zsu fx modify format float %.17g
//! ```

use bitgrain::files::read_text;
use bitgrain::lammps::{
    Atom, DataFile, DumpFrame, data_text, dump_text, parse_atoms, parse_data, parse_dump,
    read_atoms, read_data, read_dump,
};
use bitgrain::random::{Purpose, uniforms};
use bitgrain_tests::{golden, largest};

/// The 200 grains of the reference codes' bed moving, spinning and far from where they began, every fifth of
/// density 2500, and an intruder.
fn sent() -> DataFile {
    let mut data = read_data(&golden("peers/bed200.data")).unwrap();
    for atom in &mut data.atoms {
        let u: [f64; 3] = uniforms(7, Purpose::Velocity, atom.id);
        let w: [f64; 3] = uniforms(7, Purpose::Shift, atom.id);
        atom.velocity = u.map(|u| 2.0 * u - 1.0);
        atom.spin = w.map(|w| 1e-3 * (w - 0.5));
        let crossed = |u: f64| (1000.0 * u) as i32 - 500;
        atom.image = [crossed(u[0]), crossed(u[1]), 0];
        if atom.id % 5 == 0 {
            atom.density = 2500.0;
        }
    }
    data.atoms.push(Atom {
        id: 201,
        kind: 2,
        diameter: 2.1,
        density: 1.0,
        position: [2.0 / 3.0, 0.1 + 0.2, 25.0],
        image: [-3, 0, 0],
        velocity: [1.0, 1e-300, -0.0],
        spin: [f64::MIN_POSITIVE, 5e-324, 1.5e17],
    });
    data
}

/// Everything of an atom but its density, as bits.
fn bits(atom: &Atom) -> (u32, u32, [i32; 3], Vec<u64>) {
    let numbers = [[atom.diameter; 3], atom.position, atom.velocity, atom.spin];
    let words = numbers.iter().flatten().map(|x| x.to_bits()).collect();
    (atom.id, atom.kind, atom.image, words)
}

fn assert_same_but_density(got: &[Atom], want: &[Atom]) {
    assert_eq!(got.len(), want.len());
    for (got, want) in got.iter().zip(want) {
        assert_eq!(bits(got), bits(want), "{got:?} is not {want:?}");
    }
}

#[test]
#[ignore = "writes the golden that LAMMPS is to read; see the head of this file"]
fn write_what_lammps_reads() {
    let text = data_text(&sent(), "200 grains and an intruder");
    std::fs::write(golden("peers/roundtrip.data"), text).unwrap();
}

#[test]
fn what_lammps_read_is_what_is_written_today() {
    let text = read_text(&golden("peers/roundtrip.data.gz")).unwrap();
    assert_eq!(data_text(&sent(), "200 grains and an intruder"), text);
    assert_eq!(parse_data(&text, "roundtrip").unwrap(), sent());
}

#[test]
fn a_data_file_that_lammps_wrote_gives_the_same_atoms() {
    let sent = sent();
    let got = read_data(&golden("peers/roundtrip_lammps.data.gz")).unwrap();
    assert_eq!((got.lo, got.hi), (sent.lo, sent.hi));
    assert_same_but_density(&got.atoms, &sent.atoms);
    let mut off = 0;
    for (got, want) in got.atoms.iter().zip(&sent.atoms) {
        if want.density == 1.0 {
            assert_eq!(got.density, 1.0, "atom {}", want.id);
        } else {
            // Mass over volume: one rounding in the product, one in the quotient.
            let distance = got.density.to_bits().abs_diff(want.density.to_bits());
            assert!(distance <= 1, "atom {}: {}", want.id, got.density);
            off += distance;
        }
    }
    assert!(
        off > 0,
        "the caution in the docs of read_data is not needed"
    );
}

/// The dump's text with these columns only, in this order.
fn chosen(text: &str, columns: &str) -> String {
    let mut out = String::new();
    let mut places: Vec<usize> = Vec::new();
    for line in text.lines() {
        if let Some(names) = line.strip_prefix("ITEM: ATOMS ") {
            let names: Vec<&str> = names.split(' ').collect();
            let place = |wanted: &str| names.iter().position(|n| *n == wanted).unwrap();
            places = columns.split(' ').map(place).collect();
            out.push_str(&format!("ITEM: ATOMS {columns}\n"));
        } else if places.is_empty() {
            out.push_str(&format!("{line}\n"));
        } else {
            let words: Vec<&str> = line.split_whitespace().collect();
            let words: Vec<&str> = places.iter().map(|p| words[*p]).collect();
            out.push_str(&format!("{}\n", words.join(" ")));
        }
    }
    out
}

#[test]
fn a_dump_that_lammps_wrote_gives_the_same_atoms() {
    let sent = sent();
    let path = golden("peers/roundtrip_lammps.dump.gz");
    let frames = read_dump(&path).unwrap();
    let [frame] = frames.as_slice() else {
        panic!("{} frames", frames.len());
    };
    assert_eq!((frame.step, frame.periodic), (12, [true, true, false]));
    assert_eq!((frame.lo, frame.hi), (sent.lo, sent.hi));
    assert_same_but_density(&frame.atoms, &sent.atoms);
    for (got, want) in frame.atoms.iter().zip(&sent.atoms) {
        // Volumes are computed here and there in another order: a few roundings.
        assert!((got.density / want.density - 1.0).abs() < 1e-15);
    }
    let last = read_atoms(&path).unwrap();
    assert_eq!((last.lo, last.periodic), (frame.lo, Some(frame.periodic)));
    assert_eq!(last.atoms, frame.atoms);
}

#[test]
fn scaled_and_unwrapped_columns_give_the_same_places() {
    let sent = sent();
    let text = read_text(&golden("peers/roundtrip_lammps.dump.gz")).unwrap();
    let common = "id mass vz vy vx radius type";
    for position in [
        "xs ys zs ix iy iz",
        "xu yu zu ix iy iz",
        "xsu ysu zsu ix iy iz",
        "xu yu zu",
        "xsu ysu zsu",
        "x yu zs ix iy iz",
    ] {
        let text = chosen(&text, &format!("{position} {common}"));
        let frame = parse_dump(&text, position).unwrap().remove(0);
        let off = frame.atoms.iter().zip(&sent.atoms).map(|(got, want)| {
            assert_eq!(got.image, want.image, "{position}, atom {}", want.id);
            largest((0..3).map(|a| got.position[a] - want.position[a]))
        });
        // LAMMPS' scaled and unwrapped places have passed through numbers of 512 and more: half a
        // unit in the last place there, times a box length of 30.5, is 1.7e-12.
        assert!(largest(off) < 4e-12, "{position}");
    }
}

#[test]
fn frames_are_written_and_read_one_after_another() {
    let sent = sent();
    let frame = |step, shift: f64| DumpFrame {
        step,
        lo: sent.lo,
        hi: sent.hi,
        periodic: [true, false, true],
        atoms: sent
            .atoms
            .iter()
            .map(|a| Atom {
                position: a.position.map(|x| x + shift),
                ..*a
            })
            .collect(),
    };
    let frames = [frame(0, 0.0), frame(u64::MAX, 0.01)];
    let forces: Vec<[f64; 3]> = sent.atoms.iter().map(|a| a.velocity).collect();
    let text = dump_text(&frames[0], None) + &dump_text(&frames[1], Some(&forces));
    assert_eq!(parse_dump(&text, "two frames").unwrap(), frames);
    let last = text.lines().last().unwrap();
    assert!(last.ends_with(" 1.0 1e-300 -0.0"), "{last}");
    assert_eq!(parse_atoms(&text, "two").unwrap().atoms, frames[1].atoms);
}

const HEAD: &str = "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n\
    0 10\n0 10\n0 10\n";

#[test]
fn wrong_dumps_are_refused_with_their_line() {
    let atoms = "1 1 0.5 1 1 1 1\n2 1 0.5 1 3 3 3\n";
    let whole = format!("{HEAD}ITEM: ATOMS id type radius density x y z\n{atoms}");
    assert_eq!(parse_dump(&whole, "dump").unwrap()[0].atoms.len(), 2);
    for (from, to, told) in [
        (" id ", " name ", "dump:9: there is no column `id`"),
        (" radius", " c_r", "column `diameter` or `radius`"),
        (" density", " rho", "column `density` or `mass`"),
        (" y z", " y fz", "column `z`, `zu`, `zs` or `zsu`"),
        (" type", " element", "column `type`"),
        (
            " x y z\n",
            " x y z vx vy\n",
            "column `vz`, as the other two",
        ),
        ("BOUNDS pp", "BOUNDS xy xz yz pp", "dump:5: tilted boxes"),
        ("BOUNDS pp pp ff", "BOUNDS", "dump:5: expected `BOX BOUNDS"),
        ("0 10\n0 10\n", "0 10\n9 8\n", "dump:7: the lower edge"),
        ("0 10\n0 10\n", "0 10\n9\n", "dump:7: expected two edges"),
        ("\n2 1 0.5", "\n1 1 0.5", "dump:11: atom id 1 appears twice"),
        ("3 3 3\n", "3 3\n", "dump:11: expected 7 columns, found 6"),
        ("3 3 3\n", "3 3 nan\n", "dump:11: `nan` is not a finite"),
        (
            "\n2 1 0.5",
            "\n2 1 -0.5",
            "dump:11: diameter and density must",
        ),
        (
            "\n2 1 0.5 1 3 3 3\n",
            "\n",
            "dump:10: 1 atoms found, 2 announced",
        ),
        ("\n5\n", "\n-5\n", "dump:2: `-5` is not a whole number"),
        ("ITEM: TIMESTEP\n5\n", "", "has no `ITEM: TIMESTEP`"),
        ("ITEM: TIMESTEP", "ITEM: STEP", "dump:1: item `STEP`"),
        ("1 1 1\n", "1 1 1\nfoo\n", "dump:11: expected 7 columns"),
    ] {
        assert!(whole.contains(from), "{from}");
        let error = parse_dump(&whole.replacen(from, to, 1), "dump");
        let error = error.expect_err(to).to_string();
        assert!(error.contains(told), "{to:?}: {error}");
    }
    let error = parse_dump("", "dump").unwrap_err().to_string();
    assert!(error.contains("holds no frame"), "{error}");
}

#[test]
fn sections_of_other_programs_are_passed_over_or_refused() {
    let head = "title\n\n1 atoms\n1 atom types\n\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\n";
    let atoms = "Atoms # sphere\n\n1 1 0.5 1 1 2 3 0 -1 0 # a remark\n";
    let coefficients = "Pair Coeffs # hertz\n\n1 2e5 0.5\n\n";
    let data = parse_data(&format!("{head}{coefficients}{atoms}"), "bed").unwrap();
    assert_eq!(data.atoms[0].image, [0, -1, 0]);
    for (text, told) in [
        ("Masses\n\n1 1.0\n", "bed:10: section `Masses`"),
        (
            "Bonds\n\n1 1 1 2\n",
            "bed:10: section `Bonds` is not understood",
        ),
        ("Atoms # atomic\n\n", "found style `atomic`"),
        (
            "Atoms\n\n1 1 1e-308 1 1 2 3\n",
            "bed:12: the diameter 1e-308 is too",
        ),
        ("Atoms\n\n1 1 1 1 1 2 3 0 0 z\n", "image count `z`"),
    ] {
        let error = parse_data(&format!("{head}{text}"), "bed").unwrap_err();
        assert!(error.to_string().contains(told), "{error}");
    }
}
