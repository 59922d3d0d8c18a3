// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/octet_type.h"

#include <cstring>

#include "common/base/check.h"
#include "common/base/error.h"

namespace coslam {
namespace {

using Octets = std::span<const std::uint8_t>;

class OctetType : public SampleType {
 public:
  explicit OctetType(const std::string& name) : SampleType(name, kNominalBytes) {}

 private:
  static constexpr std::uint32_t kNominalBytes = 4096;

  std::uint32_t bytes_of(const void* sample) const override {
    return static_cast<std::uint32_t>(static_cast<const Octets*>(sample)->size());
  }
  bool write(const void* sample, rtps::SerializedPayload_t& payload) const override {
    const auto& octets = *static_cast<const Octets*>(sample);
    if (octets.size() > payload.max_size) return false;
    std::memcpy(payload.data, octets.data(), octets.size());
    payload.length = static_cast<std::uint32_t>(octets.size());
    payload.encapsulation = CDR_LE;
    return true;
  }
  bool read(const rtps::SerializedPayload_t& payload, void* sample) const override {
    const auto& on_octets = *static_cast<OnOctets*>(sample);
    if (on_octets) on_octets({payload.data, payload.length});
    return true;
  }
  void* make_sample() const override { return new OnOctets; }
  void delete_sample(void* sample) const override { delete static_cast<OnOctets*>(sample); }
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
