// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <set>

#include "common/mcap/reader.h"
#include "common/recording/containers.h"

namespace coslam::recording {
namespace {

class McapRecording final : public Recording {
 public:
  McapRecording(const std::filesystem::path& file, const std::string& name) : reader_(file, name) {
    for (const auto& [id, channel] : reader_.channels()) {
      const std::size_t topic = place_of({channel.topic, reader_.schema_of(channel).name, channel.encoding}, topics_);
      channels_.resize(topics_.size());
      channels_[topic].insert(id);
    }
  }

  const std::vector<Topic>& topics() const override { return topics_; }
  TimeNs first_ns() const override { return reader_.first_ns(); }
  const std::string& warning() const override { return reader_.warning(); }
  void play(std::size_t topic) override { reader_.seek(channels_.at(topic)); }

  std::optional<Message> next() override {
    auto message = reader_.next();
    if (!message) return std::nullopt;
    return Message{message->noted_ns, std::move(message->octets)};
  }

 private:
  mcap::Reader reader_;
  std::vector<Topic> topics_;
  std::vector<std::set<std::uint16_t>> channels_;  // of each topic
};

}  // namespace

std::unique_ptr<Recording> open_mcap(const std::filesystem::path& file, const std::string& name) {
  return std::make_unique<McapRecording>(file, name);
}

}  // namespace coslam::recording
