//! What a checkpoint's arrays say, once they are known to be as they were written.

use std::sync::Arc;

use bitgrain_kernel::{ContactHistory, KeptContact};
use safetensors::tensor::{Dtype, SafeTensors};

use super::head::{FACETS, FIELDS, FRAMES, Head, StageState, WORDS};
use crate::histories::Histories;
use crate::mesh::restored;
use crate::simulation::Simulation;

/// The arrays of a file.
pub(super) struct Arrays<'a> {
    pub file: &'a SafeTensors<'a>,
}

impl Arrays<'_> {
    /// The bytes of a named array in words of `N`, with its type checked.
    fn words<const N: usize>(
        &self,
        name: &str,
        dtype: Dtype,
    ) -> std::result::Result<Vec<[u8; N]>, String> {
        let view = self
            .file
            .tensor(name)
            .map_err(|e| format!("`{name}`: {e}"))?;
        if view.dtype() != dtype {
            return Err(format!("`{name}` is {:?}, not {dtype:?}", view.dtype()));
        }
        let (words, rest) = view.data().as_chunks::<N>();
        if rest.is_empty() {
            Ok(words.to_vec())
        } else {
            Err(format!("`{name}` is cut off"))
        }
    }

    fn reals<const W: usize>(&self, name: &str) -> std::result::Result<Vec<[f64; W]>, String> {
        let words = self.words::<8>(name, Dtype::F64)?;
        let reals: Vec<f64> = words.into_iter().map(f64::from_le_bytes).collect();
        Ok(reals.as_chunks::<W>().0.to_vec())
    }

    /// A simulation of the grains, without their contacts.
    pub fn sim(&self, head: &Head) -> std::result::Result<Simulation, String> {
        let id = self.words::<4>("id", Dtype::U32)?;
        let group: Vec<[u8; 1]> = self.words("group", Dtype::U8)?;
        let mut sim = Simulation::new(
            head.law.clone(),
            head.domain,
            head.dt,
            head.groups.clone(),
            &[],
            vec![],
        );
        sim.obstacles = head.obstacles.clone();
        if self.file.names().contains(&FACETS) {
            let corners = self.reals::<3>(FACETS)?;
            let triangles = corners.as_chunks::<3>().0;
            sim.facets = Arc::new(restored(triangles, &sim.obstacles));
        }
        sim.id = id.into_iter().map(u32::from_le_bytes).collect();
        sim.group = group.into_iter().map(|[g]| g).collect();
        sim.position = self.reals("position")?;
        sim.velocity = self.reals("velocity")?;
        sim.spin = self.reals("spin")?;
        sim.force = self.reals("force")?;
        sim.torque = self.reals("torque")?;
        let image = self.words::<4>("image", Dtype::I32)?;
        let image: Vec<i32> = image.into_iter().map(i32::from_le_bytes).collect();
        sim.image = image.as_chunks::<3>().0.to_vec();
        sim.fit_storage();
        sim.choose_skin();
        Ok(sim)
    }

    /// What the file holds besides the state.
    pub fn note(&self, head: &Head) -> std::result::Result<StageState, String> {
        Ok(StageState {
            recipe: head.recipe.clone(),
            link: head.link.clone(),
            course: text(
                "course",
                self.words::<1>("course", Dtype::U8)?.into_flattened(),
            )?,
            fields: self.bytes(FIELDS)?,
            frames: text(FRAMES, self.bytes(FRAMES)?)?,
        })
    }

    /// The bytes of an array; none if there is no such array.
    fn bytes(&self, name: &str) -> std::result::Result<Vec<u8>, String> {
        match self.file.names().contains(&name) {
            true => Ok(self.words::<1>(name, Dtype::U8)?.into_flattened()),
            false => Ok(Vec::new()),
        }
    }

    /// The contacts, with so many words of the law of each.
    pub fn contact_histories(&self, words: usize) -> std::result::Result<Histories, String> {
        let kinds: Vec<[u8; 1]> = self.words("bond_kind", Dtype::U8)?;
        let bodies = self.words::<4>("bond_bodies", Dtype::U32)?;
        let bodies: Vec<u32> = bodies.into_iter().map(u32::from_le_bytes).collect();
        let springs = self.reals::<3>("bond_spring")?;
        if bodies.len() != 2 * kinds.len() || springs.len() != kinds.len() {
            return Err("its contact arrays differ in length".into());
        }
        let memory = match self.file.names().contains(&WORDS) {
            true => self.reals::<1>(WORDS)?.into_flattened(),
            false => Vec::new(),
        };
        if memory.len() != words * kinds.len() {
            return Err(format!(
                "`{WORDS}` has not {words} numbers for each contact"
            ));
        }
        let pairs = bodies.as_chunks::<2>().0;
        let bond = |k: usize| {
            let (spring, [i, partner]) = (springs[k], pairs[k]);
            match kinds[k] {
                [0] => Ok(ContactHistory::Pair {
                    i,
                    j: partner,
                    spring,
                }),
                [1] => Ok(ContactHistory::Obstacle {
                    i,
                    obstacle: partner,
                    spring,
                }),
                [other] => Err(format!("contact {k} is of the unknown kind {other}")),
            }
        };
        let kept = |k: usize| {
            let mut contact = KeptContact::from(bond(k)?);
            contact.memory[..words].copy_from_slice(&memory[words * k..words * (k + 1)]);
            Ok(contact)
        };
        (0..kinds.len()).map(kept).collect()
    }
}

fn text(name: &str, bytes: Vec<u8>) -> std::result::Result<String, String> {
    String::from_utf8(bytes).map_err(|e| format!("`{name}`: {e}"))
}
