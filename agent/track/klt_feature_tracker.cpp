// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/klt_feature_tracker.h"

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <utility>

#include "agent/track/descriptors.h"
#include "agent/track/mask.h"
#include "agent/track/tags.h"
#include "agent/track/working_scale.h"
#include "common/base/error.h"

namespace coslam {
namespace {

constexpr float kSamePx = 2.5F;  // a SIFT feature this close to a track is that track
constexpr float kNearPx = 4.0F;  // the strongest SIFT feature this close to a track tells what is there
constexpr double kSiftBorderPx = 14;

// The tracker works on images of a usual size: its windows are so many pixels, whatever they show. Places outside are
// of the raw image.
constexpr int kDarkBelow = 127;  // grey: darker is masked

cv::Mat mask_for(const CameraModel& camera, const std::string& file) {
  cv::Mat mask = read_mask(file);
  if (mask.cols != camera.width_px || mask.rows != camera.height_px) {
    throw UserError("the mask " + file + " is " + std::to_string(mask.cols) + "x" + std::to_string(mask.rows) +
                    " pixels, the camera's images are " + std::to_string(camera.width_px) + "x" +
                    std::to_string(camera.height_px));
  }
  return mask;
}

class KltFeatureTracker final : public FeatureTracker {
 public:
  KltFeatureTracker(const CameraModel& camera, const TrackerConfig& config, const std::string& tag_family,
                    std::unique_ptr<Matcher> matcher)
      : pixel_scale_(pixel_scale(camera)),
        scale_(camera.width_px, config),
        work_scale_(scale_.now()),
        config_(config),
        tracker_(config, std::move(matcher)) {
    if (tag_family != kNoTags) tag_finder_.emplace(camera, tag_family);
    if (!config.mask.empty()) mask_ = given_mask_ = mask_for(camera, config.mask);
    tracker_.set_mask(scaled_mask());
  }

  const std::vector<Track>& step(const Image& image) override {
    const cv::Mat before = std::exchange(grey_, image.grey);
    const bool compare = !before.empty() && scale_.due();
    const std::vector<Track> live_before = compare ? live_ : std::vector<Track>();
    work_ = scaled_image(grey_, work_scale_);
    tracker_.step(work_);
    refresh();
    if (compare) choose_scale(before, live_before);
    return live_;
  }
  const std::vector<Track>& live() const override { return live_; }
  double working_scale() const override { return work_scale_; }
  void leave_out(const ImageParts& parts) override {
    cv::Mat mask(parts.rows, parts.columns, CV_8UC1, cv::Scalar(255));
    for (int i = 0; i < parts.rows * parts.columns; ++i) {
      if (parts.cells[static_cast<std::size_t>(i)]) mask.at<std::uint8_t>(i / parts.columns, i % parts.columns) = 0;
    }
    cv::Mat whole;  // memory of its own
    cv::resize(mask, whole, grey_.size(), 0, 0, cv::INTER_NEAREST);
    mask_ = given_mask_.empty() ? whole : cv::Mat(whole & given_mask_);
    tracker_.set_mask(scaled_mask());
  }
  void thin(int at_most) override {
    tracker_.thin(at_most);
    refresh();
  }

  std::vector<ImagePatch> patches(const std::vector<TrackId>& tracks) override {
    const std::vector<Track> wanted = live_among(live(), tracks);
    if (wanted.empty()) return {};
    const cv::Mat small = shrink_for_patches(grey_);
    std::vector<ImagePatch> out;
    out.reserve(wanted.size());
    for (const Track& t : wanted) out.push_back(cut_patch(small, t));
    return out;
  }

  std::function<DescribedTracks()> describe_at(const std::vector<TrackId>& tracks, int most) override {
    // work_ is a new image with each step.
    return [image = work_, wanted = live_among(tracker_.live(), tracks), most] {
      std::vector<Eigen::Vector2f> places;
      places.reserve(wanted.size());
      for (const Track& t : wanted) places.push_back(t.raw_px);
      const DescribedFeatures features = describe_near(image, places, kNearPx, most, kSiftBorderPx);
      std::vector<TrackId> ids;
      for (const Eigen::Vector2f& px : features.raw_px) {
        const auto at = std::ranges::find_if(
            wanted, [&](const Track& t) { return (t.raw_px - px).squaredNorm() < kNearPx * kNearPx; });
        ids.push_back(at == wanted.end() ? TrackId() : at->id);
      }
      return by_track(features, ids);
    };
  }

  std::function<StartTracks()> describe_strongest(int most) override {
    return [this, image = work_, most] {
      return [this, image, features = describe(image, most, kSiftBorderPx)](int most_new) {
        const DescribedFeatures now = image.data == work_.data ? features : followed(features, image);
        const std::vector<TrackId> ids = tracker_.add(now.raw_px, kSamePx, most_new);
        refresh();
        return by_track(now, ids);
      };
    };
  }

  std::vector<TagObservation> tags() override {
    std::vector<TagObservation> out;
    if (!tag_finder_) return out;
    for (const FoundTag& found : tag_finder_->find(grey_)) {
      TagObservation& o = out.emplace_back();
      o.tag = found.tag;
      std::ranges::transform(found.undistorted_px, o.undistorted_px.begin(),
                             [this](const Eigen::Vector2d& px) { return quantised_px(px, pixel_scale_); });
    }
    return out;
  }

 private:
  void refresh() {
    live_ = tracker_.live();
    if (work_scale_ == 1) return;
    for (Track& t : live_) t.raw_px = scaled_px(t.raw_px, 1 / work_scale_);
  }

  // At the size that is worked at, so far from what is masked that no window reaches over it.
  cv::Mat scaled_mask() const {
    if (mask_.empty()) return {};
    constexpr int kReach_px = 8;
    const cv::Mat window = cv::getStructuringElement(cv::MORPH_RECT, cv::Size(2 * kReach_px + 1, 2 * kReach_px + 1));
    cv::Mat out;
    cv::erode(scaled_image(mask_, work_scale_), out, window);
    return out > kDarkBelow;
  }

  // Both images raw; live_before: in the one before.
  void choose_scale(const cv::Mat& before, const std::vector<Track>& live_before) {
    std::vector<MovedPlace> places;
    for (const Track& t : live_) {
      const auto was = std::ranges::lower_bound(live_before, t.id, {}, &Track::id);
      if (was == live_before.end() || was->id != t.id) continue;
      places.push_back({scaled_px(was->raw_px, scale_.finest()), scaled_px(t.raw_px, scale_.finest())});
    }
    const auto loss =
        loss_by_halving(scaled_image(before, scale_.finest()), scaled_image(grey_, scale_.finest()), places);
    if (loss) scale_.compared(*loss);
    if (scale_.now() == work_scale_) return;
    const double ratio = scale_.now() / std::exchange(work_scale_, scale_.now());
    work_ = scaled_image(grey_, work_scale_);
    tracker_.set_mask(scaled_mask());
    tracker_.resize(work_, ratio);
  }

  static std::vector<Track> live_among(const std::vector<Track>& live, const std::vector<TrackId>& ids) {
    std::vector<Track> out;
    for (const Track& t : live) {
      if (std::ranges::binary_search(ids, t.id)) out.push_back(t);
    }
    return out;
  }

  // To the newest image from an earlier one, which may have been worked on at another size; what is not found there is
  // left out.
  DescribedFeatures followed(const DescribedFeatures& features, const cv::Mat& from) const {
    TrackerConfig config = config_;
    config.max_tracks = 0;
    Tracker tracker(config, cpu_matcher(config));
    tracker.step(from);
    const std::vector<TrackId> ids = tracker.add(features.raw_px, 0, static_cast<int>(features.raw_px.size()));
    if (from.size() != work_.size())
      tracker.resize(image_of_size(from, work_.size()), static_cast<double>(work_.cols) / from.cols);
    DescribedFeatures out;
    for (const Track& t : tracker.step(work_)) {
      out.raw_px.push_back(t.raw_px);
      const auto at = std::ranges::lower_bound(ids, t.id) - ids.begin();
      const auto begin = features.descriptors.begin() + at * static_cast<std::ptrdiff_t>(kDescriptorBytes);
      out.descriptors.insert(out.descriptors.end(), begin, begin + kDescriptorBytes);
    }
    return out;
  }

  // ids: of each feature's track, or none.
  static DescribedTracks by_track(const DescribedFeatures& features, const std::vector<TrackId>& ids) {
    std::map<TrackId, std::size_t> feature_of;  // the first, and strongest, of several at one track
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (ids[i] != TrackId()) feature_of.emplace(ids[i], i);
    }
    DescribedTracks out;
    for (const auto& [track, feature] : feature_of) {
      out.tracks.push_back(track);
      const auto begin = features.descriptors.begin() + static_cast<std::ptrdiff_t>(feature * kDescriptorBytes);
      out.descriptors.insert(out.descriptors.end(), begin, begin + kDescriptorBytes);
    }
    return out;
  }

  double pixel_scale_;
  WorkingScale scale_;
  double work_scale_;  // of the image that is worked on, against the raw one
  const TrackerConfig config_;
  Tracker tracker_;
  std::vector<Track> live_;  // raw pixels
  std::optional<TagFinder> tag_finder_;
  cv::Mat given_mask_, mask_;  // of raw images; empty: none
  cv::Mat grey_, work_;        // the newest image, and as it is worked on
};

}  // namespace

std::unique_ptr<FeatureTracker> klt_feature_tracker(const CameraModel& camera, const TrackerConfig& config,
                                                    const std::string& tag_family, std::unique_ptr<Matcher> matcher) {
  return std::make_unique<KltFeatureTracker>(camera, config, tag_family, std::move(matcher));
}

}  // namespace coslam
