//! Systems as their users write them: B(y)v and h in Rust, and as texts.

use formula::Definition;
use real::Real;
use systems::PoissonSystem;

/// A system from its name, type, dimension and number of noises, B(y)v and h.
macro_rules! system {
    ($system:ident, $name:literal, $d:literal, $m:literal,
     |$y:ident, $v:ident| $structure:expr, |$x:ident, $dt:ident, $dw:ident| $energy:expr) => {
        #[doc = $name]
        #[derive(Clone, Copy)]
        pub struct $system;

        impl PoissonSystem<$d, $m> for $system {
            fn name(&self) -> &'static str {
                $name
            }
            #[inline(always)]
            fn structure<R: Real>(&self, $y: [R; $d], $v: [R; $d]) -> [R; $d] {
                $structure
            }
            #[inline(always)]
            fn energy<R: Real>(&self, $x: [R; $d], $dt: f64, $dw: [f64; $m]) -> R {
                $energy
            }
        }
    };
}

#[inline(always)]
fn square<R: Real>(x: R) -> R {
    x * x
}

#[inline(always)]
fn cross<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn halves<R: Real>([a, b, c, d, e, f]: [R; 6]) -> [[R; 3]; 2] {
    [[a, b, c], [d, e, f]]
}

#[inline(always)]
fn joined<R: Real>([a, b, c]: [R; 3], [d, e, f]: [R; 3]) -> [R; 6] {
    [a, b, c, d, e, f]
}

fn definition(state: &str, rows: &[&str], energy: &str, noises: &[&str]) -> Definition {
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    Definition {
        name: energy.into(),
        state: words(state),
        structure: rows.iter().map(|row| words(row)).collect::<Vec<_>>().into(),
        energy: energy.into(),
        noises: noises.iter().map(|&noise| noise.to_owned()).collect(),
        ..Definition::default()
    }
}

system!(
    Species,
    "three species",
    3,
    1,
    |y, v| {
        let [a, b, c] = [y[0] * y[1], y[0] * y[2] * 0.5, y[1] * y[2] * -0.7];
        [a * v[1] + b * v[2], c * v[2] - a * v[0], -(b * v[0] + c * v[1])]
    },
    |y, dt, dw| {
        let [x, y, z] = y;
        let one = y - y.ln();
        ((x - x.ln()) * 2.0 + one + (z - z.ln()) * 3.0) * dt + y.ln() * (0.3 * dw[0])
    }
);

pub fn species() -> Definition {
    let energy = "2*(x - ln(x)) + y - ln(y) + 3*(z - ln(z))";
    definition("x y z", &["x*y 0.5*x*z", "-0.7*y*z"], energy, &["0.3*ln(y)"])
}

system!(Well, "double well", 2, 1, |_y, v| [v[1], -v[0]], |y, dt, dw| {
    let [q, p] = y;
    (square(p) * 0.5 + square(square(q) - 1.0) * 0.25) * dt + q * (0.28 * dw[0])
});

pub fn well() -> Definition {
    definition("q p", &["1"], "p^2/2 + (q^2 - 1)^2/4", &["0.28*q"])
}

system!(Star, "Hénon–Heiles", 4, 2, |_y, v| [v[2], v[3], -v[0], -v[1]], |y, dt, dw| {
    let [q, r, u, v] = y;
    let springs = (square(q) + square(r)) * 0.5;
    let cubic = square(q) * r - square(r) * r * (1.0 / 3.0);
    let kinetic = (square(u) + square(v)) * 0.5;
    kinetic * dt + springs * (dt + 0.1 * dw[0]) + cubic * (dt + 0.2 * dw[1])
});

pub fn star() -> Definition {
    let (springs, cubic) = ("(q1^2 + q2^2)/2", "(q1^2*q2 - q2^3/3)");
    let energy = format!("(p1^2 + p2^2)/2 + {springs} + {cubic}");
    let noises = [format!("0.1*{springs}"), format!("0.2*{cubic}")];
    let noises = noises.each_ref().map(|noise| &noise[..]);
    definition("q1 q2 p1 p2", &["0 1 0", "0 1", "0"], &energy, &noises)
}

system!(
    Particle,
    "charged particle",
    4,
    2,
    |y, v| {
        let field = y[0] + 4.0;
        [v[2], v[3], field * v[3] - v[0], -(field * v[2]) - v[1]]
    },
    |y, dt, dw| {
        let squares = (square(y[0]) + square(y[1])) + (square(y[2]) + square(y[3]));
        squares * (0.5 * dt) - y[0] * (0.4 * dw[0]) - y[1] * (0.4 * dw[1])
    }
);

pub fn particle() -> Definition {
    let energy = "(u^2 + v^2)/2 + (x^2 + y^2)/2";
    definition("x y u v", &["0 1 0", "0 1", "4+x"], energy, &["-0.4*x", "-0.4*y"])
}

system!(
    TwoSpins,
    "two spins",
    6,
    2,
    |y, v| {
        let ([a, b], [u, v]) = (halves(y), halves(v));
        joined(cross(a, u), cross(b, v))
    },
    |y, dt, dw| {
        let [a, b] = halves(y);
        let product = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        -(product + a[2] * 0.2) * dt + a[0] * (0.3 * dw[0]) + b[2] * (0.3 * dw[1])
    }
);

pub fn two_spins() -> Definition {
    let rows = ["-z1 y1 0 0 0", "-x1 0 0 0", "0 0 0", "-z2 y2", "-x2"];
    let energy = "-(x1*x2 + y1*y2 + z1*z2) - 0.2*z1";
    definition("x1 y1 z1 x2 y2 z2", &rows, energy, &["0.3*x1", "0.3*z2"])
}

system!(
    HeavyTop,
    "heavy top",
    6,
    2,
    |y, v| {
        let ([m, g], [u, w]) = (halves(y), halves(v));
        let ([a, b, c], [d, e, f]) = (cross(m, u), cross(g, w));
        joined([a + d, b + e, c + f], cross(g, u))
    },
    |y, dt, dw| {
        let kinetic = square(y[0]) * 0.5 + square(y[1]) * 0.4 + square(y[2]) * 0.9;
        (kinetic + y[5]) * dt + y[0] * (0.5 * dw[0]) + y[5] * (0.7 * dw[1])
    }
);

pub fn heavy_top() -> Definition {
    let rows = ["-m3 m2 0 -g3 g2", "-m1 g3 0 -g1", "-g2 g1 0", "0 0", "0"];
    let energy = "m1^2/2 + 0.4*m2^2 + 0.9*m3^2 + g3";
    definition("m1 m2 m3 g1 g2 g3", &rows, energy, &["0.5*m1", "0.7*g3"])
}

system!(Chain, "Toda chain", 6, 1, |_y, v| [v[3], v[4], v[5], -v[0], -v[1], -v[2]], |y, dt, dw| {
    let kinetic = (square(y[3]) + square(y[4]) + square(y[5])) * 0.5;
    let springs = (y[0] - y[1]).exp() + (y[1] - y[2]).exp() + (y[2] - y[0]).exp();
    (kinetic + springs) * dt + y[0] * (0.2 * dw[0])
});

pub fn chain() -> Definition {
    let energy = "(p1^2 + p2^2 + p3^2)/2 + exp(q1 - q2) + exp(q2 - q3) + exp(q3 - q1)";
    let rows = ["0 0 1 0 0", "0 0 1 0", "0 0 1", "0 0", "0"];
    definition("q1 q2 q3 p1 p2 p3", &rows, energy, &["0.2*q1"])
}
