// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A recording, as `coslam replay` takes it. The first octet says whether its check sums are put right first, which the
// fuzzer would not find.
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

#include "server/app/recorded_config.h"
#include "server/fleet/record/recording.h"
#include "tests/fuzz/fuzzer.h"
#include "tests/support/temp_folder.h"
#include "tests/support/wire_values.h"

namespace coslam {
namespace {

constexpr std::size_t kBegin = 12, kHead = 13, kCrc = 4;  // octets, see recording_file.h

void put_crc(std::string& file, std::size_t at, std::size_t size) {
  const auto crc = static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(file.data() + at), size));
  std::memcpy(file.data() + at + size, &crc, kCrc);
}

std::string with_right_check_sums(std::string file) {
  for (std::size_t at = kBegin; at + kHead + kCrc <= file.size();) {
    std::uint32_t length = 0;
    std::memcpy(&length, file.data() + at, sizeof length);
    put_crc(file, at, kHead);
    at += kHead + kCrc;
    if (length > file.size() - at || file.size() - at - length < kCrc) break;
    put_crc(file, at, length);
    at += length + kCrc;
  }
  return file;
}

std::string written(const std::vector<Record>& records) {
  const test::TempFolder folder;
  const auto path = folder / "a.rec";
  {
    RecordWriter writer(path);
    for (const Record& record : records) writer.write(record);
  }
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

void fuzz::try_octets(Octets octets) {
  if (octets.empty()) return;
  const std::string content(text_of(octets.subspan(1)));
  const auto file = file_of(octets[0] % 2 == 0 ? content : with_right_check_sums(content));
  recorded_config(check_recording(file).head, file);
}

void fuzz::write_seeds(const WriteSeed& write) {
  test::WireValues values(1);
  const TrackFrame frame = values.frame("cam0", RunId(1), 5, 3);
  const Record head = encode_head({"1", RunId(1), 5, 6, {{"server", {{"sigma_px", 3.0}}}}});
  const Record hello = encode_event(values.hello("cam0", RunId(1)), 10);
  const Record end{RecordType::kEnd, 40, {}};
  write("frames",
        "\1" + written({head, hello, encode_event(JoinedFrame{frame, values.patches(frame, 1), {}}, 20), end}));
  AgentStatus last = values.agent_status("cam0", RunId(1), AgentState::kFinished);
  last.last_image = values.descriptors(frame, 2);
  write("status", "\1" + written({head, hello, encode_event(last, 20), encode_event(AgentSilent{"cam0", RunId(1)}, 30),
                                  encode_event(AgentGone{"cam0", RunId(1)}, 30), end}));
  write("cut_off", std::string(1, '\0') + written({head, hello}));
}

}  // namespace coslam
