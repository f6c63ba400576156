//! Particles as balls, nearest first, on a raster finer than the page, with an outline around what stands alone.

use super::{
    color::Rgb,
    page::{Area, Image},
};

/// Least radius of a ball, units of the page: a single particle is seen at any scale.
pub(super) const LEAST_RADIUS: f64 = 1.3;
/// Width of the line around bodies and single particles, and its colour: light colours do not fade into the paper.
const OUTLINE: f64 = 0.7;
const OUTLINE_COLOR: Rgb = [84, 84, 88];
/// Balls in a plane from this radius on, units of the page, have a rim, so that each is seen.
const RIM_FROM: f64 = 4.0;
/// Radius at which the rim begins, as a share of the ball.
const RIM: f64 = 0.62;

/// A particle on the page: units from the upper left corner of its area, depth and radius too.
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
    /// Points a unit of the page.
    fine: f64,
    color: Vec<Rgb>,
    depth: Vec<f32>,
}

/// Draws the dots for an area of a page of `scale` pixels a unit; `shaded` tells depth by light and dark edges. Clear where there is none.
pub(super) fn splat(area: Area, scale: f64, dots: impl Iterator<Item = Dot>, shaded: bool) -> Image {
    let pixels = |length: f64| (length * scale).round().max(1.0) as usize;
    let (columns, rows) = (pixels(area.width), pixels(area.height));
    // Points a pixel, each way: pages of many pixels are smooth by themselves.
    let each = (3.0 / scale).ceil().clamp(1.0, 3.0) as usize;
    let mut raster = Raster::new(columns * each, rows * each, scale * each as f64);
    let mut largest = 0.0f64;
    for dot in dots {
        largest = largest.max(dot.radius);
        raster.ball(&dot, shaded);
    }
    if shaded {
        raster.darken_edges(largest, each);
    }
    raster.outline();
    raster.image(area, each)
}

impl Raster {
    fn new(width: usize, height: usize, fine: f64) -> Self {
        let count = width * height;
        Self { width, height, fine, color: vec![[255; 3]; count], depth: vec![f32::NEG_INFINITY; count] }
    }

    fn ball(&mut self, dot: &Dot, shaded: bool) {
        let units = dot.radius.max(LEAST_RADIUS);
        let (x, y, radius) = (dot.x * self.fine, dot.y * self.fine, units * self.fine);
        if !(x.is_finite() && y.is_finite() && dot.depth.is_finite()) {
            return;
        }
        let depth = dot.depth * self.fine;
        // Raster points whose centres (k + 1/2) lie inside.
        let range = |centre: f64, limit: usize| {
            let low = (centre - radius - 0.5).ceil().max(0.0) as usize;
            let high = (centre + radius + 0.5).floor().max(0.0) as usize;
            low.min(limit)..high.min(limit)
        };
        let rim = if !shaded && units >= RIM_FROM { (RIM * radius).powi(2) } else { f64::INFINITY };
        let edge = ring(dot.color);
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
                    self.color[at] = if shaded {
                        // Faint, for the colour carries the value.
                        let light = 0.86 + (0.14 * rise - 0.05 * (dx + dy)) / radius;
                        shade(dot.color, light * dot.light)
                    } else if dx * dx + dy * dy > rim {
                        edge
                    } else {
                        dot.color
                    };
                }
            }
        }
    }

    /// Darkens points that lie behind their neighbours (eye-dome lighting, Boucheny 2009), so that shape shows where balls
    /// are too small to have a shade. `largest` is the radius of which a few are the drop that darkens fully.
    fn darken_edges(&mut self, largest: f64, each: usize) {
        let (width, height) = (self.width as isize, self.height as isize);
        let step = each as isize;
        let reach = 6.0 * (largest * self.fine).max(each as f64) as f32;
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
            *color = color.map(|c| (f32::from(c) * lit) as u8);
        }
    }

    /// Draws a line around all that is covered.
    fn outline(&mut self) {
        let reach = (OUTLINE * self.fine).round().max(1.0) as isize;
        let (width, height) = (self.width as isize, self.height as isize);
        let clear = |depth: &[f32], x: isize, y: isize| {
            (0..width).contains(&x) && (0..height).contains(&y) && depth[(y * width + x) as usize] == f32::NEG_INFINITY
        };
        let mut line = Vec::new();
        for at in 0..self.depth.len() {
            let (x, y) = (at as isize % width, at as isize / width);
            let edge = self.depth[at] > f32::NEG_INFINITY
                && [(1, 0), (-1, 0), (0, 1), (0, -1)].iter().any(|(dx, dy)| clear(&self.depth, x + dx, y + dy));
            if !edge {
                continue;
            }
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    if dx * dx + dy * dy <= reach * reach && clear(&self.depth, x + dx, y + dy) {
                        line.push(((y + dy) * width + x + dx) as usize);
                    }
                }
            }
        }
        for at in line {
            self.color[at] = OUTLINE_COLOR;
            self.depth[at] = f32::MIN;
        }
    }

    /// Means of `each` by `each` points.
    fn image(&self, area: Area, each: usize) -> Image {
        let (columns, rows) = (self.width / each, self.height / each);
        let mut pixels = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            for column in 0..columns {
                let (mut sum, mut covered) = ([0u32; 3], 0u32);
                for k in 0..each * each {
                    let at = (row * each + k / each) * self.width + column * each + k % each;
                    if self.depth[at] > f32::NEG_INFINITY {
                        covered += 1;
                        (0..3).for_each(|c| sum[c] += u32::from(self.color[at][c]));
                    }
                }
                let [r, g, b] = sum.map(|s| (s / covered.max(1)) as u8);
                pixels.push([r, g, b, (255 * covered / (each * each) as u32) as u8]);
            }
        }
        Image { area, columns, rows, pixels }
    }
}

/// How light a colour is to the eye, 0 to 1.
fn lightness([r, g, b]: Rgb) -> f64 {
    (0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)) / 255.0
}

/// A colour in light: darker below 1, and where it is dark itself lighter towards the light, for black has no shade.
fn shade(color: Rgb, light: f64) -> Rgb {
    let gloss = 1.2 * (light - 0.85).max(0.0) * (1.0 - lightness(color)).powi(3);
    color.map(|c| {
        let dim = f64::from(c) * light.min(1.0);
        (dim + gloss * (255.0 - dim)).clamp(0.0, 255.0) as u8
    })
}

/// The rim of a ball: darker than a light colour, lighter than a dark one.
fn ring(color: Rgb) -> Rgb {
    if lightness(color) > 0.3 {
        color.map(|c| (0.84 * f64::from(c)) as u8)
    } else {
        color.map(|c| (f64::from(c) + 0.16 * (255.0 - f64::from(c))) as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(x: f64, radius: f64) -> Dot {
        Dot { x, y: 5.0, depth: 0.0, radius, color: [250, 250, 200], light: 1.0 }
    }

    #[test]
    fn the_nearer_ball_hides_the_other_whatever_the_order() {
        let near = Dot { depth: 3.0, color: [10, 0, 0], ..dot(5.0, 2.0) };
        let far = Dot { depth: 0.0, radius: 3.0, color: [0, 10, 0], ..near };
        for order in [[near, far], [far, near]] {
            let mut raster = Raster::new(30, 30, 3.0);
            order.iter().for_each(|dot| raster.ball(dot, false));
            assert_eq!(raster.color[15 * 30 + 15], [10, 0, 0]);
            // 2.5 units off the centre only the larger one reaches.
            assert_eq!(raster.color[15 * 30 + 22], [0, 10, 0]);
            assert_eq!(raster.color[15 * 30 + 25], [255; 3]);
        }
    }

    #[test]
    fn balls_outside_or_nowhere_are_left_out() {
        let area = Area { x: 0.0, y: 0.0, width: 10.0, height: 10.0 };
        let nowhere = [(-50.0, 0.0), (1e9, 0.0), (f64::NAN, 0.0), (5.0, f64::NAN)];
        let image = splat(area, 1.0, nowhere.into_iter().map(|(x, depth)| Dot { depth, ..dot(x, 2.0) }), false);
        assert!(image.pixels.iter().all(|p| p[3] == 0));
    }

    #[test]
    fn a_single_light_particle_is_seen_on_white_at_any_scale() {
        let area = Area { x: 0.0, y: 0.0, width: 10.0, height: 10.0 };
        for scale in [1.0, 3.0, 6.0] {
            for radius in [1e-6, 0.3, 3.0] {
                for shaded in [false, true] {
                    let image = splat(area, scale, std::iter::once(dot(5.0, radius)), shaded);
                    let ink = |p: &&[u8; 4]| u32::from(255 - p[0]) * u32::from(p[3]) / 255 > 60;
                    let dark = image.pixels.iter().filter(ink).count() as f64 / (scale * scale);
                    assert!(dark > 2.0, "{scale} {radius} {shaded}: {dark} dark units");
                    let covered = image.pixels.iter().filter(|p| p[3] > 127).count() as f64 / (scale * scale);
                    assert!(covered > 3.0 * LEAST_RADIUS * LEAST_RADIUS, "{scale} {radius} {shaded}: {covered}");
                }
            }
        }
    }

    #[test]
    fn a_closed_surface_has_no_lines_inside_and_dark_balls_have_relief() {
        let area = Area { x: 0.0, y: 0.0, width: 60.0, height: 60.0 };
        let dark = [68, 1, 84];
        let lattice = (0..36).map(|k| Dot {
            x: 10.0 * f64::from(k % 6) + 5.0,
            y: 10.0 * f64::from(k / 6) + 5.0,
            color: dark,
            ..dot(0.0, 7.1)
        });
        let image = splat(area, 1.0, lattice, false);
        assert!(image.pixels.iter().all(|p| p[3] == 255));
        let [r, g, b] = ring(dark);
        let count = |color: [u8; 4]| image.pixels.iter().filter(|p| **p == color).count();
        assert!(count([dark[0], dark[1], dark[2], 255]) > 1500 && count([r, g, b, 255]) > 300);
        assert!(lightness(ring(dark)) > lightness(dark) + 0.1);
        assert!(lightness(shade(dark, 1.0)) > lightness(shade(dark, 0.8)) + 0.1);
        assert_eq!(shade([250, 240, 200], 1.0), [250, 240, 200]);
    }
}
