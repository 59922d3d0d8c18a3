// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <utility>
#include <vector>

#include "agent/capture/decode.h"
#include "agent/capture/sources.h"
#include "common/base/error.h"
#include "common/base/log.h"

namespace coslam {
namespace {

// Images in files, with times known beforehand.
class ListSource final : public ImageSource {
 public:
  // frames: those to play, with played times.
  ListSource(const std::string& name, std::vector<ListedFrame> frames, const SourceOptions& options)
      : frames_(std::move(frames)), color_(options.color) {
    // The first readable image tells the size; it is kept for its turn.
    for (first_ = 0; first_ < frames_.size(); ++first_) {
      first_image_ = reader_.read(frames_[first_].file);
      if (!first_image_.empty()) break;
    }
    if (first_image_.empty()) {
      const auto& first = frames_.front().file;
      throw UserError(name + ": none of the " + std::to_string(frames_.size()) + " images can be read, the first is " +
                      first.string() + (std::filesystem::exists(first) ? "" : ", which is not there"));
    }
    require_size(first_image_, options, frames_[first_].file.string());
    size_ = first_image_.size();
    if (const std::string note = reader_.bit_depth_note(); !note.empty()) log_info(name + ": " + note);
  }

  std::optional<Image> next() override {
    if (position_ >= frames_.size()) return std::nullopt;
    const std::size_t i = position_++;
    Image image{FrameId(static_cast<std::uint32_t>(i)), frames_[i].source_ns,
                i == first_ ? std::exchange(first_image_, {}) : reader_.read(frames_[i].file)};
    image.fault = size_fault(image.grey, size_);
    if (image.fault == ImageFault::kNone && color_) image.color = read_color(frames_[i].file);
    if (image.fault != ImageFault::kNone && log_.pass()) {
      log_warn(frames_[i].file.string() +
               (!image.grey.empty()                        ? " has not the size of the first image"
                : std::filesystem::exists(frames_[i].file) ? " cannot be read"
                                                           : " is not there") +
               "; passed over");
    }
    return image;
  }

  bool skip() override {
    if (position_ >= frames_.size()) return false;
    if (position_++ == first_) first_image_.release();
    return true;
  }

  std::optional<TimeNs> peek_ns() const override {
    return position_ < frames_.size() ? std::optional(frames_[position_].source_ns) : std::nullopt;
  }

  std::filesystem::path peek_file() const override {
    return position_ < frames_.size() ? frames_[position_].file : std::filesystem::path();
  }

 private:
  std::vector<ListedFrame> frames_;
  bool color_;
  GreyReader reader_;
  std::size_t position_ = 0;
  std::size_t first_ = 0;
  cv::Mat first_image_;
  cv::Size size_;
  LogLimiter log_;
};

}  // namespace

std::unique_ptr<ImageSource> open_list(const std::string& name, FrameList list, const SourceOptions& options) {
  for (const std::string& guess : list.guesses) log_warn(guess);
  std::vector<ListedFrame>& frames = list.frames;
  const PlayedSpan span(options);
  std::erase_if(frames, [&](const ListedFrame& f) { return span.before(f.source_ns) || span.after(f.source_ns); });
  for (ListedFrame& frame : frames) frame.source_ns = span.played_ns(frame.source_ns);
  if (frames.empty()) throw UserError(name + ": no image lies in the time span that start_s and duration_s ask for");
  return std::make_unique<ListSource>(name, std::move(frames), options);
}

}  // namespace coslam
