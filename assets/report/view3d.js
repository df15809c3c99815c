// Draws spheres, a triangle surface and lines with WebGL2, as seen from infinitely far away (so that lengths can be
// read off), and lets mouse, fingers and keys turn and scale the view. Knows nothing of runs.
"use strict";

const SPHERE_VERTEX = `#version 300 es
uniform mat3 turn; uniform vec2 scale; uniform float depth;
in vec2 corner; in vec4 sphere; in vec4 colour;
out vec2 at; out vec4 tint; out vec2 height;
void main() {
  vec3 eye = turn * sphere.xyz;
  at = corner * 1.04; tint = colour; height = vec2(eye.z, sphere.w);
  gl_Position = vec4((eye.xy + at * sphere.w) * scale, -eye.z * depth, 1.0);
}`;
// Each sphere is a disc whose fragments carry the height and the normal of the sphere: round at any magnification.
const SPHERE_FRAGMENT = `#version 300 es
precision highp float;
uniform float depth; uniform vec3 rim;
in vec2 at; in vec4 tint; in vec2 height;
out vec4 pixel;
void main() {
  float r = length(at), soft = fwidth(r), cover = 1.0 - smoothstep(1.0 - soft, 1.0 + soft, r);
  if (cover <= 0.0) discard;
  vec3 normal = vec3(at, sqrt(max(0.0, 1.0 - r * r)));
  gl_FragDepth = 0.5 - 0.5 * depth * (height.x + normal.z * height.y);
  float light = 0.42 + 0.58 * max(0.0, dot(normal, vec3(-0.40, 0.53, 0.75)));
  vec3 body = tint.rgb * light * (1.0 - 0.45 * smoothstep(0.80, 1.0, r));
  float marked = tint.a * smoothstep(0.78 - soft, 0.78 + soft, r);
  pixel = vec4(mix(body, rim, marked), cover);
}`;
const FACE_VERTEX = `#version 300 es
uniform mat3 turn; uniform vec2 scale; uniform float depth;
in vec3 vertex; in vec3 colour;
out vec3 eye; out vec3 tint;
void main() { eye = turn * vertex; tint = colour; gl_Position = vec4(eye.xy * scale, -eye.z * depth, 1.0); }`;
const FACE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 eye; in vec3 tint;
out vec4 pixel;
void main() {
  vec3 normal = normalize(cross(dFdx(eye), dFdy(eye)));
  float light = 0.36 + 0.64 * max(0.0, dot(normal, vec3(-0.40, 0.53, 0.75)));
  pixel = vec4(tint * light, 1.0);
}`;
const LINE_VERTEX = `#version 300 es
uniform mat3 turn; uniform vec2 scale; uniform float depth; uniform float lift;
in vec3 vertex; in vec3 colour;
out vec3 tint;
void main() { vec3 eye = turn * vertex; tint = colour; gl_Position = vec4(eye.xy * scale, -eye.z * depth - lift, 1.0); }`;
const LINE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 tint;
out vec4 pixel;
void main() { pixel = vec4(tint, 1.0); }`;

class View3d {
  // Throws if the browser has no WebGL2. `reach`: radius of a sphere around all that will be drawn near the body, m.
  constructor(canvas, reach) {
    this.canvas = canvas;
    this.reach = reach;
    this.camera = View3d.standard(reach);
    this.background = [1, 1, 1];
    this.rim = [1, 0.4, 0];
    this.changed = () => {};
    // Whether the surface shows what lies within: then only its edges are drawn.
    this.seeThrough = false;
    this.start();
    canvas.addEventListener("webglcontextlost", event => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => { this.start(); this.changed(); });
    new ResizeObserver(() => this.draw()).observe(canvas);
    this.listen();
  }

  // Longitude and latitude of the eye, degrees; half the height of what is seen, m.
  static standard(reach) { return { longitude: -60, latitude: 25, half: reach * 1.3 }; }

  start() {
    const gl = this.canvas.getContext("webgl2", { antialias: true, alpha: false });
    if (!gl) throw new Error("WebGL2 is not available");
    this.gl = gl;
    this.spheres = this.program(SPHERE_VERTEX, SPHERE_FRAGMENT, ["turn", "scale", "depth", "rim"]);
    this.faces = this.program(FACE_VERTEX, FACE_FRAGMENT, ["turn", "scale", "depth"]);
    this.lines = this.program(LINE_VERTEX, LINE_FRAGMENT, ["turn", "scale", "depth", "lift"]);
    const array = (made, fields) => this.attributes(made, fields);
    this.sphereArray = array(this.spheres, { corner: [2, gl.FLOAT, 0], sphere: [4, gl.FLOAT, 1], colour: [4, gl.UNSIGNED_BYTE, 1] });
    gl.bindBuffer(gl.ARRAY_BUFFER, this.sphereArray.buffers.corner);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]), gl.STATIC_DRAW);
    const coloured = { vertex: [3, gl.FLOAT, 0], colour: [3, gl.UNSIGNED_BYTE, 0] };
    this.faceArray = array(this.faces, coloured);
    this.edgeArray = array(this.lines, coloured);
    this.lineArray = array(this.lines, coloured);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
  }

  program(vertex, fragment, uniforms) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
      throw new Error("shader: " + gl.getProgramInfoLog(program));
    }
    return { program, at: Object.fromEntries(uniforms.map(name => [name, gl.getUniformLocation(program, name)])) };
  }

  // One buffer per field: [components, type, divisor].
  attributes(made, fields) {
    const gl = this.gl, buffers = {}, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    for (const [name, [size, type, divisor]] of Object.entries(fields)) {
      const place = gl.getAttribLocation(made.program, name);
      buffers[name] = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffers[name]);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, type, type === gl.UNSIGNED_BYTE, 0, 0);
      gl.vertexAttribDivisor(place, divisor);
    }
    gl.bindVertexArray(null);
    return { array, buffers, count: 0 };
  }

  fill(target, count, fields) {
    const gl = this.gl;
    target.count = count;
    for (const [name, values] of Object.entries(fields)) {
      gl.bindBuffer(gl.ARRAY_BUFFER, target.buffers[name]);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
    }
  }

  // Centres and radii (4 floats each, m), colours (4 bytes each; the last one is 255 for a marked sphere).
  setSpheres(sphere, colour) { this.fill(this.sphereArray, sphere.length / 4, { sphere, colour }); }
  // Three vertices per facet with a colour each.
  setFaces(vertex, colour) { this.fill(this.faceArray, vertex.length / 3, { vertex, colour }); }
  // Two vertices per line with a colour each; edges belong to the surface, lines stand alone.
  setEdges(vertex, colour) { this.fill(this.edgeArray, vertex.length / 3, { vertex, colour }); }
  setLines(vertex, colour) { this.fill(this.lineArray, vertex.length / 3, { vertex, colour }); }

  // Rows: right, up, towards the eye (column-major for WebGL).
  rows() {
    const { longitude, latitude } = this.camera, d = Math.PI / 180;
    const [cl, sl, cb, sb] = [Math.cos(longitude * d), Math.sin(longitude * d), Math.cos(latitude * d), Math.sin(latitude * d)];
    return [[-sl, cl, 0], [-sb * cl, -sb * sl, cb], [cb * cl, cb * sl, sb]];
  }

  // Where a point of the body is on the canvas, CSS pixels.
  place(point) {
    const [right, up] = this.rows(), { clientWidth: w, clientHeight: h } = this.canvas;
    const dot = row => row[0] * point[0] + row[1] * point[1] + row[2] * point[2];
    const pixels = h / 2 / this.camera.half;
    return [w / 2 + dot(right) * pixels, h / 2 - dot(up) * pixels];
  }

  draw() {
    const gl = this.gl, canvas = this.canvas, ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [w, h] = [canvas.clientWidth, canvas.clientHeight].map(v => Math.max(1, Math.round(v * ratio)));
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    gl.viewport(0, 0, w, h);
    gl.clearColor(...this.background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const rows = this.rows(), half = this.camera.half;
    const turn = [0, 1, 2].flatMap(column => rows.map(row => row[column]));
    const depth = 1 / this.far;
    const begin = made => {
      gl.useProgram(made.program);
      gl.uniformMatrix3fv(made.at.turn, false, turn);
      gl.uniform2f(made.at.scale, h / w / half, 1 / half);
      gl.uniform1f(made.at.depth, depth);
    };
    const strokes = (target, lift) => {
      begin(this.lines);
      gl.uniform1f(this.lines.at.lift, lift);
      gl.bindVertexArray(target.array);
      gl.drawArrays(gl.LINES, 0, target.count);
    };
    const faces = () => {
      begin(this.faces);
      gl.bindVertexArray(this.faceArray.array);
      gl.drawArrays(gl.TRIANGLES, 0, this.faceArray.count);
    };
    if (this.faceArray.count && !this.seeThrough) faces();
    if (this.sphereArray.count) {
      begin(this.spheres);
      gl.uniform3f(this.spheres.at.rim, ...this.rim);
      gl.enable(gl.SAMPLE_ALPHA_TO_COVERAGE);
      gl.bindVertexArray(this.sphereArray.array);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.sphereArray.count);
      gl.disable(gl.SAMPLE_ALPHA_TO_COVERAGE);
    }
    if (this.lineArray.count) strokes(this.lineArray, 0);
    // Surface and spheres cut through each other: over spheres only the surface's edges are drawn, those in front.
    if (this.faceArray.count && this.seeThrough) {
      gl.clear(gl.DEPTH_BUFFER_BIT);
      gl.colorMask(false, false, false, false);
      faces();
      gl.colorMask(true, true, true, true);
    }
    // Edges lie in their facets: lifted a little towards the eye, they are not swallowed by them.
    if (this.edgeArray.count) strokes(this.edgeArray, 0.004 * this.reach * depth);
    gl.bindVertexArray(null);
    this.afterDraw?.();
  }

  // How far from the body's centre something may be drawn, m.
  get far() { return this.reach * 12; }

  // Number of pixels in the middle of the canvas that are not background: 0 if nothing was drawn.
  litPixels() {
    const gl = this.gl, size = 64, pixels = new Uint8Array(4 * size * size);
    gl.readPixels((this.canvas.width - size) / 2, (this.canvas.height - size) / 2, size, size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const empty = this.background.map(v => Math.round(v * 255));
    let lit = 0;
    for (let i = 0; i < pixels.length; i += 4) lit += empty.some((v, k) => Math.abs(pixels[i + k] - v) > 3);
    return lit;
  }

  turnBy(longitude, latitude) {
    const camera = this.camera;
    camera.longitude = (camera.longitude + longitude) % 360;
    camera.latitude = Math.max(-90, Math.min(90, camera.latitude + latitude));
    this.moved();
  }

  scaleBy(factor) {
    this.camera.half = Math.max(this.reach * 0.05, Math.min(this.reach * 10, this.camera.half * factor));
    this.moved();
  }

  look(camera) { Object.assign(this.camera, camera); this.moved(); }

  moved() { this.draw(); this.cameraMoved?.(); }

  listen() {
    const canvas = this.canvas, fingers = new Map();
    const spread = () => { const [a, b] = [...fingers.values()]; return Math.hypot(a.x - b.x, a.y - b.y); };
    canvas.addEventListener("pointerdown", event => {
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    canvas.addEventListener("pointermove", event => {
      const last = fingers.get(event.pointerId);
      if (!last) return;
      const before = fingers.size === 2 ? spread() : 0, now = { x: event.clientX, y: event.clientY };
      fingers.set(event.pointerId, now);
      if (fingers.size === 1) this.turnBy((last.x - now.x) * 0.4, (now.y - last.y) * 0.4);
      else if (fingers.size === 2 && before > 0) this.scaleBy(before / Math.max(1, spread()));
    });
    const lift = event => fingers.delete(event.pointerId);
    canvas.addEventListener("pointerup", lift);
    canvas.addEventListener("pointercancel", lift);
    // The wheel scrolls the page until the view has been clicked or tabbed to.
    canvas.addEventListener("wheel", event => {
      if (document.activeElement !== canvas) return;
      event.preventDefault();
      this.scaleBy(Math.exp(Math.max(-1, Math.min(1, event.deltaY * 0.002))));
    }, { passive: false });
    const keys = {
      ArrowLeft: () => this.turnBy(-5, 0), ArrowRight: () => this.turnBy(5, 0),
      ArrowUp: () => this.turnBy(0, 5), ArrowDown: () => this.turnBy(0, -5),
      "+": () => this.scaleBy(1 / 1.15), "=": () => this.scaleBy(1 / 1.15), "-": () => this.scaleBy(1.15),
      "0": () => this.look(View3d.standard(this.reach)),
      x: () => this.look({ longitude: 0, latitude: 0 }), y: () => this.look({ longitude: -90, latitude: 0 }),
      z: () => this.look({ longitude: -90, latitude: 90 }),
    };
    canvas.addEventListener("keydown", event => {
      const act = keys[event.key];
      if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      act();
    });
  }
}
