//! Registry of the built-in schemes: names, orders, conserved quantities, and constructors.

use BuiltIn::{
    Baoab, EulerMaruyama, Heun, HeunLevy, Midpoint, Nv, Sexp, SexpH, SexpLevy, SexpLi, SexpLiLevy,
    Split, SplitH,
};
use systems::{Flows, PoissonSystem, run_time::System};

use crate::{
    Scheme, SchemeError,
    run_time::{
        self,
        composition::{parts, parts_by_noise},
    },
};

/// A scheme of this crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BuiltIn {
    /// [`Sexp`](crate::Sexp).
    Sexp,
    /// [`SexpLevy`](crate::SexpLevy).
    SexpLevy,
    /// [`SexpLi`](crate::SexpLi).
    SexpLi,
    /// [`SexpLi::with_areas`](crate::SexpLi::with_areas).
    SexpLiLevy,
    /// [`Split`](crate::Split).
    Split,
    /// [`SplitH`](crate::SplitH), without friction on single components.
    SplitH,
    /// [`SexpH`](crate::SexpH), without friction on single components.
    SexpH,
    /// [`Nv`](crate::Nv).
    Nv,
    /// [`Baoab`](crate::Baoab), without friction on single components.
    Baoab,
    /// [`Midpoint`](crate::Midpoint).
    Midpoint,
    /// [`Heun`](crate::Heun).
    Heun,
    /// [`HeunLevy`](crate::HeunLevy).
    HeunLevy,
    /// [`EulerMaruyama`](crate::EulerMaruyama).
    EulerMaruyama,
}

/// Name, orders and long-time behaviour of a scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Properties {
    /// Name of the scheme.
    pub id: &'static str,
    /// Condition for strong order one.
    pub strong: StrongOrder,
    /// Weak order.
    pub weak: f64,
    /// Order without noise.
    pub without_noise: f64,
    /// Whether a step is explicit.
    pub explicit: Explicitness,
    /// Whether the damping is exact. Other schemes read the rate γ(t), and not its integral.
    pub exact_damping: bool,
    /// Behaviour of the energy H₀ over long times, without noise and damping.
    pub energy: Energy,
    /// Behaviour over long times, in words.
    pub long_times: &'static str,
}

/// Condition for strong order one or more; otherwise the strong order is ½.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrongOrder {
    /// The noises commute.
    Commuting,
    /// No condition: the scheme reads Lévy areas.
    Areas,
    /// The noises commute: the order is 1.5, and 2 in Langevin dynamics.
    SpaceTime,
    /// The terms ½ΔWₘΔW_l fₘ′f_l are zero.
    Additive,
}

/// Whether a step is explicit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Explicitness {
    /// Nowhere: a step solves an equation, or composes flows.
    No,
    /// Where B is constant.
    WhereConstant,
    /// For every system; no invariant is kept.
    Always,
}

/// Behaviour of an energy over long times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Energy {
    /// The energy is conserved.
    Kept,
    /// The energy stays near its value.
    Near,
    /// The energy drifts.
    Drifts,
}

impl BuiltIn {
    /// All built-in schemes.
    pub const ALL: [Self; 13] = [
        Sexp,
        SexpLevy,
        SexpLi,
        SexpLiLevy,
        Split,
        SplitH,
        SexpH,
        Nv,
        Baoab,
        Midpoint,
        Heun,
        HeunLevy,
        EulerMaruyama,
    ];

    /// The scheme of this name.
    #[must_use]
    pub fn named(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scheme| scheme.id() == id)
    }

    /// Name of the scheme.
    #[must_use]
    pub fn id(self) -> &'static str {
        self.properties().id
    }

    /// Orders and long-time behaviour of the scheme.
    #[must_use]
    pub fn properties(self) -> Properties {
        let sexp = Properties {
            id: "sexp",
            strong: StrongOrder::Commuting,
            weak: 1.0,
            without_noise: 2.0,
            explicit: Explicitness::No,
            exact_damping: true,
            energy: Energy::Kept,
            long_times: "exact damping; Casimirs and, but for the noise, the energy kept",
        };
        let linear = Properties {
            id: "sexp-li",
            explicit: Explicitness::WhereConstant,
            energy: Energy::Drifts,
            long_times: "exact damping; Casimirs kept; the energy drifts",
            ..sexp
        };
        let flows = Properties {
            id: "split",
            energy: Energy::Near,
            long_times: "exact damping; Casimirs kept; the energy stays near where flows are exact",
            ..sexp
        };
        let explicit = Properties {
            id: "heun",
            explicit: Explicitness::Always,
            exact_damping: false,
            energy: Energy::Drifts,
            long_times: "nothing is kept: the energy drifts, or explodes",
            ..sexp
        };
        let with_areas = StrongOrder::Areas;
        match self {
            Sexp => sexp,
            SexpLevy => Properties { id: "sexp-levy", strong: with_areas, ..sexp },
            SexpLi => linear,
            SexpLiLevy => Properties { id: "sexp-li-levy", strong: with_areas, ..linear },
            Split => flows,
            SplitH => {
                Properties { id: "split-h", strong: StrongOrder::SpaceTime, weak: 2.0, ..flows }
            }
            SexpH => Properties { id: "sexp-h", strong: StrongOrder::SpaceTime, weak: 2.0, ..sexp },
            Nv => Properties { id: "nv", weak: 2.0, ..flows },
            Baoab => Properties { id: "baoab", weak: 2.0, ..flows },
            Midpoint => Properties {
                id: "midpoint",
                exact_damping: false,
                energy: Energy::Near,
                long_times: "without damping Casimirs are kept, and the energy stays near",
                ..sexp
            },
            Heun => explicit,
            HeunLevy => Properties { id: "heun-levy", strong: with_areas, ..explicit },
            EulerMaruyama => Properties {
                id: "em",
                strong: StrongOrder::Additive,
                without_noise: 1.0,
                ..explicit
            },
        }
    }

    /// Whether the scheme reads Lévy areas where noises do not commute.
    #[must_use]
    pub fn is_for_areas(self) -> bool {
        self.properties().strong == StrongOrder::Areas
    }

    /// Whether the scheme uses fields alone, so that it is for equations [without B and
    /// H](systems::run_time::Description::plain).
    #[must_use]
    pub fn is_for_plain(self) -> bool {
        matches!(self, Midpoint | Heun | HeunLevy | EulerMaruyama)
    }

    /// Behaviour over long times, in words. `constant`: B does not depend on y.
    #[must_use]
    pub fn long_times(self, constant: bool) -> &'static str {
        match self.properties() {
            Properties { explicit: Explicitness::WhereConstant, .. } if constant => {
                "exact damping; explicit, since B is constant: the energy drifts"
            }
            properties => properties.long_times,
        }
    }

    /// Whether a step is explicit, so that energies drift or explode. `constant`: B does not depend
    /// on y.
    #[must_use]
    pub fn is_explicit(self, constant: bool) -> bool {
        match self.properties().explicit {
            Explicitness::Always => true,
            Explicitness::WhereConstant => constant,
            Explicitness::No => false,
        }
    }

    /// The scheme for a compiled system without flows.
    ///
    /// # Errors
    /// [`SchemeError`] if it is not for the system.
    pub fn compiled<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        self,
        system: &S,
        y0: [f64; D],
    ) -> Result<Box<dyn Scheme<S, D, M>>, SchemeError> {
        Ok(match self {
            Sexp => Box::new(crate::Sexp),
            SexpLevy => Box::new(crate::SexpLevy::new(system, y0)),
            SexpLi => Box::new(crate::SexpLi::new(system, y0)?),
            SexpLiLevy => Box::new(crate::SexpLi::with_areas(system, y0)?),
            Midpoint => Box::new(crate::Midpoint),
            Heun => Box::new(crate::Heun),
            EulerMaruyama => Box::new(crate::EulerMaruyama),
            SexpH | Baoab | HeunLevy => {
                let reason = "the scheme is for systems known at run time, such as formulas";
                return Err(SchemeError::not_for(self.id(), system.name(), reason));
            }
            Split | SplitH | Nv => {
                let reason = "its flows are not known";
                return Err(SchemeError::parts(self.id(), system.name(), reason));
            }
        })
    }

    /// The scheme for a compiled system of parts with flows.
    ///
    /// # Errors
    /// [`SchemeError`] if it is not for the system.
    pub fn by_parts<S: Flows<D, M>, const D: usize, const M: usize>(
        self,
        system: &S,
        y0: [f64; D],
    ) -> Result<Box<dyn Scheme<S, D, M>>, SchemeError> {
        match self {
            Split => Ok(Box::new(crate::Split)),
            Nv => Ok(Box::new(crate::Nv::default())),
            SplitH if systems::noises_commute(system, y0) => Ok(Box::new(crate::SplitH::new([]))),
            SplitH => Err(SchemeError::not_for("split-h", system.name(), DO_NOT_COMMUTE)),
            _ => self.compiled(system, y0),
        }
    }

    /// The scheme for a system known at run time.
    ///
    /// # Errors
    /// [`SchemeError`] if it is not for the system.
    pub fn at_run_time(
        self,
        system: &dyn System,
    ) -> Result<Box<dyn run_time::Scheme>, SchemeError> {
        let description = system.description();
        if description.plain && !self.is_for_plain() {
            return Err(SchemeError::not_for(self.id(), &description.name, PLAIN));
        }
        Ok(match self {
            Sexp => Box::new(crate::Sexp),
            SexpLevy => Box::new(crate::SexpLevy::at_run_time(system)?),
            SexpLi => Box::new(crate::SexpLi::at_run_time(system)?),
            SexpLiLevy => Box::new(crate::SexpLi::at_run_time_with_areas(system)?),
            Midpoint => Box::new(crate::Midpoint),
            Heun => Box::new(crate::Heun),
            HeunLevy if description.noises_commute => Box::new(crate::HeunLevy::<false>),
            HeunLevy => fits(crate::HeunLevy::<true>, system)?,
            EulerMaruyama => Box::new(crate::EulerMaruyama),
            Split => parts("split", system).map(|_| Box::new(crate::Split))?,
            Nv => parts_by_noise("nv", system).map(|_| Box::new(crate::Nv::default()))?,
            Baoab => fits(crate::Baoab::default(), system)?,
            SplitH => fits(crate::SplitH::of(system, []), system)?,
            SexpH => fits(crate::SexpH::of(system, []), system)?,
        })
    }
}

/// Why a scheme is not for a [plain](systems::run_time::Description::plain) equation.
pub const PLAIN: &str = "an equation of drift and noise alone has neither B nor H, from \
                                which it is made: take heun, heun-levy, midpoint or em";

/// Why a scheme is refused.
pub const DO_NOT_COMMUTE: &str = "its noises do not commute; take nv";

/// The scheme, if it is for the system.
fn fits<T: run_time::Scheme + 'static>(
    scheme: T,
    system: &dyn System,
) -> Result<Box<dyn run_time::Scheme>, SchemeError> {
    scheme.stepper(system)?;
    Ok(Box::new(scheme))
}
