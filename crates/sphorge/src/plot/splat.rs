//! Particles as their deformed cells, or as balls where these are unknown, nearest first, on a raster finer than the page, with an outline
//! around what stands alone and a line between bodies.

use super::{
    cell::{Corners, HalfSpace, Hit, Hull, dot},
    color::Rgb,
    light::LIGHT,
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

/// Half the width of the line between cells in units of the page, and the least half width of a cell that has one.
const CELL_LINE: f64 = 0.35;
const CELL_LINE_FROM: f64 = 2.5;
/// Gaps between cells up to twice this share of the spacing are filled: the deformation gradients of neighbours are means over
/// surroundings, so that their cells need not meet.
const CLOSED: f64 = 0.2;
/// Depth below the plane of a section, in spacings, that is flat with it.
const NEAR_CUT: f64 = 0.4;
/// Depth of what fills gaps, before all else is.
const BEHIND_ALL: f64 = -1e6;
/// Depth that only what fills gaps is behind.
const FARTHEST: f32 = -5e5;

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
    pub(super) body: u16,
    /// Units of the page; of the initial cell.
    pub(super) spacing: f64,
    /// Corners of the deformed cell from the particle: to the right, down, towards the eye.
    pub(super) cell: Option<Corners<f32>>,
}

struct Raster {
    width: usize,
    height: usize,
    /// Points a unit of the page.
    fine: f64,
    color: Vec<Rgb>,
    depth: Vec<f32>,
    body: Vec<u16>,
    /// Points beside a cell, which stay only in gaps.
    is_beside: Vec<bool>,
}

/// Draws the dots for an area of a page of `scale` pixels a unit; `shaded` tells depth by light and dark edges; what is
/// beyond the plane `cut`, in units of the page, is left out. Clear where there is none.
pub(super) fn splat(
    area: Area,
    scale: f64,
    dots: impl Iterator<Item = Dot>,
    shaded: bool,
    cut: Option<HalfSpace>,
) -> Image {
    let pixels = |length: f64| (length * scale).round().max(1.0) as usize;
    let (columns, rows) = (pixels(area.width), pixels(area.height));
    // Points a pixel, each way: pages of many pixels are smooth by themselves.
    let each = (3.0 / scale).ceil().clamp(1.0, 3.0) as usize;
    let mut raster = Raster::new(columns * each, rows * each, scale * each as f64);
    let fine = raster.fine;
    let cut = cut.map(|cut| HalfSpace { offset: fine * cut.offset, ..cut });
    let (mut largest, mut margin) = (0.0f64, 0.0f64);
    for dot in dots {
        largest = largest.max(dot.radius);
        if let Some(hull) = hull(&dot, fine) {
            margin = margin.max(CLOSED * dot.spacing * fine);
            raster.cell(&dot, &hull, shaded, cut.as_ref());
        } else {
            raster.ball(&dot, shaded);
        }
    }
    raster.open(margin.ceil() as usize);
    if shaded {
        raster.darken_edges(largest, each);
    }
    raster.outline();
    raster.image(area, each)
}

/// The deformed cell of a dot in points of the raster; none where it is unknown, flat, or too small to be seen.
fn hull(dot: &Dot, fine: f64) -> Option<Hull> {
    let centre = [dot.x, dot.y, dot.depth];
    let corners = dot.cell.as_ref()?.map(|corner| std::array::from_fn(|a| fine * (centre[a] + f64::from(corner[a]))));
    let hull = Hull::new(&corners)?;
    let widest = hull.bounds.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    (widest >= 2.0 * LEAST_RADIUS * fine).then_some(hull)
}

impl Raster {
    fn new(width: usize, height: usize, fine: f64) -> Self {
        let count = width * height;
        Self {
            width,
            height,
            fine,
            color: vec![[255; 3]; count],
            depth: vec![f32::NEG_INFINITY; count],
            body: vec![0; count],
            is_beside: vec![false; count],
        }
    }

    /// Raster points whose centres (k + 1/2) may lie between places.
    fn points((low, high): (f64, f64), limit: usize) -> std::ops::Range<usize> {
        let low = (low - 0.5).ceil().max(0.0) as usize;
        let high = (high + 0.5).floor().max(0.0) as usize;
        low.min(limit)..high.min(limit)
    }

    fn cell(&mut self, dot: &Dot, hull: &Hull, shaded: bool, cut: Option<&HalfSpace>) {
        let margin = CLOSED * dot.spacing * self.fine;
        let [columns, rows] = hull.bounds.map(|(low, high)| (low - margin, high + margin));
        let line = CELL_LINE * self.fine;
        let has_line = hull.half_width >= CELL_LINE_FROM * self.fine;
        let edge = ring(dot.color);
        let top = hull.top as f32;
        for row in Self::points(rows, self.height) {
            for column in Self::points(columns, self.width) {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let at = row * self.width + column;
                // All of it is behind what is there.
                if shaded && self.depth[at] >= top {
                    continue;
                }
                let (z, is_beside, color) = if shaded {
                    let (hit, is_beside) = match hull.hit(x, y, 0.0, cut) {
                        Some(hit) => (hit, false),
                        // Behind all cells that are there.
                        None if self.depth[at] > FARTHEST => continue,
                        None => match hull.hit(x, y, margin, cut) {
                            Some(hit) => (Hit { depth: hit.depth + BEHIND_ALL, ..hit }, true),
                            None => continue,
                        },
                    };
                    let on_line = has_line && !is_beside && hit.from_edge < line;
                    let own = if on_line { edge } else { dot.color };
                    // A cut has the colours of the bar, and is no less flat where cells end just before it.
                    let is_near =
                        cut.is_some_and(|cut| cut.depth([x, y, hit.depth]) < NEAR_CUT * dot.spacing * self.fine);
                    let color = match hit.normal {
                        // Down on the page is up for the light.
                        Some([right, down, towards]) if !is_near => {
                            shade(own, dot.light * light_on([right, -down, towards]))
                        }
                        Some(_) | None => own,
                    };
                    // Where cells overlap, each has what is nearer to its middle.
                    let before = if hit.normal.is_none() { 1e-3 * hit.from_edge } else { 0.0 };
                    (hit.depth + before, is_beside, color)
                } else {
                    // Where cells overlap, each has what is nearer to its middle.
                    let inside = hull.inside(x, y);
                    if inside < -margin {
                        continue;
                    }
                    let on_line = has_line && (0.0..line).contains(&inside);
                    (inside, inside < 0.0, if on_line { edge } else { dot.color })
                };
                if z as f32 > self.depth[at] {
                    self.depth[at] = z as f32;
                    self.color[at] = color;
                    self.body[at] = dot.body;
                    self.is_beside[at] = is_beside;
                }
            }
        }
    }

    /// Takes away what is beside cells but in no gap: layer by layer, as deep as the margin.
    fn open(&mut self, layers: usize) {
        let (width, height) = (self.width, self.height);
        let around = |at: usize| {
            let (x, y) = (at % width, at / width);
            let to = [
                (x > 0).then(|| at - 1),
                (x + 1 < width).then(|| at + 1),
                (y > 0).then(|| at - width),
                (y + 1 < height).then(|| at + width),
            ];
            to.into_iter().flatten()
        };
        let mut layer: Vec<usize> = (0..self.depth.len()).filter(|&at| self.is_beside[at]).collect();
        layer.retain(|&at| around(at).any(|to| self.depth[to] == f32::NEG_INFINITY));
        for _ in 0..layers {
            for &at in &layer {
                self.depth[at] = f32::NEG_INFINITY;
                self.is_beside[at] = false;
            }
            layer = layer.into_iter().flat_map(around).filter(|&to| self.is_beside[to]).collect();
            layer.sort_unstable();
            layer.dedup();
        }
    }

    fn ball(&mut self, dot: &Dot, shaded: bool) {
        let units = dot.radius.max(LEAST_RADIUS);
        let (x, y, radius) = (dot.x * self.fine, dot.y * self.fine, units * self.fine);
        if !(x.is_finite() && y.is_finite() && dot.depth.is_finite()) {
            return;
        }
        let depth = dot.depth * self.fine;
        let range = |centre: f64, limit: usize| Self::points((centre - radius, centre + radius), limit);
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
                    self.body[at] = dot.body;
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

    /// Draws a line around all that is covered, and where one body meets another.
    fn outline(&mut self) {
        let (columns, count) = (self.width, self.depth.len());
        let covered = |at: usize| self.depth[at] > f32::NEG_INFINITY;
        let meets = |at: usize, to: usize| covered(at) && covered(to) && self.body[at] != self.body[to];
        let meets_another = |at: usize| {
            at % columns + 1 < columns && meets(at, at + 1) || at + columns < count && meets(at, at + columns)
        };
        let between: Vec<usize> = (0..count).filter(|&at| meets_another(at)).collect();
        let wide = (OUTLINE * self.fine).round().max(1.0) as usize;
        for at in between {
            for (down, right) in (0..wide).flat_map(|down| (0..wide).map(move |right| (down, right))) {
                let to = at + down * columns + right;
                if at % columns + right < columns && to < count && self.depth[to] > f32::NEG_INFINITY {
                    self.color[to] = OUTLINE_COLOR;
                }
            }
        }

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

/// Light on a plane face from its normal: right, up, towards the eye.
fn light_on(normal: [f64; 3]) -> f64 {
    0.9 + 0.1 * (dot(normal, LIGHT) / LIGHT[2]).clamp(0.0, 1.0)
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
        let color = [250, 250, 200];
        Dot { x, y: 5.0, depth: 0.0, radius, color, light: 1.0, body: 0, spacing: radius, cell: None }
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
        let image = splat(area, 1.0, nowhere.into_iter().map(|(x, depth)| Dot { depth, ..dot(x, 2.0) }), false, None);
        assert!(image.pixels.iter().all(|p| p[3] == 0));
    }

    #[test]
    fn a_single_light_particle_is_seen_on_white_at_any_scale() {
        let area = Area { x: 0.0, y: 0.0, width: 10.0, height: 10.0 };
        for scale in [1.0, 3.0, 6.0] {
            for radius in [1e-6, 0.3, 3.0] {
                for shaded in [false, true] {
                    let image = splat(area, scale, std::iter::once(dot(5.0, radius)), shaded, None);
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
        let image = splat(area, 1.0, lattice, false, None);
        assert!(image.pixels.iter().all(|p| p[3] == 255));
        let [r, g, b] = ring(dark);
        let count = |color: [u8; 4]| image.pixels.iter().filter(|p| **p == color).count();
        assert!(count([dark[0], dark[1], dark[2], 255]) > 1500 && count([r, g, b, 255]) > 300);
        assert!(lightness(ring(dark)) > lightness(dark) + 0.1);
        assert!(lightness(shade(dark, 1.0)) > lightness(shade(dark, 0.8)) + 0.1);
        assert_eq!(shade([250, 240, 200], 1.0), [250, 240, 200]);
    }
}
