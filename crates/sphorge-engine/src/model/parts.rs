//! The parts of a composed shape.

use super::{Dimensions, Shape};
use crate::box_tree::BoxTree;
use std::{fmt, ops::Deref, sync::OnceLock};

/// Shapes in order. Their boxes are sorted when a point is first sought among many.
#[derive(Clone)]
pub struct Parts {
    shapes: Vec<Shape>,
    tree: OnceLock<(Dimensions, BoxTree)>,
}

impl Parts {
    /// Boxes of all but the first, which a difference and a lattice tell from the others. `None` where the boxes of other dimensions were
    /// sought before.
    pub(crate) fn boxes_of_others(&self, dimensions: Dimensions) -> Option<&BoxTree> {
        let sorted = || {
            let boxes: Vec<_> = self.shapes.iter().skip(1).map(|part| part.bounds(dimensions)).collect();
            (dimensions, BoxTree::new(&boxes, dimensions.count()))
        };
        let (of, tree) = self.tree.get_or_init(sorted);
        (*of == dimensions).then_some(tree)
    }
}

impl From<Vec<Shape>> for Parts {
    fn from(shapes: Vec<Shape>) -> Self {
        Self { shapes, tree: OnceLock::new() }
    }
}

impl FromIterator<Shape> for Parts {
    fn from_iter<I: IntoIterator<Item = Shape>>(shapes: I) -> Self {
        Vec::from_iter(shapes).into()
    }
}

impl Deref for Parts {
    type Target = [Shape];

    fn deref(&self) -> &[Shape] {
        &self.shapes
    }
}

impl fmt::Debug for Parts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.shapes.fmt(f)
    }
}
