// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/target.h"

#include <gtest/gtest.h>

namespace coslam::target_test {
namespace {

TEST(Target, PathAndQuery) {
  const auto request = parse_target("/api/v1/explain?kind=point&id=4%2012&at=&flag#part");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->path, "/api/v1/explain");
  EXPECT_EQ(request->query.at("kind"), "point");
  EXPECT_EQ(request->query.at("id"), "4 12");
  EXPECT_EQ(request->query.at("at"), "");
  EXPECT_EQ(request->query.at("flag"), "");
  EXPECT_EQ(parse_target("/")->path, "/");
  EXPECT_EQ(parse_target("/assets/main.js")->path, "/assets/main.js");
  EXPECT_EQ(parse_target("/with%20blank")->path, "/with blank");
  EXPECT_EQ(parse_target("/folder/")->path, "/folder/");
}

TEST(Target, NothingClimbsOut) {
  for (const char* target : {"/..",
                             "/../etc/passwd",
                             "/a/../../b",
                             "/a/..",
                             "/./a",
                             "/%2e%2e/etc/passwd",
                             "/a/%2E%2E%2fb",
                             "/..%2f..%2fb",
                             "//etc/passwd",
                             "/a//b",
                             "/a\\..\\b",
                             "/a%5c..%5cb",
                             "",
                             "etc/passwd",
                             "http://elsewhere/",
                             "*",
                             "/a%00b",
                             "/a%0d%0ab",
                             "/a%",
                             "/a%4",
                             "/a%zz",
                             "/?a=%0a"}) {
    EXPECT_FALSE(parse_target(target)) << target;
  }
}

}  // namespace
}  // namespace coslam::target_test
