// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace coslam {

// A value in a YAML file together with the place that an error names: every reader throws UserError
// "FILE:LINE: KEY.PATH: reason".
class YamlValue {
 public:
  // Reads the file; its top level must be a map.
  static YamlValue load(const std::filesystem::path& file);
  // Parses a text; errors name `file` as its origin.
  static YamlValue parse(std::istream& text, const std::filesystem::path& file);

  bool is_map() const { return node_.IsMap(); }
  bool is_sequence() const { return node_.IsSequence(); }
  bool is_scalar() const { return node_.IsScalar(); }

  // Whether a map has the key. A key without a value counts as absent.
  bool has(const std::string& key) const { return find(key).has_value(); }
  std::optional<YamlValue> find(const std::string& key) const;
  YamlValue at(const std::string& key) const;  // throws when missing
  std::vector<std::string> keys() const;
  // Throws for a key that is not among `known` (naming the nearest) and for one that stands twice.
  void allow_only(const std::vector<std::string>& known) const;
  // Like allow_only() above; `unknown` gives the reason in the error for an unknown key.
  using ReasonOf = std::function<std::string(const std::string& key)>;
  void allow_only(const std::vector<std::string>& known, const ReasonOf& unknown) const;

  std::vector<YamlValue> items() const;  // elements of a sequence

  double number() const;
  double number(double min, double max) const;  // bounds included
  std::int64_t integer() const;
  bool boolean() const;
  std::string text() const;
  std::vector<double> numbers() const;  // elements of a sequence of numbers

  const std::filesystem::path& file() const { return *file_; }
  const std::string& key_path() const { return path_; }
  [[noreturn]] void fail(const std::string& reason) const;

 private:
  YamlValue(const YAML::Node& node, std::shared_ptr<const std::filesystem::path> file, std::string path)
      : node_(node), file_(std::move(file)), path_(std::move(path)) {}
  YamlValue child(const YAML::Node& node, const std::string& step) const { return {node, file_, path_ + step}; }
  const std::string& scalar(const char* wanted) const;
  void require_map() const;

  YAML::Node node_;
  std::shared_ptr<const std::filesystem::path> file_;
  std::string path_;
};

// "unknown key, did you mean 'x'?" or, with nothing near, the list of known keys.
std::string unknown_key_reason(std::string_view key, const std::vector<std::string>& known);

}  // namespace coslam
