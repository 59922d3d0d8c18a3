// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/formats.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "common/base/text.h"

namespace coslam::exporting {
namespace {

using Path = std::filesystem::path;

template <Files (*kExport)(const ResultMap&, const Path&)>
Files maps_alone(const ResultContents& contents, const Path& folder, const Sequence* /*sequence*/,
                 const FormatOptions& /*options*/) {
  return export_maps(contents, folder, kExport);
}

Files ply(const ResultContents& contents, const Path& folder, const Sequence* sequence,
          const FormatOptions& /*options*/) {
  if (sequence == nullptr) return export_maps(contents, folder, export_ply);
  return export_maps(contents, folder,
                     [&](const ResultMap& map, const Path& to) { return export_ply_in_colour(map, *sequence, to); });
}

Files colmap(const ResultContents& contents, const Path& folder, const Sequence* sequence,
             const FormatOptions& options) {
  const ColmapOptions every{.every = options.every.value_or(kTracksOfEvery)};
  return export_maps(contents, folder, [&](const ResultMap& map, const Path& to) {
    return options.undistort ? export_colmap_undistorted(map, *sequence, to, every)
                             : export_colmap(map, *sequence, to, every);
  });
}

// All maps in one file.
Files mcap(const ResultContents& contents, const Path& folder, const Sequence* /*sequence*/,
           const FormatOptions& /*options*/) {
  return export_mcap(contents, folder);
}

std::string lines_without_times(const ResultMap& map) {
  const std::string gaps = gaps_of(map);
  return gaps.empty() ? "" : gaps + "; lines of KITTI have no times: they stand in *.times.txt";
}

constexpr std::array kFormats{
    Format{.name = "colmap", .sequence = UsesSequence::kAlways, .takes_options = true, .write = colmap},
    Format{.name = "ply", .sequence = UsesSequence::kIfGiven, .write = ply},
    Format{.name = "tum", .write = maps_alone<export_tum>},
    Format{.name = "euroc", .write = maps_alone<export_euroc>},
    Format{.name = "kitti", .write = maps_alone<export_kitti>, .lacks = lines_without_times},
    Format{.name = "mcap", .write = mcap}};

}  // namespace

std::span<const Format> formats() { return kFormats; }

std::vector<std::string> names_of_formats() {
  std::vector<std::string> names;
  for (const Format& f : kFormats) names.emplace_back(f.name);
  return names;
}

const Format& format_of(std::string_view name) {
  const auto at = std::ranges::find(kFormats, name, &Format::name);
  if (at == kFormats.end()) throw std::out_of_range("no such format");
  return *at;
}

std::string formats_where(bool (*holds)(const Format&)) {
  std::string out;
  for (const Format& f : kFormats) {
    if (holds(f)) out += (out.empty() ? "" : " and ") + std::string(f.name);
  }
  return out;
}

}  // namespace coslam::exporting
