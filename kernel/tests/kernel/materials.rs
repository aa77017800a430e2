//! Materials: the table of laws, and what a world of several is refused for.

use bitgrain_kernel::contact::{HertzTsuji, Law, PairLaws};
use bitgrain_kernel::{Domain, Error, Group, Obstacle, Store, start, step};

use crate::common::crowd::{history, tsuji};

#[test]
fn a_table_holds_each_pair_in_either_order() {
    type Table<'a> = PairLaws<'a, HertzTsuji<f64>>;
    let pairs: Vec<_> = Table::pairs(3).collect();
    assert_eq!(pairs, [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]]);
    for materials in 1..=255 {
        let own = |[a, b]: [u8; 2]| HertzTsuji {
            mu: f64::from(a) + 1e3 * f64::from(b),
            ..tsuji()
        };
        let laws: Vec<_> = Table::pairs(materials).map(own).collect();
        let table = Table::new(materials, &laws).unwrap();
        for [a, b] in Table::pairs(materials) {
            assert_eq!(
                (*table.of([a, b]), *table.of([b, a])),
                (own([a, b]), own([a, b]))
            );
        }
        assert_eq!(Law::<f64>::materials(&table), usize::from(materials));
        // As many laws as pairs, and at least one.
        assert_eq!(Table::new(materials, &laws[1..]), None);
        assert_eq!(Table::new(materials - 1, &laws), None);
    }
    let laws = [tsuji(); 3];
    let table = Table::new(2, &laws).unwrap();
    for unknown in [[0, 2], [255, 0], [255, 255], [2, 1]] {
        assert_eq!(*table.of(unknown), tsuji());
    }
    assert_eq!(Law::<f64>::materials(&tsuji()), 1);
}

/// Two bodies of one material have the law of that material to the bit, and of two the mean compliance.
#[test]
fn two_materials_have_the_sum_of_their_compliances() {
    let [soft, hard] = [[5e6, 0.45], [2e11, 0.3]];
    let law = |a, b| HertzTsuji::<f64>::between([a, b], 0.6, 0.5);
    assert_eq!(law(soft, soft), tsuji());
    assert_eq!(law(soft, hard), law(hard, soft));
    // Against a rigid body a material is twice as stiff as against itself; steel is as good as rigid within 1e-4.
    let (own, on_steel) = (law(soft, soft), law(soft, hard));
    for (twice, once) in [(on_steel.kn, own.kn), (on_steel.kt, own.kt)] {
        assert!((twice / once - 2.0).abs() < 2e-4, "{twice} {once}");
    }
    // The damping follows from the stiffness: its ratio to the root of it is that of the restitution alone.
    assert!((on_steel.cn / on_steel.kn.sqrt() / (own.cn / own.kn.sqrt()) - 1.0).abs() < 1e-15);
}

#[test]
fn a_material_that_the_law_does_not_know_is_refused() {
    let laws = [history(0.3); 3];
    let table = PairLaws::new(2, &laws).unwrap();
    for (group, body, fault) in [
        (0, 0, None),
        (1, 1, None),
        (2, 0, Some(2)),
        (0, 200, Some(200)),
    ] {
        let mut store = Store::<f64, 1, 4, 1, 1>::new(Domain::open(), 1e-4, 0.1);
        let free = Group::free([0.0, 0.0, -1.0]).of_material(group);
        store.add_group(free).unwrap();
        let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
        let floor = Obstacle {
            material: body,
            ..floor
        };
        store.add_obstacle(floor).unwrap();
        store.add_grain(1, 0, [0.0, 0.0, 0.6], 0.5, 0.5).unwrap();
        let mut world = store.world();
        let fault = fault.map_or(Ok(()), |material| Err(Error::UnknownMaterial { material }));
        assert_eq!(start(&mut world, &table), fault);
        // A law that tells none apart knows all of them.
        if fault.is_err() {
            assert_eq!(step(&mut world, &table), Err(Error::NotStarted));
            assert_eq!(start(&mut world, &history(0.3)), Ok(()));
        }
    }
}
