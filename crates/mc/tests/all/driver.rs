//! What the driver shows to schemes and to statistics: raw and clipped increments, noise from
//! elsewhere, and how each step was solved.

use std::sync::{Arc, Mutex};

use mc::{LadderError, NextNoise, Run, Statistic, View, bind, parts::Stop};
use noise::{
    AreaSampler, NoiseError, StepNoise, Truncation, WienerPath, WienerRows, area_terms,
    strong_order_one_error,
};
use nonlin::BlockStatus;
use real::{PathMask, Row};
use schemes::{
    About, Explicit, Implicit, Increment, Method, Scheme, Sexp, SexpLevy, Step, Stepper,
};

use crate::{
    ladder::{KEY, Keep, body, ladder},
    statistical::judged::{Additive, additive},
};

/// Euler's method with Lévy areas, on clipped noise or on raw noise: an explicit scheme of a user.
pub struct Euler<const CLIPS: bool>;

impl<const CLIPS: bool> Explicit for Euler<CLIPS> {
    const ID: &'static str = "euler";
    const READS_AREAS: bool = true;
    const CLIPS_INCREMENTS: bool = CLIPS;

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        y + h.field(y) + h.commutators(y)
    }
}

/// ψ(ẑ, z) = ẑ + B(z)∇h(z): an implicit scheme of a user.
pub struct BackwardEuler;

impl Implicit for BackwardEuler {
    const ID: &'static str = "backward-euler";
    const EXACT_DAMPING: bool = true;

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        start + h.field(z)
    }
}

/// For every path the final W of each run, and whether an increment of the run was clipped.
struct Walks(Vec<[(f64, bool); 2]>);

impl Statistic for Walks {
    fn observe(&mut self, view: &View<'_>) {
        if view.time == 4 {
            let run = |r: usize, p| (view.state(r)[1][p], view.clipped[r].contains(p));
            self.0.extend(view.live.paths().map(|p| [run(0, p), run(1, p)]));
        }
    }
    fn merge(&mut self, later: Self) {
        self.0.extend(later.0);
    }
}

#[test]
fn raw_and_clipped_increments_side_by_side() {
    let problem = additive(1.0);
    let bound = Truncation::new(1).unwrap().bound(0.25).unwrap();
    let runs = vec![
        Run::new(bind(&problem, &Euler::<false>), 0),
        Run::new(bind(&problem, &Euler::<true>), 0),
    ];
    let ladder = ladder(&problem, (4, 0), 1, runs).unwrap();
    let measured = ladder.run(500, || Walks(Vec::new()));
    let mut beyond = 0;
    for (path, [raw, clipped]) in measured.statistic.0.iter().enumerate() {
        let mut wiener = WienerPath::<1>::new(KEY, path as u64);
        let (mut w, mut within) = (0.0, 0.0);
        for _ in 0..4 {
            let [dw] = wiener.increments(0.5);
            w += dw;
            within += dw.clamp(-bound, bound);
            beyond += u64::from(dw.abs() > bound);
        }
        assert_eq!(*raw, (w, false), "path {path}");
        assert_eq!(*clipped, (within, w != within), "path {path}");
    }
    // One increment in ten is beyond 1.67 standard deviations.
    assert!(beyond > 100, "{beyond}");
    assert_eq!(measured.clipped, [beyond]);
}

#[test]
fn raw_increments_need_no_bound() {
    let problem = additive(8.0);
    let last = |scheme: &dyn Scheme<Additive, 2, 1>| {
        let ladder = ladder(&problem, (4, 0), 4, vec![Run::new(bind(&problem, scheme), 0)])?;
        Ok(ladder.run(1, || Keep::<2>::new(4, 1)).statistic.runs[0][0][1])
    };
    let mut wiener = WienerPath::<1>::new(KEY, 0);
    let w: f64 = (0..4).map(|_| wiener.increments(2f64.sqrt())[0]).sum();
    assert_eq!(last(&Euler::<false>), Ok(w));
    let refused = "truncated increments need a step size with 0 < tau < 1, got tau = 2";
    let refused = LadderError::Noise(NoiseError(refused.into()));
    assert_eq!(last(&Euler::<true>), Err(refused));
}

/// A method whose paths stay, and which writes down what is wanted of them.
struct Still(Mutex<Vec<PathMask>>);

struct StillPaths<'a>(&'a Still, Vec<Row>);

impl Method for Still {
    fn about(&self) -> About {
        About::new("still")
    }

    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        Box::new(StillPaths(self, y.to_vec()))
    }
}

impl Stepper for StillPaths<'_> {
    fn state(&self) -> &[Row] {
        &self.1
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.1
    }

    fn step(&mut self, _: &Step, _: &StepNoise, status: &mut BlockStatus) {
        *status = BlockStatus::explicit();
    }

    fn rests(&mut self, live: PathMask) -> bool {
        self.0.0.lock().unwrap().push(live);
        false
    }
}

/// Before the first step and after each coarsest one: methods whose paths go one after the other
/// step the others for nothing.
#[test]
fn every_run_is_told_which_paths_are_wanted() {
    let problem = body();
    let [one, other] = [(); 2].map(|()| Arc::new(Still(Mutex::default())));
    let runs = vec![Run::new(Arc::clone(&one) as _, 0), Run::new(Arc::clone(&other) as _, 1)];
    let ladder = ladder(&problem, (8, 1), 2, runs).unwrap();
    ladder.run(3, || Keep::<3>::new(4, 1));
    for still in [one, other] {
        assert_eq!(*still.0.lock().unwrap(), [PathMask::first(3); 5]);
    }
}

#[test]
fn given_noise_drives_a_ladder_like_the_path_that_has_it() {
    let problem = body();
    let levy = SexpLevy::new(problem.system(), problem.y0());
    let ladder = || {
        let runs = vec![
            Run::new(bind(&problem, &Sexp), 0),
            Run::new(bind(&problem, &levy), 0),
            Run::new(bind(&problem, &levy), 2),
            Run::swapped(bind(&problem, &levy), 1),
        ];
        ladder(&problem, (32, 2), 2, runs).unwrap()
    };
    let keep = || Keep::<3>::new(8, 4);
    let drawn = ladder().run_until(&Stop::default(), 4, 1, keep).statistic.runs;
    let tau = 1.0 / 32.0;
    let terms = area_terms(strong_order_one_error(tau), tau, 3).unwrap();
    let given = |path| {
        let source = move |_| -> NextNoise {
            let mut increments = WienerRows::new(KEY, path);
            let mut areas = AreaSampler::new(KEY, path, 3, terms);
            Box::new(move |noise| {
                increments.increments(tau.sqrt(), &mut noise.increments);
                areas.areas(tau, &noise.increments, &mut noise.areas);
            })
        };
        ladder().with_noise(source).run(1, keep).statistic.runs
    };
    assert_eq!(given(4), drawn);
    assert_ne!(given(5), drawn);
}
