//! Reordering of columns in place.

/// A new order of the particles, as cycles, so that columns move in place and nothing is allocated once the buffers have
/// grown.
#[derive(Clone, Debug, Default)]
pub struct Permutation {
    /// Place `k` receives what was at `source[k]`.
    source: Vec<u32>,
    /// One place of every cycle longer than one.
    cycles: Vec<u32>,
    visited: Vec<bool>,
}

impl Permutation {
    /// Sets the order: place `k` is to receive what is at `order[k]`. `order` must hold every index once.
    pub fn set(&mut self, order: &[u32]) {
        self.source.clear();
        self.source.extend_from_slice(order);
        self.cycles.clear();
        self.visited.clear();
        self.visited.resize(order.len(), false);
        for start in 0..order.len() {
            if self.visited[start] || order[start] as usize == start {
                continue;
            }
            self.cycles.push(start as u32);
            let mut place = start;
            while !self.visited[place] {
                self.visited[place] = true;
                place = order[place] as usize;
            }
        }
    }

    /// Moves the values of one column; an empty column stays empty.
    pub fn apply<V: Copy>(&self, column: &mut [V]) {
        if column.is_empty() {
            return;
        }
        for &start in &self.cycles {
            let first = column[start as usize];
            let mut place = start;
            loop {
                let from = self.source[place as usize];
                if from == start {
                    column[place as usize] = first;
                    break;
                }
                column[place as usize] = column[from as usize];
                place = from;
            }
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        4 * (self.source.capacity() + self.cycles.capacity()) + self.visited.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_move_as_if_collected_anew() {
        let order = [4, 1, 0, 2, 3, 6, 5];
        let column = [10, 11, 12, 13, 14, 15, 16];
        let mut permutation = Permutation::default();
        permutation.set(&[1, 0, 2]);
        permutation.set(&order);
        let mut moved = column;
        permutation.apply(&mut moved);
        assert_eq!(moved, order.map(|i| column[i as usize]));
        permutation.apply::<f64>(&mut []);
    }
}
