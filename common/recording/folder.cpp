// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <fstream>

#include "common/base/error.h"
#include "common/config/yaml_value.h"
#include "common/recording/containers.h"

namespace coslam::recording {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetadata = "metadata.yaml";
constexpr const char* kInformation = "rosbag2_bagfile_information";

bool has_metadata(const fs::path& folder) {
  std::string start(4096, '\0');
  std::ifstream stream(folder / kMetadata, std::ios::binary);
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(stream.gcount()));
  return start.find(kInformation) != std::string::npos;
}

// Where a file that the metadata names lies, decompressed meanwhile or compressed. Early versions wrote the path from
// where the recorder ran. Empty: it is missing.
std::optional<fs::path> found(const fs::path& folder, const fs::path& named) {
  std::error_code ignored;
  for (const fs::path& base : {folder / named, folder / named.filename()}) {
    fs::path compressed = base, decompressed = base;
    compressed += ".zstd";
    if (base.extension() == ".zstd") decompressed.replace_extension();
    for (const fs::path& file : {base, decompressed, compressed}) {
      if (fs::is_regular_file(file, ignored)) return file;
    }
  }
  return std::nullopt;
}

// Those with names of recordings, by name; of a file that is there both compressed and not the latter.
std::vector<fs::path> recordings_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path& file = entry.path();
    if (!entry.is_regular_file(error) || !has_name_of_recording(file)) continue;
    const bool twice = has_name_of_compressed(file) && fs::exists(fs::path(file).replace_extension());
    if (!twice) files.push_back(file);
  }
  std::ranges::sort(files);
  return files;
}

std::unique_ptr<Recording> open_by_metadata(const fs::path& folder) {
  const YamlValue information = YamlValue::load(folder / kMetadata).at(kInformation);
  const auto format = information.find("compression_format");
  const std::string compression = format && format->is_scalar() ? format->text() : "";
  if (!compression.empty() && compression != "zstd") {
    throw UserError(folder.string() + ": is compressed with " + compression + ", which is not read; only zstd is");
  }
  std::vector<fs::path> files;
  std::string missing;
  const auto named = information.at("relative_file_paths").items();
  for (const YamlValue& name : named) {
    if (const auto file = found(folder, name.text())) {
      files.push_back(*file);
    } else {
      missing += (missing.empty() ? "" : ", ") + name.text();
    }
  }
  if (files.empty()) {
    const std::string none = folder.string() + ": none of the files that its metadata.yaml names are there: " + missing;
    files = recordings_in(folder);
    if (files.empty()) throw UserError(none);
    missing = none + "; those that are there are read";
  } else if (!missing.empty()) {
    missing = folder.string() + ": these of its files are missing: " + missing;
  }
  return open_parts(files, missing);
}

}  // namespace

std::unique_ptr<Recording> open_folder(const fs::path& folder) {
  if (has_metadata(folder)) return open_by_metadata(folder);
  const std::vector<fs::path> files = recordings_in(folder);
  if (files.empty()) {
    throw UserError(folder.string() + ": holds neither the metadata.yaml of rosbag2 nor .mcap, .db3 or .bag files");
  }
  return open_parts(files, "");
}

bool is_folder_of_recordings(const fs::path& folder) {
  if (has_metadata(folder)) return true;
  bool any = false;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const bool beside_db3 = name.ends_with(".db3-wal") || name.ends_with(".db3-shm");
    if (!entry.is_regular_file(error) || !(has_name_of_recording(entry.path()) || beside_db3)) return false;
    any = true;
  }
  return any;
}

}  // namespace coslam::recording
