// The shapes of a run as the page carries them: each one as the spheres and vertices that differ from the one before,
// decoded only when it is looked at.
"use strict";

function bytesOf(text) {
  const binary = atob(text), bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

// A list of numbered points: the count, the numbers, then three 16-bit coordinates each.
function readPoints(text, wide) {
  const bytes = bytesOf(text), view = new DataView(bytes.buffer), step = wide ? 4 : 2;
  const count = bytes.length / (step + 6), numbers = new Uint32Array(count), points = new Int16Array(3 * count);
  for (let i = 0; i < count; i++) numbers[i] = wide ? view.getUint32(4 * i, true) : view.getUint16(2 * i, true);
  for (let i = 0; i < 3 * count; i++) points[i] = view.getInt16(step * count + 2 * i, true);
  return { numbers, points };
}

class Timeline {
  constructor(data) {
    this.data = data;
    this.frames = data.frames;
    this.radius = new Float32Array(bytesOf(data.radius).buffer);
    this.facets = new Uint32Array(bytesOf(data.facets).buffer);
    this.rewind();
    this.seek(0);
    this.first = this.position.slice();
  }

  rewind() {
    this.at = -1;
    this.here = new Uint8Array(this.radius.length);      // 1: belongs to the body
    this.position = new Float32Array(3 * this.radius.length);
    this.vertex = new Float32Array(3 * this.data.vertices);
  }

  // Brings everything to shape `target`; `moved` and `step` tell what changed since the shape before it.
  seek(target) {
    if (target < this.at) this.rewind();
    while (this.at < target) this.advance();
  }

  advance() {
    const frame = this.frames[++this.at], { unit, wide } = this.data;
    this.step = new Float32Array(this.radius.length);    // displacement since the shape before, m
    this.moved = new Uint8Array(this.radius.length);
    this.retiled = new Uint8Array(this.data.vertices);
    for (const sphere of frame.gone) this.here[sphere] = 0;
    const spheres = readPoints(frame.spheres, wide), vertices = readPoints(frame.vertices, wide);
    for (let i = 0; i < spheres.numbers.length; i++) {
      const sphere = spheres.numbers[i];
      let squares = 0;
      for (let k = 0; k < 3; k++) {
        const value = spheres.points[3 * i + k] * unit;
        squares += (value - this.position[3 * sphere + k]) ** 2;
        this.position[3 * sphere + k] = value;
      }
      if (this.here[sphere]) this.step[sphere] = Math.sqrt(squares);
      this.here[sphere] = 1;
    }
    // A surface follows smaller shifts too; what counts as moved is what the run recorded so.
    for (const sphere of frame.moved) this.moved[sphere] = 1;
    for (let i = 0; i < vertices.numbers.length; i++) {
      const vertex = vertices.numbers[i];
      for (let k = 0; k < 3; k++) this.vertex[3 * vertex + k] = vertices.points[3 * i + k] * unit;
      this.retiled[vertex] = this.at > 0 ? 1 : 0;
    }
  }

  // Displacement of a sphere since the first shape, m.
  sinceFirst(sphere) {
    const at = k => this.position[3 * sphere + k] - this.first[3 * sphere + k];
    return Math.hypot(at(0), at(1), at(2));
  }

  // 0..255 for each sphere of the body in rising number, between the limits of data.potential_m2_s2.
  potential() { return bytesOf(this.frames[this.at].potential); }

  // Point number `index` of `points` in the body frame of the present shape, m.
  inBodyFrame(points, index) {
    const { axes, centre } = this.frames[this.at];
    const d = [0, 1, 2].map(k => points[3 * index + k] - centre[k]);
    return [0, 3, 6].map(row => axes[row] * d[0] + axes[row + 1] * d[1] + axes[row + 2] * d[2]);
  }
}
