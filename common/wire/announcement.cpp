// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/announcement.h"

#include <algorithm>

namespace coslam {
namespace {

using Octets = std::span<const std::uint8_t>;

constexpr std::size_t kHeader = 20, kSubmessageHeader = 4;
constexpr std::uint8_t kData = 0x15;
constexpr std::uint8_t kLittleEndian = 0x01, kInlineQos = 0x02, kHasData = 0x04;
// The writer of announcements.
constexpr std::array<std::uint8_t, 4> kParticipantWriter{0x00, 0x01, 0x00, 0xc2};
constexpr std::uint16_t kEnd = 0x0001, kName = 0x0062, kUnicast = 0x0032;
constexpr std::size_t kLocator = 24, kMostName = 64, kMostEndpoints = 64;

// A part of a datagram, read from the front. What is asked for beyond its end is 0.
class Reader {
 public:
  Reader(Octets octets, bool little) : octets_(octets), little_(little) {}

  Octets take(std::size_t count) {
    const Octets out = octets_.first(std::min(count, octets_.size()));
    octets_ = octets_.subspan(out.size());
    return out;
  }
  std::uint32_t number(std::size_t bytes) {
    const Octets part = take(bytes);
    if (part.size() < bytes) return 0;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) value = value << 8U | part[little_ ? bytes - 1 - i : i];
    return value;
  }
  bool empty() const { return octets_.empty(); }

 private:
  Octets octets_;
  bool little_;
};

// Calls visit(id, value) with each parameter of a list, up to its end.
template <class Visit>
void for_each_parameter(Reader& list, Visit visit) {
  while (!list.empty()) {
    const auto id = static_cast<std::uint16_t>(list.number(2));
    const std::uint32_t length = list.number(2);
    if (id == kEnd) return;
    visit(id, list.take(length));
  }
}

std::string text_of(Octets value, bool little) {
  Reader reader(value, little);
  const std::uint32_t length = reader.number(4);
  std::string text;
  for (const std::uint8_t c : reader.take(std::min<std::size_t>(length, kMostName))) {
    if (c == 0) break;
    text.push_back(c >= 0x20 && c < 0x7f ? static_cast<char>(c) : '?');
  }
  return text;
}

std::optional<Ipv4Endpoint> endpoint_of(Octets value, bool little) {
  constexpr std::uint32_t kUdpV4 = 1;
  if (value.size() != kLocator) return std::nullopt;
  Reader reader(value, little);
  const std::uint32_t kind = reader.number(4), port = reader.number(4);
  Reader address(value.last(4), false);
  if (kind != kUdpV4 || port == 0 || port > 65535) return std::nullopt;
  return Ipv4Endpoint{address.number(4), static_cast<std::uint16_t>(port)};
}

// Of the content of a DATA submessage.
bool read_data(Octets data, std::uint8_t flags, Announcement& out) {
  Reader reader(data, (flags & kLittleEndian) != 0);
  reader.take(2);  // extra flags
  const std::uint32_t to_qos = reader.number(2);
  reader.take(4);  // whom it is for
  if ((flags & kHasData) == 0 || !std::ranges::equal(reader.take(4), kParticipantWriter)) return false;
  constexpr std::uint32_t kRead = 8;  // of what to_qos counts
  reader.take(to_qos < kRead ? 0 : to_qos - kRead);
  if ((flags & kInlineQos) != 0) for_each_parameter(reader, [](std::uint16_t, Octets) {});
  const Octets encapsulation = reader.take(4);
  if (encapsulation.size() < 4 || encapsulation[0] != 0 || (encapsulation[1] != 2 && encapsulation[1] != 3))
    return false;
  const bool little = encapsulation[1] == 3;
  Reader list(reader.take(data.size()), little);
  for_each_parameter(list, [&](std::uint16_t id, Octets value) {
    if (id == kName) out.name = text_of(value, little);
    if (id != kUnicast || out.endpoints.size() == kMostEndpoints) return;
    if (const auto endpoint = endpoint_of(value, little)) out.endpoints.push_back(*endpoint);
  });
  return true;
}

}  // namespace

bool is_rtps(Octets datagram) {
  constexpr std::array<std::uint8_t, 4> kMagic{'R', 'T', 'P', 'S'};
  return datagram.size() >= kHeader && std::ranges::equal(datagram.first(kMagic.size()), kMagic);
}

std::optional<Announcement> read_announcement(Octets datagram) {
  if (!is_rtps(datagram)) return std::nullopt;
  Announcement out;
  std::ranges::copy(datagram.subspan(6, 2), out.vendor.begin());
  std::ranges::copy(datagram.subspan(8, out.key.size()), out.key.begin());
  Octets rest = datagram.subspan(kHeader);
  while (rest.size() >= kSubmessageHeader) {
    const std::uint8_t kind = rest[0], flags = rest[1];
    Reader header(rest.subspan(2), (flags & kLittleEndian) != 0);
    std::size_t length = header.number(2);
    rest = rest.subspan(kSubmessageHeader);
    if (length == 0) length = rest.size();  // the last one, to the end
    if (length > rest.size()) return std::nullopt;
    if (kind == kData && read_data(rest.first(length), flags, out)) return out;
    rest = rest.subspan(length);
  }
  return std::nullopt;
}

}  // namespace coslam
