// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/outbox.h"

#include <gtest/gtest.h>

namespace coslam::outbox_test {
namespace {

ChannelPtr channel(const std::string& topic, std::size_t keep = 0) {
  Channel c;
  c.topic = topic;
  c.keep = keep;
  return std::make_shared<const Channel>(c);
}

MessagePtr message(const ChannelPtr& of, TimeNs t_ns, std::size_t bytes = 10) {
  return std::make_shared<const PublicMessage>(PublicMessage{of, t_ns, std::vector<std::uint8_t>(bytes)});
}

std::vector<TimeNs> times(Outbox& box) {
  std::vector<TimeNs> out;
  while (const auto item = box.take()) out.push_back(item->body ? item->body->t_ns : -1);
  return out;
}

TEST(Outbox, TextsGoFirstThenTheTimeThenMessagesInOrder) {
  Outbox box;
  const auto tf = channel("/tf");
  box.put_message(3, message(tf, 5));
  box.put_time(4);
  box.put_time(5);
  EXPECT_TRUE(box.put_text("hello"));
  const auto text = box.take();
  EXPECT_EQ(text->head, "hello");
  EXPECT_FALSE(text->binary);
  const auto time = box.take();
  EXPECT_EQ(time->head, foxglove::time_message(5)) << "the newest alone";
  const auto data = box.take();
  EXPECT_EQ(data->head, foxglove::message_head(3, 5));
  EXPECT_EQ(data->body->octets.size(), 10U);
  EXPECT_FALSE(box.take());
  EXPECT_EQ(box.bytes(), 0U);
}

TEST(Outbox, OfAChannelTheOldestGo) {
  Outbox box;
  const auto fast = channel("/fast"), slow = channel("/slow");
  box.put_message(1, message(slow, 1));
  for (int i = 0; i < 100; ++i) box.put_message(2, message(fast, 100 + i));
  EXPECT_EQ(box.dropped(), 100 - Outbox::kMostOfChannel);
  const auto left = times(box);
  EXPECT_EQ(left.size(), Outbox::kMostOfChannel + 1);
  EXPECT_EQ(left.front(), 1) << "the other channel loses nothing";
  EXPECT_EQ(left.back(), 199);
}

TEST(Outbox, OfWhatIsBigOnlyTheNewestWaits) {
  Outbox box;
  const auto cloud = channel("/points");
  for (int i = 0; i < 5; ++i) box.put_message(1, message(cloud, i, Outbox::kBig + 1));
  EXPECT_EQ(times(box), std::vector<TimeNs>{4});
}

TEST(Outbox, WhatIsKeptForThoseWhoComeLaterFits) {
  Outbox box;
  const auto events = channel("/events", 200);
  for (int i = 0; i < 250; ++i) box.put_message(1, message(events, i));
  EXPECT_EQ(times(box).size(), 200U);
}

TEST(Outbox, ItsBytesAreBounded) {
  Outbox box;
  for (int i = 0; i < 40; ++i) box.put_message(1, message(channel("/" + std::to_string(i)), i, 1 << 20));
  EXPECT_LE(box.bytes(), Outbox::kMostBytes);
  EXPECT_EQ(times(box).back(), 39);
  box.put_message(1, message(channel("/huge"), 1, 2 * Outbox::kMostBytes));
  EXPECT_EQ(times(box).size(), 1U) << "one message may be larger than all that";
}

TEST(Outbox, WhoeverAsksForMoreAnswersThanItReadsIsTold) {
  Outbox box;
  for (std::size_t i = 0; i < Outbox::kMostTexts; ++i) EXPECT_TRUE(box.put_text("answer"));
  EXPECT_FALSE(box.put_text("answer"));
}

}  // namespace
}  // namespace coslam::outbox_test
