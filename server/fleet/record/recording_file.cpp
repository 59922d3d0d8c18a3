// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/record/recording_file.h"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/base/check.h"
#include "common/base/error.h"
#include "common/base/file_kind.h"
#include "common/base/text.h"
#include "common/wire/packing.h"

namespace coslam {
namespace {

constexpr std::string_view kMagic = "CoSLAMrc";
constexpr std::size_t kHeader_bytes = 13, kCrc_bytes = 4;
constexpr TimeNs kLongest_ns = 315'360'000'000'000'000;  // ten years

std::uint32_t crc_of(std::span<const std::uint8_t> octets) {
  return static_cast<std::uint32_t>(crc32_z(0, octets.data(), octets.size()));
}

std::string text_of(int error) { return std::generic_category().message(error); }

std::vector<std::uint8_t> coded(const Record& record) {
  std::vector<std::uint8_t> octets;
  octets.reserve(kHeader_bytes + record.payload.size() + 2 * kCrc_bytes);
  Packer packer(octets);
  packer.put(static_cast<std::uint32_t>(record.payload.size()));
  packer.put(static_cast<std::uint8_t>(record.type));
  packer.put(record.t_ns);
  packer.put(crc_of(octets));
  octets.insert(octets.end(), record.payload.begin(), record.payload.end());
  packer.put(crc_of(record.payload));
  return octets;
}

}  // namespace

RecordWriter::RecordWriter(std::filesystem::path file) : file_(std::move(file)) {
  std::error_code ignored;  // shows when the file is opened
  if (file_.has_parent_path()) std::filesystem::create_directories(file_.parent_path(), ignored);
  descriptor_ = open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor_ < 0 && errno == EEXIST) {
    throw UserError(file_.string() + " exists already: name another file for the recording");
  }
  if (descriptor_ < 0) throw UserError(file_.string() + ": cannot be written: " + text_of(errno));
  std::vector<std::uint8_t> begin(kMagic.begin(), kMagic.end());
  Packer(begin).put(kRecordingVersion);
  const int error = write(begin);
  if (error == 0) return;
  remove();
  close(descriptor_);
  throw UserError(file_.string() + ": cannot be written: " + text_of(error));
}

RecordWriter::~RecordWriter() { close(descriptor_); }

int RecordWriter::write(const Record& record) {
  COSLAM_CHECK(record.payload.size() <= kMostPayload_bytes, "a record is longer than its reader takes");
  return write(coded(record));
}

int RecordWriter::write(std::span<const std::uint8_t> octets) {
  for (std::size_t done = 0; done < octets.size();) {
    const ssize_t n = ::write(descriptor_, octets.data() + done, octets.size() - done);
    if (n > 0) done += static_cast<std::size_t>(n);
    if (n > 0 || (n < 0 && errno == EINTR)) continue;
    const int error = n < 0 ? errno : EIO;
    // Where this fails too, readers find the record cut off.
    [[maybe_unused]] const int unheard = ftruncate(descriptor_, whole_bytes_);
    return error;
  }
  whole_bytes_ += static_cast<std::int64_t>(octets.size());
  return 0;
}

void RecordWriter::remove() {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

RecordReader::RecordReader(std::filesystem::path file) : file_(std::move(file)) {
  std::error_code error;
  left_bytes_ = std::filesystem::file_size(file_, error);
  stream_.open(file_, std::ios::binary);
  if (error || !stream_) throw UserError(file_.string() + ": cannot be read" + why_unreadable(file_));
  std::array<std::uint8_t, kMagic.size() + 4> begin{};
  if (!read(begin) || !std::equal(kMagic.begin(), kMagic.end(), begin.begin())) {
    throw UserError(file_.string() + " is no recording of coslam" + but_it_is(file_));
  }
  const std::uint32_t version = *Unpacker(std::span(begin).subspan(kMagic.size())).get<std::uint32_t>();
  if (version != kRecordingVersion) {
    throw UserError(file_.string() + " is a recording of format " + std::to_string(version) +
                    ", and this program reads format " + std::to_string(kRecordingVersion));
  }
}

std::optional<Record> RecordReader::next() {
  if (left_bytes_ == 0 || cut_off_) return std::nullopt;
  ++number_;
  std::array<std::uint8_t, kHeader_bytes + kCrc_bytes> header{};
  cut_off_ = !read(header);
  if (cut_off_) return std::nullopt;
  Unpacker in(header);
  const auto length = *in.get<std::uint32_t>();
  const auto type = *in.get<std::uint8_t>();
  const auto t_ns = *in.get<TimeNs>();
  if (*in.get<std::uint32_t>() != crc_of(std::span(header).first(kHeader_bytes))) fail("is damaged");
  const bool possible = length <= RecordWriter::kMostPayload_bytes &&
                        type <= static_cast<std::uint8_t>(RecordType::kEnd) && t_ns >= last_ns_ && t_ns <= kLongest_ns;
  if (!possible) fail("is not one that coslam writes");
  Record record{static_cast<RecordType>(type), t_ns, {}};
  cut_off_ = left_bytes_ < length + kCrc_bytes;
  if (cut_off_) return std::nullopt;
  record.payload.resize(length);
  std::array<std::uint8_t, kCrc_bytes> crc{};
  cut_off_ = !read(record.payload) || !read(crc);
  if (cut_off_) return std::nullopt;
  if (*Unpacker(crc).get<std::uint32_t>() != crc_of(record.payload)) fail("is damaged");
  last_ns_ = t_ns;
  return record;
}

void RecordReader::fail(const std::string& reason) const {
  throw UserError(file_.string() + ": record " + std::to_string(number_) + ", " + format_seconds(last_ns_) +
                  " s after the beginning, " + reason);
}

bool RecordReader::read(std::span<std::uint8_t> octets) {
  if (left_bytes_ < octets.size()) return false;
  stream_.read(reinterpret_cast<char*>(octets.data()), static_cast<std::streamsize>(octets.size()));
  left_bytes_ -= octets.size();
  return static_cast<bool>(stream_);
}

}  // namespace coslam
