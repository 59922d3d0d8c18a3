// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "server/show/web/target.h"

namespace coslam {

struct WebAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string encoding;               // value of Content-Encoding; empty: plain
  std::string_view body;              // view of data that `owner` keeps
  std::shared_ptr<const void> owner;  // null: it lasts as long as the program
};

inline WebAnswer answer_of(std::string text, std::string type, int status = 200) {
  auto owner = std::make_shared<const std::string>(std::move(text));
  return {status, std::move(type), "", *owner, owner};
}
// A sentence.
inline WebAnswer plain_answer(int status, std::string text) {
  return answer_of(std::move(text) + "\n", "text/plain; charset=utf-8", status);
}

// Called once, from any thread.
using WebReply = std::function<void(WebAnswer)>;
// Called in the web server's thread: it must not wait, but may reply later.
using WebApi = std::function<void(const WebRequest&, WebReply)>;

// A file of the page; 404 when there is none.
WebAnswer page_answer(std::string_view path);

}  // namespace coslam
