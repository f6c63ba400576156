//! Particles as balls, nearest first, on a raster finer than the page.

use super::{
    canvas::{Area, Canvas},
    color::Rgb,
};

/// Raster points a pixel, each way.
const FINE: usize = 3;

/// A particle on the page: pixels from the upper left corner of its area, depth and radius in pixels too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Dot {
    pub(super) x: f64,
    pub(super) y: f64,
    /// Larger is nearer to the eye.
    pub(super) depth: f64,
    pub(super) radius: f64,
    pub(super) color: Rgb,
    /// Factor on the colour.
    pub(super) light: f64,
}

struct Raster {
    width: usize,
    height: usize,
    color: Vec<Rgb>,
    depth: Vec<f32>,
}

/// Draws the dots into an area of the page; `shaded` tells depth by light and dark edges.
pub(super) fn splat(canvas: &mut Canvas, area: Area, dots: impl Iterator<Item = Dot>, shaded: bool) {
    let size = |length: f64| (length.ceil().max(0.0) as usize) * FINE;
    let (width, height) = (size(area.width), size(area.height));
    let mut raster =
        Raster { width, height, color: vec![[255; 3]; width * height], depth: vec![f32::NEG_INFINITY; width * height] };
    let mut largest = 0.0f64;
    for dot in dots {
        largest = largest.max(dot.radius);
        raster.ball(&dot, shaded);
    }
    if shaded {
        raster.darken_edges((largest * FINE as f64) as f32);
    }
    raster.shrink_onto(canvas, area);
}

impl Raster {
    fn ball(&mut self, dot: &Dot, shaded: bool) {
        let fine = FINE as f64;
        let (x, y, radius) = (dot.x * fine, dot.y * fine, (dot.radius * fine).max(0.75));
        if !(x.is_finite() && y.is_finite() && dot.depth.is_finite()) {
            return;
        }
        let depth = dot.depth * fine;
        // Raster points whose centres (k + 1/2) lie inside.
        let range = |centre: f64, limit: usize| {
            let low = (centre - radius - 0.5).ceil().max(0.0) as usize;
            let high = (centre + radius + 0.5).floor().max(0.0) as usize;
            low.min(limit)..high.min(limit)
        };
        for row in range(y, self.height) {
            let dy = row as f64 + 0.5 - y;
            for column in range(x, self.width) {
                let dx = column as f64 + 0.5 - x;
                let square = radius * radius - dx * dx - dy * dy;
                if square < 0.0 {
                    continue;
                }
                let rise = square.sqrt();
                let at = row * self.width + column;
                let z = (depth + rise) as f32;
                if z > self.depth[at] {
                    self.depth[at] = z;
                    // Faint, for the colour carries the value.
                    let light = if shaded { 0.86 + (0.14 * rise - 0.05 * (dx + dy)) / radius } else { 1.0 };
                    self.color[at] = dim(dot.color, light * dot.light);
                }
            }
        }
    }

    /// Darkens points that lie behind their neighbours (eye-dome lighting, Boucheny 2009), so that shape shows where balls
    /// are too small to have a shade. `reach` is the drop that darkens fully.
    fn darken_edges(&mut self, reach: f32) {
        let (width, height) = (self.width as isize, self.height as isize);
        let step = FINE as isize;
        let reach = 6.0 * reach.max(FINE as f32);
        let lit: Vec<f32> = (0..self.depth.len())
            .map(|at| {
                let z = self.depth[at];
                if z == f32::NEG_INFINITY {
                    return 1.0;
                }
                let (x, y) = (at as isize % width, at as isize / width);
                let mut drop = 0.0;
                for (dx, dy) in [(step, 0), (-step, 0), (0, step), (0, -step)] {
                    let (nx, ny) = (x + dx, y + dy);
                    if (0..width).contains(&nx) && (0..height).contains(&ny) {
                        let neighbor = self.depth[(ny * width + nx) as usize];
                        drop += ((neighbor - z) / reach).clamp(0.0, 1.0);
                    }
                }
                (1.0 - 0.35 * drop).max(0.45)
            })
            .collect();
        for (color, lit) in self.color.iter_mut().zip(lit) {
            *color = dim(*color, f64::from(lit));
        }
    }

    fn shrink_onto(&self, canvas: &mut Canvas, area: Area) {
        let (left, top) = (area.x.round() as u32, area.y.round() as u32);
        for row in 0..self.height / FINE {
            for column in 0..self.width / FINE {
                let mut sum = [0u32; 3];
                let mut covered = false;
                for k in 0..FINE * FINE {
                    let at = (row * FINE + k / FINE) * self.width + column * FINE + k % FINE;
                    covered |= self.depth[at] > f32::NEG_INFINITY;
                    for c in 0..3 {
                        sum[c] += u32::from(self.color[at][c]);
                    }
                }
                if covered {
                    let mean = sum.map(|s| (s / (FINE * FINE) as u32) as u8);
                    canvas.set(left + column as u32, top + row as u32, mean);
                }
            }
        }
    }
}

fn dim(color: Rgb, light: f64) -> Rgb {
    color.map(|c| (f64::from(c) * light).clamp(0.0, 255.0) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raster() -> Raster {
        Raster { width: 30, height: 30, color: vec![[255; 3]; 900], depth: vec![f32::NEG_INFINITY; 900] }
    }

    #[test]
    fn the_nearer_ball_hides_the_other_whatever_the_order() {
        let near = Dot { x: 5.0, y: 5.0, depth: 3.0, radius: 2.0, color: [10, 0, 0], light: 1.0 };
        let far = Dot { depth: 0.0, radius: 3.0, color: [0, 10, 0], ..near };
        for order in [[near, far], [far, near]] {
            let mut raster = raster();
            order.iter().for_each(|dot| raster.ball(dot, false));
            assert_eq!(raster.color[15 * 30 + 15], [10, 0, 0]);
            // 2.5 pixels off the centre only the larger one reaches.
            assert_eq!(raster.color[15 * 30 + 22], [0, 10, 0]);
            assert_eq!(raster.color[15 * 30 + 25], [255; 3]);
        }
    }

    #[test]
    fn balls_outside_or_nowhere_are_left_out() {
        let mut raster = raster();
        for (x, depth) in [(-50.0, 0.0), (1e9, 0.0), (f64::NAN, 0.0), (5.0, f64::NAN)] {
            raster.ball(&Dot { x, y: 5.0, depth, radius: 2.0, color: [0; 3], light: 1.0 }, false);
        }
        assert!(raster.color.iter().all(|c| *c == [255; 3]));
    }
}
