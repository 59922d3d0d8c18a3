// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "deploy/coslam/commands.h"
#include "deploy/coslam/console.h"
#include "deploy/simulation/scene.h"
#include "deploy/simulation/sensor.h"

namespace coslam {
namespace {

std::string known_scenes() {
  std::string names;
  for (const std::string& name : scene_names()) names += (names.empty() ? "" : ", ") + name;
  return names;
}

struct RenderArguments {
  RenderOptions options;
  std::string folder, size;
};

// "WxH" in pixels. An empty text is one that was not given.
std::string read_size(const std::string& text, RenderOptions& options) {
  int read = 0;
  const bool whole = std::sscanf(text.c_str(), "%5dx%5d%n", &options.width_px, &options.height_px, &read) == 2 &&
                     static_cast<std::size_t>(read) == text.size();
  const auto fits = [](int side_px) { return side_px >= 64 && side_px <= 8192; };
  if (whole && fits(options.width_px) && fits(options.height_px)) return {};
  return "takes WIDTHxHEIGHT in pixels, 64 to 8192 each, not '" + text + "'";
}

int render(RenderArguments arguments) {
  constexpr std::string_view kSimulated = "sim:";
  std::string& scene = arguments.options.scene;
  if (scene.starts_with(kSimulated)) scene.erase(0, kSimulated.size());
  {
    Progress progress("rendering " + scene);
    render_sequence(arguments.options, arguments.folder, std::ref(progress));
  }
  std::printf("%s: a sequence with truth; play it with: coslam run %s\n", arguments.folder.c_str(),
              arguments.folder.c_str());
  return 0;
}

}  // namespace

void add_render_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<RenderArguments>();
  RenderOptions& options = arguments->options;
  options.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App* command = app.add_subcommand("render", "Render a simulated sequence with truth");
  command->add_option("SCENE", options.scene, "one of: " + known_scenes())->required();
  command->add_option("DIR", arguments->folder, "folder to write, must not exist")->required();
  command->add_option("--frames", options.frames, "frames a camera; default: the scene's own")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--cameras", options.cameras, "cameras; default: the scene's own")->check(CLI::Range(1, 16));
  command->add_option("--seed", options.seed, "seed of textures, motion and noise")
      ->capture_default_str()
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{4294967295}).description(""));
  command->add_option("--rate-hz", options.rate_hz, "images a second of the same motion; default: the scene's own")
      ->check(CLI::Range(0.5, 240.0));
  command->add_option("--size", arguments->size, "WIDTHxHEIGHT of the images in pixels; default: the scene's own")
      ->check([&options](const std::string& text) { return read_size(text, options); });
  command->add_option(
      "--lens", options.lens,
      sim::known_lenses() + " or fisheyeN (N degrees from corner to corner, 60 to 170); default: the scene's own");
  command
      ->add_option("--turn-at-s", options.turn_at_s,
                   "the cameras stop there, turn by 180 degrees on the spot within 4 s, and go on looking back")
      ->check(CLI::Range(0.001, 3600.0).description(""));
  command->callback([arguments, &chosen] { chosen = [arguments] { return render(*arguments); }; });
}

}  // namespace coslam
