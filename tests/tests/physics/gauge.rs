//! The gauge of a flowing bed on grains whose motion is known: far field, floating grains, windows.

use std::path::Path;

use bitgrain::flow::FlowGauge;
use bitgrain::motion::{Motion, Moves};
use bitgrain::scenario;
use bitgrain::simulation::{Grain, Simulation};
use bitgrain_kernel::{Domain, Group, Obstacle};
use bitgrain_tests::SMALL;

/// A power of two, so that no sum of displacements rounds.
const DT: f64 = 1.0 / 1024.0;

/// Steps between rows: half a diameter at a speed of 1.
const ROW: u64 = 512;

const FREE: u8 = 0;
const BASE: u8 = 1;
const LID: u8 = 2;

/// Grains at these places with these velocities along x, none in touch, in a box 16 long round an intruder
/// in its middle, high up; nothing pulls them.
fn tray(grains: &[(u8, [f64; 3], f64)]) -> Simulation {
    let domain = Domain::new([0.0; 3], [16.0, 4.0, 16.0], [true, true, false]).unwrap();
    let groups = vec![
        Group::free([0.0; 3]),
        Group::prescribed_velocity(),
        Group::free_along_z([0.0; 3]),
    ];
    let grain = |(k, &(group, position, speed)): (usize, &(u8, [f64; 3], f64))| Grain {
        id: k as u32 + 1,
        group,
        diameter: 1.0,
        density: 1.0,
        position,
        velocity: [speed, 0.0, 0.0],
        spin: [0.0; 3],
    };
    let grains: Vec<Grain> = grains.iter().enumerate().map(grain).collect();
    let law = scenario::parse(SMALL, "small", &[], Path::new(""))
        .unwrap()
        .law
        .build()
        .unwrap();
    let body = Obstacle::sphere([8.0, 2.0, 14.0], 0.5);
    let mut sim = Simulation::new(law, domain, DT, groups, &grains, vec![body]);
    sim.start().unwrap();
    sim
}

/// Rows of a gauge at this sim for a speed of 1; `turn` may change velocities after a step.
fn read(
    sim: &mut Simulation,
    moves: Moves,
    rows: u64,
    turn: impl Fn(&mut Simulation, u64),
) -> FlowGauge {
    let motion = motion(moves, rows, 0.0);
    let mut gauge = FlowGauge::new(sim, &motion, 8.0);
    for n in 1..=motion.steps() {
        sim.steps(1).unwrap();
        turn(sim, n);
        read_step(&mut gauge, sim, n);
    }
    gauge
}

/// Reads step `n`, with forces that grow by the step.
fn read_step(gauge: &mut FlowGauge, sim: &Simulation, n: u64) {
    let note = sim.note(&gauge.watch(sim.obstacles.len()));
    gauge.read(&note, [n as f64, 2.0 * n as f64, 0.0]);
    if gauge.is_due(n) {
        gauge.end_row(sim, n);
    }
}

fn motion(moves: Moves, rows: u64, discard: f64) -> Motion {
    let motion = Motion {
        moves,
        speed: 1.0,
        dt: DT,
        grain_diameter: 1.0,
        window: [1, 1],
        last: 1,
    };
    motion.averaged_beyond(discard, rows * ROW)
}

fn speeds(gauge: &FlowGauge) -> Vec<f64> {
    gauge.rows.iter().map(|row| row.far_field).collect()
}

/// A line of grains a diameter and a half apart, low in the box.
fn line(speed: impl Fn(f64) -> f64) -> Vec<(u8, [f64; 3], f64)> {
    let places = (0..10).map(|k| 0.5 + 1.5 * f64::from(k));
    places.map(|x| (FREE, [x, 1.0, 2.0], speed(x))).collect()
}

/// A bed that goes by as one is at the speed asked for, and exactly: across the edge of the box, in the frame
/// of the bed or of the intruder.
#[test]
fn a_bed_that_moves_as_one_is_at_its_speed() {
    let mut sim = tray(&line(|_| 1.0));
    let gauge = read(&mut sim, Moves::Bed, 8, |_, _| ());
    assert_eq!(speeds(&gauge), [1.0; 8]);
    let crossed = sim.image.iter().filter(|image| image[0] == 1).count();
    assert!((2..5).contains(&crossed), "{crossed}");
    let mass = sim.velocity.iter().map(|v| v[3]).sum::<f64>();
    let moving: Vec<f64> = gauge.rows.iter().map(|row| row.momentum).collect();
    assert_eq!(moving, [mass; 8]);
    let travel: Vec<f64> = gauge.rows.iter().map(|row| row.distance).collect();
    assert_eq!(travel, [0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0]);
    // The far bed at rest, and the intruder through it.
    let mut sim = tray(&line(|_| 0.0));
    let gauge = read(&mut sim, Moves::Intruder, 3, |_, _| ());
    assert_eq!(speeds(&gauge), [1.0; 3]);
    assert_eq!(gauge.rows[2].momentum, mass);
    // Dragged along at a quarter of the intruder's speed.
    let mut sim = tray(&line(|_| 0.25));
    let gauge = read(&mut sim, Moves::Intruder, 3, |_, _| ());
    assert_eq!(speeds(&gauge), [0.75; 3]);
    let mut sim = tray(&line(|_| -0.5));
    assert_eq!(speeds(&read(&mut sim, Moves::Bed, 2, |_, _| ())), [-0.5; 2]);
}

/// Gives every grain this speed along x.
fn set_speed(sim: &mut Simulation, speed: f64) {
    let histories = sim.contact_histories();
    for v in &mut sim.velocity {
        v[0] = speed;
    }
    sim.resume(&histories).unwrap();
}

/// Speeds are those of displacements: grains that rest for half of the time are at half of their speed,
/// whether they move or rest at the moment a row ends.
#[test]
fn bursts_do_not_mislead() {
    for moves_last in [false, true] {
        let pace = |sim: &mut Simulation, n: u64| {
            let fast = (n % ROW < ROW / 2) == moves_last;
            set_speed(sim, if fast { 2.0 } else { 0.0 });
        };
        let mut sim = tray(&line(|_| if moves_last { 2.0 } else { 0.0 }));
        let gauge = read(&mut sim, Moves::Bed, 3, pace);
        assert_eq!(speeds(&gauge), [1.0; 3]);
        assert_eq!(gauge.rows[2].momentum > 0.0, moves_last);
    }
}

/// The near field, a quarter of the box on either side, does not affect the far one; nor do base and lid.
#[test]
fn only_far_free_grains_count() {
    let near = |x: f64| (x - 8.0).abs() < 4.0;
    let mut grains = line(|x| if near(x) { 0.0 } else { 1.0 });
    // In separate lanes, so that no grain catches up with another.
    for (_, at, _) in grains.iter_mut().filter(|(_, at, _)| near(at[0])) {
        at[1] = 3.0;
    }
    grains.push((BASE, [1.0, 1.0, 0.5], 0.5));
    grains.push((LID, [1.0, 1.0, 6.0], 0.5));
    let gauge = read(&mut tray(&grains), Moves::Bed, 1, |_, _| ());
    assert_eq!(speeds(&gauge), [1.0]);
    // By height, over the window: one layer with free grains.
    assert_eq!(gauge.profile.speeds(), [(2.0, 3.0, 1.0)]);
}

/// A grain floats if it is above the grain of the lid that is nearest to it from above, also if that is
/// beyond the edge of the box.
#[test]
fn floating_grains_are_those_above_the_lids_nearest() {
    let lid = [(LID, [0.5, 1.0, 3.0], 0.0), (LID, [8.0, 1.0, 6.0], 0.0)];
    let count = |at: [f64; 3]| {
        let mut grains = lid.to_vec();
        grains.push((FREE, at, 0.0));
        let rows = read(&mut tray(&grains), Moves::Bed, 1, |_, _| ()).rows;
        assert_eq!(rows[0].lid_height, 4.5);
        rows[0].floating
    };
    assert_eq!(count([1.0, 1.0, 4.5]), 1, "over the low end");
    assert_eq!(count([7.0, 1.0, 4.5]), 0, "under the high end");
    assert_eq!(
        count([15.0, 1.0, 4.5]),
        1,
        "over the low end, across the edge"
    );
    assert_eq!(count([15.0, 1.0, 1.5]), 0);
    assert_eq!(count([7.0, 1.0, 7.5]), 1);
    let alone = read(&mut tray(&line(|_| 0.0)), Moves::Bed, 1, |_, _| ());
    assert_eq!((alone.rows[0].floating, alone.rows[0].lid_height), (0, 0.0));
}

/// A row has the means of its steps; means over the window take the rows that lie in it wholly.
#[test]
fn rows_and_windows_are_whole() {
    let mut sim = tray(&line(|_| 1.0));
    let rows = read(&mut sim, Moves::Bed, 5, |_, _| ()).rows;
    // The mean of 1 to 512, and so on.
    let mean = |k: u64| (k * ROW) as f64 + 0.5 * (ROW + 1) as f64;
    for (k, row) in (0..).zip(&rows) {
        assert_eq!(
            (row.step, row.drag, row.lift),
            ((k + 1) * ROW, mean(k), 2.0 * mean(k))
        );
    }
    // Faster with each row, and ever more so, that no window has the means of another.
    let speed = |k: u64| 1.0 + (k * k) as f64 / 16.0;
    let windows = |discard: f64| {
        let motion = motion(Moves::Bed, 5, discard);
        let mut sim = tray(&line(|_| 1.0));
        let mut gauge = FlowGauge::new(&sim, &motion, 8.0);
        for n in 1..=motion.steps() {
            sim.steps(1).unwrap();
            set_speed(&mut sim, speed(n / ROW));
            read_step(&mut gauge, &sim, n);
        }
        gauge.means(DT)
    };
    let mass = sim.velocity.iter().map(|v| v[3]).sum::<f64>();
    let inertia = |from: u64| {
        let rows = (5 - from) as f64;
        mass * (speed(5) - speed(from)) / (rows * ROW as f64 * DT)
    };
    let same = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
    let all = windows(0.0).unwrap();
    assert_eq!((all.rows, all.drag, all.far_field), (5, mean(2), 1.375));
    assert!(same(all.inertia, inertia(0)), "{}", all.inertia);
    // The window begins with the first step of the second row, and with its second.
    let late = windows(0.5).unwrap();
    assert_eq!((late.rows, late.drag), (4, 0.5 * (mean(2) + mean(3))));
    assert_eq!(
        late.drag_halves,
        [0.5 * (mean(1) + mean(2)), 0.5 * (mean(3) + mean(4))]
    );
    assert_eq!(late.lift_halves, late.drag_halves.map(|x| 2.0 * x));
    assert!(same(late.inertia, inertia(1)), "{}", late.inertia);
    let later = windows(0.5 + DT).unwrap();
    assert_eq!((later.rows, later.drag), (3, mean(3)));
    assert_eq!(later.far_field, (speed(2) + speed(3) + speed(4)) / 3.0);
    assert!(same(later.inertia, inertia(2)), "{}", later.inertia);
    assert_eq!(windows(1.75), None, "one row is no mean");
}
