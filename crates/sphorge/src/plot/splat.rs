//! Particles as their deformed cells, in space as the polygons of bodies, or as balls where cells are unknown, on a raster finer than the page, with an
//! outline around what stands alone and a line between bodies.

use super::{
    cell::{Corners, HalfSpace, Hull, dot},
    color::Rgb,
    light::{DARKEST, LIGHT},
    page::{Area, Image},
};

/// Radius of a ball in spacings: balls close the surface.
pub(super) const BALL: f64 = 0.71;
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
/// Depth below the plane of a section, in spacings, that is flat with it, and the least cosine between the plane and a face that is.
const NEAR_CUT: f64 = 0.4;
const ALONG_CUT: f64 = 0.8;
/// How much nearer a point of a cut is for each point that it is away from the surface of its body: where bodies overlap, each has what is deeper in it.
const DEEPER: f64 = 1e-3;

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

/// A polygon of a body on the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Facet<'a> {
    /// To the right, down, towards the eye: units from the upper left corner of the area.
    pub(super) corners: &'a [[f64; 3]],
    /// Away from the body: to the right, down, towards the eye; none where a section cuts it.
    pub(super) outward: Option<[f64; 3]>,
    /// Which edges from each corner to the next have a line, one bit each; of a cut, which are at the surface.
    pub(super) edges: u32,
    pub(super) color: Rgb,
    pub(super) body: u16,
    /// Units of the page; of the initial cell.
    pub(super) spacing: f64,
}

/// What a point of the raster shows of a body that a section opens.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Outside,
    Cut,
    /// The inside of a surface.
    Inside,
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
    /// Of bodies in space that are cut; empty without a section.
    side: Vec<Side>,
}

/// Draws facets and dots for an area of a page of `scale` pixels a unit; `shaded` tells depth by light and dark edges; facets near the plane
/// `cut`, in units of the page, are as flat as it. Clear where there is nothing.
pub(super) fn splat<'a>(
    area: Area,
    scale: f64,
    facets: impl Iterator<Item = Facet<'a>>,
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
    if cut.is_some() {
        raster.side = vec![Side::Outside; raster.depth.len()];
    }
    let mut corners = Vec::new();
    for facet in facets {
        largest = largest.max(BALL * facet.spacing);
        corners.clear();
        corners.extend(facet.corners.iter().map(|corner| corner.map(|x| fine * x)));
        raster.facet(&facet, &corners, cut.as_ref());
    }
    raster.close();
    for dot in dots {
        largest = largest.max(dot.radius);
        if let Some(hull) = hull(&dot, fine) {
            margin = margin.max(CLOSED * dot.spacing * fine);
            raster.cell(&dot, &hull);
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
            side: Vec::new(),
        }
    }

    /// Raster points whose centres (k + 1/2) may lie between places.
    fn points((low, high): (f64, f64), limit: usize) -> std::ops::Range<usize> {
        let low = (low - 0.5).ceil().max(0.0) as usize;
        let high = (high + 0.5).floor().max(0.0) as usize;
        low.min(limit)..high.min(limit)
    }

    /// Draws a polygon with these corners, points of the raster, as triangles around its first one.
    fn facet(&mut self, facet: &Facet<'_>, corners: &[[f64; 3]], cut: Option<&HalfSpace>) {
        let [first, rest @ ..] = corners else { return };
        let flagged = corners.iter().enumerate().filter(|(k, _)| facet.edges >> k & 1 == 1);
        let drawn: Vec<Edge> = flagged.map(|(k, from)| Edge::new(*from, corners[(k + 1) % corners.len()])).collect();
        let count = corners.len() as f64;
        let middle = [0, 1].map(|a| corners.iter().map(|corner| corner[a]).sum::<f64>() / count);
        let half_width = drawn.iter().map(|edge| edge.distance(middle)).fold(f64::INFINITY, f64::min);
        let has_line = facet.outward.is_some() && half_width >= CELL_LINE_FROM * self.fine;
        let (line, spacing) = (CELL_LINE * self.fine, facet.spacing * self.fine);
        let [own, edge] = [facet.color, ring(facet.color)];
        // Down on the page is up for the light.
        let light = facet.outward.map_or(1.0, |n| {
            let towards = if n[2] < 0.0 { n.map(|x| -x) } else { n };
            light_on([towards[0], -towards[1], towards[2]])
        });
        let lit = [own, edge].map(|color| shade(color, light));
        // One along the cut and just before it is as flat.
        let flat = cut.filter(|cut| facet.outward.is_some_and(|n| dot(n, cut.normal) > ALONG_CUT));
        let side = match facet.outward {
            None => Side::Cut,
            Some([_, _, towards]) if towards < 0.0 => Side::Inside,
            Some(_) => Side::Outside,
        };
        for pair in rest.windows(2) {
            let triangle = [first, &pair[0], &pair[1]];
            let reach = |a: usize| {
                let each = triangle.map(|corner| corner[a]);
                each.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
            };
            let (columns, top) = (reach(0), reach(2).1 as f32);
            for row in Self::points(reach(1), self.height) {
                for column in Self::points(columns, self.width) {
                    let at = row * self.width + column;
                    let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                    // All of it is behind what is there.
                    if facet.outward.is_some() && self.depth[at] >= top {
                        continue;
                    }
                    let Some(z) = height(triangle, x, y) else { continue };
                    let from_edge = || drawn.iter().map(|edge| edge.distance([x, y])).fold(f64::INFINITY, f64::min);
                    let (before, color) = if facet.outward.is_none() {
                        (DEEPER * from_edge().min(spacing), own)
                    } else if flat.is_some_and(|cut| cut.depth([x, y, z]) < NEAR_CUT * spacing) {
                        (0.0, own)
                    } else {
                        (0.0, lit[usize::from(has_line && from_edge() < line)])
                    };
                    let z = (z + before) as f32;
                    if z > self.depth[at] {
                        self.depth[at] = z;
                        self.color[at] = color;
                        self.body[at] = facet.body;
                        if let Some(own) = self.side.get_mut(at) {
                            *own = side;
                        }
                    }
                }
            }
        }
    }

    /// Where the inside of a surface is seen past a cut, there are slivers between cells whose corners are not the same: they have the colour of
    /// the cut beside them.
    fn close(&mut self) {
        let (width, height) = (self.width, self.height);
        let mut layer: Vec<usize> = (0..self.side.len()).filter(|&at| self.side[at] == Side::Cut).collect();
        while !layer.is_empty() {
            let mut next = Vec::new();
            for at in layer {
                for to in around(at, width, height) {
                    if self.side[to] == Side::Inside {
                        self.side[to] = Side::Cut;
                        (self.color[to], self.depth[to], self.body[to]) =
                            (self.color[at], self.depth[at], self.body[at]);
                        next.push(to);
                    }
                }
            }
            layer = next;
        }
    }

    /// A cell in a plane.
    fn cell(&mut self, dot: &Dot, hull: &Hull) {
        let margin = CLOSED * dot.spacing * self.fine;
        let [columns, rows] = hull.bounds.map(|(low, high)| (low - margin, high + margin));
        let line = CELL_LINE * self.fine;
        let has_line = hull.half_width >= CELL_LINE_FROM * self.fine;
        let edge = ring(dot.color);
        for row in Self::points(rows, self.height) {
            for column in Self::points(columns, self.width) {
                let at = row * self.width + column;
                // Where cells overlap, each has what is nearer to its middle.
                let inside = hull.inside(column as f64 + 0.5, row as f64 + 0.5);
                if inside < -margin || inside as f32 <= self.depth[at] {
                    continue;
                }
                self.depth[at] = inside as f32;
                self.color[at] = if has_line && (0.0..line).contains(&inside) { edge } else { dot.color };
                self.body[at] = dot.body;
                self.is_beside[at] = inside < 0.0;
            }
        }
    }

    /// Takes away what is beside cells but in no gap: layer by layer, as deep as the margin.
    fn open(&mut self, layers: usize) {
        let (width, height) = (self.width, self.height);
        let around = |at: usize| around(at, width, height);
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
            // Rounded: what is deeper by a hair is no darker.
            *color = color.map(|c| (f32::from(c) * lit).round() as u8);
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

/// An edge of a polygon on the raster.
struct Edge {
    from: [f64; 2],
    along: [f64; 2],
    square: f64,
}

impl Edge {
    fn new(from: [f64; 3], to: [f64; 3]) -> Self {
        let along = [to[0] - from[0], to[1] - from[1]];
        Self { from: [from[0], from[1]], along, square: along[0] * along[0] + along[1] * along[1] }
    }

    fn distance(&self, at: [f64; 2]) -> f64 {
        let off = [at[0] - self.from[0], at[1] - self.from[1]];
        let share = (off[0] * self.along[0] + off[1] * self.along[1]) / self.square.max(f64::MIN_POSITIVE);
        let share = share.clamp(0.0, 1.0);
        (off[0] - share * self.along[0]).hypot(off[1] - share * self.along[1])
    }
}

/// Points beside one.
fn around(at: usize, width: usize, height: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (at % width, at / width);
    let to = [
        (x > 0).then(|| at - 1),
        (x + 1 < width).then(|| at + 1),
        (y > 0).then(|| at - width),
        (y + 1 < height).then(|| at + width),
    ];
    to.into_iter().flatten()
}

/// Where the line through a point of the page towards the eye meets a triangle; nowhere beside it, or where it is seen from its edge.
fn height([p, q, r]: [&[f64; 3]; 3], x: f64, y: f64) -> Option<f64> {
    let twice = (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
    let on_q = ((x - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (y - p[1])) / twice;
    let on_r = ((q[0] - p[0]) * (y - p[1]) - (x - p[0]) * (q[1] - p[1])) / twice;
    // Of two triangles with an edge in common each has it, too.
    let is_inside = on_q >= -1e-9 && on_r >= -1e-9 && on_q + on_r <= 1.0 + 1e-9;
    is_inside.then_some(p[2] + on_q * (q[2] - p[2]) + on_r * (r[2] - p[2]))
}

/// Light on a plane face from its normal: right, up, towards the eye.
fn light_on(normal: [f64; 3]) -> f64 {
    1.0 - DARKEST * (1.0 - (dot(normal, LIGHT) / LIGHT[2]).max(0.0))
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
        let image = splat(
            area,
            1.0,
            std::iter::empty(),
            nowhere.into_iter().map(|(x, depth)| Dot { depth, ..dot(x, 2.0) }),
            false,
            None,
        );
        assert!(image.pixels.iter().all(|p| p[3] == 0));
    }

    #[test]
    fn a_single_light_particle_is_seen_on_white_at_any_scale() {
        let area = Area { x: 0.0, y: 0.0, width: 10.0, height: 10.0 };
        for scale in [1.0, 3.0, 6.0] {
            for radius in [1e-6, 0.3, 3.0] {
                for shaded in [false, true] {
                    let image = splat(area, scale, std::iter::empty(), std::iter::once(dot(5.0, radius)), shaded, None);
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
        let image = splat(area, 1.0, std::iter::empty(), lattice, false, None);
        assert!(image.pixels.iter().all(|p| p[3] == 255));
        let [r, g, b] = ring(dark);
        let count = |color: [u8; 4]| image.pixels.iter().filter(|p| **p == color).count();
        assert!(count([dark[0], dark[1], dark[2], 255]) > 1500 && count([r, g, b, 255]) > 300);
        assert!(lightness(ring(dark)) > lightness(dark) + 0.1);
        assert!(lightness(shade(dark, 1.0)) > lightness(shade(dark, 0.8)) + 0.1);
        assert_eq!(shade([250, 240, 200], 1.0), [250, 240, 200]);
    }
}
