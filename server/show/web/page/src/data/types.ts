// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the server says, as docs/live.md has it. Lengths are metres where the scale is known, else units of the map.

export interface Channel {
  id: number;
  topic: string;
  encoding: string;
  schemaName: string;
  schema: string;
}

// t_s is the time of the capture: UTC for live cameras, from 0 for files.
export interface Message {
  topic: string;
  t_s: number;
  data: Uint8Array;
  channel: Channel;
}

export type AgentStatus = "tracking" | "relative" | "lost" | "none" | "unheard";

// How good a path is, as far as can be told without truth. sigma: the error to be expected, also in percent of the length.
export interface PathQuality { quality: "good" | "fair" | "poor"; why: string; length: number; sigma: number | null; sigma_percent: number | null }

export interface AgentState {
  name: string;
  topic?: string;        // "/coslam/<its name as ROS allows it>"; its channels begin so
  alive: boolean;
  camera: number;
  map: number;
  group: number;
  frame: string;
  state: AgentStatus;
  why: string;
  rate_hz: number;
  frame_ms: number;
  kB_up_per_s: number | null;  // null, here and below: what the state was made of does not hold it
  kB_down_per_s: number | null;
  lag_s: number | null;
  lost_percent: number | null;
  account?: { captured: number; tracked: number } | null;  // images, and a number for each other fate
  losses?: string | null;      // what became of those that are not tracked; empty: all are
  path?: PathQuality | null;
  images?: string;             // why its images are not to be believed; "none": they are
  tracks: number;
  bound: number;
  clock_offset_ms: number | null;
  pose: number[] | null;
  scale_known?: boolean;       // of its map
  fov: number[];
}

export interface ServerFigures {
  ms_per_set: number;
  points: number;
  moving_points: number;
  objects: number;
  maps: number;
  key_frames: number | null;
  memory_mib: number | null;
  frame_sets: number;
  left_out: number | null;
}

export interface RunState {
  t_s: number;
  run: string;
  scale_known: boolean;
  finishing?: boolean;   // no frames come any more, and the whole is adjusted
  result?: string;       // folder of the result; empty: none
  join?: string;         // options with which coslam-agent comes here; empty: none does
  server: ServerFigures;
  agents: AgentState[];
  groups: string[][];
  links: [string, string, number][];
}

export interface RunEvent {
  t_s: number;
  kind: string;
  text: string;
  agents: string[];
}

// state: 0 none, 1 static, 2 moving, 3 uncertain
export interface Tracks {
  t_s: number;
  width: number;
  height: number;
  tracks: [number, number, number, number][];
}

export interface Vector { x: number; y: number; z: number }
export interface Quaternion extends Vector { w: number }
export interface Pose { position: Vector; orientation: Quaternion }
export interface Header { stamp: { sec: number; nsec?: number; nanosec?: number }; frame_id: string }
export const secondsOf = ({ stamp }: Header): number => stamp.sec + (stamp.nsec ?? stamp.nanosec ?? 0) / 1e9;
export interface PoseEstimate { header: Header; pose: { pose: Pose; covariance: ArrayLike<number> } }
export interface PoseArray { header: Header; poses: Pose[] }
export interface Path { header: Header; poses: { header: Header; pose: Pose }[] }
export interface Marker {
  header: Header;
  ns: string;
  id: number;
  type: number;
  action: number;
  pose: Pose;
  scale: Vector;
  points: Vector[];
}
export interface MarkerArray { markers: Marker[] }

export const TOPIC = {
  points: "/coslam/map/points",
  moving: "/coslam/map/moving",
  objects: "/coslam/objects",
  state: "/coslam/state",
  events: "/coslam/events",
} as const;

// What the channels of an agent have between /coslam/ and their last part.
export function topicName(agent: AgentState): string { return agent.topic?.replace(/^\/coslam\//, "") ?? agent.name; }

// "/coslam/cam0/pose" -> ["cam0", "pose"], the first as topicName() has it; undefined for topics that are of no agent.
export function agentTopic(topic: string): [string, string] | undefined {
  const match = /^\/coslam\/(.+)\/(pose|path|key_frames|tracks)$/.exec(topic);
  return match ? [match[1]!, match[2]!] : undefined;
}
