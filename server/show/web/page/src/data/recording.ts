// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A recorded run: an MCAP file with the channels of the live view.
import { McapIndexedReader, McapStreamReader, type IReadable } from "@mcap/core";
import { decompress } from "fzstd";

import { Chronicle } from "./chronicle";
import { Chunks } from "./chunks";
import { decode } from "./decode";
import { History } from "./history";
import { indexOf, type ChannelIndex } from "./index_of_mcap";
import { countUntil, type Source } from "./source";
import { TOPIC, agentTopic, type Channel, type Message, type RunEvent, type RunState } from "./types";

const BACK_S = 2.5;          // how far back trails reach
const AHEAD_S = 1;           // loaded before it is needed
const MOST_HELD = 200;       // messages of a topic that keep their identity
const STREAM_STEP = 4 << 20;

interface Row { channel: Channel; index: ChannelIndex; held: Map<number, Message> }

class Recording implements Source {
  readonly live = false;
  readonly chronicle = new Chronicle();
  readonly range: { start_s: number; end_s: number };
  private readonly wantedTracks = new Set<string>();
  private closed = false;

  constructor(private readonly rows: Map<string, Row>, private readonly chunks: Chunks, start_s: number, end_s: number) {
    this.range = { start_s, end_s };
    void this.readChronicle();
  }

  topics(): Iterable<string> { return this.rows.keys(); }
  close(): void { this.closed = true; }

  want(agent: string, tracks: boolean): void {
    if (tracks) this.wantedTracks.add(agent);
    else this.wantedTracks.delete(agent);
  }

  async prepare(t_s: number): Promise<void> {
    const needed = new Set<number>();
    for (const [topic, row] of this.rows) {
      const [agent, what] = agentTopic(topic) ?? [];
      if (what === "tracks" && !this.wantedTracks.has(agent!)) continue;
      const to = this.until(row, t_s);
      const trails = topic === TOPIC.moving || topic === TOPIC.objects;
      const from = trails ? this.until(row, t_s - BACK_S) : to - 1;
      for (let i = Math.max(0, from); i < to; ++i) needed.add(row.index.chunk[i]!);
      if (trails && to < row.index.t_s.length && row.index.t_s[to]! < t_s + AHEAD_S) void this.chunks.load(row.index.chunk[to]!);
    }
    await Promise.all([...needed].map((chunk) => this.chunks.load(chunk)));
  }

  last(topic: string, t_s: number): Message | undefined {
    const row = this.rows.get(topic);
    return row && this.message(row, this.until(row, t_s) - 1);
  }

  between(topic: string, from_s: number, to_s: number): Message[] {
    const row = this.rows.get(topic);
    const out: Message[] = [];
    if (!row) return out;
    for (let i = this.until(row, from_s), end = this.until(row, to_s); i < end; ++i) {
      const message = this.message(row, i);
      if (message) out.push(message);
    }
    return out;
  }

  private until(row: Row, t_s: number): number {
    return countUntil(row.index.t_s.length, (i) => row.index.t_s[i]!, t_s);
  }

  private message(row: Row, at: number): Message | undefined {
    if (at < 0) return undefined;
    const held = row.held.get(at);
    if (held) return held;
    const data = this.chunks.message(row.index.chunk[at]!, row.index.offset[at]!);
    if (!data) return undefined;
    const message = { topic: row.channel.topic, t_s: row.index.t_s[at]!, data, channel: row.channel };
    row.held.set(at, message);
    if (row.held.size > MOST_HELD) row.held.delete(row.held.keys().next().value!);
    return message;
  }

  // States and events of the whole run, chunk after chunk.
  private async readChronicle(): Promise<void> {
    const rows = [TOPIC.state, TOPIC.events].map((topic) => this.rows.get(topic)).filter((row) => row !== undefined);
    const order = rows.flatMap((row) => Array.from(row.index.t_s, (t_s, at) => ({ row, at, t_s }))).sort((a, b) => a.t_s - b.t_s);
    for (const { row, at } of order) {
      if (this.closed) return;
      const chunk = row.index.chunk[at]!;
      if (!this.chunks.has(chunk)) await this.chunks.load(chunk).then(() => new Promise((done) => setTimeout(done)));
      const message = this.message(row, at);
      if (message) take(this.chronicle, message);
    }
  }
}

function take(chronicle: Chronicle, message: Message): void {
  if (message.topic === TOPIC.state) {
    const state = decode<RunState>(message);
    if (state) chronicle.addState(state);
  } else if (message.topic === TOPIC.events) {
    const event = decode<RunEvent>(message);
    if (event) chronicle.addEvent(event);
  }
}

// A file without an index, as one that was cut off: read from its start, held in memory.
class Heard implements Source {
  readonly live = false;
  readonly chronicle = new Chronicle();
  private readonly history = new History();
  readonly range = this.history.range;

  add(message: Message): void {
    this.history.add(message);
    take(this.chronicle, message);
  }

  topics(): Iterable<string> { return this.history.topics(); }
  prepare(): Promise<void> { return Promise.resolve(); }
  last(topic: string, t_s: number): Message | undefined { return this.history.last(topic, t_s); }
  between(topic: string, from_s: number, to_s: number): Message[] { return this.history.between(topic, from_s, to_s); }
  want(): void {}
  close(): void {}
}

async function readThrough(file: IReadable): Promise<Source> {
  const heard = new Heard();
  const reader = new McapStreamReader({ decompressHandlers: { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) } });
  const schemas = new Map<number, { name: string; text: string }>();
  const channels = new Map<number, Channel>();
  const size = await file.size();
  for (let at = 0n; at < size; at += BigInt(STREAM_STEP)) {
    const left = size - at;
    reader.append(await file.read(at, left < STREAM_STEP ? left : BigInt(STREAM_STEP)));
    for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
      if (record.type === "Schema") schemas.set(record.id, { name: record.name, text: new TextDecoder().decode(record.data) });
      if (record.type === "Channel") channels.set(record.id, channelOf(record, schemas.get(record.schemaId)));
      const channel = record.type === "Message" ? channels.get(record.channelId) : undefined;
      if (record.type !== "Message" || !channel) continue;
      heard.add({ topic: channel.topic, t_s: Number(record.logTime) / 1e9, data: record.data.slice(), channel });
    }
  }
  return heard;
}

function channelOf(record: { id: number; topic: string; messageEncoding: string }, schema?: { name: string; text: string }): Channel {
  return { id: record.id, topic: record.topic, encoding: record.messageEncoding, schemaName: schema?.name ?? "", schema: schema?.text ?? "" };
}

async function readIndexed(file: IReadable): Promise<Source> {
  const reader = await McapIndexedReader.Initialize({ readable: file });
  if (reader.chunkIndexes.length === 0) throw new Error("there is no index of chunks");
  const index = await indexOf(file, reader.chunkIndexes);
  const rows = new Map<string, Row>();
  for (const [id, record] of reader.channelsById) {
    const schema = reader.schemasById.get(record.schemaId);
    const channel = channelOf(record, schema && { name: schema.name, text: new TextDecoder().decode(schema.data) });
    const own = index.get(id);
    if (own && own.t_s.length > 0) rows.set(channel.topic, { channel, index: own, held: new Map() });
  }
  const times = [...rows.values()].map((row) => row.index.t_s);
  const start_s = Math.min(...times.map((t_s) => t_s[0]!));
  const end_s = Math.max(...times.map((t_s) => t_s.at(-1)!));
  return new Recording(rows, new Chunks(file, reader.chunkIndexes), start_s, end_s);
}

const readableOf = (blob: Blob): IReadable => ({
  size: () => Promise.resolve(BigInt(blob.size)),
  read: async (offset, size) => new Uint8Array(await blob.slice(Number(offset), Number(offset + size)).arrayBuffer()),
});

const MAGIC = [0x89, 0x4d, 0x43, 0x41, 0x50];

// Throws an Error whose message says what is wrong with the file.
export async function openRecording(blob: Blob): Promise<Source> {
  const head = new Uint8Array(await blob.slice(0, MAGIC.length).arrayBuffer());
  if (MAGIC.some((octet, i) => head[i] !== octet)) throw new Error("it is no MCAP file");
  const file = readableOf(blob);
  const source = await readIndexed(file).catch((error: unknown) => {
    console.info(`read from its start: ${String(error)}`);
    return readThrough(file);
  });
  if (!Number.isFinite(source.range.start_s)) throw new Error("it holds no messages");
  if (![...source.topics()].some((topic) => topic.startsWith("/coslam/"))) throw new Error("it holds nothing of CoSLAM");
  return source;
}
