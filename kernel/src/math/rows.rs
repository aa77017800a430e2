//! Reading and writing lent slices without a way to panic.
//!
//! A world's slices are checked to fit together before a step relies on them, so the case that is
//! handled here in place of a panic is never seen; without a panic the kernel can go into firmware
//! that must not have one.

use crate::math::real::Real;
use crate::math::vec3::Vec3;

/// Four words: the unit of grain storage, and the layout that other languages lend.
pub type Row<R> = [R; 4];

/// The entry at a place; the default beyond the end.
#[inline(always)]
pub(crate) fn get_or_default<T: Copy + Default>(slice: &[T], place: usize) -> T {
    slice.get(place).copied().unwrap_or_default()
}

/// Writes the entry at a place; nothing beyond the end.
#[inline(always)]
pub(crate) fn set<T>(slice: &mut [T], place: usize, value: T) {
    if let Some(entry) = slice.get_mut(place) {
        *entry = value;
    }
}

/// A vector as a row.
#[inline(always)]
pub(crate) fn row<R: Real>(v: Vec3<R>) -> Row<R> {
    [v[0], v[1], v[2], R::ZERO]
}

// Rows are computed whole if that changes no word that is used: each is one wide operation then.

/// The sum of two rows.
#[inline(always)]
pub(crate) fn plus<R: Real>(a: &Row<R>, b: &Row<R>) -> Row<R> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}

/// The difference of two rows.
#[inline(always)]
pub(crate) fn less<R: Real>(a: &Row<R>, b: &Row<R>) -> Row<R> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

/// A row times a number.
#[inline(always)]
pub(crate) fn times<R: Real>(row: &Row<R>, by: R) -> Row<R> {
    [row[0] * by, row[1] * by, row[2] * by, row[3] * by]
}

/// Adds to the row at a place.
#[inline(always)]
pub(crate) fn add_at<R: Real>(rows: &mut [Row<R>], place: usize, by: &Row<R>) {
    if let Some(row) = rows.get_mut(place) {
        *row = plus(row, by);
    }
}

/// Subtracts from the row at a place.
#[inline(always)]
pub(crate) fn sub_at<R: Real>(rows: &mut [Row<R>], place: usize, by: &Row<R>) {
    if let Some(row) = rows.get_mut(place) {
        *row = less(row, by);
    }
}

/// A slice from its beginning to `end`; empty if it is shorter.
#[inline(always)]
pub(crate) fn prefix<T>(slice: &[T], end: usize) -> &[T] {
    slice.get(..end).unwrap_or_default()
}

/// The same to write to.
#[inline(always)]
pub(crate) fn front_mut<T>(slice: &mut [T], end: usize) -> &mut [T] {
    slice.get_mut(..end).unwrap_or_default()
}

/// Both sides of a place; all on the left if the slice is shorter.
#[inline(always)]
pub(crate) fn split_at<T>(slice: &[T], place: usize) -> (&[T], &[T]) {
    slice.split_at_checked(place).unwrap_or((slice, &[]))
}

/// The same to write to.
#[inline(always)]
pub(crate) fn halves_mut<T>(slice: &mut [T], place: usize) -> (&mut [T], &mut [T]) {
    let place = if place < slice.len() {
        place
    } else {
        slice.len()
    };
    slice.split_at_mut_checked(place).unwrap_or_default()
}

/// A slice from `begin` to `end`; empty if it is shorter.
#[inline(always)]
pub(crate) fn part<T>(slice: &[T], begin: usize, end: usize) -> &[T] {
    slice.get(begin..end).unwrap_or_default()
}

/// The same to write to.
#[inline(always)]
pub(crate) fn part_mut<T>(slice: &mut [T], begin: usize, end: usize) -> &mut [T] {
    slice.get_mut(begin..end).unwrap_or_default()
}

/// Copies a slice to one of the same length; nothing if the lengths differ.
#[inline(always)]
pub(crate) fn copy<T: Copy>(to: &mut [T], from: &[T]) {
    // A compiler that sees one length makes one copy of it, and this cannot panic.
    if to.len() == from.len() {
        for (to, from) in to.iter_mut().zip(from) {
            *to = *from;
        }
    }
}

/// Shortens a lent slice to its beginning.
pub(crate) fn shorten<T>(slice: &mut &mut [T], end: usize) {
    let whole = core::mem::take(slice);
    *slice = whole.get_mut(..end).unwrap_or_default();
}

/// The larger of two numbers of entries.
#[inline(always)]
pub(crate) fn max(a: usize, b: usize) -> usize {
    if a > b { a } else { b }
}

/// The smaller of two numbers of entries.
#[inline(always)]
pub(crate) fn min(a: usize, b: usize) -> usize {
    if a < b { a } else { b }
}

/// Shell's sort with these gaps, of which the last is 1: it cannot panic, whatever the order is.
#[inline(always)]
pub(crate) fn sort_by<T: Copy + Default>(
    items: &mut [T],
    gaps: &[usize],
    is_before: impl Fn(&T, &T) -> bool,
) {
    for gap in gaps.iter().copied() {
        for k in gap..items.len() {
            let item = get_or_default(items, k);
            let mut place = k;
            while place >= gap && is_before(&item, &get_or_default(items, place - gap)) {
                let before = get_or_default(items, place - gap);
                set(items, place, before);
                place -= gap;
            }
            set(items, place, item);
        }
    }
}
