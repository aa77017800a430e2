//! The coefficients of a contact law as the paper's table gives them.

use crate::grain::sphere_mass;
use crate::law::{AnyLaw, LawSpec};

/// One row of Guillard 2014, Table I: the coefficient, its unit in SI, and its values for two grains
/// and for a grain at a cylinder or plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficient {
    /// The coefficient over what it grows with.
    pub name: &'static str,
    /// In SI units.
    pub unit: &'static str,
    /// Two equal grains.
    pub pair: f64,
    /// A grain and a wall.
    pub wall: f64,
}

/// The eight coefficients of Table I for grains of this diameter and density; `None` for another law.
///
/// The table's `gamma_t/delta_t^(1/4)` is a misprint for `delta_n^(1/4)`, and its cylinder column writes
/// the damping with the stiffness of two grains.
pub fn table_one(law: &LawSpec, diameter: f64, density: f64) -> Option<[Coefficient; 4]> {
    let Ok(AnyLaw::HertzTsuji(law)) = law.build() else {
        return None;
    };
    let mass = sphere_mass(diameter, density);
    // Effective radius and mass.
    let bodies = [(0.25 * diameter, 0.5 * mass), (0.5 * diameter, mass)];
    let stiff = |k: f64| bodies.map(|(radius, _)| k * radius.sqrt());
    let damped = |c: f64| bodies.map(|(radius, mass)| c * (mass * radius.sqrt()).sqrt());
    let row = |name, unit, [pair, wall]: [f64; 2]| Coefficient {
        name,
        unit,
        pair,
        wall,
    };
    Some([
        row("k_n/delta_n^(1/2)", "N m^(-3/2)", stiff(law.kn)),
        row("k_t/delta_n^(1/2)", "N m^(-3/2)", stiff(law.kt)),
        row("gamma_n/delta_n^(1/4)", "kg s^-1 m^(-1/4)", damped(law.cn)),
        row("gamma_t/delta_n^(1/4)", "kg s^-1 m^(-1/4)", damped(law.ct)),
    ])
}

/// The table as text, five digits a number; `None` for another law.
pub fn table_text(law: &LawSpec, diameter: f64, density: f64, si: bool) -> Option<String> {
    let rows = table_one(law, diameter, density)?;
    let mut out = format!(
        "{:<34}{:>12}{:>16}\n",
        "contact law", "two grains", "grain and wall"
    );
    let digits = |x: f64| {
        if x >= 1e4 {
            format!("{x:.0}")
        } else {
            format!("{x:.5}")
        }
    };
    for row in rows {
        let unit = if si { row.unit } else { "" };
        let line = format!(
            "  {:<32}{:>12}{:>16}  {unit}",
            row.name,
            digits(row.pair),
            digits(row.wall)
        );
        out.push_str(line.trim_end());
        out.push('\n');
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::HertzTsujiParameters;

    /// Guillard 2014, Table I, unrounded.
    #[test]
    fn the_eight_coefficients_are_the_papers() {
        let law = LawSpec::HertzTsuji(HertzTsujiParameters {
            young: 5e6,
            poisson: 0.45,
            restitution: 0.6,
            mu: 0.5,
            rolling: None,
        });
        let rows = table_one(&law, 1.5e-3, 2500.0).unwrap();
        let paper = [
            (80940.0, 114_467.0),
            (86162.0, 121_852.0),
            (0.15174, 0.25520),
            (0.12783, 0.21499),
        ];
        for (row, (pair, wall)) in rows.iter().zip(paper) {
            // The paper's formulas to five digits.
            assert!((row.pair / pair - 1.0).abs() < 1e-4, "{row:?}");
            assert!((row.wall / wall - 1.0).abs() < 1e-4, "{row:?}");
        }
        let text = table_text(&law, 1.5e-3, 2500.0, true).unwrap();
        for number in ["80940", "114467", "86162", "121852", "0.15174", "0.25520"] {
            assert!(text.contains(number), "{text}");
        }
    }
}
