// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/image_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "agent/capture/image_name.h"
#include "common/base/error.h"
#include "common/base/text.h"
#include "common/base/words.h"

namespace coslam {
namespace {

namespace fs = std::filesystem;

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

// They count time and not images: their steps are about even, and those of a clock that counts since it was started.
bool count_time(const std::vector<std::int64_t>& numbers) {
  constexpr std::int64_t kMicroseconds = 4000;                                       // and more: 250 Hz
  constexpr std::int64_t kMilliseconds = 4, kFrom = 1'000'000, kTo = kFrom * kFrom;  // images are not counted so far
  constexpr double kEven = 0.15;
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < numbers.size(); ++i) steps.push_back(numbers[i] - numbers[i - 1]);
  if (steps.empty()) return false;
  std::ranges::sort(steps);
  const std::int64_t usual = steps[steps.size() / 2];
  const auto even = std::ranges::count_if(steps, [&](std::int64_t step) {
    return static_cast<double>(std::abs(step - usual)) <= kEven * static_cast<double>(usual);
  });
  const bool far = numbers.front() >= kFrom && numbers.front() < kTo;
  if ((usual >= kMicroseconds || (usual >= kMilliseconds && far)) && 2 * even > std::ssize(steps)) return true;
  // Counts go on by 1, or by a number of which all steps are multiples; a clock of a few milliseconds does not.
  constexpr std::int64_t kLeastUsual = 15, kLeastSteps = 8;
  const std::int64_t common =
      std::accumulate(steps.begin(), steps.end(), std::int64_t{0}, std::gcd<std::int64_t, std::int64_t>);
  return usual >= kLeastUsual && std::ssize(steps) >= kLeastSteps && common == 1 && 10 * even >= 8 * std::ssize(steps);
}

}  // namespace

bool is_image(const fs::path& file) {
  constexpr auto kImages =
      std::to_array<std::string_view>({".png", ".jpg", ".jpeg", ".jpe", ".jp2", ".webp", ".bmp", ".dib", ".tif",
                                       ".tiff", ".pgm", ".ppm", ".pbm", ".pnm", ".pam", ".sr", ".ras"});
  return std::ranges::find(kImages, lower(file.extension().string())) != kImages.end();
}

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

std::string instead_of_images(const fs::path& folder) {
  std::map<std::string, int> files;
  int folders = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().string().starts_with('.')) continue;
    if (entry.is_directory()) {
      ++folders;
    } else {
      ++files[entry.path().extension().string()];
    }
  }
  if (folders > 0) return "; it holds " + std::to_string(folders) + " folders: name one of them for each camera";
  const auto most = std::ranges::max_element(files, {}, [](const auto& f) { return f.second; });
  if (most == files.end()) return "";
  return "; it holds " + std::to_string(most->second) + " files " +
         (most->first.empty() ? "without an ending" : most->first);
}

std::vector<fs::path> of_one_camera(const fs::path& folder, const std::vector<fs::path>& files,
                                    std::vector<std::string>* guesses) {
  Families families = families_of(files);
  std::vector<fs::path> remaining = files;
  if (const std::set<fs::path> depth = depth_in(families); !depth.empty() && depth.size() * 2 <= files.size()) {
    guesses->push_back(folder.string() + ": " + std::to_string(depth.size()) + " images of depth are left out, as " +
                       depth.begin()->filename().string());
    std::erase_if(families, [&](const auto& f) { return depth.contains(f.second.front()); });
    std::erase_if(remaining, [&](const fs::path& file) { return depth.contains(file); });
  }
  std::size_t most = 0;
  for (const auto& [family, images] : families) most = std::max(most, images.size());
  // A few others among many images, or names that have nothing in common, are no second camera.
  constexpr std::size_t kFew = 10;
  std::erase_if(families, [&](const auto& f) { return f.second.size() < 2 || f.second.size() * kFew < most; });
  if (families.size() < 2) return remaining;
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
  NamedTimes out{{}, TimeUnit::kNanoseconds};
  if (const auto numbers = numbers_of(files); count_time(numbers)) {
    for (const std::int64_t number : numbers) out.times.push_back({number, 0});
  }
  return out;
}

}  // namespace coslam
