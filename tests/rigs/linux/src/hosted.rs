//! Start, output and end by a C library.

use core::ffi::{c_int, c_void};

mod c {
    use super::{c_int, c_void};

    unsafe extern "C" {
        pub safe fn _exit(status: c_int) -> !;
        pub fn write(file: c_int, bytes: *const c_void, count: usize) -> isize;
    }
}

/// What the C library's start code calls.
#[unsafe(no_mangle)]
extern "C" fn main() -> c_int {
    crate::report()
}

/// Writes to standard output and returns how many bytes went out.
pub fn write(bytes: &[u8]) -> usize {
    // SAFETY: the address and the count are those of a slice, which is only read.
    let sent = unsafe { c::write(1, bytes.as_ptr().cast(), bytes.len()) };
    usize::try_from(sent).unwrap_or(0)
}

/// Ends the program.
pub fn exit(status: i32) -> ! {
    c::_exit(status)
}

/// The compiled `core` names it where it could unwind, and a debug build keeps that; nothing unwinds here.
#[cfg(debug_assertions)]
#[unsafe(no_mangle)]
extern "C" fn rust_eh_personality() {}
