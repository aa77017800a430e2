//! What a caller's pointers lead to: structures, arrays and texts. What C promises, and what is checked here, is
//! written at each `unsafe`.

use core::ffi::c_char;

use crate::status::{BG_BAD_ARGUMENT, BG_BAD_SIZE, BG_MISALIGNED, BG_NULL, Done, fault};
use crate::types::bg_fault;

/// A structure that the caller lends, if its size is right.
pub(crate) fn take<T: Copy>(from: *const T) -> Result<T, bg_fault> {
    check(from)?;
    // SAFETY: not null, aligned, and the caller wrote at least a size, which each structure begins with.
    let size = unsafe { from.cast::<u32>().read() };
    if size as usize != size_of::<T>() {
        return Err(fault(BG_BAD_SIZE));
    }
    // SAFETY: the size says that it is whole, and all fields are numbers.
    Ok(unsafe { from.read() })
}

/// Writes a structure to where the caller says, if the size that stands there is right.
pub(crate) fn give<T: Copy>(to: *mut T, value: T) -> Done {
    take(to.cast_const())?;
    // SAFETY: as `take` has read from there, it is a whole structure.
    unsafe { to.write(value) };
    Ok(())
}

/// Entries that the caller lends.
pub(crate) fn lent<'a, T>(from: *const T, count: usize) -> Result<&'a [T], bg_fault> {
    if count == 0 {
        return Ok(&[]);
    }
    check(from)?;
    check_length::<T>(count)?;
    // SAFETY: not null, aligned, no longer than an address space; the caller says that they are there, and they are
    // read before the call returns.
    Ok(unsafe { core::slice::from_raw_parts(from, count) })
}

/// Entries that the caller lends for writing.
pub(crate) fn lent_mut<'a, T>(to: *mut T, count: usize) -> Result<&'a mut [T], bg_fault> {
    if count == 0 {
        return Ok(&mut []);
    }
    check(to.cast_const())?;
    check_length::<T>(count)?;
    // SAFETY: as `lent`; they are initialised or plain numbers that are written only.
    Ok(unsafe { core::slice::from_raw_parts_mut(to, count) })
}

/// A vector.
pub(crate) fn vector(from: *const f64) -> Result<[f64; 3], bg_fault> {
    let numbers = lent(from, 3)?;
    numbers.try_into().map_err(|_| fault(BG_BAD_ARGUMENT))
}

/// Writes one value.
pub(crate) fn put<T: Copy>(to: *mut T, value: T) -> Done {
    check(to.cast_const())?;
    // SAFETY: not null and aligned; the caller says that there is room for it.
    unsafe { to.write(value) };
    Ok(())
}

/// A text that ends with a zero, if that comes within `most` bytes.
pub(crate) fn text<'a>(from: *const c_char, most: usize) -> Result<Option<&'a str>, bg_fault> {
    check(from)?;
    for length in 0..=most {
        // SAFETY: the caller says that a zero ends the text, and none of the bytes before this one was it.
        if unsafe { from.add(length).read() } == 0 {
            let bytes = lent(from.cast::<u8>(), length)?;
            return Ok(core::str::from_utf8(bytes).ok());
        }
    }
    Ok(None)
}

fn check<T>(pointer: *const T) -> Done {
    if pointer.is_null() {
        return Err(fault(BG_NULL));
    }
    match pointer.is_aligned() {
        true => Ok(()),
        false => Err(fault(BG_MISALIGNED)),
    }
}

fn check_length<T>(count: usize) -> Done {
    let bytes = count.checked_mul(size_of::<T>());
    match bytes.is_some_and(|bytes| isize::try_from(bytes).is_ok()) {
        true => Ok(()),
        false => Err(fault(BG_BAD_ARGUMENT)),
    }
}

/// A flag of a structure: 0 or 1.
pub(crate) fn flag(word: u32) -> Result<bool, bg_fault> {
    match word {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(fault(BG_BAD_ARGUMENT)),
    }
}

/// Bits 0, 1, 2 of a word: whether x, y, z.
pub(crate) fn axes(word: u32) -> Result<[bool; 3], bg_fault> {
    match word {
        0..=7 => Ok([0, 1, 2].map(|a| word >> a & 1 != 0)),
        _ => Err(fault(BG_BAD_ARGUMENT)),
    }
}
