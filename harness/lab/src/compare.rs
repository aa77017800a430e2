//! Where two states first differ: part, body and component, with both numbers to the bit.

use std::fmt;

use bitgrain_kernel::contact::MEMORY_MAX;
use bitgrain_kernel::{ContactHistory, PARTS};

use bitgrain_sim::simulation::Simulation;

/// The first number that differs between two states, in the order in which a digest reads them.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// One of [`PARTS`].
    pub part: &'static str,
    /// The grain, the two grains, the grain and obstacle or the obstacle.
    pub body: String,
    /// Which number of it.
    pub component: &'static str,
    /// The first state's number; NaN if it has none.
    pub first: f64,
    /// The second state's.
    pub second: f64,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (a, b) = (self.first, self.second);
        write!(
            f,
            "{} of {}, {}: {a} (0x{:016x}) against {b} (0x{:016x})",
            self.part,
            self.body,
            self.component,
            a.to_bits(),
            b.to_bits()
        )
    }
}

/// One number of a state and where it belongs.
struct Number {
    part: &'static str,
    body: String,
    component: &'static str,
    value: f64,
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// Words that a law keeps of a contact.
const WORDS: [&str; MEMORY_MAX] = [
    "word 1", "word 2", "word 3", "word 4", "word 5", "word 6", "word 7", "word 8",
];

/// The first difference of two states with equally many grains and obstacles; `None` if they are
/// the same to the bit.
///
/// ```
/// # use bitgrain_lab::{case, compare::first_difference};
/// let text = r#"{"law": {"kind": "hertz_history", "kn": 2e5, "kt": 2.45e5, "gamma_n": 0,
///     "gamma_t": 0, "mu": 0.5}, "dt": 1e-4, "grains": [{"id": 3, "diameter": 1, "density": 1,
///     "position": [0, 0, 0]}]}"#;
/// let mut one = case::parse(text, "text").unwrap().start("text", |_| {}).unwrap();
/// let mut other = one.clone();
/// assert_eq!(first_difference(&mut one, &mut other), None);
/// other.velocity[0][1] = 0.5;
/// let told = first_difference(&mut one, &mut other).unwrap().to_string();
/// assert!(told.starts_with("velocities of grain 3, y: 0 (0x0000000000000000) against 0.5 (0x3fe"));
/// ```
pub fn first_difference(first: &mut Simulation, second: &mut Simulation) -> Option<Difference> {
    let mut theirs = numbers(second).into_iter();
    for one in numbers(first) {
        let other = theirs.next();
        let same_place = other
            .as_ref()
            .is_some_and(|o| o.part == one.part && o.body == one.body);
        let value = match other {
            Some(other) if same_place => other.value,
            // A contact that only one of them has shifts all that follow it.
            other => {
                let theirs =
                    other.map_or("nothing".into(), |o| format!("{} of {}", o.part, o.body));
                return Some(Difference {
                    part: one.part,
                    body: format!("{}, but the other has {theirs}", one.body),
                    component: one.component,
                    first: one.value,
                    second: f64::NAN,
                });
            }
        };
        if one.value.to_bits() != value.to_bits() {
            return Some(Difference {
                part: one.part,
                body: one.body,
                component: one.component,
                first: one.value,
                second: value,
            });
        }
    }
    theirs.next().map(|other| Difference {
        part: other.part,
        body: other.body,
        component: other.component,
        first: f64::NAN,
        second: other.value,
    })
}

/// Every number of a state, in the order of its digest.
fn numbers(sim: &mut Simulation) -> Vec<Number> {
    let mut all = Vec::new();
    let mut put = |part: usize, body: &str, components: &[&'static str], values: &[f64]| {
        for (component, value) in components.iter().zip(values) {
            all.push(Number {
                part: PARTS[part],
                body: body.to_string(),
                component,
                value: *value,
            });
        }
    };
    let grain = |id: u32| format!("grain {id}");
    let n = sim.count();
    for i in 0..n {
        let body = grain(sim.id[i]);
        put(0, &body, &["x", "y", "z", "radius"], &sim.position[i]);
        let image = sim.image[i].map(f64::from);
        put(0, &body, &["image x", "image y", "image z"], &image);
    }
    for i in 0..n {
        let body = grain(sim.id[i]);
        put(1, &body, &["x", "y", "z", "mass"], &sim.velocity[i]);
    }
    for i in 0..n {
        put(2, &grain(sim.id[i]), &AXES, &sim.spin[i]);
    }
    let words = sim.law.words();
    for contact in sim.contact_histories().iter() {
        let body = match contact.history {
            ContactHistory::Pair { i, j, .. } => {
                let [i, j] = [i, j].map(|place| sim.id[place as usize]);
                format!("grains {i} and {j}")
            }
            ContactHistory::Obstacle { i, obstacle, .. } => {
                let id = sim.id[i as usize];
                format!("grain {id} on obstacle {obstacle}")
            }
        };
        let kept = contact.kept();
        put(3, &body, &AXES, &kept.spring);
        put(3, &body, &WORDS[..words], &kept.memory[..words]);
    }
    for i in 0..n {
        let body = grain(sim.id[i]);
        put(4, &body, &["force x", "force y", "force z"], &sim.force[i]);
        put(
            4,
            &body,
            &["torque x", "torque y", "torque z"],
            &sim.torque[i],
        );
    }
    for (k, one) in sim.obstacles.iter().enumerate() {
        let body = format!("obstacle {k}");
        put(5, &body, &["point x", "point y", "point z"], &one.point);
        let image = one.image.map(f64::from);
        put(5, &body, &["image x", "image y", "image z"], &image);
        put(
            5,
            &body,
            &["velocity x", "velocity y", "velocity z"],
            &one.velocity,
        );
        put(5, &body, &["force x", "force y", "force z"], &one.force);
        put(5, &body, &["torque x", "torque y", "torque z"], &one.torque);
    }
    all
}
