//! Claims that answer the same statement, and their common verdict.

use verify::results::Claim;

use super::outcome::Outcome;
use crate::report::escape::escape;

/// The claims about one statement: proven ones by statement, what is only reported by statement and
/// scheme.
pub struct Group<'a> {
    /// The claims, never none, in the order of the results.
    pub claims: Vec<&'a Claim>,
}

impl<'a> Group<'a> {
    /// Groups claims in the order in which the statements first appear.
    pub fn all(claims: impl IntoIterator<Item = &'a Claim>) -> Vec<Self> {
        let mut groups: Vec<Self> = Vec::new();
        for claim in claims {
            match groups.iter_mut().find(|group| key(group.first()) == key(claim)) {
                Some(group) => group.claims.push(claim),
                None => groups.push(Self { claims: vec![claim] }),
            }
        }
        groups
    }

    /// The claim that opened the group.
    pub fn first(&self) -> &'a Claim {
        self.claims[0]
    }

    /// How many claims have this outcome.
    pub fn tally(&self, outcome: Outcome) -> usize {
        self.claims.iter().filter(|claim| Outcome::of(claim) == outcome).count()
    }

    /// Refuted if one claim is, else undecided if one is; a misprint counts only where nothing else
    /// is left.
    pub fn verdict(&self) -> Outcome {
        let worst = |outcome| self.tally(outcome) > 0;
        [Outcome::Refuted, Outcome::Undecided, Outcome::Holds]
            .into_iter()
            .find(|o| worst(*o))
            .unwrap_or(Outcome::Misprint)
    }

    /// Whether every claim simply holds.
    pub fn is_clear(&self) -> bool {
        self.tally(Outcome::Holds) == self.claims.len()
    }

    /// How many of how many hold, and what became of the rest.
    pub fn counts(&self) -> String {
        let (all, holding) = (self.claims.len(), self.tally(Outcome::Holds));
        let verb = if all == 1 { "holds" } else { "hold" };
        let rest: String = [Outcome::Refuted, Outcome::Misprint, Outcome::Undecided]
            .into_iter()
            .map(|outcome| (outcome, self.tally(outcome)))
            .filter(|(_, n)| *n > 0)
            .map(|(outcome, n)| {
                format!(
                    ", {n} {}",
                    if outcome == Outcome::Misprint { "misprint" } else { outcome.words() }
                )
            })
            .collect();
        format!("{holding} of {all} {verb}{rest}")
    }

    /// Its address on the page.
    pub fn anchor(&self) -> String {
        let claim = self.first();
        let id = escape(&claim.id);
        if claim.proven {
            format!("statement-{id}")
        } else {
            format!("reported-{id}-{}", escape(&claim.scheme))
        }
    }
}

fn key(claim: &Claim) -> (bool, &str, &str) {
    (claim.proven, &claim.id, if claim.proven { "" } else { &claim.scheme })
}

#[cfg(test)]
pub mod tests {
    use verify::results::Verdict;

    use super::*;

    /// A claim for tests.
    pub fn claim(id: &str, scheme: &str, proven: bool, verdict: Verdict, erratum: &str) -> Claim {
        Claim {
            id: id.into(),
            panel: String::new(),
            scheme: scheme.into(),
            statement: format!("{scheme} has {id}"),
            verdict,
            evidence: "order 1.0, as it should be".into(),
            proven,
            erratum: erratum.into(),
        }
    }

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
}
