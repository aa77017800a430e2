//! Frictionless drags over those of the paper's Table I, the only absolute drags that it gives in numbers (Kumar
//! 2018, section III C).

use serde::{Deserialize, Serialize};

use super::beds::larger;
use super::exponents::near;
use super::speeds::drag;
use super::yields::PLATEAU_MU;
use super::{Curve, Point, Reading, Scaling, Value};

/// Diameter D in d, and a, b and c of `F = a + b Fr^c` in rho d^3 g (Kumar 2018, Table I).
pub const TABLE_ONE: [[f64; 4]; 6] = [
    [1.0, 17.294, 102.832, 0.22],
    [2.0, 182.943, 104.124, 0.773],
    [3.0, 304.399, 192.047, 0.662],
    [4.0, 442.263, 312.832, 0.591],
    [5.0, 663.476, 358.956, 0.728],
    [6.0, 802.574, 584.3, 0.549],
];

/// Depths of the paper's intruder in d between which its bed leaves the choice: 70,000 grains of packing fraction 0.64
/// and 0.606 fill a box of 40 d x 40 d to 36.1 d and 38.2 d, and it lies at z = 13.5 d (Kumar 2018, section II).
pub const DEPTHS: [f64; 2] = [22.6, 24.7];

/// Exponent of depth of drags that were measured near the paper's depth, if a campaign has no second depth to find its
/// own from: that of a hydrostatic pressure, which the paper calls nearly true without friction (section III H), give
/// or take what beds of other depths of ours are off it.
const HYDROSTATIC: Value = Value {
    value: 1.0,
    error: 0.1,
};

/// Largest distance of a depth from the paper's, as the logarithm of their ratio, over which that is enough: drags are
/// uncertain by a hundredth of themselves then.
const NEAR_DEPTH: f64 = 0.1;

/// Froude numbers between which drags are compared: the paper fits its law up to 1, and the least that its figure shows
/// is not told.
const FROUDE: [f64; 2] = [0.25, 1.0];

/// The drags on one intruder over the paper's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableOne {
    /// Diameter D in mean diameters.
    pub diameter: f64,
    /// Depth h that the drags were measured at, in mean diameters.
    pub depth: f64,
    /// Exponent of depth that brings them to the paper's.
    pub alpha: Value,
    /// Which mean the drags are: with nothing cut, as the paper averages (Fig. 4), if the errors of all of those are
    /// known; else without the start-up.
    pub reading: Reading,
    /// Froude number, drag brought to the middle of the paper's depths, and that over the paper's.
    pub points: Vec<(f64, Value, Value)>,
    /// The paper's depths, least and largest.
    pub depths: [f64; 2],
    /// Mean of the ratios if the paper's depth is the least, and if it is the largest: errors of the drags alone.
    pub at_depths: [Value; 2],
    /// Mean of the ratios at the middle of the paper's depths, with the errors of the drags, of alpha, and of the
    /// paper's depth, which lies anywhere between the two.
    pub ratio: Value,
}

/// The law of Table I at a Froude number; `None` of a diameter that is not in it.
pub fn law(diameter: f64, froude: f64) -> Option<f64> {
    let [_, a, b, c] = TABLE_ONE.into_iter().find(|row| near(row[0], diameter))?;
    Some(a + b * libm::pow(froude, c))
}

/// The ratio for each diameter, in the stiffest frictionless grains that it was dragged through, at the depth that is
/// nearest to the paper's.
pub(super) fn table_one(curves: &[Curve], scalings: &[Scaling]) -> Vec<TableOne> {
    let off = |c: &Curve| libm::log(middle() / (c.depth / c.mean_diameter)).abs();
    let better = |b: &Curve, a: &Curve| {
        b.material.kn > a.material.kn || b.material == a.material && off(b) < off(a)
    };
    let all = TABLE_ONE.iter().filter_map(|row| {
        let slick = curves
            .iter()
            .filter(|c| c.material.mu < PLATEAU_MU && near(c.diameter / c.mean_diameter, row[0]));
        let curve = slick.reduce(|a, b| if better(b, a) { b } else { a })?;
        let scaling = scalings.iter().find(|s| s.material == curve.material)?;
        let alpha = scaling
            .depth_exponent()
            .or((off(curve) < NEAR_DEPTH).then_some(HYDROSTATIC));
        compared(curve, alpha?, row[0])
    });
    all.collect()
}

fn middle() -> f64 {
    0.5 * (DEPTHS[0] + DEPTHS[1])
}

fn compared(curve: &Curve, alpha: Value, diameter: f64) -> Option<TableOne> {
    let depth = curve.depth / curve.mean_diameter;
    let brought = |to: f64, drag: Value| drag.times(libm::pow(to / depth, alpha.value));
    let within = |p: &&Point| p.froude >= FROUDE[0] && p.froude <= FROUDE[1];
    let inside = || curve.points.iter().filter(within);
    let reading = match inside().all(|p| p.uncut.is_some()) {
        true => Reading::Uncut,
        false => Reading::Cut,
    };
    let points: Vec<(f64, Value, Value)> = inside()
        .filter_map(|p| {
            let drag = brought(middle(), drag(p, reading, None)?);
            Some((p.froude, drag, drag.divided(law(diameter, p.froude)?)))
        })
        .collect();
    let ratios: Vec<Value> = points.iter().map(|point| point.2).collect();
    if ratios.is_empty() {
        return None;
    }
    // Drags of one bed are alike: a mean of several is known no better than one of them.
    let (mean, _) = larger(&ratios);
    let own = mean.error * (ratios.len() as f64).sqrt();
    let mean = Value::new(mean.value, own);
    let at = |to: f64| mean.times(libm::pow(to / middle(), alpha.value));
    // Standard deviation of a number that lies anywhere in an interval.
    let paper = alpha.value * (DEPTHS[1] - DEPTHS[0]) / 12.0_f64.sqrt() / middle();
    let far = alpha.error * libm::log(middle() / depth);
    let relative = (mean.relative() * mean.relative() + paper * paper + far * far).sqrt();
    Some(TableOne {
        diameter,
        depth,
        alpha,
        reading,
        depths: DEPTHS,
        at_depths: DEPTHS.map(at),
        ratio: Value::new(mean.value, mean.value * relative),
        points,
    })
}

#[cfg(test)]
mod tests {
    use super::super::curves::Material;
    use super::super::point::ErrorOf;
    use super::super::scaling::scaling;
    use super::super::yields::yield_of;
    use super::*;
    use crate::fit::synthetic::normal;
    use bitgrain_sim::random::{Purpose, uniforms};

    /// Drags of the paper's law on D = 2 at this depth, where the paper's own is `paper`; the bed makes all of them
    /// larger by the part `off`.
    fn curve(depth: f64, paper: f64, off: f64) -> Curve {
        let point = |froude: f64| Point {
            name: "m/r".into(),
            beds: 1,
            error_of: ErrorOf::Blocks,
            digest: String::new(),
            speed: froude,
            froude,
            depth,
            drag: Value::new(1.0, 1.0),
            uncut: {
                let drag = law(2.0, froude).unwrap() * depth / paper * (1.0 + off);
                Some(Value::new(drag, 0.05 * drag))
            },
            by_travel: vec![],
            discard: 2.0,
            plug_ratio: 0.1,
            angle: None,
            new_angle: None,
            kappa: None,
            within: vec![],
            floating: None,
            moving: None,
            drift: None,
            coordination: vec![],
        };
        let points: Vec<Point> = [0.15, 0.3, 0.6, 0.9, 1.5].map(point).into();
        Curve {
            material: Material {
                kn: 2e6,
                gamma_n: 3e3,
                mu: 0.0,
            },
            diameter: 2.0,
            mean_diameter: 1.0,
            depth_asked: depth,
            depth,
            runs: points.clone(),
            points,
        }
    }

    #[test]
    fn the_papers_own_drags_have_the_ratio_one() {
        let alpha = Value::new(1.0, 0.0);
        let found = compared(&curve(8.0, middle(), 0.0), alpha, 2.0).unwrap();
        assert_eq!((found.points.len(), found.reading), (3, Reading::Uncut));
        assert!((found.ratio.value - 1.0).abs() < 1e-12);
        // Of one drag the mean with nothing cut has no error: all are then those of the window.
        let mut mixed = curve(8.0, middle(), 0.0);
        for point in &mut mixed.points {
            point.drag = point.uncut.unwrap().times(2.0);
        }
        mixed.points[2].uncut = None;
        let window = compared(&mixed, alpha, 2.0).unwrap();
        assert!((window.ratio.value - 2.0).abs() < 1e-12 && window.reading == Reading::Cut);
        let [least, most] = found.at_depths;
        assert!(
            (least.value - 22.6 / 23.65).abs() < 1e-12 && (most.value - 24.7 / 23.65).abs() < 1e-12
        );
        // 5 % of one bed, and 2.1 d / sqrt(12) of 23.65 d.
        assert!((found.ratio.error - (0.05f64.powi(2) + 0.025_63_f64.powi(2)).sqrt()).abs() < 1e-4);
        assert!(compared(&curve(8.0, 23.0, 0.0), alpha, 7.0).is_none());
    }

    /// Without an exponent of its own a drag is compared near the paper's depth, and nowhere else; of two stiffnesses
    /// the larger counts.
    #[test]
    fn near_the_papers_depth_no_other_depth_is_needed() {
        let scalings = |curves: &[Curve]| -> Vec<Scaling> {
            let own = |c: &Curve| scaling(c.material, &[(c, &yield_of(c))]);
            curves.iter().map(own).collect()
        };
        let at = |depth| {
            let curves = [curve(depth, middle(), 0.0)];
            table_one(&curves, &scalings(&curves))
        };
        let found = at(24.5);
        assert_eq!(found.len(), 1);
        assert!((found[0].ratio.value - 1.0).abs() < 1e-12 && found[0].alpha == HYDROSTATIC);
        assert!(at(16.0).is_empty());
        let mut curves = [curve(24.5, middle(), 0.0), curve(24.5, middle(), 0.2)];
        curves[1].material.kn *= 100.0;
        let found = table_one(&curves, &scalings(&curves));
        assert!((found[0].ratio.value - 1.2).abs() < 1e-12, "{found:?}");
    }

    /// A bed that is off by its error, a depth of the paper anywhere between the two, an exponent that is off by its
    /// error: the truth lies within two errors in 93 to 97 % of 1,000 draws.
    #[test]
    fn the_error_holds_bed_depth_and_exponent() {
        let mut held = 0;
        for seed in 0..1000 {
            let [x] = uniforms::<1>(77, Purpose::Shift, seed as u32);
            let paper = DEPTHS[0] + x * (DEPTHS[1] - DEPTHS[0]);
            let alpha = Value::new(1.0 + 0.04 * normal(seed, 1), 0.04);
            let found = compared(&curve(8.0, paper, 0.05 * normal(seed, 0)), alpha, 2.0).unwrap();
            held += usize::from((found.ratio.value - 1.0).abs() <= 2.0 * found.ratio.error);
        }
        assert!((930..=970).contains(&held), "{held}");
    }
}
