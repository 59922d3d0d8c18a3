// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/unknown_key.h"

#include <algorithm>
#include <utility>

#include "common/base/text.h"

namespace coslam::config {
namespace {

using Words = std::vector<std::string>;

bool contains(const Words& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string last_step(const std::string& path) { return path.substr(path.rfind('.') + 1); }

// What stands in a section ("" or with a dot at its end), in the order of declaration.
Words names_in(const std::string& section, const Words& known) {
  Words names;
  for (const std::string& path : known) {
    if (!path.starts_with(section)) continue;
    const std::string name = path.substr(section.size(), path.find('.', section.size()) - section.size());
    if (!contains(names, name)) names.push_back(name);
  }
  return names;
}

bool is_section(const std::string& path, const Words& known) { return !names_in(path + ".", known).empty(); }

// The longest known section that a path lies in.
std::string section_of(const std::string& path, const Words& known) {
  for (std::size_t dot = path.rfind('.'); dot != std::string::npos && dot > 0; dot = path.rfind('.', dot - 1)) {
    if (is_section(path.substr(0, dot), known)) return path.substr(0, dot + 1);
  }
  return "";
}

Words sections_in(const Words& known) {
  Words sections;
  for (const std::string& path : known) {
    for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1)) {
      if (!contains(sections, path.substr(0, dot))) sections.push_back(path.substr(0, dot));
    }
  }
  return sections;
}

// How far the sections of a path are among those of another, wherever they stand there: 2 for each, 1 if nearly so.
int shared_sections(const std::string& path, const std::string& other) {
  const Words steps = sections_in({path}), other_steps = sections_in({other});
  Words names;
  for (const std::string& section : other_steps) names.push_back(last_step(section));
  int shared = 0;
  for (const std::string& section : steps) {
    const std::string name = last_step(section);
    shared += contains(names, name) ? 2 : nearest_of(name, names).empty() ? 0 : 1;
  }
  return shared;
}

// Paths whose own name is the typed one, or nearly so, in whatever section: those that share most sections.
Words same_name_elsewhere(const std::string& typed, const Words& paths) {
  Words names;
  for (const std::string& path : paths) names.push_back(last_step(path));
  const std::string name = contains(names, last_step(typed)) ? last_step(typed) : nearest_of(last_step(typed), names);
  Words found;
  int most = 0;
  for (const std::string& path : paths) {
    if (name.empty() || last_step(path) != name) continue;
    const int shared = shared_sections(path, typed);
    if (shared > most) found.clear();
    most = std::max(most, shared);
    if (shared == most) found.push_back(path);
  }
  return found;
}

std::string either(const Words& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += (i == 0 ? "'" : i + 1 < words.size() ? ", '" : " or '") + words[i] + "'";
  }
  return text;
}

std::string what_there_is(const std::string& section, const Words& known) {
  std::string text;
  for (const std::string& name : names_in(section, known)) text += " " + name;
  return text;
}

std::string did_you_mean(const Words& keys) { return "unknown key, did you mean " + either(keys) + "?"; }

std::string known_are(const std::string& section, const Words& known) {
  const std::string in_section = section.empty() ? "" : " in " + section.substr(0, section.size() - 1);
  return "unknown key, known" + in_section + " are" + what_there_is(section, known);
}

}  // namespace

Words nearest_keys(const std::string& typed, const Words& known) {
  const std::string section = section_of(typed, known);
  const std::size_t end = typed.find('.', section.size());
  const std::string name = nearest_of(typed.substr(section.size(), end - section.size()), names_in(section, known));
  Words all = known;
  if (!name.empty()) {
    const std::string corrected = section + name + (end == std::string::npos ? "" : typed.substr(end));
    if (contains(known, corrected)) return {corrected};
    // `corrected` lies in a longer section now; what follows may be wrong too.
    if (section_of(corrected, known).size() > section.size()) {
      const Words found = nearest_keys(corrected, known);
      return found.empty() ? Words{section + name} : found;
    }
    if (is_section(corrected, known)) all.push_back(corrected);
  }
  constexpr std::size_t kMost = 3;
  Words found = same_name_elsewhere(typed, known);
  if (found.empty()) found = {nearest_of(typed, all)};
  if (found.front().empty()) found = same_name_elsewhere(typed, sections_in(known));
  if (found.size() > kMost) found.resize(kMost);
  return found;
}

std::string unknown_set_reason(const std::string& typed, const Words& known) {
  if (is_section(typed, known)) return "this is a section, its keys are" + what_there_is(typed + ".", known);
  const Words nearest = nearest_keys(typed, known);
  return nearest.empty() ? known_are(section_of(typed, known), known) : did_you_mean(nearest);
}

std::string unknown_file_key_reason(const std::string& section, const std::string& key, const std::string& below,
                                    const Words& known) {
  const std::string tail = below.empty() ? "" : "." + below;
  std::string dotted = section;
  dotted.append(key).append(tail);
  if (contains(known, dotted)) return "unknown key: in a file sections are nested, without dots";
  const Words names = names_in(section, known);
  Words nearest;
  for (const std::string& found : nearest_keys(dotted, known)) {
    const std::string head = found.ends_with(tail) ? found.substr(0, found.size() - tail.size()) : found;
    // Another name for this key, all else being right; or something that belongs elsewhere.
    const bool is_renamed_key = head.starts_with(section) && contains(names, head.substr(section.size())) &&
                                !nearest_of(key, {last_step(head)}).empty();
    nearest.push_back(is_renamed_key ? last_step(head) : found);
  }
  return nearest.empty() ? known_are(section, known) : did_you_mean(nearest);
}

}  // namespace coslam::config
