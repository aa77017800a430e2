//! A bed as exported to other programs: nothing is lost.

use std::fmt::Debug;
use std::str::FromStr;

use bitgrain::bed::import;
use bitgrain::bench::read_bed;
use bitgrain::case::{BodyShape, ObstacleSpec};
use bitgrain::export::{atoms, frame, vtk_bodies, vtk_contacts, vtk_grains};
use bitgrain::lammps::{DataFile, data_text, dump_text, parse_atoms, parse_data};
use bitgrain::scenario;
use bitgrain::simulation::{Simulation, sphere_mass};
use bitgrain_kernel::{ContactForce, Domain, Obstacle, Partner};
use bitgrain_tests::fuzzing::assert_same_bits;
use bitgrain_tests::{
    GLASS, ball, golden, golden_case, open_case, printed, results, small_from_file,
};

use crate::PROGRAM;

/// The reference codes' bed with an intruder across the periodic edge and a floor, 40 steps on, and the
/// contacts of the last.
fn bed() -> (Simulation, Vec<ContactForce<f64>>) {
    let mut sim = read_bed(&golden("peers/bed200.data")).unwrap();
    let (edge, radius) = (sim.domain.hi()[0] - 1e-6, 0.75);
    // Overlaps the highest grain, which falls, by 0.001 and follows it.
    let height = |x: &[f64; 4]| {
        let d = sim.domain.separation([x[0], x[1], 0.0], [edge, 2.0, 0.0]);
        let reach = radius + x[3] - 1e-3;
        x[2] + (reach * reach - d[0] * d[0] - d[1] * d[1]).sqrt()
    };
    let top = sim.position.iter().map(height).fold(0.0, f64::max);
    sim.obstacles = vec![
        Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]),
        Obstacle {
            velocity: [1.0, 0.0, -4.0],
            inverse_mass: 1.0 / sphere_mass(2.0 * radius, 2500.0),
            ..Obstacle::sphere([edge, 2.0, top], radius)
        },
    ];
    sim.fit_storage();
    sim.start().unwrap();
    sim.steps(39).unwrap();
    let mut seen = Vec::new();
    sim.step_seen(&mut seen).unwrap();
    (sim, seen)
}

#[test]
fn a_bed_survives_a_data_file_and_a_dump() {
    let (sim, _) = bed();
    let data = atoms(&sim, true);
    assert_eq!(data.atoms.len(), sim.count() + 1);
    for (i, atom) in data.atoms[..sim.count()].iter().enumerate() {
        let [x, y, z, radius] = sim.position[i];
        assert_eq!((atom.id, atom.position), (sim.id[i], [x, y, z]));
        assert_eq!((0.5 * atom.diameter, atom.density), (radius, 1.0));
        assert_eq!(sphere_mass(atom.diameter, atom.density), sim.velocity[i][3]);
        assert_eq!(
            atom.kind == 3,
            sim.groups[sim.group[i] as usize].infinite_mass
        );
    }
    let ball = data.atoms.last().unwrap();
    assert_eq!((ball.kind, ball.id, ball.density), (2, 201, 2500.0));
    assert_eq!((ball.image, ball.velocity), ([1, 0, 0], [1.0, 0.0, -4.0]));
    let back = parse_data(&data_text(&data, "a bed"), "data").unwrap();
    assert_eq!(
        (back.lo, back.hi, &back.atoms),
        (data.lo, data.hi, &data.atoms)
    );
    let (frame, forces) = frame(&sim);
    assert_eq!((frame.step, forces.len()), (40, data.atoms.len()));
    let back = parse_atoms(&dump_text(&frame, Some(&forces)), "dump").unwrap();
    assert_eq!(back, data);
}

/// The rig in motion: its base is of type 3 and its lid of type 4, in every file for other programs; what
/// has no place in a data file, cylinder and planes, is not in it.
#[test]
fn a_rig_tells_its_base_and_its_lid() {
    let mut sim = golden_case("rig.json").start("rig", |_| {}).unwrap();
    sim.steps(9000).unwrap();
    let (frame, forces) = frame(&sim);
    // Base, bulk and lid by name; all that crossed an edge says so.
    let kinds = [vec![3; 12], vec![1; 30], vec![4; 12]].concat();
    let found: Vec<u32> = frame.atoms.iter().map(|a| a.kind).collect();
    assert_eq!(found, kinds);
    assert!(frame.atoms.iter().any(|a| a.image == [1, 0, 0]));

    let data = atoms(&sim, true);
    assert_eq!(data.atoms, frame.atoms);
    let text = data_text(&data, "a rig");
    assert!(text.contains("\n54 atoms\n4 atom types\n"), "{text}");
    assert_same_bits(&parse_data(&text, "data").unwrap(), &data);

    let text = dump_text(&frame, Some(&forces));
    let (head, rows) = text.split_once("ITEM: ATOMS ").unwrap();
    assert!(head.contains("BOX BOUNDS pp pp ff\n"), "{head}");
    let mut rows = rows.lines();
    let columns: Vec<&str> = rows.next().unwrap().split(' ').collect();
    // The names by which OVITO knows particles, types, radii, velocities and forces.
    for name in "id type radius x y z ix iy iz vx vy vz omegax omegay omegaz fx fy fz".split(' ') {
        assert!(columns.contains(&name), "no column {name}");
    }
    let column = |name: &str| columns.iter().position(|c| *c == name).unwrap();
    let written = rows.map(|row| row.split(' ').nth(column("type")).unwrap().parse::<u32>());
    assert_eq!(written.collect::<Result<Vec<u32>, _>>(), Ok(kinds.clone()));
    assert_same_bits(&parse_atoms(&text, "dump").unwrap(), &data);

    let vtk = vtk_grains(&sim, "rig");
    assert_eq!(after::<u32>(&vtk, "SCALARS type unsigned_int 1", 54), kinds);
}

/// The lid of our own bed is refused if the bed is imported from a file, and the message says what it is.
#[test]
fn a_lid_in_a_file_is_no_lid() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bed.data");
    let mut data = atoms(&bed().0, true);
    let read = |data: &DataFile| {
        std::fs::write(&file, data_text(data, "a bed")).unwrap();
        let text = small_from_file("bed.data", "");
        let scenario = scenario::parse(&text, "small", &[], folder.path())?;
        import::bed(&scenario, &file)
    };
    for atom in &mut data.atoms {
        atom.density = 1.0;
    }
    // From another program it is a type like any other.
    data.atoms[190].kind = 4;
    let sim = read(&data).expect("a sound bed");
    assert_eq!(sim.count(), data.atoms.len() - 1);
    data.atoms[190].density = 60.0;
    let refused = read(&data).unwrap_err().to_string();
    let lid = "atom 191 has the density 60; expected 1: see bed.density; type 4 is a lid's, and a bed \
               from a file gets no lid: leave it out";
    assert!(refused.ends_with(lid), "{refused}");
}

#[test]
fn densities_give_the_masses_back_and_read_as_they_were_given() {
    let (mut sim, _) = bed();
    for density in [2500.0, 0.1, 7850.0, 1e-9, 2.65] {
        for i in 0..sim.count() {
            sim.velocity[i][3] = sphere_mass(2.0 * sim.position[i][3], density);
        }
        for (i, atom) in atoms(&sim, false).atoms.iter().enumerate() {
            assert_eq!(sphere_mass(atom.diameter, atom.density), sim.velocity[i][3]);
            assert_eq!(atom.density, density, "atom {}", atom.id);
        }
    }
}

#[test]
fn open_space_gets_edges() {
    let (mut sim, _) = bed();
    sim.domain = Domain::open();
    let data = atoms(&sim, true);
    let inside = |a: usize, x: f64| data.lo[a] < x && x < data.hi[a];
    assert!(
        data.atoms
            .iter()
            .all(|p| (0..3).all(|a| inside(a, p.position[a])))
    );
    assert!(parse_data(&data_text(&data, "open"), "open").is_ok());
}

/// The numbers that follow a line with this beginning, as many as are wanted.
fn after<T: FromStr<Err: Debug>>(text: &str, start: &str, count: usize) -> Vec<T> {
    let at = text.find(&format!("\n{start}")).expect(start);
    let lines = text[at + 1..].lines().skip(1);
    let words = lines.flat_map(str::split_whitespace);
    let words = words.filter(|w| !["LOOKUP_TABLE", "default"].contains(w));
    words.take(count).map(|w| w.parse().unwrap()).collect()
}

#[test]
fn vtk_grains_hold_every_number() {
    let (sim, _) = bed();
    let text = vtk_grains(&sim, "grains\nof a bed");
    let head = "# vtk DataFile Version 3.0\ngrains of a bed\nASCII\nDATASET POLYDATA\n";
    assert!(text.starts_with(head));
    let n = sim.count() + 1;
    let points: Vec<f64> = after(&text, &format!("POINTS {n} double"), 3 * n);
    assert_eq!(points[..3], sim.position[0][..3]);
    assert_eq!(points[3 * n - 3..], sim.obstacles[1].point);
    let forces: Vec<f64> = after(&text, "VECTORS force double", 3 * n);
    assert_eq!(forces[..3], sim.force[0][..3]);
    assert_eq!(forces[3 * n - 3..], sim.obstacles[1].force);
    let spins: Vec<f64> = after(&text, "VECTORS spin double", 3 * n);
    assert_eq!(spins[3 * n - 6..3 * n - 3], sim.spin[n - 2][..3]);
    let radii: Vec<f64> = after(&text, "SCALARS radius double 1", n);
    assert_eq!((radii[0], radii[n - 1]), (sim.position[0][3], 0.75));
    let ids: Vec<u32> = after(&text, "SCALARS id unsigned_int 1", n);
    assert_eq!(ids, (1..=n as u32).collect::<Vec<u32>>());
    let vertices: Vec<usize> = after(&text, &format!("VERTICES {n} {}", 2 * n), 2 * n);
    assert_eq!(vertices[2 * n - 2..], [1, n - 1]);
    let last = text.lines().last().unwrap();
    assert_eq!(
        last.split(' ').count(),
        3,
        "the file ends with the last force"
    );
}

#[test]
fn vtk_contacts_are_as_long_as_the_contact() {
    let (sim, contacts) = bed();
    let text = vtk_contacts(&sim, &contacts, "contacts");
    let n = contacts.len();
    let points: Vec<f64> = after(&text, &format!("POINTS {} double", 2 * n), 6 * n);
    let normal: Vec<f64> = after(&text, "SCALARS normal_force double 1", n);
    let overlap: Vec<f64> = after(&text, "SCALARS overlap double 1", n);
    let slip: Vec<f64> = after(&text, "VECTORS tangential_force double", 3 * n);
    let obstacle: Vec<i64> = after(&text, "SCALARS obstacle int 1", n);
    let (mut beyond, mut pushes) = (0, 0);
    for (k, c) in contacts.iter().enumerate() {
        assert_eq!((normal[k], overlap[k]), (c.normal_force, c.overlap));
        assert_eq!(slip[3 * k..3 * k + 3], c.tangential_force);
        let line: [f64; 3] = std::array::from_fn(|a| points[6 * k + a] - points[6 * k + 3 + a]);
        let length = line.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut want = sim.position[c.i as usize][3] - c.overlap;
        match c.partner {
            Partner::Grain(j) => {
                want += sim.position[j as usize][3];
                assert_eq!(obstacle[k], -1);
            }
            Partner::Obstacle(number) => {
                pushes += 1;
                assert_eq!(obstacle[k], i64::from(number));
            }
        }
        // Sums and a root of numbers of order 10, each rounded once.
        assert!(
            (length - want).abs() < 1e-14,
            "contact {k}: {length} {want}"
        );
        let end = &points[6 * k + 3..6 * k + 5];
        beyond += usize::from(end.iter().any(|x| !(0.0..5.5).contains(x)));
    }
    assert!(
        n > 200 && beyond > 20 && pushes > 0,
        "{n} {beyond} {pushes}"
    );
}

/// `replay --vtk` writes each sample, and leaves a folder of something else alone.
#[test]
fn a_replay_is_written_for_paraview() {
    let folder = tempfile::tempdir().unwrap();
    let case = golden("cases/rig.json");
    let case = case.to_str().unwrap();
    let replay = |out: &str, code: i32| {
        let args = [
            "replay",
            case,
            "--steps",
            "200",
            "--every",
            "100",
            "--contacts",
            "--vtk",
            out,
        ];
        printed(PROGRAM, folder.path(), &args, code)
    };
    assert_eq!(replay("out", 0).lines().count(), 3);
    let files = results(&folder.path().join("out"));
    let names: Vec<String> = ["bodies", "contacts", "grains"]
        .iter()
        .flat_map(|what| ["0", "100", "200"].map(|step| format!("{what}.{step}.vtk")))
        .collect();
    assert_eq!(files.keys().cloned().collect::<Vec<_>>(), names);
    let text = |name: &str| String::from_utf8(files[name].clone()).unwrap();
    assert!(text("grains.100.vtk").contains("POINTS 54 double"));
    assert!(text("contacts.200.vtk").contains("SCALARS overlap double 1"));
    // The same names again are written anew.
    replay("out", 0);
    assert_eq!(results(&folder.path().join("out")), files);
    std::fs::write(folder.path().join("case.json"), "{}").unwrap();
    let refused = replay(".", 2);
    assert!(refused.contains("holds case.json"), "{refused}");
}

/// Each corner of each body lies on its surface, wherever it is turned to, and no polygon is left without a body.
#[test]
fn vtk_bodies_lie_on_their_surfaces() {
    let turned = Some([0.8, 0.0, 0.6, 0.0]);
    let long = |shape, length, half_length| ObstacleSpec {
        shape,
        length,
        half_length,
        orientation: turned,
        ..ObstacleSpec::cylinder([1.0, 2.0, 3.0], [1.0, 2.0, -1.0], 1.5)
    };
    let bodies = vec![
        ObstacleSpec::plane([0.0; 3], [0.0, 0.0, 1.0]),
        ObstacleSpec::sphere([4.0, 0.0, 9.0], 2.0),
        long(BodyShape::Cylinder, Some(4.0), None),
        long(BodyShape::Capsule, None, Some(1.0)),
        ObstacleSpec {
            center: Some([50.0; 3]),
            ..long(BodyShape::Drum, Some(4.0), None)
        },
        ObstacleSpec {
            shape: BodyShape::Box,
            diameter: None,
            half: Some([0.5, 1.0, 2.0]),
            orientation: turned,
            ..ObstacleSpec::sphere([0.0, 0.0, 20.0], 1.0)
        },
        ObstacleSpec {
            orientation: turned,
            ..ObstacleSpec::mesh(vec![[[0.0; 3], [1.0, 0.0, 0.5], [0.0, 1.0, 0.0]]])
        },
    ];
    let far = ball(1, [50.0; 3], [0.0; 3]);
    let sim = open_case(GLASS, 1e-4, vec![far], bodies).start("bodies", |_| {});
    let sim = sim.expect("a sound case");
    let text = vtk_bodies(&sim, "bodies");
    let head = |name: &str| -> Vec<usize> {
        let line = text
            .lines()
            .find(|line| line.starts_with(name))
            .expect(name);
        line.split(' ')
            .filter_map(|word| word.parse().ok())
            .collect()
    };
    let (corners, polygons) = (head("POINTS")[0], head("POLYGONS")[0]);
    let points: Vec<f64> = after(&text, &format!("POINTS {corners} double"), 3 * corners);
    let numbers: Vec<usize> = after(&text, "SCALARS obstacle int 1", polygons);
    let rows = text
        .lines()
        .skip_while(|line| !line.starts_with("POLYGONS"))
        .skip(1);
    let mut met = [0; 7];
    for (row, number) in rows.zip(&numbers) {
        let body = &sim.obstacles[*number];
        for corner in row.split(' ').skip(1) {
            let at: usize = corner.parse().expect("a number");
            let place = std::array::from_fn(|a| points[3 * at + a]);
            let distance = (0..body.shape.surfaces())
                .map(|surface| {
                    body.meet(surface, &sim.facets, &sim.domain, place, 0.0)
                        .overlap
                        .abs()
                })
                .fold(f64::INFINITY, f64::min);
            // Roundings of coordinates up to fifty.
            assert!(distance < 1e-12, "body {number}: {distance:e}");
            met[*number] += 1;
        }
    }
    assert!(
        met[0] == 0 && met[1..].iter().all(|count| *count > 2),
        "{met:?}"
    );
}
