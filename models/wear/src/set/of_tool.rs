//! What the section of a tool states beside the set that it names: constants of a handbook, values of another wear law.

use super::fault::SetFault;
use super::values::{Placed, Values};
use super::{Catalogue, Group, Origin, ParameterSet, ParameterValue, read};
use toml::de::{DeTable, DeValue};
use toolroom_form::{Echo, Fault, Quantity, Section, Value, Walk, nearest};

impl ParameterSet {
    /// The set of a tool, or of a study of tool lives, whose section states more than the set that it names. Constants under
    /// `handbook` ([`HANDBOOK`](crate::HANDBOOK)) are converted as those of a file; `parameters` holds values group by group,
    /// without sources, and the group of another wear law makes that the law. A set whose law stays and that has no such
    /// constants is as before: the values of its groups are left to [`set_parameters`](toolroom_form::set_parameters).
    ///
    /// `None` where a fault was noted: constants or values at fault, several laws, values that the law lacks.
    pub fn of_tool(self, walk: &mut Walk, section: &Section<'_>, catalogue: &'static Catalogue) -> Option<Self> {
        let Some(groups) = groups(section) else {
            return if section.given("handbook") {
                self.with(walk, section, catalogue, Values::new())
            } else {
                Some(self)
            };
        };
        let laws: Vec<&'static str> = catalogue.laws().filter(|law| groups.contains_key(*law)).collect();
        if !section.given("handbook") && laws.iter().all(|law| self.law == Some(law)) {
            return Some(self);
        }
        if let [_, _, ..] = laws[..] {
            let laws = laws.join(", ");
            let reason =
                format!("`parameters` has values of several wear laws ({laws}), and a tool has one: keep one of them");
            walk.fault(section.span_of("parameters"), SetFault::Implausible(reason));
            return None;
        }
        let values = values(walk, section, groups, catalogue)?;
        self.with(walk, section, catalogue, values)
    }

    /// The set under another wear law of its catalogue. Values of that law which the set does not hold beside its own are not
    /// numbers (NaN): they are still to be stated.
    #[must_use]
    pub fn under_law(mut self, law: &'static str, catalogue: &'static Catalogue) -> Self {
        if self.law.replace(law) == Some(law) {
            return self;
        }
        let held: Vec<ParameterValue> = self.values.drain(..).chain(self.unused.drain(..)).collect();
        for group in catalogue.groups {
            for field in group.fields {
                let found = held.iter().find(|value| value.group == group.name && value.field.name == field.name);
                let (origin, source) = (Origin::Given, String::new());
                let due = || ParameterValue { group: group.name, field, value: f64::NAN, origin, source };
                match found.cloned() {
                    Some(value) if group.law && group.name != law => self.unused.push(value),
                    Some(value) => self.values.push(value),
                    None if group.name == law => self.values.push(due()),
                    None => {}
                }
            }
        }
        self
    }

    fn with(
        self,
        walk: &mut Walk,
        section: &Section<'_>,
        catalogue: &'static Catalogue,
        values: Values,
    ) -> Option<Self> {
        let (faults, before) = (walk.problems.len(), self.law);
        let set = read::merged(walk, section, catalogue, (values, faults), Some(self))?;
        if walk.problems.len() > faults {
            return None;
        }
        for value in &set.values {
            let default = value.origin == Origin::Assumed && Some(value.group) == set.law && set.law != before;
            if default || value.origin == Origin::Handbook {
                let (key, shown) = (value.key(), value.shown());
                let span = section.span_of(if default { "parameters" } else { "handbook" });
                walk.echo.push(Echo { section: section.path.clone(), key, value: shown, span, default });
            }
        }
        Some(set)
    }
}

/// The table `parameters`, where it is one.
fn groups<'s, 'd>(section: &'s Section<'d>) -> Option<&'s DeTable<'d>> {
    match section.got("parameters").map(|got| &got.value) {
        Some(Value::Raw(DeValue::Table(groups))) => Some(groups),
        _ => None,
    }
}

/// The values of `parameters` that belong to groups of sets; those at fault are noted.
fn values(
    walk: &mut Walk,
    section: &Section<'_>,
    groups: &DeTable<'_>,
    catalogue: &'static Catalogue,
) -> Option<Values> {
    let (faults, echoes) = (walk.problems.len(), walk.echo.len());
    let mut values = Values::new();
    for group in catalogue.groups {
        let Some(DeValue::Table(entries)) = groups.get(group.name).map(|entries| entries.get_ref()) else { continue };
        for (key, raw) in entries {
            let Some(field) = group.fields.iter().find(|field| field.name == &**key.get_ref()) else {
                walk.fault(key.span(), unknown(section, group, key.get_ref()));
                continue;
            };
            if let Value::Si(value) = walk.quantity(field.name, &Quantity::of(field), raw) {
                let source = format!("stated for {}", section.path);
                values.insert(
                    (group.name, field.name),
                    Placed { value, source, origin: Origin::Given, span: raw.span() },
                );
            }
        }
    }
    walk.echo.truncate(echoes); // told where the values are set
    (walk.problems.len() == faults).then_some(values)
}

fn unknown(section: &Section<'_>, group: &Group, key: &str) -> Fault {
    let names = || group.fields.iter().map(|field| field.name);
    let known = names().collect::<Vec<_>>().join(", ");
    // Constants as handbooks print them have a key of their own.
    let handbook = if group.name == "extended_taylor" { "; C, m, n of handbooks stand under `handbook`" } else { "" };
    Fault::UnknownKey {
        section: format!("{}, parameters, {}", section.path, group.name),
        key: key.to_owned(),
        nearest: nearest(key, names()),
        known: known + handbook,
    }
}
