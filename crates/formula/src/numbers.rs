//! Expressions evaluated on any numbers: dual numbers, or numbers that bound their rounding errors.

use real::Real;

use crate::graph::{Binary, Graph, Id, Node, Unary};

impl Graph {
    /// The values of `roots` on numbers of type R, with a number for each input. Slow: for checks.
    /// The functions tan, sinh, cosh and tanh are made of sine, cosine and exponentials here, and
    /// may differ from those of a tape in their last bits.
    #[must_use]
    pub fn evaluate<R: Real>(&self, roots: &[Id], inputs: &[R]) -> Vec<R> {
        let needed = self.needed(roots);
        let mut values = vec![R::zero(); self.len()];
        for id in self.ids().filter(|id| needed[id.index()]) {
            let of = |id: Id| values[id.index()];
            values[id.index()] = match self.node(id) {
                Node::Constant(bits) => R::constant(f64::from_bits(bits)),
                Node::Input(k) => inputs[k as usize],
                Node::Unary(function, a) => unary(function, of(a)),
                Node::Binary(function, a, b) => binary(function, of(a), of(b)),
                Node::Power(a, n) => of(a).powi(n as i32),
                Node::Where([x, y, a, b]) => R::where_less(of(x), of(y), of(a), of(b)),
            };
        }
        roots.iter().map(|root| values[root.index()]).collect()
    }
}

fn unary<R: Real>(function: Unary, x: R) -> R {
    let halves = |x: R| (x.exp() * 0.5, (-x).exp() * 0.5);
    match function {
        Unary::Neg => -x,
        Unary::Abs => R::where_less(x, R::zero(), -x, x),
        Unary::Sqrt => x.sqrt(),
        Unary::Exp => x.exp(),
        Unary::Ln => x.ln(),
        Unary::Sin => x.sin(),
        Unary::Cos => x.cos(),
        Unary::Tan => {
            let (sin, cos) = x.sin_cos();
            sin / cos
        }
        Unary::Sinh => {
            let (up, down) = halves(x);
            up - down
        }
        Unary::Cosh => {
            let (up, down) = halves(x);
            up + down
        }
        Unary::Tanh => {
            let (up, down) = halves(x);
            (up - down) / (up + down)
        }
        Unary::Sinc => x.sinc(),
    }
}

fn binary<R: Real>(function: Binary, a: R, b: R) -> R {
    match function {
        Binary::Add => a + b,
        Binary::Sub => a - b,
        Binary::Mul => a * b,
        Binary::Div => a / b,
        Binary::Min => R::where_less(a, b, a, b),
        Binary::Max => R::where_less(a, b, b, a),
    }
}
