// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "agent/capture/decode.h"
#include "agent/capture/encodings.h"
#include "agent/capture/sources.h"
#include "agent/capture/video_packets.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/dataset/recorded_topic.h"
#include "common/recording/message_reader.h"

namespace coslam {
namespace {

// The images of one topic. One is read ahead, because only reading tells whether there is another.
class RecordedSource final : public ImageSource {
 public:
  RecordedSource(const std::string& uri, const SourceOptions& options)
      : name_(uri),
        topic_(recorded_topic(uri)),
        recording_(recording::open(topic_.path)),
        place_(find_topic(*recording_, topic_, Wanted::kImages)),
        reader_(recording::MessageReader::of(recording_->topics()[place_]).value()),
        span_(options) {
    if (!recording_->warning().empty()) log_warn(recording_->warning());
    recording_->play(place_);
    advance();
    while (ahead_ && span_.before(ahead_->t_ns)) advance();
    while (ahead_ && decoded().empty()) drop_unreadable();
    if (!ahead_) throw UserError(uri + ": there is no image in the time span asked for that can be read" + hint_);
    require_size(decoded(), options, uri);
    size_ = decoded().size();
    if (const std::string said = grey_.said(); !said.empty()) log_info(uri + ": " + said);
  }

  std::optional<Image> next() override {
    if (!ahead_) return std::nullopt;
    Image image{FrameId(frame_++), span_.played_ns(ahead_->t_ns), decoded()};
    image.fault = size_fault(image.grey, size_);
    if (image.fault != ImageFault::kNone) warn_unreadable();
    advance();
    return image;
  }

  bool skip() override {
    if (!ahead_) return false;
    ++frame_;
    advance();
    return true;
  }

  std::optional<TimeNs> peek_ns() const override {
    return ahead_ ? std::optional(span_.played_ns(ahead_->t_ns)) : std::nullopt;
  }
  std::size_t undated() const override { return undated_; }

 private:
  struct Ahead {
    TimeNs t_ns = 0;  // source time
    std::string octets;
    std::optional<cv::Mat> grey;  // once it was decoded
  };

  // Images count from the start of the recording, so that those of several topics keep their time. A stamp that is far
  // from when it was noted is of another clock, and counts from its own first.
  TimeNs source_ns(TimeNs stamp_ns, TimeNs noted_ns) {
    constexpr double kOneClock_s = 10, kUnderWay_s = 0.1;  // from its stamp until it was noted
    if (!by_stamps_) {
      by_stamps_ = stamp_ns != 0;
      const bool one_clock = std::abs(to_seconds(stamp_ns - noted_ns)) < kOneClock_s;
      zero_ns_ = one_clock || !*by_stamps_ ? recording_->first_ns() - to_ns(kUnderWay_s) : stamp_ns;
    }
    return (*by_stamps_ ? stamp_ns : noted_ns) - zero_ns_;
  }

  void advance() {
    ahead_.reset();
    while (auto message = next_message()) {
      // Of a video all are decoded, as each needs those before.
      std::optional<cv::Mat> grey;
      if (is_video(message->octets)) grey = frame_of(message->octets);
      const auto stamp_ns = reader_.stamp_ns(message->octets);
      const TimeNs t_ns = stamp_ns ? source_ns(*stamp_ns, message->noted_ns) : last_ns_;
      if (!stamp_ns || t_ns <= last_ns_) {
        ++undated_;
        if (log_.pass()) log_warn(name_ + ": an image without a stamp, or with one that is not later; passed over");
        continue;
      }
      last_ns_ = t_ns;
      if (!span_.after(t_ns)) ahead_ = Ahead{t_ns, std::move(message->octets), std::move(grey)};
      return;
    }
  }

  // What is damaged further on ends the source; at its start it is said to the user.
  std::optional<recording::Message> next_message() {
    try {
      auto message = recording_->next();
      if (message) message->octets = reader_.unpacked(std::move(message->octets));
      return message;
    } catch (const UserError& e) {
      if (size_.empty()) throw;
      log_warn(e.what());
      return std::nullopt;
    }
  }

  // By the first message of the topic that can be read.
  bool is_video(const std::string& message) {
    if (reader_.kind() != recording::MessageKind::kCompressedImage || asked_for_video_) return video_ != nullptr;
    if (const auto image = reader_.compressed_image(message)) {
      asked_for_video_ = true;
      video_ = VideoPackets::of(image->format);
    }
    return video_ != nullptr;
  }

  cv::Mat frame_of(const std::string& message) {
    const auto packet = reader_.compressed_image(message);
    return packet ? grey_.in_8_bits(video_->decode(packet->data)) : cv::Mat();
  }

  const cv::Mat& decoded() {
    if (!ahead_->grey) ahead_->grey = decode(ahead_->octets);
    return *ahead_->grey;
  }

  cv::Mat decode(const std::string& message) {
    if (reader_.kind() == recording::MessageKind::kCompressedImage) {
      const auto image = reader_.compressed_image(message);
      if (!image) return {};
      cv::Mat grey = grey_.decode(image->data);
      if (grey.empty()) hint_ = "; its format is " + (image->format.empty() ? "not named" : image->format);
      return grey;
    }
    const auto image = reader_.image(message);
    if (!image) return {};
    if (!is_known_encoding(image->encoding)) {
      hint_ = "; its encoding is " + image->encoding + ", known are " + known_encodings();
    }
    return grey_.in_8_bits(grey_of({.width_px = image->width,
                                    .height_px = image->height,
                                    .encoding = image->encoding,
                                    .big_endian = image->is_bigendian != 0,
                                    .octets_per_row = image->step,
                                    .octets = image->data}));
  }

  void drop_unreadable() {
    ++frame_;
    warn_unreadable();
    advance();
  }
  void warn_unreadable() {
    if (log_.pass()) log_warn(name_ + ": an image that cannot be read, or of another size, is left out");
  }

  const std::string name_;
  const RecordedTopic topic_;
  const std::unique_ptr<recording::Recording> recording_;
  const std::size_t place_;  // of the topic in the recording
  const recording::MessageReader reader_;
  PlayedSpan span_;
  GreyReader grey_;
  bool asked_for_video_ = false;
  std::unique_ptr<VideoPackets> video_;  // null: each image stands for itself
  std::optional<bool> by_stamps_;
  TimeNs zero_ns_ = 0, last_ns_ = std::numeric_limits<TimeNs>::min();
  std::optional<Ahead> ahead_;
  std::uint32_t frame_ = 0;
  cv::Size size_;
  std::string hint_;
  std::size_t undated_ = 0;
  LogLimiter log_;
};

}  // namespace

std::unique_ptr<ImageSource> open_recorded(const std::string& uri, const SourceOptions& options) {
  return std::make_unique<RecordedSource>(uri, options);
}

}  // namespace coslam
