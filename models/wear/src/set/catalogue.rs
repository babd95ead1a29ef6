//! What the parameter sets of a process may hold.

use toolroom_process::Field;

/// The parameter sets of one process: shipped ones, and the groups that every set has.
#[derive(Debug)]
pub struct Catalogue {
    /// The process in files, `turning` or `milling`.
    pub process: &'static str,
    /// Shipped sets: name and file.
    pub sets: &'static [(&'static str, &'static str)],
    /// Groups of parameters; of those that are laws a set has one.
    pub groups: &'static [Group],
}

/// A group of parameters.
#[derive(Debug)]
pub struct Group {
    /// Name in files, `[parameters.NAME]`.
    pub name: &'static str,
    /// Its parameters.
    pub fields: &'static [Field],
    /// Whether it is one of several laws of wear.
    pub law: bool,
    /// Parameters that a file may leave out; their defaults are assumed then.
    pub assumed: &'static [&'static str],
}

impl Catalogue {
    /// The group of this name.
    pub fn group(&self, name: &str) -> Option<&'static Group> {
        self.groups.iter().find(|group| group.name == name)
    }

    /// The parameter `group.name`.
    pub fn field(&self, group: &str, name: &str) -> Option<&'static Field> {
        self.group(group)?.fields.iter().find(|field| field.name == name)
    }

    /// Names of the laws of wear, known while compiling.
    ///
    /// # Panics
    /// Where `N` is not their number.
    pub(super) const fn law_names<const N: usize>(&self) -> [&'static str; N] {
        let mut names = [""; N];
        let (mut index, mut count) = (0, 0);
        while index < self.groups.len() {
            if self.groups[index].law {
                names[count] = self.groups[index].name;
                count += 1;
            }
            index += 1;
        }
        assert!(count == N);
        names
    }

    /// Names of the laws of wear, where sets of the process choose one.
    pub fn laws(&self) -> impl Iterator<Item = &'static str> {
        self.groups.iter().filter(|group| group.law).map(|group| group.name)
    }
}
