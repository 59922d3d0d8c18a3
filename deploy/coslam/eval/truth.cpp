// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/truth.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
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
  std::string place;
  std::vector<std::string> fields;
  bool commas = false;  // between them
};

bool is_nan(const std::string& field) { return field == "nan" || field == "NaN"; }

bool is_number(const std::string& field) { return parse_double(field) || is_nan(field); }

std::vector<Line> lines_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) throw UserError(file.string() + ": cannot be read");
  std::vector<Line> out;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto fields = split_fields(line, " ,;\t\r");
    if (fields.empty() || fields[0].starts_with('#')) continue;
    Line read{file.string() + ":" + std::to_string(number) + ": ",
              {fields.begin(), fields.end()},
              line.find(',') != line.npos};
    if (!out.empty() || std::ranges::any_of(read.fields, is_number)) out.push_back(std::move(read));
  }
  if (out.empty()) throw UserError(file.string() + ": has no pose");
  return out;
}

// Of the body that a motion capture lost sight of.
bool is_unknown(const Line& line) { return std::ranges::any_of(line.fields, is_nan); }

Form form_of(const Line& line) {
  const std::size_t count = line.fields.size();
  if (count == 12 || (!line.commas && (count == 13 || count == 16))) return Form::kKitti;
  if (count >= 8 && parse_integer(line.fields.front()) && (line.commas || count > 8)) return Form::kEuroc;
  if (count == 8) return Form::kTum;
  throw UserError(line.place + std::to_string(count) + " fields; poses are lines `t_s tx ty tz qx qy qz qw` (TUM), " +
                  "`t_ns,x,y,z,qw,qx,qy,qz,...` (EuRoC), or the 12 numbers of [R t] for each image (KITTI)");
}

std::vector<double> numbers_of(const Line& line, std::size_t first, std::size_t count) {
  std::vector<double> out;
  for (std::size_t i = first; i < first + count && i < line.fields.size(); ++i) {
    const auto number = parse_double(line.fields[i]);
    if (!number) throw UserError(line.place + "'" + line.fields[i] + "' is not a number");
    out.push_back(*number);
  }
  if (out.size() != count) throw UserError(line.place + "too few numbers");
  return out;
}

// Of the seven numbers of a place and a quaternion.
Rigid3 pose_of(const Line& line, bool w_first) {
  const auto v = numbers_of(line, 1, 7);
  const Eigen::Quaterniond q =
      w_first ? Eigen::Quaterniond(v[3], v[4], v[5], v[6]) : Eigen::Quaterniond(v[6], v[3], v[4], v[5]);
  if (std::abs(q.norm() - 1) > 0.01)
    throw UserError(line.place +
                    "not a unit quaternion; poses in another form, as Vicon's or COLMAP's, are written as "
                    "lines `t_s tx ty tz qx qy qz qw` (TUM), camera to world");  // with few decimals
  return {q.normalized(), {v[0], v[1], v[2]}};
}

// By their digits, or as poses would come too seldom in seconds.
bool are_nanoseconds(const std::vector<Line>& lines) {
  constexpr std::size_t kDigits = 12;
  constexpr std::int64_t kMostStep_s = 100'000;
  const auto first = parse_integer(lines.front().fields.front()), last = parse_integer(lines.back().fields.front());
  if (!first || !last) return false;
  return lines.back().fields.front().size() >= kDigits || *last - *first > kMostStep_s * std::ssize(lines);
}

Trajectory read_tum(const std::vector<Line>& lines, bool w_first) {
  const bool in_ns = are_nanoseconds(lines);
  Trajectory out;
  for (const Line& line : lines) {
    const std::string& t = line.fields.front();
    const auto t_ns = in_ns ? parse_integer(t) : parse_seconds(t);
    if (!t_ns) throw UserError(line.place + "'" + t + "' is no time in " + (in_ns ? "nanoseconds" : "seconds"));
    out.push_back({*t_ns, pose_of(line, w_first).inverse()});
  }
  return out;
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

Trajectory read_euroc(const std::vector<Line>& lines, const SequenceAgent& agent, bool w_first) {
  pose_of(lines.front(), w_first);  // or it is none of EuRoC's
  const auto body = body_from_camera(agent.calibration);
  if (!body) {
    log_warn(agent.truth->string() + ": its poses are of the body; the calibration of agent " + agent.name +
             " has no T_BS, so that they are taken for the camera's");
  }
  Trajectory out;
  for (const Line& line : lines) {
    const auto t_ns = parse_integer(line.fields.front());
    if (!t_ns) throw UserError(line.place + "'" + line.fields.front() + "' is no time in nanoseconds");
    const Rigid3 world_from_body = pose_of(line, w_first);
    out.push_back({*t_ns, (body ? world_from_body * *body : world_from_body).inverse()});
  }
  return out;
}

std::size_t number_of_image(const Line& line) {
  const auto number = parse_integer(line.fields.front());
  if (!number || *number < 0) throw UserError(line.place + "'" + line.fields.front() + "' is no number of an image");
  return static_cast<std::size_t>(*number);
}

Trajectory read_kitti(const std::vector<Line>& lines, const SequenceAgent& agent,
                      const std::optional<ListedTimes>& times, double rate_hz) {
  if (!times) {
    log_warn(agent.truth->string() + ": has a pose for each image, whose times are not known here; taken to come " +
             format_double(rate_hz) + " times a second");
  }
  const bool numbered = lines.front().fields.size() == 13;
  if (numbered)
    log_info(agent.truth->string() + ": the number before each pose is taken for its image's place, 0 the first");
  if (times && !numbered && lines.size() != times->source_ns.size()) {
    throw UserError(agent.truth->string() + ": " + std::to_string(lines.size()) + " poses for " +
                    std::to_string(times->source_ns.size()) +
                    " images; each image needs one, or its number before each pose");
  }
  Trajectory out;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t image = numbered ? number_of_image(lines[i]) : i;
    if (times && image >= times->source_ns.size()) continue;
    const auto t_ns = times ? times->source_ns[image] : std::optional(to_ns(static_cast<double>(image) / rate_hz));
    if (!t_ns || is_unknown(lines[i])) continue;  // its image is left out
    const auto v = numbers_of(lines[i], numbered ? 1 : 0, 12);
    const Eigen::Matrix<double, 3, 4> m = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(v.data());
    const Rigid3 world_from_cam(Eigen::Quaterniond(Eigen::Matrix3d(m.leftCols<3>())).normalized(), m.col(3));
    out.push_back({*t_ns, world_from_cam.inverse()});
  }
  return out;
}

// A result may be judged where the images are no more: then nothing is known of their times.
template <class Known>
Known if_readable(const std::function<Known()>& read) {
  try {
    return read();
  } catch (const UserError&) {
    return {};
  }
}

// Where the times of the source count from, if those of the truth are the source's as they were written; else 0.
TimeNs written_from_ns(const Trajectory& truth, const SequenceAgent& agent, double rate_hz) {
  const auto zero_ns = if_readable<TimeNs>([&] { return written_zero_ns(agent.source, rate_hz); });
  return !truth.empty() && truth.back().t_ns >= zero_ns ? zero_ns : 0;
}

std::vector<Line> known_of(const std::filesystem::path& file, const std::vector<Line>& lines) {
  std::vector<Line> known;
  std::ranges::copy_if(lines, std::back_inserter(known), [](const Line& line) { return !is_unknown(line); });
  if (known.empty()) throw UserError(file.string() + ": has no pose without NaN");
  if (known.size() < lines.size())
    log_warn(file.string() + ": " + std::to_string(lines.size() - known.size()) +
             " poses of NaN are left out: there is no truth there");
  return known;
}

// A pose whose time is that of the one before; throws where it is earlier. A line has one pose, but for KITTI's.
void leave_out_repeated(const std::filesystem::path& file, const std::vector<Line>& lines, Trajectory* truth) {
  for (std::size_t i = 1; i < truth->size(); ++i) {
    if ((*truth)[i].t_ns < (*truth)[i - 1].t_ns)
      throw UserError(lines[i].place + "the time is earlier than that of the line before");
  }
  const auto same_time = [](const StampedPose& a, const StampedPose& b) { return a.t_ns == b.t_ns; };
  const auto repeated = std::unique(truth->begin(), truth->end(), same_time);
  if (repeated == truth->end()) return;
  log_warn(file.string() + ": " + std::to_string(truth->end() - repeated) +
           " poses have the time of the one before and are left out");
  truth->erase(repeated, truth->end());
}

}  // namespace

Trajectory load_truth(const SequenceAgent& agent, double rate_hz, QuaternionOrder order) {
  if (!agent.truth) return {};
  const auto written = lines_of(*agent.truth);
  const Form form = form_of(written.front());
  const auto lines = form == Form::kKitti ? written : known_of(*agent.truth, written);
  const bool w_first = (form == Form::kEuroc) != (order == QuaternionOrder::kOther);
  Trajectory truth;
  if (form == Form::kTum) truth = read_tum(lines, w_first);
  if (form == Form::kEuroc) truth = read_euroc(lines, agent, w_first);
  if (form == Form::kKitti) {
    const auto times = if_readable<std::optional<ListedTimes>>([&] { return listed_times(agent.source, rate_hz); });
    truth = read_kitti(lines, agent, times, rate_hz);
  }
  const TimeNs zero_ns = form == Form::kKitti ? 0 : written_from_ns(truth, agent, rate_hz);
  leave_out_repeated(*agent.truth, lines, &truth);
  // What has the source's times is brought to those that were played; else it has them.
  const bool of_source = form == Form::kKitti || zero_ns != 0;
  const TimeNs later_ns = zero_ns + to_ns(of_source ? agent.start_s : agent.start_s - agent.truth_start_s);
  for (StampedPose& pose : truth) pose.t_ns -= later_ns;
  if (agent.duration_s) std::erase_if(truth, [&](const StampedPose& p) { return p.t_ns >= to_ns(*agent.duration_s); });
  return truth;
}

}  // namespace coslam::eval
