//! Instructions of operations and of a grain's step, by the processor's own clock: in an emulator that takes as long
//! for every instruction as for any other.

use core::hint::black_box;

use bitgrain_kernel::conformance::{Room, World, history};
use bitgrain_kernel::{Real, start, step};
use cortex_m::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::hio::HostStream;

use crate::tell_number;

/// Times that an operation is done.
const TIMES: u32 = 256;

/// Steps that are counted, after as many that are not.
const STEPS: u32 = 50;

/// Starts the clock.
pub fn begin() {
    // SAFETY: one core, no interrupts, and nothing else uses the clock.
    let mut syst = unsafe { Peripherals::steal() }.SYST;
    syst.set_clock_source(SystClkSource::Core);
    syst.set_reload(0x00ff_ffff);
    syst.clear_current();
    syst.enable_counter();
}

/// Ticks that something takes: fewer than 2^24.
#[inline(never)]
fn ticks(what: &mut dyn FnMut()) -> u32 {
    let before = SYST::get_current();
    what();
    before.wrapping_sub(SYST::get_current()) & 0x00ff_ffff
}

/// `# count TYPE WHAT TICKS TIMES`
fn tell(host: &mut HostStream, kind: &str, what: &str, ticks: u64, times: u32) {
    for word in ["# count ", kind, " ", what, " "] {
        let _ = host.write_all(word.as_bytes());
    }
    tell_number(host, ticks as usize);
    let _ = host.write_all(b" ");
    tell_number(host, times as usize);
    let _ = host.write_all(b"\n");
}

/// The four operations and the root, each less a loop that does nothing, and a step of the bed a grain.
pub fn all<R: Real>(host: &mut HostStream, room: &mut Room<R>) {
    let (x, y) = (R::from_f64(1.7182818), R::from_f64(0.5772157));
    let mut nothing = || (0..TIMES).for_each(|_| drop(black_box((black_box(x), black_box(y)).0)));
    let empty = ticks(&mut nothing);
    let operations: [(&str, fn(R, R) -> R); 5] = [
        ("add", |x, y| x + y),
        ("mul", |x, y| x * y),
        ("div", |x, y| x / y),
        ("sqrt", |x, _| x.sqrt()),
        ("compare", |x, y| if x < y { x } else { y }),
    ];
    for (name, operation) in operations {
        let mut many = || {
            (0..TIMES).for_each(|_| drop(black_box(operation(black_box(x), black_box(y)))));
        };
        let taken = ticks(&mut many).saturating_sub(empty);
        tell(host, R::NAME, name, u64::from(taken), TIMES);
    }
    let law = history(50.0);
    let mut sum = 0u64;
    let ready = World::Bed
        .lay(room)
        .and_then(|()| start(&mut room.world(), &law));
    let mut sound = ready.is_ok();
    for n in 0..2 * STEPS {
        let taken = ticks(&mut || sound &= step(&mut room.world(), &law).is_ok());
        sum += if n < STEPS { 0 } else { u64::from(taken) };
    }
    let grains = room.world().grains.count() as u32;
    if sound {
        tell(host, R::NAME, "grain-step", sum, STEPS * grains);
    }
}
