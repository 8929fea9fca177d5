//! Texts of scenes that are changed key by key; comments stay.

use std::ops::Range;

use pyo3::{exceptions::PyValueError, prelude::*};
use serde_json::Value as Json;
use toml_edit::{Array, Document, DocumentMut, InlineTable, Item, Table, TableLike, Value, value};

/// A text with other values: pairs of a path of keys and JSON. `null` removes a key.
#[pyfunction]
pub fn changed(text: &str, changes: Vec<(Vec<String>, String)>) -> PyResult<String> {
    let mut document: DocumentMut = text.parse().map_err(wrong)?;
    for (path, json) in changes {
        let json: Json = serde_json::from_str(&json).map_err(wrong)?;
        let Some((last, tables)) = path.split_last() else { continue };
        let mut at: &mut dyn TableLike = document.as_table_mut();
        for key in tables {
            let item = at.entry(key).or_insert_with(|| Item::Table(Table::new()));
            at = item.as_table_like_mut().ok_or_else(|| wrong(format!("`{key}` is no table")))?;
        }
        if json.is_null() {
            at.remove(last);
            continue;
        }
        let item = match json {
            Json::Object(object) if tables.is_empty() => {
                let mut table = Table::new();
                for (key, json) in object {
                    table.insert(&key, item(json)?);
                }
                Item::Table(table)
            }
            json => item(json)?,
        };
        match at.get_mut(last).and_then(Item::as_value_mut).zip(item.as_value()) {
            Some((old, new)) => {
                let decor = old.decor().clone();
                *old = new.clone();
                *old.decor_mut() = decor;
            }
            None => {
                at.insert(last, item);
            }
        }
    }
    Ok(document.to_string())
}

/// A text as JSON.
#[pyfunction]
pub fn as_json(text: &str) -> PyResult<String> {
    let json: Json = toml_edit::de::from_str(text).map_err(wrong)?;
    Ok(json.to_string())
}

fn wrong(error: impl ToString) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn item(json: Json) -> PyResult<Item> {
    Ok(value(of_json(json)?))
}

fn of_json(json: Json) -> PyResult<Value> {
    Ok(match json {
        Json::Null => return Err(wrong("a value may not be None")),
        Json::Bool(switch) => switch.into(),
        Json::String(text) => text.into(),
        Json::Number(number) => match (number.as_i64(), number.as_u64()) {
            (Some(whole), _) => whole.into(),
            // A seed that TOML has no number for.
            (None, Some(whole)) => whole.to_string().into(),
            (None, None) => number.as_f64().unwrap_or(f64::NAN).into(),
        },
        Json::Array(list) => {
            list.into_iter().map(of_json).collect::<PyResult<Array>>().map(Value::Array)?
        }
        Json::Object(object) => {
            let mut table = InlineTable::new();
            for (key, json) in object {
                table.insert(&key, of_json(json)?);
            }
            Value::InlineTable(table)
        }
    })
}

/// The innermost key whose name or value has the place, as `run.steps`.
pub fn key_at(text: &str, place: &Range<usize>) -> Option<String> {
    let document = Document::parse(text).ok()?;
    let mut found: Option<String> = None;
    let mut waiting: Vec<(String, &dyn TableLike)> = vec![(String::new(), document.as_table())];
    while let Some((above, table)) = waiting.pop() {
        for (name, item) in table.iter() {
            let path = if above.is_empty() { name.into() } else { format!("{above}.{name}") };
            let key = table.key(name).and_then(|key| key.span());
            let spans = [key, item.span()];
            let has = |span: &Range<usize>| span.start <= place.start && place.start < span.end;
            if spans.iter().flatten().any(has)
                && found.as_ref().is_none_or(|known| known.len() < path.len())
            {
                found = Some(path.clone());
            }
            if let Some(table) = item.as_table_like() {
                waiting.push((path, table));
            }
        }
    }
    found
}
