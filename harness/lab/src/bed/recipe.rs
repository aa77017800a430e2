//! The recipe of a poured bed: everything that shapes it, and the digest by which it is found again.

use bitgrain_kernel::BITS_VERSION;
use serde::{Deserialize, Serialize};

use crate::scenario::{
    BedPlan, CheckedScenario, Container, IntruderShape, LidPlan, PouringOrder, UnitSystem,
};
use bitgrain_sim::checkpoint::FORMAT;
use bitgrain_sim::law::LawSpec;
use bitgrain_sim::motion::Moves;
use bitgrain_sim::simulation::hex;

/// Names the procedure of pouring. A change that gives other beds from equal scenarios raises it.
pub const POURING: u32 = 2;

/// Everything that shapes a bed. Two equal recipes give beds that are equal to the bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Version of the kernel's arithmetic.
    pub bits_version: u32,
    /// Version of the procedure, [`POURING`].
    pub pouring: u32,
    /// Version of the checkpoint's layout: beds in another are poured again.
    pub format: u32,
    /// Units of the numbers below.
    pub units: UnitSystem,
    /// Seed of every random number.
    pub seed: u64,
    /// Acceleration of gravity, along -z.
    pub gravity: f64,
    /// Time step.
    pub dt: f64,
    /// Lengths along x and y and the height of the box.
    #[serde(rename = "box")]
    pub size: [f64; 3],
    /// What held it at its sides.
    #[serde(default, skip_serializing_if = "is_default")]
    pub container: Container,
    /// Number of grains.
    pub grains: usize,
    /// Smallest and largest diameter, uniform between.
    pub diameters: [f64; 2],
    /// Mass density of the grains.
    pub density: f64,
    /// Height below which grains are frozen.
    pub base: f64,
    /// Whether a plane at z = 0 lies under the base.
    pub floor: bool,
    /// Bound of the kinetic energy per grain, over its weight times the mean diameter.
    pub settled: f64,
    /// Whether it was stopped at maxima of the kinetic energy, if the scenario says.
    #[serde(rename = "halting", default, skip_serializing_if = "Option::is_none")]
    pub kinetic_damping: Option<bool>,
    /// Whether the grains were released all at once or in turn.
    #[serde(default, skip_serializing_if = "is_default")]
    pub order: PouringOrder,
    /// Friction coefficient of the pouring, if it is not that of the law.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pouring_mu: Option<f64>,
    /// What moves: the base of a bed that moves is carried, that of another frozen.
    #[serde(default, skip_serializing_if = "is_default")]
    pub moves: Moves,
    /// The intruder that the grains fall round.
    pub intruder: RecipeIntruder,
    /// The lid that was put on the bed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lid: Option<LidPlan>,
    /// Contact law.
    pub law: LawSpec,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// The intruder of a recipe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecipeIntruder {
    /// A sphere, an endless cylinder along y, or a bar along y.
    #[serde(default, skip_serializing_if = "is_default")]
    pub shape: IntruderShape,
    /// Diameter.
    pub diameter: f64,
    /// Length of a bar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<f64>,
    /// Mass density of a sphere, as it enters the effective mass of its contacts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Its centre.
    pub center: [f64; 3],
}

impl Recipe {
    /// The recipe of one bed of a scenario.
    pub fn new(scenario: &CheckedScenario, plan: &BedPlan) -> Self {
        let bed = &scenario.bed;
        Self {
            bits_version: BITS_VERSION,
            pouring: POURING,
            format: FORMAT,
            units: scenario.units,
            seed: plan.seed,
            gravity: scenario.gravity,
            dt: scenario.drag.dt,
            size: bed.size,
            container: bed.container,
            grains: scenario.grain_count(plan.diameter),
            diameters: bed.diameters,
            density: bed.density,
            base: bed.base,
            floor: bed.floor,
            settled: bed.settled,
            kinetic_damping: bed.kinetic_damping,
            order: scenario.pouring_order(),
            pouring_mu: bed.pouring_mu,
            moves: scenario.drag.moves,
            intruder: RecipeIntruder {
                shape: scenario.intruder.shape,
                diameter: plan.diameter,
                length: scenario.intruder.length,
                density: scenario.intruder.density,
                center: plan.center,
            },
            lid: plan.lid,
            law: scenario.law,
        }
    }

    /// The recipe as TOML: the text that is digested.
    pub fn text(&self) -> String {
        toml::to_string(self).expect("a recipe has only string keys and finite numbers")
    }

    /// BLAKE3 of the text, in hex.
    pub fn digest(&self) -> String {
        hex(blake3::hash(self.text().as_bytes()).as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario;

    /// Every input that shapes a bed changes its digest; an input that only concerns the drag does not.
    #[test]
    fn the_digest_follows_what_shapes_a_bed() {
        let of = |sets: &[&str]| {
            let sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
            let scenario = scenario::load("quick", &sets).unwrap();
            Recipe::new(&scenario, &scenario.beds()[0]).digest()
        };
        let plain = of(&[]);
        let shaping = [
            "seed=2",
            "law.mu=0.4",
            "law.kn=2.4e5",
            "law.kt=2.4e5",
            "law.gamma_n=800.0",
            "bed.diameters=[0.91, 1.09]",
            "bed.box=[38.0, 12.5, 8.5]",
            "bed.grains=3899",
            "bed.base=0.7",
            "bed.floor=false",
            "bed.settled=2e-6",
            "bed.halting=true",
            "bed.pouring_mu=0.5",
            "bed.pouring_mu=0.1",
            "intruder.diameter=2.1",
            "intruder.density=2.0",
            "intruder.height=4.1",
            "drag.dt=3e-4",
        ];
        let mut digests: Vec<String> = shaping.iter().map(|set| of(&[set])).collect();
        digests.push(plain.clone());
        digests.sort();
        digests.dedup();
        assert_eq!(digests.len(), shaping.len() + 1);
        for set in [
            "name=other",
            "drag.discard=1.5",
            "measure.every=50",
            "intruder.speed=[0.1, 0.2, 0.3]",
        ] {
            assert_eq!(of(&[set]), plain, "{set}");
        }
    }

    #[test]
    fn a_recipe_reads_back() {
        for sets in [&[][..], &["bed.pouring_mu=0.0".to_string()]] {
            let scenario = scenario::load("quick", sets).unwrap();
            let recipe = Recipe::new(&scenario, &scenario.beds()[0]);
            let again: Recipe = toml::from_str(&recipe.text()).unwrap();
            assert_eq!(recipe, again);
            // Recipes of beds without the key are as they were before there was one.
            assert_eq!(recipe.text().contains("pouring_mu"), !sets.is_empty());
            assert_eq!(scenario.to_toml().contains("pouring_mu"), !sets.is_empty());
        }
    }
}
