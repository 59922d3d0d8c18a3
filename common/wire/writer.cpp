// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>

#include "common/base/check.h"
#include "common/base/log.h"
#include "common/wire/participant_impl.h"
#include "common/wire/qos.h"

namespace coslam {
namespace {

// Unequal settings of two programs are the commonest cause of "no data", and DDS only whispers it.
class IncompatibleQos : public dds::DataWriterListener {
  void on_offered_incompatible_qos(dds::DataWriter* writer, const dds::OfferedIncompatibleQosStatus& status) override {
    log_warn("DDS: a reader of '" + writer->get_topic()->get_name() + "' asks for other QoS, policy " +
             std::to_string(status.last_policy_id) + ": it gets no data");
  }
};

}  // namespace

struct TopicWriter::Impl {
  Participant::Impl& participant;
  std::size_t topic;
  dds::Publisher* publisher = nullptr;
  dds::DataWriter* writer = nullptr;
  IncompatibleQos listener;

  Impl(Participant::Impl& p, std::size_t index) : participant(p), topic(index) {}
};

TopicWriter::TopicWriter(Participant& participant, std::size_t topic, const std::string& partition, Repeat repeat)
    : impl_(std::make_unique<Impl>(participant.impl(), topic)) {
  dds::PublisherQos qos;
  if (!partition.empty()) qos.partition().push_back(partition.c_str());
  Participant::Impl& p = impl_->participant;
  impl_->publisher = p.participant->create_publisher(qos);
  COSLAM_CHECK(impl_->publisher != nullptr, "a publisher needs nothing that could be missing");
  dds::StatusMask mask = dds::StatusMask::offered_incompatible_qos();
  impl_->writer = impl_->publisher->create_datawriter(p.topic(topic), writer_qos(kTopics[topic], p.config, repeat),
                                                      &impl_->listener, mask);
  COSLAM_CHECK(impl_->writer != nullptr, "the QoS of every topic is tested");
}

TopicWriter::~TopicWriter() {
  const bool flush = kTopics[impl_->topic].late_joiners && readers() > 0 && !impl_->participant.given_up;
  if (flush) impl_->writer->wait_for_acknowledgments(Duration_t(2.0L));
  impl_->publisher->delete_datawriter(impl_->writer);
  impl_->participant.participant->delete_publisher(impl_->publisher);
}

std::uint64_t TopicWriter::write(const void* message, std::size_t sample_bytes) {
  if (!write_sample(*impl_->writer, message)) return 0;
  const std::uint64_t bytes = impl_->participant.cost(sample_bytes);
  auto& counts = impl_->participant.counts[impl_->topic];
  counts.sent.fetch_add(1, std::memory_order_relaxed);
  counts.sent_bytes.fetch_add(bytes, std::memory_order_relaxed);
  return bytes;
}

void TopicWriter::assert_alive() { impl_->writer->assert_liveliness(); }

void TopicWriter::forget() {
  std::size_t forgotten = 0;
  impl_->writer->clear_history(&forgotten);
}

int TopicWriter::readers() const {
  dds::PublicationMatchedStatus status;
  impl_->writer->get_publication_matched_status(status);
  return status.current_count;
}

}  // namespace coslam
