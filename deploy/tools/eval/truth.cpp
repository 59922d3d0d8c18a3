// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/eval/truth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <optional>
#include <vector>

#include "agent/capture/source.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/config/yaml_value.h"
#include "common/dataset/calibration.h"

namespace coslam::eval {
namespace {

enum class Form : std::uint8_t { kTum, kEuroc, kKitti };

struct Line {
  std::string where;
  std::vector<std::string> fields;
  bool commas = false;  // between them
};

std::vector<Line> lines_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) throw UserError(file.string() + ": cannot be read");
  std::vector<Line> out;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto fields = split_fields(line, " ,\t\r");
    if (fields.empty() || fields[0].starts_with('#')) continue;
    out.push_back({file.string() + ":" + std::to_string(number) + ": ",
                   {fields.begin(), fields.end()},
                   line.find(',') != line.npos});
  }
  return out;
}

Form form_of(const std::vector<Line>& lines) {
  if (lines.empty()) return Form::kTum;
  const auto& [where, fields, commas] = lines.front();
  if (fields.size() == 12) return Form::kKitti;
  return commas || fields.size() > 8 ? Form::kEuroc : Form::kTum;
}

std::vector<double> numbers_of(const Line& line, std::size_t first, std::size_t count) {
  std::vector<double> out;
  for (std::size_t i = first; i < first + count && i < line.fields.size(); ++i) {
    const auto number = parse_double(line.fields[i]);
    if (!number) throw UserError(line.where + "'" + line.fields[i] + "' is not a number");
    out.push_back(*number);
  }
  if (out.size() != count) throw UserError(line.where + "too few numbers");
  return out;
}

Eigen::Quaterniond unit(const Line& line, double w, double x, double y, double z) {
  const Eigen::Quaterniond q(w, x, y, z);
  if (std::abs(q.norm() - 1) > 0.01) throw UserError(line.where + "not a unit quaternion");
  return q.normalized();
}

// T_BS of an EuRoC sensor.yaml.
std::optional<Rigid3> body_from_camera(const std::filesystem::path& name) {
  const std::filesystem::path calibration = calibration_file(name).file;
  if (calibration.extension() != ".yaml" && calibration.extension() != ".yml") return std::nullopt;
  const YamlValue root = YamlValue::load(calibration);
  const auto at = root.find("T_BS");
  if (!at) return std::nullopt;
  const auto v = at->is_map() ? at->at("data").numbers() : at->numbers();
  if (v.size() != 16) at->fail("sixteen numbers are expected");
  const Eigen::Matrix4d m = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(v.data());
  return Rigid3(Eigen::Quaterniond(m.topLeftCorner<3, 3>()).normalized(), m.topRightCorner<3, 1>());
}

Trajectory read_euroc(const std::vector<Line>& lines, const SequenceAgent& agent) {
  const auto body = body_from_camera(agent.calibration);
  if (!body) {
    log_warn(agent.truth->string() + ": its poses are of the body; the calibration of agent " + agent.name +
             " has no T_BS, so that they are taken for the camera's");
  }
  Trajectory out;
  for (const Line& line : lines) {
    const auto t_ns = parse_integer(line.fields.front());
    if (!t_ns) throw UserError(line.where + "'" + line.fields.front() + "' is no time in nanoseconds");
    const auto v = numbers_of(line, 1, 7);
    const Rigid3 world_from_body(unit(line, v[3], v[4], v[5], v[6]), {v[0], v[1], v[2]});
    out.push_back({*t_ns, (body ? world_from_body * *body : world_from_body).inverse()});
  }
  return out;
}

Trajectory read_kitti(const std::vector<Line>& lines, const SequenceAgent& agent,
                      const std::optional<ListedTimes>& times, double rate_hz) {
  if (!times) {
    log_warn(agent.truth->string() + ": has a pose for each image, whose times are not known here; taken to come " +
             format_double(rate_hz) + " times a second");
  }
  Trajectory out;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (times && i >= times->source_ns.size()) break;
    const auto t_ns = times ? times->source_ns[i] : std::optional(to_ns(static_cast<double>(i) / rate_hz));
    if (!t_ns) continue;  // its image is left out
    const auto v = numbers_of(lines[i], 0, 12);
    const Eigen::Matrix<double, 3, 4> m = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(v.data());
    const Rigid3 world_from_cam(Eigen::Quaterniond(Eigen::Matrix3d(m.leftCols<3>())).normalized(), m.col(3));
    out.push_back({*t_ns, world_from_cam.inverse()});
  }
  return out;
}

// A result may be judged where the images are no more.
std::optional<ListedTimes> times_of(const SequenceAgent& agent, double rate_hz) {
  try {
    return listed_times(agent.source, rate_hz);
  } catch (const UserError&) {
    return std::nullopt;
  }
}

// Whether these times are the source's as they were written, before they were counted from its first image.
bool as_written(const Trajectory& truth, const ListedTimes& times) {
  if (truth.empty() || times.zero_ns == 0) return false;
  TimeNs last_ns = 0;
  for (const auto& t : times.source_ns) last_ns = std::max(last_ns, t.value_or(0));
  return truth.front().t_ns <= times.zero_ns + last_ns && truth.back().t_ns >= times.zero_ns;
}

std::string seconds(TimeNs t_ns) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", to_seconds(t_ns));
  return text.data();
}

}  // namespace

Trajectory load_truth(const SequenceAgent& agent, double rate_hz) {
  if (!agent.truth) return {};
  const auto lines = lines_of(*agent.truth);
  const Form form = form_of(lines);
  Trajectory truth;
  if (form == Form::kTum) truth = load_tum(*agent.truth);
  if (form == Form::kEuroc) truth = read_euroc(lines, agent);
  const auto times = times_of(agent, rate_hz);
  if (form == Form::kKitti) truth = read_kitti(lines, agent, times, rate_hz);
  const bool written = form != Form::kKitti && times && as_written(truth, *times);
  for (std::size_t i = 1; i < truth.size(); ++i) {
    if (truth[i].t_ns <= truth[i - 1].t_ns)
      throw UserError(lines[i].where + "the time is not later than that of the line before");
  }
  // What has the source's times is brought to those that were played; else it has them.
  const bool of_source = form == Form::kKitti || written;
  const TimeNs later_ns =
      (written ? times->zero_ns : 0) + to_ns(of_source ? agent.start_s : agent.start_s - agent.truth_start_s);
  for (StampedPose& pose : truth) pose.t_ns -= later_ns;
  if (agent.duration_s) std::erase_if(truth, [&](const StampedPose& p) { return p.t_ns >= to_ns(*agent.duration_s); });
  return truth;
}

std::string times_apart(const std::string& agent, const Trajectory& poses, const Trajectory& truth) {
  constexpr std::ptrdiff_t kLeast = 3;  // which a map can be aligned by
  if (poses.empty() || truth.empty()) return {};
  const auto common = std::ranges::count_if(
      poses, [&](const StampedPose& p) { return p.t_ns >= truth.front().t_ns && p.t_ns <= truth.back().t_ns; });
  if (common >= kLeast || std::ssize(poses) < kLeast) return {};
  const auto span = [](const Trajectory& t) {
    return seconds(t.front().t_ns) + " to " + seconds(t.back().t_ns) + " s";
  };
  return "the poses of agent " + agent + " are of " + span(poses) + " of the time that was played, its truth of " +
         span(truth) + ": hardly an instant is in both";
}

}  // namespace coslam::eval
