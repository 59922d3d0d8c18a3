// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/wire/echo.h"
#include "common/wire/middleware.h"
#include "common/wire/peer_paths.h"

// Internal header of this folder: it includes much of the middleware.
namespace coslam {

// A transport that sends each datagram once to a peer that has several addresses, by `paths`, which outlives it, and
// once where this host uses several `interfaces` (as in WireConfig). `carrier`, left alone, would send it from each
// interface to each address. Questions that echo.h speaks of are answered by `echo`, and not passed on.
std::shared_ptr<rtps::TransportDescriptorInterface> single_path_transport(
    std::shared_ptr<rtps::TransportDescriptorInterface> carrier, PeerPaths& paths,
    const std::vector<std::string>& interfaces, std::shared_ptr<EchoAnswerer> echo);

Ipv4Endpoint ipv4_endpoint(const rtps::Locator& locator);

}  // namespace coslam
