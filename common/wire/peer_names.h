// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace coslam {

// The addresses of a peer as in WireConfig, which may be a name. Throws UserError.
std::vector<std::string> addresses_of_peer(const std::string& peer);

// Peers whose names the system knows no address of now: a machine that just started has no name service yet. Throws
// UserError of what is no peer at all.
std::vector<std::string> unknown_peers(const std::vector<std::string>& peers);

// Waits until all peers have addresses, as long as wait() is true, which takes a moment each time; then leaves out
// those without, with a warning: where multicast passes, all find each other without them.
void await_names(
    std::vector<std::string>* peers, const std::function<bool()>& wait,
    const std::function<std::vector<std::string>(const std::vector<std::string>&)>& unknown = unknown_peers);

// The wait of a program that starts: ten seconds at most, or until it is to stop.
std::function<bool()> while_starting(std::function<bool()> stops);

}  // namespace coslam
