//! Claims about the same statement, and their common verdict.

use plot::escape;

use super::Outcome;
use super::{
    markup::{code, scheme},
    number::scientific,
    prose::prose,
};
use crate::results::{Claim, Evidence};

/// The claims about one statement: proven ones by statement, others by statement and scheme.
pub struct Group<'a> {
    /// The claims, never none, in the order of the results.
    pub claims: Vec<&'a Claim>,
}

impl<'a> Group<'a> {
    /// Groups claims in the order in which the statements first appear.
    pub fn all(claims: impl IntoIterator<Item = &'a Claim>) -> Vec<Self> {
        let key = |claim: &'a Claim| (&claim.id, (!claim.proven).then_some(&claim.scheme));
        let mut groups: Vec<Self> = Vec::new();
        for claim in claims {
            match groups.iter_mut().find(|group| key(group.first()) == key(claim)) {
                Some(group) => group.claims.push(claim),
                None => groups.push(Self { claims: vec![claim] }),
            }
        }
        groups
    }

    /// The groups of what is proven and of what is only reported.
    pub fn proven_and_reported(claims: &'a [Claim]) -> (Vec<Self>, Vec<Self>) {
        Self::all(claims).into_iter().partition(|group| group.first().proven)
    }

    /// The claim that opened the group.
    pub fn first(&self) -> &'a Claim {
        self.claims[0]
    }

    /// How many claims have this outcome.
    pub fn tally(&self, outcome: Outcome) -> usize {
        outcome.count(self.claims.iter().copied())
    }

    /// Refuted if one claim is, else undecided if one is; a misprint counts only where nothing else
    /// is left.
    pub fn verdict(&self) -> Outcome {
        Outcome::of(self.worst())
    }

    fn worst(&self) -> &'a Claim {
        self.claims.iter().min_by_key(|claim| Outcome::of(claim)).expect("a group has claims")
    }

    /// How many of how many hold, and what became of the rest.
    pub fn counts(&self) -> String {
        let mut counts = format!("{} of {} hold", self.tally(Outcome::Holds), self.claims.len());
        for outcome in Outcome::BLEMISHES {
            match self.tally(outcome) {
                0 => {}
                n => counts += &format!(", {n} {}", outcome.word()),
            }
        }
        counts
    }

    /// Its address on the page.
    pub fn anchor(&self) -> String {
        let claim = self.first();
        let id = escape(&claim.id);
        match claim.proven {
            true => format!("statement-{id}"),
            false => format!("reported-{id}-{}", escape(&claim.scheme)),
        }
    }

    /// The scheme, which is part of the name of what is not proven.
    pub fn scheme(&self) -> String {
        if self.first().proven { String::new() } else { scheme(self.first()) }
    }

    /// Its identifier, linked to its address.
    pub fn link(&self) -> String {
        format!("<a href=\"#{}\">{}</a>", self.anchor(), code(&self.first().id))
    }

    /// What the claims measured, in a line.
    pub fn digest(&self) -> String {
        // One number, or how many there are and between what; none where a claim has none.
        let spread = |name: &str, number: fn(&Evidence) -> Option<f64>, show: fn(f64) -> String| {
            let numbers = self.claims.iter().map(|claim| number(&claim.measured));
            let mut numbers: Vec<f64> = numbers.collect::<Option<_>>()?;
            numbers.sort_by(f64::total_cmp);
            let (count, least, most) = (numbers.len(), numbers[0], numbers[numbers.len() - 1]);
            Some(match count {
                1 => format!("{name} {}", show(least)),
                _ => format!("{count} {name}s between {} and {}", show(least), show(most)),
            })
        };
        let order = |evidence: &Evidence| match evidence {
            Evidence::Order { rate, .. } => Some(rate.as_ref()?.estimate),
            _ => None,
        };
        let defect = |evidence: &Evidence| match evidence {
            Evidence::Defect { largest, .. } | Evidence::Approach { largest, .. } => Some(*largest),
            _ => None,
        };
        let evidence = || {
            let example = if self.claims.len() == 1 { "" } else { "for example, " };
            example.to_owned() + &prose(&self.worst().evidence)
        };
        spread("order", order, |order| format!("{order:.3}"))
            .or_else(|| spread("largest relative defect", defect, |defect| scientific(defect, 1)))
            .unwrap_or_else(evidence)
    }
}

#[cfg(test)]
mod tests {
    use crate::results::{Rate, Verdict};

    use super::super::tests::claim;
    use super::*;

    #[test]
    fn what_is_proven_and_what_is_reported_stay_apart() {
        let claims = [
            claim("a", "sexp", true, Verdict::Holds, ""),
            claim("a", "em", false, Verdict::Holds, ""),
            claim("a", "sexp", false, Verdict::Undecided, ""),
            claim("b", "", true, Verdict::Holds, ""),
            claim("a", "", true, Verdict::Refuted, ""),
        ];
        let groups = Group::all(&claims);
        let anchors: Vec<String> = groups.iter().map(Group::anchor).collect();
        assert_eq!(anchors, ["statement-a", "reported-a-em", "reported-a-sexp", "statement-b"]);
        assert_eq!(groups[0].verdict(), Outcome::Refuted);
        assert_eq!(groups[0].counts(), "1 of 2 hold, 1 refuted");
    }

    #[test]
    fn a_group_is_as_good_as_its_worst_claim_misprints_aside() {
        let verdict = |claims: &[Claim]| Group { claims: claims.iter().collect() }.verdict();
        let holds = claim("a", "", true, Verdict::Holds, "");
        let misprint = claim("a", "", true, Verdict::Refuted, "p ≤ 2 is meant");
        let undecided = claim("a", "", true, Verdict::Undecided, "");
        let refuted = claim("a", "", true, Verdict::Refuted, "");
        assert_eq!(verdict(&[misprint.clone(), holds.clone()]), Outcome::Holds);
        assert_eq!(verdict(std::slice::from_ref(&misprint)), Outcome::Misprint);
        assert_eq!(
            verdict(&[holds.clone(), undecided.clone(), misprint.clone()]),
            Outcome::Undecided
        );
        assert_eq!(verdict(&[holds, undecided, misprint, refuted]), Outcome::Refuted);
    }

    #[test]
    fn measurements_are_gathered() {
        let digest = |measured: &[Evidence]| {
            let claim = |measured: &Evidence| Claim {
                evidence: measured.to_string(),
                measured: measured.clone(),
                ..claim("a", "", true, Verdict::Holds, "")
            };
            let claims: Vec<Claim> = measured.iter().map(claim).collect();
            Group { claims: claims.iter().collect() }.digest()
        };
        let order = |estimate| Evidence::order(1.0, Some(Rate { estimate, ..Rate::default() }));
        let other = Evidence::Undecided { reason: "too short".into() };
        assert_eq!(digest(&[order(1.001)]), "order 1.001");
        assert_eq!(digest(&[order(1.001), order(0.99)]), "2 orders between 0.990 and 1.001");
        assert_eq!(digest(std::slice::from_ref(&other)), "too short");
        assert_eq!(digest(&[other, order(1.0)]), "for example, too short");
    }
}
