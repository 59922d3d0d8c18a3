// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/result_past.h"

#include <algorithm>
#include <cstring>

namespace coslam {
namespace {

// Numbers one behind the other; read back by the same program.
class Octets {
 public:
  Octets() = default;
  explicit Octets(std::string text) : text_(std::move(text)) {}
  template <class Number>
  void put(Number value) {
    static_assert(std::is_arithmetic_v<Number>);
    text_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class Number>
  Number get() {
    Number value{};
    std::memcpy(&value, text_.data() + read_, sizeof value);
    read_ += sizeof value;
    return value;
  }
  bool at_end() const { return read_ >= text_.size(); }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
  std::size_t read_ = 0;
};

void put_pose(const StampedPose& p, Octets* out) {
  out->put(p.t_ns);
  for (int i = 0; i < 4; ++i) out->put(p.cam_from_world.rotation.coeffs()[i]);
  for (int i = 0; i < 3; ++i) out->put(p.cam_from_world.translation[i]);
}

StampedPose get_pose(Octets* in) {
  StampedPose p;
  p.t_ns = in->get<TimeNs>();
  for (int i = 0; i < 4; ++i) p.cam_from_world.rotation.coeffs()[i] = in->get<double>();
  for (int i = 0; i < 3; ++i) p.cam_from_world.translation[i] = in->get<double>();
  return p;
}

}  // namespace

// Of frames that are past, a block of each camera at a time.
class ResultPast::Poses {
 public:
  Poses(const ResultPast& past, const Map& map) : past_(past), map_(map) {}

  // Null when it is not known. In memory, else in the block that would have it.
  const FramePose* at(CameraId camera, SetId set) {
    const MapCamera& c = map_.camera(camera);
    if (set >= c.past.until) return c.frame_at(set);
    const auto blocks = past_.frames_.find(camera);
    if (blocks == past_.frames_.end()) return nullptr;
    auto block = std::ranges::upper_bound(blocks->second, set, {}, &FrameBlock::first);
    if (block == blocks->second.begin()) return nullptr;
    --block;
    Read& read = read_[camera];
    if (read.frames.empty() || read.ticket != block->ticket) {
      read = {block->ticket, frames_now(map_, past_frames_of(past_.file_.get(block->ticket)))};
    }
    const auto frame = std::ranges::lower_bound(read.frames, set, {}, &FramePose::set);
    return frame == read.frames.end() || frame->set != set ? nullptr : &*frame;
  }

 private:
  struct Read {
    SpillFile::Ticket ticket = 0;
    std::vector<FramePose> frames;
  };
  const ResultPast& past_;
  const Map& map_;
  std::map<CameraId, Read> read_;
};

void ResultPast::add(const PastPart& past) {
  for (const PastFrames& block : past.frames) {
    auto& blocks = frames_[block.camera];
    const SetId first = block.frames.front().set;
    const auto at = std::ranges::lower_bound(blocks, first, {}, &FrameBlock::first);
    if (at != blocks.end() && at->first == first) continue;  // of a map file, that has it from here
    blocks.insert(at, {first, file_.put(octets_of_past(block))});
  }
  if (past.places) places_.push_back(file_.put(octets_of_past(*past.places)));
}

void ResultPast::add_live(CameraId camera, MapId map, const Trajectory& part) {
  Octets octets;
  for (const StampedPose& p : part) put_pose(p, &octets);
  live_[{camera, map}].push_back(file_.put(octets.take()));
}

void ResultPast::add_objects(const std::vector<SeenObject>& objects) {
  if (objects.empty()) return;
  Octets octets;
  for (const SeenObject& o : objects) {
    octets.put(o.t_ns);
    octets.put(o.id.value);
    octets.put(static_cast<std::uint32_t>(o.members.size()));
    for (const PointId p : o.members) octets.put(p.value);
  }
  objects_.push_back(file_.put(octets.take()));
}

Trajectory ResultPast::trajectory(const Map& map, CameraId camera, MapId map_id, SetId from_set) const {
  Trajectory out;
  const auto blocks = frames_.find(camera);
  if (blocks == frames_.end()) return out;
  for (const FrameBlock& block : blocks->second) {
    for (const FramePose& f : frames_now(map, past_frames_of(file_.get(block.ticket)))) {
      if (f.map == map_id && f.valid() && f.set >= from_set) out.push_back({f.capture_ns, f.cam_from_world});
    }
  }
  return out;
}

Trajectory ResultPast::live(CameraId camera, MapId map) const {
  Trajectory out;
  const auto parts = live_.find({camera, map});
  if (parts == live_.end()) return out;
  for (const SpillFile::Ticket ticket : parts->second) {
    for (Octets octets(file_.get(ticket)); !octets.at_end();) out.push_back(get_pose(&octets));
  }
  return out;
}

void ResultPast::for_each_place(const Map& map, MapId map_id,
                                const std::function<void(const ResultDynamicRow&)>& visit) const {
  Poses poses(*this, map);
  for (const SpillFile::Ticket ticket : places_) {
    const PastPlaces block = past_places_of(file_.get(ticket));
    std::map<MapId, MovedMap> moved;
    for (const PastPlace& place : block.places) {
      const auto [at, added] = moved.try_emplace(place.map);
      if (added) at->second = moved_map(map, block.put, place.map);
      if (at->second.map != map_id) continue;
      const FramePose* frame = poses.at(place.camera, place.set);
      if (frame == nullptr || frame->map != map_id) continue;
      const double scale = at->second.now_from_then.scale;
      const Rigid3 world_from_cam = frame->cam_from_world.inverse();
      const Eigen::Matrix3d m = scale * world_from_cam.rotation.toRotationMatrix();
      visit({place.t_ns + map.shifted_ns() - block.put.shifted_ns, place.point,
             world_from_cam * (scale * place.p_in_cam).eval(), m * place.covariance_in_cam * m.transpose(),
             place.views});
    }
  }
}

std::vector<SeenObject> ResultPast::objects(std::size_t block) const {
  std::vector<SeenObject> out;
  for (Octets octets(file_.get(objects_.at(block))); !octets.at_end();) {
    SeenObject& o = out.emplace_back();
    o.t_ns = octets.get<TimeNs>();
    o.id = ObjectId(octets.get<decltype(o.id.value)>());
    o.members.resize(octets.get<std::uint32_t>());
    for (PointId& p : o.members) p = PointId(octets.get<decltype(p.value)>());
  }
  return out;
}

}  // namespace coslam
