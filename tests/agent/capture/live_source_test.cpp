// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <thread>
#include <vector>

#include "agent/capture/source.h"
#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::live_source_test {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 48;
const SourceOptions kOptions{0, {}, 10, kWidth, kHeight, "calib.yaml"};

// A network camera on this machine: motion JPEG over HTTP. Each client gets so many images, then the line drops.
class NetworkCamera {
 public:
  explicit NetworkCamera(int images_a_client)
      : NetworkCamera("HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=next\r\n\r\n",
                      images_a_client) {}
  explicit NetworkCamera(std::string answer, int images_a_client = 0)
      : answer_(std::move(answer)), images_a_client_(images_a_client) {
    listener_ = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    ready_ = bind(listener_, reinterpret_cast<sockaddr*>(&address), size) == 0 && listen(listener_, 4) == 0 &&
             getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) == 0;
    url_ = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port)) + "/cam.mjpg";
    const timeval patience{0, 50'000};
    setsockopt(listener_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    server_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
  }
  ~NetworkCamera() {
    server_ = {};
    close(listener_);
  }
  NetworkCamera(const NetworkCamera&) = delete;
  NetworkCamera& operator=(const NetworkCamera&) = delete;

  bool ready() const { return ready_; }
  const std::string& url() const { return url_; }
  int clients() const { return clients_; }

 private:
  void serve(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const int client = accept(listener_, nullptr, nullptr);
      if (client < 0) continue;
      ++clients_;
      std::string request(2048, ' ');
      bool connected = recv(client, request.data(), request.size(), 0) > 0;
      connected = connected && write(client, answer_);
      for (int i = 0; connected && i < images_a_client_ && !stop.stop_requested(); ++i) {
        connected = write(client, image_part(i));
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
      close(client);
    }
  }
  static bool write(int client, const std::string& bytes) {
    return send(client, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
  }
  static std::string image_part(int number) {
    std::vector<uchar> jpeg;
    cv::imencode(".jpg", cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(100 + number % 50)), jpeg);
    return "--next\r\nContent-Type: image/jpeg\r\nContent-Length: " + std::to_string(jpeg.size()) + "\r\n\r\n" +
           std::string(jpeg.begin(), jpeg.end()) + "\r\n";
  }

  const std::string answer_;
  int images_a_client_;
  int listener_ = -1;
  bool ready_ = false;
  std::string url_;
  std::atomic<int> clients_ = 0;
  std::jthread server_;
};

TEST(Live, NamesWhatCannotBeOpened) {
  const NetworkCamera page(
      "HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: 19\r\n\r\n<html>Log in</html>");
  const NetworkCamera none("HTTP/1.1 404 Not Found\r\n\r\n");
  ASSERT_TRUE(page.ready() && none.ready());
  const std::vector<std::pair<std::string, std::string>> why{
      {"v4l2:99", "No such file or directory"},       {"v4l2:/dev/no-such-video", "No such file or directory"},
      {"v4l2:/dev/null", "/dev/null is no camera"},   {"gst:no-such-element", ""},
      {"rtsp://127.0.0.1:1/x", "Connection refused"}, {page.url(), "what it gives is no video"},
      {none.url(), "Server returned 404 Not Found"}};
  for (const auto& [uri, reason] : why) {
    EXPECT_THAT(test::error_of<UserError>([&, &uri = uri] { open_source(uri, kOptions); }),
                HasSubstr("the source '" + uri + "' cannot be opened: " + reason));
  }
}

TEST(Live, PasswordsAreNotSaid) {
  EXPECT_THAT(test::error_of<UserError>([&] { open_source("rtsp://guard:secret@127.0.0.1:1/x", kOptions); }),
              HasSubstr("the source 'rtsp://***@127.0.0.1:1/x' cannot be opened: "));
  EXPECT_THAT(test::error_of<UserError>([&] { open_source("rtmp://guard:secret@127.0.0.1:1/x", kOptions); }),
              HasSubstr("the source 'rtmp://***@127.0.0.1:1/x' is of no known kind"));
}

TEST(Live, ImagesCarryTheTimeOfDay) {
  const NetworkCamera camera(1000);
  ASSERT_TRUE(camera.ready());
  const auto source = open_source(camera.url(), kOptions);
  EXPECT_TRUE(source->live());
  EXPECT_FALSE(source->peek_ns());
  TimeNs last_ns = 1'600'000'000'000'000'000;  // UTC, a while ago
  for (std::uint32_t i = 0; i < 20; ++i) {
    const auto image = source->next();
    ASSERT_TRUE(image);
    EXPECT_EQ(image->frame, FrameId(i));
    EXPECT_EQ(image->grey.type(), CV_8UC1);
    EXPECT_EQ(image->grey.size(), cv::Size(kWidth, kHeight));
    EXPECT_GT(image->capture_ns, last_ns);
    last_ns = image->capture_ns;
  }
}

TEST(Live, ALostCameraIsOpenedAgain) {
  const NetworkCamera camera(60);
  ASSERT_TRUE(camera.ready());
  const auto source = open_source(camera.url(), kOptions);
  int images = 0, losses = 0;
  while (images < 150) {
    const auto image = source->next();
    ASSERT_TRUE(image);
    ++(image->fault == ImageFault::kNone ? images : losses);
    EXPECT_EQ(image->fault == ImageFault::kNone, !image->grey.empty());
  }
  EXPECT_GE(camera.clients(), 3);
  EXPECT_GE(losses, 2) << "each is told";
}

TEST(Live, StopEndsTheWaitForALostCamera) {
  auto camera = std::make_unique<NetworkCamera>(40);
  ASSERT_TRUE(camera->ready());
  const auto source = open_source(camera->url(), kOptions);
  camera.reset();
  std::jthread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    source->stop();
  });
  ImageFault last = ImageFault::kNone;
  while (const auto image = source->next()) last = image->fault;
  EXPECT_EQ(last, ImageFault::kMissing);
}

TEST(Live, WrongSize) {
  const NetworkCamera camera(1000);
  SourceOptions options = kOptions;
  options.width_px = 640;
  EXPECT_THAT(test::error_of<UserError>([&] { open_source(camera.url(), options); }), HasSubstr("is 64x48 pixels"));
}

TEST(Live, PlaysAGstreamerPipelineToItsEnd) {
  std::unique_ptr<ImageSource> source;
  try {
    source = open_source("gst:videotestsrc is-live=true num-buffers=10 ! video/x-raw,width=64,height=48", kOptions);
  } catch (const UserError&) {
    GTEST_SKIP() << "no GStreamer test source here";
  }
  int images = 0;
  while (source->next()) ++images;
  EXPECT_GE(images, 1);
}

}  // namespace
}  // namespace coslam::live_source_test
