// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "common/base/time.h"
#include "common/wire/participant.h"

namespace coslam {

// Names one writer somewhere in the domain; a restarted process has new ones.
struct WriterId {
  std::array<std::uint8_t, 16> guid{};
  friend auto operator<=>(const WriterId&, const WriterId&) = default;
};

enum class Presence : std::uint8_t {
  kAlive,   // matched, or heard again after silence
  kSilent,  // no sign of life for WireConfig::silent_after_s
  kGone,    // ended, or unheard for WireConfig::lease_s
};

// Origin and cost of a received sample.
struct Sample {
  WriterId writer;
  std::uint64_t bytes = 0;
  TimeNs written_ns = 0;  // UTC by the clock of the writer's machine
};

// One thread that waits for samples and for changes of presence of any number of topics and hands them on, the samples
// that came before a change of presence before it. The middleware's own threads only leave a note; all work is done
// here.
class Loop {
 public:
  template <class Message>
  using OnSample = std::function<void(const Message&, const Sample&)>;
  using OnPresence = std::function<void(const WriterId&, Presence)>;

  // on_tick is called about every `tick`, also when nothing arrives.
  Loop(Participant& participant, std::string name, std::chrono::milliseconds tick, std::function<void()> on_tick);
  ~Loop();  // stops; no handler runs afterwards
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  // Adds a topic, before start(). The topics of one loop are read in this order.
  template <class Message>
  void read(OnSample<Message> on_sample, const OnPresence& on_presence = {}, const std::string& partition = {}) {
    read_topic(topic_index<Message>(), std::make_unique<TypedInlet<Message>>(std::move(on_sample)), on_presence,
               partition);
  }
  void start();
  // How many writers of this topic, which is read, have been found and are there.
  template <class Message>
  int writers() const {
    return writers_of(topic_index<Message>());
  }

  // A place for one sample of a topic's type, and what is done with it.
  class Inlet {
   public:
    virtual ~Inlet() = default;
    virtual void* place() = 0;
    virtual std::size_t bytes() const = 0;  // serialized, of what lies there
    virtual void hand_on(const Sample& sample) = 0;
  };
  struct Impl;

 private:
  template <class Message>
  class TypedInlet : public Inlet {
   public:
    explicit TypedInlet(OnSample<Message> on_sample) : on_sample_(std::move(on_sample)) {}
    void* place() override { return &message_; }
    std::size_t bytes() const override { return sample_bytes(message_); }
    void hand_on(const Sample& sample) override { on_sample_(message_, sample); }

   private:
    OnSample<Message> on_sample_;
    Message message_;
  };

  void read_topic(std::size_t topic, std::unique_ptr<Inlet> inlet, OnPresence on_presence,
                  const std::string& partition);
  int writers_of(std::size_t topic) const;

  std::unique_ptr<Impl> impl_;
};

}  // namespace coslam
