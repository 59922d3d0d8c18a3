// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/result.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "common/base/error.h"
#include "common/base/text.h"
#include "common/dataset/file.h"

namespace coslam {
namespace {

constexpr std::string_view kPointHeader =
    "id,x,y,z,cov_xx,cov_xy,cov_xz,cov_yy,cov_yz,cov_zz,state,first_t_s,last_t_s,views";
constexpr std::string_view kTrackHeader = "frame,t_s,track,u,v,point,state";
constexpr std::string_view kDynamicHeader = "t_s,id,x,y,z,cov_xx,cov_xy,cov_xz,cov_yy,cov_yz,cov_zz,views";
constexpr std::string_view kObjectHeader = "t_s,object,x,y,z,vx,vy,vz,extent_x,extent_y,extent_z,members";
constexpr std::string_view kGroupHeader = "t_s,group,agents";

constexpr std::array<PointState, 3> kStates = {PointState::kStatic, PointState::kUncertain, PointState::kDynamic};

std::string position_text(const Eigen::Vector3d& p, const Eigen::Matrix3d& c) {
  char text[256];
  std::snprintf(text, sizeof text, "%.9g,%.9g,%.9g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g", p.x(), p.y(), p.z(), c(0, 0),
                c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2));
  return text;
}

// Reads the fields of one line in order; `ok` tells whether all were there and of their kind.
class FieldReader {
 public:
  explicit FieldReader(std::string_view line) : fields_(split_csv(line)) {}

  double number() { return take(parse_double(field())).value_or(0); }
  TimeNs time() { return take(parse_seconds(field())).value_or(0); }
  std::uint32_t count() {
    const auto value = take(parse_integer(field()));
    if (value && (*value < 0 || *value > 0xffffffff)) ok_ = false;
    return static_cast<std::uint32_t>(value.value_or(0));
  }
  Eigen::Vector3d vector() {
    const double x = number(), y = number();
    return {x, y, number()};
  }
  Eigen::Matrix3d covariance() {
    const double xx = number(), xy = number(), xz = number(), yy = number(), yz = number(), zz = number();
    return (Eigen::Matrix3d() << xx, xy, xz, xy, yy, yz, xz, yz, zz).finished();
  }
  std::optional<PointState> state() {
    const std::string_view name = field();
    for (const PointState state : kStates) {
      if (name == state_name(state)) return state;
    }
    if (name != state_name(std::nullopt)) ok_ = false;
    return std::nullopt;
  }
  std::string_view text() { return field(); }

  bool complete() const { return ok_ && position_ == fields_.size(); }

 private:
  std::string_view field() {
    if (position_ >= fields_.size()) ok_ = false;
    return position_ < fields_.size() ? fields_[position_++] : std::string_view();
  }
  template <class T>
  std::optional<T> take(std::optional<T> value) {
    if (!value) ok_ = false;
    return value;
  }

  std::vector<std::string_view> fields_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

// Calls read_line for each line below the header; it answers whether the line was good. Names of the columns are the
// format's version: any other header is refused.
void read_csv(const std::filesystem::path& file, std::string_view header,
              const std::function<bool(FieldReader&)>& read_line) {
  std::ifstream stream(file);
  std::string line;
  if (!stream || !std::getline(stream, line)) throw UserError(file.string() + ": cannot be read");
  if (trimmed(line) != header)
    throw UserError(file.string() + ":1: the header `" + std::string(header) + "` is expected");
  for (int number = 2; std::getline(stream, line); ++number) {
    if (trimmed(line).empty()) continue;
    FieldReader fields(line);
    if (!read_line(fields)) {
      throw UserError(file.string() + ":" + std::to_string(number) + ": not a line `" + std::string(header) + "`");
    }
  }
}

}  // namespace

const char* state_name(std::optional<PointState> state) {
  if (!state) return "none";
  switch (*state) {
    case PointState::kStatic:
      return "static";
    case PointState::kUncertain:
      return "uncertain";
    case PointState::kDynamic:
      break;
  }
  return "dynamic";
}

CsvWriter::CsvWriter(const std::filesystem::path& file, std::string_view header, OutputFile::Shows shows)
    : file_(file, shows) {
  file_.write(std::string(header) + '\n');
}

PointWriter::PointWriter(const std::filesystem::path& file)
    : CsvWriter(file, kPointHeader, OutputFile::Shows::kWhole) {}
TrackWriter::TrackWriter(const std::filesystem::path& file, OutputFile::Shows shows)
    : CsvWriter(file, kTrackHeader, shows) {}
DynamicWriter::DynamicWriter(const std::filesystem::path& file)
    : CsvWriter(file, kDynamicHeader, OutputFile::Shows::kWhole) {}
ObjectWriter::ObjectWriter(const std::filesystem::path& file)
    : CsvWriter(file, kObjectHeader, OutputFile::Shows::kWhole) {}
GroupWriter::GroupWriter(const std::filesystem::path& file)
    : CsvWriter(file, kGroupHeader, OutputFile::Shows::kAtOnce) {
  file_.flush();
}

void PointWriter::write(const ResultPoint& p) {
  line_ = std::to_string(p.id.value) + ',' + position_text(p.position, p.covariance) + ',' + state_name(p.state) + ',' +
          format_seconds(p.first_ns) + ',' + format_seconds(p.last_ns) + ',' + std::to_string(p.views) + '\n';
  file_.write(line_);
}

void TrackWriter::write(const ResultTrackRow& r) {
  char pixel[64];
  std::snprintf(pixel, sizeof pixel, "%.3f,%.3f", r.raw_px.x(), r.raw_px.y());
  line_ = std::to_string(r.frame.value) + ',' + format_seconds(r.t_ns) + ',' + std::to_string(r.track.value) + ',' +
          pixel + ',' + std::to_string(r.point.value) + ',' + state_name(r.state) + '\n';
  file_.write(line_);
}

void DynamicWriter::write(const ResultDynamicRow& r) {
  line_ = format_seconds(r.t_ns) + ',' + std::to_string(r.id.value) + ',' + position_text(r.position, r.covariance) +
          ',' + std::to_string(r.views) + '\n';
  file_.write(line_);
}

void ObjectWriter::write(const ResultObjectRow& r) {
  line_ = format_seconds(r.t_ns) + ',' + std::to_string(r.object.value);
  char text[128];
  for (const Eigen::Vector3d& v : {r.position, r.velocity_per_s, r.extent}) {
    std::snprintf(text, sizeof text, ",%.9g,%.9g,%.9g", v.x(), v.y(), v.z());
    line_ += text;
  }
  line_ += ',';
  for (std::size_t i = 0; i < r.members.size(); ++i) line_ += (i == 0 ? "" : " ") + std::to_string(r.members[i].value);
  line_ += '\n';
  file_.write(line_);
}

void GroupWriter::write(const ResultGroupRow& r) {
  line_ = format_seconds(r.t_ns) + ',' + std::to_string(r.group.value) + ',';
  for (std::size_t i = 0; i < r.agents.size(); ++i) line_ += (i == 0 ? "" : " ") + r.agents[i];
  line_ += '\n';
  file_.write(line_);
  file_.flush();  // rare, and of use while the run goes on
}

std::vector<ResultPoint> read_points(const std::filesystem::path& file) {
  std::vector<ResultPoint> points;
  read_csv(file, kPointHeader, [&](FieldReader& f) {
    ResultPoint p;
    p.id = PointId(f.count());
    p.position = f.vector();
    p.covariance = f.covariance();
    const auto state = f.state();
    p.state = state.value_or(PointState::kUncertain);
    p.first_ns = f.time();
    p.last_ns = f.time();
    p.views = static_cast<int>(f.count());
    points.push_back(p);
    return f.complete() && state.has_value();
  });
  return points;
}

void for_each_track_row(const std::filesystem::path& file, const std::function<void(const ResultTrackRow&)>& row) {
  read_csv(file, kTrackHeader, [&](FieldReader& f) {
    ResultTrackRow r;
    r.frame = FrameId(f.count());
    r.t_ns = f.time();
    r.track = TrackId(f.count());
    r.raw_px.x() = f.number();
    r.raw_px.y() = f.number();
    r.point = PointId(f.count());
    r.state = f.state();
    if (!f.complete()) return false;
    row(r);
    return true;
  });
}

void for_each_dynamic_row(const std::filesystem::path& file, const std::function<void(const ResultDynamicRow&)>& row) {
  read_csv(file, kDynamicHeader, [&](FieldReader& f) {
    ResultDynamicRow r;
    r.t_ns = f.time();
    r.id = PointId(f.count());
    r.position = f.vector();
    r.covariance = f.covariance();
    r.views = static_cast<int>(f.count());
    if (!f.complete()) return false;
    row(r);
    return true;
  });
}

void for_each_object_row(const std::filesystem::path& file, const std::function<void(const ResultObjectRow&)>& row) {
  read_csv(file, kObjectHeader, [&](FieldReader& f) {
    ResultObjectRow r;
    r.t_ns = f.time();
    r.object = ObjectId(f.count());
    r.position = f.vector();
    r.velocity_per_s = f.vector();
    r.extent = f.vector();
    bool good = true;
    for (const std::string_view member : split_fields(f.text())) {
      const auto id = parse_integer(member);
      good = good && id && *id > 0 && *id <= 0xffffffff;
      r.members.emplace_back(static_cast<std::uint32_t>(id.value_or(0)));
    }
    if (!good || !f.complete()) return false;
    row(r);
    return true;
  });
}

std::vector<ResultGroupRow> read_groups(const std::filesystem::path& file) {
  std::vector<ResultGroupRow> rows;
  read_csv(file, kGroupHeader, [&](FieldReader& f) {
    ResultGroupRow r;
    r.t_ns = f.time();
    r.group = GroupId(f.count());
    for (const std::string_view agent : split_fields(f.text())) r.agents.emplace_back(agent);
    rows.push_back(r);
    return f.complete();
  });
  return rows;
}

void write_ply(const std::filesystem::path& file, const std::vector<ResultPoint>& points, LengthUnit unit) {
  static_assert(std::endian::native == std::endian::little, "the PLY is written as it lies in memory");
  const auto is_static = [](const ResultPoint& p) { return p.state == PointState::kStatic; };
  OutputFile out(file, OutputFile::Shows::kWhole);
  out.write("ply\nformat binary_little_endian 1.0\ncomment CoSLAM map, static points; " + std::string(words_of(unit)) +
            "\nelement vertex " + std::to_string(std::count_if(points.begin(), points.end(), is_static)) +
            "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
            "property uchar blue\nproperty float sqrt_trace_sigma\nend_header\n");
  for (const ResultPoint& p : points) {
    if (!is_static(p)) continue;
    const Eigen::Vector3f position = p.position.cast<float>();
    const float sigma = static_cast<float>(std::sqrt(p.covariance.trace()));
    out.write({reinterpret_cast<const char*>(position.data()), 3 * sizeof(float)});
    out.write({reinterpret_cast<const char*>(p.rgb.data()), p.rgb.size()});
    out.write({reinterpret_cast<const char*>(&sigma), sizeof sigma});
  }
  out.close();
}

nlohmann::json read_json(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw UserError(file.string() + ": cannot be read");
  try {
    return nlohmann::json::parse(stream);
  } catch (const nlohmann::json::exception& e) {
    throw UserError(file.string() + ": not valid JSON: " + e.what());
  }
}

void write_json(const std::filesystem::path& file, const nlohmann::ordered_json& json) {
  OutputFile out(file, OutputFile::Shows::kWhole);
  out.write(json.dump(2) + '\n');
  out.close();
}

}  // namespace coslam
