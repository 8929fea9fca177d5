//! The keys of a scene file. Their comments are the descriptions in its JSON schema.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::{
    At, Count, Event, Few, Formulas, Name, Named, Parameter, Seed, Start, Structure, Text, Values,
    items, some_list,
};

/// A scene: one simulation of dy = (B∇H₀ − γy)dt + Σ B∇Hₘ ∘ dWₘ.
#[derive(Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Title of reports. Default: the name of the system or of the file.
    pub title: Option<String>,
    /// The system to simulate.
    pub system: SystemTable,
    /// Linear damping −γ(t)y. Default: none.
    pub damping: Option<DampingTable>,
    /// A heat bath; or several, each at its temperature, by `[[bath]]`. Default: none.
    #[serde(default)]
    pub bath: Few<BathTable>,
    /// Settings of the simulation.
    pub run: RunTable,
    /// Functions of the state that are of interest, by name.
    #[serde(default)]
    pub observe: Named<Text>,
    /// Conditions whose probabilities in time are of interest, by name.
    #[serde(default)]
    pub probabilities: Named<Text>,
    /// Events of a path, by name: the condition when one happens, `"q > 2"`, or a table of `when`
    /// and `stop`. An observable of this name is one from then on, `… time` is the time of the
    /// event.
    #[serde(default)]
    pub events: Named<Event>,
    /// Statistics of how observables depend on each other and on their past.
    #[serde(default)]
    pub statistics: StatisticsTable,
    /// The figures that are drawn, and their axes.
    #[serde(default)]
    pub figures: FiguresTable,
    /// Expectations for `casimir expect`.
    pub expect: Option<ExpectTable>,
    /// Parameters that `casimir fit` finds.
    pub fit: Option<FitTable>,
    /// Values of parameters that are varied, with an answer for each combination: a list, or
    /// `"from:to:number"`.
    #[serde(default)]
    pub sweep: Named<Values>,
}

/// A system of the project by its `name`, or formulas: `state`, `B`, `H0` and `H`; or `state`,
/// `drift` and `noise` of an equation that has neither B nor H.
#[derive(Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SystemTable {
    /// A system of the project, see `casimir new --list`. Not together with formulas.
    pub name: Option<Name>,
    /// Values of names in formulas, or of the parameters of a system of the project.
    #[serde(default)]
    pub parameters: Named<Parameter>,
    /// The names of the components of y. `q[1..3]` stands for q1, q2, q3 and makes them a vector q,
    /// `s[xyz]` stands for sx, sy, sz, and `s[1..2][xyz]` for two such vectors s1 and s2.
    #[serde(default, deserialize_with = "some_list")]
    pub state: Option<At<Vec<Name>>>,
    /// The skew-symmetric matrix B(y), row by row: all of it, or the entries above the diagonal. Or
    /// a sum of blocks: `canonical(q, p)`, `spins(s1, s2)` and `rigid`, which is B(y)v = y × v.
    #[serde(rename = "B")]
    pub structure: Option<At<Structure>>,
    /// The Hamiltonian H₀(y).
    #[serde(rename = "H0")]
    pub energy: Option<At<Text>>,
    /// The Hamiltonians Hₘ(y), one for each noise. Default: none.
    #[serde(rename = "H", default, deserialize_with = "some_list")]
    pub noises: Option<Formulas>,
    /// The sense of `drift` and `noise`. Default: `stratonovich`.
    pub calculus: Option<At<Calculus>>,
    /// The drift, a formula for each component. Without B, H0 and H it is that of the system, and
    /// damping comes besides; with them it is that of the whole equation, damping included, which
    /// is compared with them.
    #[serde(default, deserialize_with = "some_list")]
    pub drift: Option<Formulas>,
    /// The noise fields, a list of formulas for each noise, likewise.
    pub noise: Option<Vec<Formulas>>,
}

/// The sense of a stochastic equation.
#[derive(Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Calculus {
    /// Itô's.
    Ito,
    /// Stratonovich's.
    Stratonovich,
}

/// Linear damping −γ(t)y, of all components or of some: friction.
#[derive(Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DampingTable {
    /// γ(t) in 1/time, a formula in t and the parameters. A negative rate excites.
    pub rate: Option<At<Text>>,
    /// The components or vectors that have it. Default: all.
    #[serde(default, deserialize_with = "some_list")]
    pub components: Option<At<Vec<Name>>>,
    /// Rates of components or vectors by name, in the place of `rate`. Others have none.
    #[serde(default)]
    pub rates: Named<Text>,
}

/// A heat bath: noise and the damping that belongs to it, with exp(−H₀/kT) as its law.
#[derive(Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BathTable {
    /// kT, a formula in t and the parameters; on a lattice it is constant.
    pub temperature: At<Text>,
    /// Functions Φ(y) through which it acts: the noise B∇Φ ∘ (dW + u dt) with u = −{H₀, Φ}/2kT.
    #[serde(default, deserialize_with = "items")]
    pub through: Vec<At<Text>>,
    /// Rates γ of friction on momenta or vectors of them by name: Φ = √(2γmkT) q with the
    /// coordinate q and the mass m of the momentum.
    #[serde(default)]
    pub friction: Named<Text>,
    /// The damping α of Landau and Lifshitz of spins by name, `s` for all spins of a lattice:
    /// Φ = √(2αkT/|s|) s for each component of a spin s.
    #[serde(default)]
    pub transverse: Named<Text>,
}

/// Settings of the simulation.
#[derive(Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RunTable {
    /// The initial value y(0): a number or a formula of the parameters for each component, and of
    /// random numbers: z1, z2, … are standard normals, u1, u2, … uniform on (0, 1). For spins on a
    /// lattice three may stand for all, and depend on the place x, y, z of a spin. Or the name of a
    /// file of states, one in a line: paths take them in turn.
    pub initial: At<Start>,
    /// The final time T > 0; paths begin at time 0.
    pub until: At<Text>,
    /// Number of steps on [0, T].
    pub steps: At<Count>,
    /// The scheme: `auto` (one that damps exactly and keeps Casimirs and energy), `sexp`,
    /// `sexp-li`, `split`, `split-h`, `sexp-h`, `sexp-levy`, `sexp-li-levy`, `nv`, `baoab`,
    /// `midpoint`, `heun`, `heun-levy` or `em`. Default: `auto`.
    pub scheme: Option<Name>,
    /// Number of paths. From 100 on means, quantiles and histograms are computed, below that tables
    /// of all paths. Default: 1.
    pub paths: Option<At<Count>>,
    /// Number of paths of which tables are kept beside the statistics. Default: 3.
    pub tables: Option<At<Count>>,
    /// The columns of tables: names of components, observables and laws, `components` for all of
    /// them, `laws` likewise. Default: all, but not more than twelve components.
    pub columns: Option<Vec<Name>>,
    /// Number of saved times, evenly spaced; it divides the number of steps. Default: the largest
    /// number up to 200 that does.
    pub times: Option<At<Count>>,
    /// Number of snapshots of a large lattice after the start, evenly spaced, with correlations and
    /// structure factors; it divides the number of saved times. Default: 1, the end.
    pub snapshots: Option<At<Count>>,
    /// Seed of the random numbers: the same seed gives the same bits. Default: 1.
    pub seed: Option<At<Seed>>,
    /// Order k of the truncation of increments, |ΔW| ≤ √(2kτ|ln τ|), for schemes that need one; the
    /// step τ must be below 1 then. Default: 4, and never fewer than six deviations.
    pub truncation: Option<At<Count>>,
}

/// Expectations E[φ(y(T))] for `casimir expect`.
#[derive(Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExpectTable {
    /// Functions φ: names of components or observables, or formulas.
    #[serde(default, deserialize_with = "some_list")]
    pub of: Option<Formulas>,
    /// Half-width of the 95 % intervals.
    pub accuracy: Option<At<f64>>,
    /// Parameters θ for the derivatives of all expectations.
    #[serde(default, deserialize_with = "items")]
    pub gradient: Vec<Name>,
}

/// Parameters that `casimir fit` finds from data.
#[derive(Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FitTable {
    /// Names of the parameters, which are numbers; the search begins at their values.
    #[serde(deserialize_with = "items")]
    pub parameters: Vec<Name>,
}

/// Statistics of how observables depend on each other and on their past, from 100 paths on.
#[derive(Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StatisticsTable {
    /// Pairs of components or names of `observe`: covariance, correlation, joint law at the end.
    #[serde(default)]
    pub pairs: Vec<Pair>,
    /// Components or names of `observe`: autocorrelation and spectrum along paths.
    #[serde(default, deserialize_with = "items")]
    pub autocorrelation: Vec<Name>,
    /// The time from which autocorrelations count. Default: 0.
    pub from: Option<At<Text>>,
}

/// Two columns of tables.
pub type Pair = [Name; 2];

/// The figures that are drawn, and their axes.
#[derive(Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FiguresTable {
    /// Pairs of components or names of `observe` that are drawn against each other. Default: a few
    /// pairs of components.
    pub portraits: Option<Vec<Pair>>,
    /// The columns that are drawn, in this order. Default: all observables.
    pub show: Option<Vec<Name>>,
    /// Columns, and parameters of a sweep, with logarithmic axes.
    #[serde(default)]
    pub log: Vec<Name>,
}

/// The JSON schema of a scene file.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(SceneFile)
}
