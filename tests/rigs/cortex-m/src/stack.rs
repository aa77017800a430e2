//! How deep the stack has been: it is painted at first, and later the paint that is left is measured.

use core::ptr::addr_of_mut;

/// Not a likely value of anything.
const PAINT: u32 = 0xc5c5_c5c5;

/// Words just below the painting function that it may use itself.
const MARGIN: usize = 16;

unsafe extern "C" {
    // Addresses, by the linker script: the end of the static data, and where the stack begins.
    static mut __sheap: u32;
    static mut _stack_start: u32;
}

/// Paints all of the stack that is free. What is called from the same function afterwards is measured.
#[inline(never)]
pub fn paint() {
    let lowest = addr_of_mut!(__sheap);
    let own = cortex_m::register::msp::read() as usize / size_of::<u32>();
    let words = own.saturating_sub(lowest as usize / size_of::<u32>() + MARGIN);
    for k in 0..words {
        // SAFETY: above the static data and below this function's own frame lies nothing yet.
        unsafe { lowest.add(k).write_volatile(PAINT) };
    }
}

/// Bytes of the stack that were used at most since [`paint`], and bytes that there are.
#[inline(never)]
pub fn deepest() -> (usize, usize) {
    let lowest = addr_of_mut!(__sheap);
    let room = addr_of_mut!(_stack_start) as usize - lowest as usize;
    let mut clean = 0;
    // SAFETY: every word of the stack can be read.
    while clean < room / size_of::<u32>() && unsafe { lowest.add(clean).read_volatile() } == PAINT {
        clean += 1;
    }
    (room - clean * size_of::<u32>(), room)
}
