// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "agent/capture/decode.h"
#include "agent/capture/encodings.h"
#include "agent/capture/recorded_clock.h"
#include "agent/capture/sources.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/dataset/recorded_topic.h"
#include "common/image/image_file.h"
#include "common/recording/message_reader.h"
#include "common/video/video_packets.h"

namespace coslam {
namespace {

using ReadMessage = std::function<std::optional<recording::Message>()>;

// The first messages of a topic, and their times, which tell its clock.
struct FirstMessages {
  std::deque<recording::Message> messages;
  std::vector<RecordedTime> times;
};

FirstMessages first_messages(const recording::MessageReader& reader, const ReadMessage& read) {
  constexpr std::size_t kMessages = 32, kOctets = 64U << 20U;
  FirstMessages out;
  std::size_t octets = 0;
  while (out.messages.size() < kMessages && octets < kOctets) {
    auto message = read();
    if (!message) break;
    octets += message->octets.size();
    if (const auto stamp_ns = reader.stamp_ns(message->octets)) out.times.push_back({*stamp_ns, message->noted_ns});
    out.messages.push_back(std::move(*message));
  }
  return out;
}

// The images of one topic. One is read ahead, because only reading tells whether there is another.
class RecordedSource final : public ImageSource {
 public:
  RecordedSource(const std::string& uri, const SourceOptions& options)
      : name_(uri),
        topic_(recorded_topic(uri)),
        recording_(recording::open(topic_.path)),
        place_(find_topic(*recording_, topic_, Wanted::kImages)),
        reader_(recording::MessageReader::for_topic(recording_->topics()[place_]).value()),
        span_(options) {
    if (!recording_->warning().empty()) log_warn(recording_->warning());
    recording_->play(place_);
    look_ahead();
    advance();
    while (ahead_ && span_.before(ahead_->t_ns)) advance();
    while (ahead_ && decoded().empty()) drop_unreadable();
    if (!ahead_) throw UserError(uri + ": there is no image in the time span asked for that can be read" + hint_);
    require_size(decoded(), options, uri);
    size_ = decoded().size();
    if (const std::string note = grey_.bit_depth_note(); !note.empty()) log_info(uri + ": " + note);
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

  // The first messages tell which of their times count.
  void look_ahead() {
    FirstMessages first = first_messages(reader_, [this] { return read_message(); });
    read_ahead_ = std::move(first.messages);
    clock_ = recorded_clock(name_, first.times, recording_->first_ns());
    for (const std::string& guess : clock_.guesses) log_warn(guess);
  }

  // The next image by time. Recorders write some in another order than they were taken.
  void advance() {
    constexpr std::size_t kOutOfOrder = 4;
    ahead_.reset();
    while (true) {
      while (waiting_.size() < kOutOfOrder && take_message()) {
      }
      if (waiting_.empty()) return say_undated();
      const auto earliest = std::ranges::min_element(waiting_, {}, &Ahead::t_ns);
      Ahead next = std::move(*earliest);
      waiting_.erase(earliest);
      if (next.t_ns <= last_ns_) {
        ++undated_;
        continue;
      }
      last_ns_ = next.t_ns;
      if (span_.after(next.t_ns)) return say_undated();
      ahead_ = std::move(next);
      return;
    }
  }

  // False at the end.
  bool take_message() {
    auto message = next_message();
    if (!message) return false;
    // Of a video all are decoded, as each needs those before.
    std::optional<cv::Mat> grey;
    if (is_video(message->octets)) grey = frame_of(message->octets);
    const auto stamp_ns = reader_.stamp_ns(message->octets);
    if (!stamp_ns || (clock_.by_stamps && *stamp_ns == 0)) {
      ++undated_;
    } else {
      waiting_.push_back(
          {clock_.source_ns({*stamp_ns, message->noted_ns}), std::move(message->octets), std::move(grey)});
    }
    return true;
  }

  void say_undated() {
    if (undated_ == undated_said_) return;
    undated_said_ = undated_;
    log_warn(name_ + ": of its images " + std::to_string(undated_) +
             " had no stamp, or one that is not later than that of the one before; left out");
  }

  std::optional<recording::Message> next_message() {
    if (read_ahead_.empty()) return read_message();
    auto message = std::move(read_ahead_.front());
    read_ahead_.pop_front();
    return message;
  }

  // What is damaged further on ends the source; at its start it is said to the user.
  std::optional<recording::Message> read_message() {
    if (ended_) return std::nullopt;
    std::optional<recording::Message> message;
    try {
      message = recording_->next();
      if (message) message->octets = reader_.unpacked(std::move(message->octets));
    } catch (const UserError& e) {
      if (!any_read_) throw;
      log_warn(e.what());
      message.reset();
    }
    any_read_ = true;
    ended_ = !message;
    return message;
  }

  // By the first message of the topic that can be read.
  bool is_video(const std::string& message) {
    if (reader_.kind() != recording::MessageKind::kCompressedImage || asked_for_video_) return video_ != nullptr;
    if (const auto image = reader_.compressed_image(message)) {
      asked_for_video_ = true;
      video_ = VideoPackets::for_codec(image->format);
    }
    return video_ != nullptr;
  }

  cv::Mat frame_of(const std::string& message) {
    const auto packet = reader_.compressed_image(message);
    return packet ? grey_.in_8_bits(mat_of(video_->decode(packet->data))) : cv::Mat();
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
    const RawImage raw{.width_px = image->width,
                       .height_px = image->height,
                       .encoding = image->encoding,
                       .big_endian = image->is_bigendian != 0,
                       .octets_per_row = image->step,
                       .octets = image->data};
    cv::Mat grey = grey_.decode(raw);
    if (grey.empty()) hint_ = "; " + why_not_grey(raw);
    return grey_.in_8_bits(grey);
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
  bool any_read_ = false, ended_ = false;
  std::deque<recording::Message> read_ahead_;
  RecordedClock clock_;
  std::vector<Ahead> waiting_;  // for those that were taken before them
  TimeNs last_ns_ = std::numeric_limits<TimeNs>::min();
  std::optional<Ahead> ahead_;
  std::uint32_t frame_ = 0;
  cv::Size size_;
  std::string hint_;
  std::size_t undated_ = 0, undated_said_ = 0;
  LogLimiter log_;
};

}  // namespace

TimeNs recorded_zero_ns(const std::string& uri) {
  constexpr TimeNs kHour_ns = 3'600'000'000'000;
  const RecordedTopic topic = recorded_topic(uri);
  const auto recording = recording::open(topic.path);
  const std::size_t place = find_topic(*recording, topic, Wanted::kImages);
  const auto reader = recording::MessageReader::for_topic(recording->topics()[place]).value();
  recording->play(place);
  const FirstMessages first = first_messages(reader, [&] {
    auto message = recording->next();
    if (message) message->octets = reader.unpacked(std::move(message->octets));
    return message;
  });
  const TimeNs zero_ns = recorded_clock(uri, first.times, recording->first_ns()).zero_ns;
  return zero_ns > kHour_ns ? zero_ns : 0;
}

std::unique_ptr<ImageSource> open_recorded(const std::string& uri, const SourceOptions& options) {
  return std::make_unique<RecordedSource>(uri, options);
}

}  // namespace coslam
