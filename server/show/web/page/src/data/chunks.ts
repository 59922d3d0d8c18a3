// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The chunks of an MCAP file, unpacked when they are needed; the last ones used are kept.
import type { IReadable, McapTypes } from "@mcap/core";
import { decompress } from "fzstd";

const CHUNK_HEAD = 9 + 8 + 8 + 8 + 4;  // record, first and last time, unpacked size, check sum; then the name, the size
const MESSAGE_HEAD = 9 + 2 + 4 + 8 + 8;
const MOST_BYTES = 192e6;

export class Chunks {
  private readonly unpacked = new Map<number, Uint8Array>();  // the one used last is last
  private readonly loading = new Map<number, Promise<void>>();
  private bytes = 0;

  constructor(private readonly file: IReadable, private readonly chunks: readonly McapTypes.ChunkIndex[]) {}

  has(chunk: number): boolean { return this.unpacked.has(chunk); }

  load(chunk: number): Promise<void> {
    if (this.unpacked.has(chunk)) return Promise.resolve();
    let promise = this.loading.get(chunk);
    if (!promise) {
      promise = this.unpack(chunk).finally(() => this.loading.delete(chunk));
      this.loading.set(chunk, promise);
    }
    return promise;
  }

  // The data of the message that lies there; undefined while its chunk is not loaded.
  message(chunk: number, offset: number): Uint8Array | undefined {
    const bytes = this.unpacked.get(chunk);
    if (!bytes) return undefined;
    this.unpacked.delete(chunk);
    this.unpacked.set(chunk, bytes);
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const size = Number(view.getBigUint64(offset + 1, true));
    return bytes.subarray(offset + MESSAGE_HEAD, offset + 9 + size);
  }

  private async unpack(number: number): Promise<void> {
    const chunk = this.chunks[number]!;
    const record = await this.file.read(chunk.chunkStartOffset, chunk.chunkLength);
    const view = new DataView(record.buffer, record.byteOffset, record.byteLength);
    const bytes = unpack(chunk, record.subarray(CHUNK_HEAD + 4 + view.getUint32(CHUNK_HEAD, true) + 8));
    this.unpacked.set(number, bytes);
    this.bytes += bytes.byteLength;
    for (const [oldest, old] of this.unpacked) {
      if (this.bytes <= MOST_BYTES || oldest === number) break;
      this.unpacked.delete(oldest);
      this.bytes -= old.byteLength;
    }
  }
}

function unpack(chunk: McapTypes.ChunkIndex, packed: Uint8Array): Uint8Array {
  if (chunk.compression === "") return packed.slice();
  if (chunk.compression !== "zstd") throw new Error(`its chunks are compressed as ${chunk.compression}; zstd and none are read`);
  return decompress(packed, new Uint8Array(Number(chunk.uncompressedSize)));
}
