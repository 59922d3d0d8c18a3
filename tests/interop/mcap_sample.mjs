// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node mcap_sample.mjs FILE: what mcap_sample wrote, as programs of others read it.
import assert from "node:assert/strict";
import { Recording } from "./mcap.mjs";

const period = 20_000_000n;
const recording = await Recording.open(process.argv[2]);
const { reader } = recording;

// The summary is enough to know what there is.
assert.equal(reader.header.profile, "ros2");
assert.ok(reader.chunkIndexes.length > 5, "several chunks");
assert.equal(reader.statistics.messageCount, 4n * 300n + 7n * 30n);
assert.equal(reader.statistics.messageStartTime, 0n);
assert.equal(reader.statistics.messageEndTime, 299n * period);
assert.equal(reader.summaryOffsetsByOpcode.size, 4);

const count = new Map();
for await (const { topic, independent } of recording.messages()) {
  count.set(topic, (count.get(topic) ?? 0) + 1);
  if (!["/px4", "/detections", "/state"].includes(topic)) assert.ok(independent, `${topic}: checked by ROS 2's definition`);
}
assert.equal(count.get("/odom"), 300);
assert.equal(count.get("/cloud"), 30);

// The first message of a topic at an instant or after it.
async function at(topic, i) {
  for await (const message of recording.messages({ topics: [topic], startTime: BigInt(i) * period })) return message;
}

const odom = await at("/odom", 150);
assert.equal(odom.t, 150n * period);
assert.deepEqual(odom.value.header.stamp, { sec: 3, nanosec: 0 });
assert.equal(odom.value.header.frame_id, "map");
assert.equal(odom.value.child_frame_id, "left/base_link");
assert.equal(odom.value.pose.pose.position.x, 75);
assert.ok(Math.abs(odom.value.pose.pose.orientation.z - Math.sin(0.75)) < 1e-12);
assert.equal(odom.value.pose.covariance[35], 35);
assert.equal(odom.value.twist.twist.linear.z, 1.5);

const tf = await at("/tf", 10);
assert.equal(tf.value.transforms[0].transform.translation.x, 5);

const cloud = await at("/cloud", 101);
assert.equal(cloud.t, 110n * period);
const field = (name) => cloud.value.fields.find((f) => f.name === name);
const view = new DataView(cloud.value.data.buffer, cloud.value.data.byteOffset);
assert.equal(cloud.value.width, 2);
assert.equal(view.getFloat32(field("x").offset, true), 110);
assert.equal(view.getFloat32(cloud.value.point_step + field("sigma").offset, true), 0.25);
assert.equal(view.getUint32(cloud.value.point_step + field("id").offset, true), 8);
assert.equal(view.getUint16(cloud.value.point_step + field("views").offset, true), 65535);

const path = await at("/path", 20);
assert.equal(path.value.poses.length, 21);
assert.equal(path.value.poses[20].pose.position.x, 20);

const markers = await at("/markers", 0);
assert.equal(markers.value.markers.length, 2);
assert.equal(markers.value.markers[0].type, 1, "a cube");
assert.equal(markers.value.markers[0].scale.z, 1.7);
assert.equal(markers.value.markers[1].points[1].y, 2.5);

assert.equal((await at("/detections", 0)).value.detections[0].bbox.size.y, 0.6);
assert.equal((await at("/info", 0)).value.k[4], 501);
assert.deepEqual(Array.from((await at("/image", 0)).value.data), [1, 2, 3]);
assert.equal((await at("/jpeg", 0)).value.format, "jpeg");
assert.deepEqual((await at("/state", 42)).value, { i: 42 });

const px4 = (await at("/px4", 5)).value;
assert.equal(px4.timestamp, 100_000n);
assert.deepEqual(Array.from(px4.position), [5, 2, 3]);
assert.equal(px4.reset_counter, 7);
assert.equal(px4.quality, -1);

console.log(`mcap_sample: ${reader.statistics.messageCount} messages in ${reader.chunkIndexes.length} chunks read by their index`);
