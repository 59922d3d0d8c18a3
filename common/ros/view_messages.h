// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/ros/geometry_messages.h"
#include "common/ros/sensor_messages.h"

// visualization_msgs as of ROS 2 Humble, and vision_msgs 4.
namespace coslam::ros {

struct UVCoordinate {
  static constexpr const char* kType = "visualization_msgs/UVCoordinate";
  float u = 0, v = 0;
  static void fields(auto& m, auto& visit) {
    visit("u", m.u);
    visit("v", m.v);
  }
};

struct MeshFile {
  static constexpr const char* kType = "visualization_msgs/MeshFile";
  std::string filename;
  std::vector<std::uint8_t> data;
  static void fields(auto& m, auto& visit) {
    visit("filename", m.filename);
    visit("data", m.data);
  }
};

struct Marker {
  static constexpr const char* kType = "visualization_msgs/Marker";
  enum Kind : std::int32_t { kArrow = 0, kCube = 1, kText = 9 };
  enum Action : std::int32_t { kAdd = 0, kDelete = 2, kDeleteAll = 3 };
  Header header;
  std::string ns;
  std::int32_t id = 0, type = kArrow, action = kAdd;
  Pose pose;
  Vector3 scale;
  ColorRGBA color;
  Duration lifetime;  // 0: for ever
  bool frame_locked = false;
  std::vector<Point> points;
  std::vector<ColorRGBA> colors;
  std::string texture_resource;
  CompressedImage texture;
  std::vector<UVCoordinate> uv_coordinates;
  std::string text, mesh_resource;
  MeshFile mesh_file;
  bool mesh_use_embedded_materials = false;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("ns", m.ns);
    visit("id", m.id);
    visit("type", m.type);
    visit("action", m.action);
    visit("pose", m.pose);
    visit("scale", m.scale);
    visit("color", m.color);
    visit("lifetime", m.lifetime);
    visit("frame_locked", m.frame_locked);
    visit("points", m.points);
    visit("colors", m.colors);
    visit("texture_resource", m.texture_resource);
    visit("texture", m.texture);
    visit("uv_coordinates", m.uv_coordinates);
    visit("text", m.text);
    visit("mesh_resource", m.mesh_resource);
    visit("mesh_file", m.mesh_file);
    visit("mesh_use_embedded_materials", m.mesh_use_embedded_materials);
  }
};

struct MarkerArray {
  static constexpr const char* kType = "visualization_msgs/MarkerArray";
  std::vector<Marker> markers;
  static void fields(auto& m, auto& visit) { visit("markers", m.markers); }
};

struct ObjectHypothesis {
  static constexpr const char* kType = "vision_msgs/ObjectHypothesis";
  std::string class_id;
  double score = 0;
  static void fields(auto& m, auto& visit) {
    visit("class_id", m.class_id);
    visit("score", m.score);
  }
};

struct ObjectHypothesisWithPose {
  static constexpr const char* kType = "vision_msgs/ObjectHypothesisWithPose";
  ObjectHypothesis hypothesis;
  PoseWithCovariance pose;
  static void fields(auto& m, auto& visit) {
    visit("hypothesis", m.hypothesis);
    visit("pose", m.pose);
  }
};

struct BoundingBox3D {
  static constexpr const char* kType = "vision_msgs/BoundingBox3D";
  Pose center;
  Vector3 size;
  static void fields(auto& m, auto& visit) {
    visit("center", m.center);
    visit("size", m.size);
  }
};

struct Detection3D {
  static constexpr const char* kType = "vision_msgs/Detection3D";
  Header header;
  std::vector<ObjectHypothesisWithPose> results;
  BoundingBox3D bbox;
  std::string id;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("results", m.results);
    visit("bbox", m.bbox);
    visit("id", m.id);
  }
};

struct Detection3DArray {
  static constexpr const char* kType = "vision_msgs/Detection3DArray";
  Header header;
  std::vector<Detection3D> detections;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("detections", m.detections);
  }
};

}  // namespace coslam::ros
