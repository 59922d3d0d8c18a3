// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The channels of the made-up run, and the messages that fall due between two instants.
import { schemaOf } from "./schemas.mjs";
import { NAMES, WHY_LOST } from "./script.mjs";

const json = (value) => new TextEncoder().encode(JSON.stringify(value));
const cloud = "sensor_msgs/msg/PointCloud2";
const estimate = "geometry_msgs/msg/PoseWithCovarianceStamped";

function channelsOf(cameras) {
  const list = [
    { topic: "/coslam/map/points", type: cloud, rate_hz: 1, make: (run, t) => run.points(t) },
    { topic: "/coslam/map/moving", type: cloud, rate_hz: 15, make: (run, t) => run.moving(t) },
    { topic: "/coslam/objects", type: "visualization_msgs/msg/MarkerArray", rate_hz: 15, make: (run, t) => run.objects(t) },
    { topic: "/coslam/state", rate_hz: 4, make: (run, t) => json(run.state(t)) },
    { topic: "/coslam/events", rate_hz: 0 },
  ];
  for (const i of cameras) {
    const of = `/coslam/${NAMES[i]}`;
    list.push(
      { topic: `${of}/pose`, type: estimate, rate_hz: 30, make: (run, t) => (run.isLost(i, t) ? null : run.pose(i, t)) },
      { topic: `${of}/path`, type: "nav_msgs/msg/Path", rate_hz: 1, make: (run, t) => run.path(i, t) },
      { topic: `${of}/key_frames`, type: "geometry_msgs/msg/PoseArray", rate_hz: 1, make: (run, t) => run.keyFrames(i, t) },
      { topic: `${of}/tracks`, rate_hz: 5, make: (run, t) => json(run.tracks(i, t)) });
  }
  return list.map((channel, index) => ({
    id: index + 1, ...channel, encoding: channel.type ? "cdr" : "json", schemaName: channel.type ?? "",
    schemaEncoding: channel.type ? "ros2msg" : "", schema: channel.type ? schemaOf(channel.type) : "",
  }));
}

export class Program {
  constructor(run, start_s = 0) {
    this.run = run;
    this.channels = channelsOf(run.cameras);
    this.t_s = start_s;
    this.said = [];  // events besides those of the script
    for (let t = 0; t < start_s; t += 0.1) run.step(t);
  }

  // From now on that camera has no pose.
  lose(name) {
    this.run.lost.add(name);
    this.said.push({ kind: "lost", text: `${name} lost its pose: ${WHY_LOST}`, agents: [name] });
  }

  // All agents have ended, and the map is adjusted.
  finish() { this.run.finishing = true; }

  // Calls give(channel, t_s, octets) for what is due until then and wanted.
  advance(to_s, wanted, give) {
    for (let t = this.t_s + 1 / 30; t <= to_s; t += 1 / 30) {
      this.run.step(t);
      for (const channel of this.channels) {
        const nobody = this.run.cameras.length === 0 && channel.topic !== "/coslam/state";
        const due = !nobody && channel.rate_hz > 0 && Math.floor(t * channel.rate_hz) !== Math.floor((t - 1 / 30) * channel.rate_hz);
        if (!due || !wanted(channel)) continue;
        const octets = channel.make(this.run, t);
        if (octets) give(channel, t, octets);
      }
      const events = this.channels.find(({ topic }) => topic === "/coslam/events");
      const due = this.said.splice(0).map((event) => ({ t_s: t, ...event }));
      for (const event of [...due, ...(this.run.cameras.length === 0 ? [] : this.run.eventsBetween(this.t_s, t))]) if (wanted(events)) give(events, event.t_s, json(event));
      this.t_s = t;
    }
  }
}
