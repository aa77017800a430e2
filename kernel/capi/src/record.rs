//! Recordings of any simulator: a line of text for each array of each step, which the caller writes to a file.

use core::ffi::{c_char, c_void};

use bitgrain_kernel::record::{Chain, Element, HEAD, NAME_MAX, Refusal, length};

use crate::arguments::{give, lent, lent_mut, take, text};
use crate::status::{BG_BAD_RECORD, BG_OK, BG_TOO_SMALL, Done, fault};
use crate::types::{bg_fault, bg_recording};

fn code(done: Done) -> i32 {
    done.map_or_else(|fault| fault.code, |()| BG_OK)
}

fn refused(_: Refusal) -> bg_fault {
    fault(BG_BAD_RECORD)
}

/// Writes a text and a zero.
fn put(line: &str, out: *mut c_char, size: usize) -> Done {
    let bytes = line.as_bytes();
    if size <= bytes.len() {
        return Err(fault(BG_TOO_SMALL));
    }
    let out = lent_mut(out.cast::<u8>(), bytes.len() + 1)?;
    for (to, byte) in out.iter_mut().zip(bytes.iter().chain(&[0])) {
        *to = *byte;
    }
    Ok(())
}

/// Begins a recording: writes its first two lines, and a zero, to `out` of `size` bytes; `BG_LINE` are enough.
/// `bitgrain bisect A B` finds the step and the array at which two recordings part.
#[unsafe(no_mangle)]
pub extern "C" fn bg_record_begin(
    recording: *mut bg_recording,
    out: *mut c_char,
    size: usize,
) -> i32 {
    let begin = || {
        take(recording.cast_const())?;
        put(HEAD, out, size)?;
        keep(recording, &Chain::new())
    };
    code(begin())
}

/// Writes the line of an array at a step, and a zero, to `out`. `type_name` is `"f64"`, `"f32"`, `"i32"`, `"u8"` and so
/// on; `shape` has `axes` lengths, none for a single number; `data` are the elements row by row, little-endian. Steps
/// do not descend, and the arrays of a step have names of their own.
#[unsafe(no_mangle)]
pub extern "C" fn bg_record(
    recording: *mut bg_recording,
    step: u64,
    name: *const c_char,
    type_name: *const c_char,
    shape: *const usize,
    axes: usize,
    data: *const c_void,
    out: *mut c_char,
    size: usize,
) -> i32 {
    let record = || {
        let now = take(recording.cast_const())?;
        let none = fault(BG_BAD_RECORD);
        let name = text(name, NAME_MAX)?.ok_or(none)?;
        let kind = text(type_name, 8)?.and_then(Element::of).ok_or(none)?;
        let shape = lent(shape, axes)?;
        let bytes = lent(data.cast::<u8>(), length(kind, shape).map_err(refused)?)?;
        let mut chain = Chain::at(now.step, now.link);
        let line = chain.add(step, name, kind, shape, bytes);
        put(line.map_err(refused)?.text(), out, size)?;
        keep(recording, &chain)
    };
    code(record())
}

/// Writes the last line of a recording, and a zero, to `out`. Without it a recording is not whole.
#[unsafe(no_mangle)]
pub extern "C" fn bg_record_end(
    recording: *mut bg_recording,
    out: *mut c_char,
    size: usize,
) -> i32 {
    let end = || {
        let now = take(recording.cast_const())?;
        put(Chain::at(now.step, now.link).end().text(), out, size)
    };
    code(end())
}

fn keep(recording: *mut bg_recording, chain: &Chain) -> Done {
    give(
        recording,
        bg_recording {
            size: size_of::<bg_recording>() as u32,
            reserved: 0,
            step: chain.step(),
            link: *chain.link(),
        },
    )
}
