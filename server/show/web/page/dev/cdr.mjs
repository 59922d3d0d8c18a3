// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Writes CDR as a server does: XCDR1, little endian, four octets of encapsulation before the data.
export class CdrWriter {
  constructor(capacity = 1024) {
    this.bytes = new Uint8Array(capacity);
    this.view = new DataView(this.bytes.buffer);
    this.bytes[1] = 1;
    this.size = 4;
  }

  #take(width, alignTo = width) {
    const at = 4 + Math.ceil((this.size - 4) / alignTo) * alignTo;
    this.size = at + width;
    if (this.size > this.bytes.length) {
      const larger = new Uint8Array(Math.max(this.size, 2 * this.bytes.length));
      larger.set(this.bytes);
      this.bytes = larger;
      this.view = new DataView(larger.buffer);
    }
    return at;
  }

  u8(value) { this.view.setUint8(this.#take(1), value); return this; }
  i32(value) { this.view.setInt32(this.#take(4), value, true); return this; }
  u32(value) { this.view.setUint32(this.#take(4), value, true); return this; }
  f32(value) { this.view.setFloat32(this.#take(4), value, true); return this; }
  f64(value) { this.view.setFloat64(this.#take(8), value, true); return this; }
  f64s(values) { for (const value of values) this.f64(value); return this; }

  string(text) {
    const octets = new TextEncoder().encode(text);
    this.u32(octets.length + 1);
    this.bytes.set(octets, this.#take(octets.length + 1, 1));
    return this.u8At(this.size - 1, 0);
  }

  u8At(at, value) { this.bytes[at] = value; return this; }

  octets(octets) {
    this.u32(octets.length);
    this.bytes.set(octets, this.#take(octets.length, 1));
    return this;
  }

  sequence(items, write) {
    this.u32(items.length);
    for (const item of items) write(item);
    return this;
  }

  stamp(t_s) { return this.i32(Math.floor(t_s)).u32(Math.round((t_s % 1) * 1e9)); }
  header(t_s, frame) { return this.stamp(t_s).string(frame); }
  // position and quaternion x y z w
  pose(p, q) { return this.f64s(p).f64s(q); }
  done() { return this.bytes.slice(0, this.size); }
}
