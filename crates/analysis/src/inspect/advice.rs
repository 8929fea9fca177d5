//! Whether `sexp-li` and `nv` are for a system, and which methods are worth writing out.

use real::Degree;
use schemes::{Nv, Scheme, SexpLi};
use serde::{Serialize, Serializer};
use systems::{ImplicitStep, Linearity, PoissonSystem, is_quadratic, linearity};

/// What [`SexpLi`] and [`Nv`] say of a system.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WithoutIteration {
    /// How B depends on y.
    #[serde(serialize_with = "as_word")]
    pub structure: Linearity,
    /// Why `sexp-li` refuses the system, if it does.
    pub refused: Option<String>,
    /// Whether it truncates increments, since a step may have no solution.
    pub truncates: bool,
    /// Why `sexp-li-levy` refuses the system, if it does.
    pub areas_refused: Option<String>,
    /// Why `nv` refuses the system, unless it is given flows of its parts.
    pub nv_refused: Option<String>,
    /// Whether Lévy areas are drawn for the system: not where its noises are counted at run time.
    pub draws_areas: bool,
}

impl WithoutIteration {
    /// That of a system, found around y.
    pub(super) fn of<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        system: &S,
        y: [f64; D],
    ) -> Self {
        let scheme = SexpLi::new(system, y);
        let truncates = scheme.as_ref().is_ok_and(<SexpLi as Scheme<S, D, M>>::clips_increments);
        Self {
            structure: linearity(system, y),
            refused: scheme.err().map(|refused| refused.to_string()),
            truncates,
            areas_refused: SexpLi::with_areas(system, y).err().map(|refused| refused.to_string()),
            nv_refused: Nv::new(system, y).err().map(|refused| refused.to_string()),
            draws_areas: true,
        }
    }
}

/// `constant`, `affine` or `other`.
pub(super) fn word(structure: Linearity) -> &'static str {
    match structure {
        Linearity::Constant => "constant",
        Linearity::Affine => "affine",
        Linearity::Other => "other",
    }
}

fn as_word<S: Serializer>(structure: &Linearity, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(word(*structure))
}

/// A method of `PoissonSystem` that is worth writing out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Override {
    /// Its name.
    pub method: &'static str,
    /// The schemes that use it, in words.
    pub schemes: &'static str,
    /// What it gains.
    pub gains: String,
}

/// A system of nothing but its two formulas.
struct TwoFormulas<'a, S>(&'a S);

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> PoissonSystem<D, M>
    for TwoFormulas<'_, S>
{
    fn name(&self) -> &'static str {
        self.0.name()
    }
    fn structure<R: real::Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        self.0.structure(y, v)
    }
    fn energy<R: real::Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R {
        self.0.energy(y, dt, dw)
    }
}

/// Nodes of the provided ∇̄h, and the most that are advised.
const PROVIDED_NODES: u32 = 8;
const MOST_NODES: u32 = 32;

impl Override {
    /// Those of a system. A method is the provided one if its results have the same bits.
    pub(super) fn worthwhile<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        system: &S,
        points: &[Vec<f64>],
    ) -> Vec<Self> {
        let plain = TwoFormulas(system);
        let array = |y: &Vec<f64>| -> [f64; D] { std::array::from_fn(|i| y[i]) };
        // Areas and increments of no special ratio.
        let areas: [[f64; M]; M] = std::array::from_fn(|m| {
            std::array::from_fn(|l| (m as f64 - l as f64) * (1.0 + 0.37 * (m * l) as f64))
        });
        let (dt, dw) = (0.3, std::array::from_fn(|m| 0.7 - 0.2 * m as f64));
        let same = |ours: &dyn Fn([f64; D], [f64; D]) -> [[f64; D]; 2]| {
            points.windows(2).take(4).all(|pair| {
                let [one, other] = ours(array(&pair[0]), array(&pair[1]));
                one.map(f64::to_bits) == other.map(f64::to_bits)
            })
        };
        let mut found = Vec::new();
        let mut worth = |method, schemes, gains| found.push(Self { method, schemes, gains });
        let quadratic = is_quadratic(system, dt, dw);
        let averages =
            |a, b| [system.averaged_gradient(a, b, dt, dw), plain.averaged_gradient(a, b, dt, dw)];
        let degree = system.energy([Degree::VARIABLE; D], dt, dw);
        let exact = (1..=MOST_NODES).find(|&n| degree <= Degree::of(2 * n));
        if !quadratic && exact != Some(PROVIDED_NODES) && same(&averages) {
            let gains = match exact {
                Some(1) => "∇̄h takes 8 evaluations of ∇h, of which one is enough".into(),
                Some(n) if n < PROVIDED_NODES => format!(
                    "∇̄h takes 8 evaluations of ∇h; dgrad::averaged::<{n}, _, _, {D}> is exact with \
                     {n}"
                ),
                Some(n) => {
                    format!("8 nodes are not exact; dgrad::averaged::<{n}, _, _, {D}> is")
                }
                None => "∇̄h takes 8 evaluations of ∇h and is as exact as the line ∇̄h says; sines \
                         and cosines of one coordinate have closed forms, dgrad::mean_cosine and \
                         dgrad::mean_sine; for other functions keep the 8 nodes"
                    .into(),
            };
            worth("averaged_gradient", "sexp, sexp-levy and sexp-li", gains);
        }
        let gradients = |a, _| [system.gradient(a, dt, dw), plain.gradient(a, dt, dw)];
        if D > 8 && same(&gradients) {
            worth(
                "gradient",
                "all schemes",
                format!("∇h takes {D} evaluations of h on dual numbers; by hand about one"),
            );
        }
        let steps = |y, v| [system.cayley(y, v), plain.cayley(y, v)];
        let affine = linearity(system, array(&points[0])) == Linearity::Affine;
        if affine && D > 3 && same(&steps) {
            let gains = "a closed form, where B is made of cross products, halves a step";
            worth("cayley", "sexp-li", gains.into());
        }
        let commutators = |a, _| [system.commutators(a, areas), plain.commutators(a, areas)];
        let silent = commutators(array(&points[0]), [0.0; D])[0].iter().all(|x| *x == 0.0);
        if M > 1 && !silent && same(&commutators) {
            worth("commutators", "sexp-levy", "by hand, a step costs about a third less".into());
        }
        if quadratic && D <= 3 && S::IMPLICIT_STEP == ImplicitStep::FixedPoint {
            worth(
                "IMPLICIT_STEP",
                "sexp and midpoint",
                "UnrolledFixedPoint makes steps about a third faster".into(),
            );
        }
        found
    }
}
