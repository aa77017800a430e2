//! Prints the lines of the reference worlds from a Cortex-M microcontroller, and then how deep its stack
//! has been. No allocator, no formatting, and no storage but the kernel's own in static memory.

#![no_std]
#![no_main]

#[cfg(feature = "count")]
mod count;
mod stack;

use core::mem::ManuallyDrop;
use core::ptr::addr_of_mut;

use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::conformance::{self, Line, Room};
#[cfg(feature = "no-floats")]
use bitgrain_kernel::fixed_point::I32F32;
use bitgrain_kernel::{Error as KernelError, Real};
use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
use cortex_m_semihosting::hio::{self, HostStream};

// Static, so that the table of sizes counts it where it lies.
static mut ALL: Hasher = Hasher::new();

/// One room after the other, in the same memory.
union Rooms {
    #[cfg(not(feature = "no-floats"))]
    double: ManuallyDrop<Room<f64>>,
    #[cfg(not(feature = "no-floats"))]
    single: ManuallyDrop<Room<f32>>,
    #[cfg(feature = "no-floats")]
    fixed: ManuallyDrop<Room<I32F32>>,
}

// All zero, so that it takes RAM and no flash.
static mut ROOMS: Rooms = Rooms {
    #[cfg(feature = "no-floats")]
    fixed: ManuallyDrop::new(Room::vacant()),
    #[cfg(not(feature = "no-floats"))]
    double: ManuallyDrop::new(Room::vacant()),
};

#[cortex_m_rt::entry]
fn main() -> ! {
    stack::paint();
    let ran = report();
    debug::exit(if ran { EXIT_SUCCESS } else { EXIT_FAILURE });
    loop {
        core::hint::spin_loop();
    }
}

/// Its own frame, so that painting the stack below `main` can overwrite none of its values.
#[inline(never)]
fn report() -> bool {
    let Ok(mut host) = hio::hstdout() else {
        return false;
    };
    // SAFETY: one core, no interrupts, and this function runs once.
    let all = unsafe { &mut *addr_of_mut!(ALL) };
    let ran = worlds(all, &mut host);
    print(&mut host, &conformance::last(all));
    tell_stack(&mut host);
    ran.is_ok()
}

/// Those in fixed point alone, or those in floats: both together are too much for the smallest board.
#[cfg(feature = "no-floats")]
fn worlds(all: &mut Hasher, host: &mut HostStream) -> Result<(), KernelError> {
    // SAFETY: one core, no interrupts, and nothing else borrows the rooms while this does.
    let room = unsafe { &mut *addr_of_mut!(ROOMS.fixed) };
    show(room, all, host)
}

#[cfg(not(feature = "no-floats"))]
fn worlds(all: &mut Hasher, host: &mut HostStream) -> Result<(), KernelError> {
    double(all, host).and_then(|()| single(all, host))
}

#[cfg(not(feature = "no-floats"))]
#[inline(never)]
fn double(all: &mut Hasher, host: &mut HostStream) -> Result<(), KernelError> {
    // SAFETY: as above.
    let room = unsafe { &mut *addr_of_mut!(ROOMS.double) };
    show(room, all, host)
}

#[cfg(not(feature = "no-floats"))]
#[inline(never)]
fn single(all: &mut Hasher, host: &mut HostStream) -> Result<(), KernelError> {
    // SAFETY: as above, and a vacant room is all zero bytes, whatever its precision.
    let room = unsafe {
        addr_of_mut!(ROOMS).write_bytes(0, 1);
        &mut *addr_of_mut!(ROOMS.single)
    };
    show(room, all, host)
}

#[cfg(feature = "count")]
fn show<R: Real>(
    room: &mut Room<R>,
    _: &mut Hasher,
    host: &mut HostStream,
) -> Result<(), KernelError> {
    count::begin();
    count::all(host, room);
    Ok(())
}

#[cfg(not(feature = "count"))]
fn show<R: Real>(
    room: &mut Room<R>,
    all: &mut Hasher,
    host: &mut HostStream,
) -> Result<(), KernelError> {
    conformance::run(room, all, |line| print(host, line))
}

#[inline(never)]
fn print(host: &mut HostStream, line: &Line) {
    // What is not written is missed by who compares the text.
    let _ = host.write_all(&line.text());
}

/// `# stack BYTES of BYTES`: the deepest that it has been, and what there was.
fn tell_stack(host: &mut HostStream) {
    let (deepest, room) = stack::deepest();
    let _ = host.write_all(b"# stack ");
    tell_number(host, deepest);
    let _ = host.write_all(b" of ");
    tell_number(host, room);
    let _ = host.write_all(b"\n");
}

fn tell_number(host: &mut HostStream, number: usize) {
    let mut digits = [b' '; 10];
    let mut left = number;
    let mut shown = 0;
    for digit in digits.iter_mut().rev() {
        *digit = b'0' + (left % 10) as u8;
        left /= 10;
        shown += 1;
        if left == 0 {
            break;
        }
    }
    if let Some(digits) = digits.get(digits.len() - shown..) {
        let _ = host.write_all(digits);
    }
}

/// The image is checked to hold no call of this.
#[panic_handler]
fn panicked(_: &core::panic::PanicInfo) -> ! {
    if let Ok(mut host) = hio::hstdout() {
        let _ = host.write_all(b"# a panic\n");
    }
    debug::exit(EXIT_FAILURE);
    loop {
        core::hint::spin_loop();
    }
}
