//! What the parts in a folder are parts of: its file `run.json`.

use std::{collections::BTreeMap, fs, io, path::Path};

use anyhow::{Context, Result, bail};
use mc::parts::Program;
use report::{files, provenance};
use serde::{Deserialize, Serialize};

/// The file in a folder of parts that says how to merge them.
pub const RUN: &str = "run.json";

/// A program with the arguments that decide what is computed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// The chore of `cargo xtask`.
    pub program: String,
    /// Version of the package, and the commit.
    pub version: String,
    /// Arguments of which every part has the same.
    pub arguments: Vec<String>,
    /// Arguments that may grow: a larger study reuses what was merged.
    pub sizes: BTreeMap<String, f64>,
    /// Whether parts of these sizes were merged. Before that a study cannot grow.
    pub merged: bool,
}

impl Study {
    /// A study in a folder. Where git knows no commit, as on a node without it, the commit is the
    /// one that the folder was begun with.
    ///
    /// # Errors
    /// When the file of the folder cannot be read.
    pub fn new(
        program: &str,
        arguments: Vec<String>,
        sizes: BTreeMap<String, f64>,
        folder: &Path,
    ) -> Result<Self> {
        let package = env!("CARGO_PKG_VERSION");
        let version = match (provenance::commit(), Self::read(folder)?) {
            (Some(commit), _) => format!("{package} ({commit})"),
            (None, Some(begun)) => begun.version,
            (None, None) => package.to_owned(),
        };
        Ok(Self { program: program.to_owned(), version, arguments, sizes, merged: false })
    }

    /// The study that a folder was begun with, if it was.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn read(folder: &Path) -> Result<Option<Self>> {
        let file = folder.join(RUN);
        let text = match fs::read(&file) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            text => text.with_context(|| format!("cannot read {}", file.display()))?,
        };
        let study = serde_json::from_slice(&text);
        study.map(Some).with_context(|| format!("{} is damaged: delete it", file.display()))
    }

    /// Begins the folder with this study, or goes on with it there, maybe at a larger size.
    ///
    /// # Errors
    /// When it has another study, or one of a larger size.
    pub fn settle(&self, folder: &Path) -> Result<()> {
        if let Some(begun) = Self::read(folder)? {
            self.check(&begun, folder)?;
            if begun.sizes == self.sizes {
                return Ok(());
            }
            if !begun.merged && has_parts(folder)? {
                let folder = folder.display();
                bail!("before it grows, merge what is there: cargo xtask merge {folder}");
            }
        }
        self.write(folder)
    }

    /// Notes that the parts in the folder are merged.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn note_merged(&self, folder: &Path) -> Result<()> {
        Self { merged: true, ..self.clone() }.write(folder)
    }

    fn write(&self, folder: &Path) -> Result<()> {
        Ok(files::write_json(&folder.join(RUN), self)?)
    }

    fn check(&self, begun: &Self, folder: &Path) -> Result<()> {
        let folder = folder.display();
        let smaller =
            |(name, size): (&String, &f64)| begun.sizes.get(name).is_some_and(|n| n > size);
        let pairs = [
            (&begun.program, &self.program),
            (&begun.version, &self.version),
            (&begun.arguments.join(" "), &self.arguments.join(" ")),
            (&names(&begun.sizes), &names(&self.sizes)),
        ];
        if let Some((found, here)) = pairs.into_iter().find(|(found, here)| found != here) {
            bail!(
                "{folder} was begun with {found:?}, here it is {here:?}: take another folder, or \
                 what that one was begun with"
            );
        }
        if let Some((name, size)) = self.sizes.iter().find(|size| smaller(*size)) {
            let begun = begun.sizes[name];
            bail!("{folder} has {name} {begun}, here it is {size}: a study can only grow");
        }
        Ok(())
    }

    /// The arguments with their sizes.
    pub fn command(&self) -> Vec<String> {
        let sizes = self.sizes.iter().flat_map(|(name, size)| [name.clone(), size.to_string()]);
        self.arguments.iter().cloned().chain(sizes).collect()
    }

    /// What parts are told apart by.
    pub fn program(&self) -> Program {
        Program { name: self.program.clone(), version: self.version.clone() }
    }
}

fn has_parts(folder: &Path) -> Result<bool> {
    let files: Vec<_> = fs::read_dir(folder)?.collect::<io::Result<_>>()?;
    Ok(files.iter().any(|file| file.file_name().to_string_lossy().starts_with("part-")))
}

fn names(sizes: &BTreeMap<String, f64>) -> String {
    sizes.keys().map(String::as_str).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn study(arguments: &str, times: Option<f64>, folder: &Path) -> Study {
        let arguments = arguments.split(' ').map(str::to_owned).collect();
        let sizes = times.map(|times| ("--samples-times".to_owned(), times)).into_iter().collect();
        Study::new("reproduce", arguments, sizes, folder).unwrap()
    }

    #[test]
    fn a_folder_has_one_study_which_may_grow() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path();
        let begun = study("--seed 1", Some(2.0), folder);
        assert_eq!(Study::read(folder).unwrap(), None);
        begun.settle(folder).unwrap();
        begun.settle(folder).unwrap();
        assert_eq!(Study::read(folder).unwrap(), Some(begun.clone()));
        let larger = study("--seed 1", Some(2.5), folder);
        let part = folder.join("part-1-of-2.json");
        fs::write(&part, "").unwrap();
        let error = larger.settle(folder).unwrap_err().to_string();
        assert!(error.contains("before it grows, merge"), "{error}");
        begun.note_merged(folder).unwrap();
        begun.settle(folder).unwrap();
        larger.settle(folder).unwrap();
        assert_eq!(Study::read(folder).unwrap(), Some(larger.clone()));
        assert_eq!(larger.command(), ["--seed", "1", "--samples-times", "2.5"]);
        let others = [
            (study("--seed 2", Some(2.5), folder), "was begun with \"--seed 1\""),
            (study("--seed 1", None, folder), "was begun with \"--samples-times\""),
            (study("--seed 1", Some(2.0), folder), "has --samples-times 2.5, here it is 2"),
            (Study { version: "0".into(), ..larger.clone() }, "here it is \"0\""),
        ];
        for (other, why) in others {
            let error = other.settle(folder).unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
        assert_eq!(Study::read(folder).unwrap(), Some(larger));
    }
}
