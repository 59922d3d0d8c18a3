// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// PointCloud2 by hand: 200,000 points once a second are too many for a reader that makes objects.

interface Field { offset: number; datatype: number }

export interface Cloud {
  frame: string;
  count: number;
  step: number;
  littleEndian: boolean;
  fields: Map<string, Field>;
  data: Uint8Array;
}

class CdrCursor {
  private at = 4;  // after the encapsulation, where alignment counts from
  private readonly view: DataView;
  readonly littleEndian: boolean;

  constructor(private readonly bytes: Uint8Array) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.littleEndian = (this.view.getUint8(1) & 1) === 1;
  }

  u8(): number { return this.view.getUint8(this.at++); }

  u32(): number {
    this.at += (4 - (this.at & 3)) & 3;
    this.at += 4;
    return this.view.getUint32(this.at - 4, this.littleEndian);
  }

  octets(): Uint8Array {
    const size = this.u32();
    this.at += size;
    if (this.at > this.bytes.length) throw new RangeError("a sequence is longer than its message");
    return this.bytes.subarray(this.at - size, this.at);
  }

  text(): string { return new TextDecoder().decode(this.octets()).replace(/\0$/, ""); }
}

export function readCloud(bytes: Uint8Array): Cloud {
  const cdr = new CdrCursor(bytes);
  cdr.u32();
  cdr.u32();
  const frame = cdr.text();
  const height = cdr.u32();
  const width = cdr.u32();
  const fields = new Map<string, Field>();
  for (let left = cdr.u32(); left > 0; --left) {
    const name = cdr.text();
    const offset = cdr.u32();
    const datatype = cdr.u8();
    cdr.u32();
    fields.set(name, { offset, datatype });
  }
  const littleEndian = cdr.u8() === 0;
  const step = cdr.u32();
  cdr.u32();
  const data = cdr.octets();
  const count = Math.min(height * width, step > 0 ? Math.floor(data.length / step) : 0);
  return { frame, count, step, littleEndian, fields, data };
}

type Numbers = Float32Array | Uint32Array | Uint16Array | Uint8Array;
type Getter = (view: DataView, at: number, little: boolean) => number;

// By the datatypes of sensor_msgs/PointField.
const GETTERS: Record<number, Getter> = {
  1: (v, at) => v.getInt8(at),
  2: (v, at) => v.getUint8(at),
  3: (v, at, l) => v.getInt16(at, l),
  4: (v, at, l) => v.getUint16(at, l),
  5: (v, at, l) => v.getInt32(at, l),
  6: (v, at, l) => v.getUint32(at, l),
  7: (v, at, l) => v.getFloat32(at, l),
  8: (v, at, l) => v.getFloat64(at, l),
};

// One field of all points into `out`; false where the cloud has none of that name.
export function column(cloud: Cloud, name: string, out: Numbers): boolean {
  const field = cloud.fields.get(name);
  const get = field && GETTERS[field.datatype];
  if (!field || !get) return false;
  const { data, step, count, littleEndian } = cloud;
  if (field.datatype === 2 || field.datatype === 1) {
    for (let i = 0, at = field.offset; i < count; ++i, at += step) out[i] = data[at]!;
    return true;
  }
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  if (field.datatype === 7) {
    for (let i = 0, at = field.offset; i < count; ++i, at += step) out[i] = view.getFloat32(at, littleEndian);
  } else if (field.datatype === 6) {
    for (let i = 0, at = field.offset; i < count; ++i, at += step) out[i] = view.getUint32(at, littleEndian);
  } else {
    for (let i = 0, at = field.offset; i < count; ++i, at += step) out[i] = get(view, at, littleEndian);
  }
  return true;
}
