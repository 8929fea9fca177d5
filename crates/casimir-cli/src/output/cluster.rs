//! A study in parts on a cluster: its job script for Slurm, and the same for whoever has another
//! scheduler or none.

use std::path::Path;

/// A program that computes one part of many.
#[derive(Clone, Debug, Default)]
pub struct Script<'a> {
    /// What the job is called.
    pub name: &'a str,
    /// The command that writes the script.
    pub written_by: &'a str,
    /// Number of parts.
    pub parts: u64,
    /// The program, as an absolute path: it is built already.
    pub program: &'a str,
    /// Its arguments but `--part` and `--threads`.
    pub arguments: &'a [String],
    /// The folder of the parts, as an absolute path.
    pub folder: &'a str,
    /// Where the program runs.
    pub directory: &'a str,
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
        let Self { name, written_by, parts, program, arguments, folder, directory, .. } = *self;
        let Self { minutes, cpus, .. } = *self;
        let options: String =
            self.options.iter().map(|option| format!("#SBATCH {option}\n")).collect();
        let words: String = arguments.iter().map(|word| format!(" {}", quoted(word))).collect();
        let [program, directory] = [program, directory].map(quoted);
        let log = Path::new(folder).join("part-%a.log");
        format!(
            "#!/bin/bash\n\
             # Written by `{written_by}`. `sbatch {script}` computes all parts, `bash {script} \
             K` part K.\n\
             #SBATCH --job-name={name}\n\
             #SBATCH --array=1-{parts}\n\
             #SBATCH --time={minutes}\n\
             #SBATCH --cpus-per-task={cpus}\n\
             #SBATCH --signal=B:TERM@60\n\
             #SBATCH --requeue\n\
             #SBATCH --open-mode=append\n\
             #SBATCH --output={log}\n\
             {options}\
             part=${{SLURM_ARRAY_TASK_ID:-${{HQ_TASK_ID:-$1}}}}\n\
             cd {directory} || exit 2\n\
             exec {program}{words} --part \"$part\" \\\n    \
             --threads \"${{SLURM_CPUS_PER_TASK:-{cpus}}}\"\n",
            script = JOB,
            log = quoted(&log.display().to_string()),
        )
    }

    /// How the parts are computed with and without schedulers, in lines to copy.
    pub fn lines(&self) -> String {
        let Self { parts, cpus, .. } = *self;
        let script = quoted(&Path::new(self.folder).join(JOB).display().to_string());
        let done = Path::new(self.folder).join("done-{part}").display().to_string();
        format!(
            "Slurm:\n  sbatch {script}\n\
             a shell:\n  for part in $(seq {parts}); do bash {script} $part; done\n\
             xargs or GNU parallel, 8 at a time:\n  \
             seq {parts} | xargs -P 8 -n 1 bash {script}\n  \
             parallel -j 8 bash {script} ::: $(seq {parts})\n\
             HyperQueue:\n  hq submit --array 1-{parts} --cpus {cpus} -- bash {script}\n\
             Snakemake:\n  \
             rule all:\n      input: expand({done:?}, part=range(1, {end}))\n  \
             rule part:\n      output: touch({done:?})\n      threads: {cpus}\n      \
             shell: \"bash {script} {{wildcards.part}}\"\n",
            end = parts + 1,
        )
    }
}

/// The file of the script in the folder of the parts.
pub const JOB: &str = "job.sh";

/// A word for the shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn script() -> Script<'static> {
        Script {
            name: "reproduce",
            parts: 64,
            program: "/opt/casimir/reproduce",
            folder: "/scratch/my run",
            directory: "/home/me",
            minutes: 30,
            cpus: 2,
            ..Script::default()
        }
    }

    #[test]
    fn a_script_has_what_the_scheduler_needs() {
        let arguments = ["--seed", "it's", "--parts", "64"].map(str::to_owned);
        let options = ["--account=physics".to_owned()];
        let text = Script { arguments: &arguments, options: &options, ..script() }.slurm();
        assert!(text.starts_with("#!/bin/bash\n"));
        for line in [
            "#SBATCH --array=1-64",
            "#SBATCH --time=30",
            "#SBATCH --cpus-per-task=2",
            "#SBATCH --account=physics",
            "#SBATCH --output='/scratch/my run/part-%a.log'",
            "cd /home/me || exit 2",
        ] {
            assert!(text.lines().any(|found| found == line), "{line} in\n{text}");
        }
        let exec = r"exec /opt/casimir/reproduce --seed 'it'\''s' --parts 64 --part";
        assert!(text.contains(exec), "{text}");
        // Options come before the first command.
        let last = text.rfind("#SBATCH").unwrap();
        assert!(last < text.find("\npart=").unwrap());
    }

    #[test]
    fn there_are_lines_for_everybody() {
        let lines = script().lines();
        for line in ["sbatch '/scratch/my run/job.sh'", "seq 64 |", "hq submit", "range(1, 65)"] {
            assert!(lines.contains(line), "{lines}");
        }
    }

    #[test]
    fn words_are_quoted_where_they_must() {
        assert_eq!(
            ["a-b_c/1.5", "", "a b", "$x"].map(quoted),
            ["a-b_c/1.5", "''", "'a b'", "'$x'"]
        );
    }
}
