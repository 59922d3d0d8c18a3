// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <deque>
#include <utility>

#include "agent/capture/fields.h"
#include "agent/capture/sources.h"
#include "common/base/log.h"
#include "common/dataset/sequence.h"

namespace coslam {
namespace {

// Of interlaced images the rows of the first field. Images are read ahead until it is known whether they are, so that
// the first ones are treated so too; those of a live source are not held back.
class OneFieldSource final : public ImageSource {
 public:
  OneFieldSource(std::unique_ptr<ImageSource> source, std::string name)
      : source_(std::move(source)), name_(std::move(name)), ahead_(source_->live() ? 1 : kAhead) {}

  std::optional<Image> next() override {
    const std::size_t ahead = order_ == Fields::kUnknown ? ahead_ : 1;
    while (held_.size() < ahead && hold()) {
    }
    if (held_.empty()) return std::nullopt;
    Image image = std::move(held_.front());
    held_.pop_front();
    if (order_ == Fields::kUpperFirst || order_ == Fields::kLowerFirst) {
      for (cv::Mat* pixels : {&image.grey, &image.color}) {
        *pixels = pixels->clone();  // others may have it
        keep_first_field(*pixels, order_);
      }
    }
    return image;
  }
  bool skip() override {
    if (held_.empty()) return source_->skip();
    held_.pop_front();
    return true;
  }
  std::optional<TimeNs> peek_ns() const override {
    return held_.empty() ? source_->peek_ns() : std::optional(held_.front().capture_ns);
  }
  std::filesystem::path peek_file() const override {
    return held_.empty() ? source_->peek_file() : std::filesystem::path();
  }
  std::optional<int> about_left() const override {
    const auto left = source_->about_left();
    return left ? std::optional(*left + static_cast<int>(held_.size())) : left;
  }
  bool live() const override { return source_->live(); }
  std::size_t undated() const override { return source_->undated(); }
  void stop() override { source_->stop(); }

 private:
  static constexpr std::size_t kAhead = 6;

  // False at the end.
  bool hold() {
    auto image = source_->next();
    if (!image) return false;
    if (order_ == Fields::kUnknown && image->fault == ImageFault::kNone) note(image->grey);
    held_.push_back(std::move(*image));
    return true;
  }

  void note(const cv::Mat& grey) {
    order_ = fields_.note(grey);
    if (order_ == Fields::kUnknown || order_ == Fields::kNone) return;
    log_warn(shown_source(name_) + ": its images are interlaced, the " +
             (order_ == Fields::kUpperFirst ? "upper" : "lower") +
             " field first: of each every second row is used, those of that field");
  }

  std::unique_ptr<ImageSource> source_;
  const std::string name_;
  const std::size_t ahead_;
  std::deque<Image> held_;
  FieldOrder fields_;
  Fields order_ = Fields::kUnknown;
};

}  // namespace

std::unique_ptr<ImageSource> of_one_field(std::unique_ptr<ImageSource> source, std::string name) {
  return std::make_unique<OneFieldSource>(std::move(source), std::move(name));
}

}  // namespace coslam
