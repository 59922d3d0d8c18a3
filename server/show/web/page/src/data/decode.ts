// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// From octets to values by what the channel says of them.
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

import { readCloud } from "./cloud";
import type { Channel, Message } from "./types";

type Decoder = (data: Uint8Array) => unknown;

function decoderOf(channel: Channel): Decoder {
  if (channel.encoding === "json") {
    const text = new TextDecoder();
    return (data) => JSON.parse(text.decode(data));
  }
  if (channel.encoding !== "cdr") throw new Error(`${channel.topic}: encoding ${channel.encoding} is not known here`);
  if (/^sensor_msgs\/(msg\/)?PointCloud2$/.test(channel.schemaName)) return readCloud;
  const reader = new MessageReader(parse(channel.schema, { ros2: true }));
  return (data) => reader.readMessage(data);
}

const decoders = new WeakMap<Channel, Decoder>();
const values = new WeakMap<Message, unknown>();
const failed = new Set<string>();

// undefined where the message cannot be read; that is said once a topic.
export function decode<T>(message: Message): T | undefined {
  if (values.has(message)) return values.get(message) as T | undefined;
  let value: unknown;
  try {
    let decoder = decoders.get(message.channel);
    if (!decoder) decoders.set(message.channel, (decoder = decoderOf(message.channel)));
    value = decoder(message.data);
  } catch (error) {
    if (!failed.has(message.topic)) console.warn(`${message.topic} cannot be read: ${String(error)}`);
    failed.add(message.topic);
  }
  values.set(message, value);
  return value as T | undefined;
}
