// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/serialisers.h"

#include <array>
#include <exception>
#include <functional>
#include <tuple>

#include "idl/coslamPubSubTypes.h"

namespace coslam {
namespace {

// The generated serialiser, safe against strangers: it catches one kind of exception of its decoder only, and the
// others would end the process from a thread of the middleware.
template <class Generated>
class Guarded : public ReadThrough<Generated> {
 public:
  explicit Guarded(RejectionCounts& counts) : rejections_(counts) {}

 private:
  bool on_read(const std::function<bool()>& read) override {
    try {
      if (read()) return true;
    } catch (const std::exception&) {
    }
    rejections_.add(Rejection::kMalformed);
    return false;
  }

  RejectionCounts& rejections_;
};

using MakeSerialiser = dds::TopicDataType* (*)(RejectionCounts&);

template <class Serialiser>
dds::TopicDataType* make_guarded(RejectionCounts& rejections) {
  return new Guarded<Serialiser>(rejections);
}

template <class... Types>
constexpr std::array<MakeSerialiser, kTopicCount> makers_of(const std::tuple<Types...>&) {
  return {&make_guarded<typename Types::Serialiser>...};
}

constexpr auto kMakeSerialiser = makers_of(kMessageTypes);

}  // namespace

dds::TopicDataType* make_serialiser(std::size_t topic, RejectionCounts& rejections) {
  return kMakeSerialiser[topic](rejections);
}

}  // namespace coslam
