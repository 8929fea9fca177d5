//! All that results depend on, as text.

use toml::{Table, Value};

use super::{Changes, Scene, number};

/// Keys that change how results are shown or how many there are, but not the law of the samples:
/// stored samples can still be extended.
const APART: [&str; 6] =
    ["title", "figures.", "expect.accuracy", "run.paths", "run.tables", "run.columns"];

impl Scene {
    /// The scene and what a command line changes, in lines `key = value`. Comments, blanks and ways
    /// to write a number do not count.
    pub fn meaning(&self) -> String {
        let law = self.settings.random.as_ref().map(|random| &*random.law);
        lines(&self.source.text, law, &self.changes)
    }
}

/// Lines `key = value` of a scene and of its changes. The `law` of random initial values has the
/// sum of a file of states.
fn lines(text: &str, law: Option<&str>, changes: &Changes) -> String {
    // It was read before.
    let scene: Table = toml::from_str(text).unwrap_or_default();
    let mut lines = Vec::new();
    flatten(String::new(), &scene.into(), &mut lines);
    lines.retain(|line| !APART.iter().any(|key| line.starts_with(key)));
    lines.extend(law.map(|law| format!("run.initial is {law}")));
    // More paths may be asked for.
    let changes = Changes { paths: None, ..changes.clone() };
    let changes = Value::try_from(changes).expect("they are keys and values");
    flatten("--".into(), &changes, &mut lines);
    lines.join("\n") + "\n"
}

fn flatten(key: String, value: &Value, lines: &mut Vec<String>) {
    let dot = if key.is_empty() || key.ends_with('-') { "" } else { "." };
    let text = match value {
        Value::Table(table) => {
            let each = |(name, of): (&String, _)| flatten(format!("{key}{dot}{name}"), of, lines);
            return table.iter().for_each(each);
        }
        Value::Array(list) => {
            let each = |(n, of): (usize, _)| flatten(format!("{key}[{n}]"), of, lines);
            return (1..).zip(list).for_each(each);
        }
        Value::String(text) => canonical(text),
        Value::Boolean(switch) => switch.to_string(),
        other => canonical(&number(other)),
    };
    lines.push(format!("{key} = {text}"));
}

/// The canonical form of a number, or a formula without blanks except those between words.
fn canonical(text: &str) -> String {
    // Beyond 2⁵³ a number is not exact.
    if let Ok(number) = text.parse::<f64>()
        && number.abs() < 9e15
    {
        return number.to_string();
    }
    let mut all = String::new();
    for word in text.split_whitespace() {
        let joins =
            |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == '.');
        if joins(all.chars().next_back()) && joins(word.chars().next()) {
            all.push(' ');
        }
        all += word;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> String {
        lines(text, None, &Changes::default())
    }

    const SCENE: &str = "[system]\nstate = [\"q\", \"p\"]\nH0 = \"2 q^2 + p*q\"\n\
                         [run]\nuntil = 10\npaths = 5\n[events]\nfar = \"q > 4 or p > 1\"\n";

    #[test]
    fn what_means_the_same_is_the_same() {
        let same = "# a comment\ntitle = \"T\"\n[system]\nstate = ['q','p'] # another\n\
                    H0 = \" 2 q^2+p * q\"\n[run]\nuntil = 1e1\n paths=7\n\n[events]\n\
                    far=\"q>4  or p>1.0\"\n[figures]\nlog = [\"q\"]\n[expect]\naccuracy = 1\n";
        // A number within a formula stays as it is written.
        assert_eq!(of(&same.replace("1.0", "1")), of(SCENE));
        assert!(of(SCENE).contains("\nevents.far = q>4 or p>1\n"), "{}", of(SCENE));
        for seed in ["18446744073709551615", "18446744073709551614"] {
            assert!(of(&format!("[run]\nseed = \"{seed}\"")).contains(seed));
        }
    }

    #[test]
    fn every_other_change_shows() {
        let edits =
            [("4", "4.5"), ("2 q", "2*q"), ("10", "11"), ("far", "near"), (" or ", " and ")];
        for (old, new) in edits {
            assert_ne!(of(&SCENE.replacen(old, new, 1)), of(SCENE), "{old} {new}");
        }
        let with = |law, changes: Changes| lines(SCENE, law, &changes);
        let none = Changes::default;
        assert_eq!(with(None, Changes { paths: Some(9), ..none() }), of(SCENE));
        assert_ne!(with(None, Changes { steps: Some(9), ..none() }), of(SCENE));
        assert!(with(None, Changes { steps: Some(9), ..none() }).contains("--steps = 9"));
        assert_ne!(with(None, Changes { independent: true, ..none() }), of(SCENE));
        let mut set = none();
        set.scheme.sets.push("a=1,2".parse().unwrap());
        assert!(with(None, set).contains("--sets[1].values[2] = 2\n"));
        assert_ne!(with(Some("the 3 states of f, SHA-256 0"), none()), of(SCENE));
    }
}
