//! Real spherical harmonics.

/// Position of (l, m), |m| ≤ l, in a vector of all harmonics.
pub fn index(l: usize, m: i64) -> usize {
    ((l * (l + 1)) as i64 + m) as usize
}

/// √((l² − m²)/(4l² − 1)): u₃Y_{l−1,m} is this times Y_lm, plus a multiple of Y_{l−2,m}.
pub fn raising(l: usize, m: i64) -> f64 {
    let square = (l * l) as f64;
    ((square - (m * m) as f64) / (4.0 * square - 1.0)).sqrt()
}

/// h_lm(u) = (Re + Im)(iˡ Y_lm(u)) for l ≤ `degree` and |m| ≤ l, where Y_lm are the spherical
/// harmonics of mean square one with the Condon–Shortley phase. They are an orthonormal basis of
/// L²(S²).
///
/// Y_mm and then Y_lm for l > m by the recursions that u₁ + iu₂ and u₃ obey; Y_{l,−m} = (−1)ᵐ conj
/// Y_lm.
pub fn harmonics(u: [f64; 3], degree: usize) -> Vec<f64> {
    // (Re + Im)(iˡ(x + iy)).
    let rotated = |l: usize, x: f64, y: f64| match l % 4 {
        0 => x + y,
        1 => x - y,
        2 => -x - y,
        _ => y - x,
    };
    let mut h = vec![0.0; (degree + 1) * (degree + 1)];
    let (mut x, mut y) = (1.0, 0.0);
    for order in 0..=degree {
        let m = order as i64;
        let sign = if m % 2 == 0 { 1.0 } else { -1.0 };
        // Y_lm, and Y_{l−1,m} times raising(l, m).
        let (mut now, mut before) = ([x, y], [0.0; 2]);
        for l in order..=degree {
            h[index(l, m)] = rotated(l, now[0], now[1]);
            h[index(l, -m)] = sign * rotated(l, now[0], -now[1]);
            let a = raising(l + 1, m);
            let next = [0, 1].map(|i| (u[2] * now[i] - before[i]) / a);
            (now, before) = (next, now.map(|part| a * part));
        }
        let n = m as f64;
        let c = -((2.0 * n + 3.0) / (2.0 * n + 2.0)).sqrt();
        (x, y) = (c * (u[0] * x - u[1] * y), c * (u[0] * y + u[1] * x));
    }
    h
}
