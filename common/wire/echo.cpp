// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/echo.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <mutex>

#include "common/flow/clock.h"
#include "common/model/session.h"

namespace coslam {
namespace {

static_assert(std::endian::native == std::endian::little, "integers are copied as they lie in memory");

// What each begins with: nothing of RTPS does, and older programs take it for nonsense.
constexpr std::array<std::uint8_t, 4> kRequest{'C', 'S', 'L', '?'}, kAnswer{'C', 'S', 'L', '!'};
constexpr std::size_t kNumberAt = 8, kPortAt = 16, kTimeAt = 16, kProtocolAt = 24, kNameAt = 32;
constexpr std::size_t kMostNameBytes = kEchoBytes - kNameAt - 1;

template <class T>
void put(EchoOctets& octets, std::size_t at, const T& value) {
  std::memcpy(octets.data() + at, &value, sizeof value);
}

template <class T>
T get(std::span<const std::uint8_t> octets, std::size_t at) {
  T value{};
  std::memcpy(&value, octets.data() + at, sizeof value);
  return value;
}

bool begins(std::span<const std::uint8_t> datagram, const std::array<std::uint8_t, 4>& magic) {
  return datagram.size() == kEchoBytes && std::ranges::equal(datagram.first(magic.size()), magic);
}

}  // namespace

EchoOctets encode(const EchoRequest& request) {
  EchoOctets octets{};
  std::ranges::copy(kRequest, octets.begin());
  put(octets, kNumberAt, request.number);
  put(octets, kPortAt, request.answer_port);
  return octets;
}

EchoOctets encode(const EchoAnswer& answer) {
  EchoOctets octets{};
  std::ranges::copy(kAnswer, octets.begin());
  put(octets, kNumberAt, answer.number);
  put(octets, kTimeAt, answer.answered_ns);
  put(octets, kProtocolAt, answer.protocol);
  std::copy_n(answer.name.begin(), std::min(answer.name.size(), kMostNameBytes), octets.begin() + kNameAt);
  return octets;
}

std::optional<EchoRequest> decode_echo_request(std::span<const std::uint8_t> datagram) {
  if (!begins(datagram, kRequest)) return std::nullopt;
  return EchoRequest{get<std::uint64_t>(datagram, kNumberAt), get<std::uint16_t>(datagram, kPortAt)};
}

std::optional<EchoAnswer> decode_echo_answer(std::span<const std::uint8_t> datagram) {
  if (!begins(datagram, kAnswer)) return std::nullopt;
  EchoAnswer answer{get<std::uint64_t>(datagram, kNumberAt),
                    get<TimeNs>(datagram, kTimeAt),
                    get<std::uint16_t>(datagram, kProtocolAt),
                    {}};
  for (std::size_t i = kNameAt; i < kEchoBytes && datagram[i] != 0; ++i) {
    const bool printable = datagram[i] >= 0x20 && datagram[i] < 0x7f;
    answer.name.push_back(printable ? static_cast<char>(datagram[i]) : '?');
  }
  return answer;
}

struct EchoAnswerer::Impl {
  // A flood of questions takes no more than this of the link.
  static constexpr int kMostPerSecond = 200;

  bool pass() {
    const std::lock_guard lock(mutex);
    const Instant now = std::chrono::steady_clock::now();
    if (now - second >= std::chrono::seconds(1)) {
      second = now;
      answered = 0;
    }
    return ++answered <= kMostPerSecond;
  }

  void send(std::span<const std::uint8_t> datagram, const Ipv4Endpoint& to) const {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(to.address);
    address.sin_port = htons(to.port);
    // One that is lost is what the question is about.
    (void)sendto(socket, datagram.data(), datagram.size(), MSG_DONTWAIT, reinterpret_cast<const sockaddr*>(&address),
                 sizeof address);
  }

  std::string name;
  std::optional<Sealer> sealer;
  int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  std::mutex mutex;  // for what follows
  Instant second{};
  int answered = 0;
};

EchoAnswerer::EchoAnswerer(const std::string& name, const std::optional<FleetKey>& key)
    : impl_(std::make_unique<Impl>()) {
  impl_->name = name;
  if (key) impl_->sealer.emplace(*key);
}

EchoAnswerer::~EchoAnswerer() { close(impl_->socket); }

bool EchoAnswerer::take(std::span<const std::uint8_t> datagram, const Ipv4Endpoint& from) {
  const auto request = decode_echo_request(datagram);
  if (!request) return false;
  if (!impl_->pass()) return true;
  const EchoOctets answer = encode(EchoAnswer{request->number, time_of_day_ns(), kProtocolVersion, impl_->name});
  const Ipv4Endpoint to{from.address, request->answer_port == 0 ? from.port : request->answer_port};
  if (!impl_->sealer) {
    impl_->send(answer, to);
    return true;
  }
  std::vector<std::uint8_t> sealed;
  impl_->sealer->seal(answer, sealed);
  impl_->send(sealed, to);
  return true;
}

}  // namespace coslam
