// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/recording/containers.h"

namespace coslam::recording {
namespace {

void add_sentence(std::string& text, const std::string& sentence) {
  text += (text.empty() || sentence.empty() ? "" : "; ") + sentence;
}

// The files of one recording. Of hundreds only those are open whose time it is; a part that fails is left where it
// fails, and the others go on.
class Parts final : public Recording {
 public:
  Parts(const std::vector<std::filesystem::path>& files, std::string warning) : warning_(std::move(warning)) {
    for (const std::filesystem::path& file : files) {
      try {
        add(file, files.size() == 1);
      } catch (const UserError& e) {
        if (files.size() == 1) throw;
        add_sentence(warning_, e.what());
      }
    }
    if (parts_.empty()) throw UserError(warning_);
    std::ranges::stable_sort(parts_, {}, &Part::first_ns);
  }

  const std::vector<Topic>& topics() const override { return topics_; }
  const std::string& warning() const override { return warning_; }
  TimeNs first_ns() const override {
    const auto filled = std::ranges::find_if(parts_, [](const Part& p) { return p.first_ns != 0; });
    return filled == parts_.end() ? 0 : filled->first_ns;
  }

  void play(std::size_t topic) override {
    topic_ = topics_.at(topic);
    playing_.clear();
    next_part_ = 0;
  }

  std::optional<Message> next() override {
    while (next_part_ < parts_.size() &&
           (playing_.empty() || parts_[next_part_].first_ns <= earliest()->ahead.noted_ns)) {
      start(parts_[next_part_++]);
    }
    if (playing_.empty()) return std::nullopt;
    const auto from = earliest();
    Message message = std::move(from->ahead);
    if (!advance(*from)) playing_.erase(from);
    return message;
  }

 private:
  struct Part {
    std::filesystem::path file;
    TimeNs first_ns = 0;
    std::vector<Topic> topics;
    std::unique_ptr<Recording> open;  // of the only part, until it is played
  };
  struct Playing {
    std::unique_ptr<Recording> recording;
    Message ahead;
  };

  void add(const std::filesystem::path& file, bool stays_open) {
    auto recording = open_file(file);
    for (const Topic& topic : recording->topics()) place_of(topic, topics_);
    add_sentence(warning_, recording->warning());
    parts_.push_back({file, recording->first_ns(), recording->topics(), nullptr});
    if (stays_open) parts_.back().open = std::move(recording);
  }

  void start(Part& part) {
    const auto topic = std::ranges::find(part.topics, topic_);
    if (topic == part.topics.end()) return;
    try {
      Playing playing{part.open ? std::move(part.open) : open_file(part.file), {}};
      playing.recording->play(static_cast<std::size_t>(topic - part.topics.begin()));
      if (advance(playing)) playing_.push_back(std::move(playing));
    } catch (const UserError& e) {
      log_warn(e.what());
    }
  }

  // False: there is no further message of that part.
  static bool advance(Playing& playing) {
    try {
      auto message = playing.recording->next();
      if (!message) return false;
      playing.ahead = std::move(*message);
      return true;
    } catch (const UserError& e) {
      log_warn(e.what());
      return false;
    }
  }

  std::vector<Playing>::iterator earliest() {
    return std::ranges::min_element(playing_, {}, [](const Playing& p) { return p.ahead.noted_ns; });
  }

  std::string warning_;
  std::vector<Topic> topics_;
  std::vector<Part> parts_;  // by their first time
  Topic topic_;
  std::vector<Playing> playing_;
  std::size_t next_part_ = 0;
};

}  // namespace

std::unique_ptr<Recording> open_parts(const std::vector<std::filesystem::path>& files, const std::string& warning) {
  return std::make_unique<Parts>(files, warning);
}

}  // namespace coslam::recording
