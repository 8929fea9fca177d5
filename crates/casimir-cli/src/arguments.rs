//! The command line.

use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum};
use scenes::{Changes, count};
use verbs::{
    Compare, Equilibrium, Expect, Fit, Inspect, Lyapunov, Order, failure::Done, output::Format,
};

use crate::commands;

/// Damped stochastic Poisson systems from a text file:
/// dy = (B∇H₀ − γy)dt + Σ B∇Hₘ ∘ dWₘ
#[derive(Parser)]
#[command(name = "casimir", version, max_term_width = 90, after_help = EXAMPLES)]
#[command(arg_required_else_help = true, args_conflicts_with_subcommands = true)]
pub struct Arguments {
    /// Print what to cite as BibTeX: all, or what a scene or results in JSON used
    #[arg(long, value_name = "FILE")]
    pub citation: Option<Option<PathBuf>>,
    #[command(subcommand)]
    pub command: Option<Command>,
}

const EXAMPLES: &str = "\
Examples:
  casimir new rigid-body > body.toml     a commented scene to change
  casimir run body.toml                  tables, figures and a report in body-run/
  casimir expect body.toml               expectations with 95 % intervals
Exit codes: 0 done, 1 the run failed, 2 the scene or the command is wrong, 130 stopped";

#[derive(Subcommand)]
pub enum Command {
    /// Print a commented scene to begin with
    #[command(after_help = "Example: casimir new heavy-top > top.toml")]
    New {
        /// A scene of the gallery; without it an empty scene with all keys
        name: Option<String>,
        /// List the scenes and the systems of the project
        #[arg(long)]
        list: bool,
    },
    /// Say what a system is: Casimirs, orders, mistakes, a scheme to take
    #[command(after_help = "Example: casimir inspect top.toml")]
    Inspect(Asked<Inspect>),
    /// Simulate paths: tables, figures, a report in HTML
    #[command(after_help = "Examples:
  casimir run top.toml --paths 1e6 --write csv,npz --out top-million
  casimir run top.toml --set sigma=0.1,0.2,0.5 --set k=0.5:1.5:11")]
    Run(Run),
    /// Compute expectations with 95 % intervals
    #[command(after_help = "Example: casimir expect top.toml --accuracy 1e-4")]
    Expect(Asked<Expect>),
    /// Find parameters from moments or samples of data, with 95 % intervals
    #[command(after_help = "Example: casimir fit kubo.toml data.csv --of sigma
Data are a table of moments, with the columns time, observable, statistic (mean, variance or a
quantile as q0.05), value and error; or of samples, with t and a column for each observable")]
    Fit(Asked<Fit>),
    /// Average over the stationary law, with 95 % intervals that include the step error
    #[command(after_help = "Example: casimir equilibrium double-well.toml --accuracy 1e-3")]
    Equilibrium(Asked<Equilibrium>),
    /// Compute Lyapunov exponents with 95 % intervals
    #[command(after_help = "Example: casimir lyapunov kubo.toml --count 2 --accuracy 1e-3")]
    Lyapunov(Asked<Lyapunov>),
    /// Measure the strong and the weak order of a scheme on a scene
    #[command(after_help = "Example: casimir order top.toml --scheme sexp-li")]
    Order(Asked<Order>),
    /// Measure error against cost of all schemes on a scene, and recommend one
    #[command(after_help = "Example: casimir compare top.toml --error 1e-3")]
    Compare(Asked<Compare>),
    /// Divide a run into parts for a cluster
    #[command(after_help = "Example: casimir plan top.toml --parts 64 --out big")]
    Plan(Plan),
    /// Compute one part; goes on from its checkpoint
    #[command(after_help = "Example: casimir part big --part 3")]
    Part {
        /// The folder that `casimir plan` made
        folder: PathBuf,
        /// The number of the part, from 1
        #[arg(long)]
        part: u64,
        /// Number of threads. Default: one for each processor
        #[arg(long)]
        threads: Option<u64>,
        /// The machine that advances paths; the results are the same bits on any
        #[arg(long, value_enum, default_value_t)]
        on: Machine,
    },
    /// Put the parts in a folder together, or say which are missing
    Merge {
        /// The folder that `casimir plan` made
        folder: PathBuf,
        /// Formats to write beside the report
        #[arg(long, value_name = "FORMATS", value_delimiter = ',')]
        write: Vec<Format>,
        /// Print a summary as JSON
        #[arg(long)]
        json: bool,
    },
    /// Ask for more paths in a folder, which keeps what it has
    #[command(after_help = "Example: casimir extend big --paths 1e9")]
    Extend {
        /// The folder that `casimir plan` made
        folder: PathBuf,
        /// The new number of paths, in all
        #[arg(long, value_parser = count)]
        paths: u64,
    },
    /// Print the JSON schema of scenes, for editors, or of the options of a command
    Schema {
        /// The command
        verb: Option<String>,
    },
    /// Test the program on this machine, for reports of faults
    Doctor,
}

impl Command {
    /// Executes the command; job scripts start `program`.
    pub fn run(self, program: &Path) -> Done {
        use Command::*;
        match self {
            New { name, list } => commands::new(name.as_deref(), list),
            Inspect(asked) => commands::compute(&asked),
            Run(asked) => commands::run(&asked),
            Expect(asked) => commands::compute(&asked),
            Fit(asked) => commands::compute(&asked),
            Equilibrium(asked) => commands::compute(&asked),
            Lyapunov(asked) => commands::compute(&asked),
            Order(asked) => commands::compute(&asked),
            Compare(asked) => commands::compute(&asked),
            Plan(asked) => commands::plan(&asked, program),
            Part { folder, part, threads, on } => commands::part(&folder, part, threads, on),
            Merge { folder, write, json } => commands::merge(&folder, &write, json),
            Extend { folder, paths } => commands::extend(&folder, paths),
            Schema { verb } => commands::schema(verb.as_deref()),
            Doctor => commands::doctor(),
        }
    }
}

/// A verb with its options, on a scene.
#[derive(Args)]
pub struct Asked<V: Args> {
    #[command(flatten)]
    pub options: V,
    #[command(flatten)]
    pub on: On,
}

/// Arguments of every command on a scene.
#[derive(Args)]
pub struct On {
    /// The file of the scene
    pub scene: PathBuf,
    /// The folder of results. Default: the name of the scene and the command, as `top-run`
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print a summary as JSON
    #[arg(long)]
    pub json: bool,
    /// Number of threads; the results are the same bits with any number
    #[arg(long)]
    pub threads: Option<u64>,
}

/// A machine that advances paths.
#[derive(Clone, Copy, Default, PartialEq, ValueEnum)]
pub enum Machine {
    /// This processor
    #[default]
    Cpu,
    /// A graphics card of NVIDIA, with what the processor has to do beside it
    Gpu,
}

#[derive(Args)]
pub struct Run {
    #[command(flatten)]
    pub changes: Changes,
    /// Formats to write beside the report
    #[arg(long, value_name = "FORMATS", value_delimiter = ',')]
    pub write: Vec<Format>,
    /// Keep tables that are more than a gigabyte of text
    #[arg(long)]
    pub large: bool,
    /// The machine that advances paths; the results are the same bits on any
    #[arg(id = "machine", long = "on", value_enum, default_value_t)]
    pub machine: Machine,
    #[command(flatten)]
    pub on: On,
}

#[derive(Args)]
pub struct Plan {
    /// The file of the scene
    pub scene: PathBuf,
    /// Number of parts
    #[arg(long)]
    pub parts: u64,
    /// The folder of the parts
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Processors of a part
    #[arg(long, default_value_t = 1)]
    pub cpus: u64,
    /// A further option of `sbatch`, such as --account=physics; may be repeated
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    pub sbatch: Vec<String>,
    #[command(flatten)]
    pub changes: Changes,
}
