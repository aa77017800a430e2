//! The load that grains put on a cylinder, by angle (Guillard 2014, section IV and eq. A4).
//!
//! The angle theta is 0 at the front, where grains come from, and 0 to pi/2 in the bottom front quarter.

use serde::{Deserialize, Serialize};

/// Points round the cylinder: the paper's M.
pub const POINTS: usize = 64;
/// Standard deviation of the Gaussian that shares a force out among them, in radians: the paper's 8 degrees.
pub const WIDTH: f64 = 8.0 / 180.0 * std::f64::consts::PI;
/// Of `(1/2) integral s sin^2 theta d theta`, which is a force over `L D`, eq. 4 makes a lift over buoyancy.
const SIMPLE: f64 = 2.0 / std::f64::consts::PI;
/// Equal parts of the averaging window, from which errors come.
pub const PARTS: usize = 8;

/// Angle of point `m`: `(m + 1/2) 2 pi/M`.
pub fn theta(m: usize) -> f64 {
    (m as f64 + 0.5) * (2.0 * std::f64::consts::PI / POINTS as f64)
}

/// Of a force, what each point gets: Gaussian weights whose sum is 1.
pub fn weights(angle: f64) -> [f64; POINTS] {
    let turn = 2.0 * std::f64::consts::PI;
    let mut all = [0.0; POINTS];
    let mut sum = 0.0;
    for (m, weight) in all.iter_mut().enumerate() {
        let off = theta(m) - angle;
        let off = (off - turn * (off / turn).round()) / WIDTH;
        *weight = libm::exp(-0.5 * (off * off));
        sum += *weight;
    }
    all.map(|weight| weight / sum)
}

/// Forces on a cylinder, shared out among the points and summed over samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadSums {
    /// Of each part of the window: how many samples.
    samples: [u64; PARTS],
    /// And the sums of the forces, along the flow and up, point by point.
    force: Vec<Vec<[f64; 2]>>,
    /// The sums of the forces themselves, not shared out.
    whole: [Sum; PARTS],
}

/// Sums over contacts with a cylinder, each at its own angle. Divided by the number of samples, and by `L D`,
/// these are stresses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sum {
    /// Force along the flow.
    pub drag: f64,
    /// Force up.
    pub lift: f64,
    /// The same by normal forces alone.
    pub normal_drag: f64,
    /// And up.
    pub normal_lift: f64,
    /// Normal force times `sin^2 theta`: of it eq. 4 makes a lift.
    pub sine_square: f64,
}

impl Sum {
    /// The length of the force without the contacts' normal forces, over that of the whole.
    pub fn tangential_part(&self) -> f64 {
        let length = |x: f64, z: f64| (x * x + z * z).sqrt();
        let rest = length(self.drag - self.normal_drag, self.lift - self.normal_lift);
        rest / length(self.drag, self.lift)
    }

    /// What eq. 4 makes of these normal forces: over the pressure, lift over buoyancy.
    pub fn simple_lift(&self) -> f64 {
        SIMPLE * self.sine_square
    }
}

impl Default for LoadSums {
    fn default() -> Self {
        Self {
            samples: [0; PARTS],
            force: vec![vec![[0.0; 2]; POINTS]; PARTS],
            whole: [Sum::default(); PARTS],
        }
    }
}

impl LoadSums {
    /// Whether the sums have as many points and parts as they should: they may come from a file.
    pub fn is_whole(&self) -> bool {
        self.force.len() == PARTS && self.force.iter().all(|part| part.len() == POINTS)
    }

    /// Adds a sample of part `part`: angles of contacts, with the forces on the cylinder along the flow and up.
    pub fn add(&mut self, part: usize, contacts: &[(f64, [f64; 2])]) {
        self.samples[part] += 1;
        for (angle, force) in contacts {
            let (sin, cos) = (libm::sin(*angle), libm::cos(*angle));
            let normal = force[0] * cos + force[1] * sin;
            let whole = &mut self.whole[part];
            whole.drag += force[0];
            whole.lift += force[1];
            whole.normal_drag += normal * cos;
            whole.normal_lift += normal * sin;
            whole.sine_square += normal * (sin * sin);
            for (sum, weight) in self.force[part].iter_mut().zip(weights(*angle)) {
                sum[0] += weight * force[0];
                sum[1] += weight * force[1];
            }
        }
    }

    /// Mean stresses on a cylinder of this diameter and length; `None` if a part of the window has no
    /// sample.
    pub fn load(&self, diameter: f64, length: f64) -> Option<Load> {
        if self.samples.contains(&0) {
            return None;
        }
        let area = length * diameter * std::f64::consts::PI / POINTS as f64;
        let mut load = Load::default();
        for m in 0..POINTS {
            let (sin, cos) = (libm::sin(theta(m)), libm::cos(theta(m)));
            // The flow goes against the outward normal at the front; up is against it at the bottom.
            let normal = |f: [f64; 2]| (f[0] * cos + f[1] * sin) / area;
            let tangential = |f: [f64; 2]| (f[0] * sin - f[1] * cos) / area;
            let parts = |of: &dyn Fn([f64; 2]) -> f64| -> Vec<f64> {
                let each = self.force.iter().zip(self.samples);
                each.map(|(part, n)| of(part[m]) / n as f64).collect()
            };
            let whole = |of: &dyn Fn([f64; 2]) -> f64| {
                let n: u64 = self.samples.iter().sum();
                let sum = |a: usize| self.force.iter().map(|part| part[m][a]).sum::<f64>();
                of([sum(0), sum(1)]) / n as f64
            };
            load.normal.push(whole(&normal));
            load.normal_error.push(error(&parts(&normal)));
            load.tangential.push(whole(&tangential));
            load.tangential_error.push(error(&parts(&tangential)));
        }
        let each = self.whole.iter().zip(self.samples);
        load.parts = each
            .map(|(sum, n)| {
                let over = |x: f64| x / (n as f64 * length * diameter);
                Sum {
                    drag: over(sum.drag),
                    lift: over(sum.lift),
                    normal_drag: over(sum.normal_drag),
                    normal_lift: over(sum.normal_lift),
                    sine_square: over(sum.sine_square),
                }
            })
            .collect();
        Some(load)
    }
}

/// Standard error of the mean of independent values.
fn error(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (squares / (n - 1.0) / n).sqrt()
}

/// Stress on a cylinder at [`POINTS`] angles, mean over the averaging window.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Along the inward normal: positive in compression (force over length^2).
    pub normal: Vec<f64>,
    /// Its standard error, from eight parts of the window.
    pub normal_error: Vec<f64>,
    /// In the plane x, z, along growing angle: with the flow below, against it above.
    pub tangential: Vec<f64>,
    /// Its standard error.
    pub tangential_error: Vec<f64>,
    /// Forces over `L D`, mean over each of the eight parts, from contacts at their own angles: what is shared out
    /// over angles turns a fiftieth of a normal force into a tangential one.
    pub parts: Vec<Sum>,
}

impl Load {
    /// `(1/2) integral s(theta) w(theta) d theta` over the whole turn.
    fn half_integral(s: &[f64], w: fn(f64) -> f64) -> f64 {
        let width = std::f64::consts::PI / POINTS as f64;
        s.iter()
            .enumerate()
            .map(|(m, s)| s * w(theta(m)) * width)
            .sum()
    }

    /// Drag and lift over `L D`: the sums of the stresses, normal and tangential parts together.
    pub fn forces(&self) -> [f64; 2] {
        let (n, t) = (&self.normal, &self.tangential);
        [
            Self::half_integral(n, libm::cos) + Self::half_integral(t, libm::sin),
            Self::half_integral(n, libm::sin) - Self::half_integral(t, libm::cos),
        ]
    }

    /// What `of` gives for the whole window, mean over its parts, and its standard error from them.
    pub fn mean(&self, of: impl Fn(&Sum) -> f64) -> (f64, f64) {
        let values: Vec<f64> = self.parts.iter().map(of).collect();
        (
            values.iter().sum::<f64>() / values.len() as f64,
            error(&values),
        )
    }

    /// Mean of the normal stress over points whose angle from `angle` is within `half`.
    pub fn normal_near(&self, angle: f64, half: f64) -> f64 {
        let turn = 2.0 * std::f64::consts::PI;
        let off = |m: &usize| {
            let off = theta(*m) - angle;
            (off - turn * (off / turn).round()).abs()
        };
        let near: Vec<usize> = (0..POINTS).filter(|m| off(m) <= half).collect();
        near.iter().map(|&m| self.normal[m]).sum::<f64>() / near.len() as f64
    }
}

/// The odd part of a stress: `[s(theta) - s(-theta)]/2`.
pub fn odd(s: &[f64]) -> Vec<f64> {
    let last = s.len().saturating_sub(1);
    (0..s.len()).map(|m| 0.5 * (s[m] - s[last - m])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The stress of which the paper's figures speak, 15 cos theta at the front and nothing behind: eq. 4 makes
    /// (1/pi) 15 (2/3) buoyancies of it, and the drag is (1/2) 15 (pi/2). Pushes at ten thousand angles are an
    /// integral to a part in a million.
    #[test]
    fn a_cosine_at_the_front_gives_its_closed_forms() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let width = 2.0 * quarter / 10_000.0;
        let push = |k: u32| {
            let angle = (f64::from(k) + 0.5) * width - quarter;
            // On a cylinder of diameter and length 1.
            let force = 15.0 * libm::cos(angle) * 0.5 * width;
            (angle, [force * libm::cos(angle), force * libm::sin(angle)])
        };
        let pushes: Vec<(f64, [f64; 2])> = (0..10_000).map(push).collect();
        let mut sums = LoadSums::default();
        (0..PARTS).for_each(|part| sums.add(part, &pushes));
        let load = sums.load(1.0, 1.0).unwrap();
        let lift = load.mean(Sum::simple_lift).0;
        assert!((lift - 10.0 / std::f64::consts::PI).abs() < 1e-5, "{lift}");
        let drag = load.mean(|s| s.normal_drag).0;
        assert!((drag - 7.5 * quarter).abs() < 1e-5, "{drag}");
        assert!((lift - 3.18).abs() < 0.01 && (drag - 11.8).abs() < 0.03);
        // Its smoothed front is a little below 15.
        assert!((14.0..15.0).contains(&load.normal_near(0.0, 0.1)));
    }

    #[test]
    fn weights_add_up_and_are_alike_across_the_seam() {
        for angle in [0.0, 0.01, 3.0, 6.2, -0.3] {
            let sum: f64 = weights(angle).iter().sum();
            assert!((sum - 1.0).abs() < 1e-14, "{sum}");
        }
        let all = weights(0.0);
        for m in 0..POINTS / 2 {
            assert!((all[m] - all[POINTS - 1 - m]).abs() < 1e-15);
        }
        assert!(all[0] > all[1] && all[20] < 1e-20);
    }

    /// For any forces added, the stresses add up to their sum: to rounding, and along both axes.
    #[test]
    fn stresses_come_to_the_forces() {
        let mut sums = LoadSums::default();
        let mut all = [0.0; 2];
        let mut samples = 0.0;
        for part in 0..PARTS {
            for k in 0..=part {
                let x = (7 * part + k) as f64;
                let force = [3.0 + libm::sin(x), libm::cos(2.0 * x)];
                sums.add(part, &[(x, force), (0.3 * x, [0.1, -0.2])]);
                all = [all[0] + force[0] + 0.1, all[1] + force[1] - 0.2];
                samples += 1.0;
            }
        }
        let (d, l) = (3.3, 5.0);
        let load = sums.load(d, l).unwrap();
        let forces = load.forces();
        for a in 0..2 {
            let mean = all[a] / samples;
            assert!((forces[a] * d * l - mean).abs() < 1e-12 * mean.abs().max(1.0));
        }
        assert!(load.normal_error.iter().all(|e| *e >= 0.0));
        // The contacts themselves say so too: parts are of unequal length, each is its own mean.
        let last = &load.parts[PARTS - 1];
        let own: f64 = (0..PARTS)
            .map(|k| 3.1 + libm::sin((7 * (PARTS - 1) + k) as f64))
            .sum();
        assert!((last.drag * d * l - own / PARTS as f64).abs() < 1e-12);
        assert!(sums.is_whole());
        // A part of the window without a sample has no mean.
        let mut half = LoadSums::default();
        half.add(0, &[]);
        assert_eq!(half.load(d, l), None);
    }

    /// Drag and lift over `L D` of the normal stresses alone.
    fn normal_forces(load: &Load) -> [f64; 2] {
        [libm::cos, libm::sin].map(|w| Load::half_integral(&load.normal, w))
    }

    /// A push straight on the front is all drag and all normal, one on the bottom lift; one along the surface
    /// is tangential.
    #[test]
    fn angles_are_those_of_the_paper() {
        let only = |angle: f64, force| {
            let mut sums = LoadSums::default();
            (0..PARTS).for_each(|part| sums.add(part, &[(angle, force)]));
            sums.load(1.0, 1.0).unwrap()
        };
        let quarter = std::f64::consts::FRAC_PI_2;
        let front = only(0.0, [1.0, 0.0]);
        assert!(front.normal_near(0.0, 0.1) > 1.0 && front.normal_near(2.0 * quarter, 1.0) < 1e-9);
        // Sharing out over 8 degrees leaves the mean of cos^2, 1 - 0.14^2, of a push.
        let near = |got: [f64; 2], want: [f64; 2]| {
            assert!((0..2).all(|a| (got[a] - want[a]).abs() < 0.021), "{got:?}");
        };
        near(normal_forces(&front), [1.0, 0.0]);
        near(normal_forces(&only(quarter, [0.0, 1.0])), [0.0, 1.0]);
        let grazing = only(quarter, [1.0, 0.0]);
        near(normal_forces(&grazing), [0.0, 0.0]);
        near(grazing.forces(), [1.0, 0.0]);
        let part = |load: &Load| load.mean(Sum::tangential_part).0;
        assert!((part(&grazing) - 1.0).abs() < 1e-12 && part(&front) < 1e-12);
        assert!(part(&only(2.5, [-libm::cos(2.5), -libm::sin(2.5)])) < 1e-12);
        let bottom = only(quarter, [0.0, 1.0]);
        assert!((bottom.mean(|s| s.sine_square).0 - 1.0).abs() < 1e-12);
        assert!(front.mean(|s| s.sine_square).0 < 1e-12);
        assert!(grazing.tangential[POINTS / 4] > 0.0);
    }

    #[test]
    fn odd_parts_are_odd() {
        let s: Vec<f64> = (0..POINTS)
            .map(|m| 2.0 + libm::cos(theta(m)) + 3.0 * libm::sin(theta(m)))
            .collect();
        for (m, odd) in odd(&s).iter().enumerate() {
            assert!((odd - 3.0 * libm::sin(theta(m))).abs() < 1e-12);
        }
    }
}
