// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml_value.h"

#include <algorithm>
#include <fstream>
#include <set>

#include "common/base/error.h"
#include "common/base/file_kind.h"
#include "common/base/text.h"

namespace coslam {
namespace {

std::string shortest(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", v);
  return text;
}

}  // namespace

YamlValue YamlValue::load(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) {
    throw UserError(file.string() + ": cannot be read" + why_unreadable(file));
  }
  return parse(stream, file);
}

YamlValue YamlValue::parse(std::istream& text, const std::filesystem::path& file) {
  try {
    YamlValue root(YAML::Load(text), std::make_shared<const std::filesystem::path>(file), "");
    if (!root.is_map()) root.fail("a YAML map (key: value) is expected" + but_it_is(file));
    return root;
  } catch (const YAML::Exception& e) {
    throw UserError(file.string() + ":" + std::to_string(e.mark.line + 1) +
                    ": not valid YAML: " + e.msg.substr(0, e.msg.find('\0')) +  // up to an octet 0 in what is no text
                    but_it_is(file));
  }
}

void YamlValue::fail(const std::string& reason) const {
  std::string place = file_->string();
  const YAML::Mark mark = node_.Mark();
  if (!mark.is_null()) place += ":" + std::to_string(mark.line + 1);
  throw UserError(place + ": " + (path_.empty() ? "" : path_ + ": ") + reason);
}

void YamlValue::require_map() const {
  if (!is_map()) fail("a section (key: value) is expected");
}

std::optional<YamlValue> YamlValue::find(const std::string& key) const {
  require_map();
  const YAML::Node node = node_[key];
  if (!node.IsDefined() || node.IsNull()) return std::nullopt;
  return child(node, path_.empty() ? key : "." + key);
}

YamlValue YamlValue::at(const std::string& key) const {
  auto value = find(key);
  if (!value) fail("the key '" + key + "' is missing");
  return *value;
}

std::vector<std::string> YamlValue::keys() const {
  require_map();
  std::vector<std::string> names;
  for (const auto& entry : node_) names.push_back(entry.first.IsScalar() ? entry.first.Scalar() : "?");
  return names;
}

void YamlValue::allow_only(const std::vector<std::string>& known) const {
  allow_only(known, [&](const std::string& key) { return unknown_key_reason(key, known); });
}

void YamlValue::allow_only(const std::vector<std::string>& known, const ReasonOf& unknown) const {
  require_map();
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
    const YamlValue place = child(entry.first, path_.empty() ? key : "." + key);
    if (std::find(known.begin(), known.end(), key) == known.end())
      place.fail(unknown(key) + (path_.empty() ? but_it_is(*file_) : ""));
    if (!seen.insert(key).second) place.fail("the key stands twice");
  }
}

std::vector<YamlValue> YamlValue::items() const {
  if (!is_sequence()) fail("a list is expected");
  std::vector<YamlValue> values;
  for (std::size_t i = 0; i < node_.size(); ++i) values.push_back(child(node_[i], "[" + std::to_string(i) + "]"));
  return values;
}

const std::string& YamlValue::scalar(const char* wanted) const {
  if (!is_scalar()) fail(std::string(wanted) + " is expected");
  return node_.Scalar();
}

double YamlValue::number() const {
  std::string_view digits = scalar("a number");
  if (digits.starts_with('+')) digits.remove_prefix(1);
  // "1." and ".5" are YAML numbers; from_chars takes both.
  const auto value = parse_double(digits);
  if (!value) fail("'" + node_.Scalar() + "' is not a number");
  return *value;
}

double YamlValue::number(double min, double max) const {
  const double value = number();
  if (value < min || value > max) {
    fail("'" + node_.Scalar() + "' is outside " + shortest(min) + " to " + shortest(max));
  }
  return value;
}

std::int64_t YamlValue::integer() const {
  const auto value = parse_integer(scalar("a whole number"));
  if (!value) fail("'" + node_.Scalar() + "' is not a whole number");
  return *value;
}

bool YamlValue::boolean() const {
  const std::string& word = scalar("true or false");
  if (word == "true" || word == "yes" || word == "on") return true;
  if (word == "false" || word == "no" || word == "off") return false;
  fail("'" + word + "' is neither true nor false");
}

std::string YamlValue::text() const { return scalar("a text"); }

std::vector<double> YamlValue::numbers() const {
  std::vector<double> values;
  for (const YamlValue& item : items()) values.push_back(item.number());
  return values;
}

std::string unknown_key_reason(std::string_view key, const std::vector<std::string>& known) {
  const std::string nearest = nearest_of(key, known);
  if (!nearest.empty()) return "unknown key, did you mean '" + nearest + "'?";
  std::string reason = "unknown key, known are";
  for (const std::string& k : known) reason += " " + k;
  return reason;
}

}  // namespace coslam
