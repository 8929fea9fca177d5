//! A study in parts on a cluster: its job script for Slurm, and the same for whoever has another
//! scheduler or none.

use std::path::Path;

/// Parameters of the script in which `casimir part` computes one part of many.
pub struct Script<'a> {
    /// Number of parts.
    pub parts: u64,
    /// This program.
    pub program: &'a Path,
    /// The folder of the parts, as an absolute path.
    pub folder: &'a Path,
    /// Most minutes that a part takes.
    pub minutes: u64,
    /// Processors of a part, which are its threads.
    pub cpus: u64,
    /// Further options of `sbatch`, such as `--account=physics`.
    pub options: &'a [String],
}

impl Script<'_> {
    /// The script. `sbatch` runs it as an array; `bash script 3` computes part 3 anywhere.
    ///
    /// Slurm sends TERM to the program a minute before the time is over, and so it does on
    /// preemption. The program writes a checkpoint, and goes on from it when the job is requeued or
    /// submitted again.
    pub fn slurm(&self) -> String {
        let Self { parts, minutes, cpus, .. } = self;
        let mut options =
            self.options.iter().map(|option| format!("#SBATCH {option}\n")).collect::<String>();
        let log = quoted(&self.folder.join("part-%a.log"));
        // Slurm itself does not read words with escapes.
        if !log.starts_with('$') {
            options = format!("#SBATCH --output={log}\n{options}");
        }
        let [program, folder] = [self.program, self.folder].map(quoted);
        format!(
            "#!/bin/bash\n\
             # Written by `casimir plan`. `sbatch {JOB}` computes all parts, `bash {JOB} K` part K.\n\
             #SBATCH --job-name=casimir\n\
             #SBATCH --array=1-{parts}\n\
             #SBATCH --time={minutes}\n\
             #SBATCH --cpus-per-task={cpus}\n\
             #SBATCH --signal=B:TERM@60\n\
             #SBATCH --requeue\n\
             #SBATCH --open-mode=append\n\
             {options}\
             part=${{SLURM_ARRAY_TASK_ID:-${{HQ_TASK_ID:-$1}}}}\n\
             cd {folder} || exit 2\n\
             exec {program} part {folder} --part \"$part\" \\\n    \
             --threads \"${{SLURM_CPUS_PER_TASK:-{cpus}}}\"\n"
        )
    }

    /// Instructions to compute the parts with and without schedulers, in lines to copy.
    pub fn lines(&self) -> String {
        let (parts, cpus, script) = (self.parts, self.cpus, quoted(&self.folder.join(JOB)));
        format!(
            "Slurm:\n  sbatch {script}\n\
             a shell, 8 at a time:\n  seq {parts} | xargs -P 8 -n 1 bash {script}\n\
             HyperQueue:\n  hq submit --array 1-{parts} --cpus {cpus} -- bash {script}\n\
             any other scheduler: bash {script} K for each K from 1 to {parts}\n"
        )
    }
}

/// The file of the script in the folder of the parts.
pub const JOB: &str = "job.sh";

/// A path as a word for the shell.
fn quoted(path: &Path) -> String {
    let Some(word) = path.to_str().filter(|word| !word.contains(char::is_control)) else {
        return format!("$'{}'", path.as_os_str().as_encoded_bytes().escape_ascii());
    };
    if word.chars().all(|c| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c)) {
        return word.into();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_script_has_what_the_scheduler_needs_and_there_are_lines_for_everybody() {
        let script = Script {
            parts: 64,
            program: Path::new("/opt/casimir/it's"),
            folder: Path::new("/scratch/my run"),
            minutes: 30,
            cpus: 2,
            options: &["--account=physics".to_owned()],
        };
        // Options come before the first command.
        let expected = r"#!/bin/bash
#SBATCH --array=1-64
#SBATCH --time=30
#SBATCH --cpus-per-task=2
#SBATCH --account=physics
#SBATCH --output='/scratch/my run/part-%a.log'
cd '/scratch/my run' || exit 2
exec '/opt/casimir/it'\''s' part '/scratch/my run' --part";
        let text = script.slurm();
        for line in expected.lines() {
            assert!(text.contains(line), "{line} in\n{text}");
        }
        assert!(text.rfind("#SBATCH").unwrap() < text.find("\npart=").unwrap());
        let lines = script.lines();
        for line in ["sbatch '/scratch/my run/job.sh'", "seq 64 |", "hq submit", "from 1 to 64"] {
            assert!(lines.contains(line), "{lines}");
        }
    }
}
