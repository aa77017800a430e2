//! LAMMPS' drags and ours as the goldens hold them, and functions to compare them.

use bitgrain::scenario::{self, CheckedScenario};

use crate::golden;

/// A bed and the name that LAMMPS' series through it have in common.
pub struct Bed {
    /// Diameter of the intruder.
    pub diameter: f64,
    /// Coefficient of friction.
    pub friction: f64,
    /// Its file in `golden/peers`.
    pub file: &'static str,
    /// The series in `golden/peers/drag`, up to the Froude number.
    pub series: &'static str,
}

/// One of our drags, a line of `bitgrain.snap`.
pub struct Ours {
    /// Drag, its error, lift, its error.
    pub means: [f64; 4],
    /// Drag of each eighth of the run.
    pub eighths: [f64; 8],
}

/// One of LAMMPS' drags, a row of `drag.csv`.
pub struct Lammps {
    /// Speed of the intruder.
    pub speed: f64,
    /// Steps.
    pub steps: u64,
    /// Drag, its error, lift, its error.
    pub means: [f64; 4],
}

fn text(name: &str) -> String {
    let path = golden("peers/drag").join(name);
    std::fs::read_to_string(path).expect("the golden is in the repository")
}

fn numbers(words: impl Iterator<Item: AsRef<str>>) -> Vec<f64> {
    words
        .map(|w| w.as_ref().parse().expect("the golden holds numbers"))
        .collect()
}

/// The body of a snapshot file of these drags.
pub fn body(name: &str) -> String {
    let text = text(&format!("{name}.snap"));
    let body = text.split("---\n").nth(2);
    body.expect("the golden is a snapshot").to_string()
}

impl Bed {
    /// The scenario of one drag; the `replica`-th has its time step longer by this many parts in 10,000.
    /// Without friction a floor is under the bed.
    pub fn scenario(&self, froude: f64, replica: usize) -> CheckedScenario {
        let file = golden("peers/drag/lammps.toml");
        let sets = [
            format!("bed.file='{}'", golden("peers").join(self.file).display()),
            format!("bed.floor={}", self.friction == 0.0),
            format!("law.mu={:?}", self.friction),
            format!("intruder.froude={froude:?}"),
            format!("drag.dt={:?}", 1.5e-4 * (1.0 + 1e-4 * replica as f64)),
        ];
        scenario::load(&file.to_string_lossy(), &sets).expect("the scenario is in order")
    }

    /// Our drags at a Froude number, replica by replica.
    pub fn ours(&self, froude: f64) -> Vec<Ours> {
        let mut found = Vec::new();
        for line in body("bitgrain").lines().skip(1) {
            let n = numbers(line.split_whitespace());
            if n[..3] == [self.diameter, self.friction, froude] {
                assert_eq!(n[3], found.len() as f64);
                found.push(Ours {
                    means: std::array::from_fn(|k| n[4 + k]),
                    eighths: std::array::from_fn(|k| n[8 + k]),
                });
            }
        }
        found
    }

    /// LAMMPS' drag at a Froude number.
    pub fn lammps(&self, froude: f64) -> Lammps {
        let text = text("drag.csv");
        let mut rows = text.lines().skip(2).map(|line| numbers(line.split(',')));
        let point = [self.diameter, self.friction, froude];
        let row = rows.find(|row| row[..3] == point);
        let row = row.expect("LAMMPS' drag is there");
        Lammps {
            speed: row[3],
            steps: row[4] as u64,
            means: [row[5], row[6], row[7], row[8]],
        }
    }

    /// LAMMPS' series at a Froude number.
    pub fn lammps_series(&self, froude: f64) -> (String, Vec<[f64; 4]>) {
        series(&format!("{}{froude}.csv", self.series))
    }
}

/// A series of LAMMPS': its head, and rows of step, x, y and z of the force.
pub fn series(name: &str) -> (String, Vec<[f64; 4]>) {
    let text = text(name);
    let row = |line: &str| {
        let n = numbers(line.split(','));
        [n[0], n[1], n[2], n[3]]
    };
    let head = text.lines().next().unwrap_or_default().to_string();
    (head, text.lines().skip(2).map(row).collect())
}

/// A second number less a first, each with its error, over both errors.
pub fn difference([a, ae]: [f64; 2], [b, be]: [f64; 2]) -> f64 {
    (b - a) / be.hypot(ae)
}

/// LAMMPS' mean and ours, each with its error, as cells of a table; and the difference over both errors.
pub fn cells([l, le]: [f64; 2], [b, be]: [f64; 2]) -> (String, f64) {
    let off = difference([l, le], [b, be]);
    (
        format!(" {l:.0} ± {le:.0} | {b:.0} ± {be:.0} | {off:+.1} σ |"),
        off,
    )
}

/// The page of the guide that shows them.
pub fn validation() -> String {
    let path = golden("../harness/guide/src/validation.md");
    std::fs::read_to_string(path).expect("the page is in the repository")
}

/// Means of this many equal blocks from the beginning; the rest at the end is left out.
pub fn blocks(values: &[f64], count: usize) -> Vec<f64> {
    let part = values.len() / count;
    let parts = values.chunks_exact(part).take(count);
    parts.map(|p| p.iter().sum::<f64>() / part as f64).collect()
}

/// Mean and standard deviation.
pub fn spread(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    (mean, (square / (n - 1.0)).sqrt())
}

/// Chance that the squares of this many normal numbers add up to as much or more: the tail of chi-square
/// with an even number of degrees of freedom, which is a Poisson sum.
pub fn tail(chi_square: f64, degrees: u32) -> f64 {
    assert_eq!(degrees % 2, 0);
    let half = 0.5 * chi_square;
    let mut term = (-half).exp();
    let mut sum = term;
    for k in 1..degrees / 2 {
        term *= half / f64::from(k);
        sum += term;
    }
    sum
}
