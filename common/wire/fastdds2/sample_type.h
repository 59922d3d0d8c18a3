// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/wire/fastdds2/names.h"

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
    setName(name.c_str());
    m_typeSize = nominal_bytes;
    m_isGetKeyDefined = with_key;
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }

 protected:
  virtual std::uint32_t bytes_of(const void* sample) const = 0;
  virtual bool write(const void* sample, rtps::SerializedPayload_t& payload) const = 0;  // false: no room
  virtual bool read(const rtps::SerializedPayload_t& payload, void* sample) const = 0;   // false: not one of ours
  virtual bool get_key(dds::InstanceHandle_t&) const { return false; }                   // false: it has none
  virtual void* make_sample() const = 0;
  virtual void delete_sample(void* sample) const = 0;

 private:
  bool serialize(void* data, rtps::SerializedPayload_t* payload) final { return write(data, *payload); }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) final { return read(*payload, data); }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) final {
    return [this, data] { return bytes_of(data); };
  }
  void* createData() final { return make_sample(); }
  void deleteData(void* data) final { delete_sample(data); }
  bool getKey(void*, dds::InstanceHandle_t* key, bool) final { return get_key(*key); }
};

// A generated serialiser, with a way in before it reads a sample.
template <class Generated>
class ReadThrough : public Generated {
 protected:
  // Calls read(), which reads the sample; false: it is none of this type. May throw.
  virtual bool on_read(const std::function<bool()>& read) = 0;

 private:
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) final {
    return on_read([&] { return Generated::deserialize(payload, data); });
  }
};

// The type's name in DDS.
inline std::string type_name(dds::TopicDataType& type) { return type.getName(); }

}  // namespace coslam
