// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/image_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <compare>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "common/base/error.h"
#include "common/base/text.h"

namespace coslam {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_image(const fs::path& file) {
  constexpr std::array<std::string_view, 7> kImages = {".png", ".jpg", ".jpeg", ".pgm", ".bmp", ".tif", ".tiff"};
  return std::ranges::find(kImages, lower(file.extension().string())) != kImages.end();
}

// A name between its numbers: texts[0] numbers[0] texts[1] numbers[1] ... texts.back().
struct Name {
  std::vector<std::string> texts, numbers;
  bool negative = false;  // it is one number below 0, whose sign is no text
};

Name parts_of(const fs::path& file) {
  const std::string stem = file.stem().string();
  Name name{{""}, {}};
  for (std::size_t i = 0; i < stem.size(); ++i) {
    if (!is_digit(stem[i])) {
      name.texts.back() += stem[i];
      continue;
    }
    if (i == 0 || !is_digit(stem[i - 1])) {
      name.numbers.emplace_back();
      name.texts.emplace_back();
    }
    name.numbers.back() += stem[i];
  }
  name.negative = name.numbers.size() == 1 && name.texts.front() == "-" && name.texts.back().empty();
  if (name.negative) name.texts.front().clear();
  return name;
}

std::strong_ordering by_value(std::string_view a, std::string_view b) {
  a.remove_prefix(std::min(a.find_first_not_of('0'), a.size()));
  b.remove_prefix(std::min(b.find_first_not_of('0'), b.size()));
  return a.size() != b.size() ? a.size() <=> b.size() : a <=> b;
}

// Text by text and number by number, after the negative numbers.
std::strong_ordering in_order(const Name& a, const Name& b) {
  if (a.negative != b.negative) return b.negative <=> a.negative;
  if (a.negative) return by_value(b.numbers.front(), a.numbers.front());
  for (std::size_t i = 0; i < std::min(a.texts.size(), b.texts.size()); ++i) {
    if (a.texts[i] != b.texts[i]) return a.texts[i] <=> b.texts[i];
    if (i >= a.numbers.size() || i >= b.numbers.size()) break;
    if (const auto order = by_value(a.numbers[i], b.numbers[i]); order != 0) return order;
  }
  return a.texts.size() <=> b.texts.size();
}

// What names of one camera have in common: `left_#`. A single digit behind a letter, before `_` or `-` and a further
// number, tells cameras apart: `cam0_#`.
std::string family_of(const Name& name) {
  std::string family = name.texts.front();
  for (std::size_t i = 0; i < name.numbers.size(); ++i) {
    const std::string& before = name.texts[i];
    const std::string& after = name.texts[i + 1];
    const bool of_camera = name.numbers[i].size() == 1 && i + 1 < name.numbers.size() &&
                           (after.starts_with('_') || after.starts_with('-')) && !before.empty() &&
                           std::isalpha(static_cast<unsigned char>(before.back()));
    family += (of_camera ? name.numbers[i] : "#") + after;
  }
  return family;
}

using Families = std::map<std::string, std::vector<fs::path>>;

Families families_of(const std::vector<fs::path>& files) {
  std::set<std::string> stems;
  for (const fs::path& file : files) stems.insert(file.stem().string());
  Families families;
  for (const fs::path& file : files) {
    // The same name twice is two kinds of images.
    const std::string kind = stems.size() < files.size() ? file.extension().string() : "";
    families[family_of(parts_of(file)) + kind].push_back(file);
  }
  return families;
}

std::set<fs::path> depth_in(const Families& families) {
  std::set<fs::path> depth;
  for (const auto& [family, images] : families) {
    if (lower(family).find("depth") != std::string::npos) depth.insert(images.begin(), images.end());
  }
  return depth;
}

// `left_ (80)`.
std::string count_of(std::string family, std::size_t images) {
  std::erase(family, '#');
  return family + " (" + std::to_string(images) + ")";
}

// The form in which a time is written.
enum class Form : std::uint8_t { kNone, kWhole, kSeconds, kShort, kDate };

struct Found {
  Form form = Form::kNone;
  std::string text;  // as parse_written_time() reads it
};

using Numbers = std::span<const std::string>;

// A date by its numbers: 2014 06 24 19 35 18 050000, or 20140624 193518050, or 20140624 193518 050.
Found date_of(Numbers numbers) {
  constexpr std::size_t kToSeconds = 14;  // digits
  const auto of_two = [](const std::string& n) { return n.size() == 2; };
  const bool joined =
      (numbers.size() == 2 && numbers[1].size() >= 6) || (numbers.size() == 3 && numbers[1].size() == 6);
  const bool apart = (numbers.size() == 6 || numbers.size() == 7) && numbers[0].size() == 4 &&
                     std::ranges::all_of(numbers.subspan(1, 5), of_two);
  std::string digits;
  for (const std::string& number : numbers) digits += number;
  if (!(joined && numbers[0].size() == 8) && !apart) return {};
  const auto at = [&](std::size_t from) { return digits.substr(from, 2); };
  return {Form::kDate, digits.substr(0, 4) + "-" + at(4) + "-" + at(6) + " " + at(8) + ":" + at(10) + ":" + at(12) +
                           "." + digits.substr(kToSeconds)};
}

// Seconds and their fraction in two numbers, with this text between them.
Found seconds_of(Numbers numbers, const std::string& between, bool alone) {
  constexpr std::size_t kSince1970 = 9, kLong = 12;  // digits
  const std::string text = numbers[0] + "." + numbers[1];
  const bool dated = numbers[0].size() == kSince1970 || numbers[0].size() == kSince1970 + 1;
  if (between == ".") {
    if (dated || (alone && text.size() >= kLong)) return {Form::kSeconds, text};
    return alone ? Found{Form::kShort, text} : Found{};
  }
  const std::size_t digits = numbers[1].size();
  const bool fraction = digits == 3 || digits == 6 || digits == 9;
  return dated && fraction && (between == "_" || between == "-") ? Found{Form::kSeconds, text} : Found{};
}

// Whole seconds, milliseconds, ... since 1970; a name that is nothing else may be of any clock.
Found whole_of(const std::string& number, bool alone) {
  constexpr std::size_t kLong = 12;
  const std::size_t digits = number.size();
  const bool dated = number.front() == '1' && (digits == 13 || digits == 16 || digits == 19);
  return dated || (alone && digits >= kLong) ? Found{Form::kWhole, number} : Found{};
}

// A time in the numbers of a name from `first` on.
Found time_in(const Name& name, std::size_t first) {
  const Numbers numbers = Numbers(name.numbers).subspan(first);
  const bool alone = first == 0 && name.texts.front().empty() && name.texts.back().empty() && !name.negative;
  if (numbers.size() == 1) return whole_of(numbers[0], alone);
  const std::string& between = name.texts[first + 1];
  if (numbers.size() == 2 && between == ".") return seconds_of(numbers, between, alone);
  if (Found date = date_of(numbers); date.form != Form::kNone) return date;
  return numbers.size() == 2 ? seconds_of(numbers, between, alone) : Found{};
}

// Times of all names in their numbers from `first` on; none where one is no time, or of another form.
NamedTimes times_from(const std::vector<Name>& names, std::size_t first) {
  NamedTimes out;
  Form form = Form::kNone;
  bool whole = true;  // seconds without a fraction
  for (const Name& name : names) {
    const Found found = time_in(name, first);
    const auto time = found.form == Form::kNone ? std::nullopt : parse_written_time(found.text);
    if (!time || (!out.times.empty() && found.form != form)) return {};
    form = found.form;
    whole = whole && found.text.ends_with('.');
    out.times.push_back(*time);
  }
  out.unit = form == Form::kWhole ? TimeUnit::kNanoseconds : TimeUnit::kSeconds;
  out.vague = form == Form::kShort;
  out.coarse = whole;
  return out;
}

}  // namespace

std::vector<fs::path> images_in(const fs::path& folder) {
  std::vector<std::pair<Name, fs::path>> named;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const bool hidden = entry.path().filename().string().starts_with('.');
    if (!hidden && entry.is_regular_file() && is_image(entry.path())) {
      named.emplace_back(parts_of(entry.path()), entry.path());
    }
  }
  std::ranges::sort(named, [](const auto& a, const auto& b) {
    const auto order = in_order(a.first, b.first);
    return order != 0 ? order < 0 : a.second < b.second;
  });
  std::vector<fs::path> files;
  files.reserve(named.size());
  for (const auto& [name, file] : named) files.push_back(file);
  return files;
}

std::vector<fs::path> of_one_camera(const fs::path& folder, const std::vector<fs::path>& files,
                                    std::vector<std::string>* guesses) {
  Families families = families_of(files);
  std::vector<fs::path> kept = files;
  if (const std::set<fs::path> depth = depth_in(families); !depth.empty() && depth.size() * 2 <= files.size()) {
    guesses->push_back(folder.string() + ": " + std::to_string(depth.size()) + " images of depth are left out, as " +
                       depth.begin()->filename().string());
    std::erase_if(families, [&](const auto& f) { return depth.contains(f.second.front()); });
    std::erase_if(kept, [&](const fs::path& file) { return depth.contains(file); });
  }
  std::size_t most = 0;
  for (const auto& [family, images] : families) most = std::max(most, images.size());
  // A few others among many images, or names that have nothing in common, are no second camera.
  constexpr std::size_t kFew = 10;
  std::erase_if(families, [&](const auto& f) { return f.second.size() < 2 || f.second.size() * kFew < most; });
  if (families.size() < 2) return kept;
  std::string listed;
  for (const auto& [family, images] : families) {
    listed += (listed.empty() ? "" : ", ") + count_of(family, images.size());
  }
  throw UserError(folder.string() + ": images of " + std::to_string(families.size()) + " cameras? " + listed +
                  ": give each a folder or a list.csv");
}

std::vector<std::int64_t> numbers_of(const std::vector<fs::path>& files) {
  std::vector<Name> names;
  for (const fs::path& file : files) {
    names.push_back(parts_of(file));
    if (names.back().numbers.size() != names.front().numbers.size()) return {};
  }
  const auto differs = [&](std::size_t i) {
    return std::ranges::any_of(names, [&](const Name& n) { return n.numbers[i] != names.front().numbers[i]; });
  };
  std::optional<std::size_t> differing;
  for (std::size_t i = 0; !names.empty() && i < names.front().numbers.size(); ++i) {
    if (!differs(i)) continue;
    if (differing) return {};
    differing = i;
  }
  if (!differing) return {};
  std::vector<std::int64_t> numbers;
  for (const Name& name : names) {
    if (family_of(name) != family_of(names.front())) return {};
    const auto number = parse_integer((name.negative ? "-" : "") + name.numbers[*differing]);
    if (!number || (!numbers.empty() && *number <= numbers.back())) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

NamedTimes times_in_names(const std::vector<fs::path>& files) {
  std::vector<Name> names;
  for (const fs::path& file : files) {
    names.push_back(parts_of(file));
    if (names.back().numbers.size() != names.front().numbers.size()) return {};
  }
  for (std::size_t first = 0; !names.empty() && first < names.front().numbers.size(); ++first) {
    if (NamedTimes found = times_from(names, first); !found.times.empty()) return found;
  }
  return {};
}

}  // namespace coslam
