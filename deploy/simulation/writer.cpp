// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/writer.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <thread>

#include "common/base/error.h"
#include "common/dataset/calibration.h"
#include "common/image/image_file.h"
#include "deploy/simulation/marked_spots.h"
#include "deploy/simulation/parallel.h"
#include "deploy/simulation/renderer.h"
#include "deploy/simulation/view_overlap.h"

namespace coslam {
namespace sim {
namespace {

namespace fs = std::filesystem;

std::string formatted(const char* format, auto... values) {
  char line[256];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

std::string agent_name(int camera) { return "cam" + std::to_string(camera); }
std::string image_name(int frame) { return formatted("%06d.png", frame); }

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.flush();
  if (!out) throw UserError("cannot write " + file.string());
}

void write_image(const fs::path& file, const cv::Mat& image) {
  if (!write_image_file(file, image)) {
    throw UserError("cannot write " + file.string());
  }
}

std::string truth_text(const SimulatedScene& scene, int camera) {
  std::string out = "# t_s tx ty tz qx qy qz qw, camera to world\n";
  for (int frame = 0; frame < scene.frames(); ++frame) {
    const double t_s = scene.time_s(frame);
    const Rigid3 p = scene.cam_from_world(camera, t_s).inverse();
    const Eigen::Vector3d& t = p.translation;
    const Eigen::Quaterniond& q = p.rotation;
    out += formatted("%.9f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", t_s, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return out;
}

std::string times_text(const SimulatedScene& scene) {
  std::string out;
  for (int frame = 0; frame < scene.frames(); ++frame) out += formatted("%.9f\n", scene.time_s(frame));
  return out;
}

std::string sequence_text(const SimulatedScene& scene, const WriteOptions& options) {
  std::string out = "name: " + options.name + formatted("\nrate_hz: %g\n", scene.rate_hz());
  out += "scene: " + options.name + "\nscene_seed: " + std::to_string(options.seed) + "\n";
  if (scene.tag_m() > 0) out += formatted("scale: {tag_m: %g}\n", scene.tag_m());
  // The distance of the first two is known to the server when both start in one map.
  constexpr double kStartTogether = 0.2;
  if (scene.tag_m() <= 0 && scene.cameras() > 1 && ViewOverlap(scene).at(0)(0, 1) > kStartTogether) {
    const Eigen::Vector3d apart = scene.cam_from_world(0, 0).center() - scene.cam_from_world(1, 0).center();
    out += formatted("scale: {baseline_m: %.9f}\n", apart.norm());
  }
  if (scene.cameras() > 1) out += "overlap: overlap.csv\n";
  if (scene.bodies() > 0) out += "truth_points: points.csv\nmasks: masks\n";
  out += "agents:\n";
  for (int camera = 0; camera < scene.cameras(); ++camera) {
    const std::string name = agent_name(camera);
    const char* n = name.c_str();
    out += formatted("  - name: %s\n    source: %s\n    calibration: %s.yaml\n    truth: %s.tum\n", n, n, n, n);
  }
  return out;
}

// A line for every two cameras, ten times a second.
void write_overlap(const SimulatedScene& scene, const fs::path& file) {
  constexpr double kRateHz = 10;
  const int every = std::max(1, static_cast<int>(std::lround(scene.rate_hz() / kRateHz)));
  const ViewOverlap overlap(scene);
  std::string out = "t_s,agent_a,agent_b,share\n";
  for (int frame = 0; frame < scene.frames(); frame += every) {
    const Eigen::MatrixXd shares = overlap.at(scene.time_s(frame));
    for (int a = 0; a < scene.cameras(); ++a) {
      for (int b = 0; b < scene.cameras(); ++b) {
        if (a == b) continue;
        out += formatted("%.9f,%s,%s,%.3f\n", scene.time_s(frame), agent_name(a).c_str(), agent_name(b).c_str(),
                         shares(a, b));
      }
    }
  }
  write_text(file, out);
}

// A line for every marked spot and frame.
void write_marked_points(const SimulatedScene& scene, std::uint64_t seed, const fs::path& file) {
  constexpr int kMarked = 300;
  const std::vector<SurfaceSpot> spots = marked_spots(scene, kMarked, seed);
  std::string out = "t_s,id,x,y,z\n";
  for (int frame = 0; frame < scene.frames(); ++frame) {
    for (std::size_t i = 0; i < spots.size(); ++i) {
      const Eigen::Vector3d p = scene.position(spots[i], scene.time_s(frame));
      out += formatted("%.9f,%zu,%.5f,%.5f,%.5f\n", scene.time_s(frame), i + 1, p.x(), p.y(), p.z());
    }
  }
  write_text(file, out);
}

void write_descriptions(const SimulatedScene& scene, const WriteOptions& options, const fs::path& folder) {
  for (int camera = 0; camera < scene.cameras(); ++camera) {
    const std::string name = agent_name(camera);
    fs::create_directories(folder / name);
    fs::create_directories(folder / "depth" / name);
    save_calibration(folder / (name + ".yaml"), scene.camera(camera));
    write_text(folder / (name + ".tum"), truth_text(scene, camera));
    write_text(folder / name / "times.txt", times_text(scene));
    if (scene.bodies() > 0) fs::create_directories(folder / "masks" / name);
  }
  if (scene.cameras() > 1) write_overlap(scene, folder / "overlap.csv");
  if (scene.bodies() > 0) write_marked_points(scene, options.seed, folder / "points.csv");
  write_text(folder / "sequence.yaml", sequence_text(scene, options));
}

// Draws the frames of all cameras in the order of time.
class FrameWriter {
 public:
  FrameWriter(const SimulatedScene& scene, const WriteOptions& options, fs::path folder)
      : scene_(scene),
        folder_(std::move(folder)),
        renderer_(scene.world(), scene.caster(), scene.parts(), options.threads, options.coarseness) {
    for (int i = 0; i < scene.cameras(); ++i) rays_.emplace_back(scene.camera(i), options.threads);
  }

  void write(int item) const {
    const int camera = item % scene_.cameras(), frame = item / scene_.cameras();
    const RayTable& rays = rays_[static_cast<std::size_t>(camera)];
    const double t_s = scene_.time_s(frame);
    const Rigid3 pose = scene_.cam_from_world(camera, t_s);
    const auto posed = scene_.posed(t_s);
    cv::Mat1b moving;
    const cv::Mat1f radiance = renderer_.radiance(rays, pose, posed.get(), posed ? &moving : nullptr);
    const cv::Mat1b image = expose(radiance, scene_.at(camera).sensor, frame, t_s);
    if (posed) write_image(folder_ / "masks" / agent_name(camera) / image_name(frame), moving);
    write_image(folder_ / agent_name(camera) / image_name(frame), image);
    if (frame % kDepthEvery == 0) {
      write_image(folder_ / "depth" / agent_name(camera) / image_name(frame),
                  renderer_.depth_mm(rays, pose, posed.get()));
    }
  }

 private:
  const SimulatedScene& scene_;
  fs::path folder_;
  Renderer renderer_;
  std::vector<RayTable> rays_;
};

// Runs the work on threads of its own and reports from this one. An exception of either ends the work.
void run_with_progress(int total, int threads, const std::function<void(int)>& work,
                       const std::function<void(int, int)>& progress) {
  std::mutex mutex;
  std::condition_variable_any changed;
  int done = 0;
  bool ended = false, cancelled = false;
  std::exception_ptr failure;
  std::jthread runner([&] {
    try {
      parallel_for(total, threads, [&](int item) {
        work(item);
        const std::scoped_lock lock(mutex);
        if (cancelled) throw std::runtime_error("cancelled");
        ++done;
        changed.notify_one();
      });
    } catch (...) {
      failure = std::current_exception();
    }
    const std::scoped_lock lock(mutex);
    ended = true;
    changed.notify_one();
  });
  int reported = 0;
  std::unique_lock lock(mutex);
  while (!ended || reported < done) {
    changed.wait(lock, [&] { return ended || reported < done; });
    if (reported == done) continue;
    reported = done;
    lock.unlock();
    try {
      if (progress) progress(reported, total);
    } catch (...) {
      lock.lock();
      cancelled = true;
      throw;
    }
    lock.lock();
  }
  lock.unlock();
  runner.join();
  if (failure) std::rethrow_exception(failure);
}

// A folder beside the final one that is removed unless it was renamed to it.
class FolderAside {
 public:
  explicit FolderAside(fs::path final_folder) : final_(std::move(final_folder)) {
    if (final_.filename().empty()) final_ = final_.parent_path();  // "folder/"
    if (fs::exists(final_) && !(fs::is_directory(final_) && fs::is_empty(final_))) {
      throw UserError(final_.string() + " exists already");
    }
    aside_ = final_;
    aside_ += formatted(".partial-%ld", static_cast<long>(getpid()));
    fs::remove_all(aside_);
    fs::create_directories(aside_);
  }
  ~FolderAside() {
    std::error_code ignored;
    fs::remove_all(aside_, ignored);
  }
  FolderAside(const FolderAside&) = delete;
  FolderAside& operator=(const FolderAside&) = delete;

  const fs::path& path() const { return aside_; }
  void commit() { fs::rename(aside_, final_); }

 private:
  fs::path final_, aside_;
};

}  // namespace

void write_sequence(const SimulatedScene& scene, const WriteOptions& options, const fs::path& folder,
                    const std::function<void(int, int)>& progress) {
  try {
    FolderAside aside(folder);
    write_descriptions(scene, options, aside.path());
    const FrameWriter writer(scene, options, aside.path());
    run_with_progress(
        scene.frames() * scene.cameras(), options.threads, [&](int item) { writer.write(item); }, progress);
    aside.commit();
  } catch (const fs::filesystem_error& error) {
    throw UserError("cannot write the sequence to " + folder.string() + ": " + error.code().message());
  }
}

}  // namespace sim

void render_sequence(const RenderOptions& options, const std::filesystem::path& folder,
                     const std::function<void(int, int)>& progress) {
  const sim::SceneSize size{options.cameras,  options.frames,    1.0,          options.rate_hz,
                            options.width_px, options.height_px, options.lens, options.turn_at_s};
  const auto scene = sim::make_simulated_scene(options.scene, options.seed, size);
  sim::write_sequence(*scene, {options.scene, options.seed, options.threads, 1.0}, folder, progress);
}

}  // namespace coslam
