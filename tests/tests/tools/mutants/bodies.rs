//! Mutants of rigid bodies.

use super::list::{Mutant, UNIT};

pub const BODIES: &[Mutant] = &[
    Mutant {
        name: "a bar is curved although nobody asks for it",
        file: "kernel/src/state/obstacle.rs",
        from: "_ if self.curved => meeting.curvature,",
        to: "_ if true => meeting.curvature,",
        target: "oracle",
        red: &["the_step_equals_its_definition_hertz_tsuji"],
    },
    Mutant {
        name: "a turned body is met as if it were upright",
        file: "kernel/src/state/obstacle.rs",
        from: "self.shape.meet(surface, to_body(q, offset), radius)",
        to: "self.shape.meet(surface, offset, radius)",
        target: "oracle",
        red: &["the_step_equals_its_definition_hertz_tsuji"],
    },
    Mutant {
        name: "a surface that turns moves as its middle",
        file: "kernel/src/state/obstacle.rs",
        from: "(add(velocity, cross(spin, nearest)), [R::ZERO; 3])",
        to: "(add(velocity, cross(spin, sub(nearest, nearest))), [R::ZERO; 3])",
        target: "oracle",
        red: &["the_step_equals_its_definition_hertz_tsuji"],
    },
    Mutant {
        name: "a free body takes only half of its kicks",
        file: "kernel/src/phases.rs",
        from: "    for body in world.obstacles.iter_mut() {\n        body.kick(world.dt);\n    }\n    go_on",
        to: "    go_on",
        target: "oracle",
        red: &["the_step_equals_its_definition_hertz_tsuji"],
    },
    Mutant {
        name: "angular momentum turns with the body",
        file: "kernel/src/state/rigid_body.rs",
        from: "w[B] = (lb * cosine + lc * sine) / inertia[B];\n    w[C] = (lc * cosine - lb * sine) / inertia[C];",
        to: "w[B] = (lb * cosine - lc * sine) / inertia[B];\n    w[C] = (lc * cosine + lb * sine) / inertia[C];",
        target: UNIT,
        red: &["state::rigid_body::tests::a_hundred_turns_keep_energy_and_momentum"],
    },
    Mutant {
        name: "a hollow crease counts twice",
        file: "kernel/src/state/mesh.rs",
        from: "    R::ONE - part * (depth * depth.sqrt())",
        to: "    R::ONE - part * (depth * R::ZERO)",
        target: "meshes",
        red: &["the_force_has_no_jump_over_a_crease"],
    },
    Mutant {
        name: "an edge counts for each of its triangles",
        file: "kernel/src/state/mesh.rs",
        from: "Feature::Edge(edge) if edge == [a, b] => other < number,",
        to: "Feature::Edge(edge) if edge == [a, b] => false,",
        target: "meshes",
        red: &["a_hollow_has_two_contacts_and_a_ridge_one"],
    },
    Mutant {
        name: "triangles stay in the order of the file",
        file: "kernel/src/state/mesh.rs",
        from: "first < second || first == second && precedes(a, b)",
        to: "false && (first < second || first == second && precedes(a, b))",
        target: "meshes",
        red: &["the_order_of_triangles_says_nothing"],
    },
    Mutant {
        name: "a contact that passes to the next triangle begins anew",
        file: "kernel/src/forces/mesh_histories.rs",
        from: "set(springs, t, spring);",
        to: "set(springs, t, spring.map(|x| x * R::ZERO));",
        target: "meshes",
        red: &["springs_go_along_over_flat_triangles"],
    },
];
