//! `casimir new`: scenes to begin with.

use casimir_cli::{
    failure::{Done, Failure},
    gallery::{GALLERY, scene},
    model::PROJECT,
};

use super::print;
use crate::arguments::New;

/// Prints a scene, or lists them.
pub fn new(arguments: &New) -> Done {
    if arguments.list {
        let mut list = String::from("Scenes, for casimir new NAME:\n");
        for (name, text) in GALLERY {
            list += &format!("  {name:<18}{}\n", headline(text));
        }
        list += "\nSystems of the project, for `name` in [system], and their parameters:\n";
        for (name, parameters, what) in PROJECT {
            list += &format!("  {name:<18}{what}\n");
            if !parameters.is_empty() {
                list += &format!("{:20}{parameters}\n", "");
            }
        }
        return print(&list);
    }
    let name = arguments.name.as_deref().unwrap_or("empty");
    print(scene(name).map_err(Failure::Usage)?)
}

/// The first line of a scene, without its #.
fn headline(text: &str) -> &str {
    text.lines().next().unwrap_or("").trim_start_matches(['#', ' '])
}
