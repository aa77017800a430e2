//! Histories that go with a grain from one triangle of a mesh to the next.

use crate::integrate::GrainMotion;
use crate::math::real::Real;
use crate::math::rows::{Row, get_or_default, set};
use crate::math::vec3::head;
use crate::neighbors::memory::{MemoryColumns, put, taken};
use crate::neighbors::pair_list::{TOUCHING, obstacle_of, surface_of};
use crate::state::facet::{Facet, to_shared};
use crate::state::obstacle::Obstacle;

/// Gives each contact on a triangle that begins the spring and the words that the grain has on a triangle beside it,
/// if what both share, an edge or a corner, reaches into the grain: the contact has come from there. Of several the
/// nearest counts.
#[inline(never)]
pub(crate) fn hand_on<R: Real>(
    grains: &GrainMotion<'_, R>,
    (listed, words): (&[u32], &[u32]),
    (springs, memory): (&mut [Row<R>], &mut MemoryColumns<'_, R>),
    (obstacles, facets): (&[Obstacle<R>], &[Facet<R>]),
) {
    let count = listed.len();
    let mut begin = 0;
    while begin < count {
        let of = |t: usize| {
            let word = get_or_default(words, t);
            (get_or_default(listed, t), obstacle_of(word))
        };
        let run = of(begin);
        let mut end = begin + 1;
        while end < count && of(end) == run {
            end += 1;
        }
        let (grain, k) = run;
        if let Some(body) = obstacles.get(k as usize).filter(|body| body.is_mesh()) {
            let own = words.get(begin..end).unwrap_or_default();
            // Without an old contact there is nothing to hand on.
            let has_any = own.iter().any(|word| word & TOUCHING != 0);
            for (t, word) in (begin..).zip(own).filter(|_| has_any) {
                if word & TOUCHING == 0
                    && let Some(from) = source(grains, (body, facets), own, grain, *word)
                {
                    let spring = get_or_default(springs, begin + from);
                    set(springs, t, spring);
                    put(memory, t, taken(memory, begin + from));
                }
            }
        }
        begin = end;
    }
}

/// The entry of those of a grain and a mesh whose spring a contact takes over that may begin.
fn source<R: Real>(
    grains: &GrainMotion<'_, R>,
    (body, facets): (&Obstacle<R>, &[Facet<R>]),
    own: &[u32],
    grain: u32,
    word: u32,
) -> Option<usize> {
    let x = get_or_default(grains.position, grain as usize);
    let met = body.meet(surface_of(word), facets, grains.domain, head(x), x[3]);
    let begins = met.overlap > R::ZERO;
    if !begins {
        return None;
    }
    let (mesh, place) = body.in_mesh(facets, met.offset)?;
    let facet = mesh.0.get(surface_of(word) as usize)?;
    let mut best: Option<(R, usize)> = None;
    for (t, word) in own.iter().enumerate() {
        let beside = mesh.0.get(surface_of(*word) as usize)?;
        if word & TOUCHING == 0 || to_shared(facet, beside, place).is_none_or(|far| far >= x[3]) {
            continue;
        }
        let distance = beside.nearest(place).distance;
        if best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, t));
        }
    }
    best.map(|(_, t)| t)
}
