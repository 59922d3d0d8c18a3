// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <cmath>
#include <fstream>
#include <limits>
#include <opencv2/core.hpp>
#include <utility>

#include "agent/capture/decode.h"
#include "agent/capture/encodings.h"
#include "agent/capture/ros2_topic.h"
#include "agent/capture/sources.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/flow/clock.h"
#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/sensor_messages.h"
#include "common/ros/type.h"

namespace coslam {
namespace {

constexpr double kOneClock_s = 10;  // from a stamp to when its image came

// A message as it is read where it lies: an image of pixels is grey afterwards, a compressed one still what it is.
struct Heard {
  bool whole = false;
  TimeNs stamp_ns = 0, came_ns = 0;
  std::size_t octets = 0;
  cv::Mat grey;  // of 8 or 16 bits
  std::string encoding;
  std::vector<std::uint8_t> compressed;
};

void read_image(std::span<const std::uint8_t> octets, GreyReader* reader, Heard* heard) {
  const auto image = ros::from_cdr<ros::ImageView>(octets);
  if (!image) return;
  heard->whole = true;
  heard->stamp_ns = ros::ns_of(image->header.stamp);
  heard->encoding = image->encoding;
  heard->grey = reader->decode(RawImage{.width_px = image->width,
                                        .height_px = image->height,
                                        .encoding = image->encoding,
                                        .big_endian = image->is_bigendian != 0,
                                        .octets_per_row = image->step,
                                        .octets = image->data});
}

void read_compressed(std::span<const std::uint8_t> octets, Heard* heard) {
  auto image = ros::from_cdr<ros::CompressedImage>(octets);
  if (!image) return;
  heard->whole = true;
  heard->stamp_ns = ros::ns_of(image->header.stamp);
  heard->compressed = std::move(image->data);
}

// Where the system's socket buffers have no room for two images: what to do.
std::string buffers_too_small(std::size_t image_octets) {
  constexpr std::size_t kAdvised = 32U << 20U;
  std::size_t most = 0;
  std::ifstream("/proc/sys/net/core/rmem_max") >> most;
  if (most == 0 || most >= 2 * image_octets) return {};
  return ": the system's socket buffers hold " + std::to_string(most) + " octets, its images have " +
         std::to_string(image_octets) + "; 'sysctl -w net.core.rmem_max=" + std::to_string(kAdvised) +
         "' makes them larger";
}

// Images as they come; what waits for long in the middleware makes room for newer ones.
class Ros2Source final : public ImageSource {
 public:
  Ros2Source(const std::string& name, const SourceOptions& options)
      : name_(name),
        duration_s_(options.duration_s),
        topic_(name, {ros::type_text<ros::Image>().name, ros::type_text<ros::CompressedImage>().name}, "Image"),
        compressed_(topic_.type() == ros::type_text<ros::CompressedImage>().name) {
    const auto until = std::chrono::steady_clock::now() + Ros2Topic::kPatience;
    std::optional<Heard> first;
    while (!first || first->grey.empty()) {
      if (auto heard = hear()) first = std::move(heard);
      if (std::chrono::steady_clock::now() > until) throw UserError(name_ + ": " + no_image(first));
    }
    require_size(first->grey, options, "the image of '" + name_ + "'");
    size_ = first->grey.size();
    missed_said_ = topic_.missed();  // those before it do not count
    if (const std::string note = grey_.bit_depth_note(); !note.empty()) log_info(name_ + ": " + note);
    warn_of_clock(*first);
  }

  std::optional<Image> next() override {
    if (!first_ns_) first_ns_ = utc_now_ns();
    while (!stopped_ && !ended_) {
      std::optional<Heard> heard = hear();
      ended_ = duration_s_ && utc_now_ns() - *first_ns_ >= to_ns(*duration_s_);
      if (!heard || ended_) continue;
      say_missed(heard->octets);
      if (heard->whole && heard->stamp_ns <= last_ns_) {
        ++undated_;
        warn("an image whose stamp is not later than that of the one before is passed over");
        continue;
      }
      if (heard->whole) last_ns_ = heard->stamp_ns;
      Image image{FrameId(frame_++), heard->stamp_ns, std::move(heard->grey)};
      image.fault = size_fault(image.grey, size_);
      if (image.fault != ImageFault::kNone) warn("an image that cannot be read, or of another size, is left out");
      return image;
    }
    return std::nullopt;
  }

  bool skip() override { return next().has_value(); }
  std::optional<TimeNs> peek_ns() const override { return std::nullopt; }
  bool live() const override { return true; }
  std::size_t undated() const override { return undated_; }
  void stop() override { stopped_ = true; }

 private:
  // The next message, if one comes soon.
  std::optional<Heard> hear() {
    Heard heard;
    const auto came_ns = topic_.take([&](std::span<const std::uint8_t> octets) {
      heard.octets = octets.size();
      compressed_ ? read_compressed(octets, &heard) : read_image(octets, &grey_, &heard);
    });
    if (!came_ns) return std::nullopt;
    heard.came_ns = utc_now_ns();
    heard.grey = compressed_ ? grey_.decode(heard.compressed) : grey_.in_8_bits(heard.grey);
    if (heard.stamp_ns == 0) {
      if (heard.whole && !std::exchange(unstamped_, true))
        log_warn(name_ + ": images without a stamp count as of when they come");
      heard.stamp_ns = heard.came_ns;
      return heard;
    }
    // Stamps of this machine follow when its time of day is set, ours do not.
    const TimeNs unset_ns = heard.stamp_ns - clock_set_ns();
    if (std::abs(unset_ns - heard.came_ns) < std::abs(heard.stamp_ns - heard.came_ns)) heard.stamp_ns = unset_ns;
    return heard;
  }

  void warn_of_clock(const Heard& heard) const {
    const double off_s = to_seconds(heard.stamp_ns - heard.came_ns);
    if (std::abs(off_s) < kOneClock_s) return;
    log_warn(name_ + ": its stamps are " + format_double(std::round(std::abs(off_s))) + " s " +
             (off_s < 0 ? "behind" : "ahead of") + " this machine's clock");
  }

  std::string no_image(const std::optional<Heard>& heard) const {
    if (!heard) return topic_.why_silent();
    std::string problem = "no image came that can be read";
    if (heard->encoding.empty() || is_known_encoding(heard->encoding)) return problem;
    return problem + "; " + why_not_grey({.encoding = heard->encoding});
  }

  void warn(const char* problem) {
    if (log_.pass()) log_warn(name_ + ": " + problem);
  }

  void say_missed(std::size_t image_octets) {
    const std::uint64_t missed = topic_.missed();
    if (missed == missed_said_ || !missed_log_.pass()) return;
    log_warn(name_ + ": " + std::to_string(missed - missed_said_) +
             " images were lost, on the way or while this machine was busy" + buffers_too_small(image_octets));
    missed_said_ = missed;
  }

  const std::string name_;
  const std::optional<double> duration_s_;
  Ros2Topic topic_;
  const bool compressed_;
  GreyReader grey_;
  cv::Size size_;
  std::optional<TimeNs> first_ns_;
  TimeNs last_ns_ = std::numeric_limits<TimeNs>::min();
  std::uint32_t frame_ = 0;
  std::size_t undated_ = 0;
  std::uint64_t missed_said_ = 0;
  bool ended_ = false, unstamped_ = false;
  LogLimiter log_, missed_log_;
  std::atomic<bool> stopped_ = false;
};

}  // namespace

std::unique_ptr<ImageSource> open_ros2(const std::string& uri, const SourceOptions& options) {
  return std::make_unique<Ros2Source>(uri, options);
}

}  // namespace coslam
