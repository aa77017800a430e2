//! The tables of the tests.

use bitgrain_sim::table::{Cell, Table, column, optional};

use super::collision::{Collision, Outcome};
use super::material::Name;

/// An elastic impact at one instant (tests 1 and 2).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CourseRow {
    material: Name,
    time: f64,
    overlap: f64,
    force: f64,
    force_theory: f64,
    force_of_overlap_theory: f64,
}

/// Time, overlap and force of an elastic impact, and what theory gives at that time and at that overlap.
pub(super) const COURSE: Table<CourseRow> = Table(&[
    column("material", |r| Cell::Word(&mut r.material)),
    column("time", |r| Cell::Real(&mut r.time)),
    column("overlap", |r| Cell::Real(&mut r.overlap)),
    column("force", |r| Cell::Real(&mut r.force)),
    column("force_theory", |r| Cell::Real(&mut r.force_theory)),
    column("force_of_overlap_theory", |r| {
        Cell::Real(&mut r.force_of_overlap_theory)
    }),
]);

/// The units of [`COURSE`].
pub(super) const COURSE_UNITS: &str = "time s; overlap m; forces N";

impl CourseRow {
    /// The steps of an elastic impact.
    pub fn of(collision: &Collision, outcome: &Outcome) -> Vec<Self> {
        let (hertz, course) = (collision.hertz(), collision.hertz().course());
        let rows = outcome.samples.iter().map(|s| Self {
            material: Name(collision.material.name),
            time: s.time,
            overlap: s.overlap,
            force: s.force,
            force_theory: hertz.force(course.overlap(s.time)),
            force_of_overlap_theory: hertz.force(s.overlap),
        });
        rows.collect()
    }

    /// Overlap, force and force of theory at that overlap.
    pub fn against_overlap(&self) -> [f64; 3] {
        [self.overlap, self.force, self.force_of_overlap_theory]
    }

    /// Time, force and force of theory at that time.
    pub fn against_time(&self) -> [f64; 3] {
        [self.time, self.force, self.force_theory]
    }
}

/// An impact as a whole (tests 3 to 8). Speeds are of the sphere relative to its partner, the spin is the sphere's own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ImpactRow {
    pub material: Name,
    pub stiffness_ratio: f64,
    pub restitution: f64,
    pub normal_in: f64,
    pub tangential_in: f64,
    pub spin_in: f64,
    pub normal_out: f64,
    pub tangential_out: f64,
    pub spin_out: f64,
    pub surface_out: f64,
    pub duration: f64,
    pub peak_overlap: f64,
    pub peak_force: f64,
    pub slides: u32,
    pub normal_restitution: f64,
    /// Angle of the path from the normal, degrees.
    pub incident_angle: Option<f64>,
    /// `v_t / (mu v_n)`.
    pub scaled_speed: Option<f64>,
    /// `3.5 mu (1 + e) v_n / (R w)`.
    pub inverse_spin: Option<f64>,
    /// `R w / v_n`.
    pub tan_incident: Option<f64>,
    /// `v_t` after over that before.
    pub tangential_restitution: Option<f64>,
    /// `atan(v_s / v_n)` after, degrees; `v_s` is the speed of the surface.
    pub rebound_angle: Option<f64>,
    /// `v_s / (mu v_n)` after.
    pub recoil_speed: Option<f64>,
    /// `R w / (mu v_n)` after, with `v_n` before.
    pub scaled_spin: Option<f64>,
    /// `- v_s` after over that before.
    pub beta: Option<f64>,
    /// `v_s / v_n` after.
    pub tan_recoil: Option<f64>,
}

/// The columns that a test may leave out.
const SOME: [&str; 10] = [
    "incident_angle",
    "scaled_speed",
    "inverse_spin",
    "tan_incident",
    "tangential_restitution",
    "rebound_angle",
    "recoil_speed",
    "scaled_spin",
    "beta",
    "tan_recoil",
];

const IMPACT: Table<ImpactRow> = Table(&[
    column("material", |r| Cell::Word(&mut r.material)),
    column("stiffness_ratio", |r| Cell::Real(&mut r.stiffness_ratio)),
    column("restitution", |r| Cell::Real(&mut r.restitution)),
    column("normal_in", |r| Cell::Real(&mut r.normal_in)),
    column("tangential_in", |r| Cell::Real(&mut r.tangential_in)),
    column("spin_in", |r| Cell::Real(&mut r.spin_in)),
    column("normal_out", |r| Cell::Real(&mut r.normal_out)),
    column("tangential_out", |r| Cell::Real(&mut r.tangential_out)),
    column("spin_out", |r| Cell::Real(&mut r.spin_out)),
    column("surface_out", |r| Cell::Real(&mut r.surface_out)),
    column("duration", |r| Cell::Real(&mut r.duration)),
    column("peak_overlap", |r| Cell::Real(&mut r.peak_overlap)),
    column("peak_force", |r| Cell::Real(&mut r.peak_force)),
    column("slides", |r| Cell::Count(&mut r.slides)),
    column("normal_restitution", |r| {
        Cell::Real(&mut r.normal_restitution)
    }),
    optional("incident_angle", |r| Cell::Optional(&mut r.incident_angle)),
    optional("scaled_speed", |r| Cell::Optional(&mut r.scaled_speed)),
    optional("inverse_spin", |r| Cell::Optional(&mut r.inverse_spin)),
    optional("tan_incident", |r| Cell::Optional(&mut r.tan_incident)),
    optional("tangential_restitution", |r| {
        Cell::Optional(&mut r.tangential_restitution)
    }),
    optional("rebound_angle", |r| Cell::Optional(&mut r.rebound_angle)),
    optional("recoil_speed", |r| Cell::Optional(&mut r.recoil_speed)),
    optional("scaled_spin", |r| Cell::Optional(&mut r.scaled_spin)),
    optional("beta", |r| Cell::Optional(&mut r.beta)),
    optional("tan_recoil", |r| Cell::Optional(&mut r.tan_recoil)),
]);

/// The text of a table of impacts with these of the columns that a test may leave out.
pub(super) fn impact_table(kept: &[&str], rows: &[ImpactRow]) -> String {
    let left_out: Vec<&str> = SOME
        .into_iter()
        .filter(|name| !kept.contains(name))
        .collect();
    let units = "normal and tangential speeds m/s; spins rad/s; duration s; overlap m; force N; angles degrees; \
                 slides 1 if friction is at its limit at every step; other numbers have no unit";
    IMPACT.text_without(&left_out, units, rows)
}

impl ImpactRow {
    /// The row of an impact, with every number that any test has.
    pub fn of(collision: &Collision, outcome: &Outcome) -> Self {
        let (before, after) = (outcome.before, outcome.after);
        let Collision {
            mu, restitution, ..
        } = *collision;
        let speed = -before.normal;
        let some = |x: f64| x.is_finite().then_some(x);
        let degrees = |angle: f64| angle * 180.0 / core::f64::consts::PI;
        let turning = collision.radius * before.spin;
        Self {
            material: Name(collision.material.name),
            stiffness_ratio: collision.stiffness_ratio,
            restitution,
            normal_in: before.normal,
            tangential_in: before.tangential,
            spin_in: before.spin,
            normal_out: after.normal,
            tangential_out: after.tangential,
            spin_out: after.spin,
            surface_out: after.surface,
            duration: outcome.duration,
            peak_overlap: outcome.largest(|s| s.overlap),
            peak_force: outcome.largest(|s| s.force),
            slides: u32::from(outcome.slides(mu)),
            normal_restitution: after.normal / speed,
            incident_angle: some(degrees(libm::atan2(before.tangential, speed))),
            scaled_speed: some(before.tangential / (mu * speed)),
            inverse_spin: some(3.5 * mu * (1.0 + restitution) * speed / turning),
            tan_incident: some(turning / speed),
            tangential_restitution: some(after.tangential / before.tangential),
            rebound_angle: some(degrees(libm::atan2(after.surface, after.normal))),
            recoil_speed: some(after.surface / (mu * after.normal)),
            scaled_spin: some(collision.radius * after.spin / (mu * speed)),
            beta: some(-after.surface / before.surface),
            tan_recoil: some(after.surface / after.normal),
        }
    }
}
