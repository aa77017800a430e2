//! Tests 6 to 8: impacts of a spinning sphere along the normal.

use bitgrain_sim::error::Result;

use super::collision::{Collision, Partner};
use super::elastic::WALL;
use super::material::{ALUMINIUM_ALLOY, COPPER, Material, NYLON};
use super::rows::{ImpactRow, impact_table};
use super::series::{Quantity, Series, TOLERANCE, refined};
use crate::benchmark::comparison::Published;
use crate::benchmark::result::{Chart, Check, Curve, Source, Test};

const RADIUS: f64 = 0.1;
const APPROACH: f64 = 0.2;
const RESTITUTION: f64 = 0.5;
const MU: f64 = 0.4;

/// The published values of `3.5 mu (1 + e) v_n / (R w)`, and one beyond each end.
const INVERSE_SPINS: [f64; 19] = [
    0.165, 0.175, 0.35, 0.55, 0.77, 0.97, 1.19, 1.45, 1.74, 2.09, 2.5, 3.0, 3.63, 4.5, 5.75, 7.82,
    11.9, 24.0, 24.5,
];

const KEPT: [&str; 4] = ["inverse_spin", "tan_incident", "beta", "tan_recoil"];

fn collision(
    material: &'static Material,
    stiffness_ratio: f64,
    partner: Option<Partner>,
) -> Collision {
    Collision {
        material,
        stiffness_ratio,
        radius: RADIUS,
        restitution: RESTITUTION,
        mu: MU,
        approach: APPROACH,
        tangential: 0.0,
        spin: 0.0,
        partner,
    }
}

/// What friction takes from the speed of the surface if the contact slides throughout and does not pull.
fn taken() -> f64 {
    3.5 * MU * (1.0 + RESTITUTION) * APPROACH
}

/// Impacts of this kind at all spins are added to a test, and to its rows.
fn add(
    test: &mut Test,
    rows: &mut Vec<ImpactRow>,
    (name, like): (String, Collision),
    published: &Published,
) -> Result<()> {
    let inverse = Quantity {
        key: "inverse_spin",
        label: "3.5 mu (1 + e) v_n/(R w)",
        of: |row| row.inverse_spin,
    };
    let incident = Quantity {
        key: "tan_incident",
        label: "R w/v_n",
        of: |row| row.tan_incident,
    };
    let beta = Quantity {
        key: "beta",
        label: "beta: - v_s after over v_s before",
        of: |row| row.beta,
    };
    let recoil = Quantity {
        key: "tan_recoil",
        label: "v_s/v_n after",
        of: |row| row.tan_recoil,
    };
    let spins = refined(&INVERSE_SPINS, 3).into_iter().map(|x| Collision {
        spin: taken() / (x * RADIUS),
        ..like
    });
    let series = Series::run(name, spins)?;
    let charts = [
        series.chart(
            test.number,
            [inverse, beta],
            |c| taken() / (c.spin * RADIUS) - 1.0,
            published,
        ),
        series.chart(
            test.number,
            [incident, recoil],
            |c| (c.spin * RADIUS - taken()) / (RESTITUTION * APPROACH),
            published,
        ),
    ];
    // Friction acts at the surface, so what it takes from the spin is 5/2 of what it gives to the velocity. The law's
    // lever is shorter by half the overlap, less than a thousandth here.
    let shared = series.rows().map(|row| {
        let turning = RADIUS * (row.spin_in - row.spin_out);
        (-2.5 * row.tangential_out, turning)
    });
    let what = "spin lost, times the radius, m/s";
    let checks = [
        series.check_restitution(),
        Check::worst(&series.name, what, TOLERANCE, shared),
    ];
    test.add(charts, checks);
    rows.extend(series.rows());
    Ok(())
}

/// Test 6.
pub(super) fn on_wall(published: &Published) -> Result<Test> {
    let mut test = Test::new(
        6,
        "Impact of a spinning sphere on a rigid wall",
        "A sphere of radius 0.1 m meets a wall, 1000 times as stiff, at 0.2 m/s, with different spins w; restitution \
         0.5, mu = 0.4. v_n is the speed of its centre, v_s that of its surface along the wall.",
    );
    let mut rows = Vec::new();
    for material in [&ALUMINIUM_ALLOY, &NYLON] {
        let like = (material.name.to_owned(), collision(material, WALL, None));
        add(&mut test, &mut rows, like, published)?;
    }
    test.table = impact_table(&KEPT, &rows);
    Ok(test)
}

/// Test 7.
pub(super) fn alike() -> Result<Test> {
    let mut test = Test::new(
        7,
        "Impact of two identical spheres with opposite spins",
        "Two spheres of radius 0.1 m meet at 0.2 m/s each, with equal and opposite spins: their surfaces do not slide; \
         restitution 0.5, mu = 0.4.",
    );
    let mut rows = Vec::new();
    for material in [&ALUMINIUM_ALLOY, &COPPER] {
        let spins = [0.175, 0.5, 2.0, 5.5, 11.3, 22.9].map(|spin| {
            let partner = Partner {
                radius: RADIUS,
                density: material.density,
                approach: APPROACH,
                spin: -spin,
            };
            Collision {
                spin,
                ..collision(material, 1.0, Some(partner))
            }
        });
        let series = Series::run(material.name, spins)?;
        let spin = series.rows().map(|row| (row.spin_in, row.spin_out));
        // Beside the normal speed, since the tangential one is zero.
        let still = series
            .rows()
            .map(|row| (APPROACH, APPROACH + row.tangential_out));
        let checks = [
            series.check_restitution(),
            Check::worst(material.name, "spin after, rad/s", TOLERANCE, spin),
            Check::worst(
                material.name,
                "no tangential speed, beside the normal one, m/s",
                TOLERANCE,
                still,
            ),
        ];
        let points: Vec<_> = series
            .rows()
            .map(|row| (row.spin_in, row.spin_out))
            .collect();
        let theory = points.iter().map(|p| (p.0, p.0)).collect();
        let chart = Chart {
            title: format!("Test 7, {}", material.name),
            labels: ["spin before (rad/s)".into(), "spin after (rad/s)".into()],
            curves: vec![
                Curve {
                    source: Source::Computed,
                    points,
                },
                Curve {
                    source: Source::Theory,
                    points: theory,
                },
            ],
        };
        test.add([(chart, Vec::new())], checks);
        rows.extend(series.rows());
    }
    test.table = impact_table(&[], &rows);
    Ok(test)
}

/// Test 8.
pub(super) fn on_sphere(published: &Published) -> Result<Test> {
    let mut test = Test::new(
        8,
        "Impact of a spinning sphere on a large resting one",
        "A sphere of radius 0.1 m meets one of radius 0.5 m, 1000 times as dense and at rest, at 0.2 m/s, with \
         different spins; the large one is 1000 times as stiff (A) or equally stiff (B); restitution 0.5, mu = 0.4. \
         Which of both the paper calls A is second-hand.",
    );
    let mut rows = Vec::new();
    for material in [&ALUMINIUM_ALLOY, &NYLON] {
        let partner = Partner {
            radius: 0.5,
            density: 1000.0 * material.density,
            approach: 0.0,
            spin: 0.0,
        };
        for (case, ratio) in [("A", 1000.0), ("B", 1.0)] {
            let name = format!("{}, case {case}", material.name);
            let like = (name, collision(material, ratio, Some(partner)));
            add(&mut test, &mut rows, like, published)?;
        }
    }
    test.table = impact_table(&KEPT, &rows);
    Ok(test)
}
