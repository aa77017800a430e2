//! Worlds as bytes: the contact law and its BLAKE3 hash, then the kernel's saved world.

use core::ffi::c_void;

use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::contact::{RollingResistance, RollingSpring};
use bitgrain_kernel::{Error, save, save_size};

use crate::arguments::{lent, lent_mut, put};
use crate::block::{Parts, Row, pairs_of, with};
use crate::laws::{kind_of, law_of, row_of, table_of};
use crate::status::{BG_LAW_MISFIT, Done, fault};
use crate::types::{BG_NO_ROLLING, BG_ROLLING_EPSD2, BG_ROLLING_SDS, bg_fault, bg_law, bg_world};

/// How the bytes begin.
const MAGIC: [u32; 2] = [u32::from_le_bytes(*b"bglw"), 1];
/// Words of the beginning and the kind.
const HEAD: usize = 3;
/// Bytes of a hash.
const HASH: usize = 32;
/// Numbers of a law, and of one that resists rolling: 0 for `sds` or 1 for `epsd2`, stiffness, damping, coefficient.
const NUMBERS: usize = 5;
const ROLLING_NUMBERS: usize = NUMBERS + 4;

/// How the law of a world is written: the kinds of laws are 1 and 2; of tables 3 and 4, or 5 and 6 if they resist
/// rolling.
#[derive(Clone, Copy)]
struct Form {
    kind: u32,
    /// How many materials there are; none of a law of one.
    materials: Option<u8>,
    rolls: bool,
}

impl Form {
    fn of(parts: &Parts<'_>) -> Self {
        let (kind, materials) = kind_of(parts.law);
        let rolls = |row: &Row| row.resistance != RollingResistance::NONE;
        Self {
            kind,
            materials,
            rolls: materials.is_some() && parts.table.iter().any(rolls),
        }
    }

    /// That with this word, before it is known how many materials it has.
    fn with_word(word: u32) -> Option<Self> {
        let (materials, rolls) = match word {
            1 | 2 => (None, false),
            3 | 4 => (Some(0), false),
            5 | 6 => (Some(0), true),
            _ => return None,
        };
        let kind = if word % 2 == 1 { 1 } else { 2 };
        Some(Self {
            kind,
            materials,
            rolls,
        })
    }

    fn word(self) -> u32 {
        match (self.materials, self.rolls) {
            (None, _) => self.kind,
            (Some(_), false) => self.kind + 2,
            (Some(_), true) => self.kind + 4,
        }
    }

    /// Numbers of each pair.
    fn numbers(self) -> usize {
        match self.rolls {
            true => ROLLING_NUMBERS,
            false => NUMBERS,
        }
    }

    /// Pairs, and words before their numbers.
    fn rows(self) -> (usize, usize) {
        match self.materials {
            None => (1, HEAD),
            Some(count) => (pairs_of(count.into()), HEAD + 1),
        }
    }

    /// Bytes of the law without its hash.
    fn bytes(self) -> usize {
        let (rows, head) = self.rows();
        4 * head + 8 * rows * self.numbers()
    }
}

/// Sets `out` to the bytes that `bg_save` needs now.
#[unsafe(no_mangle)]
pub extern "C" fn bg_save_size(world: *mut bg_world, out: *mut usize) -> i32 {
    with(world, |parts| {
        let law = Form::of(parts).bytes() + HASH;
        put(out, law.saturating_add(save_size(&parts.store.world())))
    })
}

/// Writes a world at rest to `out` of `size` bytes; `bg_load` goes on from there with the same bits, in a block of any
/// capacity that holds it, on any machine.
#[unsafe(no_mangle)]
pub extern "C" fn bg_save(world: *mut bg_world, out: *mut c_void, size: usize) -> i32 {
    with(world, |parts| {
        if !parts.store.world().clock.has_state() {
            return Err(Error::NotStarted.into());
        }
        let form = Form::of(parts);
        let law = form.bytes();
        let needed = save_size(&parts.store.world()).saturating_add(law + HASH);
        if size < needed {
            return Err(Error::BufferTooShort { needed }.into());
        }
        let bytes = lent_mut(out.cast::<u8>(), size)?;
        let (text, rest) = bytes.split_at_mut_checked(law).unwrap_or_default();
        let (hash, rest) = rest.split_at_mut_checked(HASH).unwrap_or_default();
        save(&mut parts.store.world(), rest)?;
        let mut to = Words(text, Hasher::new());
        to.law(parts, form);
        for (to, byte) in hash.iter_mut().zip(to.1.finish()) {
            *to = byte;
        }
        Ok(())
    })
}

/// Replaces a world, its law too, by what `bg_save` wrote; its skins stay. Bytes that are not as they were written are
/// refused, and nothing is lost; those behind the end of what was written are not looked at, so that `size` may be that
/// of a buffer. After a full list the world is stopped: lessen its skin and load again.
#[unsafe(no_mangle)]
pub extern "C" fn bg_load(world: *mut bg_world, bytes: *const c_void, size: usize) -> i32 {
    with(world, |parts| {
        let bytes = lent(bytes.cast::<u8>(), size)?;
        let words = bytes.as_chunks::<4>().0;
        let mut at = words.iter().map(|word| u32::from_le_bytes(*word));
        let mut next = || at.next().unwrap_or(0);
        let magic = [next(), next()];
        let form = Form::with_word(next());
        let form = form.map(|form| Form {
            materials: form.materials.map(|_| u8::try_from(next()).unwrap_or(0)),
            ..form
        });
        let form = form.filter(|form| form.materials != Some(0));
        // Of a law that is none, the least that there can be.
        let law = form.map_or(4 * HEAD, Form::bytes);
        let (law, rest) = bytes.split_at_checked(law).ok_or(Error::BadSave)?;
        let (hash, rest) = rest.split_at_checked(HASH).ok_or(Error::BadSave)?;
        let form = form.ok_or(Error::BadSave)?;
        let words = law.as_chunks::<4>().0;
        if hash != hashed(words) {
            return Err(Error::BadSave.into());
        }
        if magic != MAGIC {
            return Err(Error::OtherVersion.into());
        }
        let (rows, head) = form.rows();
        let numbers = words.get(head..).unwrap_or_default();
        let numbers = numbers.as_chunks::<2>().0;
        let row = |k: usize| read(numbers.get(k * form.numbers()..).unwrap_or_default(), form);
        for k in 0..rows {
            row(k)?;
        }
        let law = match form.materials {
            None => law_of(form.kind, &row(0)?)?,
            Some(_) if parts.table.len() < rows => return Err(fault(BG_LAW_MISFIT)),
            Some(count) => table_of(form.kind, count.into(), &row(0)?)?,
        };
        let done: Done = parts.store.load(rest).map_err(Into::into);
        if done.is_ok() {
            *parts.law = law;
            if form.materials.is_some() {
                for (k, entry) in parts.table.iter_mut().enumerate().take(rows) {
                    *entry = row(k)?;
                }
            }
            *parts.departed = 0;
            *parts.stepped = 0;
            parts.sums.fill([0.0; 6]);
        }
        done
    })
}

/// The law of a pair in its numbers, each of two words.
fn read(numbers: &[[[u8; 4]; 2]], form: Form) -> Result<Row, bg_fault> {
    let number = |k: usize| {
        let [low, high] = numbers.get(k).copied().unwrap_or_default();
        let [low, high] = [low, high].map(|word| u64::from(u32::from_le_bytes(word)));
        f64::from_bits(low | high << 32)
    };
    let own = |k: usize| match form.rolls {
        true => number(NUMBERS + k),
        false => 0.0,
    };
    let rolling = match (form.rolls, own(0)) {
        (false, _) => BG_NO_ROLLING,
        (true, 0.0) => BG_ROLLING_SDS,
        (true, 1.0) => BG_ROLLING_EPSD2,
        _ => return Err(Error::BadSave.into()),
    };
    row_of(&bg_law {
        size: size_of::<bg_law>() as u32,
        kind: form.kind,
        kn: number(0),
        kt: number(1),
        gamma_n: number(2),
        gamma_t: number(3),
        mu: number(4),
        rolling,
        reserved: 0,
        rolling_k: own(1),
        rolling_gamma: own(2),
        rolling_mu: own(3),
    })
}

/// Bytes that are written word by word, with the hash of what was written.
struct Words<'a>(&'a mut [u8], Hasher);

impl Words<'_> {
    fn word(&mut self, word: u32) {
        self.1.word(word);
        let whole = core::mem::take(&mut self.0);
        let (to, rest) = whole.split_at_mut_checked(4).unwrap_or_default();
        for (to, byte) in to.iter_mut().zip(word.to_le_bytes()) {
            *to = byte;
        }
        self.0 = rest;
    }

    fn numbers(&mut self, numbers: &[f64]) {
        for bits in numbers.iter().map(|number| number.to_bits()) {
            self.word(bits as u32);
            self.word((bits >> 32) as u32);
        }
    }

    fn law(&mut self, parts: &Parts<'_>, form: Form) {
        for word in MAGIC.into_iter().chain([form.word()]) {
            self.word(word);
        }
        let Some(count) = form.materials else {
            self.numbers(&parts.law.numbers);
            return;
        };
        self.word(count.into());
        let (rows, _) = form.rows();
        for row in parts.table.iter().take(rows) {
            let law = &row.law;
            self.numbers(&[law.kn, law.kt, law.gamma_n, law.gamma_t, law.mu]);
            if form.rolls {
                let own = &row.resistance;
                let spring = match own.spring {
                    RollingSpring::Sds => 0.0,
                    RollingSpring::Epsd2 => 1.0,
                };
                self.numbers(&[spring, own.k, own.gamma, own.mu]);
            }
        }
    }
}

fn hashed(words: &[[u8; 4]]) -> [u8; 32] {
    let mut hasher = Hasher::new();
    for word in words {
        hasher.word(u32::from_le_bytes(*word));
    }
    hasher.finish()
}
