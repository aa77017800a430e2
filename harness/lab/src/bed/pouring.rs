//! A bed from the first grain's release to rest: phase by phase, from a checkpoint on if it
//! was stopped.

use super::course::{Phase, Pouring, PouringState};
use super::lattice::Lattice;
use super::lid;
use super::make::{buried, dropped, freeze_base, renumbered};
use super::recipe::Recipe;
use super::settle::{fallen, rest, settle, upward};
use super::survey::stopped;
use crate::progress::Stage;
use crate::scenario::{BedPlan, CheckedScenario, PouringOrder as Order};
use bitgrain_sim::chain::{self, Chain};
use bitgrain_sim::checkpoint::StageState;
use bitgrain_sim::error::Result;
use bitgrain_sim::memory::{PER_GRAIN, room};
use bitgrain_sim::observer::Observer;
use bitgrain_sim::simulation::Simulation;

/// Steps between links of a bed's chain: beds are shared by scenarios, so it is the same for all.
const LINKS: u64 = 1000;

impl Pouring {
    /// The grains of a bed as they are released; its lid is not yet on it.
    ///
    /// # Errors
    /// [`bitgrain_sim::error::Error::Input`] and [`bitgrain_sim::error::Error::Run`] if they cannot be.
    pub fn begin(scenario: &CheckedScenario, plan: &BedPlan) -> Result<Self> {
        let lowest = plan.center[2] - 0.5 * plan.diameter;
        let count = scenario.grain_count(plan.diameter);
        room(
            PER_GRAIN * count as f64,
            &format!("{count} grains of {}", plan.name),
        )?;
        let (first, beside) = match scenario.pouring_order() {
            Order::AtOnce => (count, Some(plan)),
            Order::InTurn => (scenario.filling(lowest, 0.0).min(count), None),
        };
        let lattice = Lattice::new(scenario, first, 0.0, beside);
        let mut sim = dropped(scenario, plan, &lattice)?;
        sim.start().map_err(|f| stopped(&plan.name, &sim, f))?;
        let key = Recipe::new(scenario, plan).digest();
        let link = chain::beginning(&key);
        let mut bed = Self::new(key, sim, Phase::Fall, link, &plan.name)?;
        bed.course.top = lattice.top;
        Ok(bed)
    }

    /// A settled bed with the lid of `plan`, which must have one, laid on it; `link` is the last of the
    /// bed's chain.
    ///
    /// # Errors
    /// [`bitgrain_sim::error::Error::Unfit`] if the bed is deep enough without one, and as [`Pouring::begin`].
    pub fn cover(
        bare: &mut Simulation,
        link: &str,
        scenario: &CheckedScenario,
        plan: &BedPlan,
    ) -> Result<Self> {
        let lid = plan.lid.as_ref().expect("only beds with a lid are covered");
        let mut sim = lid::covered(bare, scenario, plan, lid)?;
        sim.law = scenario.quenching_law();
        let key = Recipe::new(scenario, plan).digest();
        Self::new(key, sim, Phase::Quench, link.into(), &plan.name)
    }

    /// An imported bed, which is taken as it is, without a recipe. Its chain begins with the digest of
    /// its file.
    ///
    /// # Errors
    /// [`bitgrain_sim::error::Error::Contract`].
    pub fn imported(sim: Simulation, scenario: &CheckedScenario, plan: &BedPlan) -> Result<Self> {
        let file = scenario.bed.hash.as_deref().unwrap_or_default();
        let link = chain::beginning(file);
        Self::new(String::new(), sim, Phase::Settled, link, &plan.name)
    }

    fn new(key: String, sim: Simulation, phase: Phase, link: String, name: &str) -> Result<Self> {
        let mut bed = Self {
            sim,
            course: PouringState {
                key,
                phase,
                begin: 0,
                before: 0.0,
                top: 0.0,
                chain: Chain::new(link, LINKS),
            },
        };
        bed.enter(phase);
        let digest = bed.sim.digest().map_err(|f| stopped(name, &bed.sim, f))?;
        bed.course.chain.add(bed.sim.step_count(), &digest);
        Ok(bed)
    }

    /// Takes a bed up again from a checkpoint.
    ///
    /// # Errors
    /// What is wrong with the note.
    pub fn of(
        sim: Simulation,
        note: &StageState,
        scenario: &CheckedScenario,
        plan: &BedPlan,
    ) -> std::result::Result<Self, String> {
        let course = PouringState::of(note)?;
        if course.key == Recipe::new(scenario, plan).digest() {
            Ok(Self { sim, course })
        } else {
            Err("holds a bed that was poured by another recipe".into())
        }
    }

    /// Goes on until the bed is settled. Returns whether it is: `false` if `observer` has seen enough before.
    ///
    /// # Errors
    /// [`bitgrain_sim::error::Error::Run`] if grains escape or overlap too deep,
    /// [`bitgrain_sim::error::Error::Unsettled`], [`bitgrain_sim::error::Error::Interrupted`], after which the bed can
    /// go on from here, and what `observer` returns.
    pub fn go_on(
        &mut self,
        scenario: &CheckedScenario,
        plan: &BedPlan,
        stage: &mut Stage,
        observer: &mut impl Observer,
    ) -> Result<bool> {
        let count = scenario.grain_count(plan.diameter);
        observer.on_start(self.sim.step_count(), &mut self.sim)?;
        while self.course.phase != Phase::Settled {
            let phase = self.course.phase;
            let goal = match phase {
                Phase::Fall | Phase::Fill => fallen(scenario, self.course.top),
                _ => rest(scenario, plan, phase == Phase::Quench),
            };
            if !settle(self, scenario, plan, &goal, stage, observer)? {
                return Ok(false);
            }
            let wrong = |sim: &Simulation, f| stopped(&plan.name, sim, f);
            let next = match phase {
                Phase::Fall => {
                    self.sim =
                        freeze_base(&mut self.sim, scenario).map_err(|f| wrong(&self.sim, f))?;
                    if scenario.pouring_order() == Order::InTurn {
                        (self.sim, self.course.top) = buried(&mut self.sim, scenario, plan, count)
                            .map_err(|f| wrong(&self.sim, f))?;
                        Phase::Fill
                    } else {
                        Phase::Quench
                    }
                }
                Phase::Fill => {
                    self.sim =
                        renumbered(&mut self.sim, scenario).map_err(|f| wrong(&self.sim, f))?;
                    Phase::Quench
                }
                Phase::Quench => Phase::Rest,
                Phase::Rest | Phase::Settled => Phase::Settled,
            };
            // A bed under a lid begins with its quenching: what comes to it here was poured. The last rest is under the
            // law of the drag, so that a bed poured with another friction is at rest as the drag begins: springs beyond
            // a smaller limit are cut, and the bed gives way, before that.
            self.sim.law = match next {
                Phase::Fall | Phase::Fill => scenario.pouring_law(),
                Phase::Quench => scenario.pouring_quenching_law(),
                Phase::Rest | Phase::Settled => scenario.contact_law(),
            };
            self.enter(next);
        }
        self.link(plan, observer)?;
        Ok(true)
    }

    pub(super) fn enter(&mut self, phase: Phase) {
        self.course.phase = phase;
        self.course.begin = self.sim.step_count();
        self.course.before = upward(&self.sim);
    }

    /// After a look that was not the last of its phase: the next link, if it is due, and an opportunity to save.
    pub(super) fn looked(&mut self, plan: &BedPlan, observer: &mut impl Observer) -> Result<()> {
        if self.course.chain.is_due(self.sim.step_count()) {
            self.link(plan, observer)?;
        }
        let Self { sim, course } = self;
        observer.on_checkpoint(sim.step_count(), sim, &|| course.note())
    }

    fn link(&mut self, plan: &BedPlan, observer: &mut impl Observer) -> Result<()> {
        let digest = self.sim.digest();
        let digest = digest.map_err(|f| stopped(&plan.name, &self.sim, f))?;
        let link = self.course.chain.add(self.sim.step_count(), &digest);
        link.map_or(Ok(()), |link| observer.on_digest(link))
    }
}
