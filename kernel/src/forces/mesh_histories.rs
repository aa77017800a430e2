//! Histories that go with a grain from one triangle of a mesh to the next.

use crate::forces::obstacle_contacts::ObstacleContactRange;
use crate::integrate::GrainMotion;
use crate::math::real::Real;
use crate::math::rows::{get_or_default, set};
use crate::math::vec3::head;
use crate::neighbors::pair_list::{TOUCHING, obstacle_of, surface_of};
use crate::state::facet::to_shared;

/// Gives each contact on a triangle that begins the spring that the grain has on a triangle beside it, if what both
/// share, an edge or a corner, reaches into the grain: the contact has come from there. Of several the nearest counts.
#[inline(never)]
pub(crate) fn hand_on<R: Real>(
    grains: &GrainMotion<'_, R>,
    touch: &mut ObstacleContactRange<'_, R>,
) {
    let count = touch.grain.len();
    let mut begin = 0;
    while begin < count {
        let of = |t: usize| {
            let word = get_or_default(touch.obstacle, t);
            (get_or_default(touch.grain, t), obstacle_of(word))
        };
        let run = of(begin);
        let mut end = begin + 1;
        while end < count && of(end) == run {
            end += 1;
        }
        let (grain, k) = run;
        if touch
            .obstacles
            .get(k as usize)
            .is_some_and(|body| body.is_mesh())
        {
            for t in begin..end {
                let word = get_or_default(touch.obstacle, t);
                if word & TOUCHING == 0
                    && let Some(from) = source(grains, touch, (begin, end), grain, surface_of(word))
                {
                    let spring = get_or_default(touch.spring, from);
                    set(touch.spring, t, spring);
                }
            }
        }
        begin = end;
    }
}

/// The entry of the run, those of a grain and a mesh, whose spring a contact takes over that may begin.
fn source<R: Real>(
    grains: &GrainMotion<'_, R>,
    touch: &ObstacleContactRange<'_, R>,
    (begin, end): (usize, usize),
    grain: u32,
    surface: u32,
) -> Option<usize> {
    let word = get_or_default(touch.obstacle, begin);
    let body = touch.obstacles.get(obstacle_of(word) as usize)?;
    let x = get_or_default(grains.position, grain as usize);
    let met = body.meet(surface, touch.facets, grains.domain, head(x), x[3]);
    let (mesh, place) = body.in_mesh(touch.facets, met.offset)?;
    let own = mesh.0.get(surface as usize)?;
    let is_new = met.overlap > R::ZERO;
    let mut best: Option<(R, usize)> = None;
    for t in (begin..end).filter(|_| is_new) {
        let word = get_or_default(touch.obstacle, t);
        let beside = mesh.0.get(surface_of(word) as usize)?;
        if word & TOUCHING == 0 || to_shared(own, beside, place).is_none_or(|far| far >= x[3]) {
            continue;
        }
        let distance = beside.nearest(place).distance;
        if best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, t));
        }
    }
    best.map(|(_, t)| t)
}
