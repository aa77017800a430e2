//! Tests 4 and 5: oblique impacts on a rigid wall.

use bitgrain_sim::error::Result;

use super::collision::Collision;
use super::elastic::WALL;
use super::material::{ALUMINIUM_ALLOY, ALUMINIUM_OXIDE, Material, POLYETHYLENE, STEEL};
use super::rows::impact_table;
use super::series::{Done, Quantity, Series, TOLERANCE, refined};
use crate::benchmark::comparison::Published;
use crate::benchmark::result::{Check, Test};

/// What a contact that slides throughout takes from the motion along the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sliding {
    /// From the velocity, m/s: `mu (1 + e) v_n`.
    speed: f64,
    /// From the spin times the radius, m/s: 2.5 times that, by the part of the radius that the lever has.
    turning: f64,
}

impl Sliding {
    fn of(c: &Collision) -> Self {
        let speed = c.mu * (1.0 + c.restitution) * c.approach;
        let lever = 1.0 - 0.5 * c.hertz().mean_overlap() / c.radius;
        Self {
            speed,
            turning: 2.5 * speed * lever,
        }
    }

    /// Speed of the surface after.
    fn surface(&self, c: &Collision) -> f64 {
        c.tangential - self.speed - self.turning
    }
}

/// Both parts of the motion of all contacts that slide throughout.
fn checks(series: &Series) -> [Check; 3] {
    let check = |what, of: fn(&Done) -> (f64, f64)| {
        Check::worst(&series.name, what, TOLERANCE, series.sliding().map(of))
    };
    let speed = |done: &Done| {
        let row = &done.row;
        let taken = row.tangential_in - row.tangential_out;
        (Sliding::of(&done.collision).speed, taken)
    };
    let turning = |done: &Done| {
        let taken = -done.collision.radius * done.row.spin_out;
        (Sliding::of(&done.collision).turning, taken)
    };
    [
        series.check_restitution(),
        check("tangential speed lost by sliding, m/s", speed),
        check("spin gained by sliding, times the radius, m/s", turning),
    ]
}

const ANGLE: Quantity = Quantity {
    key: "incident_angle",
    label: "angle of incidence (degrees)",
    of: |row| row.incident_angle,
};

/// Test 4.
pub(super) fn angles(published: &Published) -> Result<Test> {
    let collision = |material: &'static Material, degrees: f64| {
        let angle = degrees * core::f64::consts::PI / 180.0;
        Collision {
            material,
            stiffness_ratio: WALL,
            radius: 0.0025,
            restitution: 0.98,
            mu: 0.092,
            approach: 3.9 * libm::cos(angle),
            tangential: 3.9 * libm::sin(angle),
            spin: 0.0,
            partner: None,
        }
    };
    // The published angles, and one beyond each end.
    let angles = [
        1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 50.0, 60.0, 70.0, 80.0, 85.0, 86.0,
    ];
    let restitution = Quantity {
        key: "tangential_restitution",
        label: "v_t after over v_t before",
        of: |row| row.tangential_restitution,
    };
    let spin = Quantity {
        key: "final_spin",
        label: "spin after (rad/s)",
        of: |row| Some(row.spin_out),
    };
    let rebound = Quantity {
        key: "rebound_angle",
        label: "rebound angle (degrees)",
        of: |row| row.rebound_angle,
    };
    let mut test = Test::new(
        4,
        "Oblique impact on a rigid wall at different angles",
        "A sphere of radius 0.0025 m meets a wall, 1000 times as stiff, at 3.9 m/s, 1 to 86 degrees from the normal; \
         restitution 0.98, mu = 0.092. v_t is the speed of its centre along the wall; the rebound angle is that of \
         the surface.",
    );
    let mut rows = Vec::new();
    for material in [&ALUMINIUM_OXIDE, &ALUMINIUM_ALLOY] {
        let all = refined(&angles, 4);
        let series = Series::run(
            material.name,
            all.into_iter().map(|a| collision(material, a)),
        )?;
        let charts = [
            series.chart(
                4,
                [ANGLE, restitution],
                |c| 1.0 - Sliding::of(c).speed / c.tangential,
                published,
            ),
            series.chart(
                4,
                [ANGLE, spin],
                |c| -Sliding::of(c).turning / c.radius,
                published,
            ),
            series.chart(
                4,
                [ANGLE, rebound],
                |c| {
                    let after = Sliding::of(c).surface(c);
                    libm::atan2(after, c.restitution * c.approach) * 180.0 / core::f64::consts::PI
                },
                published,
            ),
        ];
        test.add(charts, checks(&series));
        rows.extend(series.rows());
    }
    test.table = impact_table(
        &["incident_angle", "tangential_restitution", "rebound_angle"],
        &rows,
    );
    Ok(test)
}

/// Test 5.
pub(super) fn speeds(published: &Published) -> Result<Test> {
    const MU: f64 = 0.3;
    const APPROACH: f64 = 5.0;
    let collision = |material: &'static Material, scaled: f64| Collision {
        material,
        stiffness_ratio: WALL,
        radius: 1e-5,
        restitution: 1.0,
        mu: MU,
        approach: APPROACH,
        tangential: scaled * MU * APPROACH,
        spin: 0.0,
        partner: None,
    };
    // The published ratios, and one beyond each end.
    let ratios = [
        0.05, 0.0665, 0.33, 0.67, 1.0, 1.33, 1.67, 2.0, 2.35, 3.0, 3.33, 4.0, 5.0, 6.0, 7.0, 8.0,
        10.0, 13.0, 20.0, 20.5,
    ];
    let speed = Quantity {
        key: "scaled_speed",
        label: "v_t/(mu v_n)",
        of: |row| row.scaled_speed,
    };
    let recoil = Quantity {
        key: "recoil_speed",
        label: "v_s/(mu v_n) after",
        of: |row| row.recoil_speed,
    };
    let spin = Quantity {
        key: "final_spin",
        label: "R w/(mu v_n) after",
        of: |row| row.scaled_spin,
    };
    let mut test = Test::new(
        5,
        "Oblique impact on a rigid wall at different tangential speeds",
        "A sphere of radius 0.01 mm meets a wall, 1000 times as stiff, at a normal speed of 5 m/s; restitution 1, \
                mu = 0.3. v_n and v_t are \
         speeds of its centre, v_s that of its surface along the wall, w is the spin.",
    );
    let mut rows = Vec::new();
    for material in [&STEEL, &POLYETHYLENE] {
        let all = refined(&ratios, 3);
        let series = Series::run(
            material.name,
            all.into_iter().map(|x| collision(material, x)),
        )?;
        let unit = MU * APPROACH;
        let charts = [
            series.chart(
                5,
                [speed, recoil],
                |c| Sliding::of(c).surface(c) / unit,
                published,
            ),
            series.chart(
                5,
                [speed, spin],
                |c| -Sliding::of(c).turning / unit,
                published,
            ),
        ];
        test.add(charts, checks(&series));
        rows.extend(series.rows());
    }
    test.table = impact_table(&["scaled_speed", "recoil_speed", "scaled_spin"], &rows);
    Ok(test)
}
