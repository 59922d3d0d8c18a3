// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/explain/answer.h"

#include <algorithm>
#include <cmath>

#include "common/base/error.h"
#include "common/base/text.h"
#include "server/keep/explain/life.h"
#include "server/keep/explain/sentence.h"

namespace coslam::explain {
namespace {

std::uint32_t number_of(const std::string& text, const char* noun) {
  const auto value = parse_integer(text);
  if (!value || *value < 1 || *value > 0xffffffff) throw UsageError("`" + text + "` is no number of a " + noun);
  return static_cast<std::uint32_t>(*value);
}

CameraId camera_of(const EventLog& log, const std::string& agent) {
  const auto at = std::ranges::find(log.cameras, agent);
  if (at != log.cameras.end()) return CameraId(static_cast<std::uint16_t>(at - log.cameras.begin()));
  std::string known;
  for (const std::string& name : log.cameras) known += (known.empty() ? "" : ", ") + name;
  throw UserError("the run had no camera " + agent + "; it had " + (known.empty() ? "none" : known));
}

TrackKey asked_track(const EventLog& log, const std::string& id) {
  const std::size_t slash = id.find('/');
  if (slash == std::string::npos) throw UsageError("`" + id + "` is no track: AGENT/TRACK is expected, as in cam0/17");
  const TrackId track(number_of(id.substr(slash + 1), "track"));
  return {camera_of(log, id.substr(0, slash)), track};
}

std::string caution_of(const EventLog& log) {
  const std::string until = seconds(log, log.end_ns);
  if (log.end == EventLog::End::kFull)
    return "events.csv reached its bound (server.events.most_mb) at " + until + ": what happened later is not known";
  if (log.end == EventLog::End::kNone) return "events.csv has no end: the run goes on, or was cut off at " + until;
  return "";
}

Life life_of(const EventLog& log, const Question& question) {
  std::optional<Life> life;
  if (question.kind == "point") life = life_of_point(log, PointId(number_of(question.id, "point")));
  if (question.kind == "track") life = life_of_track(log, asked_track(log, question.id));
  if (question.kind == "camera") life = life_of_camera(log, camera_of(log, question.id));
  if (life) return *life;
  const std::string caution = caution_of(log);
  const char* none = question.kind == "track" ? ": there was none, or it was never mapped and still followed at the end"
                                              : ": there was none";
  throw UserError("events.csv does not speak of " + question.kind + " " + question.id +
                  (caution.empty() ? none : "; " + caution));
}

std::string estimate(const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance, int views) {
  return "at (" + number(position.x()) + ", " + number(position.y()) + ", " + number(position.z()) +
         "), standard deviation " + number(std::sqrt(covariance.trace())) + ", " + std::to_string(views) + " views";
}

// As the user finds it in the result.
std::string file_name(const ResultFolder& result, const std::filesystem::path& file) {
  return file.lexically_relative(result.path()).string();
}

std::string in_points(const ResultFolder& result, const ResultFolder& map, const EventLog& log, PointId point) {
  if (!std::filesystem::exists(map.points())) return "";
  for (const ResultPoint& p : read_points(map.points())) {
    if (p.id != point) continue;
    return file_name(result, map.points()) + " has " + name(point) + ": " + state_name(p.state) + ", " +
           estimate(p.position, p.covariance, p.views) + " from " + seconds(log, p.first_ns) + " to " +
           seconds(log, p.last_ns) + ".\n";
  }
  return "";
}

std::string in_dynamic(const ResultFolder& result, const ResultFolder& map, const EventLog& log, PointId point) {
  if (!std::filesystem::exists(map.dynamic())) return "";
  std::optional<ResultDynamicRow> first, last;
  int rows = 0;
  for_each_dynamic_row(map.dynamic(), [&](const ResultDynamicRow& r) {
    if (r.id != point) return;
    if (!first) first = r;
    last = r;
    ++rows;
  });
  if (!last) return "";
  return file_name(result, map.dynamic()) + " has its path, " + std::to_string(rows) + " places from " +
         seconds(log, first->t_ns) + " to " + seconds(log, last->t_ns) + ", the last one " +
         estimate(last->position, last->covariance, last->views) + ".\n";
}

}  // namespace

Answer answer(const ResultFolder& result, const Question& question) {
  if (!std::filesystem::exists(result.events())) {
    throw UserError(result.events().string() +
                    ": there is none; the run was of an earlier version, or had server.events.enabled=false");
  }
  const EventLog log = read_event_log(result.events());
  const Life life = life_of(log, question);
  Answer out{.text = "", .caution = caution_of(log)};
  if (question.at_s) {
    const TimeNs at_ns = log.start_ns + to_ns(*question.at_s);
    const bool over = log.end == EventLog::End::kRunIsOver && at_ns > log.end_ns;
    if (over) out.text = "The run ended at " + seconds(log, log.end_ns) + ".\n";
    out.text += told_at(log, life, over ? log.end_ns : at_ns);
    return out;
  }
  out.text = life.subject + ", in seconds of the run\n" + life_text(log, life);
  if (question.kind != "point") return out;
  for (const ResultMap& map : contents_of(result).maps) {
    out.text += in_points(result, map.folder, log, life.last) + in_dynamic(result, map.folder, log, life.last);
  }
  return out;
}

}  // namespace coslam::explain
