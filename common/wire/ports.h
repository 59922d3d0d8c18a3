// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The UDP ports of a DDS domain, as the standard of DDS gives them.
namespace coslam {

// Multicast group in which all participants listen for announcements.
constexpr const char* kMulticastGroup = "239.255.0.1";
constexpr int kMostDomain = 232;  // the ports of higher ones would be above 65535
// Participants of one domain on one host: what callers on the loopback device reach.
constexpr int kMostPerHost = 32;

constexpr int multicast_port(int domain) { return 7400 + 250 * domain; }
// Port of the participant with that number on its host: for announcements, and one higher for samples.
constexpr int unicast_port(int domain, int participant) { return multicast_port(domain) + 10 + 2 * participant; }
constexpr int last_port(int domain) { return multicast_port(domain + 1) - 1; }

}  // namespace coslam
