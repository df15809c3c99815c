// Connects the shapes of a run with the view and the controls of the page, and keeps their state over reloads.
"use strict";

// Viridis, nine stops: equal steps look equal, to colour-blind eyes too.
const RAMP = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"];
const SUN = [224, 168, 0];
const FATES = { escape: "#d6336c", reimpact: "#9c36b5", bound: "#1c7ed6", merged: "#2b8a3e", "": "#868e96" };

const rgb = hex => [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16));
const RAMP_RGB = RAMP.map(rgb);

function rampAt(value) {
  const place = Math.max(0, Math.min(1, value)) * (RAMP.length - 1), i = Math.min(RAMP.length - 2, Math.floor(place));
  return RAMP_RGB[i].map((low, k) => low + (RAMP_RGB[i + 1][k] - low) * (place - i));
}

class Viewer {
  constructor(data) {
    const by = id => document.getElementById(id);
    this.data = data;
    this.timeline = new Timeline(data);
    this.canvas = by("view3d");
    this.view = new View3d(this.canvas, data.reach);
    this.controls = Object.fromEntries(["time", "colour", "spheres", "tiling", "axes", "shed"].map(id => [id, by(id)]));
    this.text = Object.fromEntries(["when", "legend", "low", "high", "scalebar", "losses"].map(id => [id, by(id)]));
    this.labels = [...document.querySelectorAll("#overlay b")];
    this.edges = this.uniqueEdges();
    this.extent = [0, 0, 0];
    this.view.changed = () => this.show();
    this.view.cameraMoved = () => this.save();
    this.view.afterDraw = () => this.annotate();
    this.restore();
    this.theme();
    this.connect();
    this.canvas.dataset.lit = this.view.litPixels();
  }

  uniqueEdges() {
    const { facets } = this.timeline, seen = new Map(), n = this.data.vertices;
    for (let f = 0; f < facets.length; f += 3) {
      for (let k = 0; k < 3; k++) {
        const a = facets[f + k], b = facets[f + (k + 1) % 3];
        seen.set(Math.min(a, b) * n + Math.max(a, b), [a, b]);
      }
    }
    return [...seen.values()].flat();
  }

  connect() {
    const { time, ...others } = this.controls;
    time.addEventListener("input", () => { this.show(); this.save(); });
    Object.values(others).forEach(c => c.addEventListener("change", () => { this.show(); this.save(); }));
    const step = by => { time.value = +time.value + by; this.show(); this.save(); };
    document.getElementById("back").addEventListener("click", () => step(-1));
    document.getElementById("forward").addEventListener("click", () => step(1));
    const play = document.getElementById("play");
    play.addEventListener("click", () => {
      if (this.playing) return this.pause();
      if (time.value === time.max) time.value = 0;
      play.textContent = "Pause";
      const pause = Math.max(60, Math.min(600, 20000 / this.data.frames.length));
      this.playing = setInterval(() => time.value === time.max ? this.pause() : step(1), pause);
      this.show();
    });
    // A link to #configuration=7, in the table of intervals or from outside, shows that configuration.
    const follow = () => {
      const asked = /^#configuration=(\d+)$/.exec(location.hash);
      if (!asked) return;
      const reached = this.data.frames.findLastIndex(f => f.configuration <= +asked[1]);
      time.value = Math.max(0, reached);
      this.show();
      this.save();
      this.canvas.scrollIntoView({ block: "center" });
    };
    addEventListener("hashchange", follow);
    // Loaded again, the page stays where its reader went after following the link.
    if (performance.getEntriesByType("navigation")[0]?.type !== "reload") follow();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.theme());
  }

  pause() {
    clearInterval(this.playing);
    this.playing = null;
    document.getElementById("play").textContent = "Play";
  }

  // Takes the colours of the style sheet.
  theme() {
    const style = getComputedStyle(this.canvas), of = name => rgb(style.getPropertyValue(name).trim());
    this.view.background = of("--stage").map(v => v / 255);
    this.view.rim = of("--moved").map(v => v / 255);
    this.plain = of("--stone");
    this.ink = of("--wire");
    this.retiledColour = of("--retiled");
    this.show();
  }

  show() {
    const { timeline, controls } = this, index = +controls.time.value;
    timeline.seek(index);
    this.showSpheres();
    this.showSurface();
    this.showLines();
    this.view.draw();
    this.describe(this.data.frames[index]);
  }

  showSpheres() {
    const { timeline, view, controls } = this, shown = controls.spheres.checked;
    const colourOf = this.colouring(), body = [], colours = [];
    this.extent = [0, 0, 0];
    for (let sphere = 0; sphere < timeline.radius.length; sphere++) {
      if (!timeline.here[sphere]) continue;
      const place = timeline.inBodyFrame(timeline.position, sphere), radius = timeline.radius[sphere];
      this.extent = this.extent.map((e, k) => Math.max(e, place[k] + radius));
      if (!shown) continue;
      body.push(...place, radius);
      colours.push(...colourOf(sphere), timeline.moved[sphere] * 255);
    }
    for (const loss of controls.shed.checked ? this.lossesHere() : []) {
      body.push(...loss.position, timeline.radius[loss.sphere]);
      colours.push(...rgb(FATES[loss.fate] ?? FATES[""]), 0);
    }
    view.setSpheres(new Float32Array(body), new Uint8Array(colours));
    this.showLegend();
  }

  lossesHere() { return this.data.frames[this.timeline.at].lost; }

  // A function from a sphere to its colour, called in rising number.
  colouring() {
    const { timeline, data, controls } = this;
    const logarithmic = (value, largest) => value > 0 ? rampAt(1 + Math.log10(value / largest) / 3) : this.plain;
    switch (controls.colour.value) {
      case "step": return sphere => logarithmic(timeline.step[sphere], data.largest_step_m);
      case "since": return sphere => logarithmic(timeline.sinceFirst(sphere), data.largest_since_first_m);
      case "potential": {
        const values = timeline.potential();
        let next = 0;
        return () => rampAt(values[next++] / 255);
      }
      default: return () => this.plain;
    }
  }

  showLegend() {
    const { data, controls, text } = this, metres = value => `${value.toPrecision(3)} m`;
    const [low, high] = {
      step: [`${metres(data.largest_step_m / 1000)}, logarithmic`, metres(data.largest_step_m)],
      since: [`${metres(data.largest_since_first_m / 1000)}, logarithmic`, metres(data.largest_since_first_m)],
      potential: data.potential_m2_s2.map(v => `${v.toPrecision(3)} m²/s²`),
    }[controls.colour.value] ?? [];
    text.legend.hidden = !low || !controls.spheres.checked;
    [text.low.textContent, text.high.textContent] = [low ?? "", high ?? ""];
  }

  showSurface() {
    const { timeline, view, controls, edges } = this, { facets } = timeline;
    const shown = controls.tiling.checked;
    view.seeThrough = controls.spheres.checked;
    const place = [];
    for (let v = 0; shown && v < this.data.vertices; v++) place.push(timeline.inBodyFrame(timeline.vertex, v));
    const vertices = list => new Float32Array(list.length * 3).map((_, i) => place[list[(i / 3) | 0]][i % 3]);
    const none = [new Float32Array(0), new Uint8Array(0)];
    if (shown) {
      const colour = new Uint8Array(3 * facets.length);
      for (let f = 0; f < facets.length; f += 3) {
        const changed = [0, 1, 2].some(k => timeline.retiled[facets[f + k]]);
        for (let k = 0; k < 3; k++) colour.set(changed ? this.retiledColour : this.plain, 3 * (f + k));
      }
      view.setFaces(vertices([...facets]), colour);
      view.setEdges(vertices(edges), new Uint8Array(3 * edges.length).map((_, i) => this.ink[i % 3]));
    } else {
      view.setFaces(...none);
      view.setEdges(...none);
    }
  }

  showLines() {
    const { controls, view } = this, reach = this.data.reach, points = [], colours = [];
    const line = (from, to, colour) => { points.push(...from, ...to); colours.push(...colour, ...colour); };
    if (controls.axes.checked) {
      for (let k = 0; k < 3; k++) line([0, 0, 0], [0, 1, 2].map(i => i === k ? this.extent[k] + 0.1 * reach : 0), this.ink);
      const tip = [0, 0, this.extent[2] + 0.22 * reach];
      line([0, 0, this.extent[2]], tip, this.ink);
      this.arrowHead(line, tip, [0, 0, 1], this.ink);
      const sun = this.sunward(), at = far => sun.map(v => v * far * reach);
      line(at(1.35), at(1.1), SUN);
      this.arrowHead(line, at(1.1), sun.map(v => -v), SUN);
    }
    for (const loss of controls.shed.checked ? this.lossesHere() : []) {
      const colour = rgb(FATES[loss.fate] ?? FATES[""]);
      for (let i = 1; i < loss.path.length; i++) line(loss.path[i - 1], loss.path[i], colour);
    }
    view.setLines(new Float32Array(points), new Uint8Array(colours));
  }

  // Four strokes that end in `tip`, along the unit vector `along`.
  arrowHead(line, tip, along, colour) {
    const size = 0.05 * this.data.reach, across = Math.abs(along[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
    const cross = (a, b) => [0, 1, 2].map(i => a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
    const unit = v => v.map(x => x / Math.hypot(...v)), side = unit(cross(along, across)), other = cross(along, side);
    for (const [v, sign] of [[side, 1], [side, -1], [other, 1], [other, -1]]) {
      line(tip, tip.map((t, i) => t - size * (2 * along[i] - sign * 0.8 * v[i])), colour);
    }
  }

  // Unit vector to the Sun at the northern solstice: its latitude is then the obliquity, or what is left of it to 180 degrees.
  sunward() {
    const obliquity = this.data.frames[this.timeline.at].obliquity_deg, latitude = Math.min(obliquity, 180 - obliquity);
    const angle = latitude * Math.PI / 180;
    return [Math.cos(angle), 0, Math.sin(angle)];
  }

  describe(frame) {
    const { timeline, text, controls } = this, moved = timeline.moved.reduce((n, m) => n + m, 0);
    const facts = [`configuration ${frame.configuration} of ${this.data.last}`, `${frame.t_myr.toFixed(4)} Myr`];
    if (frame.configuration < 0) facts.splice(0, 2, frame.title);
    if (frame.period_h) facts.push(`period ${frame.period_h.toFixed(3)} h`);
    facts.push(`obliquity ${frame.obliquity_deg.toFixed(1)}°`);
    if (timeline.at > 0) facts.push(`${moved} moved`);
    if (frame.gone.length) facts.push(`${frame.gone.length} gone`);
    text.when.textContent = facts.join(" · ");
    controls.time.setAttribute("aria-valuetext", facts.join(", "));
    const told = frame.lost.map(l => `sphere ${l.sphere} left at ${l.speed_m_s.toPrecision(2)} m/s${l.fate ? `: ${l.fate}` : ""}`);
    const more = told.length > 8 ? [`and ${told.length - 8} more`] : [];
    text.losses.textContent = told.slice(0, 8).concat(more).join("; ");
    this.canvas.dataset.configuration = frame.configuration;
  }

  // Names of the axes and a bar of round length.
  annotate() {
    const { view, labels, text, controls } = this;
    const { reach } = this.data, beyond = k => this.extent[k] + (k === 2 ? 0.29 : 0.15) * reach;
    labels.forEach((label, k) => {
      const at = k === 3 ? this.sunward().map(v => 1.43 * reach * v) : [0, 1, 2].map(i => i === k ? beyond(k) : 0);
      const [x, y] = view.place(at);
      label.style.transform = `translate(${x}px, ${y}px) translate(-50%, -50%)`;
      label.hidden = !controls.axes.checked;
    });
    const metresPerPixel = 2 * view.camera.half / this.canvas.clientHeight, wanted = 120 * metresPerPixel;
    const decade = 10 ** Math.floor(Math.log10(wanted)), length = [5, 2, 1].find(n => n * decade <= wanted) * decade;
    text.scalebar.style.width = `${length / metresPerPixel}px`;
    text.scalebar.textContent = length >= 1000 ? `${length / 1000} km` : `${length} m`;
  }

  state() {
    const { time, colour, ...boxes } = this.controls;
    const checked = Object.fromEntries(Object.entries(boxes).map(([name, box]) => [name, box.checked]));
    return { time: time.value, last: time.value === time.max, colour: colour.value, checked, camera: this.view.camera };
  }

  // Opened from disk, some browsers keep nothing; then the page starts afresh.
  save() {
    try { sessionStorage.setItem("yorp " + location.pathname, JSON.stringify(this.state())); } catch { /* see above */ }
  }

  restore() {
    const { time, colour, ...boxes } = this.controls;
    // What the browser itself kept in the form fields may be older.
    time.value = time.max;
    let kept = null;
    try { kept = JSON.parse(sessionStorage.getItem("yorp " + location.pathname)); } catch { /* see above */ }
    if (!kept) return;
    // Who looked at the latest shape wants to see the next one.
    time.value = kept.last ? time.max : kept.time;
    colour.value = kept.colour;
    for (const [name, box] of Object.entries(boxes)) box.checked = kept.checked[name];
    this.view.camera = kept.camera;
  }
}

function openViewer() {
  const source = document.getElementById("run-data"), problem = document.getElementById("view-problem");
  if (!source) return null;
  const place = document.getElementById("viewer");
  place.hidden = false;
  try {
    return new Viewer(JSON.parse(source.textContent));
  } catch (error) {
    place.hidden = true;
    problem.textContent = `The 3-D view cannot be drawn here: ${error.message}.`;
    problem.hidden = false;
    return null;
  }
}

// A page of a run that goes on is rewritten on disk; it is loaded again unless somebody is busy with it.
function keepFresh(viewer, seconds) {
  let busy = 0;
  const touched = () => { busy = Date.now(); };
  ["pointerdown", "keydown", "wheel"].forEach(kind => addEventListener(kind, touched, { passive: true }));
  setInterval(() => {
    if (document.hidden || viewer?.playing || Date.now() - busy < 1000 * seconds) return;
    location.reload();
  }, 1000 * seconds);
}

const viewer = openViewer();
const freshEvery = Number(document.documentElement.dataset.freshEvery);
if (freshEvery > 0) keepFresh(viewer, freshEvery);
