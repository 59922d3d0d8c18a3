// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/guard.h"

#include <fcntl.h>
#include <openssl/core_names.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/params.h>
#include <openssl/rand.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <bitset>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <system_error>
#include <unordered_map>

#include "common/base/check.h"
#include "common/base/error.h"

namespace coslam {
namespace {

constexpr std::size_t kSenderBytes = 8, kCounterBytes = 8, kDigestBytes = 16;
static_assert(kSenderBytes + kCounterBytes + kDigestBytes == kSealBytes);
static_assert(std::endian::native == std::endian::little, "integers are copied as they lie in memory");

constexpr std::size_t kLeastSecret = 16, kMostSecret = 4096;

using Octets = std::span<const std::uint8_t>;
using Digest = std::array<std::uint8_t, 32>;

Octets octets_of_text(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::uint64_t integer_at(Octets octets, std::size_t at) {
  std::uint64_t value = 0;
  std::memcpy(&value, octets.data() + at, sizeof(value));
  return value;
}

// HMAC-SHA256 with one key. Thread-safe: one context serves all, since a new one for each datagram would cost more.
class Hmac {
 public:
  explicit Hmac(Octets key) {
    EVP_MAC* algorithm = EVP_MAC_fetch(nullptr, "HMAC", nullptr);
    context_.reset(algorithm == nullptr ? nullptr : EVP_MAC_CTX_new(algorithm));
    EVP_MAC_free(algorithm);
    std::string digest = "SHA256";
    const std::array<OSSL_PARAM, 2> parameters = {
        OSSL_PARAM_construct_utf8_string(OSSL_MAC_PARAM_DIGEST, digest.data(), 0), OSSL_PARAM_construct_end()};
    if (!context_ || EVP_MAC_init(context_.get(), key.data(), key.size(), parameters.data()) != 1) {
      throw UserError("the OpenSSL of this machine has no HMAC-SHA256, which wire.key_file needs");
    }
  }

  Digest digest_of(Octets octets) {
    Digest digest{};
    std::size_t written = 0;
    const std::lock_guard lock(mutex_);
    const bool done = EVP_MAC_init(context_.get(), nullptr, 0, nullptr) == 1 &&
                      EVP_MAC_update(context_.get(), octets.data(), octets.size()) == 1 &&
                      EVP_MAC_final(context_.get(), digest.data(), &written, digest.size()) == 1;
    COSLAM_CHECK(done && written == digest.size(), "an HMAC that worked once works again");
    return digest;
  }

 private:
  struct Free {
    void operator()(EVP_MAC_CTX* context) const { EVP_MAC_CTX_free(context); }
  };
  std::unique_ptr<EVP_MAC_CTX, Free> context_;
  std::mutex mutex_;
};

// Which of the newest counters of one sender were here.
class Window {
 public:
  // False when it was here before, or is too old to tell.
  bool take(std::uint64_t counter) {
    if (counter > newest_) {
      const std::uint64_t steps = std::min(counter - newest_, Opener::kWindow);
      for (std::uint64_t i = 0; i < steps; ++i) seen_.reset((counter - i) % Opener::kWindow);
      newest_ = counter;
    }
    if (newest_ - counter >= Opener::kWindow || seen_[counter % Opener::kWindow]) return false;
    seen_.set(counter % Opener::kWindow);
    return true;
  }

 private:
  std::uint64_t newest_ = 0;
  std::bitset<Opener::kWindow> seen_;
};

struct Sender {
  Window window;
  std::uint64_t last_heard = 0;  // in datagrams
};

std::uint64_t draw_sender() {
  std::array<std::uint8_t, kSenderBytes> octets{};
  do {
    if (RAND_bytes(octets.data(), static_cast<int>(octets.size())) != 1) {
      throw UserError("the OpenSSL of this machine has no random numbers, which wire.key_file needs");
    }
  } while (octets[0] == 'R');  // as RTPS starts
  return integer_at(octets, 0);
}

std::string read_secret(const std::string& file) {
  const auto refuse = [&](const std::string& why) { throw UserError("key file '" + file + "' " + why); };
  const int handle = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // not held up by a pipe
  if (handle < 0) refuse("cannot be opened: " + std::generic_category().message(errno));
  struct stat status {};
  const bool known = fstat(handle, &status) == 0;
  std::string content(kMostSecret + 2, '\0');  // the end of the line, and one more to see that it is too long
  const ssize_t size = read(handle, content.data(), content.size());
  close(handle);
  if (!known || size < 0 || !S_ISREG(status.st_mode)) refuse("cannot be read: it is not a file");
  if ((status.st_mode & 077) != 0) refuse("is open to others than its owner: chmod 600 it");
  content.resize(static_cast<std::size_t>(size));
  if (content.ends_with('\n')) content.pop_back();
  if (content.size() < kLeastSecret) refuse("holds less than " + std::to_string(kLeastSecret) + " bytes");
  if (content.size() > kMostSecret) refuse("holds more than " + std::to_string(kMostSecret) + " bytes");
  return content;
}

}  // namespace

FleetKey fleet_key(std::string_view secret, int domain) {
  return Hmac(octets_of_text(secret))
      .digest_of(octets_of_text("CoSLAM fleet key 1, DDS domain " + std::to_string(domain)));
}

FleetKey load_fleet_key(const std::string& file, int domain) { return fleet_key(read_secret(file), domain); }

struct Sealer::Impl {
  explicit Impl(const FleetKey& key) : hmac(key), sender(draw_sender()) {}

  Hmac hmac;
  const std::uint64_t sender;
  std::atomic<std::uint64_t> counter{0};
};

Sealer::Sealer(const FleetKey& key) : impl_(std::make_unique<Impl>(key)) {}

Sealer::~Sealer() = default;

void Sealer::seal(std::span<const std::uint8_t> payload, std::vector<std::uint8_t>& sealed) {
  const std::uint64_t counter = ++impl_->counter;
  sealed.resize(payload.size() + kSealBytes);
  std::uint8_t* at = sealed.data();
  std::memcpy(at, &impl_->sender, kSenderBytes);
  at = std::ranges::copy(payload, at + kSenderBytes).out;
  std::memcpy(at, &counter, kCounterBytes);
  const Digest digest = impl_->hmac.digest_of(Octets(sealed).first(sealed.size() - kDigestBytes));
  std::memcpy(at + kCounterBytes, digest.data(), kDigestBytes);
}

struct Opener::Impl {
  explicit Impl(const FleetKey& key) : hmac(key) {}

  // False when the sender sent it before.
  bool take(std::uint64_t sender, std::uint64_t counter) {
    const std::lock_guard lock(mutex);
    auto known = senders.find(sender);
    if (known == senders.end()) {
      if (senders.size() == kMostSenders) {
        senders.erase(std::ranges::min_element(senders, {}, [](const auto& s) { return s.second.last_heard; }));
      }
      known = senders.emplace(sender, Sender()).first;
    }
    known->second.last_heard = ++heard;
    return known->second.window.take(counter);
  }

  Hmac hmac;
  mutable std::mutex mutex;  // for what follows
  std::unordered_map<std::uint64_t, Sender> senders;
  std::uint64_t heard = 0;
};

Opener::Opener(const FleetKey& key) : impl_(std::make_unique<Impl>(key)) {}

Opener::~Opener() = default;

Opened Opener::open(std::span<const std::uint8_t> sealed) {
  if (sealed.size() < kSealBytes) return {Rejection::kUnauthentic, {}};
  const Digest digest = impl_->hmac.digest_of(sealed.first(sealed.size() - kDigestBytes));
  // In a time that does not tell how much of the tag is right.
  if (CRYPTO_memcmp(digest.data(), sealed.last(kDigestBytes).data(), kDigestBytes) != 0)
    return {Rejection::kUnauthentic, {}};
  const std::uint64_t counter = integer_at(sealed, sealed.size() - kDigestBytes - kCounterBytes);
  if (!impl_->take(integer_at(sealed, 0), counter)) return {Rejection::kReplayed, {}};
  return {std::nullopt, sealed.subspan(kSenderBytes, sealed.size() - kSealBytes)};
}

std::size_t Opener::senders() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->senders.size();
}

}  // namespace coslam
