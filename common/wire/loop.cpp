// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/loop.h"

#include "common/wire/participant_impl.h"

#include <algorithm>
#include <atomic>
#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/check.h"
#include "common/base/log.h"
#include "common/flow/worker.h"
#include "common/wire/qos.h"

namespace coslam {
namespace {

WriterId id_of(const dds::InstanceHandle_t& handle) {
  WriterId id;
  std::copy_n(static_cast<const rtps::octet*>(handle.value), id.guid.size(), id.guid.begin());
  return id;
}

// Notes changes of presence on the middleware's threads, for the loop to read. The status alone would not do: it names
// the last writer only, and twelve may fall silent at once when a cable is pulled.
class PresenceNotes : public dds::DataReaderListener {
 public:
  explicit PresenceNotes(dds::GuardCondition& wake) : wake_(wake) {}

  std::vector<std::pair<WriterId, Presence>> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(notes_, {});
  }

  int writers() const { return writers_; }

  void on_liveliness_changed(dds::DataReader*, const dds::LivelinessChangedStatus& s) override {
    if (s.not_alive_count_change > 0) note(s.last_publication_handle, Presence::kSilent);
    if (s.alive_count_change > 0) note(s.last_publication_handle, Presence::kAlive);
  }

  void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& s) override {
    writers_ = s.current_count;
    if (s.current_count_change < 0) note(s.last_publication_handle, Presence::kGone);
  }

  void on_requested_incompatible_qos(dds::DataReader* reader,
                                     const dds::RequestedIncompatibleQosStatus& status) override {
    log_warn("DDS: a writer of '" + reader->get_topicdescription()->get_name() + "' offers other QoS, policy " +
             std::to_string(status.last_policy_id) + ": its data cannot be read");
  }

 private:
  void note(const dds::InstanceHandle_t& writer, Presence presence) {
    {
      const std::lock_guard lock(mutex_);
      notes_.emplace_back(id_of(writer), presence);
    }
    wake_.set_trigger_value(true);
  }

  dds::GuardCondition& wake_;
  std::mutex mutex_;
  std::vector<std::pair<WriterId, Presence>> notes_;
  std::atomic<int> writers_{0};
};

// A reader of one topic.
class Source {
 public:
  Source(Participant::Impl& participant, std::size_t topic, dds::GuardCondition& wake,
         std::unique_ptr<Loop::Inlet> inlet, Loop::OnPresence on_presence, const std::string& partition)
      : participant_(participant),
        topic_(topic),
        inlet_(std::move(inlet)),
        notes_(wake),
        on_presence_(std::move(on_presence)) {
    dds::SubscriberQos qos;
    if (!partition.empty()) qos.partition().push_back(partition.c_str());
    subscriber_ = participant_.participant->create_subscriber(qos);
    COSLAM_CHECK(subscriber_ != nullptr, "a subscriber needs nothing that could be missing");
    dds::StatusMask mask = dds::StatusMask::liveliness_changed();
    mask << dds::StatusMask::subscription_matched() << dds::StatusMask::requested_incompatible_qos();
    reader_ = subscriber_->create_datareader(participant_.topic(topic), reader_qos(kTopics[topic], participant_.config),
                                             &notes_, mask);
    COSLAM_CHECK(reader_ != nullptr, "the QoS of every topic is tested");
    // Any other status would stay unread, keep the condition triggered and make the loop spin.
    reader_->get_statuscondition().set_enabled_statuses(dds::StatusMask::data_available());
  }

  ~Source() {
    subscriber_->delete_datareader(reader_);
    participant_.participant->delete_subscriber(subscriber_);
  }
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  void take_samples() {
    dds::SampleInfo info;
    while (reader_->take_next_sample(inlet_->place(), &info) == kTaken) {
      if (!info.valid_data) continue;
      const std::uint64_t bytes = participant_.cost(inlet_->bytes());
      auto& counts = participant_.counts[topic_];
      counts.received.fetch_add(1, std::memory_order_relaxed);
      counts.received_bytes.fetch_add(bytes, std::memory_order_relaxed);
      inlet_->hand_on({id_of(info.publication_handle), bytes, info.source_timestamp.to_ns()});
    }
  }

  // Two steps, so that the samples which came before a note can be handed on between them.
  void take_notes() { taken_ = notes_.take(); }
  void hand_on_notes() {
    for (const auto& [writer, presence] : taken_) {
      if (on_presence_) on_presence_(writer, presence);
    }
  }

  std::size_t topic() const { return topic_; }
  int writers() const { return notes_.writers(); }
  dds::StatusCondition& condition() { return reader_->get_statuscondition(); }

 private:
  Participant::Impl& participant_;
  const std::size_t topic_;
  std::unique_ptr<Loop::Inlet> inlet_;
  PresenceNotes notes_;
  std::vector<std::pair<WriterId, Presence>> taken_;
  Loop::OnPresence on_presence_;
  dds::Subscriber* subscriber_ = nullptr;
  dds::DataReader* reader_ = nullptr;
};

}  // namespace

struct Loop::Impl {
  Participant::Impl& participant;
  std::string name;
  std::chrono::milliseconds tick;
  std::function<void()> on_tick;
  dds::WaitSet wait_set;
  dds::GuardCondition wake;
  std::vector<std::unique_ptr<Source>> sources;
  std::optional<Worker> worker;

  void run(const std::stop_token& stop) {
    const std::stop_callback wake_up(stop, [this] { wake.set_trigger_value(true); });
    const Duration_t timeout(1e-3L * static_cast<long double>(tick.count()));
    auto next_tick = std::chrono::steady_clock::now() + tick;
    while (!stop.stop_requested()) {
      dds::ConditionSeq active;
      wait_set.wait(active, timeout);
      wake.set_trigger_value(false);
      for (auto& source : sources) source->take_notes();
      for (auto& source : sources) source->take_samples();
      for (auto& source : sources) source->hand_on_notes();
      const auto now = std::chrono::steady_clock::now();
      if (now < next_tick) continue;
      next_tick = now + tick;
      on_tick();
    }
  }
};

Loop::Loop(Participant& participant, std::string name, std::chrono::milliseconds tick, std::function<void()> on_tick)
    : impl_(new Impl{participant.impl(), std::move(name), tick, std::move(on_tick), {}, {}, {}, {}}) {
  impl_->wait_set.attach_condition(impl_->wake);
}

Loop::~Loop() = default;

void Loop::read_topic(std::size_t topic, std::unique_ptr<Inlet> inlet, OnPresence on_presence,
                      const std::string& partition) {
  auto source = std::make_unique<Source>(impl_->participant, topic, impl_->wake, std::move(inlet),
                                         std::move(on_presence), partition);
  impl_->wait_set.attach_condition(source->condition());
  impl_->sources.push_back(std::move(source));
}

int Loop::writers_of(std::size_t topic) const {
  const auto at = std::ranges::find(impl_->sources, topic, &Source::topic);
  return at == impl_->sources.end() ? 0 : (*at)->writers();
}

void Loop::start() {
  impl_->worker.emplace(impl_->name, [impl = impl_.get()](const std::stop_token& stop) { impl->run(stop); });
}

}  // namespace coslam
