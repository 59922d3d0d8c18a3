// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/frame_list.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <functional>
#include <optional>
#include <string>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"

namespace coslam {
namespace {

namespace fs = std::filesystem;

using LineReader = std::function<std::optional<ListedFrame>(std::string_view)>;

// Reads a list line by line; `form` is what a line should have been.
FrameList read_list(const fs::path& file, const char* form, const LineReader& read_line) {
  std::ifstream stream(file);
  if (!stream) throw UserError(file.string() + ": cannot be read");
  FrameList frames;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (number == 1 && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    const auto frame = read_line(text);
    const std::string where = file.string() + ":" + std::to_string(number) + ": ";
    const bool header = number == 1 && std::isalpha(static_cast<unsigned char>(text.front()));
    if (!frame && header) continue;
    if (!frame) throw UserError(where + "not a line `" + form + "`");
    if (!frames.empty() && frame->source_ns <= frames.back().source_ns) {
      throw UserError(where + "the time is not later than that of the line before");
    }
    frames.push_back(*frame);
  }
  if (frames.empty()) throw UserError(file.string() + ": there is no line `" + form + "` in it");
  return frames;
}

void count_from_first(FrameList& frames) {
  const TimeNs first_ns = frames.front().source_ns;
  for (ListedFrame& frame : frames) frame.source_ns -= first_ns;
}

// Seconds that are a date, not a time since the start.
void count_utc_from_first(FrameList& frames) {
  constexpr TimeNs kLongestPlay_ns = 100'000'000'000'000'000;  // three years; 1973 as UTC
  if (frames.front().source_ns > kLongestPlay_ns) count_from_first(frames);
}

FrameList read_seconds_list(const fs::path& file) {
  FrameList frames = read_list(file, "t_s", [](std::string_view line) -> std::optional<ListedFrame> {
    const auto t_ns = parse_seconds(line);
    return t_ns ? std::optional(ListedFrame{*t_ns, {}}) : std::nullopt;
  });
  count_utc_from_first(frames);
  return frames;
}

bool is_image(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  constexpr std::array<const char*, 7> kImages = {".png", ".jpg", ".jpeg", ".pgm", ".bmp", ".tif", ".tiff"};
  return std::find(kImages.begin(), kImages.end(), extension) != kImages.end();
}

std::vector<fs::path> images_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && is_image(entry.path())) files.push_back(entry.path());
  }
  // Shorter names first, so that 999 precedes 1000.
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    const std::string x = a.stem().string(), y = b.stem().string();
    return x.size() != y.size() ? x.size() < y.size() : x < y;
  });
  return files;
}

// Names of 12 digits and more are nanoseconds, shorter ones count images.
std::optional<TimeNs> stamp_of(const fs::path& file) {
  const std::string stem = file.stem().string();
  return stem.size() >= 12 ? parse_integer(stem) : std::nullopt;
}

// Numbers of the images' names, where all are numbers and ascend; else empty.
std::vector<std::int64_t> numbers_of(const std::vector<fs::path>& files) {
  std::vector<std::int64_t> numbers;
  for (const fs::path& file : files) {
    const auto number = parse_integer(file.stem().string());
    if (!number || (!numbers.empty() && *number <= numbers.back())) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

// Times of images that come at a rate: by their numbers, so that a number that is missing is a gap in time.
FrameList at_rate(const fs::path& folder, const std::vector<fs::path>& files, double rate_hz) {
  std::vector<std::int64_t> numbers = numbers_of(files);
  if (numbers.empty()) {
    for (std::size_t i = 0; i < files.size(); ++i) numbers.push_back(static_cast<std::int64_t>(i));
  }
  std::int64_t step = numbers.size() > 1 ? numbers[1] - numbers[0] : 1;  // usually 1; 5 where one in five was kept
  for (std::size_t i = 1; i < numbers.size(); ++i) step = std::min(step, numbers[i] - numbers[i - 1]);
  FrameList frames;
  std::optional<std::size_t> gap;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const double steps = static_cast<double>(numbers[i] - numbers[0]) / static_cast<double>(step);
    frames.push_back({to_ns(steps / rate_hz), files[i]});
    if (!gap && i > 0 && numbers[i] - numbers[i - 1] != step) gap = i;
  }
  if (gap) {
    const auto missing = (numbers.back() - numbers.front()) / step + 1 - std::ssize(numbers);
    log_warn(folder.string() + ": " + std::to_string(missing) + " numbers of images are missing, the first after " +
             files[*gap - 1].filename().string() + "; played as gaps in time");
  }
  return frames;
}

}  // namespace

FrameList list_csv(const fs::path& file) {
  FrameList frames = read_list(file, "t_s,file", [&](std::string_view line) -> std::optional<ListedFrame> {
    const auto fields = split_csv(line);
    if (fields.size() != 2 || fields[1].empty()) return std::nullopt;
    const auto t_ns = parse_seconds(fields[0]);
    return t_ns ? std::optional(ListedFrame{*t_ns, file.parent_path() / fields[1]}) : std::nullopt;
  });
  count_utc_from_first(frames);
  return frames;
}

FrameList list_tum(const fs::path& rgb_txt) {
  FrameList frames = read_list(rgb_txt, "t_s file", [&](std::string_view line) -> std::optional<ListedFrame> {
    const auto fields = split_fields(line);
    if (fields.size() != 2) return std::nullopt;
    const auto t_ns = parse_seconds(fields[0]);
    return t_ns ? std::optional(ListedFrame{*t_ns, rgb_txt.parent_path() / fields[1]}) : std::nullopt;
  });
  count_utc_from_first(frames);
  return frames;
}

FrameList list_euroc(const fs::path& camera_folder) {
  const fs::path csv = camera_folder / "data.csv";
  FrameList frames = read_list(csv, "t_ns,file", [&](std::string_view line) -> std::optional<ListedFrame> {
    const auto fields = split_csv(line);
    if (fields.size() != 2 || fields[1].empty()) return std::nullopt;
    const auto t_ns = parse_integer(fields[0]);
    return t_ns ? std::optional(ListedFrame{*t_ns, camera_folder / "data" / fields[1]}) : std::nullopt;
  });
  count_from_first(frames);
  return frames;
}

FrameList list_images(const fs::path& folder, double rate_hz) {
  const auto files = images_in(folder);
  if (files.empty()) throw UserError(folder.string() + ": there is no image in the folder");
  FrameList frames;
  // KITTI has the times of image_0, image_1, ... beside these folders.
  const fs::path name = fs::absolute(folder / ".").lexically_normal().parent_path();
  const bool kitti = name.filename().string().starts_with("image_");
  const fs::path beside = name.parent_path() / "times.txt";
  const fs::path times = !fs::exists(folder / "times.txt") && kitti ? beside : folder / "times.txt";
  if (fs::exists(times)) {
    frames = read_seconds_list(times);
    if (frames.size() != files.size()) {
      throw UserError(times.string() + ": " + std::to_string(frames.size()) + " times for " +
                      std::to_string(files.size()) + " images");
    }
    for (std::size_t i = 0; i < files.size(); ++i) frames[i].file = files[i];
    return frames;
  }
  const bool stamped =
      std::all_of(files.begin(), files.end(), [](const fs::path& f) { return stamp_of(f).has_value(); });
  if (!stamped) return at_rate(folder, files, rate_hz);
  frames.reserve(files.size());
  for (const fs::path& file : files) frames.push_back({*stamp_of(file), file});
  count_from_first(frames);
  return frames;
}

FrameList list_folder(const fs::path& folder, double rate_hz) {
  for (const char* camera : {"mav0/cam0", "cam0", "."}) {
    const fs::path candidate = (folder / camera).lexically_normal();
    if (fs::exists(candidate / "data.csv")) return list_euroc(candidate);
  }
  if (fs::exists(folder / "rgb.txt")) return list_tum(folder / "rgb.txt");
  if (fs::is_directory(folder / "image_0") && images_in(folder).empty())
    return list_images(folder / "image_0", rate_hz);
  return list_images(folder, rate_hz);
}

std::vector<TimeNs> read_times(const fs::path& file) {
  std::vector<TimeNs> times;
  for (const ListedFrame& frame : read_seconds_list(file)) times.push_back(frame.source_ns);
  return times;
}

}  // namespace coslam
