//! From values to colours, and the bar or key that says which.

use super::{
    ColorMap, FieldPicture,
    axis::AxisScale,
    color::Rgb,
    font::{LEADING, widest, wrap},
    page::{Anchor, Area, FRAME, Image, Page, SMALL, TEXT},
    scene::Scene,
};
use crate::number::{four_digits, quantity};

/// Colour of a value that is not finite.
pub(crate) const NO_VALUE: Rgb = [150, 150, 150];
/// Colours of a field that is zero or one.
pub(crate) const FLAG_COLORS: [Rgb; 2] = [[176, 190, 204], [213, 94, 0]];
/// Colour of bodies that have one value everywhere: light enough for light and shade to show their shape.
pub(crate) const SINGLE_COLOR: Rgb = [126, 158, 190];
const THICKNESS: f64 = 18.0;
const SWATCH: f64 = 16.0;
/// Room for an arrow with an extreme beyond an end of the bar.
const ARROW: f64 = 36.0;
/// Bodies that a key names, if there are more than one more.
const MOST_NAMES: usize = 12;
/// Width of the words of a key, at most.
const KEY_WIDTH: f64 = 130.0;
/// Length of a bar beside panels, at least.
const LEAST_LENGTH: f64 = 150.0;

/// The colour of a body: light enough for light and shade, and to be told apart by the colour-blind (after Okabe and Ito 2008).
pub(crate) fn body_color(index: usize) -> Rgb {
    const COLORS: [Rgb; 8] = [
        SINGLE_COLOR,
        [230, 159, 0],
        [60, 175, 135],
        [204, 121, 167],
        [240, 228, 120],
        [150, 150, 154],
        [120, 200, 235],
        [213, 110, 50],
    ];
    COLORS[index % COLORS.len()]
}

/// From values to colours.
pub(super) struct Colors {
    map: ColorMap,
    low: f64,
    high: f64,
    label: String,
    unit: &'static str,
    extremes: (f64, f64),
    /// Colours with their words, where the field has but these.
    key: Option<Vec<(Rgb, String)>>,
    /// Colours of the values 0, 1 and so on of such a field.
    whole: Vec<Rgb>,
}

impl Colors {
    pub(super) fn new(scene: &Scene, picture: &FieldPicture) -> Self {
        let (extremes, bulk) = (scene.extent.extremes, scene.extent.bulk);
        let inside = bulk.1 - bulk.0;
        let stretched = extremes.1 - extremes.0 > 1.5 * inside && inside > 0.0;
        // An end that outliers move little is the extreme itself.
        let end = |bulk: f64, extreme: f64| {
            if stretched && (extreme - bulk).abs() > 0.2 * inside { bulk } else { extreme }
        };
        let (low, high) = (end(bulk.0, extremes.0), end(bulk.1, extremes.1));
        // Zero is worth a colour of its own where both signs matter.
        let both_signs = low < -0.2 * high.abs() && high > -0.2 * low;
        let map = picture.color_map.unwrap_or(if both_signs { ColorMap::Diverging } else { ColorMap::Viridis });
        let least = 1e-6 * low.abs().max(high.abs()).max(f64::MIN_POSITIVE);
        let single = picture.range.is_none() && high - low <= least;
        let (low, high) = match picture.range {
            Some(range) => range,
            None if map == ColorMap::Diverging => (-high.abs().max(low.abs()), high.abs().max(low.abs())),
            None => (low, high),
        };
        let is_shown = |name: &String| picture.bodies.is_empty() || picture.bodies.contains(name);
        let names = scene.bodies.iter().enumerate().filter(|(_, name)| is_shown(name));
        let names: Vec<_> = names.map(|(k, name)| (body_color(k), name.clone())).collect();
        let key = match scene.flag {
            _ if !scene.bodies.is_empty() => {
                let mut names = names;
                if names.len() > MOST_NAMES + 1 {
                    let others = names.len() - MOST_NAMES;
                    names.truncate(MOST_NAMES);
                    names.push(([255; 3], format!("{others} others")));
                }
                Some(names)
            }
            Some([zero, one]) => Some(vec![(FLAG_COLORS[1], one.to_owned()), (FLAG_COLORS[0], zero.to_owned())]),
            None if single => {
                // The mean of round-off around zero is zero.
                let value = if low.abs().max(high.abs()) < f64::MIN_POSITIVE { 0.0 } else { scene.extent.extremes.0 };
                Some(vec![(SINGLE_COLOR, format!("{} everywhere", quantity(value, scene.unit)))])
            }
            None => None,
        };
        let whole = match scene.flag {
            _ if !scene.bodies.is_empty() => (0..scene.bodies.len()).map(body_color).collect(),
            Some(_) => FLAG_COLORS.to_vec(),
            None => vec![SINGLE_COLOR],
        };
        Self { map, low, high, label: scene.label.clone(), unit: scene.unit, extremes, key, whole }
    }

    pub(super) fn of(&self, value: f64) -> Rgb {
        match &self.key {
            _ if !value.is_finite() => NO_VALUE,
            Some(_) => self.whole[(value.round().max(0.0) as usize).min(self.whole.len() - 1)],
            None => self.map.color((value - self.low) / (self.high - self.low)),
        }
    }

    /// What is written at the arrows beyond the ends: smallest and largest value.
    fn beyond(&self, scale: f64) -> [Option<String>; 2] {
        let slack = 1e-6 * (self.high - self.low);
        let (least, most) = self.extremes;
        [
            (least < self.low - slack).then(|| format!("min {}", four_digits(least / scale))),
            (most > self.high + slack).then(|| format!("max {}", four_digits(most / scale))),
        ]
    }

    /// Width of the bar beside panels of that height.
    pub(super) fn width(&self, height: f64) -> f64 {
        let Some(_) = &self.key else {
            let (axis, lines) = self.upright(height);
            let ends = self.beyond(axis.scale).into_iter().flatten().collect::<Vec<_>>();
            let numbers = THICKNESS + 9.0 + widest(&axis.labels, SMALL);
            return (numbers + 8.0 + lines.len() as f64 * LEADING * TEXT).max(widest(&ends, SMALL));
        };
        let (title, words) = self.key_lines(KEY_WIDTH);
        widest(&title, SMALL).max(8.0 + SWATCH + widest(words.iter().flat_map(|(_, lines)| lines), SMALL))
    }

    /// Height of the bar below panels of that width.
    pub(super) fn height(&self, width: f64) -> f64 {
        if self.key.is_none() {
            let (axis, lines) = self.level(width);
            let ends = if self.beyond(axis.scale).iter().any(Option::is_some) { 20.0 } else { 0.0 };
            return THICKNESS + 24.0 + ends + lines.len() as f64 * LEADING * TEXT;
        }
        let (title, words) = self.key_lines(width);
        (title.len() + words.iter().map(|(_, lines)| lines.len()).sum::<usize>()) as f64 * 20.0
    }

    /// Least height of panels beside which the bar stands.
    pub(super) fn least_height(&self) -> f64 {
        if self.key.is_some() { 80.0 } else { LEAST_LENGTH + 2.0 * ARROW }
    }

    /// Length of an upright bar in a height, with room for arrows.
    fn length(height: f64) -> f64 {
        (height - 2.0 * ARROW).clamp(LEAST_LENGTH, 460.0)
    }

    fn upright(&self, height: f64) -> (AxisScale, Vec<String>) {
        let length = Self::length(height);
        let axis = AxisScale::upright((self.low, self.high), self.unit, length, SMALL);
        let lines = wrap(&axis.title(&self.label), TEXT, length + ARROW);
        (axis, lines)
    }

    fn level(&self, width: f64) -> (AxisScale, Vec<String>) {
        // Numbers at the ends are centred there.
        let axis = AxisScale::level((self.low, self.high), self.unit, width - 50.0, SMALL);
        let lines = wrap(&axis.title(&self.label), TEXT, width);
        (axis, lines)
    }

    fn key_lines(&self, width: f64) -> (Vec<String>, Vec<(Rgb, Vec<String>)>) {
        let words = self.key.iter().flatten();
        let words = words.map(|(color, word)| (*color, wrap(word, SMALL, width - SWATCH - 8.0))).collect();
        (wrap(&self.label, SMALL, width), words)
    }

    /// Draws the bar upright with its left end at `x` beside panels from `top` to `top + height`.
    pub(super) fn draw_beside(&self, page: &mut Page, x: f64, top: f64, height: f64) {
        if self.key.is_some() {
            let (title, words) = self.key_lines(KEY_WIDTH);
            let lines = title.len() + words.iter().map(|(_, lines)| lines.len()).sum::<usize>();
            return self.draw_key(page, x, top + 0.5 * (height - 20.0 * lines as f64), KEY_WIDTH);
        }
        let (axis, lines) = self.upright(height);
        let length = Self::length(height);
        let area = Area { x, y: (top + 0.5 * (height - length)).round(), width: THICKNESS, height: length };
        let pixels: Vec<_> = (0..256).rev().map(|k| self.opaque(f64::from(k) / 255.0)).collect();
        page.image(Image { area, columns: 1, rows: 256, pixels });
        page.outline(area, 1.0, FRAME);
        let (left, right, bottom) = (area.x, area.right(), area.bottom());
        for (tick, label) in axis.ticks.iter().zip(&axis.labels) {
            let y = bottom - axis.share(*tick) * length;
            page.line((right, y), (right + 5.0, y), 1.0, FRAME);
            page.text((right + 9.0, y + 0.36 * SMALL), SMALL, Anchor::Left, label);
        }
        let middle = 0.5 * (left + right);
        let [least, most] = self.beyond(axis.scale);
        if let Some(most) = most {
            let y = area.y;
            page.polygon(vec![(left, y - 2.0), (right, y - 2.0), (middle, y - 13.0)], self.map.color(1.0));
            page.text((left, y - 19.0), SMALL, Anchor::Left, &most);
        }
        if let Some(least) = least {
            page.polygon(
                vec![(left, bottom + 2.0), (right, bottom + 2.0), (middle, bottom + 13.0)],
                self.map.color(0.0),
            );
            page.text((left, bottom + 29.0), SMALL, Anchor::Left, &least);
        }
        for (k, line) in lines.iter().enumerate() {
            let x = right + 9.0 + widest(&axis.labels, SMALL) + LEADING * TEXT * (k as f64 + 0.9);
            page.text_upwards((x, area.y + 0.5 * length), TEXT, line);
        }
    }

    /// Draws the bar from left to right, its upper left corner at a place, in a width.
    pub(super) fn draw_below(&self, page: &mut Page, (x, y): (f64, f64), width: f64) {
        if self.key.is_some() {
            return self.draw_key(page, x, y, width);
        }
        let (axis, lines) = self.level(width);
        let area = Area { x: x + 25.0, y, width: width - 50.0, height: THICKNESS };
        let pixels: Vec<_> = (0..256).map(|k| self.opaque(f64::from(k) / 255.0)).collect();
        page.image(Image { area, columns: 256, rows: 1, pixels });
        page.outline(area, 1.0, FRAME);
        for (tick, label) in axis.ticks.iter().zip(&axis.labels) {
            let x = area.x + axis.share(*tick) * area.width;
            page.line((x, area.bottom()), (x, area.bottom() + 5.0), 1.0, FRAME);
            page.text((x, area.bottom() + 18.0), SMALL, Anchor::Centre, label);
        }
        let (top, bottom, middle) = (area.y, area.bottom(), 0.5 * (area.y + area.bottom()));
        let mut next = bottom + 24.0;
        let [least, most] = self.beyond(axis.scale);
        if least.is_some() || most.is_some() {
            next += 20.0;
        }
        if let Some(least) = least {
            page.polygon(
                vec![(area.x - 2.0, top), (area.x - 2.0, bottom), (area.x - 13.0, middle)],
                self.map.color(0.0),
            );
            page.text((x, next - 4.0), SMALL, Anchor::Left, &least);
        }
        if let Some(most) = most {
            let right = area.right();
            page.polygon(vec![(right + 2.0, top), (right + 2.0, bottom), (right + 13.0, middle)], self.map.color(1.0));
            page.text((x + width, next - 4.0), SMALL, Anchor::Right, &most);
        }
        for (k, line) in lines.iter().enumerate() {
            page.text((x + 0.5 * width, next + LEADING * TEXT * (k as f64 + 0.7)), TEXT, Anchor::Centre, line);
        }
    }

    fn draw_key(&self, page: &mut Page, x: f64, y: f64, width: f64) {
        let (title, words) = self.key_lines(width);
        let mut y = y;
        for line in &title {
            page.text((x, y + 0.5 * 20.0 + 0.36 * SMALL), SMALL, Anchor::Left, line);
            y += 20.0;
        }
        for (color, lines) in &words {
            let swatch = Area { x, y: y + 2.0, width: SWATCH, height: SWATCH };
            page.fill(swatch, *color);
            page.outline(swatch, 1.0, FRAME);
            for line in lines {
                page.text((x + SWATCH + 8.0, y + 10.0 + 0.36 * SMALL), SMALL, Anchor::Left, line);
                y += 20.0;
            }
        }
    }

    fn opaque(&self, share: f64) -> [u8; 4] {
        let [r, g, b] = self.map.color(share);
        [r, g, b, 255]
    }
}
