// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/octet_topic.h"

#include "common/wire/participant_impl.h"

#include <cstring>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <utility>
#include <vector>

#include "common/base/check.h"
#include "common/base/error.h"
#include "common/wire/qos.h"

namespace coslam {
namespace {

using Octets = std::vector<std::uint8_t>;
using eprosima::fastrtps::rtps::SerializedPayload_t;

// What is written is a span of octets, what is read a vector of them.
class OctetType : public dds::TopicDataType {
 public:
  explicit OctetType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 4096;  // nominal: histories grow as samples need
    m_isGetKeyDefined = false;
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }

  bool serialize(void* data, SerializedPayload_t* payload) override {
    const auto& octets = *static_cast<std::span<const std::uint8_t>*>(data);
    if (octets.size() > payload->max_size) return false;
    std::memcpy(payload->data, octets.data(), octets.size());
    payload->length = static_cast<std::uint32_t>(octets.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(SerializedPayload_t* payload, void* data) override {
    static_cast<Octets*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<std::span<const std::uint8_t>*>(data)->size()); };
  }
  void* createData() override { return new Octets; }
  void deleteData(void* data) override { delete static_cast<Octets*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

Topic with_qos_of(const OctetTopic& topic) {
  return {.name = topic.name.c_str(),
          .way = Way::kDown,
          .reliable = topic.reliable,
          .late_joiners = topic.late_joiners,
          .writer_depth = topic.depth,
          .reader_depth = topic.depth};
}

dds::Topic* topic_in(Participant::Impl& participant, const OctetTopic& topic) {
  const std::lock_guard lock(participant.topics_mutex);
  if (dds::TopicDescription* known = participant.participant->lookup_topicdescription(topic.name)) {
    if (known->get_type_name() != topic.type) {
      throw UserError("topic " + topic.name + " is of type " + known->get_type_name() + ", not " + topic.type);
    }
    return static_cast<dds::Topic*>(known);
  }
  const dds::TypeSupport type(new OctetType(topic.type));
  type.register_type(participant.participant);
  dds::Topic* made = participant.participant->create_topic(topic.name, topic.type, dds::TOPIC_QOS_DEFAULT);
  COSLAM_CHECK(made != nullptr, "a topic needs nothing that could be missing");
  return made;
}

}  // namespace

struct OctetWriter::Impl {
  Participant::Impl& participant;
  dds::Publisher* publisher = nullptr;
  dds::DataWriter* writer = nullptr;
};

OctetWriter::OctetWriter(Participant& participant, const OctetTopic& topic)
    : impl_(std::make_unique<Impl>(Impl{participant.impl()})) {
  Participant::Impl& p = impl_->participant;
  dds::Topic* dds_topic = topic_in(p, topic);
  impl_->publisher = p.participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  COSLAM_CHECK(impl_->publisher != nullptr, "a publisher needs nothing that could be missing");
  impl_->writer = impl_->publisher->create_datawriter(dds_topic, writer_qos(with_qos_of(topic), p.config));
  COSLAM_CHECK(impl_->writer != nullptr, "the QoS of every kind of topic is tested");
}

OctetWriter::~OctetWriter() {
  impl_->publisher->delete_datawriter(impl_->writer);
  impl_->participant.participant->delete_publisher(impl_->publisher);
}

bool OctetWriter::write(std::span<const std::uint8_t> octets) { return impl_->writer->write(&octets); }

int OctetWriter::readers() const {
  dds::PublicationMatchedStatus status;
  impl_->writer->get_publication_matched_status(status);
  return status.current_count;
}

struct OctetReader::Impl : dds::DataReaderListener {
  Impl(Participant::Impl& p, OnSample handler) : participant(p), on_sample(std::move(handler)) {}

  void on_data_available(dds::DataReader* from) override {
    Octets octets;
    dds::SampleInfo info;
    while (from->take_next_sample(&octets, &info) == ReturnCode_t::RETCODE_OK) {
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
  dds::Topic* dds_topic = topic_in(p, topic);
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
