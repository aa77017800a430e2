//! Notes of the steps of a stretch against the rows after each step: on any threads, with any cut, with lists that are
//! full, and as far as a stretch gets that ends at a fault or a loss. The bed is `bed-2500/settled.safetensors.gz`.

use bitgrain::notes::{Note, Watch};
use bitgrain::parts::Cutting;
use bitgrain::simulation::{Role, Simulation};
use bitgrain::threads::on_threads;
use bitgrain_kernel::{Error as KernelError, LossPolicy, Obstacle};
use bitgrain_tests::{bed_that_loses_a_grain, highest, settled_bed};

/// The bed with its intruder in motion, and a ball that lies on the highest grain.
fn bed() -> Simulation {
    let mut sim = settled_bed();
    let [x, y, z, radius] = sim.position[highest(&sim)];
    let ball = Obstacle::sphere([x, y, z + radius + 0.99], 1.0);
    sim.obstacles.push(ball);
    sim.start().expect("a sound bed");
    sim
}

/// All obstacles, the last first, and the grains of the base, in no order.
fn watch(sim: &Simulation) -> Watch {
    let base = (0..sim.count()).filter(|&i| sim.role(i) == Role::Base);
    let mut grains: Vec<u32> = base.map(|i| i as u32).collect();
    grains.sort_by_key(|place| place.wrapping_mul(0x9e37_79b9));
    Watch {
        obstacles: (0..sim.obstacles.len() as u32).rev().collect(),
        grains,
    }
}

/// What a stretch of so many steps tells on so many threads, and how it ended.
fn told(
    mut sim: Simulation,
    (threads, cutting): (usize, Cutting),
    steps: u64,
) -> (Vec<Note>, Result<(), KernelError>) {
    sim.stepping.divide_always();
    sim.stepping.cutting = cutting;
    let (watch, mut notes) = (watch(&sim), Vec::new());
    let began = sim.step_count();
    let done = on_threads(threads, || {
        sim.steps_noted(steps, &watch, |note| notes.push(note.clone()))
    });
    assert_eq!(notes.len() as u64, sim.step_count() - began);
    (notes, done.unwrap())
}

/// The same of single steps that are looked at.
fn seen(mut sim: Simulation, steps: u64) -> (Vec<Note>, Result<(), KernelError>) {
    let (watch, mut notes) = (watch(&sim), Vec::new());
    for _ in 0..steps {
        if let Err(fault) = sim.step_watched(|_| {}) {
            return (notes, Err(fault));
        }
        notes.push(sim.note(&watch));
    }
    (notes, Ok(()))
}

const WAYS: [(usize, Cutting); 6] = [
    (1, Cutting::Planes),
    (2, Cutting::Planes),
    (3, Cutting::Planes),
    (8, Cutting::Planes),
    (2, Cutting::Scattered(1)),
    (5, Cutting::Scattered(2)),
];

fn compare(begin: &Simulation, steps: u64) -> (Vec<Note>, Result<(), KernelError>) {
    let plain = seen(begin.clone(), steps);
    for way in WAYS {
        let (notes, ended) = told(begin.clone(), way, steps);
        for (one, other) in notes.iter().zip(&plain.0) {
            assert_eq!(one, other, "{way:?}");
        }
        assert_eq!((notes.len(), ended), (plain.0.len(), plain.1), "{way:?}");
    }
    plain
}

#[test]
fn notes_are_what_a_look_after_each_step_shows() {
    let steps = if cfg!(debug_assertions) { 12 } else { 150 };
    let mut begin = bed();
    let (notes, ended) = compare(&begin, steps);
    assert_eq!(ended, Ok(()));
    let touched = |k: usize| {
        notes
            .iter()
            .any(|note| !note.obstacles[k].touching.is_empty())
    };
    // The ball on top, and the intruder.
    assert!(touched(0) && touched(2));
    assert!(
        notes
            .iter()
            .all(|note| note.forces.iter().any(|f| f[2] < 0.0))
    );
    // With lists that are full at once, and pairs that are searched for again and again.
    let histories = begin.contact_histories();
    begin.outer_skin *= 0.05;
    begin.stepping.tunes = false;
    begin.lend(1);
    begin.resume(&histories).unwrap();
    let (notes, _) = compare(&begin, steps);
    assert_eq!(notes.len() as u64, steps);
}

#[test]
fn a_stretch_that_ends_early_has_notes_of_all_finished_steps() {
    // In the tenth step.
    let (mut begin, id) = bed_that_loses_a_grain();
    begin.start().unwrap();
    let (notes, ended) = compare(&begin, 30);
    assert_eq!((notes.len(), ended), (9, Err(KernelError::Escaped { id })));
    // If it may leave, the step in which it does so is the last one.
    begin.policy = LossPolicy {
        takes_out: true,
        drain: None,
    };
    begin.start().unwrap();
    let (notes, ended) = compare(&begin, 30);
    assert_eq!((notes.len(), ended), (10, Err(KernelError::GrainsLeaving)));
}

/// As many as are kept at once are those of one step here.
#[test]
fn notes_that_fill_their_room_are_read_step_by_step() {
    let (mut one, mut other) = (bed(), bed());
    let few = Watch {
        obstacles: vec![0],
        grains: vec![0, 1],
    };
    let many = Watch {
        obstacles: vec![0],
        grains: [0, 1].repeat(1 << 19),
    };
    let (mut a, mut b) = (Vec::new(), Vec::new());
    one.steps_noted(4, &few, |note| a.push(note.clone()))
        .unwrap();
    other
        .steps_noted(4, &many, |note| {
            let mut note = note.clone();
            note.forces.truncate(2);
            b.push(note);
        })
        .unwrap();
    assert_eq!(a.len(), 4);
    assert_eq!(a, b);
    assert_eq!(one.digest(), other.digest());
}
