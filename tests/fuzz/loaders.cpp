// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A file that a user hands over: the first octet says which kind. It is loaded, or refused with a sentence.
#include <string>

#include "common/dataset/event_file.h"
#include "common/dataset/result.h"
#include "common/dataset/sequence.h"
#include "common/dataset/trajectory.h"
#include "common/model/rig.h"
#include "tests/fuzz/fuzzer.h"

namespace coslam {
namespace {

constexpr int kKinds = 7;

void load(int kind, const std::filesystem::path& file, const std::string& text) {
  switch (kind) {
    case 0:
      load_sequence(file);
      return;
    case 1:
      load_tum(file);
      return;
    case 2:
      read_points(file);
      return;
    case 3:
      for_each_track_row(file, [](const ResultTrackRow&) {});
      return;
    case 4:
      for_each_object_row(file, [](const ResultObjectRow&) {});
      return;
    case 5:
      for_each_event_row(file, [](const EventRow&) { return true; });
      return;
    default:
      parse_rig_camera(text);
  }
}

}  // namespace

void fuzz::try_octets(Octets octets) {
  if (octets.empty()) return;
  const std::string text(text_of(octets.subspan(1)));
  load(octets[0] % kKinds, file_of(text), text);
}

void fuzz::write_seeds(const WriteSeed& write_seed) {
  const auto write = [&](int kind, const std::string& text) {
    write_seed("kind" + std::to_string(kind), static_cast<char>(kind) + text);
  };
  write(0, "rate_hz: 30\nagents:\n  - {name: cam0, source: cam0, calibration: calibration.yaml, start_s: 1}\n");
  write(1, "# t x y z qx qy qz qw\n0.5 1 2 3 0 0 0 1\n0.6 1 2 3 0 0 0 1\n");
  write(2, "id,x,y,z,cxx,cxy,cxz,cyy,cyz,czz,state,first_s,last_s,views\n1,0,0,1,1,0,0,1,0,1,static,0,1,5\n");
  write(3, "frame,t_s,track,x_px,y_px,point,state\n1,0.1,3,10,20,4,static\n");
  write(4, "t_s,object,x,y,z,vx,vy,vz,sx,sy,sz,members\n0.1,1,0,0,0,0,0,0,1,1,1,3 4 5\n");
  write(5, "set,t_s,kind,why\n");
  write(6, "cam1 cam0 0.1 0 0 0 0 0 1");
}

}  // namespace coslam
