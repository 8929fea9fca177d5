//! `casimir doctor`: this machine and a self-test, for a report of a fault.

use casimir_cli::{
    doctor::{EXPECTED, facts, self_test},
    failure::{Done, Failure},
};

use super::print;

/// Prints facts and what the self-test found.
pub fn doctor() -> Done {
    print(&facts(option_env!("CASIMIR_COMMIT")))?;
    let (text, holds) = self_test(EXPECTED)?;
    print(&text)?;
    let words = "attach this text, the scene, the command, and what should have come out";
    match holds {
        true => print(&format!("To report a fault, {words}.\n")),
        false => Err(Failure::Run(format!("a self-test fails: report it; {words}"))),
    }
}
