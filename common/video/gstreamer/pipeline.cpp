// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/video/pipeline.h"

#include <gst/gst.h>

#include <algorithm>
#include <array>
#include <utility>

namespace coslam {
namespace {

using Text = std::unique_ptr<gchar, decltype([](gchar* t) { g_free(t); })>;
using Error = std::unique_ptr<GError, decltype([](GError* e) { g_error_free(e); })>;
using Element = std::unique_ptr<GstElement, decltype([](GstElement* e) { gst_object_unref(e); })>;
using Message = std::unique_ptr<GstMessage, decltype([](GstMessage* m) { gst_message_unref(m); })>;
using Sample = std::unique_ptr<GstSample, decltype([](GstSample* s) { gst_sample_unref(s); })>;

constexpr GstClockTime kStep_ns = 100 * GST_MSECOND;
constexpr GstClockTime kPatience_ns = 10 * GST_SECOND;

// GStreamer's names of formats, and those of encodings.
constexpr auto kEncodings = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"GRAY8", "mono8"},
    {"GRAY16_LE", "mono16"},
    {"BGR", "bgr8"},
    {"RGB", "rgb8"},
    {"BGRA", "bgra8"},
    {"BGRx", "bgra8"},
    {"RGBA", "rgba8"},
    {"RGBx", "rgba8"},
    {"YUY2", "yuyv"},
    {"UYVY", "uyvy"},
    {"NV12", "nv12"},
    {"NV21", "nv21"},
    {"I420", "i420"},
    {"YV12", "yv12"},
});

std::string_view encoding_of(std::string_view format) {
  const auto* at = std::ranges::find(kEncodings, format, &std::pair<std::string_view, std::string_view>::first);
  return at == kEncodings.end() ? std::string_view() : at->second;
}

// Octets a pixel of the first plane.
int octets_of(std::string_view encoding) {
  if (encoding == "bgr8" || encoding == "rgb8") return 3;
  if (encoding == "bgra8" || encoding == "rgba8") return 4;
  return encoding == "mono16" || encoding == "yuyv" || encoding == "uyvy" ? 2 : 1;
}

class GstPipeline final : public Pipeline {
 public:
  explicit GstPipeline(const std::atomic<bool>& stopped) : stopped_(stopped) {}
  ~GstPipeline() override {
    release();
    if (pipeline_) gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
  }
  GstPipeline(const GstPipeline&) = delete;
  GstPipeline& operator=(const GstPipeline&) = delete;

  // Empty: it plays; else why not.
  std::string start(const std::string& words) {
    GError* error = nullptr;
    pipeline_.reset(gst_parse_launch(words.c_str(), &error));
    const Error owner(error);
    if (!pipeline_ || error != nullptr) return error == nullptr ? "it is no pipeline" : error->message;
    if (!GST_IS_BIN(pipeline_.get())) return "it is a single element";
    if (!find_sink()) return "it has no appsink";
    if (gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE) return why_failed();
    return {};
  }

  bool read(Raw* picture) override {
    release();
    for (GstClockTime waited = 0; waited < kPatience_ns && !stopped_; waited += kStep_ns) {
      GstSample* pulled = nullptr;
      g_signal_emit_by_name(sink_.get(), "try-pull-sample", kStep_ns, &pulled);
      sample_.reset(pulled);
      if (sample_) return show(picture);
      gboolean ended = FALSE;
      g_object_get(sink_.get(), "eos", &ended, nullptr);
      if (ended != FALSE || has_failed()) return false;
    }
    return false;
  }

 private:
  bool find_sink() {
    GstIterator* sinks = gst_bin_iterate_sinks(GST_BIN(pipeline_.get()));
    GValue item = G_VALUE_INIT;
    while (!sink_ && gst_iterator_next(sinks, &item) == GST_ITERATOR_OK) {
      auto* element = GST_ELEMENT(g_value_get_object(&item));
      const Text type(g_strdup(G_OBJECT_TYPE_NAME(element)));
      if (std::string_view(type.get()) == "GstAppSink") sink_.reset(GST_ELEMENT(gst_object_ref(element)));
      g_value_reset(&item);
    }
    g_value_unset(&item);
    gst_iterator_free(sinks);
    return sink_ != nullptr;
  }

  Message error_message() const {
    GstBus* bus = gst_element_get_bus(pipeline_.get());
    Message message(gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR));
    gst_object_unref(bus);
    return message;
  }
  bool has_failed() const { return error_message() != nullptr; }
  std::string why_failed() const {
    const Message message = error_message();
    if (!message) return "it does not start";
    GError* error = nullptr;
    gst_message_parse_error(message.get(), &error, nullptr);
    const Error owner(error);
    return error->message;
  }

  // The length of a row is that of GStreamer's own layout: rows begin at multiples of four octets.
  bool show(Raw* out) {
    const GstStructure* form = gst_caps_get_structure(gst_sample_get_caps(sample_.get()), 0);
    gint width = 0, height = 0;
    gst_structure_get_int(form, "width", &width);
    gst_structure_get_int(form, "height", &height);
    const gchar* format = gst_structure_get_string(form, "format");
    GstBuffer* buffer = gst_sample_get_buffer(sample_.get());
    if (width <= 0 || height <= 0 || buffer == nullptr || gst_buffer_map(buffer, &mapped_, GST_MAP_READ) == FALSE)
      return false;
    is_mapped_ = true;
    out->format = format == nullptr ? "" : format;
    out->encoding = encoding_of(out->format);
    out->octets = mapped_.size;
    constexpr std::size_t kAligned = 4;
    const std::size_t row = static_cast<std::size_t>(width) * static_cast<std::size_t>(octets_of(out->encoding));
    out->first_plane = {width, height, 1, 1, (row + kAligned - 1) / kAligned * kAligned, mapped_.data};
    return true;
  }

  void release() {
    if (is_mapped_) gst_buffer_unmap(gst_sample_get_buffer(sample_.get()), &mapped_);
    is_mapped_ = false;
    sample_.reset();
  }

  const std::atomic<bool>& stopped_;
  Element pipeline_, sink_;
  Sample sample_;
  GstMapInfo mapped_{};
  bool is_mapped_ = false;
};

class GstPipelines final : public Pipelines {
 public:
  std::unique_ptr<Pipeline> start(const std::string& words, std::string* why,
                                  const std::atomic<bool>& stopped) const override {
    GError* error = nullptr;
    const bool ready = gst_init_check(nullptr, nullptr, &error) != FALSE;
    const Error owner(error);
    auto pipeline = std::make_unique<GstPipeline>(stopped);
    *why = ready ? pipeline->start(words) : error->message;
    if (why->empty()) return pipeline;
    *why += "; elements come with Debian's gstreamer1.0-plugins-base, -good, -bad, -ugly and -libav";
    return nullptr;
  }
};

}  // namespace
}  // namespace coslam

extern "C" __attribute__((visibility("default"))) const void* coslam_plug_in(const char* version) {
  static const coslam::GstPipelines pipelines;
  return std::string_view(version) == COSLAM_VERSION ? static_cast<const coslam::Pipelines*>(&pipelines) : nullptr;
}
