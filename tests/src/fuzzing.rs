//! Bodies of the fuzz targets: nothing that comes in as bytes may panic or hang, what is sound
//! goes out and comes in again as it was, and every state of a run is finite.
//!
//! Each returns whether the bytes were sound (something was read, or at least one step done), so
//! that the replay of the committed corpus cannot pass by refusing everything.

use std::path::Path;

use bitgrain::case::{self, BoxSpec, Case, GrainSpec, MotionSpec, ObstacleSpec};
use bitgrain::flow::{flow_text, parse_flow, parse_profile};
use bitgrain::lammps::{Atom, DataFile, data_text, dump_text, parse_atoms, parse_data, parse_dump};
use bitgrain::law::{LawSpec, RAYLEIGH_FRACTION_MAX};
use bitgrain::scenario::{self, Measure};
use bitgrain::series::{parse_series, series_text};
use bitgrain::sim::Sim;
use bitgrain::units::Units;

/// Steps of one contact: enough for it to open, slide and close again.
const CONTACT_STEPS: u8 = 200;
/// Steps of a case.
const CASE_STEPS: u64 = 20;
/// Larger cases are read and written but not stepped, so that an input takes milliseconds.
const CASE_GRAINS: usize = 64;

/// One contact over many steps, under parameters drawn from the bytes: two grains, the first at an
/// obstacle or not, in open space or across a periodic edge, twice with different skins.
pub fn contact(data: &[u8]) -> bool {
    let mut bytes = Bytes(data);
    let drawn = contact_case(&mut bytes);
    let text = serde_json::to_string(&drawn).expect("a case can be written");
    if text.contains("null") {
        // A drawn number is not finite, which JSON cannot say.
        return false;
    }
    let Ok(read) = case::parse(&text, "fuzz") else {
        return false;
    };
    assert_eq!(read, drawn, "a case changes on the way through JSON");
    let Ok(mut sim) = read.start("fuzz", |_| {}) else {
        return false;
    };
    let mut twin = sim.clone();
    let wider = [0.0, 0.3, 3.0][bytes.below(3)];
    (twin.skin, twin.reach) = (twin.skin * wider, twin.reach * wider);
    twin.start().expect("the same start with another skin");
    let steps = 1 + bytes.byte() % CONTACT_STEPS;
    for step in 0..steps {
        let (one, other) = (sim.steps(1), twin.steps(1));
        assert_eq!(one, other, "a fault depends on the skin");
        if one.is_err() {
            return step > 0;
        }
        assert_finite(&sim);
    }
    assert_eq!(sim.digest(), twin.digest(), "a bit depends on the skin");
    true
}

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
    let (beds, runs) = (read.beds(), read.runs());
    assert!(!beds.is_empty() && !runs.is_empty(), "nothing to do");
    assert!(runs.iter().all(|run| run.bed < beds.len()));
    let again = scenario::parse(&read.to_toml(), "fuzz", &[], Path::new(""));
    assert_eq!(again.expect("a scenario reads back"), read);
    true
}

/// A table of a run's folder, the force series, the flow series or the profile: read, every number is
/// finite, and the two series give the same rows when they are written and read again.
pub fn series(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    let mut sound = false;
    if let Ok(rows) = parse_flow(text) {
        let again = parse_flow(&flow_text(&units(), &rows));
        let again = again.expect("a flow series reads back");
        assert_same_rows(&again, &rows);
        sound |= !rows.is_empty();
    }
    if let Ok(rows) = parse_series(text, "fuzz") {
        let again = series_text(&units(), &Measure::default(), &rows);
        let again = parse_series(&again, "fuzz").expect("a force series reads back");
        assert_same_rows(&again, &rows);
        sound |= !rows.is_empty();
    }
    if let Ok(layers) = parse_profile(text) {
        let finite = |&(low, high, speed): &(f64, f64, f64)| {
            [low, high, speed].iter().all(|x| x.is_finite())
        };
        assert!(layers.iter().all(finite), "{layers:?}");
        sound |= !layers.is_empty();
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

/// The debug form tells the two zeros apart, which equality does not, and names what is not finite.
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

fn assert_finite(sim: &Sim) {
    let rows = [
        &sim.position,
        &sim.velocity,
        &sim.spin,
        &sim.force,
        &sim.torque,
    ];
    for row in rows.into_iter().flatten() {
        assert!(row.iter().all(|x| x.is_finite()), "{row:?}");
    }
    for body in &sim.obstacles {
        let parts = [body.point, body.velocity, body.force, body.torque];
        assert!(parts.iter().flatten().all(|x| x.is_finite()), "{body:?}");
    }
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

/// Bytes as choices; beyond their end there are zeros.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        *first
    }

    fn below(&mut self, count: u8) -> usize {
        usize::from(self.byte() % count)
    }

    /// From `lo` to `hi` in 65,536 places.
    fn between(&mut self, lo: f64, hi: f64) -> f64 {
        let word = u16::from_le_bytes([self.byte(), self.byte()]);
        lo + (hi - lo) * f64::from(word) / 65535.0
    }

    /// From 10^lo to 10^hi; now and then any number at all.
    fn scale(&mut self, lo: f64, hi: f64) -> f64 {
        if self.byte() < 250 {
            return 10f64.powf(self.between(lo, hi));
        }
        let word = std::array::from_fn(|_| self.byte());
        f64::from_bits(u64::from_le_bytes(word))
    }

    /// Zero, one time in four, or a scale.
    fn zero_or_scale(&mut self, lo: f64, hi: f64) -> f64 {
        match self.below(4) {
            0 => 0.0,
            _ => self.scale(lo, hi),
        }
    }

    fn vector(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.between(-1.0, 1.0))
    }

    /// A direction of length 1.
    fn direction(&mut self) -> [f64; 3] {
        unit(self.vector())
    }

    fn law(&mut self) -> LawSpec {
        if self.below(2) == 0 {
            LawSpec::HertzHistory {
                kn: self.scale(2.0, 10.0),
                kt: self.zero_or_scale(2.0, 10.0),
                gamma_n: self.zero_or_scale(0.0, 6.0),
                gamma_t: self.zero_or_scale(0.0, 6.0),
                mu: self.zero_or_scale(-2.0, 2.0),
            }
        } else {
            LawSpec::HertzTsuji {
                young: self.scale(3.0, 11.0),
                poisson: self.between(-0.9, 0.5),
                restitution: self.between(0.01, 1.0),
                mu: self.zero_or_scale(-2.0, 2.0),
            }
        }
    }

    fn motion(&mut self, speed: f64) -> MotionSpec {
        match self.below(8) {
            0 => MotionSpec::Frozen,
            1 => MotionSpec::Carried(self.vector().map(|v| v * speed)),
            2 => MotionSpec::Weightless,
            3 => {
                let [x, y, _] = self.vector();
                MotionSpec::Lid([x * speed, y * speed])
            }
            _ => MotionSpec::Free,
        }
    }
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    if length > 0.0 {
        v.map(|x| x / length)
    } else {
        [0.0, 0.0, 1.0]
    }
}

/// `from + direction * distance`.
fn beyond(from: [f64; 3], direction: [f64; 3], distance: f64) -> [f64; 3] {
    std::array::from_fn(|a| from[a] + direction[a] * distance)
}

/// Two grains about to touch or touching, the first with an obstacle beside it or not.
fn contact_case(bytes: &mut Bytes) -> Case {
    let law = bytes.law();
    let size = bytes.scale(-4.0, 4.0);
    let density = bytes.scale(-3.0, 4.0);
    let sizes = [size, size * bytes.between(0.2, 5.0)];
    let body = size * bytes.between(0.2, 10.0);
    let smallest = 0.5 * sizes[0].min(sizes[1]);
    let dt =
        RAYLEIGH_FRACTION_MAX * law.rayleigh_time(smallest, density) * bytes.between(0.01, 1.0);
    // Up to one and a half radii a step.
    let speed = bytes.scale(-7.0, 0.2) * smallest / dt;
    let length = 4.0 * (body + sizes[0] + sizes[1]);
    let axis_periodic = [bytes.below(2) == 0, bytes.below(2) == 0, false];
    let bounds = (bytes.below(3) > 0).then_some(BoxSpec {
        lo: [0.0; 3],
        hi: [length, length, 2.0 * length],
        periodic: axis_periodic,
    });
    let centre = [
        length * bytes.between(0.0, 0.999),
        length * bytes.between(0.0, 0.999),
        length,
    ];
    let (obstacle, normal, radius) = obstacle(bytes, &bounds, centre, body, speed);
    let overlap = bytes.between(-0.1, 0.3) * sizes[0];
    let first = beyond(centre, normal, radius + 0.5 * sizes[0] - overlap);
    let overlap = bytes.between(-0.1, 0.3) * smallest;
    let second = beyond(
        first,
        bytes.direction(),
        0.5 * (sizes[0] + sizes[1]) - overlap,
    );
    let mut grain = |id: u32, diameter: f64, position: [f64; 3]| {
        let motion = bytes.motion(speed);
        // Along which axes it may have a velocity of its own, and whether it may spin.
        let (moves, spins) = match motion {
            MotionSpec::Free | MotionSpec::Weightless => ([1.0; 3], 1.0),
            MotionSpec::Lid(_) => ([0.0, 0.0, 1.0], 1.0),
            MotionSpec::Frozen | MotionSpec::Carried(_) => ([0.0; 3], 0.0),
        };
        let mut drawn = |scale: f64, may: [f64; 3]| -> [f64; 3] {
            let v = bytes.vector();
            std::array::from_fn(|a| v[a] * scale * may[a])
        };
        GrainSpec {
            id,
            diameter,
            density,
            position,
            velocity: drawn(speed, moves),
            spin: drawn(speed / diameter, [spins; 3]),
            motion,
        }
    };
    let grains = vec![grain(1, sizes[0], first), grain(7, sizes[1], second)];
    Case {
        law,
        bounds,
        gravity: [0.0, 0.0, -bytes.zero_or_scale(-3.0, 2.0)],
        dt,
        obstacles: obstacle.into_iter().collect(),
        grains,
    }
}

/// An obstacle of each shape or none, the direction from it to the first grain, and its radius.
fn obstacle(
    bytes: &mut Bytes,
    bounds: &Option<BoxSpec>,
    center: [f64; 3],
    diameter: f64,
    speed: f64,
) -> (Option<ObstacleSpec>, [f64; 3], f64) {
    let shape = bytes.below(4);
    let velocity = bytes.vector().map(|v| v * speed);
    let direction = bytes.direction();
    // In a box with periodic axes planes face up and bars lie along an axis.
    let upright = bounds.is_some_and(|b| b.periodic.contains(&true));
    match shape {
        0 => {
            let normal = if upright { [0.0, 0.0, 1.0] } else { direction };
            let plane = ObstacleSpec::Plane {
                point: center,
                normal,
                velocity,
            };
            (Some(plane), normal, 0.0)
        }
        1 => {
            let density = (bytes.below(2) == 0).then(|| bytes.scale(-3.0, 4.0));
            let sphere = ObstacleSpec::Sphere {
                center,
                diameter,
                density,
                velocity,
            };
            (Some(sphere), direction, 0.5 * diameter)
        }
        2 => {
            let lying = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]][bytes.below(3)];
            let axis = if upright { lying } else { bytes.direction() };
            let along = (0..3).map(|a| direction[a] * axis[a]).sum::<f64>();
            let across = unit(beyond(direction, axis, -along));
            let cylinder = ObstacleSpec::Cylinder {
                center,
                axis,
                diameter,
                velocity,
            };
            (Some(cylinder), across, 0.5 * diameter)
        }
        _ => (None, direction, 0.0),
    }
}
