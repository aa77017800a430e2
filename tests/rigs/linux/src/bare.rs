//! Start, output and end by Linux's system calls on RISC-V, for a target without a C library.

use core::arch::{asm, global_asm};

#[cfg(not(any(target_arch = "riscv32", target_arch = "riscv64")))]
compile_error!("the system calls are written down for RISC-V only");

const WRITE: usize = 64;
const EXIT: usize = 93;

// Linux begins here with a stack that holds the arguments; data near gp is not used.
global_asm!(".globl _start", "_start:", "andi sp, sp, -16", "call begin");

#[unsafe(no_mangle)]
extern "C" fn begin() -> ! {
    exit(crate::report())
}

/// Writes to standard output and returns how many bytes went out.
pub fn write(bytes: &[u8]) -> usize {
    let mut result = 1isize;
    // SAFETY: the kernel reads the bytes of the slice and changes no memory of the program.
    unsafe {
        asm!(
            "ecall",
            in("a7") WRITE,
            inlateout("a0") result,
            in("a1") bytes.as_ptr(),
            in("a2") bytes.len(),
            options(nostack, readonly),
        );
    }
    usize::try_from(result).unwrap_or(0)
}

/// Ends the program.
pub fn exit(status: i32) -> ! {
    // SAFETY: it does not come back.
    unsafe { asm!("ecall", in("a7") EXIT, in("a0") status, options(noreturn)) }
}
