//! BLAKE3 of words and bytes, written out for the digests: no allocation, no call that can panic, and the
//! words go in lowest byte first on every machine. The tests compare it with the reference crate.

/// Chunks of 1024 bytes that a tree of this height can hold: 2^28, 256 GiB; all 4 GiB of a small machine.
const HEIGHT: usize = if usize::BITS > 32 { 28 } else { 22 };

const CHUNK_START: u32 = 1;
const CHUNK_END: u32 = 2;
const PARENT: u32 = 4;
const ROOT: u32 = 8;

/// Bytes of a whole block.
const BLOCK: u32 = 64;

/// Blocks of a whole chunk.
const BLOCKS: u32 = 16;

type Chain = [u32; 8];
type Block = [u32; 16];

const START: Chain = [
    0x6a09_e667,
    0xbb67_ae85,
    0x3c6e_f372,
    0xa54f_f53a,
    0x510e_527f,
    0x9b05_688c,
    0x1f83_d9ab,
    0x5be0_cd19,
];

/// A hash in progress.
#[derive(Clone, Debug)]
pub struct Hasher {
    chain: Chain,
    block: Block,
    /// Words in the block.
    filled: usize,
    /// Blocks of this chunk already compressed.
    blocks: u32,
    /// Number of this chunk.
    chunk: u64,
    /// Roots of the whole subtrees to the left, the largest first.
    left: [Chain; HEIGHT],
    height: usize,
}

impl Default for Hasher {
    fn default() -> Self {
        Self::new()
    }
}

impl Hasher {
    /// A hash of nothing yet.
    pub const fn new() -> Self {
        Self {
            chain: START,
            block: [0; 16],
            filled: 0,
            blocks: 0,
            chunk: 0,
            left: [[0; 8]; HEIGHT],
            height: 0,
        }
    }

    /// Takes in the four bytes of a word, the lowest first.
    #[inline]
    pub fn word(&mut self, word: u32) {
        if self.filled == self.block.len() {
            self.compress_block();
        }
        if let Some(slot) = self.block.get_mut(self.filled) {
            *slot = word;
            self.filled += 1;
        }
    }

    /// Takes in the bytes of a hash.
    pub fn hash(&mut self, hash: &[u8; 32]) {
        for bytes in hash.as_chunks().0 {
            self.word(u32::from_le_bytes(*bytes));
        }
    }

    /// The hash of all words so far.
    pub fn finish(&self) -> [u8; 32] {
        self.finish_without(0)
    }

    /// The hash of all words so far and of these bytes after them. The last 1 to 3 bytes of an odd number are no
    /// word, so this ends the hash: what is taken in later has no meaning.
    pub fn finish_with(&mut self, bytes: &[u8]) -> [u8; 32] {
        let (words, rest) = bytes.as_chunks();
        for word in words {
            self.word(u32::from_le_bytes(*word));
        }
        if rest.is_empty() {
            return self.finish();
        }
        let mut last = [0; 4];
        for (slot, byte) in last.iter_mut().zip(rest) {
            *slot = *byte;
        }
        self.word(u32::from_le_bytes(last));
        self.finish_without(last.len().saturating_sub(rest.len()))
    }

    /// The hash of all words without so many of the last one's bytes, which are zero.
    fn finish_without(&self, missing: usize) -> [u8; 32] {
        let mut flags = self.chunk_flags() | CHUNK_END;
        let mut chain = self.chain;
        let mut block = self.block;
        let mut length = (4 * self.filled).saturating_sub(missing) as u32;
        let mut number = self.chunk;
        for root in self.left.iter().take(self.height).rev() {
            let right = compress(&chain, &block, number, length, flags);
            (chain, block) = (START, both(root, &right));
            (number, length, flags) = (0, BLOCK, PARENT);
        }
        let whole = compress(&chain, &block, number, length, flags | ROOT);
        let mut out = [0; 32];
        for (bytes, word) in out.as_chunks_mut().0.iter_mut().zip(whole) {
            *bytes = word.to_le_bytes();
        }
        out
    }

    fn chunk_flags(&self) -> u32 {
        if self.blocks == 0 { CHUNK_START } else { 0 }
    }

    /// Compresses a whole block; a chunk's last one ends the chunk.
    fn compress_block(&mut self) {
        let last = self.blocks + 1 == BLOCKS;
        let end = if last { CHUNK_END } else { 0 };
        let flags = self.chunk_flags() | end;
        self.chain = compress(&self.chain, &self.block, self.chunk, BLOCK, flags);
        self.blocks += 1;
        self.block = [0; 16];
        self.filled = 0;
        if last {
            self.chunk += 1;
            self.join_left(self.chain);
            self.chain = START;
            self.blocks = 0;
        }
    }

    /// Joins a chunk with every subtree that it completes: one for each factor of two in their number.
    fn join_left(&mut self, chunk: Chain) {
        let mut root = chunk;
        let mut count = self.chunk;
        while count & 1 == 0 && self.height > 0 {
            self.height -= 1;
            let left = self.left.get(self.height).unwrap_or(&START);
            root = compress(&START, &both(left, &root), 0, BLOCK, PARENT);
            count >>= 1;
        }
        if let Some(slot) = self.left.get_mut(self.height) {
            *slot = root;
            self.height += 1;
        }
    }
}

fn both(l: &Chain, r: &Chain) -> Block {
    let ([a, b, c, d, e, f, g, h], [i, j, k, m, n, o, p, q]) = (*l, *r);
    [a, b, c, d, e, f, g, h, i, j, k, m, n, o, p, q]
}

/// Seven rounds over state and message, and the half of the result that chains.
fn compress(chain: &Chain, block: &Block, number: u64, length: u32, flags: u32) -> Chain {
    let [a, b, c, d, e, f, g, h] = *chain;
    let [i, j, k, l, ..] = START;
    let (low, high) = (number as u32, (number >> 32) as u32);
    let mut v = [a, b, c, d, e, f, g, h, i, j, k, l, low, high, length, flags];
    let mut m = *block;
    for round in 0..7 {
        if round > 0 {
            m = [
                m[2], m[6], m[3], m[10], m[7], m[0], m[4], m[13], m[1], m[11], m[12], m[5], m[9],
                m[14], m[15], m[8],
            ];
        }
        mix::<0, 4, 8, 12>(&mut v, m[0], m[1]);
        mix::<1, 5, 9, 13>(&mut v, m[2], m[3]);
        mix::<2, 6, 10, 14>(&mut v, m[4], m[5]);
        mix::<3, 7, 11, 15>(&mut v, m[6], m[7]);
        mix::<0, 5, 10, 15>(&mut v, m[8], m[9]);
        mix::<1, 6, 11, 12>(&mut v, m[10], m[11]);
        mix::<2, 7, 8, 13>(&mut v, m[12], m[13]);
        mix::<3, 4, 9, 14>(&mut v, m[14], m[15]);
    }
    let mut out = [0; 8];
    for (k, word) in out.iter_mut().enumerate() {
        *word = v[k] ^ v[k + 8];
    }
    out
}

#[inline(always)]
fn mix<const A: usize, const B: usize, const C: usize, const D: usize>(
    v: &mut Block,
    x: u32,
    y: u32,
) {
    v[A] = v[A].wrapping_add(v[B]).wrapping_add(x);
    v[D] = (v[D] ^ v[A]).rotate_right(16);
    v[C] = v[C].wrapping_add(v[D]);
    v[B] = (v[B] ^ v[C]).rotate_right(12);
    v[A] = v[A].wrapping_add(v[B]).wrapping_add(y);
    v[D] = (v[D] ^ v[A]).rotate_right(8);
    v[C] = v[C].wrapping_add(v[D]);
    v[B] = (v[B] ^ v[C]).rotate_right(7);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every length up to three chunks, and the edges of larger trees, against the published crate.
    #[test]
    fn hashes_are_those_of_the_published_crate() {
        let edges = [1023, 1024, 1025, 1280, 2047, 2048, 4096, 5000, 70_000];
        for words in (0..800).chain(edges) {
            let mut ours = Hasher::new();
            let mut theirs = ::blake3::Hasher::new();
            let mut word = 0x9e37_79b9u32;
            for _ in 0..words {
                word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                ours.word(word);
                theirs.update(&word.to_le_bytes());
            }
            assert_eq!(ours.finish(), *theirs.finalize().as_bytes(), "{words}");
        }
    }

    /// Every number of bytes up to two chunks, and after some words.
    #[test]
    fn bytes_are_hashed_to_the_last_one() {
        let bytes: std::vec::Vec<u8> = (0..2200u32).map(|k| ((k * k) >> 3) as u8).collect();
        for count in 0..bytes.len() {
            let ours = Hasher::new().finish_with(&bytes[..count]);
            assert_eq!(ours, *::blake3::hash(&bytes[..count]).as_bytes(), "{count}");
        }
        let mut ours = Hasher::new();
        bytes[..1024]
            .as_chunks()
            .0
            .iter()
            .for_each(|word| ours.word(u32::from_le_bytes(*word)));
        assert_eq!(
            ours.finish_with(&bytes[1024..]),
            *::blake3::hash(&bytes).as_bytes()
        );
    }
}
