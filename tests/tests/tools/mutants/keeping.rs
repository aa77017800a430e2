//! Mutants of what laws keep of contacts, of laws that act at a distance, and of rolling.

use super::list::Mutant;

const ROLLING: &[&str] = &["the_step_equals_its_definition_of_laws_that_resist_rolling"];

pub const KEEPING: &[Mutant] = &[
    Mutant {
        name: "pairs lose their words as they are picked again",
        file: "kernel/src/neighbors/prune.rs",
        from: "    list.spring.iter().chain(words).map(|column| &**column)",
        to: "    list.spring.iter().chain(words.take(0)).map(|column| &**column)",
        target: "oracle",
        red: ROLLING,
    },
    Mutant {
        name: "contacts with obstacles keep no words",
        file: "kernel/src/forces/obstacle_contacts.rs",
        from: "            put(&mut touch.memory, t, r.kept.memory);",
        to: "            put(&mut touch.memory, t, memory);",
        target: "oracle",
        red: ROLLING,
    },
    Mutant {
        name: "a torque acts on both grains alike",
        file: "kernel/src/forces/accumulate.rs",
        from: "            sub_at(grains.torque, j, torque);",
        to: "            add_at(grains.torque, j, torque);",
        target: "oracle",
        red: ROLLING,
    },
    Mutant {
        name: "an obstacle does not feel what rolls on it",
        file: "kernel/src/forces/obstacle_contacts.rs",
        from: "            moment = add(moment, r.torque);",
        to: "            moment = add(moment, scale(r.torque, R::ZERO));",
        target: "oracle",
        red: ROLLING,
    },
    Mutant {
        name: "pairs act only if they overlap",
        file: "kernel/src/contact/block.rs",
        from: "            true => self.acts[k],",
        to: "            true => self.overlap[k] > R::ZERO,",
        target: "oracle",
        red: &["the_step_equals_its_definition_of_a_law_that_acts_at_a_distance"],
    },
    Mutant {
        name: "pairs are listed as if no law reached beyond touching",
        file: "kernel/src/phases.rs",
        from: "    clock.slack = found.slack + clock.reach;",
        to: "    clock.slack = found.slack;",
        target: "oracle",
        red: &["the_step_equals_its_definition_of_a_law_that_acts_at_a_distance"],
    },
    Mutant {
        name: "a digest does not see words",
        file: "kernel/src/digest/state.rs",
        from: "            if words > 0 {",
        to: "            if words > 8 {",
        target: "keeping",
        red: &["every_word_is_in_the_digest"],
    },
    Mutant {
        name: "a saved world forgets how far its law reaches",
        file: "kernel/src/saved/write.rs",
        from: "            self.number(world.clock.reach);",
        to: "            self.number(R::ZERO);",
        target: "keeping",
        red: &["laws_that_keep_words_keep_their_bits"],
    },
    Mutant {
        name: "a law without storage for its words is started",
        file: "kernel/src/forces/accumulate.rs",
        from: "        misfit: !has_room,",
        to: "        misfit: false,",
        target: "keeping",
        red: &["storage_without_room_for_words_is_refused"],
    },
];
