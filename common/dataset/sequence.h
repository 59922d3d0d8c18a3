// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.h"
#include "common/model/rig.h"

namespace coslam {

struct SequenceAgent {
  std::string name;
  std::string source;                 // URI or absolute path, see agent/capture/source.h
  std::filesystem::path calibration;  // empty: none, the lens is found out
  double start_s = 0;
  bool start_is_open = false;  // to be found out
  std::optional<double> duration_s;
  std::optional<std::filesystem::path> truth;  // TUM, camera to world; its time 0 is this one of the source:
  double truth_start_s = 0;                    // start_s as the file has it
  std::vector<TimeSpan> covered;               // played times at which the lens is covered
  std::optional<std::filesystem::path> mask;   // black where nothing is to be tracked

  // Sets the start to where the source was found to begin. The duration of an open source counts from its beginning.
  void begin_at(double found_s) {
    if (start_is_open && duration_s) *duration_s -= found_s - start_s;
    start_s = found_s;
  }
};

// A sequence description (see docs/configuration.md): agents that play at the same time.
struct Sequence {
  std::string name;
  std::filesystem::path file;  // the YAML file it came from
  double rate_hz = 30;
  bool rate_is_given = false;
  std::optional<double> baseline_m;  // known distance of the first two cameras at the start
  std::optional<double> tag_m;       // or else the side of every printed tag
  std::string tag_family = "DICT_APRILTAG_36h11";
  std::vector<SequenceAgent> agents;
  std::vector<RigCamera> rigs;
  std::optional<std::filesystem::path> truth_points;  // t_s,id,x,y,z
  std::optional<std::filesystem::path> masks;         // <masks>/<agent>/<6-digit frame>.png, non-zero = moving
  std::optional<std::filesystem::path> overlap;       // t_s,agent_a,agent_b,share of the view of a that b sees too
  std::string scene;                                  // name of the simulated scene that rendered it, or empty
  std::uint64_t scene_seed = 0;
};

// Reads a YAML file or a folder with sequence.yaml; paths in it are relative to the file. Throws UserError with file,
// key and reason: unknown key, missing key, bad value, missing file.
Sequence load_sequence(const std::filesystem::path& path);

// A camera, stream or topic at work, by how its name begins; else a file, a folder or a topic of a recording.
bool is_live_source(std::string_view source);

// A source's name as it is said to users and written to logs: without names and passwords of users, as in
// rtsp://***@host.
std::string shown_source(const std::string& source);

// A name that an agent may have, as like this text as can be: names become file names and travel in every frame.
std::string agent_name_like(std::string_view text);

}  // namespace coslam
