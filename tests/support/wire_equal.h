// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstring>

#include "common/model/agent_images.h"
#include "common/model/agent_pose.h"
#include "common/model/map_patch.h"
#include "common/model/moving_state.h"
#include "common/model/public_sample.h"
#include "common/model/session.h"
#include "common/model/thumbnail.h"
#include "common/model/track_frame.h"

// Equality bit for bit, field by field.
namespace coslam::test {

template <class T>
void expect_same_bits(const T& a, const T& b, const char* what) {
  static_assert(std::is_trivially_copyable_v<T>);
  EXPECT_EQ(std::memcmp(&a, &b, sizeof(T)), 0) << what;  // NOLINT(bugprone-suspicious-memory-comparison): bits
}

template <class Matrix>
void expect_same_matrix(const Matrix& a, const Matrix& b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(*a.data()) * static_cast<std::size_t>(a.size())), 0) << what;
}

inline void expect_same(const Rigid3& a, const Rigid3& b) {
  expect_same_matrix(a.rotation.coeffs(), b.rotation.coeffs(), "rotation");
  expect_same_matrix(a.translation, b.translation, "translation");
}

inline void expect_same(const TrackFrame& a, const TrackFrame& b) {
  EXPECT_EQ(a.agent, b.agent);
  EXPECT_EQ(a.agent_run, b.agent_run);
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.capture_ns, b.capture_ns);
  EXPECT_EQ(a.pose_state, b.pose_state);
  EXPECT_EQ(a.server_run, b.server_run);
  EXPECT_EQ(a.epoch, b.epoch);
  expect_same(a.cam_from_world, b.cam_from_world);
  expect_same_matrix(a.pose_covariance, b.pose_covariance, "pose_covariance");
  EXPECT_EQ(a.pose_inliers, b.pose_inliers);
  expect_same_bits(a.hull_fraction, b.hull_fraction, "hull_fraction");
  EXPECT_EQ(a.applied_patch, b.applied_patch);
  EXPECT_EQ(a.wants_snapshot, b.wants_snapshot);
  EXPECT_EQ(a.patches_sent, b.patches_sent);
  EXPECT_EQ(a.descriptors_sent, b.descriptors_sent);
  EXPECT_EQ(a.on_own_points, b.on_own_points);
  EXPECT_EQ(a.narrow_link, b.narrow_link);
  EXPECT_EQ(a.images_doubted, b.images_doubted);
  EXPECT_EQ(a.clock_set_ns, b.clock_set_ns);
  ASSERT_EQ(a.tracks.size(), b.tracks.size());
  for (std::size_t i = 0; i < a.tracks.size(); ++i) {
    EXPECT_EQ(a.tracks[i].track, b.tracks[i].track);
    expect_same_matrix(a.tracks[i].undistorted_px, b.tracks[i].undistorted_px, "undistorted_px");
  }
  EXPECT_EQ(a.tags, b.tags);
}

inline void expect_same(const PatchReply& a, const PatchReply& b) {
  EXPECT_EQ(a.agent, b.agent);
  EXPECT_EQ(a.agent_run, b.agent_run);
  EXPECT_EQ(a.frame, b.frame);
  ASSERT_EQ(a.patches.size(), b.patches.size());
  for (std::size_t i = 0; i < a.patches.size(); ++i) {
    EXPECT_EQ(a.patches[i].track, b.patches[i].track);
    EXPECT_EQ(a.patches[i].grey, b.patches[i].grey);
  }
}

inline void expect_same(const DescriptorReply& a, const DescriptorReply& b) {
  EXPECT_EQ(a.agent, b.agent);
  EXPECT_EQ(a.agent_run, b.agent_run);
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.tracks, b.tracks);
  EXPECT_EQ(a.descriptors, b.descriptors);
}

inline void expect_same(const Hello& a, const Hello& b) {
  EXPECT_EQ(a.agent, b.agent);
  EXPECT_EQ(a.agent_run, b.agent_run);
  EXPECT_EQ(a.protocol, b.protocol);
  EXPECT_EQ(a.pacing, b.pacing);
  expect_same_bits(a.rate_hz, b.rate_hz, "rate_hz");
  EXPECT_EQ(a.camera.width_px, b.camera.width_px);
  EXPECT_EQ(a.camera.height_px, b.camera.height_px);
  expect_same_bits(std::array{a.camera.fx, a.camera.fy, a.camera.cx, a.camera.cy},
                   std::array{b.camera.fx, b.camera.fy, b.camera.cx, b.camera.cy}, "camera");
  EXPECT_EQ(a.camera.distortion, b.camera.distortion);
  expect_same_bits(a.camera.coefficients, b.camera.coefficients, "coefficients");
}

inline void expect_same(const AgentStatus& a, const AgentStatus& b) {
  EXPECT_EQ(a.agent, b.agent);
  EXPECT_EQ(a.agent_run, b.agent_run);
  EXPECT_EQ(a.state, b.state);
  EXPECT_EQ(a.pose_state, b.pose_state);
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.dropped, b.dropped);
  EXPECT_EQ(a.left_out, b.left_out);
  EXPECT_EQ(a.image_fault, b.image_fault);
  EXPECT_EQ(a.tracks, b.tracks);
  expect_same_bits(a.frame_ms, b.frame_ms, "frame_ms");
  EXPECT_EQ(a.report_json, b.report_json);
  ASSERT_EQ(a.last_image.has_value(), b.last_image.has_value());
  if (a.last_image) expect_same(*a.last_image, *b.last_image);
}

inline void expect_same(const MapPatch& a, const MapPatch& b) {
  EXPECT_EQ(a.agent, b.agent);
  EXPECT_EQ(a.server_run, b.server_run);
  EXPECT_EQ(a.agent_run, b.agent_run);
  EXPECT_EQ(a.sequence, b.sequence);
  EXPECT_EQ(a.after_frame, b.after_frame);
  EXPECT_EQ(a.snapshot, b.snapshot);
  EXPECT_EQ(a.epoch, b.epoch);
  expect_same_bits(a.new_from_old.scale, b.new_from_old.scale, "scale");
  expect_same(Rigid3(a.new_from_old.rotation, a.new_from_old.translation),
              Rigid3(b.new_from_old.rotation, b.new_from_old.translation));
  ASSERT_EQ(a.placed.has_value(), b.placed.has_value());
  if (a.placed) {
    EXPECT_EQ(a.placed->frame, b.placed->frame);
    expect_same(a.placed->cam_from_world, b.placed->cam_from_world);
  }
  EXPECT_EQ(a.lens, b.lens);
  ASSERT_EQ(a.updated.size(), b.updated.size());
  for (std::size_t i = 0; i < a.updated.size(); ++i) {
    EXPECT_EQ(a.updated[i].track, b.updated[i].track);
    EXPECT_EQ(a.updated[i].point, b.updated[i].point);
    EXPECT_EQ(a.updated[i].state, b.updated[i].state);
    expect_same_matrix(a.updated[i].position, b.updated[i].position, "position");
    expect_same_matrix(a.updated[i].covariance, b.updated[i].covariance, "covariance");
  }
  EXPECT_EQ(a.unbound, b.unbound);
  EXPECT_EQ(a.patch_requests, b.patch_requests);
  EXPECT_EQ(a.descriptor_request, b.descriptor_request);
  EXPECT_EQ(a.group, b.group);
  EXPECT_EQ(a.scale_known, b.scale_known);
}

inline void expect_same(const MovingState& a, const MovingState& b) {
  EXPECT_EQ(a.server_run, b.server_run);
  EXPECT_EQ(a.map, b.map);
  EXPECT_EQ(a.epoch, b.epoch);
  EXPECT_EQ(a.t_ns, b.t_ns);
  EXPECT_EQ(a.scale_known, b.scale_known);
  EXPECT_EQ(a.left_out, b.left_out);
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    EXPECT_EQ(a.objects[i].object, b.objects[i].object);
    expect_same_matrix(a.objects[i].centroid, b.objects[i].centroid, "centroid");
    expect_same_matrix(a.objects[i].velocity_per_s, b.objects[i].velocity_per_s, "velocity_per_s");
    expect_same_matrix(a.objects[i].extent, b.objects[i].extent, "extent");
    EXPECT_EQ(a.objects[i].points, b.objects[i].points);
  }
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].point, b.points[i].point);
    EXPECT_EQ(a.points[i].object, b.points[i].object);
    expect_same_matrix(a.points[i].position, b.points[i].position, "position");
    expect_same_matrix(a.points[i].covariance, b.points[i].covariance, "covariance");
    EXPECT_EQ(a.points[i].cameras, b.points[i].cameras);
  }
}

inline void expect_same(const AgentPose& a, const AgentPose& b) {
  EXPECT_EQ(a.agent, b.agent);
  EXPECT_EQ(a.agent_run, b.agent_run);
  EXPECT_EQ(a.server_run, b.server_run);
  EXPECT_EQ(a.t_ns, b.t_ns);
  EXPECT_EQ(a.map, b.map);
  EXPECT_EQ(a.epoch, b.epoch);
  EXPECT_EQ(a.state, b.state);
  EXPECT_EQ(a.scale_known, b.scale_known);
  expect_same_matrix(a.map_from_cam.rotation.coeffs(), b.map_from_cam.rotation.coeffs(), "rotation");
  expect_same_matrix(a.map_from_cam.translation, b.map_from_cam.translation, "translation");
  expect_same_matrix(a.covariance, b.covariance, "covariance");
}

inline void expect_same(const AgentImages& a, const AgentImages& b) {
  EXPECT_EQ(a.agent, b.agent);
  EXPECT_EQ(a.agent_run, b.agent_run);
  EXPECT_EQ(a.server_run, b.server_run);
  EXPECT_EQ(a.images, b.images);
  EXPECT_EQ(a.complete, b.complete);
  EXPECT_EQ(a.problem, b.problem);
}

inline void expect_same(const ThumbnailRequest& a, const ThumbnailRequest& b) {
  EXPECT_EQ(a.agent, b.agent);
  EXPECT_EQ(a.agent_run, b.agent_run);
  EXPECT_EQ(a.server_run, b.server_run);
}

inline void expect_same(const Thumbnail& a, const Thumbnail& b) {
  EXPECT_EQ(a.agent, b.agent);
  EXPECT_EQ(a.agent_run, b.agent_run);
  EXPECT_EQ(a.capture_ns, b.capture_ns);
  EXPECT_EQ(a.jpeg, b.jpeg);
}

inline void expect_same(const PublicSample& a, const PublicSample& b) {
  EXPECT_EQ(a.topic, b.topic);
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.t_ns, b.t_ns);
  EXPECT_TRUE(a.octets == b.octets);
}

inline void expect_same(const ServerStatus& a, const ServerStatus& b) {
  EXPECT_EQ(a.server_run, b.server_run);
  EXPECT_EQ(a.protocol, b.protocol);
  EXPECT_EQ(a.started, b.started);
  EXPECT_EQ(a.stopping, b.stopping);
  EXPECT_EQ(a.start_utc_ns, b.start_utc_ns);
  EXPECT_EQ(a.frame_sets, b.frame_sets);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.agents, b.agents);
  ASSERT_EQ(a.refused.size(), b.refused.size());
  for (std::size_t i = 0; i < a.refused.size(); ++i) {
    EXPECT_EQ(a.refused[i].agent_run, b.refused[i].agent_run);
    EXPECT_EQ(a.refused[i].reason, b.refused[i].reason);
  }
}

}  // namespace coslam::test
