//! Sums, extremes and counts over the particles of all ranks, whoever has them.

use super::{led, setup};
use sphorge::engine::reduction::Suspicion;
use sphorge::engine::{Cpu, EngineKind, ParticleSource, Quantity, Reduction, Simulation};
use sphorge::model::{Extremum, ParticleSelection};

/// What is found after some steps of a deck, of all kinds of questions.
fn found(kind: &dyn EngineKind, deck: &str, changes: &[(&str, &str)]) -> Vec<(String, Vec<f64>)> {
    let setup = setup(deck, changes);
    kind.take_deck("a-deck", &setup.deck_text);
    let mut simulation = Simulation::start(kind, setup.model, setup.particles).unwrap();
    for _ in 0..20 {
        simulation.step(None).unwrap();
    }
    let window = Some(([-0.02, -0.02, -1.0], [0.03, 0.01, 1.0]));
    let selections = [
        ParticleSelection::default(),
        ParticleSelection { body: Some(1), ..ParticleSelection::default() },
        ParticleSelection { window, ..ParticleSelection::default() },
        // Nobody.
        ParticleSelection { window: Some(([9.0; 3], [9.1; 3])), ..ParticleSelection::default() },
    ];
    let quantities = [
        Quantity { field: "velocity", component: Some(0) },
        Quantity { field: "von_mises_stress", component: None },
        Quantity { field: "velocity", component: Some(7) },
        Quantity { field: "density", component: None },
    ];
    let point = [3e-3, -2e-3, 0.0];
    let mut asked = vec![
        Reduction::Nearest { point, body: None },
        Reduction::Nearest { point, body: Some(1) },
        Reduction::Nearest { point, body: Some(7) },
    ];
    let limits = [
        Suspicion::Cold(293.2),
        Suspicion::Hot(0.5),
        Suspicion::MissingHeat(0.99),
        Suspicion::Compressed(1e-5),
        Suspicion::Expanded(0.9999),
        Suspicion::Away { low: [f64::NEG_INFINITY; 3], high: [0.01, 0.0, f64::INFINITY], limit: 1e-3 },
        Suspicion::Behind { limit: 0.1, breaks: false },
        Suspicion::Lonely,
        Suspicion::Apart,
        Suspicion::Paired,
        Suspicion::Torn,
        Suspicion::Inside { faces: false, breaks: false },
    ];
    asked.extend(limits.map(Reduction::Suspects));
    for of in &selections {
        asked.extend((0..3).map(|axis| Reduction::Extent { of, axis }));
        asked.extend((0..3).map(|axis| Reduction::Diameter { of, axis }));
        for quantity in quantities {
            asked.push(Reduction::Extremum { of, quantity, extremum: Extremum::Maximum });
            asked.push(Reduction::Extremum { of, quantity, extremum: Extremum::Minimum });
            asked.push(Reduction::Mean { of, quantity });
            asked.push(Reduction::Interpolation { of, quantity, point });
            asked.push(Reduction::Slabs { of, quantity, axis: 1, direction: -1.0 });
        }
    }
    asked.extend([0, 7, 400, 1_000_000].map(|id| Reduction::OfParticle { id, quantity: quantities[1] }));
    asked.iter().map(|asked| (format!("{asked:?}"), simulation.reduce(asked).unwrap())).collect()
}

#[test]
fn what_is_asked_of_the_particles_is_told_to_the_bit() {
    let coarse = [("particles.spacing", "\"24 mm\""), ("body.1.spacing", "\"12 mm\"")];
    for (deck, changes) in [
        ("bullet", &coarse[..]),
        ("penetration", &[("particles.spacing", "\"0.6 mm\""), ("time.step-control.repeats", "0")]),
    ] {
        let alone = found(&Cpu, deck, changes);
        let with_suspects =
            |found: &&(String, Vec<f64>)| found.0.starts_with("Suspects") && found.1[1] + found.1[8] > 0.0;
        assert!(alone.iter().filter(with_suspects).count() >= 4, "{alone:?}");
        assert!(alone.iter().filter(|found| found.1.is_empty()).count() > 10);
        for ranks in [2, 3, 5] {
            for (together, alone) in led(ranks, 1, |leader| found(leader, deck, changes)).iter().zip(&alone) {
                let bits = |found: &(String, Vec<f64>)| found.1.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                assert!(bits(together) == bits(alone), "{together:?} on {ranks} ranks, {:?} alone", alone.1);
            }
        }
    }
}
