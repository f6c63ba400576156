//! Columns of the history that tracers and sections make.
//!
//! - A tracer follows the particle that was nearest to its point in the initial configuration. A fixed one stays at its point
//!   and interpolates, `sum (m/rho) f W / sum (m/rho) W` (Shepard); it has no value where no kernel reaches.
//! - The force through a section is the sum of the forces of the pairs whose particles stand on either side of its plane, all of
//!   them: what the material ahead exerts on that behind, and what a grip has to hold, however far the material is stretched. It
//!   comes from pairs of up to two smoothing lengths about the plane, which is its resolution.

use crate::{
    engine::{
        ParticleSource, Quantity, Reduction, RunFailure,
        persist::{Archive, ArchiveError, Persist, persist_column},
    },
    model::{Model, ParticleSelection, Tracer},
    output::HistoryColumn,
    particles::{ColumnKind, find_field},
};

/// What tracers and sections say of one moment.
#[derive(Clone, Debug)]
pub(crate) struct Observed {
    columns: Vec<HistoryColumn>,
    values: Vec<Option<f64>>,
    /// Particle followed by each tracer, by its id.
    followed: Vec<Option<u32>>,
    /// Particles that each tracer is of.
    selections: Vec<ParticleSelection>,
}

/// What a tracer asks for a quantity, once it knows whom it follows.
fn reduction_of<'a>(
    tracer: &Tracer,
    of: &'a ParticleSelection,
    followed: Option<u32>,
    quantity: Quantity<'a>,
) -> Option<Reduction<'a>> {
    match followed {
        _ if tracer.is_fixed => Some(Reduction::Interpolation { of, quantity, point: tracer.point }),
        Some(id) => Some(Reduction::OfParticle { id, quantity }),
        None => None,
    }
}

/// Endings of the columns of a field, with the component each holds.
fn components(kind: ColumnKind, dimensions: usize) -> Vec<(String, usize)> {
    let names: &[&str] = match kind {
        ColumnKind::Scalar | ColumnKind::Integer => &[""],
        ColumnKind::Vector => &["_x", "_y", "_z"][..dimensions],
        ColumnKind::Symmetric => &["_xx", "_yy", "_zz", "_xy", "_yz", "_xz"],
        ColumnKind::Tensor => &["_xx", "_xy", "_xz", "_yx", "_yy", "_yz", "_zx", "_zy", "_zz"],
    };
    names.iter().enumerate().map(|(k, name)| ((*name).to_owned(), k)).collect()
}

/// Every field and component of a tracer, in the order of its columns.
fn quantities<'a>(tracer: &'a Tracer, model: &Model) -> impl Iterator<Item = (&'a str, String, usize, &'static str)> {
    let dimensions = model.dimensions.count();
    tracer.fields.iter().filter_map(|name| find_field(name)).flat_map(move |field| {
        components(field.kind, dimensions).into_iter().map(|(ending, k)| (field.name, ending, k, field.unit))
    })
}

impl Observed {
    pub(crate) fn new(model: &Model) -> Self {
        let mut columns = Vec::new();
        for tracer in &model.tracers {
            let what = if tracer.is_fixed { "interpolated at the point" } else { "of the followed particle" };
            for (field, ending, _, unit) in quantities(tracer, model) {
                columns.push(HistoryColumn {
                    name: format!("tracer.{}.{field}{ending}", tracer.name),
                    unit: unit.to_owned(),
                    meaning: format!("{} {what}", field.replace('_', " ")),
                });
            }
        }
        let per = match model.dimensions.count() {
            1 => "/m^2",
            2 => "/m",
            _ => "",
        };
        for section in &model.sections {
            let mut add = |ending: &str, meaning: &str| {
                let name = format!("section.{}.{ending}", section.name);
                columns.push(HistoryColumn { name, unit: format!("N{per}"), meaning: meaning.to_owned() });
            };
            add("normal_force", "force along the normal through the plane, positive in tension");
            for ending in ["force_x", "force_y", "force_z"] {
                add(ending, "force of the material ahead of the plane on the material behind it");
            }
        }
        let selection = |tracer: &Tracer| ParticleSelection { body: tracer.body, ..ParticleSelection::default() };
        Self {
            values: vec![None; columns.len()],
            columns,
            followed: vec![None; model.tracers.len()],
            selections: model.tracers.iter().map(selection).collect(),
        }
    }

    /// What the next sample will ask. It is known once every tracer knows whom it follows.
    pub(crate) fn asks<'a>(&'a self, model: &'a Model) -> Option<Vec<Reduction<'a>>> {
        let mut asked = Vec::new();
        for ((tracer, of), followed) in model.tracers.iter().zip(&self.selections).zip(&self.followed) {
            for (field, _, k, _) in quantities(tracer, model) {
                asked.push(reduction_of(tracer, of, *followed, Quantity { field, component: Some(k) })?);
            }
        }
        asked.extend(model.sections.iter().map(Reduction::SectionForce));
        Some(asked)
    }

    /// Takes the state; the first one is the initial configuration.
    ///
    /// # Errors
    /// The engine is lost.
    pub(crate) fn sample(&mut self, model: &Model, source: &dyn ParticleSource) -> Result<(), RunFailure> {
        self.values.clear();
        for ((tracer, of), followed) in model.tracers.iter().zip(&self.selections).zip(&mut self.followed) {
            if followed.is_none() && !tracer.is_fixed {
                let Tracer { point, body, .. } = *tracer;
                *followed = source.reduce(&Reduction::Nearest { point, body })?.first().map(|id| *id as u32);
            }
            for (field, _, k, _) in quantities(tracer, model) {
                let asked = reduction_of(tracer, of, *followed, Quantity { field, component: Some(k) });
                let found = asked.map(|asked| source.reduce(&asked)).transpose()?;
                self.values.push(found.and_then(|found| found.first().copied()));
            }
        }
        for section in &model.sections {
            let force = source.reduce(&Reduction::SectionForce(section))?;
            let normal = (!force.is_empty()).then(|| force.iter().zip(section.normal).map(|(f, n)| f * n).sum());
            self.values.push(normal);
            self.values.extend((0..3).map(|a| force.get(a).copied()));
        }
        Ok(())
    }

    /// The columns, always the same.
    pub(crate) fn columns(&self) -> &[HistoryColumn] {
        &self.columns
    }

    /// The value of each column in the last sample, SI.
    pub(crate) fn values(&self) -> &[Option<f64>] {
        &self.values
    }
}

impl Persist for Observed {
    /// Columns are those of the model, values those of the next sample.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        persist_column(&mut self.followed, &format!("{name}.followed"), archive)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        model::{Dimensions, Section},
        output::testing,
        particles::Particles,
    };

    /// A plane-strain block of 20 by 5 at spacing 0.1, of density 200, under the stress xx = 3, xy = 2.
    fn block() -> Particles {
        let mut particles = Particles::new(100);
        for i in 0..100 {
            particles.id[i] = 99 - i as u32;
            particles.position[i] = [0.1 * (i % 20) as f64, 0.1 * (i / 20) as f64, 0.0];
            particles.mass[i] = 2.0;
            particles.density[i] = 200.0;
            particles.smoothing_length[i] = 0.12;
            particles.pressure[i] = -1.0;
            particles.deviator[i].xx = 2.0;
            particles.deviator[i].xy = 2.0;
            particles.temperature[i] = 300.0 + particles.position[i][0];
        }
        particles
    }

    #[test]
    fn a_section_has_its_columns_and_no_force_before_there_are_any() {
        let mut model = testing::model(&["bar"]);
        let section = Section { name: "s".into(), point: [1.0, 0.0, 0.0], normal: [1.0, 0.0, 0.0], body: Some(0) };
        model.sections = vec![section];
        let mut observed = Observed::new(&model);
        observed.sample(&model, &(&model, &block())).unwrap();
        let names: Vec<&str> = observed.columns().iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["normal_force", "force_x", "force_y", "force_z"].map(|of| format!("section.s.{of}")));
        assert_eq!(observed.columns()[0].unit, "N/m");
        assert_eq!(observed.values(), [None; 4]);
    }

    #[test]
    fn a_tracer_follows_its_particle_through_sorting_and_a_fixed_one_stays() {
        let mut model = testing::model(&["bar"]);
        let fields = ["position", "temperature", "stress"].map(String::from).to_vec();
        let point = [0.52, 0.21, 0.0];
        let tracer = Tracer { name: "t".into(), point, body: None, is_fixed: false, fields };
        let fixed = Tracer { name: "f".into(), is_fixed: true, fields: vec!["temperature".into()], ..tracer.clone() };
        model.tracers = vec![tracer, fixed];
        let mut observed = Observed::new(&model);
        let mut particles = block();
        observed.sample(&model, &(&model, &particles)).unwrap();
        assert_eq!(observed.columns()[0].name, "tracer.t.position_x");
        assert_eq!(observed.columns().len(), 2 + 1 + 6 + 1);
        let value = |observed: &Observed, k: usize| observed.values()[k].unwrap();
        assert_eq!((value(&observed, 0), value(&observed, 1), value(&observed, 2)), (0.5, 0.2, 300.5));
        assert_eq!((value(&observed, 3), value(&observed, 6)), (3.0, 2.0));
        assert!((value(&observed, 9) - 300.52).abs() < 2e-3);
        // All move by one, half of them are put in another order, and the particle heats.
        for i in 0..100 {
            particles.position[i][0] += 1.0;
        }
        let mut order: Vec<u32> = (0..100).collect();
        order.reverse();
        let mut permutation = crate::particles::Permutation::default();
        permutation.set(&order);
        particles.reorder(&permutation);
        observed.sample(&model, &(&model, &particles)).unwrap();
        assert_eq!((value(&observed, 0), value(&observed, 2)), (1.5, 300.5));
        assert_eq!(observed.values()[9], None);
        model.dimensions = Dimensions::Three;
        assert_eq!(Observed::new(&model).columns().len(), 3 + 1 + 6 + 1);
    }
}
