// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A file that a user hands over: the first octet says which kind. It is loaded, or refused with a sentence.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/base/error.h"
#include "common/config/config.h"
#include "common/dataset/calibration.h"
#include "common/dataset/event_file.h"
#include "common/dataset/result.h"
#include "common/dataset/sequence.h"
#include "common/dataset/trajectory.h"
#include "common/model/rig.h"
#include "common/wire/wire_options.h"

namespace coslam {
namespace {

constexpr int kKinds = 9;

void load(int kind, const std::filesystem::path& file, const std::string& text) {
  switch (kind) {
    case 0:
      load_calibration(file);
      return;
    case 1:
      load_sequence(file);
      return;
    case 2:
      load_tum(file);
      return;
    case 3: {
      WireConfig config;
      config::load(config, file);
      return;
    }
    case 4:
      read_points(file);
      return;
    case 5:
      for_each_track_row(file, [](const ResultTrackRow&) {});
      return;
    case 6:
      for_each_object_row(file, [](const ResultObjectRow&) {});
      return;
    case 7:
      for_each_event_row(file, [](const EventRow&) { return true; });
      return;
    default:
      parse_rig_camera(text);
  }
}

void write_seeds(const std::filesystem::path& folder) {
  const auto write = [&](int kind, const std::string& text) {
    std::ofstream(folder / ("kind" + std::to_string(kind)), std::ios::binary) << static_cast<char>(kind) << text;
  };
  write(0,
        "width: 640\nheight: 480\nfx: 500\nfy: 500\ncx: 320\ncy: 240\ndistortion: radtan\ncoefficients: [0.1, 0, 0, "
        "0]\n");
  write(1, "rate_hz: 30\nagents:\n  - {name: cam0, source: cam0, calibration: calibration.yaml, start_s: 1}\n");
  write(2, "# t x y z qx qy qz qw\n0.5 1 2 3 0 0 0 1\n0.6 1 2 3 0 0 0 1\n");
  write(3, "domain: 7\npeers: [10.0.0.1]\nbulk_bytes_per_s: 100000\n");
  write(4, "id,x,y,z,cxx,cxy,cxz,cyy,cyz,czz,state,first_s,last_s,views\n1,0,0,1,1,0,0,1,0,1,static,0,1,5\n");
  write(5, "frame,t_s,track,x_px,y_px,point,state\n1,0.1,3,10,20,4,static\n");
  write(6, "t_s,object,x,y,z,vx,vy,vz,sx,sy,sz,members\n0.1,1,0,0,0,0,0,0,1,1,1,3 4 5\n");
  write(7, "set,t_s,kind,why\n");
  write(8, "cam1 cam0 0.1 0 0 0 0 0 1");
}

}  // namespace
}  // namespace coslam

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  if (const char* folder = std::getenv("COSLAM_FUZZ_SEEDS")) coslam::write_seeds(folder);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const int file = memfd_create("fuzz", 0);
  if (file < 0 || write(file, text.data(), text.size()) != static_cast<ssize_t>(text.size())) std::abort();
  try {
    coslam::load(data[0] % coslam::kKinds, "/proc/self/fd/" + std::to_string(file), text);
  } catch (const coslam::UserError&) {
    // As it should be.
  }
  close(file);
  return 0;
}
