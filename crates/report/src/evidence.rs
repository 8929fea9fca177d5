//! The measurement behind a claim, as data.

use verify::results::Claim;

/// What a claim measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measurement {
    /// A fitted order.
    Order(f64),
    /// The largest relative defect of a conformal law.
    Defect(f64),
    /// Something else, which only [`Claim::evidence`] says.
    Other,
}

/// The measurement behind a claim.
///
/// To be replaced by the field of [`Claim`] that holds it as data; until then this is the only
/// place that reads numbers from a sentence.
#[must_use]
pub fn evidence_of(claim: &Claim) -> Measurement {
    let number = |text: &str| text.parse().ok().filter(|x: &f64| x.is_finite());
    if let Some(rest) = claim.evidence.strip_prefix("order ") {
        let first = rest.split([',', ';', ' ']).next().and_then(number);
        return first.map_or(Measurement::Other, Measurement::Order);
    }
    match claim
        .evidence
        .strip_prefix("largest relative defect of ")
        .and_then(|t| t.rsplit_once(": "))
    {
        Some((_, last)) => number(last).map_or(Measurement::Other, Measurement::Defect),
        None => Measurement::Other,
    }
}
