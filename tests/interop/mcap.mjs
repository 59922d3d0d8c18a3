// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// MCAP files read by @mcap/core, their messages decoded by @foxglove/rosmsg2-serialization: with the definitions that
// ROS 2 ships (@foxglove/rosmsg-msgs-common) where it has them, and with those in the file.
import { McapIndexedReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import common from "@foxglove/rosmsg-msgs-common";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { decompress } from "fzstd";
import { open } from "node:fs/promises";

const shipped = common.ros2jazzy;

// A type and all types in it, the type first.
function definitions(type, seen = new Map()) {
  const definition = shipped[type];
  if (!definition) return undefined;
  if (seen.has(type)) return [...seen.values()];
  seen.set(type, { name: seen.size === 0 ? undefined : type, definitions: definition.definitions });
  for (const field of definition.definitions) {
    if (field.isComplex && !definitions(field.type, seen)) throw new Error(`no definition of ${field.type}`);
  }
  return [...seen.values()];
}

export class Recording {
  static async open(path) {
    const file = await open(path);
    const { size } = await file.stat();
    const readable = {
      size: async () => BigInt(size),
      read: async (offset, length) => {
        const octets = new Uint8Array(Number(length));
        await file.read(octets, 0, Number(length), Number(offset));
        return octets;
      },
    };
    const decompressHandlers = { zstd: (octets, length) => decompress(octets, new Uint8Array(Number(length))) };
    const recording = new Recording();
    recording.reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
    recording.decoders = new Map();
    return recording;
  }

  schemaOf(channel) {
    return this.reader.schemasById.get(channel.schemaId);
  }

  // Decoders of a channel: with the file's definition, and with that of ROS 2 where there is one.
  decodersOf(channel) {
    if (!this.decoders.has(channel.id)) {
      const schema = this.schemaOf(channel);
      const own = parse(new TextDecoder().decode(schema.data), { ros2: true });
      const theirs = definitions(schema.name.replace("/msg/", "/"));
      this.decoders.set(channel.id, {
        own: new MessageReader(own),
        theirs: theirs && new MessageReader(theirs),
      });
    }
    return this.decoders.get(channel.id);
  }

  // Messages in order of time: {topic, type, t, value, independent}.
  async *messages(options = {}) {
    for await (const message of this.reader.readMessages({ validateCrcs: true, ...options })) {
      const channel = this.reader.channelsById.get(message.channelId);
      const out = { topic: channel.topic, t: message.logTime, type: this.schemaOf(channel)?.name };
      if (channel.messageEncoding === "json") {
        yield { ...out, value: JSON.parse(new TextDecoder().decode(message.data)) };
        continue;
      }
      const { own, theirs } = this.decodersOf(channel);
      const value = own.readMessage(message.data);
      if (theirs) {
        const same = text(theirs.readMessage(message.data)) === text(value);
        if (!same) throw new Error(`${channel.topic}: ROS 2's definition of ${out.type} reads something else`);
      }
      yield { ...out, value, independent: theirs !== undefined };
    }
  }
}

function text(value) {
  return JSON.stringify(value, (_, v) =>
    typeof v === "bigint" ? String(v) : ArrayBuffer.isView(v) ? Array.from(v) : v,
  );
}
