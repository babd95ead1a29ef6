//! `--set machine.L1.tool_change_time="1 min"`: one value of the file replaced before it is read.

use crate::fault::{Fault, nearest};
use crate::form::{Form, Kind, Need};
use crate::section::Span;
use crate::walk::{Walk, table_form};
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// Puts `text` (`path=value`) into `root`, a file of `form`; its bytes count from `base` on.
pub(crate) fn apply<'d>(walk: &mut Walk, form: &'static Form, root: &mut DeTable<'d>, text: &'d str, base: usize) {
    let whole = base..base + text.len();
    let Some((path, value)) = text.split_once('=') else {
        walk.fault(whole, Fault::OverrideForm { read: text.to_owned() });
        return;
    };
    let Some(path) = segments(path) else {
        walk.fault(whole, Fault::OverrideForm { read: text.to_owned() });
        return;
    };
    let start = base + text.len() - value.len();
    let span = start..start + value.len();
    let value = literal(value.trim(), span.clone());
    insert(walk, Some(form), root, &path, value, whole);
}

/// A TOML literal where the text is one, else the text itself: quotes do not survive a shell.
fn literal(text: &str, span: Span) -> Spanned<DeValue<'_>> {
    let value = match DeValue::parse(text) {
        Ok(value) if !matches!(value.get_ref(), DeValue::Datetime(_)) => value.into_inner(),
        _ => DeValue::String(text.into()),
    };
    Spanned::new(span, value)
}

/// `machine."L 1".rate` to its segments.
fn segments(path: &str) -> Option<Vec<String>> {
    let text = format!("{} = 0", path.trim());
    let root = DeTable::parse(&text).ok()?;
    let mut segments = Vec::new();
    let mut table = root.get_ref();
    while let Some((key, value)) = table.iter().next() {
        segments.push(key.get_ref().to_string());
        let DeValue::Table(inner) = value.get_ref() else { return Some(segments) };
        table = inner;
    }
    None
}

fn insert<'d>(
    walk: &mut Walk,
    form: Option<&'static Form>,
    table: &mut DeTable<'d>,
    path: &[String],
    value: Spanned<DeValue<'d>>,
    whole: Span,
) {
    let [segment, rest @ ..] = path else { return };
    let inside = form.and_then(|form| table_form(form, segment));
    if rest.is_empty() {
        // An empty key span: the override's own text is the place of an unknown key.
        let key = Spanned::new(value.span().start..value.span().start, segment.clone().into());
        table.remove(segment.as_str());
        table.insert(key, value);
        return;
    }
    if let Some(entry) = form.and_then(|form| called(form, segment)).filter(|_| rest.len() <= 2) {
        let list = table
            .entry(Spanned::new(whole.start..whole.start, segment.clone().into()))
            .or_insert_with(|| Spanned::new(whole.clone(), DeValue::Array(DeArray::default())));
        if let DeValue::Array(list) = list.get_mut() {
            set_entry(list, entry, rest, value, whole);
            return;
        }
    }
    let known: Vec<String> = table.keys().map(|key| key.get_ref().to_string()).collect();
    let Some(inner) = table.get_mut(segment.as_str()) else {
        // A section that the file leaves out, such as [dispatch].
        let entries = form.and_then(|form| form.key(segment)).is_some_and(|key| matches!(key.kind, Kind::Tables(_)));
        if rest.len() == 1 && !entries {
            let key = Spanned::new(whole.start..whole.start, segment.clone().into());
            let mut section = DeTable::new();
            insert(walk, inside, &mut section, rest, value, whole.clone());
            table.insert(key, Spanned::new(whole, DeValue::Table(section)));
        } else {
            walk.fault(whole, not_found(segment, &known));
        }
        return;
    };
    descend(walk, inside, inner.get_mut(), (segment, rest), value, whole);
}

/// The keys of the entries of a list that the kind of file reads itself, where `--set` calls them.
fn called(form: &Form, key: &str) -> Option<[&'static str; 2]> {
    if let Kind::Content(content) = form.key(key)?.kind { content.entry } else { None }
}

/// Sets `rest`, the name of an entry and perhaps one of its keys.
fn set_entry<'d>(
    list: &mut DeArray<'d>,
    [name, main]: [&'static str; 2],
    rest: &[String],
    value: Spanned<DeValue<'d>>,
    whole: Span,
) {
    let key = |text: &str| Spanned::new(value.span().start..value.span().start, text.to_owned().into());
    let wanted = &rest[0];
    let named = |entry: &Spanned<DeValue<'d>>| {
        entry.get_ref().as_table().and_then(|table| table.get(name)?.get_ref().as_str()) == Some(wanted)
    };
    let index = list.iter().position(named).unwrap_or_else(|| {
        let mut entry = DeTable::new();
        entry.insert(key(name), Spanned::new(whole.clone(), DeValue::String(wanted.clone().into())));
        list.push(Spanned::new(whole.clone(), DeValue::Table(entry)));
        list.len() - 1
    });
    let set = key(rest.get(1).map_or(main, String::as_str));
    if let Some(DeValue::Table(entry)) = list.get_mut(index).map(Spanned::get_mut) {
        entry.remove(set.get_ref().as_ref());
        entry.insert(set, value);
    }
}

#[expect(clippy::wildcard_enum_match_arm, reason = "of TOML's values only tables and lists have something inside")]
fn descend<'d>(
    walk: &mut Walk,
    form: Option<&'static Form>,
    inner: &mut DeValue<'d>,
    (segment, rest): (&str, &[String]),
    value: Spanned<DeValue<'d>>,
    whole: Span,
) {
    match inner {
        DeValue::Table(inner) => insert(walk, form, inner, rest, value, whole),
        DeValue::Array(entries) => {
            let [wanted, rest @ ..] = rest else { return };
            // `pass.tolerance`: a key of every entry.
            if rest.is_empty() && form.is_some_and(|form| form.key(wanted).is_some()) {
                for entry in entries.iter_mut().map(Spanned::get_mut) {
                    if let DeValue::Table(entry) = entry {
                        insert(walk, form, entry, std::slice::from_ref(wanted), value.clone(), whole.clone());
                    }
                }
                return;
            }
            let referred = form.and_then(reference);
            let names: Vec<String> = entries
                .iter()
                .enumerate()
                .map(|(i, entry)| {
                    let name = entry.get_ref().as_table().and_then(|table| {
                        table.get("name").or_else(|| table.get(referred?))?.get_ref().as_str().map(str::to_owned)
                    });
                    name.unwrap_or_else(|| (i + 1).to_string())
                })
                .collect();
            let index = names.iter().position(|name| name == wanted).or_else(|| {
                let number: usize = wanted.parse().ok()?;
                number.checked_sub(1).filter(|index| *index < names.len())
            });
            match index.and_then(|index| entries.get_mut(index)).map(Spanned::get_mut) {
                Some(DeValue::Table(entry)) if !rest.is_empty() => insert(walk, form, entry, rest, value, whole),
                _ => walk.fault(whole, not_found(wanted, &names)),
            }
        }
        _ => walk.fault(whole, not_found(segment, &[])),
    }
}

/// The key by which entries without a name are called: what each of them has to refer to.
fn reference(form: &'static Form) -> Option<&'static str> {
    let mut keys = form.keys.iter();
    keys.find(|key| matches!((key.kind, key.need), (Kind::Reference(_), Need::Required))).map(|key| key.name)
}

fn not_found(segment: &str, known: &[String]) -> Fault {
    Fault::OverridePath {
        segment: segment.to_owned(),
        nearest: nearest(segment, known.iter().map(String::as_str)).map(str::to_owned),
        known: known.join(", "),
    }
}
