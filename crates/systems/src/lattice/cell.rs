//! Unit cells, and pairs of sites by their distance.

/// A unit cell: its vectors a₁, a₂, a₃ in units of the lattice constant, and its sites.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Name of the lattice.
    pub name: String,
    /// The vectors a₁, a₂, a₃.
    pub vectors: [[f64; 3]; 3],
    /// Fractions of these vectors for each site.
    pub sites: Vec<[f64; 3]>,
}

/// A pair of neighbouring sites: one in a cell, and one in the cell that is `cells` further.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Site of the first cell.
    pub from: usize,
    /// Site of the other cell.
    pub to: usize,
    /// The other cell, counted from the first.
    pub cells: [isize; 3],
    /// The way from the first to the other site.
    pub way: [f64; 3],
}

/// Names of the [lattices](Cell::named).
pub const LATTICES: [&str; 9] =
    ["cubic", "bcc", "fcc", "diamond", "triangular", "hexagonal", "honeycomb", "kagome", "hcp"];

/// Cells up to this distance have the neighbours of the first two shells.
const REACH: isize = 2;
/// Relative difference of distances that are equal.
const EQUAL: f64 = 1e-9;

impl Cell {
    /// A lattice by one of the names of [`LATTICES`]. Cubic cells are conventional ones: bcc has 2
    /// sites, fcc 4, diamond 8. a₁ and a₂ of the others make 60°; `triangular` and `hexagonal` have
    /// one site, `honeycomb` 2, `kagome` 3 and `hcp` 2.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let (origin, third) = ([0.0; 3], 1.0 / 3.0);
        let fcc = [origin, [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]];
        let (oblique, sites) = match name {
            "cubic" => (false, vec![origin]),
            "bcc" => (false, vec![origin, [0.5; 3]]),
            "fcc" => (false, fcc.into()),
            "diamond" => {
                let shifted = fcc.map(|site| site.map(|fraction| fraction + 0.25));
                (false, [fcc, shifted].concat())
            }
            "triangular" | "hexagonal" => (true, vec![origin]),
            "honeycomb" => (true, vec![origin, [third, third, 0.0]]),
            "kagome" => (true, vec![origin, [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]]),
            "hcp" => (true, vec![origin, [third, third, 0.5]]),
            _ => return None,
        };
        let height = if name == "hcp" { (8.0f64 / 3.0).sqrt() } else { 1.0 };
        let second = if oblique { [0.5, 0.75f64.sqrt(), 0.0] } else { [0.0, 1.0, 0.0] };
        let vectors = [[1.0, 0.0, 0.0], second, [0.0, 0.0, height]];
        Some(Self { name: name.into(), vectors, sites })
    }

    /// The place of a site in a cell.
    #[must_use]
    pub fn place(&self, site: usize, cell: [f64; 3]) -> [f64; 3] {
        let along = |a: usize| cell[a] + self.sites[site][a];
        [0, 1, 2].map(|c| (0..3).map(|a| along(a) * self.vectors[a][c]).sum())
    }

    /// The pairs of a shell, each once: number 0 has the nearest neighbours, 1 the next-nearest.
    /// Cells have neighbours along the first `axes` axes.
    #[must_use]
    pub fn pairs(&self, axes: usize, shell: usize) -> Vec<Pair> {
        let far = |axis: usize| if axis < axes { -REACH..=REACH } else { 0..=0 };
        let cells = far(2).flat_map(|z| far(1).flat_map(move |y| far(0).map(move |x| [x, y, z])));
        let mut pairs = Vec::new();
        for cells @ [x, y, z] in cells {
            for from in 0..self.sites.len() {
                for to in (0..self.sites.len()).filter(|&to| (z, y, x, to) > (0, 0, 0, from)) {
                    let end = self.place(to, cells.map(|cells| cells as f64));
                    let begin = self.place(from, [0.0; 3]);
                    let way = [0, 1, 2].map(|c| end[c] - begin[c]);
                    pairs.push(Pair { from, to, cells, way });
                }
            }
        }
        let square = |pair: &Pair| pair.way.iter().map(|r| r * r).sum::<f64>();
        let mut least = 0.0;
        for _ in 0..=shell {
            let farther = pairs.iter().map(square).filter(|of| *of > least * (1.0 + EQUAL));
            least = farther.fold(f64::INFINITY, f64::min);
        }
        pairs.retain(|pair| (square(pair) - least).abs() <= least * EQUAL);
        pairs
    }
}
