// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/octet_topic.h"

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <utility>
#include <vector>

#include "common/base/check.h"
#include "common/wire/octet_type.h"
#include "common/wire/qos.h"

namespace coslam {

struct OctetWriter::Impl {
  Participant::Impl& participant;
  dds::Publisher* publisher = nullptr;
  dds::DataWriter* writer = nullptr;
};

OctetWriter::OctetWriter(Participant& participant, const OctetTopic& topic)
    : impl_(std::make_unique<Impl>(Impl{participant.impl()})) {
  Participant::Impl& p = impl_->participant;
  dds::Topic* dds_topic = octet_topic_in(p, topic);
  impl_->publisher = p.participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  COSLAM_CHECK(impl_->publisher != nullptr, "a publisher needs nothing that could be missing");
  impl_->writer = impl_->publisher->create_datawriter(dds_topic, writer_qos(with_qos_of(topic), p.config));
  COSLAM_CHECK(impl_->writer != nullptr, "the QoS of every kind of topic is tested");
}

OctetWriter::~OctetWriter() {
  impl_->publisher->delete_datawriter(impl_->writer);
  impl_->participant.participant->delete_publisher(impl_->publisher);
}

bool OctetWriter::write(std::span<const std::uint8_t> octets) { return write_sample(*impl_->writer, &octets); }

int OctetWriter::readers() const {
  dds::PublicationMatchedStatus status;
  impl_->writer->get_publication_matched_status(status);
  return status.current_count;
}

struct OctetReader::Impl : dds::DataReaderListener {
  Impl(Participant::Impl& p, OnSample handler) : participant(p), on_sample(std::move(handler)) {}

  void on_data_available(dds::DataReader* from) override {
    std::vector<std::uint8_t> octets;
    OnOctets copy = [&](std::span<const std::uint8_t> sample) { octets.assign(sample.begin(), sample.end()); };
    dds::SampleInfo info;
    while (from->take_next_sample(&copy, &info) == kTaken) {
      if (info.valid_data) on_sample(octets);
    }
  }

  Participant::Impl& participant;
  OnSample on_sample;
  dds::Subscriber* subscriber = nullptr;
  dds::DataReader* reader = nullptr;
};

OctetReader::OctetReader(Participant& participant, const OctetTopic& topic, OnSample on_sample)
    : impl_(std::make_unique<Impl>(participant.impl(), std::move(on_sample))) {
  Participant::Impl& p = impl_->participant;
  dds::Topic* dds_topic = octet_topic_in(p, topic);
  impl_->subscriber = p.participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  COSLAM_CHECK(impl_->subscriber != nullptr, "a subscriber needs nothing that could be missing");
  impl_->reader = impl_->subscriber->create_datareader(dds_topic, reader_qos(with_qos_of(topic), p.config), impl_.get(),
                                                       dds::StatusMask::data_available());
  COSLAM_CHECK(impl_->reader != nullptr, "the QoS of every kind of topic is tested");
}

OctetReader::~OctetReader() {
  impl_->subscriber->delete_datareader(impl_->reader);
  impl_->participant.participant->delete_subscriber(impl_->subscriber);
}

}  // namespace coslam
