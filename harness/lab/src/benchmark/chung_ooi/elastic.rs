//! Tests 1 to 3: impacts along the normal.

use bitgrain_sim::error::Result;

use super::collision::{Collision, Outcome, Partner};
use super::material::{
    ALUMINIUM_ALLOY_2, ALUMINIUM_OXIDE, CAST_IRON, GLASS, LIMESTONE, MAGNESIUM_ALLOY, Material,
};
use super::rows::{COURSE, COURSE_UNITS, CourseRow, impact_table};
use super::series::{Series, TOLERANCE};
use crate::benchmark::comparison::Published;
use crate::benchmark::result::{Chart, Check, Comparison, Curve, Source, Test};

/// A wall is 1000 times as stiff as the sphere: what the benchmark's rigid plane is in other programs.
pub(super) const WALL: f64 = 1000.0;

/// Rows of a chart: as many as can be told apart.
const SHOWN: usize = 60;

/// Test 1.
pub(super) fn spheres(published: &Published) -> Result<Test> {
    let collision = |material: &'static Material| Collision {
        material,
        stiffness_ratio: 1.0,
        radius: 0.01,
        restitution: 1.0,
        mu: 0.35,
        approach: 10.0,
        tangential: 0.0,
        spin: 0.0,
        partner: Some(Partner {
            radius: 0.01,
            density: material.density,
            approach: 10.0,
            spin: 0.0,
        }),
    };
    let setup = "Two spheres of radius 0.01 m meet at 10 m/s each; restitution 1, mu = 0.35.";
    let cases = [collision(&GLASS), collision(&LIMESTONE)];
    elastic(
        1,
        "Elastic impact of two identical spheres",
        setup,
        &cases,
        published,
    )
}

/// Test 2.
pub(super) fn wall(published: &Published) -> Result<Test> {
    let collision = |material| Collision {
        material,
        stiffness_ratio: WALL,
        radius: 0.1,
        restitution: 1.0,
        mu: 0.0,
        approach: 0.2,
        tangential: 0.0,
        spin: 0.0,
        partner: None,
    };
    let setup = "A sphere of radius 0.1 m meets a wall, 1000 times as stiff, at 0.2 m/s; restitution 1, no friction.";
    let cases = [collision(&ALUMINIUM_ALLOY_2), collision(&MAGNESIUM_ALLOY)];
    elastic(
        2,
        "Elastic impact of a sphere on a rigid wall",
        setup,
        &cases,
        published,
    )
}

fn elastic(
    number: u32,
    title: &'static str,
    setup: &str,
    cases: &[Collision],
    published: &Published,
) -> Result<Test> {
    let mut test = Test::new(number, title, setup);
    let mut rows = Vec::new();
    for collision in cases {
        let outcome = collision.run()?;
        let own = CourseRow::of(collision, &outcome);
        test.checks
            .extend(elastic_checks(collision, &outcome, &own));
        test.charts
            .extend(elastic_charts(number, collision.material.name, &own));
        let peak = outcome.largest(|s| s.force);
        let theirs = published.of((number, "peak_force", collision.material.name), 1.0);
        test.comparisons.extend(theirs.filter_map(|curve| {
            let value = curve.points.first()?.1;
            let off = (peak - value).abs() / value;
            Some(Comparison {
                quantity: "peak_force",
                material: collision.material.name.into(),
                with: curve.by.clone(),
                range: "all",
                points: 1,
                span: value,
                mean: off,
                largest: off,
            })
        }));
        rows.extend(own);
    }
    test.table = COURSE.text(COURSE_UNITS, &rows);
    Ok(test)
}

/// Peaks, duration, and both curves at every step; those over the peak, since forces go to zero.
fn elastic_checks(collision: &Collision, outcome: &Outcome, rows: &[CourseRow]) -> Vec<Check> {
    let (hertz, name) = (collision.hertz(), collision.material.name);
    let peak = hertz.force(hertz.deepest());
    let one =
        |what, expected, measured| Check::worst(name, what, TOLERANCE, [(expected, measured)]);
    let curve = |what, of: fn(&CourseRow) -> [f64; 3]| {
        let pairs = rows.iter().map(|row| {
            let [_, force, theory] = of(row);
            (peak, peak + force - theory)
        });
        Check::worst(name, what, TOLERANCE, pairs)
    };
    vec![
        one("peak force, N", peak, outcome.largest(|s| s.force)),
        one(
            "deepest overlap, m",
            hertz.deepest(),
            outcome.largest(|s| s.overlap),
        ),
        one("duration, s", hertz.course().duration(), outcome.duration),
        one(
            "normal speed after over before",
            1.0,
            outcome.after.normal / hertz.speed,
        ),
        curve(
            "force against overlap, over the peak",
            CourseRow::against_overlap,
        ),
        curve("force against time, over the peak", CourseRow::against_time),
    ]
}

/// Over overlaps in micrometres and times in microseconds.
fn elastic_charts(number: u32, material: &str, rows: &[CourseRow]) -> [Chart; 2] {
    let every = rows.len().div_ceil(SHOWN).max(1);
    let chart = |label: &str, of: fn(&CourseRow) -> [f64; 3]| {
        let shown = || rows.iter().step_by(every).map(of);
        Chart {
            title: format!("Test {number}, {material}"),
            labels: [label.into(), "normal force (N)".into()],
            curves: vec![
                Curve {
                    source: Source::Computed,
                    points: shown().map(|[x, force, _]| (1e6 * x, force)).collect(),
                },
                Curve {
                    source: Source::Theory,
                    points: shown().map(|[x, _, theory]| (1e6 * x, theory)).collect(),
                },
            ],
        }
    };
    [
        chart("overlap (\u{b5}m)", CourseRow::against_overlap),
        chart("time (\u{b5}s)", CourseRow::against_time),
    ]
}

/// Test 3.
pub(super) fn restitution() -> Result<Test> {
    let collision = |material, restitution| Collision {
        material,
        stiffness_ratio: WALL,
        radius: 0.0025,
        restitution,
        mu: 0.0,
        approach: 3.9,
        tangential: 0.0,
        spin: 0.0,
        partner: None,
    };
    let mut test = Test::new(
        3,
        "Restitution on a rigid wall",
        "A sphere of radius 0.0025 m meets a wall, 1000 times as stiff, at 3.9 m/s; restitution 0.2 to 1, no friction.",
    );
    let mut rows = Vec::new();
    for material in [&ALUMINIUM_OXIDE, &CAST_IRON] {
        let asked = [0.2, 0.4, 0.6, 0.8, 1.0];
        let series = Series::run(material.name, asked.map(|e| collision(material, e)))?;
        let points = series
            .rows()
            .map(|row| (row.restitution, row.normal_restitution));
        let chart = Chart {
            title: format!("Test 3, {}", material.name),
            labels: [
                "restitution asked for".into(),
                "rebound speed over impact speed".into(),
            ],
            curves: vec![
                Curve {
                    source: Source::Computed,
                    points: points.collect(),
                },
                Curve {
                    source: Source::Theory,
                    points: asked.map(|e| (e, e)).to_vec(),
                },
            ],
        };
        test.add([(chart, Vec::new())], [series.check_restitution()]);
        rows.extend(series.rows());
    }
    test.table = impact_table(&[], &rows);
    Ok(test)
}
