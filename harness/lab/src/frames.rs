//! Frames of a drag: the grains that a vertical plane through the intruder's centre cuts, at steps close
//! enough together for a moving picture. They are for viewing only: no result is computed from them.

use bitgrain_kernel::Shape;

use bitgrain_sim::motion::{Motion, Moves};
use bitgrain_sim::observe::INTRUDER;
use bitgrain_sim::simulation::{Role, Simulation};
use bitgrain_sim::table::{Cell, Table, column};

/// Reach of a frame round the intruder's centre, over its diameter, and its bounds in mean diameters.
const REACH: (f64, [f64; 2]) = (3.5, [6.0, 12.0]);

/// What the plane cuts of one grain: lengths over the mean grain diameter, from the intruder's centre; speeds
/// over the speed V of the drag, relative to the base.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slice {
    /// Along the drag.
    pub x: f64,
    /// Upward.
    pub z: f64,
    /// Of the circle.
    pub radius: f64,
    /// Of the grain, along x.
    pub u: f64,
    /// And upward.
    pub w: f64,
    /// All three components.
    pub speed: f64,
    /// Whether the grain is free, of the base or of the lid.
    pub role: Role,
}

/// A row of the table.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    step: u64,
    travel: f64,
    cut: Slice,
}

const FRAMES: Table<Row> = Table(&[
    column("step", |r| Cell::Whole(&mut r.step)),
    column("travel", |r| Cell::Thousandths(&mut r.travel)),
    column("x", |r| Cell::Thousandths(&mut r.cut.x)),
    column("z", |r| Cell::Thousandths(&mut r.cut.z)),
    column("radius", |r| Cell::Thousandths(&mut r.cut.radius)),
    column("u", |r| Cell::Thousandths(&mut r.cut.u)),
    column("w", |r| Cell::Thousandths(&mut r.cut.w)),
    column("speed", |r| Cell::Thousandths(&mut r.cut.speed)),
    column("role", |r| Cell::Word(&mut r.cut.role)),
]);

/// The cuts at one step.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Steps since the drag began.
    pub step: u64,
    /// Travel, over the mean grain diameter.
    pub travel: f64,
    /// Circles, in the order of the grains.
    pub cuts: Vec<Slice>,
}

/// How far a frame reaches from the centre of an intruder, to both sides, up and down; all over the mean
/// grain diameter.
pub fn reach(radius: f64) -> f64 {
    let [least, most] = REACH.1;
    (REACH.0 * 2.0 * radius)
        .clamp(least, most)
        .max(3.0 * radius)
}

/// `x` less the multiple of `size` that brings it nearest to zero; unchanged without a size.
pub fn nearest(x: f64, size: f64) -> f64 {
    match size > 0.0 {
        true => x - size * (x / size).round(),
        false => x,
    }
}

/// Height y of the plane: through the intruder's centre. A cylinder looks alike everywhere: it is cut
/// through a row of the lid, not between two.
pub fn plane(sim: &Simulation) -> f64 {
    let body = &sim.obstacles[INTRUDER as usize];
    let y = body.point[1];
    let off = |i: &usize| (sim.position[*i][1] - y).abs();
    let row = (0..sim.count()).filter(|&i| sim.role(i) == Role::Lid);
    match (body.shape, row.min_by(|a, b| off(a).total_cmp(&off(b)))) {
        (Shape::Cylinder { .. }, Some(i)) => sim.position[i][1],
        _ => y,
    }
}

/// The rows of one frame: numbers to a thousandth, which is finer than any screen shows.
pub fn rows(sim: &Simulation, motion: &Motion, step: u64) -> String {
    let d = motion.grain_diameter;
    let body = &sim.obstacles[INTRUDER as usize];
    let (centre, y) = (body.point, plane(sim));
    let reach = reach(body.reach() / d);
    let size = sim.domain.hi();
    let size = [size[0] - sim.domain.lo()[0], size[1] - sim.domain.lo()[1]];
    let half = reach.min(0.5 * size[0] / d);
    let frame = match motion.moves {
        Moves::Intruder => 0.0,
        Moves::Bed => motion.speed,
    };
    let travel = motion.travel(step) / d;
    let mut out = String::new();
    for i in 0..sim.count() {
        let [px, py, pz, radius] = sim.position[i];
        let off = nearest(py - y, size[1]);
        let square = radius * radius - off * off;
        if square <= 0.0 || square.is_nan() {
            continue;
        }
        let radius = square.sqrt() / d;
        let x = nearest(px - centre[0], size[0]) / d;
        let z = (pz - centre[2]) / d;
        let [u, v, w, _] = sim.velocity[i];
        let [u, v, w] = [u - frame, v, w].map(|v| v / motion.speed);
        let speed = (u * u + v * v + w * w).sqrt();
        let role = sim.role(i);
        // A grain at the edge of the box is seen at both.
        for x in [x, x - size[0] / d, x + size[0] / d] {
            if x.abs() < half + radius && z.abs() < reach + radius {
                let cut = Slice {
                    x,
                    z,
                    radius,
                    u,
                    w,
                    speed,
                    role,
                };
                out += &FRAMES.line(&Row { step, travel, cut });
            }
        }
    }
    out
}

/// A table of rows, with its head.
pub fn text(rows: &str) -> String {
    let comment = "lengths over the mean grain diameter, from the intruder's centre; speeds over V, relative to \
                   the base";
    FRAMES.text(comment, &[]) + rows
}

/// Reads a table of frames.
///
/// # Errors
/// The line that is not a row, counted from 1.
pub fn parse(text: &str) -> Result<Vec<Frame>, usize> {
    let mut frames: Vec<Frame> = Vec::new();
    for Row { step, travel, cut } in FRAMES.parse(text)? {
        match frames.last_mut().filter(|frame| frame.step == step) {
            Some(frame) => frame.cuts.push(cut),
            None => frames.push(Frame {
                step,
                travel,
                cuts: vec![cut],
            }),
        }
    }
    Ok(frames)
}

/// Steps of the frames that rows hold.
pub fn steps(rows: &str) -> Vec<u64> {
    let frames = parse(&text(rows)).unwrap_or_default();
    frames.iter().map(|frame| frame.step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_read_as_it_was_written() {
        let rows = "5,0.100,-1.000,0.500,0.400,1.000,0.200,1.200,free\n\
                    5,0.100,0.000,2.000,0.500,0.000,0.000,0.000,base\n\
                    9,0.200,0.000,2.000,0.500,0.000,0.000,0.000,lid\n";
        let frames = parse(&text(rows)).unwrap();
        assert_eq!(steps(rows), [5, 9]);
        assert_eq!(frames.len(), 2);
        assert_eq!((frames[0].step, frames[0].cuts.len()), (5, 2));
        assert_eq!(frames[0].cuts[0].x, -1.0);
        assert_eq!(frames[1].cuts[0].role, Role::Lid);
        assert_eq!(frames[1].travel, 0.2);
        assert_eq!((frames[0].cuts[0].u, frames[0].cuts[0].w), (1.0, 0.2));
        for wrong in [
            "5,0.1,1,1,1,1,1,1",
            "5,0.1,1,1,1,1,1,1,grain",
            "5,nan,1,1,1,1,1,1,free",
        ] {
            assert_eq!(parse(&text(wrong)), Err(3), "{wrong}");
        }
    }

    /// Grains round an intruder near an edge of the box: one beyond the edge, one that the plane misses, one of the
    /// base, one so far away that it is not shown.
    #[test]
    fn rows_are_what_the_plane_cuts() {
        use bitgrain_kernel::{Domain, Group, Obstacle, conformance};

        use bitgrain_sim::simulation::{AnyLaw, Grain};

        let domain = Domain::new([0.0; 3], [20.0, 8.0, 30.0], [true, true, false]).unwrap();
        let grain = |id: u32, group, position, velocity| Grain {
            id,
            group,
            diameter: 1.0,
            density: 1.0,
            position,
            velocity,
            spin: [0.0; 3],
        };
        let grains = [
            grain(1, 0, [0.5, 4.3, 4.0], [1.0, 0.0, 0.5]),
            grain(2, 0, [19.0, 5.0, 6.0], [1.0; 3]),
            grain(3, 1, [18.0, 4.0, 0.5], [0.0; 3]),
            grain(4, 0, [19.0, 4.0, 12.0], [0.0; 3]),
        ];
        let groups = vec![Group::free([0.0; 3]), Group::frozen()];
        let ball = Obstacle::sphere([19.0, 4.0, 3.0], 1.0);
        let law = AnyLaw::HertzHistory(conformance::history(0.0));
        let sim = Simulation::new(law, domain, 1e-3, groups, &grains, vec![ball]);
        let quick = crate::scenario::load("quick", &[]).unwrap();
        let mut plan = quick.drags()[0].clone();
        (plan.motion.speed, plan.motion.dt) = (2.0, sim.dt);
        let still = "50,0.100,1.500,1.000,0.400,0.500,0.250,0.559,free\n\
                     50,0.100,-1.000,-2.500,0.500,0.000,0.000,0.000,base\n";
        assert_eq!(rows(&sim, &plan.motion, 50), still);
        // Relative to a base that moves with V.
        plan.motion.moves = Moves::Bed;
        let moving = rows(&sim, &plan.motion, 50);
        assert!(
            moving.starts_with("50,0.100,1.500,1.000,0.400,-0.500,0.250,0.559"),
            "{moving}"
        );
        assert!(moving.contains("0.500,-1.000,0.000,1.000,base"), "{moving}");
    }
}
