//! A scenario that can be run.

use std::fmt;
use std::ops::Deref;

use serde::{Serialize, Serializer};

use super::keys::Scenario;
use super::plan::{BedPlan, DragPlan};
use bitgrain_kernel::Domain;
use bitgrain_sim::law::LawSpec;
use bitgrain_sim::simulation::AnyLaw;

/// What is wrong with a scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The key, as in `drag.dt`.
    pub key: String,
    /// What was found and what was expected.
    pub problem: String,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` {}", self.key, self.problem)
    }
}

impl std::error::Error for Refusal {}

impl From<(String, String)> for Refusal {
    fn from((key, problem): (String, String)) -> Self {
        Self { key, problem }
    }
}

/// A scenario all of whose values were checked, with what follows from it: its law, its beds and its drags.
///
/// Everything that pours, drags and measures takes only this. It is made by [`Scenario::check`] and
/// cannot be changed; [`CheckedScenario::changed`] makes another.
#[derive(Clone, Debug)]
pub struct CheckedScenario {
    scenario: Scenario,
    law: AnyLaw,
    quenching: AnyLaw,
    pouring: AnyLaw,
    pouring_quenching: AnyLaw,
    lattice: Domain<f64>,
    beds: Vec<BedPlan>,
    bare_beds: Vec<BedPlan>,
    drags: Vec<DragPlan>,
}

impl Scenario {
    /// Checks every value, and works out what is to be done.
    ///
    /// # Errors
    /// The first key that is wrong, and what was expected of it.
    pub fn check(self) -> Result<CheckedScenario, Refusal> {
        self.check_all()?;
        self.made()
    }

    /// [`Scenario::check`] by the rules for the inputs of a file of results: every default is written out, and the
    /// file of an imported bed lies in the run directory.
    ///
    /// # Errors
    /// As [`Scenario::check`].
    pub fn check_resolved(self) -> Result<CheckedScenario, Refusal> {
        self.check_written_out()?;
        self.made()
    }

    fn made(self) -> Result<CheckedScenario, Refusal> {
        let of_law = |(key, problem)| Refusal {
            key: format!("law.{key}"),
            problem,
        };
        let mu = self.bed.pouring_mu.unwrap_or(self.law.mu());
        let poured = self.law.with_mu(mu);
        let quenched = |law: LawSpec| law.quenching(self.drag.dt, self.mean_diameter());
        let [law, quenching, pouring, pouring_quenching] =
            [self.law, quenched(self.law), poured, quenched(poured)].map(|law| law.build());
        let [x, y, _] = self.bed.size;
        // Grains stand in layers as they are laid out: only the periods along x and y matter.
        let across = !self.is_tank();
        let lattice = Domain::new([0.0; 3], [x, y, 1.0], [across, across, false]);
        let lattice = lattice.map_err(|e| ("bed.box".to_string(), e.to_string()))?;
        Ok(CheckedScenario {
            law: law.map_err(of_law)?,
            quenching: quenching.map_err(of_law)?,
            pouring: pouring.map_err(of_law)?,
            pouring_quenching: pouring_quenching.map_err(of_law)?,
            lattice,
            beds: self.plan_beds(),
            bare_beds: self.plan_bare_beds(),
            drags: self.plan_drags(),
            scenario: self,
        })
    }
}

impl CheckedScenario {
    /// Its values, to change and to check again.
    pub fn edit(&self) -> Scenario {
        self.scenario.clone()
    }

    /// The same with other values, checked again.
    ///
    /// # Errors
    /// As [`Scenario::check`].
    pub fn changed(&self, change: impl FnOnce(&mut Scenario)) -> Result<Self, Refusal> {
        let mut scenario = self.edit();
        change(&mut scenario);
        scenario.check()
    }

    /// The contact law as it is computed.
    pub fn contact_law(&self) -> AnyLaw {
        self.law.clone()
    }

    /// The law under which the last motion of a bed under a lid is damped out.
    pub fn quenching_law(&self) -> AnyLaw {
        self.quenching.clone()
    }

    /// The law under which a bed is poured: the contact law with the friction of the pouring.
    pub fn pouring_law(&self) -> AnyLaw {
        self.pouring.clone()
    }

    /// The law under which the last motion of a poured bed is damped out, with the friction of the pouring, too.
    pub fn pouring_quenching_law(&self) -> AnyLaw {
        self.pouring_quenching.clone()
    }

    /// The box across which distances are taken as grains are laid out.
    pub fn lattice_domain(&self) -> &Domain<f64> {
        &self.lattice
    }

    /// The beds to make, by diameter, height, lid and seed.
    pub fn beds(&self) -> &[BedPlan] {
        &self.beds
    }

    /// The beds to pour, each once: those without a lid, and what lies below the lids of the others. A
    /// bed that only lies below lids is named after them.
    pub fn bare_beds(&self) -> &[BedPlan] {
        &self.bare_beds
    }

    /// All beds, each once: those to pour first, then those under lids.
    pub fn all_beds(&self) -> Vec<&BedPlan> {
        let own = self.beds.iter();
        let own = own.filter(|bed| !self.bare_beds.contains(bed));
        self.bare_beds.iter().chain(own).collect()
    }

    /// The drags to do, by bed and then speed.
    pub fn drags(&self) -> &[DragPlan] {
        &self.drags
    }

    /// The same with the file of its bed at another place, where it was copied to.
    #[must_use]
    pub fn with_bed_file(&self, file: String) -> Self {
        let mut moved = self.clone();
        moved.scenario.source = None;
        moved.scenario.bed.file = Some(file);
        moved
    }
}

impl Deref for CheckedScenario {
    type Target = Scenario;

    fn deref(&self) -> &Scenario {
        &self.scenario
    }
}

impl PartialEq for CheckedScenario {
    fn eq(&self, other: &Self) -> bool {
        self.scenario == other.scenario
    }
}

impl Serialize for CheckedScenario {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.scenario.serialize(to)
    }
}
