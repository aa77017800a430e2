//! Which part owns which grain: planes cut the bed where few pairs cross. Speed only, never a bit.

use bitgrain_kernel::{Domain, Row};

/// The part that owns each grain, if part `p` is to have the fraction `shares[p]` of the work, of which each grain
/// makes some: the bed is halved across its longest side, and its halves again. Every part has a grain, if there are as
/// many.
pub(super) fn cut(
    position: &[Row<f64>],
    work: &[f64],
    domain: &Domain<f64>,
    shares: &[f64],
) -> Vec<u16> {
    let mut owner = vec![0; position.len()];
    let mut places: Vec<u32> = (0..position.len() as u32).collect();
    let whole = Piece {
        places: &mut places,
        first: 0,
        periodic: domain.periodic(),
    };
    halve((position, work), whole, shares, &mut owner);
    owner
}

/// Grains that lie together, for parts from `first` on.
struct Piece<'a> {
    places: &'a mut [u32],
    first: u16,
    /// Axes along which its two ends touch each other.
    periodic: [bool; 3],
}

fn halve(grains: (&[Row<f64>], &[f64]), piece: Piece<'_>, shares: &[f64], owner: &mut [u16]) {
    let (position, work) = grains;
    let Piece {
        places,
        first,
        mut periodic,
    } = piece;
    if shares.len() <= 1 {
        for place in places {
            owner[*place as usize] = first;
        }
        return;
    }
    let lower = shares.len() / 2;
    let axis = longest(position, places, periodic);
    let along = |place: &u32| position[*place as usize][axis];
    places.sort_unstable_by(|a, b| along(a).total_cmp(&along(b)).then_with(|| a.cmp(b)));
    let sum = |shares: &[f64]| shares.iter().sum::<f64>();
    let all: f64 = places.iter().map(|place| work[*place as usize]).sum();
    let wanted = all * sum(&shares[..lower]) / sum(shares);
    let mut before = 0.0;
    let is_lower = |place: &&u32| {
        let own = work[**place as usize];
        before += own;
        before - 0.5 * own < wanted
    };
    let count = places.iter().take_while(is_lower).count();
    // So many that each part has one.
    let most = places.len().saturating_sub(shares.len() - lower);
    let count = count.clamp(lower.min(most), most);
    periodic[axis] = false;
    let (left, right) = places.split_at_mut(count);
    let piece = |places, first| Piece {
        places,
        first,
        periodic,
    };
    halve(grains, piece(left, first), &shares[..lower], owner);
    let next = first + lower as u16;
    halve(grains, piece(right, next), &shares[lower..], owner);
}

/// The axis across which a cut makes the smallest face; one that is periodic is cut twice.
fn longest(position: &[Row<f64>], places: &[u32], periodic: [bool; 3]) -> usize {
    let length = |a: usize| {
        let along = places.iter().map(|place| position[*place as usize][a]);
        let (lo, hi) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| {
            (lo.min(x), hi.max(x))
        });
        let length = hi - lo;
        if periodic[a] { 0.5 * length } else { length }
    };
    let lengths = [0, 1, 2].map(length);
    let longer = |a: usize, b: usize| if lengths[b] > lengths[a] { b } else { a };
    longer(longer(0, 1), 2)
}

/// Shares that would have taken all parts the same time, if each kept its speed: half of the way to them, since times
/// are noisy.
pub(super) fn fairer(shares: &[f64], busy: &[f64]) -> Vec<f64> {
    let all: f64 = busy.iter().sum();
    let mean = all / busy.len() as f64;
    let adjusted = shares.iter().zip(busy).map(|(share, busy)| {
        let fair = share * mean / busy.max(0.1 * mean);
        0.5 * (share + fair)
    });
    let adjusted: Vec<f64> = adjusted.collect();
    let all: f64 = adjusted.iter().sum();
    adjusted.iter().map(|share| share / all).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(sides: [usize; 3]) -> Vec<Row<f64>> {
        let at = |k: usize| {
            [
                k % sides[0],
                k / sides[0] % sides[1],
                k / sides[0] / sides[1],
            ]
        };
        let count = sides.iter().product();
        let row = |k: usize| {
            let [x, y, z] = at(k).map(|c| c as f64);
            [x, y, z, 0.5]
        };
        (0..count).map(row).collect()
    }

    fn cut(position: &[Row<f64>], domain: &Domain<f64>, shares: &[f64]) -> Vec<u16> {
        super::cut(position, &vec![1.0; position.len()], domain, shares)
    }

    #[test]
    fn grains_that_make_more_work_count_more() {
        let bed = lattice([12, 1, 1]);
        let mut work = vec![1.0; 12];
        work[..3].fill(3.0);
        let owner = super::cut(&bed, &work, &Domain::open(), &[0.5, 0.5]);
        assert_eq!(numbers(&owner, 2), [3, 9], "nine each");
    }

    fn numbers(owner: &[u16], parts: usize) -> Vec<usize> {
        let count = |part: usize| owner.iter().filter(|own| **own as usize == part).count();
        (0..parts).map(count).collect()
    }

    #[test]
    fn each_part_has_its_share_and_lies_together() {
        let bed = lattice([10, 4, 4]);
        let owner = cut(&bed, &Domain::open(), &[0.25, 0.25, 0.5]);
        assert_eq!(numbers(&owner, 3), [40, 40, 80]);
        let crossing = bed.iter().zip(&owner).filter(|(x, own)| {
            let next = bed
                .iter()
                .position(|y| y[0] == x[0] + 1.0 && y[1..] == x[1..]);
            next.is_some_and(|next| owner[next] != **own)
        });
        assert!(crossing.count() <= 3 * 16, "two faces of 16, and rounding");
    }

    #[test]
    fn a_periodic_side_is_cut_twice() {
        let bed = lattice([10, 8, 4]);
        let edges = ([-0.5; 3], [9.5, 7.5, 3.5]);
        let open = cut(&bed, &Domain::open(), &[1.0, 1.0]);
        let domain = Domain::new(edges.0, edges.1, [true, false, false]).unwrap();
        let closed = cut(&bed, &domain, &[1.0, 1.0]);
        assert_eq!((open[4], open[5]), (0, 1), "across x");
        assert_eq!((closed[0], closed[9], closed[319]), (0, 0, 1), "across y");
    }

    #[test]
    fn few_grains_are_shared_too() {
        for grains in 1..9 {
            let bed = lattice([grains, 1, 1]);
            for parts in 1..=grains {
                let owner = cut(&bed, &Domain::open(), &vec![1.0; parts]);
                assert!(numbers(&owner, parts).iter().all(|count| *count > 0));
            }
        }
    }

    #[test]
    fn who_takes_longer_gets_less() {
        let shares = fairer(&[0.5, 0.5], &[3.0, 1.0]);
        assert!((shares[0] + shares[1] - 1.0).abs() < 1e-12);
        assert!(shares[0] < 0.45 && shares[0] > 0.25, "{shares:?}");
        let same = fairer(&[0.2, 0.8], &[2.0, 2.0]);
        assert!((same[0] - 0.2).abs() < 1e-12);
    }
}
