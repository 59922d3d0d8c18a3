// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/octet_inbox.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <map>
#include <mutex>
#include <utility>

#include "common/base/check.h"
#include "common/wire/octet_type.h"
#include "common/wire/qos.h"

namespace coslam {
namespace {

std::string name_of(dds::QosPolicyId_t policy) {
  switch (policy) {
    case dds::DURABILITY_QOS_POLICY_ID:
      return "durability";
    case dds::DEADLINE_QOS_POLICY_ID:
      return "deadline";
    case dds::OWNERSHIP_QOS_POLICY_ID:
      return "ownership";
    case dds::LIVELINESS_QOS_POLICY_ID:
      return "liveliness";
    case dds::RELIABILITY_QOS_POLICY_ID:
      return "reliability";
    case dds::DATAREPRESENTATION_QOS_POLICY_ID:
      return "data representation";
    default:
      return "policy " + std::to_string(policy);
  }
}

}  // namespace

struct OctetInbox::Impl : dds::DataReaderListener {
  explicit Impl(Participant::Impl& p) : participant(p) {}

  void on_data_available(dds::DataReader*) override {
    {
      const std::lock_guard lock(mutex);
      came = true;
    }
    changed.notify_all();
  }
  void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) override {
    writers = status.current_count;
  }
  void on_requested_incompatible_qos(dds::DataReader*, const dds::RequestedIncompatibleQosStatus& status) override {
    const std::lock_guard lock(mutex);
    unmatched_qos = name_of(status.last_policy_id);
  }

  void count(const dds::SampleInfo& info) {
    const std::uint64_t number = info.sample_identity.sequence_number().to64long();
    const std::lock_guard lock(mutex);
    std::uint64_t& newest = taken.try_emplace(info.publication_handle, number).first->second;
    if (number > newest + 1) missed += number - newest - 1;
    newest = std::max(newest, number);
  }

  Participant::Impl& participant;
  dds::Subscriber* subscriber = nullptr;
  dds::DataReader* reader = nullptr;
  std::atomic<int> writers{0};
  mutable std::mutex mutex;
  std::condition_variable changed;
  bool came = false;  // since the last wait
  std::string unmatched_qos;
  std::map<dds::InstanceHandle_t, std::uint64_t> taken;  // number of the newest, by writer
  std::uint64_t missed = 0;
};

OctetInbox::OctetInbox(Participant& participant, const OctetTopic& topic)
    : impl_(std::make_unique<Impl>(participant.impl())) {
  Participant::Impl& p = impl_->participant;
  dds::Topic* dds_topic = octet_topic_in(p, topic);
  impl_->subscriber = p.participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  COSLAM_CHECK(impl_->subscriber != nullptr, "a subscriber needs nothing that could be missing");
  dds::StatusMask mask = dds::StatusMask::data_available();
  mask << dds::StatusMask::subscription_matched() << dds::StatusMask::requested_incompatible_qos();
  impl_->reader =
      impl_->subscriber->create_datareader(dds_topic, reader_qos(with_qos_of(topic), p.config), impl_.get(), mask);
  COSLAM_CHECK(impl_->reader != nullptr, "the QoS of every kind of topic is tested");
}

OctetInbox::~OctetInbox() {
  impl_->subscriber->delete_datareader(impl_->reader);
  impl_->participant.participant->delete_subscriber(impl_->subscriber);
}

std::optional<TimeNs> OctetInbox::take(OnOctets read) {
  dds::SampleInfo info;
  while (impl_->reader->take_next_sample(&read, &info) == kTaken) {
    impl_->count(info);
    if (info.valid_data) return info.reception_timestamp.to_ns();
  }
  return std::nullopt;
}

void OctetInbox::wait(std::chrono::milliseconds most) {
  std::unique_lock lock(impl_->mutex);
  impl_->changed.wait_for(lock, most, [this] { return impl_->came; });
  impl_->came = false;
}

int OctetInbox::writers() const { return impl_->writers; }

std::uint64_t OctetInbox::missed() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->missed;
}

std::string OctetInbox::unmatched_qos() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->unmatched_qos;
}

}  // namespace coslam
