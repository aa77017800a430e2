//! Worlds as bytes: the contact law and its BLAKE3 hash, then the kernel's saved world.

use core::ffi::c_void;

use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::{Error, save, save_size};

use crate::block::{lent, lent_mut, put, with};
use crate::setup::{law_for_c, law_of};
use crate::status::Done;
use crate::types::{bg_law, bg_world};

/// How the bytes begin.
const MAGIC: [u32; 2] = [u32::from_le_bytes(*b"bglw"), 1];
/// Words of the law: the beginning, its kind, five numbers of two words.
const WORDS: usize = 2 + 1 + 10;
/// Bytes of the law and its hash.
const LAW: usize = 4 * WORDS + 32;

/// Sets `out` to the bytes that `bg_save` needs now.
#[unsafe(no_mangle)]
pub extern "C" fn bg_save_size(world: *mut bg_world, out: *mut usize) -> i32 {
    with(world, |parts| {
        put(out, LAW.saturating_add(save_size(&parts.store.world())))
    })
}

/// Writes a world at rest to `out` of `size` bytes; `bg_load` goes on from there with the same bits, in a block of any
/// capacity that holds it, on any machine.
#[unsafe(no_mangle)]
pub extern "C" fn bg_save(world: *mut bg_world, out: *mut c_void, size: usize) -> i32 {
    with(world, |parts| {
        let words = words(&law_for_c(parts.law));
        let mut world = parts.store.world();
        let needed = LAW.saturating_add(save_size(&world));
        if size < needed {
            return Err(Error::BufferTooShort { needed }.into());
        }
        let bytes = lent_mut(out.cast::<u8>(), size)?;
        let (law, rest) = bytes.split_at_mut_checked(LAW).unwrap_or_default();
        save(&mut world, rest)?;
        let (text, hash) = law.split_at_mut_checked(4 * WORDS).unwrap_or_default();
        for (to, word) in text.chunks_exact_mut(4).zip(words) {
            to.copy_from_slice(&word.to_le_bytes());
        }
        for (to, byte) in hash.iter_mut().zip(hashed(&words)) {
            *to = byte;
        }
        Ok(())
    })
}

/// Replaces a world, its law too, by what `bg_save` wrote; its skins stay. Bytes that are not as they were written are
/// refused, and nothing is lost. After a full list the world is stopped: lessen its skin and load again.
#[unsafe(no_mangle)]
pub extern "C" fn bg_load(world: *mut bg_world, bytes: *const c_void, size: usize) -> i32 {
    with(world, |parts| {
        let bytes = lent(bytes.cast::<u8>(), size)?;
        let (law, rest) = bytes.split_at_checked(LAW).ok_or(Error::BadSave)?;
        let (text, hash) = law.split_at_checked(4 * WORDS).ok_or(Error::BadSave)?;
        let mut words = [0; WORDS];
        for (word, from) in words.iter_mut().zip(text.as_chunks::<4>().0) {
            *word = u32::from_le_bytes(*from);
        }
        if hash != hashed(&words) {
            return Err(Error::BadSave.into());
        }
        let law = law_in(&words)?;
        let done: Done = parts.store.load(rest).map_err(Into::into);
        if done.is_ok() {
            *parts.law = law;
            *parts.departed = 0;
            *parts.stepped = 0;
            parts.sums.fill([0.0; 6]);
        }
        done
    })
}

fn words(law: &bg_law) -> [u32; WORDS] {
    let mut words = [0; WORDS];
    let numbers = [law.kn, law.kt, law.gamma_n, law.gamma_t, law.mu];
    let halves = numbers.iter().flat_map(|number| {
        let bits = number.to_bits();
        [bits as u32, (bits >> 32) as u32]
    });
    let all = MAGIC.into_iter().chain([law.kind]).chain(halves);
    for (to, word) in words.iter_mut().zip(all) {
        *to = word;
    }
    words
}

fn law_in(words: &[u32; WORDS]) -> Result<crate::block::Law, crate::types::bg_fault> {
    let [first, second, kind, halves @ ..] = words;
    if [*first, *second] != MAGIC {
        return Err(Error::OtherVersion.into());
    }
    let mut numbers = [0.0; 5];
    for (number, [low, high]) in numbers.iter_mut().zip(halves.as_chunks::<2>().0) {
        *number = f64::from_bits(u64::from(*low) | u64::from(*high) << 32);
    }
    let [kn, kt, gamma_n, gamma_t, mu] = numbers;
    law_of(&bg_law {
        size: size_of::<bg_law>() as u32,
        kind: *kind,
        kn,
        kt,
        gamma_n,
        gamma_t,
        mu,
    })
}

fn hashed(words: &[u32; WORDS]) -> [u8; 32] {
    let mut hasher = Hasher::new();
    for word in words {
        hasher.word(*word);
    }
    hasher.finish()
}
