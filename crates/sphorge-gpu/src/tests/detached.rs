//! Fields that are copied out while the GPU goes on.

use super::card::gpu;
use super::engine::{IRON, components, start};
use sphorge_engine::FieldSource;
use sphorge_engine::particles::FIELDS;

#[test]
fn detached_fields_do_not_change_with_later_steps() {
    let renewal = ("search.total-lagrangian.renewal", "1.1");
    let new = || start(&gpu(), IRON.0, &[IRON.1[0], IRON.1[1], renewal]);
    let (mut plain, mut going_on) = (new(), new());
    for step in 0..40 {
        for simulation in [&mut plain, &mut going_on] {
            simulation.step(None).unwrap();
        }
        // Before and after the reference configuration is renewed, and where fields were read before.
        if step % 13 != 12 {
            continue;
        }
        if step == 25 {
            going_on.ledger().unwrap();
        }
        let detached = going_on.detach().unwrap().expect("a card");
        let there = {
            let copied = std::thread::spawn(move || {
                let read = |name: &str| components(&detached.read(name).unwrap());
                assert!(detached.read("nonsense").is_err());
                (detached.count(), FIELDS.iter().map(|field| read(field.name)).collect::<Vec<_>>())
            });
            going_on.step(None).unwrap();
            copied.join().unwrap()
        };
        assert_eq!(there.0, plain.count());
        for (field, there) in FIELDS.iter().zip(&there.1) {
            assert!(&components(&plain.read(field.name).unwrap()) == there, "{}", field.name);
        }
        plain.step(None).unwrap();
    }
}
