//! The first contact at which two states differ.

use crate::replay::ContactState;

/// Which contact it is: grains by name; obstacle contacts come before those of two grains.
fn key(contact: &ContactState) -> (bool, u32, u32) {
    let grains = contact.j.is_some();
    (
        grains,
        contact.i,
        contact.j.or(contact.obstacle).unwrap_or(0),
    )
}

fn name(contact: &ContactState) -> String {
    match (contact.j, contact.obstacle) {
        (Some(j), _) => format!("grains {} and {j}", contact.i),
        (_, Some(k)) => format!("grain {} on obstacle {k}", contact.i),
        _ => format!("grain {}", contact.i),
    }
}

/// The first contact that only one list has, or whose forces differ.
pub(super) fn first_contact(a: &[ContactState], b: &[ContactState]) -> Option<String> {
    for (k, one) in a.iter().enumerate() {
        let Some(other) = b.get(k).filter(|other| key(other) == key(one)) else {
            // Both lists are in order, so the lower of the two is missing in the other.
            let theirs = b.get(k).filter(|other| key(other) < key(one));
            let (first, which) = theirs.map_or((one, "first"), |theirs| (theirs, "second"));
            return Some(format!("{} touch in the {which} alone", name(first)));
        };
        let forces = [
            ("normal force", one.normal_force, other.normal_force),
            (
                "tangential force",
                one.tangential_force,
                other.tangential_force,
            ),
        ];
        for (what, x, y) in forces {
            for (axis, (x, y)) in ["x", "y", "z"].iter().zip(x.iter().zip(y)) {
                if x.to_bits() != y.to_bits() {
                    let [a, b] = [x.to_bits(), y.to_bits()];
                    let which = name(one);
                    return Some(format!(
                        "{which}, {what} {axis}: {x} (0x{a:016x}) against {y} (0x{b:016x})"
                    ));
                }
            }
        }
    }
    b.get(a.len())
        .map(|more| format!("{} touch in the second alone", name(more)))
}
