//! The contract of `expectations.json`; documented for other languages in `docs/results.md`.

use serde::Serialize;
use verify::results::Provenance;

/// Raised whenever a reader of an older version would misread a newer one.
pub const SCHEMA: u32 = 1;

/// Everything measured.
#[derive(Serialize)]
pub struct Measurements {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Where it comes from.
    pub provenance: Provenance,
    /// What the times of the processor are, in words.
    pub clock: &'static str,
    /// The load average of the last minute at the start, where the system tells.
    pub load: Option<f64>,
    /// What E[cos y₃] costs by each method.
    pub methods: Vec<Method>,
    /// The twelve test functions.
    pub twelve: Twelve,
    /// The bias of schemes.
    pub bias: Bias,
    /// The weak order of `nv` and its twins.
    pub orders: Orders,
}

/// A way to compute an expectation.
#[derive(Serialize)]
pub struct Method {
    /// What it is called.
    pub name: &'static str,
    /// From the least accurate on.
    pub rows: Vec<Cost>,
    /// Slope of ln path-steps over ln ε.
    pub path_steps: Option<Slope>,
    /// Slope of ln processor seconds over ln ε.
    pub processor_s: Option<Slope>,
    /// Of path-steps, without the rows that the pilot makes.
    pub beyond_pilot: Option<Slope>,
    /// Of processor seconds, without the same rows.
    pub beyond_pilot_s: Option<Slope>,
    /// Why there are no further rows, where some are left out.
    pub stopped: Option<String>,
    /// What was decided in the last row, in words.
    pub decisions: Vec<String>,
}

/// One expectation and its cost.
#[derive(Serialize)]
pub struct Cost {
    /// The requested half-width ε.
    pub accuracy: f64,
    /// The estimate.
    pub estimate: f64,
    /// The half-width of its interval.
    pub half_width: f64,
    /// The estimate minus the exact value.
    pub error: f64,
    /// Whether the accuracy was reached and nothing contradicts the interval.
    pub reached: bool,
    /// Path-steps, pilots included.
    pub path_steps: u64,
    /// Steps on [0, T] of the finest level.
    pub finest_steps: u64,
    /// Wall time.
    pub wall_s: f64,
    /// Processor time.
    pub processor_s: f64,
}

/// A fitted slope with its 95 % interval.
#[derive(Clone, Copy, Serialize)]
pub struct Slope {
    /// The slope.
    pub value: f64,
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

impl Slope {
    /// A slope with the half-width of its interval.
    pub fn within(value: f64, half_width: f64) -> Self {
        Self { value, lo: value - half_width, hi: value + half_width }
    }

    /// Half of the interval.
    pub fn half_width(self) -> f64 {
        0.5 * (self.hi - self.lo)
    }
}

/// Several expectations of one run.
#[derive(Serialize)]
pub struct Twelve {
    /// The requested half-width of each.
    pub accuracy: f64,
    /// Path-steps of all of them.
    pub path_steps: u64,
    /// Wall time of all of them.
    pub wall_s: f64,
    /// Processor time of all of them.
    pub processor_s: f64,
    /// Each of them.
    pub estimates: Vec<Known>,
}

/// An expectation beside its exact value.
#[derive(Serialize)]
pub struct Known {
    /// Name of φ.
    pub name: String,
    /// The estimate.
    pub estimate: f64,
    /// The half-width of its interval.
    pub half_width: f64,
    /// The exact value.
    pub exact: f64,
}

/// E[φ(y_N)] − E[φ(y(T))] of schemes.
#[derive(Serialize)]
pub struct Bias {
    /// Independent scrambles.
    pub scrambles: u64,
    /// The schemes.
    pub schemes: Vec<SchemeBias>,
}

/// The bias of a scheme.
#[derive(Serialize)]
pub struct SchemeBias {
    /// What it is called.
    pub scheme: &'static str,
    /// For each test function.
    pub functions: Vec<FunctionBias>,
}

/// The bias of a scheme for a test function.
#[derive(Serialize)]
pub struct FunctionBias {
    /// Name of φ.
    pub name: String,
    /// By number of steps.
    pub points: Vec<BiasPoint>,
}

/// A bias at a number of steps; also against twice as many, see [`ProblemOrders`].
#[derive(Clone, Copy, Serialize)]
pub struct BiasPoint {
    /// Steps on [0, T].
    pub steps: u64,
    /// Points of each scramble.
    pub points: u64,
    /// E[φ(y_N)] − E[φ(y(T))].
    pub bias: f64,
    /// The half-width of its 95 % interval.
    pub half_width: f64,
    /// Paths without a solution, which are left out.
    pub failed: u64,
}

/// Weak orders.
#[derive(Serialize)]
pub struct Orders {
    /// Independent scrambles.
    pub scrambles: u64,
    /// The problems.
    pub problems: Vec<ProblemOrders>,
}

/// Weak orders on a problem.
#[derive(Serialize)]
pub struct ProblemOrders {
    /// The name of its system.
    pub problem: &'static str,
    /// T.
    pub t_end: f64,
    /// Whether biases are against exact values. Otherwise they are against twice as many steps.
    pub exact: bool,
    /// The schemes.
    pub schemes: Vec<SchemeOrders>,
}

/// Weak orders of a scheme.
#[derive(Serialize)]
pub struct SchemeOrders {
    /// What it is called.
    pub scheme: &'static str,
    /// Whether it is a twin, of order one.
    pub twin: bool,
    /// Whether the next term of the error is two powers of τ above the first. Otherwise it is one.
    pub even: bool,
    /// The largest relative defect of a Casimir on any path at any time kT/n.
    pub defect: f64,
    /// For each test function.
    pub functions: Vec<FunctionOrder>,
}

/// The weak order for a test function.
#[derive(Serialize)]
pub struct FunctionOrder {
    /// Name of φ.
    pub name: String,
    /// At n, 2n and 4n steps.
    pub points: Vec<BiasPoint>,
    /// The order p₁ between the first two; none where a bias is smaller than its half-width, or
    /// biases differ in sign.
    pub coarse: Option<Slope>,
    /// The order p₂ between the last two.
    pub fine: Option<Slope>,
    /// (4p₂ − p₁)/3 if the next term is two powers of τ above the first, else 2p₂ − p₁.
    pub order: Option<Slope>,
}
