// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/wire/fastdds3/names.h"

#include <cstdint>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <string>

namespace coslam {

// A type of samples that has no IDL: whoever derives from it says what their octets are.
class SampleType : public dds::TopicDataType {
 public:
  // `nominal_bytes`: of a sample; histories grow as samples need.
  SampleType(const std::string& name, std::uint32_t nominal_bytes, bool with_key = false) {
    set_name(name);
    max_serialized_type_size = nominal_bytes;
    is_compute_key_provided = with_key;
  }

 protected:
  virtual std::uint32_t bytes_of(const void* sample) const = 0;
  virtual bool write(const void* sample, rtps::SerializedPayload_t& payload) const = 0;  // false: no room
  virtual bool read(const rtps::SerializedPayload_t& payload, void* sample) const = 0;   // false: not one of ours
  virtual bool get_key(dds::InstanceHandle_t&) const { return false; }                   // false: it has none
  virtual void* make_sample() const = 0;
  virtual void delete_sample(void* sample) const = 0;

 private:
  bool serialize(const void* data, rtps::SerializedPayload_t& payload, dds::DataRepresentationId_t) final {
    return write(data, payload);
  }
  bool deserialize(rtps::SerializedPayload_t& payload, void* data) final { return read(payload, data); }
  std::uint32_t calculate_serialized_size(const void* data, dds::DataRepresentationId_t) final {
    return bytes_of(data);
  }
  void* create_data() final { return make_sample(); }
  void delete_data(void* data) final { delete_sample(data); }
  bool compute_key(rtps::SerializedPayload_t&, dds::InstanceHandle_t& key, bool) final { return get_key(key); }
  bool compute_key(const void*, dds::InstanceHandle_t& key, bool) final { return get_key(key); }
};

// A generated serialiser, with a way in before it reads a sample.
template <class Generated>
class ReadThrough : public Generated {
 protected:
  // Calls read(), which reads the sample; false: it is none of this type. May throw.
  virtual bool on_read(const std::function<bool()>& read) = 0;

 private:
  bool deserialize(rtps::SerializedPayload_t& payload, void* data) final {
    return on_read([&] { return Generated::deserialize(payload, data); });
  }
  // Without it the registration of the type warns that there is none: a fleet of several versions compares names alone.
  void register_type_object_representation() final {}
};

// The type's name in DDS.
inline std::string type_name(dds::TopicDataType& type) { return type.get_name(); }

}  // namespace coslam
