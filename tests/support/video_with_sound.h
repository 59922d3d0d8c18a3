// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

extern "C" {
#include <libavformat/avformat.h>
}

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace coslam::test {

// Copies the images of a video into a Matroska or QuickTime file, with sound beside them as 16 bit samples and notes in
// its head, as phones write them.
inline void add_sound(const std::filesystem::path& video, const std::filesystem::path& to,
                      const std::vector<float>& samples, int rate_hz, double sound_later_s = 0,
                      const std::vector<std::pair<std::string, std::string>>& notes = {}) {
  const auto ensure = [](bool ok) {
    if (!ok) throw std::runtime_error("cannot write a video with sound");
  };
  AVFormatContext *in = nullptr, *out = nullptr;
  ensure(avformat_open_input(&in, video.c_str(), nullptr, nullptr) == 0 && avformat_find_stream_info(in, nullptr) >= 0);
  ensure(avformat_alloc_output_context2(&out, nullptr, nullptr, to.c_str()) >= 0);
  for (const auto& [key, value] : notes) av_dict_set(&out->metadata, key.c_str(), value.c_str(), 0);
  AVStream* images = avformat_new_stream(out, nullptr);
  avcodec_parameters_copy(images->codecpar, in->streams[0]->codecpar);
  images->codecpar->codec_tag = 0;
  images->time_base = in->streams[0]->time_base;
  AVStream* sound = nullptr;
  if (!samples.empty()) {
    sound = avformat_new_stream(out, nullptr);
    sound->codecpar->codec_type = AVMEDIA_TYPE_AUDIO;
    sound->codecpar->codec_id = AV_CODEC_ID_PCM_S16LE;
    sound->codecpar->format = AV_SAMPLE_FMT_S16;
    sound->codecpar->sample_rate = rate_hz;
    sound->codecpar->bits_per_coded_sample = 16;
    sound->codecpar->block_align = 2;
    av_channel_layout_default(&sound->codecpar->ch_layout, 1);
    sound->time_base = {1, rate_hz};
  }
  ensure(avio_open(&out->pb, to.c_str(), AVIO_FLAG_WRITE) >= 0);
  AVDictionary* options = nullptr;
  av_dict_set(&options, "movflags", "use_metadata_tags", 0);
  ensure(avformat_write_header(out, &options) >= 0);
  av_dict_free(&options);
  AVPacket* packet = av_packet_alloc();
  while (av_read_frame(in, packet) >= 0) {
    packet->stream_index = 0;
    av_packet_rescale_ts(packet, in->streams[0]->time_base, images->time_base);
    ensure(av_interleaved_write_frame(out, packet) >= 0);
  }
  constexpr std::size_t kBlock = 1024;
  for (std::size_t at = 0; at < samples.size(); at += kBlock) {
    const std::size_t n = std::min(kBlock, samples.size() - at);
    ensure(av_new_packet(packet, static_cast<int>(2 * n)) >= 0);
    for (std::size_t i = 0; i < n; ++i) {
      const auto value = static_cast<std::int16_t>(std::clamp(samples[at + i], -1.0F, 1.0F) * 32000);
      packet->data[2 * i] = static_cast<std::uint8_t>(value & 0xff);
      packet->data[2 * i + 1] = static_cast<std::uint8_t>((value >> 8) & 0xff);
    }
    packet->stream_index = 1;
    packet->pts = packet->dts = static_cast<std::int64_t>(at) + static_cast<std::int64_t>(sound_later_s * rate_hz);
    packet->duration = static_cast<std::int64_t>(n);
    av_packet_rescale_ts(packet, {1, rate_hz}, sound->time_base);
    ensure(av_interleaved_write_frame(out, packet) >= 0);
  }
  av_packet_free(&packet);
  ensure(av_write_trailer(out) >= 0);
  avio_closep(&out->pb);
  avformat_free_context(out);
  avformat_close_input(&in);
}

}  // namespace coslam::test
