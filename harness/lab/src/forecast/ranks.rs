//! Whether one machine is enough, and on how many a run is to be shared if it is not.

use bitgrain_sim::format::{bytes, duration};

/// What a scenario asks of one machine.
pub(super) struct Needs {
    /// Of its largest bed.
    pub grains: usize,
    /// Bytes.
    pub memory: f64,
    /// Seconds of its longest drag by itself on all threads, at best.
    pub longest: f64,
}

/// What to do if one machine is not enough.
#[derive(Debug, PartialEq)]
pub(super) struct Advice {
    /// Machines to share the run; 1 if no number of them would do.
    pub ranks: usize,
    pub why: String,
}

/// The longest that a drag may take on one machine: two days.
const LONG: f64 = 172_800.0;

/// The part of a machine's memory that a run may take.
const FILLED: f64 = 0.9;

/// Fewest grains of a rank that still gain by it: its border is a fifth of them.
const RANK_MIN: usize = 20_000;

/// Most ranks that are proposed: beyond, what all tell each other costs as much as the steps.
const RANKS_MAX: usize = 64;

/// Bytes of a grain in the rank that keeps the whole bed, at the moment when it gives parts away, and in a part: from
/// 2, 4 and 8 ranks of a million grains, whose first held 944, 779 and 765 bytes a grain.
const KEPT: f64 = 730.0;
const IN_PART: f64 = 440.0;

/// Bytes of the first rank among so many.
fn first(grains: usize, ranks: usize) -> f64 {
    (KEPT + IN_PART / ranks as f64) * grains as f64
}

/// What to do if a machine of this memory is not enough, or is too slow.
pub(super) fn advice(needs: &Needs, machine: Option<f64>) -> Option<Advice> {
    if let Some(machine) = machine.filter(|machine| needs.memory > FILLED * machine) {
        let fits = |ranks: &usize| first(needs.grains, *ranks) <= FILLED * machine;
        let has = bytes(machine);
        return Some(match (2..=RANKS_MAX).find(fits) {
            Some(ranks) => Advice {
                ranks,
                why: format!("it has {has}; of {ranks} like it the first keeps the whole bed"),
            },
            None => Advice {
                ranks: 1,
                why: format!(
                    "it has {has}, and no number like it is: the first keeps the whole bed, {} at \
                     least",
                    bytes(first(needs.grains, RANKS_MAX) / FILLED)
                ),
            },
        });
    }
    let most = (needs.grains / RANK_MIN).min(RANKS_MAX);
    if needs.longest <= LONG || most < 2 {
        return None;
    }
    let ranks = most.min((needs.longest / LONG).ceil() as usize).max(2);
    Some(Advice {
        ranks,
        why: format!(
            "a drag takes {} or more; on {ranks} like it {} at best",
            duration(needs.longest),
            duration(needs.longest / ranks as f64)
        ),
    })
}

#[cfg(test)]
mod tests {
    use bitgrain_sim::memory::PER_GRAIN_ON_THREADS;

    use super::*;

    fn needs(grains: usize, longest: f64) -> Needs {
        Needs {
            grains,
            memory: PER_GRAIN_ON_THREADS * grains as f64,
            longest,
        }
    }

    #[test]
    fn a_bed_too_large_for_a_machine_goes_to_as_many_as_hold_it() {
        let machine = Some(24e9);
        assert_eq!(advice(&needs(10_000_000, 0.0), machine), None, "10.7 GB");
        let found = advice(&needs(25_000_000, 0.0), machine).unwrap();
        assert_eq!(found.ranks, 4, "26.8 GB, and 21.0 of four: {}", found.why);
        let found = advice(&needs(28_000_000, 0.0), machine).unwrap();
        assert_eq!(found.ranks, 11, "20.4 GB are the whole bed: {}", found.why);
        let found = advice(&needs(40_000_000, 0.0), machine).unwrap();
        assert_eq!(found.ranks, 1, "29.2 GB are the whole bed: {}", found.why);
        assert!(found.why.ends_with("at least"), "{}", found.why);
        assert_eq!(advice(&needs(100_000_000, 0.0), None), None, "unknown");
    }

    #[test]
    fn a_drag_of_weeks_is_shared_if_ranks_have_enough_grains() {
        let day = 86_400.0;
        assert_eq!(advice(&needs(300_000, 1.9 * day), None), None);
        assert_eq!(advice(&needs(300_000, 7.0 * day), None).unwrap().ranks, 4);
        assert_eq!(advice(&needs(300_000, 90.0 * day), None).unwrap().ranks, 15);
        assert_eq!(advice(&needs(30_000, 90.0 * day), None), None, "too few");
    }
}
