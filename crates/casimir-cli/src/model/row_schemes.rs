//! The schemes on a system whose dimension is known at run time.

use casimir::{
    schemes::{EulerMaruyama, Heun, Midpoint, Nv, Sexp, SexpLi, SexpLiError, run_time::Scheme},
    systems::run_time::System,
};

/// A scheme, or why it is not for the system.
type Suited = Result<Box<dyn Scheme>, String>;

/// Schemes by name.
pub struct RowSchemes {
    names: Vec<&'static str>,
    schemes: Vec<Suited>,
}

impl RowSchemes {
    /// All but `split`.
    pub fn new(system: &dyn System) -> Self {
        fn suited<S: Scheme + 'static>(scheme: Result<S, SexpLiError>) -> Suited {
            Ok(Box::new(scheme.map_err(|error| error.to_string())?))
        }
        let mut all = Self { names: Vec::new(), schemes: Vec::new() };
        all.add("sexp", Ok(Box::new(Sexp)));
        all.add("sexp-li", suited(SexpLi::at_run_time(system)));
        all.add("nv", suited(Nv::at_run_time(system)));
        all.add("midpoint", Ok(Box::new(Midpoint)));
        all.add("heun", Ok(Box::new(Heun)));
        all.add("em", Ok(Box::new(EulerMaruyama)));
        all
    }

    /// One more.
    pub fn add(&mut self, name: &'static str, scheme: Suited) {
        self.names.push(name);
        self.schemes.push(scheme);
    }

    /// A scheme by its name.
    ///
    /// # Errors
    /// Why there is none.
    pub fn get(&self, name: &str) -> Result<&dyn Scheme, String> {
        let found = self.names.iter().position(|known| *known == name);
        let found = found.ok_or_else(|| super::unknown_scheme(name, &self.names))?;
        Ok(&**self.schemes[found].as_ref()?)
    }
}
