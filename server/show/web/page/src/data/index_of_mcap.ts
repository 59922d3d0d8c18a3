// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Where each message of an MCAP file lies: the message indexes of its chunks, read once.
import type { IReadable } from "@mcap/core";
import type { McapTypes } from "@mcap/core";

const MESSAGE_INDEX = 0x07;
const RECORD_HEAD = 9;  // opcode and length
const ENTRY = 16;       // time and offset

// Of one channel, in the order of time.
export interface ChannelIndex {
  t_s: Float64Array;
  chunk: Uint32Array;
  offset: Uint32Array;
}

interface Entry { time_ns: bigint; chunk: number; offset: number }

function readEntries(bytes: Uint8Array, chunk: number, into: Map<number, Entry[]>): void {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = 0;
  while (at + RECORD_HEAD <= bytes.byteLength) {
    const size = Number(view.getBigUint64(at + 1, true));
    if (view.getUint8(at) === MESSAGE_INDEX) {
      const channel = view.getUint16(at + RECORD_HEAD, true);
      const end = at + RECORD_HEAD + 6 + view.getUint32(at + RECORD_HEAD + 2, true);
      let entries = into.get(channel);
      if (!entries) into.set(channel, (entries = []));
      for (let row = at + RECORD_HEAD + 6; row + ENTRY <= end; row += ENTRY) {
        entries.push({ time_ns: view.getBigUint64(row, true), chunk, offset: Number(view.getBigUint64(row + 8, true)) });
      }
    }
    at += RECORD_HEAD + size;
  }
}

function sorted(entries: Entry[]): ChannelIndex {
  entries.sort((a, b) => (a.time_ns < b.time_ns ? -1 : a.time_ns > b.time_ns ? 1 : 0));
  return {
    t_s: Float64Array.from(entries, (entry) => Number(entry.time_ns) / 1e9),
    chunk: Uint32Array.from(entries, (entry) => entry.chunk),
    offset: Uint32Array.from(entries, (entry) => entry.offset),
  };
}

export async function indexOf(file: IReadable, chunks: readonly McapTypes.ChunkIndex[]): Promise<Map<number, ChannelIndex>> {
  const entries = new Map<number, Entry[]>();
  for (const [number, chunk] of chunks.entries()) {
    const bytes = await file.read(chunk.chunkStartOffset + chunk.chunkLength, chunk.messageIndexLength);
    readEntries(bytes, number, entries);
  }
  return new Map([...entries].map(([channel, own]) => [channel, sorted(own)]));
}
