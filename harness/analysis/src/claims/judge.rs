//! Whether a number agrees with what a paper says, and how far it is off.

use super::book::{Claim, Measured};
use super::verdict::Verdict;
use crate::analysis::Value;
use crate::fit::chance::beyond;
use bitgrain_sim::format::short;

/// From so many errors off the paper's number on, an agreement says how far it is off: the tolerance allows it, but
/// the two numbers are not the same.
const FAR: f64 = 3.0;

impl Claim {
    /// Whether one measurement agrees by itself.
    pub fn agreement(&self, measured: &Measured) -> Verdict {
        match measured.as_value() {
            Some(value) => self.judge(value, measured.of),
            None => Verdict::NotResolved,
        }
    }

    /// Whether all measurements together agree ([`Claim::combined`]).
    pub fn verdict(&self) -> Verdict {
        let whole = self.combined();
        whole.map_or(Verdict::NotResolved, |w| self.judge(w.value, w.of))
    }

    /// The verdict of all measurements together in words, as [`Claim::words`] has them of one.
    pub fn verdict_words(&self) -> String {
        match self.combined() {
            Some(whole) => self.words(whole.value, whole.of),
            None => Verdict::NotResolved.text().into(),
        }
    }

    /// Whether a number agrees that is the worst of so many. It agrees within the tolerance if its error is no larger,
    /// and keeps a bound if it does so by an error. It disagrees if it lies outside of the tolerance or the bound by
    /// two errors, or by the more that the worst of several takes ([`beyond`]). To agree takes no more of several
    /// than of one: each has to, and one that does not by right does so by chance as seldom beside others as alone. A
    /// claim that assumes what the paper does not say is not contradicted.
    pub(super) fn judge(&self, number: Value, of: usize) -> Verdict {
        let outside = self.outside(number.value);
        let within = match self.tolerance {
            Some(tolerance) => outside <= 0.0 && number.error <= tolerance,
            None => outside <= -number.error,
        };
        if within {
            Verdict::Agrees
        } else if outside > beyond(of) * number.error && self.assumes.is_none() {
            Verdict::Disagrees
        } else {
            Verdict::NotResolved
        }
    }

    /// How far a number lies outside of what the claim allows; below zero inside.
    fn outside(&self, x: f64) -> f64 {
        if let (Some(value), Some(tolerance)) = (self.value, self.tolerance) {
            return (x - value).abs() - tolerance;
        }
        let over = self.most.map(|most| x - most);
        let under = self.least.map(|least| least - x);
        let more = |a: f64, b: f64| if b > a { b } else { a };
        over.into_iter().chain(under).fold(f64::NEG_INFINITY, more)
    }

    /// How much a number speaks against the claim: whether it fails to agree by itself, and then the errors by which
    /// it lies outside, or, if it agrees, how far it lies outside, which is below zero.
    pub(super) fn against(&self, number: Value) -> (bool, f64) {
        let outside = self.outside(number.value);
        match self.judge(number, 1) {
            Verdict::Agrees => (false, outside),
            _ => (true, outside / number.error),
        }
    }

    /// How far a number is off the paper's number, or off a bound that it does not keep; with the number or bound.
    fn off(&self, x: f64) -> Option<(f64, f64)> {
        let most = self.most.filter(|most| x > *most);
        let least = self.least.filter(|least| x < *least);
        let aim = self.value.or(most).or(least)?;
        Some((x - aim, aim))
    }

    /// How far a number is off the paper's number, or off a bound that it does not keep: in percent (`+5 %`), and in
    /// its errors (`+2.3`); dashes for what has no meaning.
    pub fn deviation(&self, number: Value) -> [String; 2] {
        let Some((off, aim)) = self.off(number.value) else {
            return ["-".into(), "-".into()];
        };
        let percent = match aim {
            0.0 => "-".into(),
            aim => format!("{:+.0} %", 100.0 * off / aim.abs()),
        };
        let errors = match number.error > 0.0 {
            true => format!("{:+.1}", off / number.error),
            false => "-".into(),
        };
        [percent, errors]
    }

    /// The same on one line for running text, such as `+5 %, +2.3 errors`; empty if there is nothing to say.
    pub fn deviation_text(&self, number: Value) -> String {
        let [percent, errors] = self.deviation(number);
        let errors = match &errors[..] {
            "-" => errors,
            _ => format!("{errors} errors"),
        };
        let said: Vec<String> = [percent, errors].into_iter().filter(|s| s != "-").collect();
        said.join(", ")
    }

    /// The verdict on a number that is the worst of so many, in words: `agrees`, `agrees, 23 % off` if it is off by
    /// more than three errors, `disagrees`, `not resolved`.
    pub fn words(&self, number: Value, of: usize) -> String {
        let verdict = self.judge(number, of);
        let off = self
            .off(number.value)
            .filter(|(off, _)| off.abs() > FAR * number.error);
        match (verdict, off) {
            (Verdict::Agrees, Some((off, 0.0))) => format!("agrees, {} off", short(off.abs())),
            (Verdict::Agrees, Some((off, aim))) => {
                format!("agrees, {} % off", percent(100.0 * (off / aim).abs()))
            }
            (verdict, _) => verdict.text().into(),
        }
    }
}

/// Whole percents, or a digit more below one.
fn percent(x: f64) -> String {
    match x < 1.0 {
        true => format!("{x:.1}"),
        false => format!("{x:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::number::Number;
    use super::super::synthetic::claim;
    use super::*;
    use Verdict::{Agrees, Disagrees, NotResolved};

    const ONE: &str = "value = 1.0\ntolerance = 0.1";

    fn verdict(bounds: &str, value: f64, error: f64) -> Verdict {
        let found = Ok(Number::one(Value::new(value, error), ""));
        claim(bounds).agreement(&Measured::new("x", "", found))
    }

    #[test]
    fn deviations_are_from_the_number_or_from_the_bound_that_is_not_kept() {
        let off = |bounds: &str, value: f64, error: f64| {
            let number = Value::new(value, error);
            claim(bounds).deviation(number).join(" ")
        };
        assert_eq!(off("value = 2.0\ntolerance = 0.1", 2.5, 0.25), "+25 % +2.0");
        assert_eq!(off("value = -2.0\ntolerance = 0.1", -2.5, 0.0), "-25 % -");
        assert_eq!(off("value = 0.0\ntolerance = 0.1", 0.2, 0.1), "- +2.0");
        assert_eq!(off("least = 2.0", 2.5, 0.4), "- -");
        assert_eq!(off("least = 2.0", 1.0, 0.5), "-50 % -2.0");
        assert_eq!(off("least = 0.0\nmost = 1.0", 1.5, 0.5), "+50 % +1.0");
        let text = |value: f64, error: f64| claim(ONE).deviation_text(Value::new(value, error));
        assert_eq!(text(1.05, 0.01), "+5 %, +5.0 errors");
        assert_eq!(text(1.05, 0.0), "+5 %");
        assert_eq!(claim("most = 2.0").deviation_text(Value::new(1.0, 0.1)), "");
    }

    #[test]
    fn errors_decide_what_can_be_told() {
        assert_eq!(verdict(ONE, 1.09, 0.05), Agrees);
        assert_eq!(verdict(ONE, 1.0, 0.11), NotResolved);
        assert_eq!(verdict(ONE, 1.19, 0.05), NotResolved);
        assert_eq!(verdict(ONE, 1.21, 0.05), Disagrees);
        assert_eq!(verdict(ONE, f64::NAN, 0.05), NotResolved);
        let least = "least = 2.0";
        assert_eq!(verdict(least, 2.5, 0.4), Agrees);
        assert_eq!(verdict(least, 2.2, 0.4), NotResolved);
        assert_eq!(verdict(least, 1.3, 0.4), NotResolved);
        assert_eq!(verdict(least, 1.1, 0.4), Disagrees);
        let both = "least = 0.0\nmost = 1.0";
        assert_eq!(verdict(both, 0.5, 0.1), Agrees);
        assert_eq!(verdict(both, 1.5, 0.1), Disagrees);
        assert_eq!(verdict(both, 0.95, 0.1), NotResolved);
    }

    /// What is wrong may be the assumption.
    #[test]
    fn an_assumption_of_ours_keeps_a_claim_from_being_contradicted() {
        let mut own = claim(ONE);
        assert_eq!(own.judge(Value::new(2.0, 0.05), 1), Disagrees);
        own.assumes = Some("Nothing else matters.".into());
        assert_eq!(own.judge(Value::new(2.0, 0.05), 1), NotResolved);
        assert_eq!(own.judge(Value::new(1.05, 0.05), 1), Agrees);
        assert_eq!(own.words(Value::new(2.0, 0.05), 1), "not resolved");
    }

    /// Of 32 numbers the worst may lie 3.2 errors outside; to agree takes no more than of one.
    #[test]
    fn the_worst_of_several_has_to_lie_farther_outside() {
        let judge = |value: f64, of: usize| claim(ONE).judge(Value::new(value, 0.05), of);
        assert_eq!((judge(1.23, 1), judge(1.23, 32)), (Disagrees, NotResolved));
        assert_eq!(judge(1.27, 32), Disagrees);
        assert_eq!(judge(1.09, 32), Agrees);
    }

    /// A tolerance hides no deviation that is known well.
    #[test]
    fn an_agreement_says_how_far_it_is_off() {
        let words =
            |bounds: &str, value: f64, error: f64| claim(bounds).words(Value::new(value, error), 1);
        let wide = "value = 10.0\ntolerance = 3.0";
        assert_eq!(words(wide, 7.7, 0.044), "agrees, 23 % off");
        assert_eq!(words(wide, 7.7, 0.8), "agrees");
        assert_eq!(words(wide, 9.95, 0.01), "agrees, 0.5 % off");
        assert_eq!(words(wide, 5.0, 0.044), "disagrees");
        assert_eq!(words(wide, 6.9, 0.1), "not resolved");
        assert_eq!(
            words("value = 0.0\ntolerance = 0.2", 0.1, 0.01),
            "agrees, 0.1 off"
        );
        assert_eq!(words("most = 2.0", 1.0, 0.01), "agrees");
    }

    #[test]
    fn what_speaks_most_against_a_claim_is_told() {
        let against = |value: f64, error: f64| claim(ONE).against(Value::new(value, error));
        // Nearer to the edge, then poorly known, then outside; of those outside by their errors.
        let order = [
            against(1.02, 0.01),
            against(0.92, 0.05),
            against(1.0, 0.2),
            against(1.11, 0.05),
            against(1.11, 0.01),
        ];
        assert!(order.is_sorted_by(|a, b| a < b), "{order:?}");
        assert_eq!(
            claim("most = 1.0").against(Value::new(1.0, 0.0)),
            (false, 0.0)
        );
        assert_eq!(
            claim("most = 1.0").against(Value::new(1.0, 0.1)),
            (true, 0.0)
        );
    }
}
