// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <string_view>

#include "common/base/error.h"
#include "common/dataset/file.h"
#include "deploy/coslam/export/export.h"
#include "deploy/coslam/export/result_snapshots.h"
#include "server/show/mcap_sink.h"
#include "server/show/publish/publisher.h"

namespace coslam::exporting {

void write_mcap(const ResultContents& contents, const std::function<void(std::string_view)>& out) {
  ResultSnapshots snapshots(contents);
  McapSink sink(out);
  Publisher publisher;
  const auto announce = [&](const ChannelPtr& channel) { sink.announce(channel); };
  for (const ChannelPtr& channel : publisher.channels()) announce(channel);
  while (const auto snapshot = snapshots.next()) {
    publisher.encode(
        *snapshot, announce, [](const Channel&) { return true; },
        [&](const MessagePtr& message) { sink.put(message); });
  }
  sink.close();
}

Files export_mcap(const ResultContents& contents, const std::filesystem::path& folder) {
  OutputFile file(folder / "run.mcap", OutputFile::Shows::kWhole);
  write_mcap(contents, [&](std::string_view octets) { file.write(octets); });
  file.close();
  return {folder / "run.mcap"};
}

}  // namespace coslam::exporting
