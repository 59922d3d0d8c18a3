// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/config.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <sstream>

#include "common/base/check.h"
#include "common/base/error.h"
#include "common/base/text.h"
#include "common/config/unknown_key.h"
#include "common/config/yaml_value.h"

namespace coslam::config {
namespace {

// A number as short as it can be read back exactly.
std::string short_number(double v) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, v, std::chars_format::general);
  return {text, end};
}

std::string range_text(const Bounds<double>& bounds) {
  return short_number(bounds.min) + " to " + short_number(bounds.max);
}

std::string whole_range_text(const Bounds<double>& bounds) {
  return std::to_string(std::llround(bounds.min)) + " to " + std::to_string(std::llround(bounds.max));
}

std::string list_text(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

// In double quotes, so that no text is taken for a number, a list or a comment.
std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') result += '\\';
    if (code < 0x20 || code == 0x7f) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\x%02X", code);
      result += escaped;
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string yaml_text(int v) { return std::to_string(v); }
std::string yaml_text(double v) { return short_number(v); }
std::string yaml_text(bool v) { return v ? "true" : "false"; }
std::string yaml_text(const std::string& v) { return in_quotes(v); }
std::string yaml_text(const std::vector<std::string>& v) {
  std::string text;
  for (const std::string& word : v) text += (text.empty() ? "" : ", ") + in_quotes(word);
  return "[" + text + "]";
}

// Dotted, down to the first thing that is no section.
std::string first_key_below(const YamlValue& section) {
  if (!section.is_map() || section.keys().empty()) return "";
  const std::string key = section.keys().front();
  const auto value = section.find(key);
  const std::string below = value ? first_key_below(*value) : "";
  return below.empty() ? key : key + "." + below;
}

// First step of a dotted path.
std::string_view head_of(std::string_view path) { return path.substr(0, path.find('.')); }

std::optional<bool> parse_bool(std::string_view text) {
  if (text == "true" || text == "yes" || text == "on") return true;
  if (text == "false" || text == "no" || text == "off") return false;
  return std::nullopt;
}

std::vector<std::string> parse_words(std::string_view text) {
  std::vector<std::string> words;
  for (const std::string_view word : split_fields(text, ",")) words.emplace_back(trimmed(word));
  return words;
}

}  // namespace

void Fields::field(const std::string& name, int& value, Bounds<int> bounds, const std::string& comment) {
  COSLAM_CHECK(value >= bounds.min && value <= bounds.max, "a configured value is outside its bounds");
  add({prefix_ + name, &value, {static_cast<double>(bounds.min), static_cast<double>(bounds.max)}, {}, comment});
}

void Fields::field(const std::string& name, double& value, Bounds<double> bounds, const std::string& comment) {
  COSLAM_CHECK(value >= bounds.min && value <= bounds.max, "a configured value is outside its bounds");
  add({prefix_ + name, &value, bounds, {}, comment});
}

void Fields::field(const std::string& name, bool& value, const std::string& comment) {
  add({prefix_ + name, &value, {0, 0}, {}, comment});
}

void Fields::field(const std::string& name, std::string& value, const std::string& comment) {
  add({prefix_ + name, &value, {0, 0}, {}, comment});
}

void Fields::field(const std::string& name, std::string& value, const Words& allowed, const std::string& comment) {
  COSLAM_CHECK(std::find(allowed.begin(), allowed.end(), value) != allowed.end(), "a configured word is not allowed");
  add({prefix_ + name, &value, {0, 0}, allowed, comment});
}

void Fields::field(const std::string& name, Words& value, const std::string& comment) {
  add({prefix_ + name, &value, {0, 0}, {}, comment});
}

void Fields::field(const std::string& name, Words& value, ReadSection read, const std::string& comment) {
  add({prefix_ + name, &value, {0, 0}, {}, comment, read});
}

void Fields::add(Field field) {
  for (const Field& other : fields_) COSLAM_CHECK(other.path != field.path, "a configuration key is declared twice");
  fields_.push_back(std::move(field));
}

Fields::Words Fields::paths() const {
  Words paths;
  for (const Field& field : fields_) paths.push_back(field.path);
  return paths;
}

void Fields::load(const std::filesystem::path& file) const { read_section(YamlValue::load(file), ""); }

void Fields::load_text(const std::string& text, const std::filesystem::path& file) const {
  std::istringstream stream(text);
  read_section(YamlValue::parse(stream, file), "");
}

void Fields::read_section(const YamlValue& section, const std::string& prefix) const {
  Words known;
  for (const Field& field : fields_) {
    if (!field.path.starts_with(prefix)) continue;
    const std::string key(head_of(std::string_view(field.path).substr(prefix.size())));
    if (known.empty() || known.back() != key) known.push_back(key);
  }
  section.allow_only(known, [&](const std::string& key) {
    const auto value = section.find(key);
    return unknown_file_key_reason(prefix, key, value ? first_key_below(*value) : "", paths());
  });
  for (const std::string& key : known) {
    const auto value = section.find(key);
    if (!value) continue;
    const auto leaf =
        std::find_if(fields_.begin(), fields_.end(), [&](const Field& f) { return f.path == prefix + key; });
    if (leaf == fields_.end()) {
      read_section(*value, prefix + key + ".");
    } else {
      read_value(*leaf, *value);
    }
  }
}

void Fields::read_value(const Field& field, const YamlValue& value) {
  if (auto* const* words = std::get_if<Words*>(&field.value)) {
    (*words)->clear();
    for (const YamlValue& item : value.items()) {
      const bool section = item.is_map() && field.read_section != nullptr;
      const Words read = section ? field.read_section(item) : Words{item.text()};
      (*words)->insert((*words)->end(), read.begin(), read.end());
    }
    return;
  }
  const std::string problem = problem_of_text(field, value.text());
  if (!problem.empty()) value.fail(problem);
}

// Sets the field to the value that the text says; else tells what is wrong with it.
std::string Fields::problem_of_text(const Field& field, std::string_view text) {
  const std::string quoted = "'" + std::string(text) + "'";
  const auto in_bounds = [&](double v) { return v >= field.bounds.min && v <= field.bounds.max; };
  if (auto* const* number = std::get_if<int*>(&field.value)) {
    const auto parsed = parse_integer(text);
    if (!parsed) return quoted + " is not a whole number";
    if (!in_bounds(static_cast<double>(*parsed))) return quoted + " is outside " + whole_range_text(field.bounds);
    **number = static_cast<int>(*parsed);
  } else if (auto* const* real = std::get_if<double*>(&field.value)) {
    const auto parsed = parse_double(text);
    if (!parsed) return quoted + " is not a number";
    if (!in_bounds(*parsed)) return quoted + " is outside " + range_text(field.bounds);
    **real = *parsed;
  } else if (auto* const* flag = std::get_if<bool*>(&field.value)) {
    const auto parsed = parse_bool(text);
    if (!parsed) return quoted + " is neither true nor false";
    **flag = *parsed;
  } else if (auto* const* word = std::get_if<std::string*>(&field.value)) {
    const bool allowed =
        field.allowed.empty() || std::find(field.allowed.begin(), field.allowed.end(), text) != field.allowed.end();
    if (!allowed) return quoted + " is none of " + list_text(field.allowed);
    **word = text;
  } else if (auto* const* words = std::get_if<Words*>(&field.value)) {
    if (!trimmed(text).starts_with('[')) {
      **words = parse_words(text);
      return "";
    }
    std::istringstream file("list: " + std::string(text));
    try {
      read_value(field, YamlValue::parse(file, "").at("list"));
    } catch (const UserError&) {
      return quoted + " is not a list, as a,b or [a, b]";
    }
  }
  return "";
}

void Fields::apply_set(std::string_view assignment) const {
  const std::string shown = "--set " + std::string(assignment) + ": ";
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos) throw UsageError(shown + "key=value is expected");
  const std::string_view key = trimmed(assignment.substr(0, equals));
  for (const Field& field : fields_) {
    if (field.path != key) continue;
    const std::string problem = problem_of_text(field, trimmed(assignment.substr(equals + 1)));
    if (!problem.empty()) throw UsageError(shown + problem);
    return;
  }
  throw UsageError(shown + unknown_set_reason(std::string(key), paths()));
}

nlohmann::ordered_json Fields::json() const {
  nlohmann::ordered_json root = nlohmann::ordered_json::object();
  for (const Field& field : fields_) {
    nlohmann::ordered_json* place = &root;
    std::string_view rest = field.path;
    for (std::size_t dot = rest.find('.'); dot != std::string_view::npos; dot = rest.find('.')) {
      place = &(*place)[std::string(rest.substr(0, dot))];
      rest.remove_prefix(dot + 1);
    }
    std::visit([&](const auto* value) { (*place)[std::string(rest)] = *value; }, field.value);
  }
  return root;
}

std::string Fields::yaml() const {
  std::string text, section;
  for (const Field& field : fields_) {
    const std::size_t dot = field.path.rfind('.');
    const std::string parent = dot == std::string::npos ? "" : field.path.substr(0, dot);
    const auto steps = split_fields(parent, "."), open = split_fields(section, ".");
    std::size_t shared = 0;
    while (shared < steps.size() && shared < open.size() && steps[shared] == open[shared]) ++shared;
    for (std::size_t i = shared; i < steps.size(); ++i) text += std::string(2 * i, ' ') + std::string(steps[i]) + ":\n";
    section = parent;

    const std::string value = std::visit([](const auto* v) { return yaml_text(*v); }, field.value);
    text +=
        std::string(2 * steps.size(), ' ') + field.path.substr(dot == std::string::npos ? 0 : dot + 1) + ": " + value;
    text += "  #";
    if (!field.comment.empty()) text += " " + field.comment;
    if (std::holds_alternative<int*>(field.value)) text += " (" + whole_range_text(field.bounds) + ")";
    if (std::holds_alternative<double*>(field.value)) text += " (" + range_text(field.bounds) + ")";
    if (!field.allowed.empty()) text += " (" + list_text(field.allowed) + ")";
    text += "\n";
  }
  return text;
}

}  // namespace coslam::config
