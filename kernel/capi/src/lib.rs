//! The kernel for programs in C and C++, and for whatever calls C.
//!
//! A world lives in one block of memory that the caller lends, and only there: nothing is allocated, and no pointer is
//! kept, so that a block may be copied or moved between calls. Each function takes the block, makes a
//! [`LentStore`](bitgrain_kernel::LentStore) of it and calls the kernel. `unsafe` is here alone, and each use has its
//! reason beside it.
//!
//! * [`types`]: what C sees; [`status`]: the numbers of errors and their texts;
//! * [`arguments`]: what pointers lead to; [`block`]: the block and its parts;
//! * [`setup`], [`laws`], [`grains`], [`steps`], [`rows`], [`saved`]: the functions;
//! * [`record`]: recordings of any simulator, which need no world.
//!
//! What a pointer points to is the caller's promise, as everywhere in C. The functions are not marked `unsafe` for
//! that, because only tests call them from Rust: a program in Rust takes the kernel itself.
//!
//! `include/bitgrain.h` is made of these files by cbindgen; a test compares them.
#![no_std]
#![allow(non_camel_case_types)]

// The tests build the same files as a crate for Rust, beside std, whose handler of panics it then takes.
#[cfg(feature = "std")]
extern crate std;

pub mod arguments;
pub mod block;
pub mod grains;
pub mod laws;
pub mod obstacles;
pub mod record;
pub mod rows;
pub mod saved;
pub mod setup;
pub mod status;
pub mod steps;
pub mod types;

/// The number of the functions and structures: one that is higher may have more of them, and no others.
pub const BG_ABI_VERSION: u32 = 4;

/// The `BG_ABI_VERSION` that the library was built with: compare it with the header's.
#[unsafe(no_mangle)]
pub extern "C" fn bg_abi_version() -> u32 {
    BG_ABI_VERSION
}

/// The arithmetic of a step: libraries with the same number give the same bits.
#[unsafe(no_mangle)]
pub extern "C" fn bg_bits_version() -> u32 {
    bitgrain_kernel::BITS_VERSION
}

#[cfg(not(feature = "std"))]
mod panics {
    #[cfg(feature = "panic-probe")]
    unsafe extern "C" {
        safe fn bg_a_panic_is_reachable() -> !;
    }

    /// Never called: no input makes the kernel or this library panic, as a test shows.
    #[panic_handler]
    fn panicked(_: &core::panic::PanicInfo) -> ! {
        #[cfg(feature = "panic-probe")]
        bg_a_panic_is_reachable();
        #[cfg(not(feature = "panic-probe"))]
        loop {
            core::hint::spin_loop();
        }
    }
}
