// Numbers for people, as pictures write them: round steps, SI prefixes, no more digits than needed.
"use strict";

const PREFIXES = [[1e12, "T"], [1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"], [1e-12, "p"]];
const SUPERSCRIPTS = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

/** Divisor and unit for values up to `largest` in an SI unit. */
function scaledUnit(largest, unit) {
  const pretty = unit.replaceAll("^2", "²").replaceAll("^3", "³");
  if (largest === 0 || !Number.isFinite(largest)) return [1, pretty];
  const takesPrefix = ["Pa", "m", "s", "W/kg"].includes(unit) || /^[JN]/.test(unit) || (unit === "m/s" && largest < 0.1);
  if (takesPrefix && largest >= 1e-14 && largest < 1e16) {
    const [scale, prefix] = PREFIXES.find(([scale]) => largest >= 0.999 * scale) ?? PREFIXES.at(-1);
    // Metres are not counted in thousands.
    return unit === "m" && scale > 1 ? [1, pretty] : [scale, prefix + pretty];
  }
  if (largest >= 1e-3 && largest < 1e5) return [1, pretty];
  const power = 3 * Math.floor(Math.log10(largest) / 3);
  const exponent = [...String(power)].map((digit) => SUPERSCRIPTS[digit]).join("");
  return [10 ** power, `10${exponent} ${pretty}`.trim()];
}

/** Four significant digits without trailing zeros. */
function fourDigits(value) {
  if (!Number.isFinite(value)) return "not finite";
  if (value === 0) return "0";
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  const far = exponent < -4 || exponent > 6;
  let text = far ? value.toExponential(3) : value.toFixed(Math.max(3 - exponent, 0));
  if (!far && text.includes(".")) text = text.replace(/\.?0+$/, "");
  return text.replace("e+", "e").replaceAll("-", "−");
}

/** A value with its unit: `60 µs`, `1.234 GPa`. */
function quantity(value, unit) {
  const [scale, text] = scaledUnit(Math.abs(value), unit);
  return `${fourDigits(value / scale)} ${text.startsWith("10") ? "× " : ""}${text}`.trim();
}

/** Multiples of 1, 2, 2.5 or 5 times a power of ten between two numbers, at most about so many. */
function ticks(low, high, most) {
  const rough = (high - low) / Math.max(most, 2);
  if (!(rough > 0) || !Number.isFinite(rough)) return [];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = ([1, 2, 2.5, 5].find((m) => rough / power <= m * (1 + 1e-9)) ?? 10) * power;
  const first = Math.ceil(low / step - 1e-6);
  const last = Math.floor(high / step + 1e-6);
  return Array.from({ length: Math.max(last - first + 1, 0) }, (_, k) => (first + k) * step);
}

/** The numbers of an axis, all with the decimals that their step needs. */
function tickLabels(places, scale) {
  const step = places.length > 1 ? (places[1] - places[0]) / scale : 0;
  let decimals = 0;
  while (step > 0 && decimals < 9 && Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6 * step * 10 ** decimals) decimals += 1;
  return places.map((place) => (step > 0 ? ((place || 0) / scale).toFixed(decimals) : fourDigits(place / scale)).replaceAll("-", "−"));
}

/** A whole number with spaces between groups of three digits. */
function grouped(number) {
  const digits = String(number);
  return digits.length > 4 ? digits.replace(/\B(?=(\d{3})+$)/g, "\u00a0") : digits;
}
