// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/wire/middleware.h"

// Internal header of this folder: it includes much of the middleware.
namespace coslam {

// A transport for participants of the loopback device alone. Others of this machine that name its other addresses, as
// all do by default, are reached at 127.0.0.1: `carrier` takes them for hosts that it cannot reach. What other hosts
// send is not read: a group that somebody on this machine has joined on a network is heard on the loopback device too.
std::shared_ptr<rtps::TransportDescriptorInterface> own_host_transport(
    std::shared_ptr<rtps::TransportDescriptorInterface> carrier);

}  // namespace coslam
