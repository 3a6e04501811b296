//! Replaces values that cannot be read, so that the rest of the deck can be read.

use crate::deck::keys;
use crate::deck::keys::{LISTS, NAMED};
use std::borrow::Cow;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// A valid value for `path`: that of the example of its key. Errors about it point at `span`.
pub(super) fn of(path: &str, span: &Range<usize>) -> Option<Spanned<DeValue<'static>>> {
    let mut named: Vec<&str> = path.split('.').collect();
    let mut indices = Vec::new();
    while let Some(index) = named.last().and_then(|part| part.parse::<usize>().ok()) {
        indices.push(index);
        named.pop();
    }
    let empty = DeValue::Table(DeTable::new());
    let entry = LISTS.contains(&named[..].join(".").as_str()) && indices.len() == 1;
    let table = named.len() == 2 && NAMED.contains(&named[0]);
    if entry || table {
        return Some(Spanned::new(span.clone(), empty));
    }
    let line = keys::line_at(&named.join("."))?;
    if line.starts_with('[') {
        return Some(Spanned::new(span.clone(), empty));
    }
    let example = DeTable::parse(line).ok()?.into_inner();
    let mut value = example.into_iter().next()?.1;
    for index in indices.into_iter().rev() {
        value = match value.into_inner() {
            DeValue::Array(items) => {
                let last = items.len().checked_sub(1)?;
                items.into_iter().nth(index.min(last))?
            }
            single => Spanned::new(span.clone(), single),
        };
    }
    Some(placed(value, span))
}

/// Gives a value and its parts the position `span`.
fn placed(value: Spanned<DeValue<'static>>, span: &Range<usize>) -> Spanned<DeValue<'static>> {
    let value = match value.into_inner() {
        DeValue::Array(items) => {
            DeValue::Array(items.into_iter().map(|item| placed(item, span)).collect())
        }
        DeValue::Table(table) => {
            let entry = |(key, value): (Spanned<Cow<'static, str>>, Spanned<DeValue<'static>>)| {
                let key = Spanned::new(span.clone(), key.into_inner());
                (key, placed(value, span))
            };
            DeValue::Table(table.into_iter().map(entry).collect())
        }
        plain => plain,
    };
    Spanned::new(span.clone(), value)
}

/// Sets the value at a dotted path; returns false if the path does not exist.
pub(super) fn set<'a>(root: &mut DeTable<'a>, path: &str, value: Spanned<DeValue<'a>>) -> bool {
    let (above, name) = path.rsplit_once('.').unwrap_or(("", path));
    let span = value.span();
    match inside(root, above) {
        Some(Inside::Table(table)) => {
            table.remove(name);
            table.insert(Spanned::new(span, Cow::Owned(name.to_owned())), value);
            true
        }
        Some(Inside::Array(items)) => {
            let item = name.parse::<usize>().ok().and_then(|i| items.get_mut(i));
            item.map(|item| *item = value).is_some()
        }
        None => false,
    }
}

/// Removes the key at a dotted path; returns false if it does not exist.
pub(super) fn take_away(root: &mut DeTable<'_>, path: &str) -> bool {
    let (above, name) = path.rsplit_once('.').unwrap_or(("", path));
    match inside(root, above) {
        Some(Inside::Table(table)) => table.remove(name).is_some(),
        _ => false,
    }
}

/// Container of a key.
enum Inside<'t, 'a> {
    Table(&'t mut DeTable<'a>),
    Array(&'t mut DeArray<'a>),
}

fn inside<'t, 'a>(root: &'t mut DeTable<'a>, path: &str) -> Option<Inside<'t, 'a>> {
    if path.is_empty() {
        return Some(Inside::Table(root));
    }
    let mut parts = path.split('.');
    let mut value = root.get_mut(parts.next()?)?;
    for part in parts {
        value = match value.get_mut() {
            DeValue::Table(table) => table.get_mut(part)?,
            DeValue::Array(items) => items.get_mut(part.parse::<usize>().ok()?)?,
            _ => return None,
        };
    }
    match value.get_mut() {
        DeValue::Table(table) => Some(Inside::Table(table)),
        DeValue::Array(items) => Some(Inside::Array(items)),
        _ => None,
    }
}
