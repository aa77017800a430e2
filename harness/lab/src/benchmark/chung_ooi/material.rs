//! The materials of Chung and Ooi 2011.

use bitgrain_sim::law::{HertzTsujiParameters, LawSpec};
use bitgrain_sim::table::Word;

/// An elastic material, in SI units.
#[derive(Debug, PartialEq)]
pub(super) struct Material {
    /// Its name.
    pub name: &'static str,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density, kg/m^3.
    pub density: f64,
}

const fn material(name: &'static str, young: f64, poisson: f64, density: f64) -> Material {
    Material {
        name,
        young,
        poisson,
        density,
    }
}

pub(super) const GLASS: Material = material("glass", 4.8e10, 0.2, 2800.0);
pub(super) const LIMESTONE: Material = material("limestone", 2e10, 0.25, 2500.0);
/// Of test 2; that of tests 4, 6, 7 and 8 is a little different.
pub(super) const ALUMINIUM_ALLOY_2: Material = material("aluminium alloy", 7e10, 0.3, 2699.0);
pub(super) const MAGNESIUM_ALLOY: Material = material("magnesium alloy", 4e10, 0.35, 1800.0);
pub(super) const ALUMINIUM_OXIDE: Material = material("aluminium oxide", 3.8e11, 0.23, 4000.0);
pub(super) const CAST_IRON: Material = material("cast iron", 1e11, 0.25, 7000.0);
pub(super) const ALUMINIUM_ALLOY: Material = material("aluminium alloy", 7e10, 0.33, 2700.0);
pub(super) const STEEL: Material = material("steel", 2.08e11, 0.3, 7850.0);
pub(super) const POLYETHYLENE: Material = material("polyethylene", 1e9, 0.4, 1400.0);
pub(super) const NYLON: Material = material("nylon", 2.5e9, 0.4, 1000.0);
pub(super) const COPPER: Material = material("copper", 1.2e11, 0.35, 8900.0);

const ALL: [&Material; 11] = [
    &GLASS,
    &LIMESTONE,
    &ALUMINIUM_ALLOY_2,
    &MAGNESIUM_ALLOY,
    &ALUMINIUM_OXIDE,
    &CAST_IRON,
    &ALUMINIUM_ALLOY,
    &STEEL,
    &POLYETHYLENE,
    &NYLON,
    &COPPER,
];

/// The name of a material in a table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Name(pub &'static str);

impl Word for Name {
    fn word(&self) -> &'static str {
        self.0
    }

    fn take(&mut self, word: &str) -> Option<()> {
        self.0 = ALL.iter().find(|known| known.name == word)?.name;
        Some(())
    }
}

impl Material {
    /// The law of its contacts with a material of the same Poisson's ratio that is `stiffness_ratio` times as stiff.
    ///
    /// The law is of one material. A contact has one E* and one G*, and for equal Poisson's ratios both are those of
    /// two bodies of the harmonic mean of the moduli.
    pub fn law(&self, stiffness_ratio: f64, restitution: f64, mu: f64) -> LawSpec {
        LawSpec::HertzTsuji(HertzTsujiParameters {
            young: 2.0 * stiffness_ratio / (1.0 + stiffness_ratio) * self.young,
            poisson: self.poisson,
            restitution,
            mu,
            rolling: None,
        })
    }
}
