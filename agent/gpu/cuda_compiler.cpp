// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/cuda_compiler.h"

#include <array>
#include <cstddef>
#include <memory>

#include "agent/gpu/cuda_library.h"
#include "agent/gpu/device.h"
#include "agent/gpu/match_program.h"

namespace coslam {
namespace {

// What is used of the compiler's interface.
struct Compiler {
  Compiler() {
    const CudaLibrary library("compiler, libnvrtc,", {"libnvrtc.so", "libnvrtc.so.13", "libnvrtc.so.12",
                                                      "libnvrtc.so.11.2", "/usr/local/cuda/lib64/libnvrtc.so"});
    library.load("nvrtcCreateProgram", create);
    library.load("nvrtcCompileProgram", compile);
    library.load("nvrtcDestroyProgram", destroy);
    library.load("nvrtcGetCUBINSize", code_size);
    library.load("nvrtcGetCUBIN", code);
    library.load("nvrtcGetProgramLogSize", log_size);
    library.load("nvrtcGetProgramLog", log);
  }
  int (*create)(void** program, const char* source, const char* name, int headers, const char* const* texts,
                const char* const* names) = nullptr;
  int (*compile)(void* program, int count, const char* const* options) = nullptr;
  int (*destroy)(void** program) = nullptr;
  int (*code_size)(void* program, std::size_t* bytes) = nullptr;
  int (*code)(void* program, char* code) = nullptr;
  int (*log_size)(void* program, std::size_t* bytes) = nullptr;
  int (*log)(void* program, char* text) = nullptr;
};

std::string text_of(const std::string& program) {
  return "#define GROUP " + std::to_string(kCudaGroup) + "\n" + kCudaDialect + program;
}

std::string architecture_of(int capability) { return "--gpu-architecture=sm_" + std::to_string(capability); }

}  // namespace

std::vector<char> cuda_machine_code(const std::string& program, int capability) {
  static const Compiler compiler;
  const std::string text = text_of(program), architecture = architecture_of(capability);
  // As on the CPU, no product is added unrounded.
  const std::array<const char*, 4> options{architecture.c_str(), "--device-as-default-execution-space", "--fmad=false",
                                           "--std=c++17"};
  void* made = nullptr;
  if (compiler.create(&made, text.c_str(), "match_program", 0, nullptr, nullptr) != 0) {
    throw DeviceFailure("nvrtcCreateProgram failed");
  }
  const std::unique_ptr<void, void (*)(void*)> owner(made, [](void* p) { compiler.destroy(&p); });
  std::size_t bytes = 0;
  if (compiler.compile(made, static_cast<int>(options.size()), options.data()) != 0) {
    compiler.log_size(made, &bytes);
    std::string log(bytes, '\0');
    compiler.log(made, log.data());
    throw DeviceFailure("nvrtcCompileProgram failed: " + log);
  }
  if (compiler.code_size(made, &bytes) != 0) throw DeviceFailure("nvrtcGetCUBINSize failed");
  std::vector<char> code(bytes);
  if (compiler.code(made, code.data()) != 0) throw DeviceFailure("nvrtcGetCUBIN failed");
  return code;
}

std::string cuda_code_key(const std::string& program, int capability) {
  return architecture_of(capability) + "\n" + text_of(program);
}

}  // namespace coslam
