//! The tables, by number type and law.

use bitgrain_kernel::contact::{HertzHistory, HertzTsuji, PairLaws, Rolling};
use bitgrain_kernel::fixed_point::I32F32;

use crate::bodies::Bodies;
use crate::calls::Calls;
use crate::state::{Fixed, State};

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
