// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A server heard over the Foxglove WebSocket protocol. A connection that breaks, or says nothing, is made again after
// pauses that grow.
import { Chronicle } from "./chronicle";
import { decode } from "./decode";
import { History } from "./history";
import type { Source } from "./source";
import { TOPIC, agentTopic, type Channel, type Message, type RunEvent, type RunState } from "./types";

const PROTOCOLS = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
const PAUSES_S = [0.5, 1, 2, 4, 8, 15];
const CONNECT_S = 8;
const SILENT_S = 3;      // shown
const GIVE_UP_S = 12;    // a connection that says nothing for so long is made again
const MESSAGE_DATA = 1;

export type Link =
  | { kind: "connecting" }
  | { kind: "open" }
  | { kind: "silent"; since_ms: number }
  | { kind: "lost"; again_ms: number; tries: number };

export class Live implements Source {
  readonly live = true;
  readonly chronicle = new Chronicle();
  private readonly history = new History();
  readonly range = this.history.range;
  link: Link = { kind: "connecting" };
  heard_ms = 0;          // when something was heard last; 0: nothing yet
  recorded: string | undefined;  // a server that plays a run names the file
  onNewRun: () => void = () => {};
  onFirstFailure: () => void = () => {};

  private socket: WebSocket | undefined;
  private readonly channels = new Map<number, Channel>();       // of id
  private readonly subscribed = new Map<number, Channel>();     // of subscription
  private readonly tracksOf = new Set<string>();
  private nextSubscription = 1;
  private tries = 0;
  private everOpen = false;
  private opened_ms = 0;
  private run = "";
  private readonly timer: number;

  constructor(private readonly url: string) {
    this.connect();
    this.timer = window.setInterval(() => this.watch(), 250);
    window.addEventListener("online", this.retry);
  }

  topics(): Iterable<string> { return this.history.topics(); }
  prepare(): Promise<void> { return Promise.resolve(); }
  last(topic: string, t_s: number): Message | undefined { return this.history.last(topic, t_s); }
  between(topic: string, from_s: number, to_s: number): Message[] { return this.history.between(topic, from_s, to_s); }
  bytes(): number { return this.history.bytes(); }

  want(agent: string, tracks: boolean): void {
    if (tracks) this.tracksOf.add(agent);
    else this.tracksOf.delete(agent);
    this.subscribe();
  }

  close(): void {
    window.clearInterval(this.timer);
    window.removeEventListener("online", this.retry);
    this.drop();
  }

  // At once, without the rest of the pause.
  retry = (): void => { if (this.link.kind === "lost") this.connect(); };

  private connect(): void {
    this.drop();
    this.link = { kind: "connecting" };
    this.opened_ms = performance.now();
    const socket = new WebSocket(this.url, PROTOCOLS);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => {
      this.heard_ms = performance.now();
      this.link = { kind: "open" };
      this.tries = 0;
      if (typeof data === "string") this.hear(JSON.parse(data));
      else this.take(data as ArrayBuffer);
    };
    socket.onclose = () => this.fail();
  }

  private drop(): void {
    if (this.socket) {
      this.socket.onmessage = this.socket.onclose = null;
      this.socket.close();
    }
    this.socket = undefined;
    this.channels.clear();
    this.subscribed.clear();
  }

  private fail(): void {
    this.drop();
    const pause_s = PAUSES_S[Math.min(this.tries, PAUSES_S.length - 1)]!;
    this.tries += 1;
    this.link = { kind: "lost", again_ms: performance.now() + 1000 * pause_s, tries: this.tries };
    if (!this.everOpen && this.tries === 1) this.onFirstFailure();
  }

  private watch(): void {
    const now = performance.now();
    const silent_s = (now - Math.max(this.heard_ms, this.opened_ms)) / 1000;
    if (this.link.kind === "lost" && now >= this.link.again_ms) this.connect();
    else if (this.link.kind === "connecting" && silent_s > CONNECT_S) this.fail();
    else if (this.link.kind === "open" && silent_s > SILENT_S) this.link = { kind: "silent", since_ms: this.heard_ms };
    else if (this.link.kind === "silent" && silent_s > GIVE_UP_S) this.fail();
  }

  private hear(said: { op?: string; [key: string]: unknown }): void {
    if (said.op === "serverInfo") {
      this.everOpen = true;
      this.recorded = (said["metadata"] as Record<string, string> | undefined)?.["recorded"];
    }
    if (said.op === "advertise") {
      for (const channel of said["channels"] as Channel[]) this.channels.set(channel.id, channel);
      this.subscribe();
    }
    if (said.op === "unadvertise") {
      for (const id of said["channelIds"] as number[]) this.forget(id);
    }
  }

  private forget(id: number): void {
    this.channels.delete(id);
    for (const [subscription, channel] of this.subscribed) if (channel.id === id) this.subscribed.delete(subscription);
  }

  private wanted(channel: Channel): boolean {
    const [agent, what] = agentTopic(channel.topic) ?? [];
    if (agent !== undefined) return what !== "tracks" || this.tracksOf.has(agent);
    return (Object.values(TOPIC) as string[]).includes(channel.topic);
  }

  private subscribe(): void {
    if (this.socket?.readyState !== WebSocket.OPEN) return;
    const have = new Map([...this.subscribed].map(([subscription, channel]) => [channel.id, subscription]));
    const subscriptions = [];
    const unwanted = [];
    for (const channel of this.channels.values()) {
      const subscription = have.get(channel.id);
      const wanted = this.wanted(channel);
      if (wanted && subscription === undefined) {
        subscriptions.push({ id: this.nextSubscription, channelId: channel.id });
        this.subscribed.set(this.nextSubscription++, channel);
      } else if (!wanted && subscription !== undefined) {
        unwanted.push(subscription);
        this.subscribed.delete(subscription);
      }
    }
    if (subscriptions.length > 0) this.socket.send(JSON.stringify({ op: "subscribe", subscriptions }));
    if (unwanted.length > 0) this.socket.send(JSON.stringify({ op: "unsubscribe", subscriptionIds: unwanted }));
  }

  private take(buffer: ArrayBuffer): void {
    const view = new DataView(buffer);
    if (buffer.byteLength < 13 || view.getUint8(0) !== MESSAGE_DATA) return;
    const channel = this.subscribed.get(view.getUint32(1, true));
    if (!channel) return;
    const t_s = Number(view.getBigUint64(5, true)) / 1e9;
    const message = { topic: channel.topic, t_s, data: new Uint8Array(buffer, 13), channel };
    if (channel.topic === TOPIC.state) this.takeState(message);
    if (channel.topic === TOPIC.events) {
      const event = decode<RunEvent>(message);
      if (event) this.chronicle.addEvent(event);
    }
    this.history.add(message);
  }

  private takeState(message: Message): void {
    const state = decode<RunState>(message);
    if (!state) return;
    if (this.run !== "" && state.run !== this.run) {
      this.history.clear();
      this.chronicle.clear();
      this.onNewRun();
    }
    this.run = state.run;
    this.chronicle.addState(state);
  }
}
