//! Checkpoints from bytes, and checkpoints of states that no run would reach.

use std::sync::OnceLock;

use bitgrain::bed::PouringState;
use bitgrain::case;
use bitgrain::checkpoint::{bytes, parse};
use bitgrain::drag::Dragging;
use bitgrain::simulation::Simulation;

use super::bytes::Bytes;
use super::finite::assert_finite;

/// Steps of what was read.
const STEPS: u64 = 4;

/// Small states to begin from: three grains and every obstacle by one law, a lid under the other.
const CASES: [&str; 2] = [
    r#"{"law": {"kind": "hertz_history", "kn": 2e5, "kt": 2.45e5, "gamma_n": 792.4, "gamma_t": 792.4, "mu": 0.5},
        "box": {"lo": [0, 0, 0], "hi": [6, 6, 9], "periodic": [true, true, false]},
        "gravity": [0, 0, -1], "dt": 2e-4,
        "obstacles": [{"shape": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]},
            {"shape": "sphere", "center": [1, 2, 1.2], "diameter": 1.5, "density": 1, "velocity": [1, 0, 0]},
            {"shape": "cylinder", "center": [5, 0, 2], "axis": [0, 1, 0], "diameter": 2}],
        "grains": [{"id": 1, "diameter": 1, "density": 1, "position": [2.24, 2, 1.2]},
            {"id": 4, "diameter": 1, "density": 1, "position": [2.24, 2.99, 1.2], "motion": "frozen"},
            {"id": 7, "diameter": 0.8, "density": 2, "position": [2.24, 1.2, 0.8], "velocity": [0, 1, 0]}]}"#,
    r#"{"law": {"kind": "hertz_tsuji", "young": 5e6, "poisson": 0.45, "restitution": 0.6, "mu": 0.5},
        "dt": 1e-5,
        "grains": [{"id": 1, "diameter": 1, "density": 1, "position": [0, 0, 0], "motion": {"carried": [2, 0, 0]}},
            {"id": 2, "diameter": 1, "density": 1, "position": [0.1, 0, 0.994], "motion": {"lid": [2, 0]}},
            {"id": 9, "diameter": 1, "density": 1, "position": [0.1, 0.995, 0.994], "motion": "weightless"}]}"#,
];

/// Bytes of a checkpoint after a 0; after anything else, changes to a sound state that is sealed again
/// so that the checks behind the seal are reached; after a 255, the unfinished stage that
/// a checkpoint holds. What is read steps on, and is written
/// and read again to the same bytes.
pub fn checkpoint(data: &[u8]) -> bool {
    let Some((choice, rest)) = data.split_first() else {
        return false;
    };
    match choice {
        0 => goes_on(rest),
        255 => under_way(rest),
        _ => goes_on(&altered(usize::from(choice - 1), Bytes(rest))),
    }
}

/// An unfinished stage, a drag's or a bed's, as its checkpoint holds it.
fn under_way(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    let drag = serde_json::from_str::<Dragging>(text);
    let bed = serde_json::from_str::<PouringState>(text);
    for note in [
        drag.as_ref().map(Dragging::note),
        bed.as_ref().map(PouringState::note),
    ]
    .into_iter()
    .flatten()
    {
        let again = [
            Dragging::of(&note).map(|d| d.note()),
            PouringState::of(&note).map(|c| c.note()),
        ];
        assert!(again.iter().flatten().all(|again| *again == note));
    }
    drag.is_ok() || bed.is_ok()
}

/// The small states after a few steps, with contacts and histories, and their checkpoints.
fn states() -> &'static [(Simulation, Vec<u8>)] {
    static STATES: OnceLock<Vec<(Simulation, Vec<u8>)>> = OnceLock::new();
    STATES.get_or_init(|| {
        let state = |text: &&str| {
            let case = case::parse(text, "fuzz").expect("a sound case");
            let mut sim = case.start("fuzz", |_| {}).expect("a sound state");
            sim.steps(5).expect("sound steps");
            let written = bytes(&mut sim, "").expect("sound arithmetic");
            (sim, written)
        };
        CASES.iter().map(state).collect()
    })
}

/// Reads, steps, writes and reads again.
fn goes_on(data: &[u8]) -> bool {
    let Ok(mut read) = parse(data, "fuzz", None) else {
        return false;
    };
    assert_finite(&read);
    same_when_read_again(&mut read);
    let sizes: Vec<_> = read.position.iter().map(|x| x[3].to_bits()).collect();
    let masses: Vec<_> = read.velocity.iter().map(|v| v[3].to_bits()).collect();
    for _ in 0..STEPS {
        if read.steps(1).is_err() {
            return true;
        }
        assert_finite(&read);
    }
    assert!(
        read.position.iter().map(|x| x[3].to_bits()).eq(sizes),
        "a grain grew"
    );
    assert!(
        read.velocity.iter().map(|v| v[3].to_bits()).eq(masses),
        "a grain's mass changed"
    );
    same_when_read_again(&mut read);
    true
}

fn same_when_read_again(sim: &mut Simulation) {
    let written = bytes(sim, "a recipe").expect("sound arithmetic");
    let mut again = parse(&written, "fuzz", Some("a recipe")).expect("a checkpoint reads back");
    assert!(
        bytes(&mut again, "a recipe").expect("sound arithmetic") == written,
        "a checkpoint changes on its way"
    );
    assert!(parse(&written, "fuzz", Some("another")).is_err());
}

/// A checkpoint with bytes changed, or of a state with numbers changed.
fn altered(choice: usize, mut from: Bytes) -> Vec<u8> {
    let states = states();
    let (sim, written) = &states[choice % states.len()];
    if choice.is_multiple_of(5) {
        let mut written = written.clone();
        for _ in 0..1 + from.below(8) {
            let place = usize::from(u16::from_le_bytes([from.byte(), from.byte()])) % written.len();
            match from.below(4) {
                0 => written.truncate(place.max(1)),
                1 => written.insert(place, from.byte()),
                _ => written[place] = from.byte(),
            }
        }
        return written;
    }
    let mut sim = sim.clone();
    for _ in 0..from.below(5) {
        alter(&mut sim, &mut from);
    }
    bytes(&mut sim, "").expect("sound arithmetic")
}

/// Changes one thing of a state. Lists stay as long as each other: the writer guarantees it.
fn alter(sim: &mut Simulation, from: &mut Bytes) {
    let i = from.below(sim.count() as u8);
    let (word, number) = (from.below(4), any(from));
    match from.below(16) {
        0 => sim.position[i][word] = number,
        1 => sim.velocity[i][word] = number,
        2 => sim.spin[i][word] = number,
        3 => sim.force[i][word] = number,
        4 => sim.torque[i][word] = number,
        5 => sim.image[i][word % 3] = [i32::MAX, i32::MIN, 7, -1][from.below(4)],
        6 => sim.id[i] = u32::from_le_bytes([0; 4].map(|_| from.byte())),
        7 => sim.group[i] = from.byte(),
        8 => sim.dt = number,
        9 => sim.set_step_count([u64::MAX, u64::MAX - 2, 0, 1 << 53][from.below(4)]),
        10 => {
            let Some(group) = sim.groups.get_mut(i) else {
                return;
            };
            match from.below(4) {
                0 => group.gravity[word % 3] = number,
                1 => group.infinite_mass ^= true,
                2 => group.spins ^= true,
                _ => group.integrates[word % 3] ^= true,
            }
        }
        11 => sim.groups.truncate(word),
        12 => sim.position[i] = sim.position[word % sim.id.len()],
        13 => sim.obstacles.truncate(word),
        _ => {
            let Some(body) = sim.obstacles.get_mut(i) else {
                return;
            };
            match from.below(6) {
                0 => body.point[word % 3] = number,
                1 => body.velocity[word % 3] = number,
                2 => body.inverse_mass = number,
                3 => body.force[word % 3] = number,
                4 => body.torque[word % 3] = number,
                _ => body.image[word % 3] = [i32::MAX, i32::MIN, 7, -1][from.below(4)],
            }
        }
    }
}

/// Any number that a file can hold: NaN and the infinite ones among them.
fn any(from: &mut Bytes) -> f64 {
    match from.below(4) {
        0 => from.between(-2.0, 9.0),
        1 => [
            0.0,
            -0.0,
            f64::NAN,
            f64::INFINITY,
            f64::MAX,
            -f64::MAX,
            5e-324,
            1e-9,
        ][from.below(8)],
        2 => from.scale(-12.0, 12.0),
        _ => f64::from_le_bytes([0; 8].map(|_| from.byte())),
    }
}
