//! Bytes that claim to be a saved world: any of them are refused or are a world that goes on, and with hashes that fit
//! they are looked at all the same.

use bitgrain::law::AnyLaw;
use bitgrain::simulation::Simulation;
use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::{Domain, Group, Obstacle, Store, save, save_size, start, step};

use super::bytes::Bytes;

type Bed = Store<f64, 5, 24, 12, 3>;

/// A simulation of the same bytes, with a law before them: refused, or read and written it is the same, and goes on.
fn owned(law: HertzHistory<f64>, text: &[u8]) {
    let law = AnyLaw::HertzHistory(law);
    let mut empty = Simulation::new(law, Domain::open(), 1e-3, vec![], &[], vec![]);
    empty.start().unwrap();
    let mut bytes = empty.save().unwrap();
    bytes.truncate(bytes.len() - save_size(&empty.world()));
    bytes.extend_from_slice(text);
    if let Ok(mut sim) = Simulation::load(&bytes) {
        let again = sim.save().unwrap();
        assert_eq!(again[..], bytes[..again.len()]);
        let _ = sim.steps(5);
    }
}

/// Whether the bytes were a world that could be loaded.
pub fn saved(data: &[u8]) -> bool {
    let law = HertzHistory {
        kn: 2e4,
        kt: 2.45e4,
        gamma_n: 50.0,
        gamma_t: 50.0,
        mu: 0.5,
    };
    let mut bytes = Bytes(data);
    let mut bed = bed(bytes.below(3));
    start(&mut bed.world(), &law).unwrap();
    for _ in 0..bytes.below(30) {
        step(&mut bed.world(), &law).unwrap();
    }
    let mut text = vec![0; save_size(&bed.world())];
    save(&mut bed.world(), &mut text).unwrap();
    // Some words are others now, whichever; the checksum is made to fit, so that what is behind it is tried.
    let hashed = text.len() - 32;
    for _ in 0..bytes.below(5) {
        let at = usize::from(u16::from_le_bytes([bytes.byte(), bytes.byte()])) % hashed;
        text[at] = bytes.byte();
    }
    if bytes.below(8) == 0 {
        text.truncate(usize::from(bytes.byte()) * 8);
    }
    if let Some(words) = text.len().checked_sub(32) {
        let mut hasher = Hasher::new();
        for word in text[..words].chunks_exact(4) {
            hasher.word(u32::from_le_bytes(word.try_into().unwrap()));
        }
        text[words..].copy_from_slice(&hasher.finish());
    }
    owned(law, &text);
    let mut other = Bed::vacant();
    if other.load(&text).is_err() {
        return false;
    }
    let size = save_size(&other.world());
    let mut again = vec![0; size];
    save(&mut other.world(), &mut again).unwrap();
    assert_eq!(again[..], text[..size], "read and written it is the same");
    for _ in 0..5 {
        if step(&mut other.world(), &law).is_err() {
            return true;
        }
    }
    true
}

fn bed(kind: usize) -> Bed {
    let domain = match kind {
        0 => Domain::open(),
        _ => Domain::new([0.0; 3], [5.0, 5.0, 8.0], [true, kind == 1, false]).unwrap(),
    };
    let mut bed = Bed::new(domain, 1e-3, 0.05);
    bed.add_group(Group::free([0.2, 0.0, -1.0])).unwrap();
    bed.add_group(Group::frozen()).unwrap();
    bed.add_obstacle(Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]))
        .unwrap();
    for k in 0..4u32 {
        let x = [1.0 + 0.999 * f64::from(k), 1.0, 0.4995];
        bed.add_grain(3 * k, u8::from(k == 3), x, 0.5, 0.5).unwrap();
    }
    bed
}
