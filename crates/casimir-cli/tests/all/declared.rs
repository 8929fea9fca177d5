//! The options of a verb are declared once: from them follow a table in docs/scenes.md and methods
//! of Python's scenes. `WRITE=1 cargo test -p casimir-cli --test all declared` writes both.

use std::{env, fs, path::Path};

use serde_json::{Map, Value};
use verbs::{NAMES, is_of_samples, options};

/// Marks around what is written.
const OF_PAGE: &str = "<!-- options: written by the test `declared` -->\n";
const OF_PYTHON: &str = "    # Verbs: the test `declared` of the program writes these methods.\n";

const OF_KEYS: &str = "# Keys: the test `declared` of the program writes these.\n";

/// A text of documentation in Python, in lines of at most 92 letters.
fn wrapped(text: &str) -> String {
    let (mut all, mut line) = (String::new(), 0);
    for word in text.replace('`', "``").split(' ') {
        let more = word.chars().count() + 1;
        let is_new = line > 0 && line + more > 92;
        all += if is_new {
            "\n        "
        } else if line > 0 {
            " "
        } else {
            ""
        };
        line = if is_new { more } else { line + more };
        all += word;
    }
    all
}

/// Type of the result of a verb in Python.
fn result(verb: &str) -> &str {
    match verb {
        "compare" => "Comparison",
        "inspect" => "Inspection",
        "order" => "Order",
        _ if is_of_samples(verb) => "Expectation",
        _ => "Result",
    }
}

/// The key of an option, and its schema with what this refers to.
type Choice = (String, Map<String, Value>);

/// The description of a verb, and its options.
fn each(verb: &str) -> (String, Vec<Choice>) {
    let schema = options(verb).expect("a verb").to_value();
    let definition = |one: &Value| -> Map<String, Value> {
        let mut all = one.as_object().cloned().unwrap_or_default();
        let any = one["anyOf"].as_array().and_then(|any| any.first());
        for reference in [&one["$ref"], any.map_or(&Value::Null, |any| &any["$ref"])] {
            let name = reference.as_str().and_then(|path| path.rsplit('/').next());
            let found = name.map(|name| schema["$defs"][name].as_object().expect("a type"));
            all.extend(
                found.into_iter().flatten().map(|(key, value)| (key.clone(), value.clone())),
            );
        }
        all
    };
    let all = schema["properties"].as_object().cloned().unwrap_or_default();
    let about = schema["description"].as_str().expect("a description").replace('\n', " ");
    (about, all.iter().map(|(key, one)| (key.clone(), definition(one))).collect())
}

/// A default as Python and the command line take it.
fn written(default: &Value) -> String {
    match default.as_f64() {
        Some(number) if number >= 1e6 => format!("{number:e}"),
        Some(number) if number.fract() == 0.0 && default.is_f64() => format!("{number:?}"),
        _ if default.is_null() => "None".into(),
        _ => default.to_string(),
    }
}

fn meaning(one: &Map<String, Value>) -> String {
    one["description"].as_str().expect("a description").replace('\n', " ")
}

fn method(verb: &str) -> String {
    let (about, options) = each(verb);
    let (mut arguments, mut read, mut words) = (String::new(), String::new(), String::new());
    for (key, one) in &options {
        let default = &one["default"];
        let is_whole = one.contains_key("multipleOf");
        let mut kind = String::from(match default.as_f64() {
            large if is_whole && large < Some(1e6) => "int",
            _ => "float",
        });
        let above = if one.contains_key("exclusiveMinimum") { ", above=0" } else { "" };
        let mut value = match is_whole {
            true => format!("whole(\"{key}\", {key})"),
            false => format!("finite(\"{key}\", {key}{above})"),
        };
        if default.is_null() {
            kind += " | None";
            value = format!("None if {key} is None else {value}");
        }
        arguments += &format!("        {key}: {kind} = {},\n", written(default));
        read += &format!("            \"{key}\": {value},\n");
        words += &format!("\n        {}\n", wrapped(&format!("`{key}`: {}.", meaning(one))));
    }
    let (result, about) = (result(verb), wrapped(&about));
    let options = if read.is_empty() { "{}".into() } else { format!("{{\n{read}        }}") };
    let (raises, given) = match is_of_samples(verb) {
        true => ("        raises: bool = False,\n", ", raises"),
        false => ("", ""),
    };
    let (resume, folder) = match verb {
        "inspect" => ("", ""),
        _ => ("        resume: Folder = None,\n", ", resume"),
    };
    let changes = match arguments.contains("        accuracy: ") {
        true => "ChangesBesideAccuracy",
        false => "Changes",
    };
    let end = if words.is_empty() { "" } else { "        " };
    format!(
        "    def {verb}(\n        self,\n        *,\n{arguments}        threads: int | None = \
         None,\n        progress: bool = True,\n{raises}{resume}        \
         **changes: Unpack[{changes}],\n    ) -> \
         {result}:\n        \"\"\"{about}{}{words}{end}\"\"\"\n        options: Mapping[str, Any] = \
         {options}\n        return self._called({result}, \"{verb}\", options, changes, \
         how(threads, progress{folder}){given})\n",
        if words.is_empty() { "" } else { "\n" },
    )
}

/// Type of a key of scenes in Python: formulas may be expressions of SymPy, and so are any.
fn kind(definitions: &Value, one: &Value) -> &'static str {
    let name = one["$ref"].as_str().and_then(|path| path.rsplit('/').next());
    if let Some(name) = name {
        return kind(definitions, &definitions[name]);
    }
    if let Some([one, null]) = one["anyOf"].as_array().map(Vec::as_slice)
        && null["type"] == "null"
    {
        return kind(definitions, one);
    }
    let types = match &one["type"] {
        Value::Array(all) => all.iter().filter_map(Value::as_str).collect(),
        one => Vec::from_iter(one.as_str()),
    };
    match types[..] {
        ["string"] | ["string", "null"] => "str",
        ["number"] => "SupportsFloat",
        ["integer", "string"] => "SupportsIndex | str",
        ["array"] | ["array", "null"] => "Sequence[Any] | str",
        ["object"] => "Mapping[str, Any]",
        _ => "Any",
    }
}

/// Keys that changes of scenes take in Python, in classes by what some methods take otherwise.
fn keys() -> String {
    let schema = scenes::schema().to_value();
    let (tables, definitions) = (&schema["properties"], &schema["$defs"]);
    let mut classes = [
        ("_Others", String::new()),
        ("_Accuracy", String::new()),
        ("_Parameters", String::new()),
        ("_Span", String::new()),
    ];
    let mut add = |key: &str, kind: &str, about: &str| {
        let class = match key {
            "accuracy" => 1,
            "parameters" => 2,
            "initial" | "until" | "steps" => 3,
            _ => 0,
        };
        let kind = if kind == "Any" { "Any".into() } else { format!("{kind} | None") };
        let about = wrapped(&about.replace('\n', " ")).replace("\n        ", "\n    ");
        classes[class].1 += &format!("    {key}: {kind}\n    \"\"\"{about}\"\"\"\n");
    };
    for table in ["run", "expect"] {
        let of = if table == "run" { "RunTable" } else { "ExpectTable" };
        for (key, one) in definitions[of]["properties"].as_object().expect("keys") {
            let about = one["description"].as_str().unwrap_or_default();
            add(key, kind(definitions, one), about);
        }
    }
    let about = "Values of names in formulas, changed one by one.";
    add("parameters", "Mapping[Any, Any]", about);
    for (key, one) in tables.as_object().expect("tables") {
        let about = one["description"].as_str().unwrap_or_default();
        let kind = match key.as_str() {
            "title" => "str",
            // A rate in place of the table, or several tables.
            "damping" | "bath" => "Any",
            _ => "Mapping[str, Any]",
        };
        add(key, kind, about);
    }
    let class = |(name, keys)| format!("class {name}(TypedDict, total=False):\n{keys}");
    classes.map(class).join("\n\n")
}

fn table() -> String {
    let mut table = String::from("| command | option | default | meaning |\n|---|---|---|---|\n");
    for verb in NAMES {
        for (key, one) in each(verb).1 {
            let default = written(&one["default"]).replace("None", "–");
            let option = key.replace('_', "-");
            table += &format!("| `{verb}` | `--{option}` | {default} | {} |\n", meaning(&one));
        }
    }
    table
}

#[test]
fn options_are_declared_once() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    // Data are no option: `fit` is written by hand.
    let methods = NAMES.iter().filter(|verb| **verb != "fit").map(|verb| method(verb));
    let methods: Vec<String> = methods.collect();
    for (file, mark, written) in [
        ("docs/scenes.md", OF_PAGE, table()),
        ("python/casimir/_scene.py", OF_PYTHON, methods.join("\n")),
        ("python/casimir/_changes.py", OF_KEYS, keys()),
    ] {
        let file = root.join(file);
        let text = fs::read_to_string(&file).expect("a file");
        let [before, old, after] = text.split(mark).collect::<Vec<_>>()[..] else {
            panic!("{} has no two marks", file.display())
        };
        if env::var_os("WRITE").is_some() {
            let text = [before, mark, &written, mark, after].concat();
            fs::write(&file, text).expect("a file");
        } else {
            assert_eq!(old, written, "{}", file.display());
        }
    }
}

/// Arguments of the command line have the names and the defaults of the declaration.
#[test]
fn the_command_line_has_them() {
    for verb in NAMES {
        let help = crate::common::succeeds(Path::new("."), &[verb, "--help"]);
        for (key, one) in each(verb).1 {
            let option = format!("--{} <", key.replace('_', "-"));
            let at = help.find(&option).unwrap_or_else(|| panic!("{verb} {option}: {help}"));
            let about = help[at..].lines().next().unwrap_or_default();
            if !one["default"].is_null() {
                let default =
                    format!("[default: {}]", written(&one["default"]).trim_end_matches(".0"));
                assert!(about.contains(&default), "{verb} {option}: {about}");
            }
        }
    }
}
