//! The frozen base, and the numbers that grains keep.

use bitgrain_kernel::{Bond, Fault};

use super::{FREE, FROZEN};
use crate::order::spatial_order;
use crate::scenario::Bed;
use crate::sim::Sim;

/// Freezes the grains whose centres lie below the base's height, takes the floor away where the bed
/// has none, and numbers all grains in spatial order. The contacts that stay keep their springs, seen
/// from the grain that now has the lower number.
pub(super) fn freeze_base(old: &mut Sim, bed: &Bed) -> std::result::Result<Sim, Fault> {
    let mean = 2.0 * old.position.iter().map(|x| x[3]).sum::<f64>() / old.count().max(1) as f64;
    let order = spatial_order(&old.position, mean);
    let bonds = old.bonds();
    let mut new = old.clone();
    if !bed.floor {
        new.obstacles.truncate(1);
    }
    let mut place = vec![0u32; old.count()];
    for (k, &from) in order.iter().enumerate() {
        place[from] = k as u32;
        let frozen = old.position[from][2] < bed.base;
        new.group[k] = if frozen { FROZEN } else { FREE };
        new.position[k] = old.position[from];
        new.velocity[k] = old.velocity[from];
        new.spin[k] = old.spin[from];
        new.force[k] = old.force[from];
        new.torque[k] = old.torque[from];
        new.image[k] = old.image[from];
        if frozen {
            new.velocity[k] = [0.0, 0.0, 0.0, old.velocity[from][3]];
            new.spin[k] = [0.0; 4];
        }
    }
    let frozen = |k: u32| new.group[k as usize] == FROZEN;
    let mut kept = Vec::with_capacity(bonds.len());
    for bond in bonds {
        match bond {
            Bond::Pair { i, j, spring } => {
                let (a, b) = (place[i as usize], place[j as usize]);
                if frozen(a) && frozen(b) {
                    continue;
                }
                let turned = [-spring[0], -spring[1], -spring[2]];
                kept.push(if a < b {
                    Bond::Pair { i: a, j: b, spring }
                } else {
                    Bond::Pair {
                        i: b,
                        j: a,
                        spring: turned,
                    }
                });
            }
            Bond::Touch {
                i,
                obstacle,
                spring,
            } => {
                let i = place[i as usize];
                let body = new.obstacles.get(obstacle as usize);
                if body.is_some_and(|body| !frozen(i) || body.inverse_mass > 0.0) {
                    kept.push(Bond::Touch {
                        i,
                        obstacle,
                        spring,
                    });
                }
            }
        }
    }
    new.resume(&kept)?;
    Ok(new)
}
