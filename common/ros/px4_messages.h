// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

// px4_msgs, the layout that PX4 has had since its version 1.14: 118 octets of CDR.
namespace coslam::ros {

struct VehicleOdometry {
  static constexpr const char* kType = "px4_msgs/VehicleOdometry";
  enum Frame : std::uint8_t { kUnknown = 0, kNed = 1, kFrd = 2, kBodyFrd = 3 };
  using Vector = std::array<float, 3>;
  std::uint64_t timestamp = 0, timestamp_sample = 0;  // microseconds
  std::uint8_t pose_frame = kUnknown;                 // frame of position and q
  Vector position{};                                  // NaN where a number is not known, here and below
  std::array<float, 4> q{};                           // w x y z: pose frame from body (FRD)
  std::uint8_t velocity_frame = kUnknown;
  Vector velocity{};
  Vector angular_velocity{};  // in the body's frame
  Vector position_variance{}, orientation_variance{}, velocity_variance{};
  std::uint8_t reset_counter = 0;
  std::int8_t quality = 0;
  static void fields(auto& m, auto& visit) {
    visit("timestamp", m.timestamp);
    visit("timestamp_sample", m.timestamp_sample);
    visit("pose_frame", m.pose_frame);
    visit("position", m.position);
    visit("q", m.q);
    visit("velocity_frame", m.velocity_frame);
    visit("velocity", m.velocity);
    visit("angular_velocity", m.angular_velocity);
    visit("position_variance", m.position_variance);
    visit("orientation_variance", m.orientation_variance);
    visit("velocity_variance", m.velocity_variance);
    visit("reset_counter", m.reset_counter);
    visit("quality", m.quality);
  }
};

}  // namespace coslam::ros
