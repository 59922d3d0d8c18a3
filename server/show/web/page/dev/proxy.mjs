// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The page of dist/ with the data of a server that runs.
import { readFile } from "node:fs/promises";
import { createServer, request } from "node:http";
import { join } from "node:path";

const TYPES = { html: "text/html; charset=utf-8", js: "text/javascript", css: "text/css", svg: "image/svg+xml", txt: "text/plain; charset=utf-8" };

export function startProxy({ root, port, server }) {
  const to = new URL(server);
  const asked = ({ method, url, headers }) => request({ host: to.hostname, port: to.port, method, path: url, headers: { ...headers, host: to.host, origin: to.origin } });
  const http = createServer(async (incoming, response) => {
    const path = new URL(incoming.url, server).pathname;
    const name = path === "/" ? "index.html" : path.slice(1).replaceAll("..", "");
    const bytes = await readFile(join(root, name)).catch(() => null);
    if (bytes) return response.writeHead(200, { "content-type": TYPES[name.split(".").pop()] }).end(bytes);
    const outgoing = asked(incoming);
    outgoing.on("response", (answer) => answer.pipe(response.writeHead(answer.statusCode, answer.headers)));
    outgoing.on("error", () => response.writeHead(502).end("the server does not answer\n"));
    return outgoing.end();
  });
  http.on("upgrade", (incoming, socket) => {
    const outgoing = asked(incoming);
    outgoing.on("upgrade", (answer, other) => {
      const head = Object.entries(answer.headers).map(([name, value]) => `${name}: ${value}\r\n`).join("");
      socket.write(`HTTP/1.1 101 Switching Protocols\r\n${head}\r\n`);
      socket.pipe(other).pipe(socket);
      for (const [one, another] of [[socket, other], [other, socket]]) one.on("error", () => another.destroy()).on("close", () => another.destroy());
    });
    outgoing.on("response", () => socket.destroy());
    outgoing.on("error", () => socket.destroy());
    outgoing.end();
  });
  return new Promise((done) => http.listen(port, "127.0.0.1", () => done(http)));
}
