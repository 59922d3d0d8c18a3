// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros/views.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <initializer_list>
#include <string>
#include <utility>

#include "common/ros/convert.h"

namespace coslam::ros {
namespace {

constexpr std::uint32_t kMarkerLife_ns = 500'000'000;
constexpr double kThinnest = 1e-3;  // viewers complain about boxes without thickness

struct FieldKind {
  const char* name;
  PointField::Datatype datatype;
  std::uint32_t bytes;
};

constexpr FieldKind kX = {"x", PointField::kFloat32, 4}, kY = {"y", PointField::kFloat32, 4},
                    kZ = {"z", PointField::kFloat32, 4}, kSigma = {"sigma", PointField::kFloat32, 4},
                    kId = {"id", PointField::kUint32, 4};

std::size_t aligned(std::size_t at, std::size_t bytes) { return (at + bytes - 1) / bytes * bytes; }

// Points filled one value after the other, in the order of the fields; each at a multiple of its size.
class CloudWriter {
 public:
  CloudWriter(const Header& header, std::initializer_list<FieldKind> fields, std::size_t points) {
    cloud_.header = header;
    std::size_t at = 0;
    for (const FieldKind& field : fields) {
      at = aligned(at, field.bytes);
      cloud_.point_fields.push_back({field.name, static_cast<std::uint32_t>(at), field.datatype, 1});
      at += field.bytes;
    }
    cloud_.point_step = static_cast<std::uint32_t>(aligned(at, sizeof(float)));
    cloud_.width = static_cast<std::uint32_t>(points);
    cloud_.row_step = cloud_.width * cloud_.point_step;
    cloud_.data.reserve(cloud_.row_step);
  }

  template <class T>
  void put(T value) {
    std::array<std::uint8_t, sizeof(T)> octets{};
    std::memcpy(octets.data(), &value, sizeof(T));
    cloud_.data.resize(aligned(cloud_.data.size(), sizeof(T)));
    cloud_.data.insert(cloud_.data.end(), octets.begin(), octets.end());
  }
  void put(const Eigen::Vector3f& p) {
    for (const float v : p) put(v);
  }

  PointCloud2 take() {
    cloud_.data.resize(cloud_.row_step);  // the room after the last value
    return std::move(cloud_);
  }

 private:
  PointCloud2 cloud_;
};

Marker marker_of(const Header& header, const MovingObject& object, const char* ns, Marker::Kind kind) {
  Marker marker;
  marker.header = header;
  marker.ns = ns;
  marker.id = static_cast<std::int32_t>(object.id.value);
  marker.type = kind;
  marker.color = {1.0F, 0.55F, 0.1F, kind == Marker::kCube ? 0.4F : 0.9F};
  marker.lifetime = {0, kMarkerLife_ns};
  return marker;
}

Marker box_of(const Header& header, const MovingObject& object) {
  Marker box = marker_of(header, object, "boxes", Marker::kCube);
  box.pose.position = point_of(object.centroid);
  box.scale = vector_of(object.extent.cwiseMax(kThinnest));
  return box;
}

Marker arrow_of(const Header& header, const MovingObject& object) {
  Marker arrow = marker_of(header, object, "velocities", Marker::kArrow);
  arrow.points = {point_of(object.centroid), point_of(object.centroid + object.velocity_per_s)};
  const double thick = std::max(kThinnest, 0.06 * object.extent.maxCoeff());
  arrow.scale = {thick, 2 * thick, 3 * thick};  // shaft, head, length of the head
  return arrow;
}

}  // namespace

PointCloud2 static_cloud(const Header& header, std::span<const StaticPoint> points) {
  CloudWriter cloud(header,
                    {kX,
                     kY,
                     kZ,
                     kSigma,
                     kId,
                     {"map", PointField::kUint32, 4},
                     {"state", PointField::kUint8, 1},
                     {"views", PointField::kUint16, 2}},
                    points.size());
  for (const StaticPoint& p : points) {
    cloud.put(p.position);
    cloud.put(p.sigma);
    cloud.put(p.id.value);
    cloud.put(p.map.value);
    cloud.put(static_cast<std::uint8_t>(p.on_trial ? 1 : 0));
    cloud.put(p.views);
  }
  return cloud.take();
}

PointCloud2 moving_cloud(const Header& header, std::span<const MovingPoint> points) {
  CloudWriter cloud(header, {kX, kY, kZ, kSigma, kId, {"object", PointField::kUint32, 4}}, points.size());
  for (const MovingPoint& p : points) {
    cloud.put(p.position);
    cloud.put(p.sigma);
    cloud.put(p.id.value);
    cloud.put(p.object.value);
  }
  return cloud.take();
}

MarkerArray object_markers(const Header& header, std::span<const MovingObject> objects) {
  MarkerArray array;
  for (const MovingObject& object : objects) {
    array.markers.push_back(box_of(header, object));
    array.markers.push_back(arrow_of(header, object));
  }
  return array;
}

Detection3DArray object_detections(const Header& header, std::span<const MovingObject> objects) {
  Detection3DArray array;
  array.header = header;
  for (const MovingObject& object : objects) {
    Detection3D detection;
    detection.header = header;
    detection.bbox.center.position = point_of(object.centroid);
    detection.bbox.size = vector_of(object.extent);
    detection.id = std::to_string(object.id.value);
    ObjectHypothesisWithPose result;
    result.hypothesis = {"moving", 1.0};
    result.pose.pose = detection.bbox.center;
    detection.results.push_back(result);
    array.detections.push_back(std::move(detection));
  }
  return array;
}

}  // namespace coslam::ros
