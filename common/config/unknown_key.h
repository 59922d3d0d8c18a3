// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

// Answers to an unknown configuration key. Keys are dotted paths from the root, "server.sync.deadline_s".
namespace coslam::config {

// The known keys that `typed` may have meant, best first, three at most: with the section's or the key's own name put
// right, else with the same name in another section, else those written nearly so as a whole. Empty when none is near.
std::vector<std::string> nearest_keys(const std::string& typed, const std::vector<std::string>& known);

// Reason for --set: "unknown key, did you mean 'x'?", that it is a section, or what the section has.
std::string unknown_set_reason(const std::string& typed, const std::vector<std::string>& known);

// Reason for a file: the key `key` of a section is wrong (`section` is "" or ends with a dot); `below` is the first key
// in it, when it is a section itself. A key of the same section is named alone, others from the root.
std::string unknown_file_key_reason(const std::string& section, const std::string& key, const std::string& below,
                                    const std::vector<std::string>& known);

}  // namespace coslam::config
