// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Small images on request.
#include <vector>

#include "common/base/check.h"
#include "common/wire/checks.h"

namespace coslam {
namespace {

static_assert(kMostThumbnailBytes == idl::MAX_THUMBNAIL_BYTES);

// A browser is to get a JPEG image and nothing else.
Problem check_jpeg(const std::vector<std::uint8_t>& octets) {
  if (octets.empty()) return std::nullopt;
  if (const Problem p = check_count(octets.size(), kMostThumbnailBytes)) return p;
  const bool begins = octets.size() >= 4 && octets[0] == 0xFF && octets[1] == 0xD8;  // start of image
  const bool ends = begins && octets[octets.size() - 2] == 0xFF && octets.back() == 0xD9;
  return ends ? std::nullopt : Problem(Rejection::kOutOfRange);
}

}  // namespace

idl::ThumbnailRequest encode(const ThumbnailRequest& r) {
  idl::ThumbnailRequest m;
  m.agent_run(r.agent_run.value);
  m.server_run(r.server_run.value);
  m.agent(r.agent);
  return m;
}

Decoded<ThumbnailRequest> decode(const idl::ThumbnailRequest& m) {
  ThumbnailRequest r{m.agent().to_string(), RunId(m.agent_run()), RunId(m.server_run())};
  if (const Problem p = first_of({check_sender(r.agent, r.agent_run), check_id(r.server_run)})) return *p;
  return r;
}

idl::Thumbnail encode(const Thumbnail& t) {
  COSLAM_CHECK(t.jpeg.size() <= kMostThumbnailBytes, "a thumbnail is too large");
  idl::Thumbnail m;
  m.agent_run(t.agent_run.value);
  m.capture_ns(t.capture_ns);
  m.agent(t.agent);
  m.jpeg(t.jpeg);
  return m;
}

Decoded<Thumbnail> decode(const idl::Thumbnail& m) {
  Thumbnail t{m.agent().to_string(), RunId(m.agent_run()), m.capture_ns(), m.jpeg()};
  if (const Problem p = first_of({check_sender(t.agent, t.agent_run), check_jpeg(t.jpeg)})) return *p;
  return t;
}

}  // namespace coslam
