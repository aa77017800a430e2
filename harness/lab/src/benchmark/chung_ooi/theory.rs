//! Closed forms of an impact of two elastic spheres (Hertz 1882; Landau and Lifshitz, Theory of Elasticity, section 9).

/// An elastic impact along the normal, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hertz {
    /// `(4/3) E* sqrt(R)`: the force is this times `overlap^(3/2)`.
    pub stiffness: f64,
    /// Effective mass.
    pub mass: f64,
    /// Relative speed at which the bodies meet.
    pub speed: f64,
}

/// Parts that the way from the deepest overlap to none is cut into: the integral is good to 1e-7.
const PARTS: usize = 2000;

impl Hertz {
    /// The deepest overlap: all energy is in the spring, `m v^2/2 = (2/5) k overlap^(5/2)`.
    pub fn deepest(&self) -> f64 {
        let energy = 1.25 * self.mass * self.speed * self.speed;
        libm::pow(energy / self.stiffness, 0.4)
    }

    /// The force at an overlap.
    pub fn force(&self, overlap: f64) -> f64 {
        self.stiffness * overlap * libm::sqrt(overlap)
    }

    /// Mean over the impact of the overlap, weighted with the force: `Gamma(7/5) Gamma(1/2)/(2 Gamma(19/10))`, 0.818,
    /// of the deepest. Half of it is what a lever that is shortened by half the overlap loses.
    pub fn mean_overlap(&self) -> f64 {
        self.deepest() * libm::tgamma(1.4) * libm::tgamma(0.5) / (2.0 * libm::tgamma(1.9))
    }

    /// How the overlap goes with time.
    pub fn course(&self) -> Course {
        let deepest = self.deepest();
        // With x = overlap/deepest = 1 - y^2 the time from the deepest overlap is deepest/speed times the integral of
        // 2 y/sqrt(1 - x^(5/2)), which is smooth at both ends.
        let part = 1.0 / PARTS as f64;
        let mut times = vec![0.0];
        let mut sum = 0.0;
        for k in 0..PARTS {
            let y = (k as f64 + 0.5) * part;
            let x = 1.0 - y * y;
            sum += part * 2.0 * y / libm::sqrt(1.0 - x * x * libm::sqrt(x));
            times.push(sum * deepest / self.speed);
        }
        Course { deepest, times }
    }
}

/// The overlap of an elastic impact against time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Course {
    deepest: f64,
    /// Time from the deepest overlap to `1 - y^2` of it, for equal steps of y.
    times: Vec<f64>,
}

impl Course {
    /// How long the bodies touch.
    pub fn duration(&self) -> f64 {
        2.0 * self.times[PARTS]
    }

    /// The overlap this long after they met; 0 when they do not touch.
    pub fn overlap(&self, time: f64) -> f64 {
        let from_middle = (time - self.times[PARTS]).abs();
        let k = self.times.partition_point(|t| *t <= from_middle);
        let Some(next) = self.times.get(k) else {
            return 0.0;
        };
        let before = self.times[k - 1];
        let y = ((k - 1) as f64 + (from_middle - before) / (next - before)) / PARTS as f64;
        self.deepest * (1.0 - y * y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const IMPACT: Hertz = Hertz {
        stiffness: 3e4,
        mass: 0.7,
        speed: 2.0,
    };

    /// The course obeys the equation of motion: its second difference in time is the force over the mass.
    #[test]
    fn the_course_obeys_newton() {
        let course = IMPACT.course();
        let step = course.duration() / 200.0;
        for k in [20.0, 60.0, 100.0, 150.0] {
            let at = |j: f64| course.overlap((k + j) * step);
            let speed_up = (at(1.0) - 2.0 * at(0.0) + at(-1.0)) / (step * step);
            let expected = -IMPACT.force(at(0.0)) / IMPACT.mass;
            // The error of a second difference over 1/200 of the contact.
            assert!(
                (speed_up / expected - 1.0).abs() < 2e-3,
                "{k}: {speed_up} {expected}"
            );
        }
        assert_eq!(course.overlap(2.0 * course.duration()), 0.0);
        // 2.943 is the constant of the textbook.
        let constant = course.duration() * IMPACT.speed / IMPACT.deepest();
        assert!((constant - 2.943_275).abs() < 1e-5, "{constant}");
    }

    /// The closed form against a sum over the course.
    #[test]
    fn the_mean_overlap_is_that_of_the_course() {
        let (course, n) = (IMPACT.course(), 10_000);
        let (mut force, mut moment) = (0.0, 0.0);
        for k in 0..n {
            let overlap = course.overlap((f64::from(k) + 0.5) / f64::from(n) * course.duration());
            force += IMPACT.force(overlap);
            moment += IMPACT.force(overlap) * overlap;
        }
        assert!((moment / force / IMPACT.mean_overlap() - 1.0).abs() < 1e-6);
    }
}
