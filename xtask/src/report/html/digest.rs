//! The evidence of many claims in one line.

use super::group::Group;
use super::outcome::Outcome;
use super::prose::prose;

/// Up to this many orders are listed; of more only the range is told.
const LISTED: usize = 3;

/// What the claims of a group measured, in one line of HTML.
pub fn digest(group: &Group) -> String {
    let evidence = || group.claims.iter().map(|claim| claim.evidence.as_str());
    if let [only] = group.claims[..] {
        return prose(brief(&only.evidence));
    }
    if let Some(orders) = evidence().map(order).collect::<Option<Vec<_>>>() {
        return if orders.len() <= LISTED {
            format!("orders {}", prose(&listed(&orders)))
        } else {
            format!("{} orders {}", orders.len(), prose(&range(&orders)))
        };
    }
    if let Some(defects) = evidence().map(defect).collect::<Option<Vec<_>>>() {
        return format!(
            "largest relative defects {} in {} checks",
            prose(&range(&defects)),
            defects.len()
        );
    }
    let telling = group.claims.iter().find(|claim| Outcome::of(claim) == group.verdict());
    prose(&format!("for example, {}", telling.unwrap_or(&group.first()).evidence))
}

/// Evidence without the remarks on how an order was fitted.
fn brief(evidence: &str) -> &str {
    match evidence.split_once(';') {
        Some((result, _)) if order(evidence).is_some() => result,
        _ => evidence,
    }
}

/// The number in "order 0.998, 95 % interval …", as it is written.
fn order(evidence: &str) -> Option<&str> {
    number(evidence.strip_prefix("order ")?.split([',', ';', ' ']).next()?)
}

/// The number in "largest relative defect of C along the path: 1.8e-15", as it is written.
fn defect(evidence: &str) -> Option<&str> {
    number(evidence.strip_prefix("largest relative defect of ")?.rsplit_once(": ")?.1)
}

fn number(text: &str) -> Option<&str> {
    text.parse::<f64>().is_ok_and(f64::is_finite).then_some(text)
}

fn listed(numbers: &[&str]) -> String {
    match numbers {
        [init @ .., last] if !init.is_empty() => format!("{} and {last}", init.join(", ")),
        _ => numbers.concat(),
    }
}

fn range(numbers: &[&str]) -> String {
    let value = |text: &&&str| text.parse().unwrap_or(f64::NAN);
    let ends = (
        numbers.iter().min_by(|a, b| value(a).total_cmp(&value(b))),
        numbers.iter().max_by(|a, b| value(a).total_cmp(&value(b))),
    );
    match ends {
        (Some(lo), Some(hi)) => format!("between {lo} and {hi}"),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use verify::results::{Claim, Verdict};

    use super::super::group::tests::claim;
    use super::*;

    fn digest_of(evidence: &[&str]) -> String {
        let claims: Vec<Claim> = evidence
            .iter()
            .map(|text| Claim {
                evidence: (*text).to_owned(),
                ..claim("a", "", true, Verdict::Holds, "")
            })
            .collect();
        digest(&Group { claims: claims.iter().collect() })
    }

    #[test]
    fn orders_and_defects_are_gathered() {
        let order = |p: f64| format!("order {p:.3}, 95 % interval [0.9, 1.1]; least squares");
        let orders: Vec<String> = [1.001, 0.99, 1.015, 1.0].map(order).into();
        let orders: Vec<&str> = orders.iter().map(String::as_str).collect();
        assert_eq!(digest_of(&orders[..1]), "order 1.001, 95 % interval [0.9, 1.1]");
        assert_eq!(digest_of(&orders[..3]), "orders 1.001, 0.990 and 1.015");
        assert_eq!(digest_of(&orders), "4 orders between 0.990 and 1.015");
        let defects = ["1.8e-15", "5.6e-1"]
            .map(|d| format!("largest relative defect of C along the path: {d}"));
        assert_eq!(
            digest_of(&[&defects[0], &defects[1]]),
            "largest relative defects between 1.8·10<sup>−15</sup> and 0.56 in 2 checks"
        );
    }

    #[test]
    fn other_evidence_is_quoted() {
        assert_eq!(digest_of(&["ratio 2; fine"]), "ratio 2; fine");
        assert_eq!(digest_of(&["order 1.0, x", "ratio 2"]), "for example, order 1.0, x");
    }
}
