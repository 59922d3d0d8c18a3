// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The made-up run as an MCAP file. Chunks are zstd where this machine has the program zstd.
import { spawnSync } from "node:child_process";
import { McapWriter } from "@mcap/core";

import { Program } from "./channels.mjs";
import { Run } from "./messages.mjs";

class Memory {
  parts = [];
  size = 0n;
  position() { return this.size; }
  async write(bytes) {
    this.parts.push(bytes.slice());
    this.size += BigInt(bytes.length);
  }
}

function zstd(bytes) {
  const { status, stdout } = spawnSync("zstd", ["-q", "-3", "-c"], { input: bytes, maxBuffer: 1 << 28 });
  return status === 0 ? { compression: "zstd", compressedData: new Uint8Array(stdout) } : { compression: "", compressedData: bytes };
}

export async function recordingOf({ seconds_s, ...options }) {
  const memory = new Memory();
  const writer = new McapWriter({ writable: memory, chunkSize: 1 << 20, compressChunk: zstd });
  await writer.start({ profile: "ros2", library: "coslam-mock" });
  const program = new Program(new Run(options));
  const ids = new Map();
  for (const channel of program.channels) {
    const schemaId = channel.schema === "" ? 0 : await writer.registerSchema({ name: channel.schemaName, encoding: "ros2msg", data: new TextEncoder().encode(channel.schema) });
    ids.set(channel, await writer.registerChannel({ schemaId, topic: channel.topic, messageEncoding: channel.encoding, metadata: new Map() }));
  }
  const messages = [];
  program.advance(seconds_s, () => true, (channel, t_s, data) => messages.push({ channel, t_s, data }));
  let sequence = 0;
  for (const { channel, t_s, data } of messages) {
    const time = BigInt(Math.round(t_s * 1e6)) * 1000n;
    await writer.addMessage({ channelId: ids.get(channel), sequence: sequence++, logTime: time, publishTime: time, data });
  }
  await writer.end();
  return Buffer.concat(memory.parts);
}
