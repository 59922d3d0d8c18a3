// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

// Configuration as plain structs. A folder declares each of its fields once, next to the struct, and needs nothing of
// this header for it:
//
//   struct TrackerConfig { int max_tracks = 300; };
//   template <class V>
//   void describe(V& v, TrackerConfig& c) {
//     v.field("max_tracks", c.max_tracks, {20, 4000}, "features followed at once");
//   }
//
// The default is the member's initialiser; a struct within a struct is v.section("tracker", c.tracker). That one
// declaration serves the file, --set, the dump and the error texts. Precedence is the order of the calls: defaults,
// load(), apply_set().
namespace coslam {
class YamlValue;
}

namespace coslam::config {

template <class T>
struct Bounds {
  T min;
  T max;  // both included
};

// The visitor that describe() fills: all fields of one configuration, in the order of declaration.
class Fields {
 public:
  using Words = std::vector<std::string>;

  void field(const std::string& name, int& value, Bounds<int> bounds, const std::string& comment);
  void field(const std::string& name, double& value, Bounds<double> bounds, const std::string& comment);
  void field(const std::string& name, bool& value, const std::string& comment);
  void field(const std::string& name, std::string& value, const std::string& comment);
  void field(const std::string& name, std::string& value, const Words& allowed, const std::string& comment);
  void field(const std::string& name, Words& value, const std::string& comment);
  // Converts an item that is a section of a YAML file into texts.
  using ReadSection = Words (*)(const YamlValue& section);
  void field(const std::string& name, Words& value, ReadSection read, const std::string& comment);

  template <class Section>
  void section(const std::string& name, Section& section) {
    const std::string outer = prefix_;
    prefix_ += name + ".";
    describe(*this, section);
    prefix_ = outer;
  }

  void load(const std::filesystem::path& file) const;
  void load_text(const std::string& text, const std::filesystem::path& file) const;
  void apply_set(std::string_view assignment) const;
  nlohmann::ordered_json json() const;
  std::string yaml() const;

 private:
  struct Field {
    std::string path;  // dotted, from the root
    std::variant<int*, double*, bool*, std::string*, Words*> value;
    Bounds<double> bounds{0, 0};  // range of a number
    Words allowed;                // texts that may be given; empty: any
    std::string comment;
    ReadSection read_section = nullptr;
  };

  void add(Field field);
  Words paths() const;
  void read_section(const YamlValue& section, const std::string& prefix) const;
  static void read_value(const Field& field, const YamlValue& value);
  static std::string problem_of_text(const Field& field, std::string_view text);

  std::vector<Field> fields_;
  std::string prefix_;
};

template <class Config>
Fields fields_of(Config& config) {
  Fields fields;
  describe(fields, config);
  return fields;
}

// Reads a YAML file over the values in `config`; keys that are absent keep theirs. Throws UserError naming file, line,
// key path and reason.
template <class Config>
void load(Config& config, const std::filesystem::path& file) {
  fields_of(config).load(file);
}

// Like load(), from a text; errors name `file` as its origin.
template <class Config>
void load_text(Config& config, const std::string& text, const std::filesystem::path& file) {
  fields_of(config).load_text(text, file);
}

// "agent.tracker.max_tracks=200", a list as "a,b" or as in a file, "[a, b]". Throws UsageError.
template <class Config>
void apply_set(Config& config, std::string_view assignment) {
  fields_of(config).apply_set(assignment);
}

// The effective configuration, nested as in the file.
template <class Config>
nlohmann::ordered_json dump_json(Config config) {
  return fields_of(config).json();
}

// The configuration as a YAML file that load() reads back to the same values: each key with its comment and its allowed
// values.
template <class Config>
std::string dump_yaml(Config config) {
  return fields_of(config).yaml();
}

}  // namespace coslam::config
