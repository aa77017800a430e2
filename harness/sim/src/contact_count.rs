//! Contacts of grains counted, and their deepest overlap, without their springs: what a row of measurements needs.

use bitgrain_kernel::parts::listed_pairs;
use bitgrain_kernel::vec3::{dot, head};
use bitgrain_kernel::{Domain, Row, World};

/// What is counted.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactCount {
    /// Contacts of each grain with grains and with surfaces of obstacles, by place.
    pub contacts: Vec<u32>,
    /// Deepest overlap of two grains (length); 0 if none touch.
    pub deepest: f64,
}

/// Where the grains of the whole world are.
#[derive(Clone, Copy)]
pub(crate) struct Places<'a> {
    pub domain: &'a Domain<f64>,
    pub position: &'a [Row<f64>],
}

/// Counts the pairs of each grain of a world, whose grains have these places in the whole one. A pair without overlap
/// counts if the law has kept something of it.
pub(crate) fn count_pairs(
    world: &World<'_, f64>,
    home: impl Fn(u32) -> u32,
    whole: Places<'_>,
) -> ContactCount {
    let mut count = ContactCount {
        contacts: vec![0; world.grains.position.len()],
        deepest: 0.0,
    };
    for (i, j, kept) in listed_pairs(world) {
        let [x, y] = [i, j].map(|k| whole.position[home(k) as usize]);
        let d = whole.domain.separation(head(x), head(y));
        let overlap = (x[3] + y[3]) - dot(d, d).sqrt();
        if overlap > 0.0 || kept.is_any() {
            count.contacts[i as usize] += 1;
            count.contacts[j as usize] += 1;
        }
        if overlap > count.deepest {
            count.deepest = overlap;
        }
    }
    count
}
