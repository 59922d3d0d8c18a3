// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A recording in MCAP as a source: all of its images are read, or it is refused with a sentence.
#include <cstring>
#include <string>

#include "agent/capture/source.h"
#include "common/compression/compression.h"
#include "common/mcap/writer.h"
#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/sensor_messages.h"
#include "common/ros/type.h"
#include "tests/fuzz/fuzzer.h"

namespace coslam {
namespace {

// With 0 for every check sum, which says that there is none: they would hold the fuzzer up.
std::string without_check_sums(std::string file) {
  constexpr std::size_t kInChunk = 24, kInFooter = 16;  // where they are
  for (std::size_t at = mcap::kMagic.size(); at + mcap::kRecordHead < file.size();) {
    const auto opcode = static_cast<mcap::Opcode>(file[at]);
    std::uint64_t length = 0;
    std::memcpy(&length, file.data() + at + 1, sizeof length);
    at += mcap::kRecordHead;
    if (opcode == mcap::Opcode::kChunk) file.replace(at + kInChunk, 4, 4, '\0');
    if (opcode == mcap::Opcode::kFooter) file.replace(at + kInFooter, 4, 4, '\0');
    at += length;
    if (opcode == mcap::Opcode::kFooter) break;
  }
  return file;
}

// A few images of three by two pixels.
template <class Message>
std::string recorded(const Message& message, bool whole = true,
                     mcap::Compression compression = mcap::Compression::kNone) {
  const ros::TypeText& type = ros::type_text<Message>();
  std::string octets;
  mcap::Writer writer([&](std::string_view more) { octets += more; }, {.compression = compression, .chunk_bytes = 300});
  const auto channel = writer.add_channel("/image", "cdr", writer.add_schema(type.name, "ros2msg", ""));
  for (int i = 1; i <= 3; ++i) {
    Message dated = message;
    dated.header = ros::header_of(to_ns(i), "left");
    writer.write(channel, to_ns(i), ros::to_cdr(dated));
  }
  if (whole) writer.close();
  return without_check_sums(octets);
}

}  // namespace

void fuzz::try_octets(Octets octets) {
  const auto source = open_source("mcap:" + file_of(text_of(octets)).string(), {});
  while (source->peek_ns()) source->next();
}

void fuzz::write_seeds(const WriteSeed& write) {
  ros::Image image;
  image.width = 3;
  image.height = 2;
  image.encoding = "mono8";
  image.step = 4;
  image.data.assign(8, 100);
  write("image", recorded(image));
  write("image_packed", recorded(image, true, mcap::Compression::kZstd));
  write("image_cut_off", recorded(image, false));
  write("image_in_zstd", zstd_compressed(recorded(image)));
  ros::CompressedImage compressed;
  compressed.format = "pgm";
  for (const char c : std::string("P5 3 2 255\nabcdef")) compressed.data.push_back(static_cast<std::uint8_t>(c));
  write("compressed", recorded(compressed));
}

}  // namespace coslam
