//! Mutants of materials.

use super::list::Mutant;

pub const MATERIALS: &[Mutant] = &[
    Mutant {
        name: "all grains are of one material",
        file: "kernel/src/state/grains.rs",
        from: "group.map_or(0, |group| group.material)",
        to: "group.map_or(0, |_| 0)",
        target: "oracle",
        red: &["the_step_equals_its_definition_of_several_materials"],
    },
    Mutant {
        name: "an obstacle is of the grain's material",
        file: "kernel/src/forces/obstacle_contacts.rs",
        from: ", i), body.material],",
        to: ", i); 2],",
        target: "oracle",
        red: &["the_step_equals_its_definition_of_several_materials"],
    },
    Mutant {
        name: "a pair has the law of its first material",
        file: "kernel/src/contact/pair_laws.rs",
        from: "let (low, high) = if a < b { (a, b) } else { (b, a) };",
        to: "let (low, high) = if a < b { (a, a) } else { (b, b) };",
        target: "materials",
        red: &["a_table_holds_each_pair_in_either_order"],
    },
    Mutant {
        name: "sliding is of another pair than pressing",
        file: "kernel/src/contact/pair_laws.rs",
        from: "self.of(state.contact.materials)\n            .tangential_force(normal, state)",
        to: "self.of([0; 2])\n            .tangential_force(normal, state)",
        target: "oracle",
        red: &["the_step_equals_its_definition_of_several_materials"],
    },
    Mutant {
        name: "a saved group forgets its material",
        file: "kernel/src/saved/write.rs",
        from: "u32::from(group.material) << GROUP_MATERIAL;",
        to: "u32::from(group.material & 0) << GROUP_MATERIAL;",
        target: "saved",
        red: &["open_space_and_every_shape_are_saved"],
    },
];
