//! Claims about the same statement, and their common verdict.

use super::{Outcome, code, outcome::badge, prose::prose};
use crate::results::{Claim, Evidence};

/// The claims about one statement: proven ones by statement, others by statement and scheme.
pub struct Group<'a>(Vec<&'a Claim>);

impl<'a> Group<'a> {
    /// Groups claims in the order in which the statements first appear.
    pub fn all(claims: impl IntoIterator<Item = &'a Claim>) -> Vec<Self> {
        let key = |claim: &'a Claim| (&claim.id, (!claim.proven).then_some(&claim.scheme));
        let mut groups: Vec<Self> = Vec::new();
        for claim in claims {
            match groups.iter_mut().find(|group| key(group.first()) == key(claim)) {
                Some(group) => group.0.push(claim),
                None => groups.push(Self(vec![claim])),
            }
        }
        groups
    }

    /// The claim that opened the group.
    pub fn first(&self) -> &'a Claim {
        self.0[0]
    }

    /// Refuted if one claim is, else undecided if one is; a misprint counts only where nothing else
    /// is left.
    pub fn verdict(&self) -> Outcome {
        Outcome::of(self.worst())
    }

    fn worst(&self) -> &'a Claim {
        self.0.iter().min_by_key(|claim| Outcome::of(claim)).expect("a group has claims")
    }

    /// Verdict, statement, scheme and what was measured.
    pub fn row(&self) -> Vec<String> {
        let claim = self.first();
        let hold = Outcome::Holds.count(self.0.iter().copied());
        let scheme = if claim.proven { "" } else { &claim.scheme };
        vec![
            format!("{} {hold} of {}", badge(self.verdict()), self.0.len()),
            format!("{}<br>{}", prose(&claim.statement), code(&claim.id)),
            code(scheme),
            self.digest(),
        ]
    }

    /// Between what the orders or defects lie, or an example.
    fn digest(&self) -> String {
        let number = |claim: &&Claim| match &claim.measured {
            Evidence::Order { rate, .. } => Some(("order", rate.as_ref()?.estimate)),
            Evidence::Defect { largest, .. } | Evidence::Approach { largest, .. } => {
                Some(("largest relative defect", *largest))
            }
            _ => None,
        };
        let numbers: Option<Vec<_>> = self.0.iter().map(number).collect();
        let Some(mut numbers) = numbers.filter(|_| self.0.len() > 1) else {
            return prose(&self.worst().evidence);
        };
        numbers.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (name, least) = numbers[0];
        let show = |x: f64| if name == "order" { format!("{x:.3}") } else { format!("{x:.1e}") };
        prose(&format!("{name} {} … {}", show(least), show(numbers[numbers.len() - 1].1)))
    }
}

/// How many groups hold, and the others by name.
pub fn summary(what: &str, groups: &[Group]) -> String {
    if groups.is_empty() {
        return String::new();
    }
    let of = |outcome| groups.iter().filter(move |group| group.verdict() == outcome);
    let hold = of(Outcome::Holds).count();
    let mut text = format!("<strong>{hold} of {}</strong> {what} hold", groups.len());
    for outcome in Outcome::BLEMISHES {
        let name = |group: &Group| {
            let Claim { id, proven, scheme, .. } = group.first();
            code(id) + &if *proven { String::new() } else { code(scheme) }
        };
        let names: Vec<String> = of(outcome).map(name).collect();
        if !names.is_empty() {
            let word = outcome.word();
            text += &format!("; <span class=\"{word}\">{word}: {}</span>", names.join(", "));
        }
    }
    text + ". "
}

/// What the documented misprints say, each in a paragraph of its own.
pub fn misprints(claims: &[Claim]) -> String {
    let misprints = claims.iter().filter(|claim| Outcome::of(claim) == Outcome::Misprint);
    let paragraph = |claim: &Claim| {
        format!(
            "<p class=\"summary erratum\"><b>Misprint in the paper</b> ({}): {} The statement as \
             printed is refuted: {}.</p>\n",
            code(&claim.id),
            prose(&claim.erratum),
            prose(&claim.statement),
        )
    };
    misprints.map(paragraph).collect()
}
