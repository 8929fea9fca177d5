//! Functions on a sphere as pictures of maps.

use std::f64::consts::FRAC_PI_2;

use real::elementary::sin_cos;

use super::*;

/// A projection of the sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// Longitude and latitude as they are.
    Equirectangular,
    /// Mollweide's, in which areas are equal; blank outside of its ellipse.
    Mollweide,
}

impl Projection {
    /// Sines of the latitudes of the rows of a picture, from the south on.
    pub fn sines(self, rows: usize) -> Vec<f64> {
        let sines = (0..rows).map(|k| {
            let y = (2.0 * k as f64 + 1.0) / rows as f64 - 1.0;
            match self {
                Self::Equirectangular => sin_cos(FRAC_PI_2 * y).0,
                Self::Mollweide => {
                    // πsin(latitude) = 2θ + sin 2θ with sin θ = y, by Newton's method.
                    let (mut theta, root) = (y, (1.0 - y * y).sqrt());
                    for _ in 0..30 {
                        let (sine, cosine) = sin_cos(theta);
                        theta += (y - sine) / cosine.max(root);
                    }
                    (theta + y * root) / FRAC_PI_2
                }
            }
        });
        sines.collect()
    }

    /// A picture from values at even longitudes, row by row from the south.
    fn project(self, columns: usize, values: &[f64]) -> Vec<f64> {
        let rows = values.len() / columns;
        let pixels = (0..rows * columns).map(|at| {
            let [x, y] = [(at % columns, columns), (at / columns, rows)]
                .map(|(k, of)| (2.0 * k as f64 + 1.0) / of as f64 - 1.0);
            let part = match self {
                Self::Equirectangular => x,
                Self::Mollweide => x / (1.0 - y * y).sqrt(),
            };
            let column = (0.5 * (part + 1.0) * columns as f64).floor();
            if part.abs() < 1.0 { values[at / columns * columns + column as usize] } else { 0.0 }
        });
        pixels.collect()
    }
}

/// Maps of functions on a sphere as an SVG document, each with its name: values at even longitudes,
/// row by row at the latitudes of [`Projection::sines`].
pub fn maps(
    title: &str,
    projection: Projection,
    columns: usize,
    functions: &[(String, Vec<f64>)],
) -> String {
    let drawn = functions.iter().map(|(name, of)| (name.clone(), projection.project(columns, of)));
    strip(title, columns, &drawn.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of Mollweide's projection have areas of the sphere proportional to their own:
    /// 2√(1 − y²) of a width 2/rows, out of π.
    #[test]
    fn areas_are_equal() {
        let rows = 400;
        let sines = Projection::Mollweide.sines(rows);
        for k in 1..rows - 1 {
            let y = (2.0 * k as f64 + 1.0) / rows as f64 - 1.0;
            let share = 0.5 * (sines[k + 1] - sines[k - 1]) / 2.0;
            let own = 2.0 * (1.0 - y * y).sqrt() * (2.0 / rows as f64) / std::f64::consts::PI;
            assert!((share - own).abs() < 1e-5, "{k}: {share} {own}");
        }
        assert!(
            (Projection::Equirectangular.sines(3)[2] - (60f64).to_radians().sin()).abs() < 1e-15
        );
    }

    #[test]
    fn outside_of_the_ellipse_is_blank() {
        let found = Projection::Mollweide.project(8, &[1.0; 32]);
        // The outermost of the rows at ±¾, whose half is √7/4 wide.
        assert_eq!(found.iter().filter(|x| **x == 0.0).count(), 4);
        assert_eq!(Projection::Equirectangular.project(2, &[1.0, 2.0]), [1.0, 2.0]);
    }
}
