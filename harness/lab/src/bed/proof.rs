//! Whether the bytes of a checkpoint are a settled bed by a recipe, as far as the bytes alone can show.

use super::course::{Phase, PouringState};
use super::recipe::Recipe;
use bitgrain_sim::chain::{self, Chain};
use bitgrain_sim::checkpoint;
use bitgrain_sim::error::{Error, Result};

/// Checks that a checkpoint is whole, is of this recipe, and that its state is the one of the last link of its
/// chain of digests; `name` is what errors call it.
///
/// That finds accidents, and states that were changed and sealed again. Seals and links have no key: a forgery of
/// the whole chain is found only by `verify`, which pours the bed again.
///
/// # Errors
/// [`Error::Damaged`] if it is not whole or not the state of its chain, [`Error::Input`] if it is another
/// recipe's or another version's.
pub fn prove(bytes: &[u8], name: &str, recipe: &Recipe) -> Result<()> {
    let (mut sim, note) = checkpoint::unpack(bytes, name)?;
    if note.recipe != recipe.digest() {
        let problem = "holds a bed that was poured by another recipe";
        return Err(Error::input(name, problem));
    }
    let damaged = |problem: String| Error::Damaged {
        place: name.into(),
        problem,
    };
    if sim.dt != recipe.dt || recipe.law.build().is_ok_and(|law| law != sim.law) {
        return Err(damaged(
            "it is under another law or time step than its recipe".into(),
        ));
    }
    let course = PouringState::of(&note).map_err(damaged)?;
    let chain = course.chain();
    let same = Chain::parse(&chain.text(), name).is_ok_and(|read| read.links == chain.links);
    // A bed under a lid goes on from the chain of the one below, whose last link is in no recipe.
    let begins = recipe.lid.is_some() || chain.begins == chain::beginning(&recipe.digest());
    let digest = sim.digest();
    let digest = digest.map_err(|fault| Error::run(name, sim.step_count(), fault))?;
    let parts = digest
        .parts()
        .map(|part| bitgrain_sim::simulation::hex(part));
    let ends = chain.links.last();
    let ends = ends.is_some_and(|last| last.step == sim.step_count() && last.parts == parts);
    if !same || !begins || !ends || !course.is_in(Phase::Settled) || !course.is_by(recipe) {
        let problem = "its state is not the one that its chain of digests ends with";
        return Err(damaged(problem.into()));
    }
    Ok(())
}
