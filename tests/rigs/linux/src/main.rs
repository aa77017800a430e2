//! Prints the lines of the reference worlds on Linux, with a C library or, where the target has no
//! operating system (a free-standing RISC-V), by system calls alone.

#![no_std]
#![no_main]

use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::conformance::{self, Line, Room};
use bitgrain_kernel::fixed_point::I32F32;
use bitgrain_kernel::{Error as KernelError, Real};

#[cfg_attr(target_os = "none", path = "bare.rs")]
#[cfg_attr(not(target_os = "none"), path = "hosted.rs")]
mod system;

/// Prints everything and returns the exit status.
fn report() -> i32 {
    let mut all = Hasher::new();
    let floats = show::<f64>(&mut all).and_then(|()| show::<f32>(&mut all));
    print(&conformance::last(&all));
    let mut all = Hasher::new();
    let fixed = show::<I32F32>(&mut all);
    print(&conformance::last(&all));
    i32::from(floats.and(fixed).is_err())
}

fn show<R: Real>(all: &mut Hasher) -> Result<(), KernelError> {
    let mut room = Room::<R>::vacant();
    conformance::run(&mut room, all, print)
}

fn print(line: &Line) {
    let text = line.text();
    let mut rest = text.as_slice();
    while let Some(next) = rest.get(system::write(rest)..)
        && next.len() < rest.len()
    {
        rest = next;
    }
}

#[panic_handler]
fn panicked(_: &core::panic::PanicInfo) -> ! {
    system::write(b"# a panic\n");
    system::exit(101)
}
