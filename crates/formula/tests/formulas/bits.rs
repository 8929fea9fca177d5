//! A row has the bits of its points one by one, whatever its neighbours are, at every level.

use formula::{Formula, Names};
use real::{Row, Simd, WIDTH, limit_to};

use crate::expression::{Expression, Random, VARIABLES, hessian};

/// The bits; all NaN are one.
fn bits(x: f64) -> u64 {
    if x.is_nan() { u64::MAX } else { x.to_bits() }
}

#[test]
fn a_row_is_its_points_at_every_level() {
    let names = Names::with_variables(&VARIABLES).unwrap();
    for &level in Simd::BUILT {
        limit_to(level);
        let mut random = Random::new(7);
        for n in 0..1_000 {
            let expression = Expression::random(&mut random, 1 + n % 6);
            let Ok(formula) = Formula::parse(&expression.text(), &names) else { continue };
            let tape = hessian(&formula);
            let mut rows =
                || -> [Row; 3] { [(); 3].map(|()| [(); WIDTH].map(|()| random.number())) };
            let (x, u) = (rows(), rows());
            let mut out = [[f64::NAN; WIDTH]; 3];
            let mut scratch = vec![[f64::NAN; WIDTH]; tape.scratch_rows()];
            tape.evaluate(&[&x, &u], &mut out, &mut scratch);
            for p in 0..WIDTH {
                let mut one = [0.0; 3];
                tape.evaluate_one(&[&x.map(|row| row[p]), &u.map(|row| row[p])], &mut one);
                let block = out.map(|row| bits(row[p]));
                assert_eq!(block, one.map(bits), "{level:?}: {}", expression.text());
            }
        }
    }
    limit_to(Simd::Avx512);
}
