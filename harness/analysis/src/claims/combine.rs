//! Several numbers of a claim as one, both of one campaign (curves, depths, runs) and of several.
//!
//! **Mean.** A claim on one quantity: the mean weighted by the errors. Its error is multiplied by the root of the
//! reduced chi-square if that is above 1, as that of every fit here. If the chance of the chi-square is below
//! [`UNLIKELY`] the numbers are said to disagree, with the one that lies farthest from the mean of the others.
//!
//! **Worst.** A claim that holds for every size, depth or friction, of which a mean would hide the one that breaks it:
//! the number that lies farthest outside of what the claim allows, in its own errors; if all agree by themselves, the
//! one that comes nearest to the edge. It counts as the worst of N. To break the claim it has to lie farther outside
//! than a single number ([`beyond`](crate::fit::chance::beyond)), as the largest of N lies farther off by chance.
//!
//! A number with the error 0 does not say how well it is known, and cannot be weighted: it is left out if any other
//! has an error. If none has, the plain mean counts, with the standard error that their scatter gives; a single one
//! stays as it is, which suits what is computed instead of measured.

use super::book::{Claim, Measured};
use super::number::{Combine, Found, Number};
use super::points::Spread;
use crate::analysis::Value;
use crate::fit::linear::{Column, columns};
use crate::fit::{Datum, Exact};

/// Below this chance of their chi-square numbers are said to disagree.
pub const UNLIKELY: f64 = 0.05;

/// All measurements of a claim as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Combined<'a> {
    /// The number with its standard error.
    pub value: Value,
    /// Of how many numbers it is the worst; 1 if it is a mean.
    pub of: usize,
    /// The measurements that it comes from.
    pub from: Vec<&'a Measured>,
    /// The one whose number it is, if it is the worst.
    pub worst: Option<&'a Measured>,
    /// The one that lies farthest from the others, if they disagree.
    pub odd: Option<Odd<'a>>,
}

/// A measurement that disagrees with the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Odd<'a> {
    /// It.
    pub measured: &'a Measured,
    /// How far it lies from the weighted mean of the others, in errors of both, at least 0.
    pub errors: f64,
    /// Chance of the chi-square of all of them, 0 to 1.
    pub chance: f64,
}

/// Numbers as one; each is the worst of so many.
struct Whole {
    value: Value,
    of: usize,
    /// Places of those that it comes from.
    from: Vec<usize>,
    /// Place of the worst.
    worst: Option<usize>,
    /// Chance of their chi-square; 1 of the worst.
    chance: f64,
}

impl Claim {
    /// All measurements that have a number as one; `None` if none has.
    pub fn combined(&self) -> Option<Combined<'_>> {
        let known = |m: &Measured| Some((m.as_value()?, m.of));
        let counted: Vec<&Measured> = self
            .measured
            .iter()
            .filter(|m| known(m).is_some())
            .collect();
        let numbers: Vec<(Value, usize)> = counted.iter().filter_map(|m| known(m)).collect();
        let whole = self.whole(&numbers)?;
        let odd = (whole.chance < UNLIKELY).then(|| {
            let values: Vec<Value> = whole.from.iter().map(|&k| numbers[k].0).collect();
            farthest(&values).map(|(k, errors)| Odd {
                measured: counted[whole.from[k]],
                errors,
                chance: whole.chance,
            })
        });
        Some(Combined {
            value: whole.value,
            of: whole.of,
            from: whole.from.iter().map(|&k| counted[k]).collect(),
            worst: whole.worst.map(|k| counted[k]),
            odd: odd.flatten(),
        })
    }

    /// Numbers of several curves, depths or runs as one; `none` is why there is none if there are no numbers.
    pub(super) fn together(&self, all: Vec<(Value, String)>, none: &str) -> Found {
        let values: Vec<(Value, usize)> = all.iter().map(|(value, _)| (*value, 1)).collect();
        let whole = self.whole(&values).ok_or(none)?;
        let note = match (whole.worst, &whole.from[..]) {
            (_, [only]) => all[*only].1.clone(),
            (Some(worst), from) => format!("{}, worst of {}", all[worst].1, from.len()),
            (None, from) if whole.chance < UNLIKELY => format!(
                "mean of {}, which differ by more than their errors (p = {:.1e})",
                from.len(),
                whole.chance
            ),
            (None, from) => format!("mean of {}", from.len()),
        };
        Ok(Number {
            value: whole.value,
            note,
            of: whole.of,
        })
    }

    fn whole(&self, numbers: &[(Value, usize)]) -> Option<Whole> {
        let finite = |(v, _): &(Value, usize)| v.value.is_finite() && v.error.is_finite();
        // What is no number is not hidden by those that are.
        let broken = numbers.iter().position(|n| !finite(n)).map(|k| vec![k]);
        let known: Vec<usize> = (0..numbers.len())
            .filter(|&k| numbers[k].0.error > 0.0)
            .collect();
        let from = match (broken, known.is_empty()) {
            (Some(broken), _) => broken,
            (None, false) => known,
            (None, true) => (0..numbers.len()).collect(),
        };
        let values: Vec<Value> = from.iter().map(|&k| numbers[k].0).collect();
        match (self.combine, &values[..]) {
            (_, []) => None,
            (Combine::Worst, _) => {
                let against = |k: usize| self.against(numbers[k].0);
                let more = |a: usize, b: usize| against(b) > against(a);
                let worst = from.iter().copied();
                let worst = worst.reduce(|a, b| if more(a, b) { b } else { a })?;
                Some(Whole {
                    value: numbers[worst].0,
                    of: from.iter().map(|&k| numbers[k].1).sum(),
                    worst: Some(worst),
                    from,
                    chance: 1.0,
                })
            }
            (Combine::Mean, [only]) => Some(Whole::mean(*only, from, 1.0)),
            (Combine::Mean, _) if known_errors(&values) => {
                let (mean, chance) = weighted_mean(&values)?;
                Some(Whole::mean(mean, from, chance))
            }
            (Combine::Mean, _) => {
                let plain: Vec<(f64, f64)> = values.iter().map(|v| (v.value, 0.0)).collect();
                Some(Whole::mean(Spread::of(&plain).into(), from, 1.0))
            }
        }
    }
}

impl Whole {
    fn mean(value: Value, from: Vec<usize>, chance: f64) -> Self {
        Self {
            value,
            of: 1,
            from,
            worst: None,
            chance,
        }
    }
}

fn known_errors(values: &[Value]) -> bool {
    values.iter().all(|v| v.error > 0.0)
}

/// Mean of values with errors above 0, weighted by these, with the chance of their chi-square; `None` of none. The
/// error is multiplied by the root of the reduced chi-square if that is above 1.
pub(super) fn weighted_mean(values: &[Value]) -> Option<(Value, f64)> {
    let data: Vec<Datum> = values.iter().map(|v| v.at(0.0)).collect();
    let ones = Column {
        name: "a",
        values: vec![1.0; data.len()],
    };
    let fit = columns(&data, "a", &[ones], Exact::Permitted).ok()?;
    let mean = fit.parameters.first()?;
    // Zero without a sign.
    Some((Value::new(mean.value + 0.0, mean.error), fit.probability))
}

/// Of several values with errors above 0 the one farthest from the weighted mean of the others, and by how many
/// errors of both.
fn farthest(values: &[Value]) -> Option<(usize, f64)> {
    let off = |k: usize| {
        let others = values.iter().enumerate().filter(|(other, _)| *other != k);
        let apart = values[k].less(Value::mean(others.map(|(_, v)| *v))?);
        Some((k, apart.value.abs() / apart.error))
    };
    let all = (0..values.len()).filter_map(off);
    all.reduce(|a, b| if b.1 > a.1 { b } else { a })
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::claim;
    use super::super::verdict::Verdict;
    use super::*;
    use crate::fit::synthetic::normal;

    const ONE: &str = "value = 1.0\ntolerance = 0.2";
    const EACH: &str = "value = 1.0\ntolerance = 0.0\ncombine = \"worst\"";
    /// Draws of a test: a share of 5 % is known to 0.7 %.
    const DRAWS: u64 = 1000;

    fn measured(by: &str, value: f64, error: f64) -> Measured {
        Measured::new(by, "", Ok(Number::one(Value::new(value, error), "")))
    }

    fn with(lines: &str, numbers: &[(f64, f64)]) -> Claim {
        let mut claim = claim(lines);
        let named = numbers.iter().enumerate();
        claim.measured = named
            .map(|(k, (value, error))| measured(&format!("m{k}"), *value, *error))
            .collect();
        claim
    }

    /// Numbers that are all at 1 but one, `off` of its errors away, with normal noise of errors from 0.02 to 0.08.
    fn drawn(seed: u64, count: usize, off: f64) -> Vec<(Value, String)> {
        let one = |k: usize| {
            let error = 0.02 * (1 + k % 4) as f64;
            let more = if k == count / 2 { off } else { 0.0 };
            let value = 1.0 + error * (normal(seed, k) + more);
            (Value::new(value, error), format!("number {k}"))
        };
        (0..count).map(one).collect()
    }

    /// The closed forms of a mean of two: weights, chi-square of one degree, and an error that grows by its root.
    #[test]
    fn measurements_are_averaged_by_their_errors() {
        let claim = with(ONE, &[(0.9, 0.1), (0.3, 0.2)]);
        let whole = claim.combined().unwrap();
        // Weights 100 and 25; 0.6 apart of 0.05.
        assert!((whole.value.value - 0.78).abs() < 1e-12, "{whole:?}");
        let chi = 0.36_f64 / 0.05;
        assert!((whole.value.error - (chi / 125.0).sqrt()).abs() < 1e-12);
        let odd = whole.odd.unwrap();
        assert!((odd.errors - chi.sqrt()).abs() < 1e-12 && odd.chance < 0.01);
        assert_eq!(
            (odd.measured.by.as_str(), whole.from.len(), whole.of),
            ("m0", 2, 1)
        );
        assert_eq!(claim.verdict(), Verdict::NotResolved);
        // Alike: the error becomes smaller, and nothing disagrees; the order plays no part.
        let claim = with(ONE, &[(1.0, 0.1), (1.1, 0.1)]);
        let whole = claim.combined().unwrap();
        assert!((whole.value.error - 0.1 / 2f64.sqrt()).abs() < 1e-12 && whole.odd.is_none());
        let turned = with(ONE, &[(1.1, 0.1), (1.0, 0.1)]);
        assert!((turned.combined().unwrap().value.value - whole.value.value).abs() < 1e-12);
        // The last one alone would agree.
        let claim = with(ONE, &[(2.0, 0.05), (2.0, 0.05), (1.0, 0.1)]);
        assert_eq!(claim.agreement(&claim.measured[2]), Verdict::Agrees);
        assert_eq!(claim.combined().unwrap().odd.unwrap().measured.by, "m2");
        assert_eq!(claim.verdict(), Verdict::Disagrees);
    }

    #[test]
    fn what_has_no_number_or_no_error_has_no_weight() {
        let mut claim = with(ONE, &[(1.0, 0.05)]);
        let none = Measured::new("y", "", Err("too few".into()));
        claim.measured.push(none);
        assert_eq!(claim.verdict(), Verdict::Agrees);
        claim.measured.push(measured("z", 5.0, 0.0));
        assert_eq!(claim.combined().unwrap().value, Value::new(1.0, 0.05));
        claim.measured.clear();
        assert_eq!(
            (claim.verdict(), claim.combined()),
            (Verdict::NotResolved, None)
        );
        // Without any error the scatter gives one.
        let plain = with(ONE, &[(1.0, 0.0), (1.1, 0.0)]);
        let value = plain.combined().unwrap().value;
        assert!((value.value - 1.05).abs() < 1e-12 && (value.error - 0.05).abs() < 1e-12);
        assert_eq!(
            with(ONE, &[(1.1, 0.0)]).combined().unwrap().value,
            Value::new(1.1, 0.0)
        );
        let each = with(EACH, &[(1.0, 0.1), (7.0, 0.0)]);
        assert_eq!(each.combined().unwrap().value.value, 1.0);
    }

    /// Numbers that are equal are said to disagree as seldom as the chance says.
    #[test]
    fn equal_numbers_seldom_disagree() {
        let odd = |seed: &u64| {
            let all = drawn(*seed, 3, 0.0);
            let all: Vec<(f64, f64)> = all.iter().map(|(v, _)| (v.value, v.error)).collect();
            with(ONE, &all).combined().unwrap().odd.is_some()
        };
        let count = (0..DRAWS).filter(odd).count();
        // 50 with a deviation of 7.
        assert!((29..=71).contains(&count), "{count}");
    }

    /// The worst of many numbers that are all as the claim says does not break it more often than one alone; one that
    /// is six errors off is found.
    #[test]
    fn the_worst_of_many_is_judged_by_how_many_there_are() {
        let claim = claim(EACH);
        for count in [1, 4, 32, 384] {
            let broken = |off: f64, of: Option<usize>| {
                let disagrees = |seed: &u64| {
                    let found = claim.together(drawn(*seed, count, off), "").unwrap();
                    assert_eq!(found.of, count);
                    let of = of.unwrap_or(found.of);
                    claim.judge(found.value, of) == Verdict::Disagrees
                };
                (0..DRAWS).filter(disagrees).count()
            };
            // 46 with a deviation of 7: two errors on either side.
            let chance = broken(0.0, None);
            assert!((25..=67).contains(&chance), "{chance} of {count}");
            // Six errors less the 3.9 allowed to the worst of 384.
            let found = broken(6.0, None);
            assert!(found > 960, "{found} of {count}");
            if count >= 32 {
                let alone = broken(0.0, Some(1));
                assert!(alone > 700, "{alone}");
            }
        }
    }

    #[test]
    fn the_worst_of_all_measurements_counts() {
        let mut claim = with(
            "least = 2.0\ncombine = \"worst\"",
            &[(2.5, 0.1), (1.5, 0.2), (1.8, 0.3)],
        );
        claim.measured[0].of = 3;
        let whole = claim.combined().unwrap();
        assert_eq!((whole.value.value, whole.of, whole.from.len()), (1.5, 5, 3));
        assert_eq!(whole.worst.unwrap().by, "m1");
        assert_eq!(whole.odd, None);
        // 2.5 errors, where one alone may be 2.
        assert_eq!(claim.agreement(&claim.measured[1]), Verdict::Disagrees);
        assert_eq!(claim.verdict(), Verdict::NotResolved);
    }

    #[test]
    fn notes_say_what_a_number_is() {
        let all = |values: &[f64]| -> Vec<(Value, String)> {
            let each = values
                .iter()
                .map(|v| (Value::new(*v, 0.1), format!("at {v}")));
            each.collect()
        };
        let note = |lines: &str, values: &[f64]| claim(lines).together(all(values), "none");
        assert_eq!(note(ONE, &[1.0, 1.1]).unwrap().note, "mean of 2");
        assert_eq!(note(ONE, &[1.0]).unwrap().note, "at 1");
        let far = note(ONE, &[1.0, 3.0]).unwrap().note;
        assert!(far.starts_with("mean of 2, which differ"), "{far}");
        assert_eq!(note(EACH, &[1.0, 1.1]).unwrap().note, "at 1.1, worst of 2");
        assert_eq!(note(EACH, &[1.1]).unwrap().note, "at 1.1");
        assert_eq!(note(EACH, &[]).unwrap_err(), "none");
        // What is no number shows.
        for lines in [ONE, EACH] {
            assert!(note(lines, &[1.0, f64::NAN]).unwrap().value.value.is_nan());
        }
    }
}
