//! Rows of grains, copied out.

use core::ffi::c_void;

use bitgrain_kernel::Error;

use crate::arguments::lent_mut;
use crate::block::with;
use crate::status::{BG_BAD_ARGUMENT, BG_NO_GRAIN, Done, fault};
use crate::types::{
    BG_FORCE, BG_GROUP, BG_ID, BG_IMAGE, BG_MASS, BG_POSITION, BG_RADIUS, BG_SPIN, BG_TORQUE,
    BG_VELOCITY, bg_fault, bg_world,
};

/// Copies a field of `count` grains from the place `first` on, by ascending id, to `out`: one record every `stride`
/// bytes, or one after the other if `stride` is 0. Types and lengths of records stand at `BG_ID` and the others; `out`
/// need not be aligned. After a fault of the motion only what no step changes can be read: ids, groups, radii, masses.
#[unsafe(no_mangle)]
pub extern "C" fn bg_read(
    world: *mut bg_world,
    field: u32,
    out: *mut c_void,
    stride: usize,
    first: usize,
    count: usize,
) -> i32 {
    with(world, |parts| {
        let world = parts.store.world();
        let g = &world.grains;
        let stays = matches!(field, BG_ID | BG_GROUP | BG_RADIUS | BG_MASS);
        if !stays && !world.clock.has_state() {
            return Err(Error::NotStarted.into());
        }
        let end = first.checked_add(count).filter(|end| *end <= g.count());
        let range = first..end.ok_or(fault(BG_NO_GRAIN))?;
        let rows = |rows: &[[f64; 4]]| {
            let rows = rows.get(range.clone()).unwrap_or_default().iter();
            copy(
                out,
                stride,
                rows.map(|[x, y, z, _]| [*x, *y, *z].map(f64::to_ne_bytes)),
            )
        };
        let lasts = |rows: &[[f64; 4]]| {
            let rows = rows.get(range.clone()).unwrap_or_default().iter();
            copy(out, stride, rows.map(|[.., last]| [last.to_ne_bytes()]))
        };
        match field {
            BG_POSITION => rows(g.position),
            BG_RADIUS => lasts(g.position),
            BG_VELOCITY => rows(g.velocity),
            BG_MASS => lasts(g.velocity),
            BG_SPIN => rows(g.spin),
            BG_FORCE => rows(g.force),
            BG_TORQUE => rows(g.torque),
            BG_ID => {
                let ids = g.id.get(range).unwrap_or_default().iter();
                copy(out, stride, ids.map(|id| [id.to_ne_bytes()]))
            }
            BG_GROUP => {
                let groups = g.group.get(range).unwrap_or_default().iter();
                copy(out, stride, groups.map(|group| [[*group]]))
            }
            BG_IMAGE => {
                let images = g.image.get(range).unwrap_or_default().iter();
                copy(out, stride, images.map(|image| image.map(i32::to_ne_bytes)))
            }
            _ => Err(fault(BG_BAD_ARGUMENT)),
        }
    })
}

/// Copies records of `N` words of `W` bytes.
fn copy<const N: usize, const W: usize>(
    out: *mut c_void,
    stride: usize,
    records: impl ExactSizeIterator<Item = [[u8; W]; N]>,
) -> Done {
    let stride = if stride == 0 { N * W } else { stride };
    if stride < N * W {
        return Err(fault(BG_BAD_ARGUMENT));
    }
    let whole = match records.len().checked_sub(1) {
        None => return Ok(()),
        Some(before) => before
            .checked_mul(stride)
            .and_then(|n| n.checked_add(N * W)),
    };
    let whole = whole.ok_or::<bg_fault>(fault(BG_BAD_ARGUMENT))?;
    // Gaps between records are not written to.
    let bytes = lent_mut(out.cast::<u8>(), whole)?;
    for (to, record) in bytes.chunks_mut(stride).zip(records) {
        for (to, word) in to.chunks_exact_mut(W).zip(record) {
            to.copy_from_slice(&word);
        }
    }
    Ok(())
}
