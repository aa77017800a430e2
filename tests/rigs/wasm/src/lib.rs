//! The reference worlds as a WebAssembly module that imports nothing: `run` writes the lines into the
//! module's memory, from `text` on, and gives their length.

#![no_std]

use core::ptr::addr_of_mut;

use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::conformance::{self, LINE, Line, Room};
use bitgrain_kernel::fixed_point::I32F32;
use bitgrain_kernel::{Error as KernelError, Real};

/// Room for several times the lines that there are.
static mut TEXT: [u8; 512 * LINE] = [0; 512 * LINE];

/// Where the text begins in the exported memory.
#[unsafe(no_mangle)]
pub extern "C" fn text() -> *const u8 {
    addr_of_mut!(TEXT).cast()
}

/// Runs every world and returns the bytes of text that came of it.
#[unsafe(no_mangle)]
pub extern "C" fn run() -> usize {
    // SAFETY: the module has one thread, and this is the only place that borrows the text.
    let text = unsafe { &mut *addr_of_mut!(TEXT) };
    let mut length = 0;
    let mut put = |line: &Line| {
        if let Some(place) = text.get_mut(length..length + LINE) {
            place.copy_from_slice(&line.text());
            length += LINE;
        }
    };
    let mut all = Hasher::new();
    // A fault shows as lines that are missing.
    let _ = lines::<f64>(&mut all, &mut put).and_then(|()| lines::<f32>(&mut all, &mut put));
    put(&conformance::last(&all));
    let mut all = Hasher::new();
    let _ = lines::<I32F32>(&mut all, &mut put);
    put(&conformance::last(&all));
    length
}

fn lines<R: Real>(all: &mut Hasher, put: &mut impl FnMut(&Line)) -> Result<(), KernelError> {
    let mut room = Room::<R>::vacant();
    conformance::run(&mut room, all, put)
}

#[panic_handler]
fn panicked(_: &core::panic::PanicInfo) -> ! {
    core::arch::wasm32::unreachable()
}
