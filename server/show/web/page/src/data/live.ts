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
const GOING_AWAY = 1001;
const NO_ACCESS = 401;

export type Link =
  | { kind: "connecting" }
  | { kind: "open" }
  | { kind: "silent"; since_ms: number }
  | { kind: "lost"; again_ms: number }
  | { kind: "over"; again_ms: number }      // the server ended as it should
  | { kind: "refused"; again_ms: number };  // it wants a token

// Of states: how long they came, and how far their times moved on meanwhile.
const PACE_OVER_S = 20;
const PACE_LEAST_S = 6;
const UTC_S = 1e8;
const PACE_OFF = 0.2;

export const isOfNow = (pace: number | undefined): boolean => pace !== undefined && Math.abs(pace - 1) < PACE_OFF;

export class Live implements Source {
  readonly live = true;
  readonly chronicle = new Chronicle();
  private readonly history = new History();
  readonly range = this.history.range;
  link: Link = { kind: "connecting" };
  tries = 0;             // in vain, since something was heard
  heard_ms = 0;          // when something was heard last; 0: nothing yet
  recorded: string | undefined;  // a server that plays a run names the file
  onNewRun: () => void = () => {};
  onFirstFailure: () => void = () => {};

  private socket: WebSocket | undefined;
  private readonly channels = new Map<number, Channel>();       // of id
  private readonly subscribed = new Map<number, Channel>();     // of subscription
  private readonly tracksOf = new Set<string>();
  private nextSubscription = 1;
  private everOpen = false;
  private opened_ms = 0;
  private run = "";
  private finishing = false;
  private readonly heard: { at_ms: number; t_s: number }[] = [];
  private readonly timer: number;

  // askUrl: something that is answered to whom may read.
  constructor(private readonly url: string, private readonly askUrl: string) {
    this.connect();
    this.timer = window.setInterval(() => this.watch(), 250);
    window.addEventListener("online", this.retry);
  }

  topics(): Iterable<string> { return this.history.topics(); }
  prepare(): Promise<void> { return Promise.resolve(); }
  last(topic: string, t_s: number): Message | undefined { return this.history.last(topic, t_s); }
  between(topic: string, from_s: number, to_s: number): Message[] { return this.history.between(topic, from_s, to_s); }

  // How fast the run goes, where its times are those of files; undefined: not known, or it is not played.
  pace(): number | undefined {
    const [first, last] = [this.heard[0], this.heard.at(-1)];
    if (!first || !last || last.t_s > UTC_S || last.at_ms - first.at_ms < 1000 * PACE_LEAST_S) return undefined;
    return (1000 * (last.t_s - first.t_s)) / (last.at_ms - first.at_ms);
  }

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
  // Lags are by the clock: they say nothing of a run that is played faster or slower, nor before that is known.
  lagHolds(): boolean {
    const last = this.heard.at(-1);
    return last !== undefined && (last.t_s > UTC_S || isOfNow(this.pace()));
  }

  retry = (): void => { if ("again_ms" in this.link) this.connect(); };

  private connect(): void {
    this.drop();
    // What is known of the end stays until something is heard.
    if (this.link.kind === "over" || this.link.kind === "refused") this.link = { ...this.link, again_ms: Infinity };
    else this.link = { kind: "connecting" };
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
    socket.onclose = ({ code }) => this.fail(code === GOING_AWAY);
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

  private fail(ended = false): void {
    this.drop();
    const pause_s = PAUSES_S[Math.min(this.tries, PAUSES_S.length - 1)]!;
    this.tries += 1;
    const again_ms = performance.now() + 1000 * pause_s;
    const over = ended || this.finishing || this.link.kind === "over";
    this.link = { kind: over ? "over" : this.link.kind === "refused" ? "refused" : "lost", again_ms };
    this.heard.length = 0;
    if (this.everOpen) return;
    if (this.tries === 1) this.onFirstFailure();
    void this.ask(again_ms);
  }

  // A WebSocket does not say why it was refused.
  private async ask(again_ms: number): Promise<void> {
    const status = await fetch(this.askUrl).then((answer) => answer.status, () => 0);
    if (status === NO_ACCESS && !this.everOpen) this.link = { kind: "refused", again_ms };
  }

  private watch(): void {
    const now = performance.now();
    const silent_s = (now - Math.max(this.heard_ms, this.opened_ms)) / 1000;
    if ("again_ms" in this.link && this.socket === undefined && now >= this.link.again_ms) this.connect();
    else if ("again_ms" in this.link && this.socket !== undefined && silent_s > CONNECT_S) this.fail();
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
      this.heard.length = 0;
      this.onNewRun();
    }
    this.run = state.run;
    this.finishing = state.finishing === true;
    this.heard.push({ at_ms: performance.now(), t_s: state.t_s });
    while (this.heard.at(-1)!.at_ms - this.heard[0]!.at_ms > 1000 * PACE_OVER_S) this.heard.shift();
    this.chronicle.addState(state);
  }
}
