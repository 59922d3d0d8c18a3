// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/frame_list.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "agent/capture/image_names.h"
#include "common/base/error.h"
#include "common/base/file_kind.h"
#include "common/base/text.h"

namespace coslam {
namespace {

namespace fs = std::filesystem;

// One image of a list, as it stands there.
struct WrittenFrame {
  WrittenTime time;
  fs::path file;
};

using LineReader = std::function<std::optional<WrittenFrame>(std::string_view)>;

// Reads a list line by line; `form` is what a line should have been.
std::vector<WrittenFrame> read_list(const fs::path& file, const char* form, const LineReader& read_line) {
  std::ifstream stream(file);
  if (!stream) throw UserError(file.string() + ": cannot be read");
  std::vector<WrittenFrame> frames;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (number == 1 && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
    if (number == 1 && (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF"))) {
      throw UserError(file.string() + ": is written in UTF-16; it has to be UTF-8 or ASCII");
    }
    std::erase(line, '"');  // of quoted fields
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    const auto frame = read_line(text);
    const std::string place = file.string() + ":" + std::to_string(number) + ": ";
    const bool header = number == 1 && std::isalpha(static_cast<unsigned char>(text.front()));
    if (!frame && header) continue;
    if (!frame) throw UserError(place + "not a line `" + form + "`");
    if (!frames.empty() && frame->time < frames.back().time) {
      throw UserError(place + "the time is earlier than that of the line before");
    }
    frames.push_back(*frame);
  }
  if (frames.empty()) throw UserError(file.string() + ": there is no line `" + form + "` in it");
  return frames;
}

// Windows separates folders by backslashes, which are read so where no file has such a name; true where one was.
bool use_slashes(std::vector<WrittenFrame>* frames) {
  bool any = false;
  for (WrittenFrame& frame : *frames) {
    std::string name = frame.file.string();
    if (name.find('\\') == std::string::npos || fs::exists(frame.file)) continue;
    std::ranges::replace(name, '\\', '/');
    frame.file = name;
    any = true;
  }
  return any;
}

// With the times that are meant, without images whose time is that of the one before.
FrameList timed(const std::string& name, std::vector<WrittenFrame> written, TimeUnit unit) {
  const bool backslashes = use_slashes(&written);
  std::vector<WrittenTime> times;
  times.reserve(written.size());
  for (const WrittenFrame& frame : written) times.push_back(frame.time);
  FrameList list;
  SourceTimes meant = source_times(name, times, unit);
  for (std::size_t i = 0; i < written.size(); ++i) {
    if (meant.source_ns[i]) list.frames.push_back({*meant.source_ns[i], written[i].file});
  }
  list.all_ns = std::move(meant.source_ns);
  list.zero_ns = meant.zero_ns;
  list.guesses = std::move(meant.guesses);
  if (backslashes) list.guesses.push_back(name + ": backslashes in the names of its files are read as /");
  return list;
}

std::vector<WrittenFrame> read_time_lines(const fs::path& file) {
  return read_list(file, "t_s", [](std::string_view line) -> std::optional<WrittenFrame> {
    if (const auto time = parse_written_time(line)) return WrittenFrame{*time, {}};
    // TUM's monocular sequences: the name of an image, its time in seconds and its exposure.
    const auto fields = split_fields(line);
    const auto time = fields.size() == 3 ? parse_written_time(fields[1]) : std::nullopt;
    return time ? std::optional(WrittenFrame{*time, fields[0]}) : std::nullopt;
  });
}

// Fields of a line between commas, else between semicolons (numbers may have a decimal comma then), else between
// blanks.
std::vector<std::string> fields_of(std::string_view line) {
  const bool semicolons = line.find(';') != std::string_view::npos;
  const bool commas = !semicolons && line.find(',') != std::string_view::npos;
  std::vector<std::string> out;
  if (commas) {
    for (const std::string_view field : split_csv(line)) out.emplace_back(field);
  } else {
    for (const std::string_view field : split_fields(line, semicolons ? ";" : " \t\r"))
      out.emplace_back(trimmed(field));
  }
  if (semicolons && !out.empty()) std::ranges::replace(out.front(), ',', '.');
  return out;
}

// The times of the images of a folder lie in it, as KITTI has them beside image_0, image_1, ... and TUM beside images,
// or above the folder `data` of KITTI's raw recordings.
std::optional<fs::path> times_of(const fs::path& folder) {
  const fs::path absolute_folder = fs::absolute(folder / ".").lexically_normal().parent_path();
  const std::string name = absolute_folder.filename().string();
  std::vector<fs::path> candidates = {folder / "times.txt", folder / "timestamps.txt"};
  if (name.starts_with("image_") || name == "images") candidates.push_back(absolute_folder.parent_path() / "times.txt");
  if (name == "data") candidates.push_back(absolute_folder.parent_path() / "timestamps.txt");
  const auto found = std::ranges::find_if(candidates, [](const fs::path& f) { return fs::exists(f); });
  return found == candidates.end() ? std::nullopt : std::optional(*found);
}

// Numbers are times only where images come at a camera's rate.
void require_rate(const std::string& name, const std::vector<WrittenTime>& times_s) {
  constexpr double kSlowest_hz = 0.2, kFastest_hz = 240;
  const double interval_s = usual_interval(times_s).value_or(0);
  if (interval_s >= 1 / kFastest_hz && interval_s <= 1 / kSlowest_hz) return;
  throw UserError(name + ": as times in seconds the names of its images would be " + format_seconds(to_ns(interval_s)) +
                  " s apart");
}

// Times of images that come at a rate: by their numbers, so that a number that is missing is a gap in time.
FrameList at_rate(const fs::path& folder, const std::vector<fs::path>& files, std::vector<std::int64_t> numbers,
                  double rate_hz) {
  if (numbers.empty()) {
    for (std::size_t i = 0; i < files.size(); ++i) numbers.push_back(static_cast<std::int64_t>(i));
  }
  std::int64_t step = numbers.size() > 1 ? numbers[1] - numbers[0] : 1;  // usually 1; 5 where one in five was kept
  for (std::size_t i = 1; i < numbers.size(); ++i) step = std::min(step, numbers[i] - numbers[i - 1]);
  FrameList list;
  list.at_rate = true;
  std::optional<std::size_t> gap;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const double steps = static_cast<double>(numbers[i] - numbers[0]) / static_cast<double>(step);
    list.frames.push_back({to_ns(steps / rate_hz), files[i]});
    if (!gap && i > 0 && numbers[i] - numbers[i - 1] != step) gap = i;
  }
  if (gap) {
    const auto missing = (numbers.back() - numbers.front()) / step + 1 - std::ssize(numbers);
    list.guesses.push_back(folder.string() + ": " +
                           (missing > 0 ? std::to_string(missing) + " numbers of images are missing, the first"
                                        : "the numbers of images are not evenly apart, first") +
                           " after " + files[*gap - 1].filename().string() + "; played as gaps in time");
  }
  return list;
}

// The frames of a file of times, one for each image.
FrameList at_times(const fs::path& times, std::vector<WrittenFrame> frames, const std::vector<fs::path>& files) {
  if (frames.size() != files.size()) {
    throw UserError(times.string() + ": " + std::to_string(frames.size()) + " times for " +
                    std::to_string(files.size()) + " images");
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string named = frames[i].file.stem().string();
    if (!named.empty() && named != files[i].stem().string()) {
      throw UserError(times.string() + ": image " + std::to_string(i + 1) + " is " + named + " there, and " +
                      files[i].filename().string() + " in the folder");
    }
    frames[i].file = files[i];
  }
  return timed(times.string(), frames, TimeUnit::kSeconds);
}

// By times in the names of images, where they are such; else at the rate.
FrameList by_names(const fs::path& folder, const std::vector<fs::path>& files, double rate_hz) {
  NamedTimes named = times_in_names(files);
  if (named.times.empty()) return at_rate(folder, files, numbers_of(files), rate_hz);
  std::vector<WrittenFrame> frames;
  for (std::size_t i = 0; i < files.size(); ++i) frames.push_back({named.times[i], files[i]});
  std::ranges::stable_sort(frames, {}, &WrittenFrame::time);
  std::ranges::sort(named.times);
  const std::string name = folder.string();
  try {
    if (named.coarse) throw UserError(name + ": its images are named by dates of whole seconds");
    if (named.vague) require_rate(name, named.times);
    FrameList list = timed(name, frames, named.unit);
    if (named.vague) list.guesses.push_back(name + ": the names of its images are taken for times in seconds");
    return list;
  } catch (const UserError& e) {
    FrameList list = at_rate(folder, files, named.coarse ? std::vector<std::int64_t>() : numbers_of(files), rate_hz);
    list.guesses.push_back(std::string(e.what()) + "; the names of its images are not taken for times");
    return list;
  }
}

}  // namespace

FrameList list_csv(const fs::path& file) {
  std::size_t most_fields = 0;
  const auto frames = read_list(file, "t_s,file", [&](std::string_view line) -> std::optional<WrittenFrame> {
    const auto fields = fields_of(line);
    if (fields.size() < 2 || fields[1].empty()) return std::nullopt;
    const auto time = parse_written_time(fields[0]);
    if (!time) return std::nullopt;
    most_fields = std::max(most_fields, fields.size());
    return WrittenFrame{*time, file.parent_path() / fields[1]};
  });
  FrameList list = timed(file.string(), frames, TimeUnit::kSeconds);
  if (most_fields > 2)
    list.guesses.push_back(file.string() + ": of its columns the first two are read, a time and a file");
  return list;
}

FrameList list_tum(const fs::path& rgb_txt) {
  const auto frames = read_list(rgb_txt, "t_s file", [&](std::string_view line) -> std::optional<WrittenFrame> {
    const auto fields = split_fields(line);
    if (fields.size() != 2 && fields.size() != 4) return std::nullopt;
    // Associations have two images a line; depth is not for us.
    const bool second = fields.size() == 4 && fields[1].find("depth") != std::string_view::npos;
    const auto time = parse_written_time(fields[second ? 2 : 0]);
    return time ? std::optional(WrittenFrame{*time, rgb_txt.parent_path() / fields[second ? 3 : 1]}) : std::nullopt;
  });
  return timed(rgb_txt.string(), frames, TimeUnit::kSeconds);
}

FrameList list_euroc(const fs::path& camera_folder) {
  const fs::path csv = camera_folder / "data.csv";
  const auto frames = read_list(csv, "t_ns,file", [&](std::string_view line) -> std::optional<WrittenFrame> {
    const auto fields = split_csv(line);
    if (fields.size() < 2 || fields[1].empty()) return std::nullopt;
    const auto time = parse_written_time(fields[0]);
    return time ? std::optional(WrittenFrame{*time, camera_folder / "data" / fields[1]}) : std::nullopt;
  });
  return timed(csv.string(), frames, TimeUnit::kNanoseconds);
}

FrameList list_images(const fs::path& folder, double rate_hz) {
  std::vector<fs::path> files = images_in(folder);
  if (files.empty()) {
    const std::string it_is = but_it_is(folder);
    throw UserError(folder.string() + ": there is no image in the folder" +
                    (it_is.empty() ? instead_of_images(folder) : it_is));
  }
  std::vector<std::string> guesses;
  const auto times = times_of(folder);
  std::vector<WrittenFrame> frames;
  if (times) frames = read_time_lines(*times);
  if (frames.size() != files.size()) files = of_one_camera(folder, files, &guesses);
  FrameList list = times ? at_times(*times, std::move(frames), files) : by_names(folder, files, rate_hz);
  list.guesses.insert(list.guesses.begin(), guesses.begin(), guesses.end());
  return list;
}

FrameList list_folder(const fs::path& folder, double rate_hz) {
  for (const char* camera : {"mav0/cam0", "cam0", "."}) {
    const fs::path candidate = (folder / camera).lexically_normal();
    if (fs::exists(candidate / "data.csv")) return list_euroc(candidate);
  }
  if (fs::exists(folder / "rgb.txt")) return list_tum(folder / "rgb.txt");
  // KITTI: its sequences, and its raw recordings; TUM's monocular sequences.
  for (const char* camera : {"image_0", "image_00/data", "data", "images"}) {
    if (fs::is_directory(folder / camera) && images_in(folder).empty()) return list_images(folder / camera, rate_hz);
  }
  return list_images(folder, rate_hz);
}

SourceTimes read_times(const fs::path& file) {
  std::vector<WrittenTime> times;
  for (const WrittenFrame& frame : read_time_lines(file)) times.push_back(frame.time);
  return source_times(file.string(), times, TimeUnit::kSeconds);
}

}  // namespace coslam
