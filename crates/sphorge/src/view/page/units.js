// Numbers with units as people type them, read as the options of the program are.
"use strict";

/** What units are in SI, their exponents of metre, kilogram, second and kelvin, and whether they take prefixes: those of decks. */
const UNITS = {
  m: [1, [1, 0, 0, 0], true],
  in: [0.0254, [1, 0, 0, 0], false],
  ft: [0.3048, [1, 0, 0, 0], false],
  g: [1e-3, [0, 1, 0, 0], true],
  t: [1e3, [0, 1, 0, 0], false],
  lb: [0.45359237, [0, 1, 0, 0], false],
  s: [1, [0, 0, 1, 0], true],
  min: [60, [0, 0, 1, 0], false],
  h: [3600, [0, 0, 1, 0], false],
  K: [1, [0, 0, 0, 1], false],
  N: [1, [1, 1, -2, 0], true],
  Pa: [1, [-1, 1, -2, 0], true],
  bar: [1e5, [-1, 1, -2, 0], true],
  psi: [6894.757293168, [-1, 1, -2, 0], false],
  ksi: [6894757.293168, [-1, 1, -2, 0], false],
  J: [1, [2, 1, -2, 0], true],
  W: [1, [2, 1, -3, 0], true],
  rad: [1, [0, 0, 0, 0], true],
  deg: [Math.PI / 180, [0, 0, 0, 0], false],
  "°": [Math.PI / 180, [0, 0, 0, 0], false],
  rev: [2 * Math.PI, [0, 0, 0, 0], false],
  rpm: [Math.PI / 30, [0, 0, -1, 0], false],
  "%": [0.01, [0, 0, 0, 0], false],
};
const UNIT_PREFIXES = { n: 1e-9, u: 1e-6, "µ": 1e-6, "μ": 1e-6, m: 1e-3, c: 1e-2, d: 0.1, k: 1e3, M: 1e6, G: 1e9 };
const CELSIUS = ["degC", "°C"];

/** A symbol with or without a prefix; none if there is none. */
function unitSymbol(name) {
  if (Object.hasOwn(UNITS, name)) return UNITS[name];
  const [prefix, rest] = [name.slice(0, 1), name.slice(1)];
  if (!Object.hasOwn(UNIT_PREFIXES, prefix) || !Object.hasOwn(UNITS, rest) || !UNITS[rest][2]) return null;
  return [UNIT_PREFIXES[prefix] * UNITS[rest][0], UNITS[rest][1]];
}

/** Factor and exponents of a product or quotient of units such as `J/(kg K)`; `{ wrong }` says what is none. */
function readUnit(text) {
  const words = text.replaceAll("²", "^2").replaceAll("³", "^3").match(/[()/*·⋅]|\^?[-+]?\d+|[^\s()/*·⋅^\d+-]+|\S/g) ?? [];
  let at = 0;
  const product = (depth) => {
    let [factor, exponents, isDivided] = [1, [0, 0, 0, 0], false];
    while (at < words.length && words[at] !== ")") {
      if ("/*·⋅".includes(words[at])) {
        isDivided = words[at] === "/";
        at += 1;
      }
      const word = words[at] ?? "";
      at += 1;
      let part = word === "1" ? [1, [0, 0, 0, 0]] : unitSymbol(word);
      if (word === "(" && depth < 8) {
        part = product(depth + 1);
        if (words[at] !== ")") part = null;
        at += 1;
      }
      if (!part) return null;
      let power = 1;
      if (/^\^?[-+]?\d+$/.test(words[at] ?? "")) {
        power = Number(words[at].replace("^", ""));
        at += 1;
      }
      if (isDivided) power = -power;
      factor *= part[0] ** power;
      exponents = exponents.map((own, k) => own + power * part[1][k]);
      isDivided = false;
    }
    return [factor, exponents];
  };
  const found = product(0);
  return found && at >= words.length && Number.isFinite(found[0]) ? found : null;
}

/** A value in the SI unit `own` as a user types it: with a unit, or a number of `shown` ones, `scale` each. What is wrong with it is thrown. */
function readQuantity(text, [scale, shown], own) {
  const [, number, unit] = /^\s*([-+−]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[-+−]?\d+)?)?\s*(.*?)\s*$/i.exec(text);
  const value = Number((number ?? "").replace(",", ".").replaceAll("−", "-"));
  const write = `write a number such as ${own ? `0.5 or 2 ${shown.startsWith("10") ? own : shown}` : "0.5"}.`;
  if (number === undefined || !Number.isFinite(value)) throw new Error(`${text.trim() ? `“${text.trim()}” is no number` : "There is no number"}: ${write}`);
  if (!unit) return value * scale;
  if (CELSIUS.includes(unit) && own === "K") return value + 273.15;
  const found = readUnit(unit);
  if (!found && !CELSIUS.includes(unit)) throw new Error(`“${unit}” is no unit: ${write}`);
  const [factor, exponents] = readUnit(own);
  if (!found || found[1].some((power, k) => power !== exponents[k])) throw new Error(`This field is ${own ? `in ${shown}` : "a pure number"}, not in “${unit}”: ${write}`);
  return (value * found[0]) / factor;
}
