// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/octet_type.h"

#include <cstring>

#include "common/base/check.h"
#include "common/base/error.h"

namespace coslam {
namespace {

using eprosima::fastrtps::rtps::SerializedPayload_t;

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
    const auto& read = *static_cast<OnOctets*>(data);
    if (read) read({payload->data, payload->length});
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<std::span<const std::uint8_t>*>(data)->size()); };
  }
  void* createData() override { return new OnOctets; }
  void deleteData(void* data) override { delete static_cast<OnOctets*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

}  // namespace

dds::Topic* octet_topic_in(Participant::Impl& participant, const OctetTopic& topic) {
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

Topic with_qos_of(const OctetTopic& topic) {
  return {.name = topic.name.c_str(),
          .way = Way::kDown,
          .reliable = topic.reliable,
          .late_joiners = topic.late_joiners,
          .writer_depth = topic.depth,
          .reader_depth = topic.depth};
}

}  // namespace coslam
