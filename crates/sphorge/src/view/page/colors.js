// From values to colours, by the rules of pictures (`Colors` of the colour bar of `sphorge plot`).
"use strict";

/** The maps as bytes: red, green, blue of 256 colours. */
function decodedMaps(maps) {
  const bytes = (digits) => Uint8Array.from(digits.match(/../g), (pair) => parseInt(pair, 16));
  return Object.fromEntries(maps.map(([name, digits]) => [name, bytes(digits)]));
}

const css = ([r, g, b]) => `rgb(${r} ${g} ${b})`;

/** Of so many frames one may be left out at each end where limits are chosen. */
const FRAMES_LEFT_OUT = 10;

/**
 * What frames have in common: smallest and largest value, and the same without the outermost half percent of each, of nine of ten frames: a shock that is
 * there in a few of many frames would leave one colour to all others.
 */
function rangeOfFrames(heads) {
  const finite = heads.filter((head) => Number.isFinite(head[0]));
  if (finite.length === 0) return null;
  const ends = (k) => finite.map((head) => head[k]).sort((a, b) => a - b);
  const out = Math.floor(finite.length / FRAMES_LEFT_OUT);
  return [ends(0)[0], ends(1).at(-1), ends(2)[out], ends(3).at(-1 - out)];
}

/**
 * Map and ends of the bar for values in a range. A few outliers that would stretch the bar by half or more are left beyond its ends; zero has a colour of
 * its own where both signs matter.
 */
function limits(range, map, fixed) {
  const [least, most, bulkLow, bulkHigh] = range ?? [0, 0, 0, 0];
  const inside = bulkHigh - bulkLow;
  const stretched = most - least > 1.5 * inside && inside > 0;
  const end = (bulk, extreme) => (stretched && Math.abs(extreme - bulk) > 0.2 * inside ? bulk : extreme);
  let [low, high] = [end(bulkLow, least), end(bulkHigh, most)];
  const bothSigns = low < -0.2 * Math.abs(high) && high > -0.2 * low;
  const chosen = map ?? (bothSigns ? "diverging" : "viridis");
  const size = Math.max(Math.abs(low), Math.abs(high), Number.MIN_VALUE);
  const isSingle = !fixed && high - low <= 1e-6 * size;
  const single = low;
  if (fixed) [low, high] = fixed;
  else if (chosen === "diverging") [low, high] = [-size, size];
  return { map: chosen, low, high, isSingle, single, least, most };
}
