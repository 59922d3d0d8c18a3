// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recording/recording.h"

#include <algorithm>
#include <fstream>

#include "common/base/error.h"
#include "common/base/file_kind.h"
#include "common/base/log.h"
#include "common/compression/compression.h"
#include "common/mcap/records.h"
#include "common/recording/bag_records.h"
#include "common/recording/containers.h"
#include "common/recording/temporary_file.h"

namespace coslam::recording {
namespace {

// The same with one more sentence to warn of.
class Warned final : public Recording {
 public:
  Warned(std::unique_ptr<Recording> inner, const std::string& warning)
      : inner_(std::move(inner)), warning_(inner_->warning().empty() ? warning : warning + "; " + inner_->warning()) {}

  const std::vector<Topic>& topics() const override { return inner_->topics(); }
  TimeNs first_ns() const override { return inner_->first_ns(); }
  const std::string& warning() const override { return warning_; }
  void play(std::size_t topic) override { inner_->play(topic); }
  std::optional<Message> next() override { return inner_->next(); }

 private:
  std::unique_ptr<Recording> inner_;
  std::string warning_;
};

std::unique_ptr<Recording> open_as_it_is(const std::filesystem::path& file, const std::string& name) {
  switch (container_of(file)) {
    case Container::kMcap:
      return open_mcap(file, name);
    case Container::kDb3:
      return open_db3(file, name);
    case Container::kBag:
      return open_bag(file, name);
    case Container::kZstd:
    case Container::kNone:
      break;
  }
  if (!std::ifstream(file)) throw UserError(name + ": cannot be read" + why_unreadable(file));
  throw UserError(name + ": is no MCAP file, no .db3 of rosbag2 and no bag of ROS 1");
}

// By way of a temporary file, since readers go back and forth.
std::unique_ptr<Recording> open_compressed(const std::filesystem::path& file) {
  TemporaryFile decompressed;
  log_info(file.string() + ": is decompressed first, to " + decompressed.path().parent_path().string());
  std::ifstream stream(file, std::ios::binary);
  const bool whole = zstd_decompress(stream, [&](std::string_view octets) { decompressed.write(octets); });
  auto recording = open_as_it_is(decompressed.path(), file.string());
  if (whole) return recording;
  return std::make_unique<Warned>(std::move(recording),
                                  file.string() + ": its compressed octets are cut off or damaged");
}

}  // namespace

std::size_t place_of(const Topic& topic, std::vector<Topic>& topics) {
  const auto found = std::ranges::find(topics, topic);
  const auto place = static_cast<std::size_t>(found - topics.begin());
  if (found == topics.end()) topics.push_back(topic);
  return place;
}

Container container_of(const std::filesystem::path& file) {
  using namespace std::string_view_literals;
  char octets[16] = {};
  std::ifstream stream(file, std::ios::binary);
  stream.read(octets, sizeof octets);
  const std::string_view start(octets, static_cast<std::size_t>(stream.gcount()));
  if (start.starts_with(mcap::kMagic.substr(0, 5))) return Container::kMcap;
  if (start == "SQLite format 3\0"sv) return Container::kDb3;
  if (start.starts_with(kBagMagic.substr(0, kBagMagic.find('V')))) return Container::kBag;
  return is_zstd(start) ? Container::kZstd : Container::kNone;
}

bool has_name_of_compressed(const std::filesystem::path& file) {
  return file.extension() == ".zstd" || file.extension() == ".zst";
}

bool has_name_of_recording(const std::filesystem::path& file) {
  const std::filesystem::path inner = has_name_of_compressed(file) ? file.stem() : file.filename();
  const std::string ending = inner.extension();
  return ending == ".mcap" || ending == ".db3" || ending == ".bag";
}

std::unique_ptr<Recording> open_file(const std::filesystem::path& file) {
  if (container_of(file) == Container::kZstd) return open_compressed(file);
  return open_as_it_is(file, file.string());
}

std::unique_ptr<Recording> open(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return open_folder(path);
  return open_file(path);
}

bool is_recording(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return is_folder_of_recordings(path);
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  const Container container = container_of(path);
  return container == Container::kZstd ? has_name_of_recording(path) : container != Container::kNone;
}

}  // namespace coslam::recording
