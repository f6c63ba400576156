// The numbers of a particle that is picked.
"use strict";

/** Picks a particle of a run, or none with -1, and shows its numbers; they follow the time. */
async function pickParticle(app, panel, particle) {
  for (const other of app.panels) other.picked = null;
  if (particle >= 0) panel.picked = { particle, position: panel.data.positions.slice(3 * particle, 3 * particle + 3) };
  app.picked = particle >= 0 ? { panel, particle } : null;
  await showPicked(app);
  app.draw();
}

/** What is done to what is on the screen. */
const pressing = () => (window.matchMedia("(pointer: coarse)").matches ? "Tap" : "Click");

async function showPicked(app) {
  const { picked: element } = app.controls;
  for (const panel of app.panels) panel.card.hidden = panel !== app.picked?.panel;
  if (!app.picked) {
    element.replaceChildren(made("legend", { textContent: "Particle" }), made("p", { className: "note", textContent: `${pressing()} a particle to read its numbers${app.source.isLive ? "" : ", rounded"}.` }));
    return;
  }
  const { panel, particle } = app.picked;
  const { frame } = panel;
  let found;
  try {
    found = await app.store.particle(panel.number, frame, particle);
  } catch (error) {
    element.replaceChildren(made("legend", { textContent: "Particle" }), made("p", { className: "note", textContent: error.message }));
    return;
  }
  // Another one was picked, or time went on, meanwhile.
  if (app.picked?.panel !== panel || app.picked.particle !== particle || panel.frame !== frame) return;
  const row = (name, text) => made("tr", {}, made("td", { textContent: name }), made("td", { textContent: text }));
  const rows = [];
  if (app.panels.length > 1) rows.push(row("run", panel.run.name));
  if (found.body !== null) rows.push(row("body", found.body));
  found.position.slice(0, panel.run.dimensions).forEach((place, axis) => rows.push(row("xyz"[axis], quantity(place, "m"))));
  for (const { name, values } of found.fields) {
    if (name === "id" || name === "body") continue;
    const { label, unit: unitOf, components } = panel.run.fields.find((field) => field.name === name) ?? { label: name, unit: "", components: [] };
    values.forEach((value, k) => {
      if (values.length > 1 && !counts(components[k] ?? "", panel.run.dimensions)) return;
      const component = values.length > 1 ? ` ${components[k] ?? k}` : "";
      rows.push(row(`${label}${component}`, value === null ? "not finite" : quantity(value, unitOf)));
    });
  }
  const id = found.fields.find((field) => field.name === "id")?.values[0] ?? particle;
  showCard(app, panel, id, found);
  const leave = made("button", { type: "button", textContent: "Leave" });
  leave.addEventListener("click", () => pickParticle(app, panel, -1));
  element.replaceChildren(made("legend", { textContent: `Particle ${id}` }), made("div", { className: "numbers" }, made("table", {}, made("tbody", {}, ...rows))), made("div", { className: "buttons" }, leave));
}

/** In the picture: which particle it is, where it is, and its value of the field that is shown. */
function showCard(app, panel, id, found) {
  const { label, unit: unitOf } = app.colors;
  const value = panel.data.values[found.particle];
  const place = found.position.slice(0, panel.run.dimensions).map((at, axis) => `${"xyz"[axis]} ${quantity(at, "m")}`);
  const line = (className, textContent) => made("div", { className, textContent });
  const leave = made("button", { type: "button", textContent: "×", ariaLabel: "leave the particle" });
  leave.addEventListener("click", () => pickParticle(app, panel, -1));
  const all = made("button", { type: "button", className: "all", textContent: "all its numbers" });
  all.addEventListener("click", () => {
    openDrawer("controls");
    app.controls.picked.scrollIntoView({ block: "start" });
  });
  // Where the particle is not.
  const { height, pixel } = { ...panel.rectangle(), ...panel.measure() };
  const [, up] = panel.camera.seen(found.position);
  const isAbove = up < 0.05 * height * pixel;
  panel.card.classList.toggle("above", isAbove);
  // Below what stands there.
  panel.card.style.top = isAbove ? `${panel.heading.offsetTop + panel.heading.offsetHeight + 6}px` : "";
  const isBody = panel.field === "body";
  panel.card.replaceChildren(
    leave,
    line("", `Particle ${id}${found.body === null ? "" : `, ${found.body}`}`),
    line("value", isBody ? "" : `${label}: ${Number.isFinite(value) ? quantity(value, unitOf) : "not finite"}`),
    line("", place.join(", ")),
    all,
  );
}

/** On a narrow screen, opens the drawer of that name and closes the other; closes it if it is open and `toggle` is given. */
function openDrawer(name, toggle = false) {
  const { classList } = document.body;
  const isShown = !(toggle && classList.contains(`with-${name}`));
  for (const other of ["controls", "history"]) {
    const isOpen = other === name && isShown;
    classList.toggle(`with-${other}`, isOpen);
    const button = document.getElementById(`show-${other}`);
    button.setAttribute("aria-pressed", String(isOpen));
    button.setAttribute("aria-expanded", String(isOpen));
  }
}
