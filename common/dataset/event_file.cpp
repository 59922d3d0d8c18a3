// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/event_file.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <vector>

#include "common/base/error.h"
#include "common/base/text.h"

namespace coslam {
namespace {

constexpr std::string_view kEventHeader = "t_s,set,kind,why,map,from,point,other,camera,track,to,a,b";
constexpr std::size_t kColumns = 13;
constexpr int kDigits = 6;  // of a figure

void append(std::string* line, std::string_view text) { line->append(",").append(text); }

// 0 is none for every id here.
void append_id(std::string* line, std::uint32_t id) {
  line->push_back(',');
  if (id > 0) line->append(std::to_string(id));
}

void append_figure(std::string* line, const std::optional<double>& figure) {
  line->push_back(',');
  if (!figure || !std::isfinite(*figure)) return;
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, *figure, std::chars_format::general, kDigits);
  line->append(text, end.ptr);
}

template <class IdType>
bool read_id(std::string_view field, IdType* id) {
  if (field.empty()) return true;
  const auto value = parse_integer(field);
  if (!value || *value < 0 || *value > 0xffffffff) return false;
  *id = IdType(static_cast<std::uint32_t>(*value));
  return true;
}

bool read_figure(std::string_view field, std::optional<double>* figure) {
  if (field.empty()) return true;
  *figure = parse_double(field);
  return figure->has_value();
}

std::optional<EventRow> row_of(std::string_view line) {
  const std::vector<std::string_view> f = split_csv(line);
  if (f.size() != kColumns) return std::nullopt;
  EventRow r{.kind = f[2], .why = f[3], .camera = f[8], .to = f[10]};
  const auto t_ns = parse_seconds(f[0]);
  r.t_ns = t_ns.value_or(0);
  const bool good = t_ns && !r.kind.empty() && read_id(f[1], &r.set) && read_id(f[4], &r.map) &&
                    read_id(f[5], &r.from) && read_id(f[6], &r.point) && read_id(f[7], &r.other) &&
                    read_id(f[9], &r.track) && read_figure(f[11], &r.a) && read_figure(f[12], &r.b);
  return good ? std::optional(r) : std::nullopt;
}

}  // namespace

EventWriter::EventWriter(const std::filesystem::path& file)
    : CsvWriter(file, kEventHeader, OutputFile::Shows::kAtOnce) {}

void EventWriter::write(const EventRow& r) {
  line_ = format_seconds(r.t_ns);
  append(&line_, std::to_string(r.set.value));
  append(&line_, r.kind);
  append(&line_, r.why);
  append_id(&line_, r.map.value);
  append_id(&line_, r.from.value);
  append_id(&line_, r.point.value);
  append_id(&line_, r.other.value);
  append(&line_, r.camera);
  append_id(&line_, r.track.value);
  append(&line_, r.to);
  append_figure(&line_, r.a);
  append_figure(&line_, r.b);
  line_.push_back('\n');
  file_.write(line_);
}

EventFileReport for_each_event_row(const std::filesystem::path& file, const std::function<bool(const EventRow&)>& row) {
  std::ifstream stream(file);
  std::string line;
  if (!stream || !std::getline(stream, line)) throw UserError(file.string() + ": cannot be read");
  const std::string expected(kEventHeader);
  if (trimmed(line) != expected) throw UserError(file.string() + ":1: the header `" + expected + "` is expected");
  EventFileReport report;
  for (int number = 2; std::getline(stream, line); ++number) {
    if (stream.eof()) {  // no end of line: what follows was never written
      report.cut = true;
      break;
    }
    const auto read = row_of(line);
    if (!read || !row(*read)) {
      throw UserError(file.string() + ":" + std::to_string(number) + ": not a line `" + expected + "`");
    }
    ++report.rows;
  }
  return report;
}

}  // namespace coslam
