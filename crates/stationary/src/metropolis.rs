//! Steps that leave e^{−βH₀} exactly stationary.

use std::array::from_fn;

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, Rows, WIDTH, elementary::exp, golden};
use schemes::{About, Method, Step, Stepper};
use systems::run_time::{Move, Program, System, Weights, palindrome};

use mc::{Friction, Problem};

/// A sampler of e^{−βH₀} on the leaves of B for a system in a heat bath: no step size has a bias.
///
/// A step of size τ has three parts, each of which leaves the law alone:
///
/// 1. Momenta with friction γ and noise take an Ornstein–Uhlenbeck step, which is exact.
/// 2. Other noises move the state by the flow of Φₘ for the time ΔWₘ, m = 1, …, M, …, 1 with half
///    of it but for the last. Times of both signs are equally likely and flows keep volume, so that
///    Metropolis' rule accepts with min(1, e^{−βΔH₀}).
/// 3. The flows of the parts of H₀ move the state in the order of
///    [`Split`](schemes::Split) for the time sτ (a quarter of it in every eighth step, where chains
///    may be that a long step leaves nowhere), accepted with min(1, e^{−βΔH₀}). The direction s
///    is ±1 and turns at a rejection. For H₀ = T(p) + V(q) this is generalised hybrid Monte Carlo
///    (Horowitz, *Phys. Lett. B* 268, 1991), where momenta turn; a direction of time turns on any
///    Poisson manifold.
///
/// No move crosses a wall on which H₀ is infinite, as no path does: a divisor or an argument of a
/// logarithm of H₀ that changes its sign on the straight way, while H₀ grows beyond limits.
///
/// A move is accepted where βΔH₀ < (a² + b²)/2 with normals a and b, which is exponential. So a
/// step takes four more increments than the system has noises.
pub struct Metropolis<'a> {
    /// The system whose noises have the Hamiltonians H₀, H₁, ….
    flows: &'a dyn System,
    /// The inverse temperature β.
    pub(super) beta: f64,
    momenta: Vec<Momentum>,
    /// The noises that move the state by flows.
    walks: Vec<usize>,
}

/// A momentum with friction and noise.
struct Momentum {
    component: usize,
    /// The friction γ.
    rate: f64,
    /// The noise that moves it, counted from 0.
    noise: usize,
    /// The variance at equilibrium.
    variance: f64,
}

/// Rows after the state: the direction, numbers of moves that were accepted, by H₀ and by noises,
/// and last H₀.
pub const MORE: usize = 4;
/// Increments for the acceptance of both moves.
const DRAWN: usize = 4;
/// Relative difference that counts as rounding.
const ROUNDING: f64 = 1e-9;

impl<'a> Metropolis<'a> {
    /// The sampler of a problem with constant friction whose stationary law is e^{−βH₀}. The noises
    /// of `flows` have the Hamiltonians H₀, H₁, … of its system.
    ///
    /// # Errors
    /// The reason why there is none, in words: a part without a flow, or friction on what is not a
    /// momentum with noise of its own.
    pub fn new(problem: &Problem<'_>, flows: &'a dyn System, beta: f64) -> Result<Self, String> {
        flows.description().parts.as_ref().map_err(Clone::clone)?;
        if flows.rest().is_some() {
            return Err("a part of H0 or of a noise has no exact flow".into());
        }
        if !problem.in_time.is_empty() || problem.damping.rate(0.0) != 0.0 {
            return Err("it changes with time, or all components are damped".into());
        }
        let d = problem.y0.len();
        let rates = Friction::rates(problem.friction, 0.0, d);
        let points = [problem.y0.clone(), problem.y0.iter().map(|y| 1.3 * y + 0.2).collect()];
        let at = points.each_ref().map(|y| (problem.coefficients)(0.0, y));
        let mut walks: Vec<usize> = (0..problem.noises).collect();
        let mut momenta = Vec::new();
        for component in (0..d).filter(|&i| rates[i] != 0.0) {
            let moves = |m: &usize| at.iter().any(|at| at.noises[*m][component] != 0.0);
            let alone = |m: usize| {
                let first = &at[0].noises[m];
                let only = (0..d).all(|i| i == component || first[i] == 0.0);
                only && at.iter().all(|at| at.noises[m] == *first)
            };
            let own: Vec<usize> = walks.iter().copied().filter(moves).collect();
            if own.is_empty() || !own.iter().all(|&m| alone(m)) {
                return Err("friction acts on what has no noise of its own".into());
            }
            let square: f64 = own.iter().map(|&m| at[0].noises[m][component].powi(2)).sum();
            let variance = square / (2.0 * rates[component]);
            walks.retain(|m| !own.contains(m));
            momenta.push(Momentum { component, rate: rates[component], noise: own[0], variance });
        }
        let new = Self { flows, beta, momenta, walks };
        if !new.momenta.iter().all(|one| points.iter().all(|y| new.is_gaussian(one, y))) {
            return Err("H0 is not quadratic in a momentum with friction".into());
        }
        Ok(new)
    }

    /// Number of increments of a step.
    pub fn noises(&self) -> usize {
        self.flows.description().noises - 1 + DRAWN
    }

    /// Whether βH₀ = p²/2v + … with the variance v of a momentum.
    fn is_gaussian(&self, one: &Momentum, y: &[f64]) -> bool {
        let mut rows = Rows::splat(y);
        for p in 0..WIDTH {
            rows[one.component][p] = (p as f64 - 15.5) * 0.2 * one.variance.sqrt();
        }
        let mut energy = Energy::of(self.flows);
        let values = energy.values(&rows);
        (0..WIDTH).all(|p| {
            let [x, last] = [p, WIDTH - 1].map(|p| rows[one.component][p]);
            let own = (x * x - last * last) / (2.0 * one.variance);
            let all = self.beta * (values[p] - values[WIDTH - 1]);
            let size = own.abs() + self.beta * (values[p].abs() + values[WIDTH - 1].abs());
            (own - all).abs() <= ROUNDING * size
        })
    }

    /// The palindrome of flows of Hamiltonian number `only`, for a share of its time.
    fn flows_of(&self, only: usize, share: f64) -> impl Iterator<Item = Move> {
        let parts = self.flows.description().parts.as_ref().map_or(1, |parts| parts.number);
        palindrome(parts, [0.0, share, 0.0], Some(only))
    }

    fn program(&self, moves: impl Iterator<Item = Move>) -> Box<dyn Program> {
        let moves: Vec<Move> = moves.collect();
        self.flows.compose(&moves).expect("a system of formulas composes its flows")
    }
}

impl Method for Metropolis<'_> {
    fn about(&self) -> About {
        About::new("metropolis")
    }

    /// Starts from a state, or one with the rows after it.
    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        let description = self.flows.description();
        let d = description.dimension;
        let mut rows = y.to_vec();
        if rows.len() == d {
            rows.extend([[0.0; WIDTH]; MORE]);
            rows[d] = [1.0; WIDTH];
            // Not known before the first step.
            rows[d + MORE - 1] = [f64::NAN; WIDTH];
        }
        let of_noise = (!self.walks.is_empty()).then(|| {
            let last = self.walks.len() - 1;
            let palindrome = (0..=last).chain((0..last).rev());
            let share = |k: usize| if k < last { 0.5 } else { 1.0 };
            self.program(palindrome.flat_map(|k| self.flows_of(self.walks[k] + 1, share(k))))
        });
        Box::new(Walk {
            of: self,
            d,
            rows,
            of_energy: self.program(self.flows_of(0, 1.0)),
            of_noise,
            next: Rows::zero(d),
            times: Rows::zero(description.noises),
            energy: Energy::of(self.flows),
            tau: f64::NAN,
            factors: vec![(0.0, 0.0); self.momenta.len()],
        })
    }
}

/// H₀ of the system of flows.
struct Energy<'a> {
    flows: &'a dyn System,
    weights: Rows,
    scratch: Rows,
}

impl<'a> Energy<'a> {
    fn of(flows: &'a dyn System) -> Self {
        let description = flows.description();
        let mut weights = Rows::zero(description.noises);
        weights[0] = [1.0; WIDTH];
        Self { flows, weights, scratch: Rows::zero(description.scratch_rows()) }
    }

    fn values(&mut self, y: &[Row]) -> Row {
        let mut values = [0.0; WIDTH];
        let h = Weights { dw: &self.weights, ..Weights::NONE };
        self.flows.energy(y, h, &mut values, &mut self.scratch);
        values
    }
}

/// Halvings of the way to a wall, of which the last half tell whether H₀ has a limit there; the
/// least growth of βH₀ in these if it has none.
const HALVINGS: usize = 24;
const GROWS: f64 = 1e-3;

impl Energy<'_> {
    /// Sums of the energies on both sides of a wall, of which at least one comes nearer.
    fn both(&mut self, near: &[Row], far: &[Row]) -> Row {
        let (near, far) = (self.values(near), self.values(far));
        from_fn(|p| near[p] + far[p])
    }

    /// Makes energies infinite of states that H₀ = ∞ parts from those before.
    fn bar(&mut self, y: &[Row], next: &[Row], energies: &mut Row, beta: f64) {
        let walls = self.flows.walls(y);
        let others = if walls.is_empty() { Vec::new() } else { self.flows.walls(next) };
        let is_between = |k: usize, a: &Row, p: usize| (a[p] < 0.0) != (walls[k][p] < 0.0);
        for (k, other) in others.iter().enumerate() {
            if !(0..WIDTH).any(|p| is_between(k, other, p)) {
                continue;
            }
            let (mut near, mut far, mut middle) = (y.to_vec(), next.to_vec(), y.to_vec());
            let mut half_way = [0.0; WIDTH];
            for halvings in 0..HALVINGS {
                for ((middle, near), far) in middle.iter_mut().zip(&near).zip(&far) {
                    *middle = from_fn(|p| 0.5 * (near[p] + far[p]));
                }
                let at = &self.flows.walls(&middle)[k];
                for ((middle, near), far) in middle.iter().zip(&mut near).zip(&mut far) {
                    for p in 0..WIDTH {
                        match is_between(k, at, p) {
                            true => far[p] = middle[p],
                            false => near[p] = middle[p],
                        }
                    }
                }
                if halvings == HALVINGS / 2 {
                    half_way = self.both(&near, &far);
                }
            }
            let end = self.both(&near, &far);
            for p in (0..WIDTH).filter(|&p| is_between(k, other, p)) {
                let has_limit = beta * (end[p] - half_way[p]) <= GROWS;
                energies[p] = if has_limit { energies[p] } else { f64::INFINITY };
            }
        }
    }
}

/// 32 chains.
struct Walk<'a> {
    of: &'a Metropolis<'a>,
    d: usize,
    /// The state, the direction and the numbers of accepted moves.
    rows: Vec<Row>,
    of_energy: Box<dyn Program>,
    of_noise: Option<Box<dyn Program>>,
    next: Rows,
    /// Times of the flows.
    times: Rows,
    energy: Energy<'a>,
    /// The step size, and factors of momenta and of their increments for it.
    tau: f64,
    factors: Vec<(f64, f64)>,
}

/// Times of flows of H₀ differ by this part of τ at most, so that no motion resonates and rounding
/// of turns has no direction.
const SPREAD: f64 = 0.1;

/// The part of τ for which the flows of H₀ go in this step: about one, a quarter in every 8th step,
/// a sixteenth in every 64th, so that chains move also where H₀ is steeper than usual.
fn share(number: u64) -> f64 {
    let usual = 1.0 + SPREAD * (2.0 * golden(number as f64) - 1.0);
    match (number + 1) % 64 {
        0 => usual / 16.0,
        n if n.is_multiple_of(8) => usual / 4.0,
        _ => usual,
    }
}

real::kernel! {
    /// p′ = decay·p + scale·ΔW.
    fn mix(p: &'a mut Row, dw: &'a Row, decay: f64, scale: f64) {
        for (p, dw) in p.iter_mut().zip(dw) {
            *p = decay * *p + scale * dw;
        }
    }
}

real::kernel! {
    /// Takes the next state, of energies `after`, where β times the change of energies is less than
    /// (a² + b²)/2τ, and writes 1 into `taken` there; not where energies are not finite. `drawn`
    /// has the increments a and b.
    fn decide(
        y: &'a mut [Row],
        next: &'a [Row],
        energies: &'a mut [Row; 2],
        drawn: &'a [Row],
        taken: &'a mut Row,
        beta: f64,
        tau: f64
    ) {
        let [before, after] = energies;
        let scale = 0.5 / tau;
        for p in 0..WIDTH {
            let [a, b] = [drawn[0][p], drawn[1][p]];
            let accepts = beta * (after[p] - before[p]) <= scale * (a * a + b * b);
            taken[p] = if accepts { 1.0 } else { 0.0 };
            before[p] = if accepts { after[p] } else { before[p] };
        }
        for (y, next) in y.iter_mut().zip(next) {
            for p in 0..WIDTH {
                y[p] = if taken[p] == 1.0 { next[p] } else { y[p] };
            }
        }
    }
}

impl Stepper for Walk<'_> {
    fn state(&self) -> &[Row] {
        &self.rows
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.rows
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        *status = BlockStatus::explicit();
        let Self { of, d, rows, of_energy, of_noise, next, times, energy, tau, factors } = self;
        if step.tau != *tau {
            *tau = step.tau;
            for (factors, one) in factors.iter_mut().zip(&of.momenta) {
                let decay = exp(-one.rate * *tau);
                *factors = (decay, (one.variance * (1.0 - decay * decay) / *tau).sqrt());
            }
        }
        let (dw, drawn) = noise.increments.split_at(noise.increments.len() - DRAWN);
        for (one, (decay, scale)) in of.momenta.iter().zip(factors) {
            mix(&mut rows[one.component], &dw[one.noise], *decay, *scale);
        }
        let (y, more) = rows.split_at_mut(*d);
        let mut energies = [energy.values(y), [0.0; WIDTH]];
        let mut propose = |flows: &mut dyn Program, times: &[Row], drawn: &[Row]| {
            let mut taken = [0.0; WIDTH];
            flows.run(&[y], &[1.0; 2], Weights { dw: times, ..Weights::NONE }, next);
            energies[1] = energy.values(next);
            energy.bar(y, next, &mut energies[1], of.beta);
            decide(y, next, &mut energies, drawn, &mut taken, of.beta, *tau);
            taken
        };
        if let Some(of_noise) = of_noise {
            times[0] = [0.0; WIDTH];
            of.walks.iter().for_each(|&m| times[m + 1] = dw[m]);
            let taken = propose(of_noise.as_mut(), times, &drawn[2..]);
            more[2].iter_mut().zip(&taken).for_each(|(sum, taken)| *sum += taken);
        }
        times.fill([0.0; WIDTH]);
        let flow = share(step.number()) * step.tau;
        times[0] = more[0].map(|direction| direction * flow);
        let taken = propose(of_energy.as_mut(), times, &drawn[..2]);
        for p in 0..WIDTH {
            more[0][p] *= 2.0 * taken[p] - 1.0;
            more[1][p] += taken[p];
        }
        more[3] = energies[0];
        // Nothing moves a chain where H₀ is no number.
        status.fail_where_not_finite(&energies[..1]);
    }
}
