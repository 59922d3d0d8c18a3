// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A server of the made-up run: the page, the Foxglove WebSocket, explain. For developing and testing the page.
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { WebSocketServer } from "ws";

import { Program } from "./channels.mjs";
import { Run } from "./messages.mjs";

const TYPES = { html: "text/html; charset=utf-8", js: "text/javascript", css: "text/css", svg: "image/svg+xml", txt: "text/plain; charset=utf-8" };

const LIVES = {
  point: (id) => `point ${id}, in seconds of the run
     0.633 s  It was made by cam0 from two views 0.31 rad apart, and is on trial.
     1.500 s  It became static: 8 views within 1.2 sigma.
     4.233 s  cam1 found it (Mahalanobis distance 0.9).
    14.000 s  Its map became part of map 1.
points.csv has it: static, at (0.41, -0.22, 3.05), standard deviation 0.021, 46 views from 0.633 s to 31.200 s.
covariance 0.00002 0.000004 0.00006 0.00003 0.00002 0.00038
`,
  camera: (id) => `camera ${id}, in seconds of the run
     0.200 s  It joined.
     0.600 s  It was put into map 1 with 214 points.
    20.000 s  It lost its pose: 5 of its points are seen, 12 are needed.
    26.000 s  It had a pose again.
`,
};

// One grey pixel.
const IMAGE = Buffer.from("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNoAAAAggCBd81ytgAAAABJRU5ErkJggg==", "base64");

class Client {
  constructor(socket, program) {
    this.socket = socket;
    this.subscriptions = new Map();  // of channel
    const send = (value) => socket.send(JSON.stringify(value));
    send({ op: "serverInfo", name: "coslam", capabilities: ["time"], supportedEncodings: ["cdr", "json"], sessionId: "1" });
    send({ op: "advertise", channels: program.channels.map(({ make, rate_hz, type, ...rest }) => rest) });
    socket.on("message", (data) => this.hear(JSON.parse(data.toString())));
    socket.on("error", () => {});
  }

  hear(message) {
    for (const { id, channelId } of message.op === "subscribe" ? message.subscriptions : []) this.subscriptions.set(channelId, id);
    for (const id of message.op === "unsubscribe" ? message.subscriptionIds : []) {
      for (const [channel, subscription] of this.subscriptions) if (subscription === id) this.subscriptions.delete(channel);
    }
  }

  give(channel, t_s, octets) {
    const id = this.subscriptions.get(channel.id);
    if (id === undefined || this.socket.bufferedAmount > 64e6) return;
    const message = Buffer.alloc(13 + octets.length);
    message[0] = 1;
    message.writeUInt32LE(id, 1);
    message.writeBigUInt64LE(BigInt(Math.round(t_s * 1e6)) * 1000n, 5);
    message.set(octets, 13);
    this.socket.send(message);
  }
}

function answerExplain(url, response) {
  const [kind, id] = [url.searchParams.get("kind"), url.searchParams.get("id")];
  const life = LIVES[kind];
  response.writeHead(life ? 200 : 404, { "content-type": "text/plain; charset=utf-8" });
  response.end(life ? life(id) : `the run had no ${kind} ${id}\n`);
}

// The first request asks the agent, the next have its image.
const asked = new Set();
function answerThumbnail(url, response, given) {
  const agent = url.searchParams.get("agent");
  const type = (name) => ({ "content-type": name });
  if (!given) return response.writeHead(403, type("text/plain; charset=utf-8")).end(`${agent} keeps its images to itself: agent.thumbnails is false there\n`);
  if (asked.has(agent)) return response.writeHead(200, type("image/png")).end(IMAGE);
  asked.add(agent);
  response.writeHead(202, type("text/plain; charset=utf-8")).end(`${agent} is asked for an image: ask again in a second. None comes while it plays nothing\n`);
}

async function answerFile(root, path, response) {
  const name = path === "/" ? "index.html" : path.slice(1).replaceAll("..", "");
  const bytes = await readFile(join(root, name)).catch(() => null);
  const csp = "default-src 'self'; connect-src 'self' ws:; style-src 'self'; img-src 'self' data: blob:; object-src 'none'";
  response.writeHead(bytes ? 200 : 404, { "content-type": TYPES[name.split(".").pop()] ?? "text/plain", "content-security-policy": csp });
  response.end(bytes ?? "not found\n");
}

// options: {root, port, points, whole, start_s, cameras, recording, token, rate, thumbnails}; answers {port, program, stop(), end()}: stop() as one
// that dies, end() as one whose run is over.
export async function startMock(options) {
  const program = new Program(new Run(options), options.start_s ?? 0);
  const clients = new Set();
  const granted = (url) => options.token === undefined || url.searchParams.get("token") === options.token;
  const http = createServer((request, response) => {
    const url = new URL(request.url, "http://mock");
    if (url.pathname.startsWith("/api/") && !granted(url)) return response.writeHead(401).end("this needs the token of the server\n");
    if (url.pathname === "/api/v1/groups") return response.writeHead(200, { "content-type": "application/json" }).end("{}");
    if (url.pathname === "/api/v1/thumbnail") return answerThumbnail(url, response, options.thumbnails ?? true);
    if (url.pathname === "/api/v1/explain") return answerExplain(url, response);
    if (url.pathname === "/api/v1/run.mcap") {
      response.writeHead(options.recording ? 200 : 404, { "content-type": "application/octet-stream" });
      return response.end(options.recording ?? "");
    }
    return answerFile(options.root, url.pathname, response);
  });
  const sockets = new WebSocketServer({
    server: http, path: "/ws", verifyClient: ({ req }) => granted(new URL(req.url, "http://mock")),
    handleProtocols: (names) => [...names].find((name) => name.startsWith("foxglove.")) ?? false,
  });
  sockets.on("connection", (socket) => {
    const client = new Client(socket, program);
    clients.add(client);
    socket.on("close", () => clients.delete(client));
  });
  const rate = options.rate ?? 1;
  const began_s = performance.now() / 1000 - program.t_s / rate;
  const timer = setInterval(() => {
    const wanted = (channel) => [...clients].some((client) => client.subscriptions.has(channel.id));
    program.advance(rate * (performance.now() / 1000 - began_s), wanted, (channel, t_s, octets) => {
      for (const client of clients) client.give(channel, t_s, octets);
    });
  }, 33);
  await new Promise((done) => http.listen(options.port ?? 0, "127.0.0.1", done));
  const stop = () => new Promise((done) => {
    clearInterval(timer);
    for (const socket of sockets.clients) socket.terminate();
    http.closeAllConnections();
    http.close(done);
  });
  const end = async () => {
    for (const socket of sockets.clients) socket.close(1001, "the map server ends");
    await new Promise((done) => setTimeout(done, 100));
    return stop();
  };
  return { port: http.address().port, stop, end, program };
}
