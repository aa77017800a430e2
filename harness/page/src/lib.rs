//! A case in a WebAssembly module: the functions that the page calls. Nothing is imported.
//!
//! The page writes the text of a case to [`room`] and calls [`open`]: the laboratory's own reader checks it and starts
//! it, so that digests are those of `bitgrain replay`. [`advance`] steps it. Rows of grains, bodies and text are read
//! where they lie in the module's memory, from the addresses that the other functions give; any call may move them.
//!
//! A function that can fail returns 1, or 0 and leaves the reason as its [`answer`].

use std::cell::RefCell;
use std::panic;

use bitgrain_kernel::{BITS_VERSION, ContactForce, Obstacle, Partner, vec3};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::notes::Watch;
use bitgrain_sim::simulation::{Simulation, hex};

// The laboratory's own reader of cases, from its sources: the rest of that crate cannot be built for a browser.
#[allow(
    dead_code,
    unused_imports,
    reason = "the page reads no files of cases and makes none"
)]
#[path = "../../lab/src/case/mod.rs"]
mod case;
#[allow(dead_code, reason = "nor does it write any")]
#[path = "../../lab/src/json.rs"]
mod json;
#[allow(dead_code, reason = "nor does it read scenarios")]
#[path = "../../lab/src/parse_errors.rs"]
mod parse_errors;

/// What errors call the text of the page.
const NAME: &str = "case.json";

/// Numbers of a body in [`bodies`]: its point, orientation (w, x, y, z), velocity and the force on it.
const BODY: usize = 13;

/// The case that is open, and what was seen of its last steps.
struct Opened {
    sim: Simulation,
    /// Sum of the normal forces on each grain at the last step that was shown.
    loads: Vec<f64>,
    /// Mean force on the watched body since the last call.
    force: [f64; 3],
    bodies: Vec<[f64; BODY]>,
}

#[derive(Default)]
struct Page {
    text: Vec<u8>,
    opened: Option<Opened>,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
    /// Apart, since a panic may come while the page is borrowed.
    static ANSWER: RefCell<Vec<u8>> = RefCell::default();
}

/// Does something with the case that is open; `otherwise` if there is none.
fn with<T>(otherwise: T, act: impl FnOnce(&mut Opened) -> T) -> T {
    PAGE.with_borrow_mut(|page| page.opened.as_mut().map_or(otherwise, act))
}

/// 1, or 0 and the reason as answer.
fn told(done: Result<()>) -> u32 {
    match done {
        Ok(()) => 1,
        Err(error) => {
            ANSWER.with_borrow_mut(|answer| *answer = error.to_string().into_bytes());
            0
        }
    }
}

/// The version of the arithmetic.
#[unsafe(no_mangle)]
pub extern "C" fn bits_version() -> u32 {
    BITS_VERSION
}

/// Where so many bytes of a case's text are to be written.
#[unsafe(no_mangle)]
pub extern "C" fn room(bytes: usize) -> *mut u8 {
    PAGE.with_borrow_mut(|page| {
        page.text.clear();
        page.text.resize(bytes, 0);
        page.text.as_mut_ptr()
    })
}

/// Where the text of the last answer begins: why a call failed, or a digest.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    ANSWER.with_borrow(|answer| answer.as_ptr())
}

/// Its length in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn answer_length() -> usize {
    ANSWER.with_borrow(Vec::len)
}

/// Opens the case whose text was written. If it is refused, the one before stays open.
#[unsafe(no_mangle)]
pub extern "C" fn open() -> u32 {
    panic::set_hook(Box::new(|what| {
        ANSWER.with_borrow_mut(|answer| *answer = what.to_string().into_bytes());
    }));
    PAGE.with_borrow_mut(|page| {
        let text = std::mem::take(&mut page.text);
        told(started(&text).map(|opened| page.opened = Some(opened)))
    })
}

fn started(text: &[u8]) -> Result<Opened> {
    let text = str::from_utf8(text)
        .map_err(|_| Error::input(NAME, "is not text in UTF-8; expected a case as JSON"))?;
    let case = case::parse(text, NAME)?;
    let mut loads = vec![0.0; case.grains.len()];
    let mut seen = Vec::new();
    let mut sim = case.start(NAME, |contact| seen.push(contact))?;
    add_loads(&mut loads, &seen);
    // The skin is tuned by a clock, which the module does not have. It changes no bit.
    sim.stepping.tunes = false;
    let mut opened = Opened {
        sim,
        loads,
        force: [0.0; 3],
        bodies: Vec::new(),
    };
    opened.show_bodies();
    Ok(opened)
}

fn add_loads(loads: &mut [f64], seen: &[ContactForce<f64>]) {
    loads.fill(0.0);
    for contact in seen {
        loads[contact.i as usize] += contact.normal_force;
        if let Partner::Grain(j) = contact.partner {
            loads[j as usize] += contact.normal_force;
        }
    }
}

impl Opened {
    /// Steps on, with the mean force on a body, and the contacts of the last step.
    fn advance(&mut self, steps: u64, body: u32) -> Result<()> {
        let is_there = (body as usize) < self.sim.obstacles.len();
        let watch = Watch {
            obstacles: is_there.then_some(body).into_iter().collect(),
            grains: Vec::new(),
        };
        let (mut sum, mut seen) = ([0.0; 3], Vec::new());
        let mut add = |force: [f64; 3]| sum = vec3::add(sum, force);
        let mut done = self
            .sim
            .steps_noted(steps.saturating_sub(1), &watch, |note| {
                note.obstacles.iter().for_each(|of| add(of.body.force));
            });
        if done.is_ok() && steps > 0 {
            done = self.sim.step_seen(&mut seen);
            self.sim
                .obstacles
                .get(body as usize)
                .into_iter()
                .for_each(|of| add(of.force));
            add_loads(&mut self.loads, &seen);
        }
        self.force = vec3::scale(sum, 1.0 / steps.max(1) as f64);
        self.show_bodies();
        done.map_err(|fault| Error::run("the case", self.sim.step_count() + 1, fault))
    }

    fn show_bodies(&mut self) {
        let numbers = |body: &Obstacle<f64>| {
            let all = [
                &body.point[..],
                &body.orientation,
                &body.velocity,
                &body.force,
            ]
            .concat();
            std::array::from_fn(|k| all[k])
        };
        self.bodies = self.sim.obstacles.iter().map(numbers).collect();
    }
}

/// Advances by so many steps and takes the mean force on an obstacle over them, by its number; zero if there is none.
#[unsafe(no_mangle)]
pub extern "C" fn advance(steps: u32, body: u32) -> u32 {
    with(0, |opened| told(opened.advance(steps.into(), body)))
}

/// Leaves the digest of the state, in hex, as the answer.
#[unsafe(no_mangle)]
pub extern "C" fn digest() -> u32 {
    with(0, |opened| {
        let digest = opened.sim.digest();
        let digest = digest.map_err(|fault| Error::run("the case", opened.sim.step_count(), fault));
        told(digest.map(|digest| {
            ANSWER.with_borrow_mut(|answer| *answer = hex(&digest.whole).into_bytes());
        }))
    })
}

/// Steps done since the case began.
#[unsafe(no_mangle)]
pub extern "C" fn step_count() -> f64 {
    with(0.0, |opened| opened.sim.step_count() as f64)
}

/// How many grains there are.
#[unsafe(no_mangle)]
pub extern "C" fn count() -> usize {
    with(0, |opened| opened.sim.count())
}

/// How many bodies there are.
#[unsafe(no_mangle)]
pub extern "C" fn body_count() -> usize {
    with(0, |opened| opened.bodies.len())
}

/// Names of the grains, ascending: the order of all rows.
#[unsafe(no_mangle)]
pub extern "C" fn ids() -> *const u32 {
    with(std::ptr::null(), |opened| opened.sim.id.as_ptr())
}

/// Positions and radii, four numbers a grain.
#[unsafe(no_mangle)]
pub extern "C" fn positions() -> *const [f64; 4] {
    with(std::ptr::null(), |opened| opened.sim.position.as_ptr())
}

/// Velocities and masses, four numbers a grain.
#[unsafe(no_mangle)]
pub extern "C" fn velocities() -> *const [f64; 4] {
    with(std::ptr::null(), |opened| opened.sim.velocity.as_ptr())
}

/// Spins, the first three of four numbers a grain.
#[unsafe(no_mangle)]
pub extern "C" fn spins() -> *const [f64; 4] {
    with(std::ptr::null(), |opened| opened.sim.spin.as_ptr())
}

/// Sum of the normal forces on each grain at the last step.
#[unsafe(no_mangle)]
pub extern "C" fn loads() -> *const f64 {
    with(std::ptr::null(), |opened| opened.loads.as_ptr())
}

/// The bodies, thirteen numbers each: point, orientation (w, x, y, z), velocity, and the force of the grains on it.
#[unsafe(no_mangle)]
pub extern "C" fn bodies() -> *const [f64; BODY] {
    with(std::ptr::null(), |opened| opened.bodies.as_ptr())
}

/// The mean force of the last [`advance`] on its body, three numbers.
#[unsafe(no_mangle)]
pub extern "C" fn mean_force() -> *const [f64; 3] {
    with(std::ptr::null(), |opened| &raw const opened.force)
}
