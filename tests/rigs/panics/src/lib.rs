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

use bitgrain_kernel::contact::{HertzHistory, HertzTsuji, PairLaws, Rolling};
use bitgrain_kernel::fixed_point::I32F32;

use bodies::Bodies;
use calls::Calls;
use state::{Fixed, Plain, State};

/// What needs no number type.
#[unsafe(no_mangle)]
pub static PLAIN: Plain = Plain::ALL;
/// Worlds and their parts in double precision.
#[unsafe(no_mangle)]
pub static STATE_F64: State<f64> = State::ALL;
/// The same in single precision.
#[unsafe(no_mangle)]
pub static STATE_F32: State<f32> = State::ALL;
/// Rigid bodies.
#[unsafe(no_mangle)]
pub static BODIES_F64: Bodies<f64> = Bodies::ALL;
/// The same in single precision.
#[unsafe(no_mangle)]
pub static BODIES_F32: Bodies<f32> = Bodies::ALL;
/// The same in fixed point.
#[unsafe(no_mangle)]
pub static BODIES_FIXED: Bodies<I32F32> = Bodies::ALL;
/// Steps and their phases, by precision and law.
#[unsafe(no_mangle)]
pub static HISTORY_F64: Calls<f64, HertzHistory<f64>> = Calls::ALL;
/// Steps and their phases, by precision and law.
#[unsafe(no_mangle)]
pub static HISTORY_F32: Calls<f32, HertzHistory<f32>> = Calls::ALL;
/// Steps and their phases, by precision and law.
#[unsafe(no_mangle)]
pub static TSUJI_F64: Calls<f64, HertzTsuji<f64>> = Calls::ALL;
/// Steps and their phases, by precision and law.
#[unsafe(no_mangle)]
pub static TSUJI_F32: Calls<f32, HertzTsuji<f32>> = Calls::ALL;

/// Steps and their phases under a law of several materials.
#[unsafe(no_mangle)]
pub static PAIRS_F64: Calls<f64, PairLaws<'static, HertzTsuji<f64>>> = Calls::ALL;
/// Steps and their phases under a law that resists rolling.
#[unsafe(no_mangle)]
pub static ROLLING_F64: Calls<f64, PairLaws<'static, Rolling<f64, HertzTsuji<f64>>>> = Calls::ALL;
/// The same in fixed point, of one material.
#[unsafe(no_mangle)]
pub static ROLLING_FIXED: Calls<I32F32, Rolling<I32F32, HertzHistory<I32F32>>> = Calls::ALL;

/// Worlds and their parts in fixed point.
#[unsafe(no_mangle)]
pub static STATE_FIXED: State<I32F32> = State::ALL;
/// Steps and their phases there, by law.
#[unsafe(no_mangle)]
pub static HISTORY_FIXED: Calls<I32F32, HertzHistory<I32F32>> = Calls::ALL;
/// Steps and their phases there, by law.
#[unsafe(no_mangle)]
pub static TSUJI_FIXED: Calls<I32F32, HertzTsuji<I32F32>> = Calls::ALL;
/// What is known of the types.
#[unsafe(no_mangle)]
pub static FIXED: Fixed = Fixed::ALL;

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
