//! Every public function of the kernel, in both precisions and in fixed point, under both laws, in tables that the
//! library exports: a compiler can assume nothing of who calls them with what. The handler of panics
//! calls a function that is nowhere, so the library asks for it if, and only if, a panic is reachable.

#![no_std]
// Nothing here reads the tables: who loads the library could.
#![allow(dead_code)]

mod bodies;
mod calls;
mod hosts;
mod parts;
mod state;
// The control needs no more than one table, and is built sooner without these.
#[cfg(not(feature = "control"))]
mod tables;

use state::Plain;

/// What needs no number type.
#[unsafe(no_mangle)]
pub static PLAIN: Plain = Plain::ALL;

/// The control: it panics beyond the end of the slice.
#[cfg(feature = "control")]
#[unsafe(no_mangle)]
pub fn control(words: &[u32], place: usize) -> u32 {
    words[place]
}

unsafe extern "C" {
    safe fn a_panic_is_reachable() -> !;
}

#[panic_handler]
fn panicked(_: &core::panic::PanicInfo) -> ! {
    a_panic_is_reachable()
}
