// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/recording/recording.h"

// The kinds of recording behind open(). `name` is what errors and warnings call the file.
namespace coslam::recording {

std::unique_ptr<Recording> open_mcap(const std::filesystem::path& file, const std::string& name);
std::unique_ptr<Recording> open_db3(const std::filesystem::path& file, const std::string& name);
std::unique_ptr<Recording> open_bag(const std::filesystem::path& file, const std::string& name);
// Opens a file of any of these formats, compressed as a whole or not.
std::unique_ptr<Recording> open_file(const std::filesystem::path& file);
// Several files as one recording, by time. `warning`: what is known to be missing.
std::unique_ptr<Recording> open_parts(const std::vector<std::filesystem::path>& files, const std::string& warning);
// A folder as rosbag2 writes it.
std::unique_ptr<Recording> open_folder(const std::filesystem::path& folder);
bool is_folder_of_recordings(const std::filesystem::path& folder);

// Container format of a file, told by its first octets.
enum class Container : std::uint8_t { kNone, kMcap, kDb3, kBag, kZstd };
Container container_of(const std::filesystem::path& file);
// Whether a name ends as those of recordings do: ".mcap", ".db3", ".bag", and these with ".zstd" or ".zst".
bool has_name_of_recording(const std::filesystem::path& file);
bool has_name_of_compressed(const std::filesystem::path& file);

// The place of a topic among `topics`, added where it is new.
std::size_t place_of(const Topic& topic, std::vector<Topic>& topics);

}  // namespace coslam::recording
