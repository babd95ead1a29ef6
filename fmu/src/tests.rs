//! Tests of the units as they are described.

use crate::{Interface, Log, units};

#[test]
fn both_model_descriptions_are_well_formed_and_name_each_variable_once() {
    for unit in units() {
        let description = unit.describe();
        for xml in [description.fmi2(), description.fmi3(), description.terminals()] {
            let document = roxmltree::Document::parse(&xml).expect("well-formed");
            let mut names: Vec<&str> = document.descendants().filter_map(|node| node.attribute("name")).collect();
            let variables: Vec<&str> = description.variables.iter().map(|each| each.name.as_str()).collect();
            names.retain(|name| variables.contains(name));
            let count = names.len();
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), count, "{}", unit.name);
        }
    }
}

#[test]
fn a_reset_unit_is_a_new_one() {
    for unit in units() {
        let held = Interface::CoSimulation { event_mode: false, early_return: false };
        let mut used = unit.instantiate(held, None, Log::new(None, false));
        let run = |instance: &mut dyn crate::Component| {
            instance.enter_initialization().unwrap();
            instance.exit_initialization().unwrap();
            instance.do_step(0.0, 10.0).unwrap();
            let handle = instance.save(0).unwrap();
            instance.serialise(handle).unwrap()
        };
        let first = run(&mut *used);
        used.reset().unwrap();
        assert_eq!(run(&mut *used), first, "{}", unit.name);
    }
}
