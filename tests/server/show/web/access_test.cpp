// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/access.h"

#include <gtest/gtest.h>

namespace coslam::access_test {
namespace {

TEST(Access, WithATokenWhoeverKnowsItMayRead) {
  const Access access("secret", {});
  EXPECT_TRUE(access.granted({.host = "robot:8765", .token = "secret"}));
  EXPECT_TRUE(access.granted({.host = "robot", .origin = "https://anywhere.org", .authorization = "Bearer secret"}));
  for (const char* wrong : {"", "s", "secreT", "secretsecret", "secret "})
    EXPECT_FALSE(access.granted({.host = "127.0.0.1", .token = wrong})) << wrong;
  EXPECT_FALSE(access.granted({.authorization = "Bearer "}));
  EXPECT_FALSE(access.granted({.authorization = "Basic secret"}));
  EXPECT_FALSE(access.granted({.authorization = "Bearer wrong", .token = "secret"})) << "the header goes before";
}

TEST(Access, WithoutOneOnlyThisHostAndItsPages) {
  const Access access("", {"https://app.foxglove.dev"});
  EXPECT_TRUE(access.granted({.host = "127.0.0.1:8765"}));
  EXPECT_TRUE(access.granted({.host = "localhost"}));
  EXPECT_TRUE(access.granted({.host = "[::1]:8765"}));
  EXPECT_TRUE(access.granted({.host = "localhost:1", .origin = "http://localhost:8080"}));
  EXPECT_TRUE(access.granted({.host = "localhost:1", .origin = "https://app.foxglove.dev"}));
  EXPECT_TRUE(access.granted({})) << "programs need not say it";
  EXPECT_FALSE(access.granted({.host = "127.0.0.1:8765", .origin = "https://elsewhere.org"}));
  EXPECT_FALSE(access.granted({.host = "127.0.0.1:8765", .origin = "https://localhost.elsewhere.org"}));
  EXPECT_FALSE(access.granted({.host = "127.0.0.1:8765", .origin = "null"}));
  EXPECT_FALSE(access.granted({.host = "elsewhere.org:8765"})) << "a name that was made to mean this host";
}

TEST(Access, TokensAreDrawn) {
  EXPECT_EQ(draw_token().size(), 32U);
  EXPECT_NE(draw_token(), draw_token());
}

}  // namespace
}  // namespace coslam::access_test
