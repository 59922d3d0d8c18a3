// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What was heard of each topic, in bounded memory: where a topic has too much, its older part is thinned, so that the
// past stays, less finely.
import { countUntil } from "./source";
import type { Message } from "./types";

const MOST_BYTES = 48e6;        // of one topic; of clouds, which are few and large
const MOST_CLOUD_BYTES = 160e6;
const MOST_MESSAGES = 20000;
const NEW_PART = 0.4;           // which is not thinned

interface Row { messages: Message[]; bytes: number }

export class History {
  private readonly rows = new Map<string, Row>();
  readonly range = { start_s: Infinity, end_s: -Infinity };

  clear(): void {
    this.rows.clear();
    this.range.start_s = Infinity;
    this.range.end_s = -Infinity;
  }

  topics(): Iterable<string> { return this.rows.keys(); }

  add(message: Message): void {
    let row = this.rows.get(message.topic);
    if (!row) this.rows.set(message.topic, (row = { messages: [], bytes: 0 }));
    const last = row.messages.at(-1);
    if (last && last.t_s > message.t_s) row.messages.splice(this.until(row, message.t_s), 0, message);
    else row.messages.push(message);
    row.bytes += message.data.byteLength;
    this.range.start_s = Math.min(this.range.start_s, message.t_s);
    this.range.end_s = Math.max(this.range.end_s, message.t_s);
    const most = message.topic.endsWith("/points") ? MOST_CLOUD_BYTES : MOST_BYTES;
    if (row.bytes > most || row.messages.length > MOST_MESSAGES) this.thin(row);
  }

  last(topic: string, t_s: number): Message | undefined {
    const row = this.rows.get(topic);
    return row && row.messages[this.until(row, t_s) - 1];
  }

  between(topic: string, from_s: number, to_s: number): Message[] {
    const row = this.rows.get(topic);
    return row ? row.messages.slice(this.until(row, from_s), this.until(row, to_s)) : [];
  }

  bytes(): number {
    let sum = 0;
    for (const row of this.rows.values()) sum += row.bytes;
    return sum;
  }

  private until(row: Row, t_s: number): number {
    return countUntil(row.messages.length, (i) => row.messages[i]!.t_s, t_s);
  }

  private thin(row: Row): void {
    const old = Math.ceil(row.messages.length * (1 - NEW_PART));
    row.messages = row.messages.filter((_, i) => i >= old || i % 2 === 0);
    row.bytes = row.messages.reduce((sum, message) => sum + message.data.byteLength, 0);
  }
}
