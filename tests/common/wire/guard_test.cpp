// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <random>
#include <set>
#include <thread>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::guard_test {
namespace {

using test::error_of;
using testing::HasSubstr;
using Octets = std::vector<std::uint8_t>;

constexpr std::string_view kSecret = "a secret of 24 characters";

Octets text(std::string_view content) { return {content.begin(), content.end()}; }

Octets sealed(Sealer& sealer, std::string_view content) {
  Octets out;
  sealer.seal(text(content), out);
  return out;
}

std::string name_of_refusal(const Opened& opened) {
  return opened.refused ? std::string(name_of(*opened.refused)) : "accepted";
}

class Guard : public ::testing::Test {
 protected:
  std::string open(const Octets& octets) { return name_of_refusal(opener_.open(octets)); }

  FleetKey key_ = fleet_key(kSecret, 7);
  Sealer sealer_{key_};
  Opener opener_{key_};
};

TEST_F(Guard, WhatIsSealedOpens) {
  for (const std::string content : {"", "R", "RTPS and more"}) {
    const Octets octets = sealed(sealer_, content);
    ASSERT_EQ(octets.size(), content.size() + kSealBytes);
    const Opened opened = opener_.open(octets);
    EXPECT_EQ(name_of_refusal(opened), "accepted");
    EXPECT_EQ(Octets(opened.payload.begin(), opened.payload.end()), text(content));
  }
}

TEST_F(Guard, NeverLooksLikeTheMiddlewaresOwn) {
  for (int i = 0; i < 2000; ++i) {
    Sealer sealer(key_);
    ASSERT_NE(sealed(sealer, "RTPS")[0], 'R');
  }
}

TEST_F(Guard, AnotherKeyIsRefused) {
  Sealer other_secret(fleet_key("another secret of theirs", 7)), other_domain(fleet_key(kSecret, 8));
  EXPECT_EQ(open(sealed(other_secret, "hello")), "unauthentic");
  EXPECT_EQ(open(sealed(other_domain, "hello")), "unauthentic");
  EXPECT_EQ(open(text("RTPS without any seal, of some length")), "unauthentic");
  EXPECT_EQ(opener_.senders(), 0u) << "strangers leave no trace";
}

TEST_F(Guard, EveryFlippedBitIsRefused) {
  const Octets good = sealed(sealer_, "a payload of some octets");
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    Octets bad = good;
    bad[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    ASSERT_EQ(open(bad), "unauthentic") << "bit " << bit;
  }
  EXPECT_EQ(open(good), "accepted") << "refused ones leave no trace";
}

TEST_F(Guard, OtherLengthsAreRefused) {
  const Octets good = sealed(sealer_, "a payload of some octets");
  for (std::size_t size = 0; size < good.size(); ++size) {
    ASSERT_EQ(open(Octets(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size))), "unauthentic") << size;
  }
  Octets longer = good;
  longer.push_back(0);
  EXPECT_EQ(open(longer), "unauthentic");
}

TEST_F(Guard, ASecondTimeIsAReplay) {
  const Octets one = sealed(sealer_, "one"), two = sealed(sealer_, "one");
  EXPECT_NE(one, two) << "the counter differs";
  EXPECT_EQ(open(one), "accepted");
  EXPECT_EQ(open(one), "replayed");
  EXPECT_EQ(open(two), "accepted");
  EXPECT_EQ(open(one), "replayed");
  EXPECT_EQ(open(two), "replayed");
}

TEST_F(Guard, AnyOrderWithinTheWindow) {
  std::vector<Octets> all(Opener::kWindow);
  for (Octets& octets : all) octets = sealed(sealer_, "payload");
  std::mt19937 random(1);
  std::ranges::shuffle(all, random);
  for (const Octets& octets : all) ASSERT_EQ(open(octets), "accepted");
  for (const Octets& octets : all) ASSERT_EQ(open(octets), "replayed");
}

TEST_F(Guard, OlderThanTheWindowIsRefused) {
  std::vector<Octets> all(Opener::kWindow + 2);
  for (Octets& octets : all) octets = sealed(sealer_, "payload");
  EXPECT_EQ(open(all.back()), "accepted");
  EXPECT_EQ(open(all[0]), "replayed");
  EXPECT_EQ(open(all[1]), "replayed");
  EXPECT_EQ(open(all[2]), "accepted") << "the oldest one of the window";
}

// Against a set of all counters that were accepted.
TEST_F(Guard, JumpsForgetWhatTheyPass) {
  std::vector<Octets> all(4 * Opener::kWindow);
  for (Octets& octets : all) octets = sealed(sealer_, "payload");
  std::set<std::size_t> accepted;
  std::size_t newest = 0;
  std::mt19937 random(2);
  for (std::size_t at = 0; at < all.size(); at += 1 + random() % 900) {
    for (int i = 0; i < 20; ++i) {
      const std::size_t chosen = i == 0 ? at : at - std::min<std::size_t>(at, random() % (2 * Opener::kWindow));
      newest = std::max(newest, chosen);
      const bool fits = newest - chosen < Opener::kWindow && accepted.insert(chosen).second;
      ASSERT_EQ(open(all[chosen]), fits ? "accepted" : "replayed") << chosen << " of " << newest;
    }
  }
}

TEST_F(Guard, SendersAreBounded) {
  const Octets first = sealed(sealer_, "first");
  Sealer lively(key_);
  const Octets kept = sealed(lively, "kept");
  EXPECT_EQ(open(first), "accepted");
  EXPECT_EQ(open(kept), "accepted");
  for (std::size_t i = 0; i < Opener::kMostSenders; ++i) {
    Sealer sealer(key_);
    ASSERT_EQ(open(sealed(sealer, "payload")), "accepted");
    ASSERT_EQ(open(sealed(lively, "payload")), "accepted");
  }
  EXPECT_EQ(opener_.senders(), Opener::kMostSenders);
  EXPECT_EQ(open(kept), "replayed") << "who talks is remembered";
  EXPECT_EQ(open(first), "accepted") << "the one unheard for longest is not";
}

TEST_F(Guard, ThreadsMayShareBothEnds) {
  constexpr int kThreads = 4, kEach = 800;  // together within the window
  std::atomic<int> accepted = 0, replayed = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < kThreads; ++t) {
      threads.emplace_back([&] {
        Octets octets;
        for (int i = 0; i < kEach; ++i) {
          sealer_.seal(text("payload"), octets);
          if (!opener_.open(octets).refused) ++accepted;
          if (opener_.open(octets).refused == Rejection::kReplayed) ++replayed;
        }
      });
    }
  }
  EXPECT_EQ(accepted, kThreads * kEach);
  EXPECT_EQ(replayed, kThreads * kEach);
}

class KeyFile : public ::testing::Test {
 protected:
  std::string write(const std::string& content, mode_t mode = 0600) {
    const std::string file = folder_.write("fleet.key", content).string();
    chmod(file.c_str(), mode);
    return file;
  }
  std::string error(const std::string& file) {
    return error_of<UserError>([&] { load_fleet_key(file, 7); });
  }

  test::TempFolder folder_;
};

TEST_F(KeyFile, IsTheSecretWithoutTheEndOfItsLine) {
  const std::string secret(kSecret);
  const FleetKey key = fleet_key(secret, 7);
  EXPECT_EQ(load_fleet_key(write(secret), 7), key);
  EXPECT_EQ(load_fleet_key(write(secret + "\n"), 7), key);
  EXPECT_EQ(load_fleet_key(write(secret, 0400), 7), key);
  EXPECT_NE(load_fleet_key(write(secret + "\n\n"), 7), key);
  EXPECT_NE(load_fleet_key(write(secret), 8), key) << "domains differ";
}

TEST_F(KeyFile, HasSixteenTo4096Bytes) {
  EXPECT_EQ(error(write(std::string(16, 'x'))), "");
  EXPECT_EQ(error(write(std::string(4096, 'x').append("\n"))), "");
  EXPECT_THAT(error(write("")), HasSubstr("fleet.key' holds less than 16 bytes"));
  EXPECT_THAT(error(write(std::string(15, 'x').append("\n"))), HasSubstr("holds less than 16 bytes"));
  EXPECT_THAT(error(write(std::string(4097, 'x'))), HasSubstr("fleet.key' holds more than 4096 bytes"));
  EXPECT_THAT(error(write(std::string(9000, 'x'))), HasSubstr("holds more than 4096 bytes"));
}

TEST_F(KeyFile, IsForItsOwnerOnly) {
  for (const mode_t mode : {0640, 0604, 0620, 0644, 0601}) {
    EXPECT_THAT(error(write(std::string(kSecret), mode)),
                HasSubstr("fleet.key' is open to others than its owner: chmod 600 it"));
  }
}

TEST_F(KeyFile, MustBeAFile) {
  EXPECT_EQ(error("/nowhere/fleet.key"), "key file '/nowhere/fleet.key' cannot be opened: No such file or directory");
  EXPECT_THAT(error(folder_.path().string()), HasSubstr("' cannot be read: it is not a file"));
}

}  // namespace
}  // namespace coslam::guard_test
