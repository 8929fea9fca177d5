//! Warnings as data.

use std::fmt::{self, Display};

use serde::{Deserialize, Serialize};

/// Something that a reader of a result must know.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Warning {
    /// Fact that is wrong or not known.
    pub what: String,
    /// Evidence for it, with its numbers; may be empty.
    pub why: String,
    /// Remedy; may be empty.
    pub remedy: String,
}

impl Warning {
    /// A warning without evidence and remedy.
    pub fn new(what: impl Into<String>) -> Self {
        Self { what: what.into(), ..Self::default() }
    }

    /// Adds the evidence, with its numbers.
    #[must_use]
    pub fn with_reason(self, why: impl Into<String>) -> Self {
        Self { why: why.into(), ..self }
    }

    /// Adds a remedy.
    #[must_use]
    pub fn with_remedy(self, remedy: impl Into<String>) -> Self {
        Self { remedy: remedy.into(), ..self }
    }

    /// The warning about one of several: `name: what`.
    #[must_use]
    pub fn about(self, name: impl Display) -> Self {
        Self { what: format!("{name}: {}", self.what), ..self }
    }
}

/// `what: why; remedy`.
impl Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, why, remedy } = self;
        f.write_str(what)?;
        let mut parts =
            [(": ", why), ("; ", remedy)].into_iter().filter(|(_, part)| !part.is_empty());
        parts.try_for_each(|(mark, part)| write!(f, "{mark}{part}"))
    }
}
