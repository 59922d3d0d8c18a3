// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/cuda.h"

#include <dlfcn.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <utility>

#include "agent/gpu/kept_code.h"
#include "agent/gpu/match_program.h"
#include "agent/gpu/shared.h"

namespace coslam {
namespace {

constexpr int kGroup = 64;

// A library that is there for the whole run, or not at all.
class Library {
 public:
  Library(const char* library, std::initializer_list<const char*> names) : library_(library) {
    for (const char* name : names) {
      if (handle_ == nullptr) handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    }
    if (handle_ == nullptr) throw NoDevice(std::string("CUDA's ") + library + " is not installed");
  }
  template <class F>
  void load(const char* name, F*& function) const {
    function = reinterpret_cast<F*>(dlsym(handle_, name));
    if (function == nullptr) throw NoDevice(std::string("CUDA's ") + library_ + " is too old: it has no " + name);
  }

 private:
  const char* library_;
  void* handle_ = nullptr;
};

// What is used of the driver's interface, in the forms that all drivers since CUDA 4 have. Contexts, modules, functions
// and streams are opaque pointers; memory is a number of 64 bits.
struct Driver {
  using Address = std::uint64_t;
  Driver() {
    const Library library("driver", {"libcuda.so.1"});
    library.load("cuInit", init);
    library.load("cuGetErrorString", error_string);
    library.load("cuDeviceGet", device_get);
    library.load("cuDeviceGetName", device_name);
    library.load("cuDeviceGetAttribute", device_attribute);
    library.load("cuDevicePrimaryCtxRetain", retain_context);
    library.load("cuDevicePrimaryCtxRelease", release_context);
    library.load("cuCtxSetCurrent", set_context);
    library.load("cuModuleLoadData", load_module);
    library.load("cuModuleUnload", unload_module);
    library.load("cuModuleGetFunction", get_function);
    library.load("cuMemAlloc_v2", allocate);
    library.load("cuMemFree_v2", release);
    library.load("cuMemAllocHost_v2", allocate_host);
    library.load("cuMemFreeHost", release_host);
    library.load("cuMemcpyHtoDAsync_v2", to_device);
    library.load("cuMemcpyDtoHAsync_v2", to_host);
    library.load("cuStreamCreate", create_stream);
    library.load("cuStreamDestroy_v2", destroy_stream);
    library.load("cuStreamSynchronize", synchronize);
    library.load("cuLaunchKernel", launch);
  }
  static const Driver& get() {
    static const Driver driver;  // constructed anew by the next call where it threw
    return driver;
  }
  void check(int status, const char* call) const {
    if (status == 0) return;
    const char* text = nullptr;
    error_string(status, &text);
    throw DeviceFailure(std::string(call) + " failed: " + (text != nullptr ? text : std::to_string(status).c_str()));
  }

  int (*init)(unsigned flags) = nullptr;
  int (*error_string)(int status, const char** text) = nullptr;
  int (*device_get)(int* device, int index) = nullptr;
  int (*device_name)(char* name, int bytes, int device) = nullptr;
  int (*device_attribute)(int* value, int attribute, int device) = nullptr;
  int (*retain_context)(void** context, int device) = nullptr;
  int (*release_context)(int device) = nullptr;
  int (*set_context)(void* context) = nullptr;
  int (*load_module)(void** module, const void* image) = nullptr;
  int (*unload_module)(void* module) = nullptr;
  int (*get_function)(void** function, void* module, const char* name) = nullptr;
  int (*allocate)(Address* address, std::size_t bytes) = nullptr;
  int (*release)(Address address) = nullptr;
  int (*allocate_host)(void** memory, std::size_t bytes) = nullptr;
  int (*release_host)(void* memory) = nullptr;
  int (*to_device)(Address to, const void* from, std::size_t bytes, void* stream) = nullptr;
  int (*to_host)(void* to, Address from, std::size_t bytes, void* stream) = nullptr;
  int (*create_stream)(void** stream, unsigned flags) = nullptr;
  int (*destroy_stream)(void* stream) = nullptr;
  int (*synchronize)(void* stream) = nullptr;
  int (*launch)(void* function, unsigned groups_x, unsigned groups_y, unsigned groups_z, unsigned group_x,
                unsigned group_y, unsigned group_z, unsigned shared_bytes, void* stream, void** arguments,
                void** extra) = nullptr;
};
constexpr int kCapabilityMajor = 75, kCapabilityMinor = 76;  // attributes of a device
constexpr unsigned kNotWithDefaultStream = 1;

struct Compiler {
  Compiler() {
    const Library library("compiler, libnvrtc,", {"libnvrtc.so", "libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so.11.2",
                                                  "/usr/local/cuda/lib64/libnvrtc.so"});
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
  return "#define GROUP " + std::to_string(kGroup) + "\n" + kCudaDialect + program;
}

std::string architecture_of(int capability) { return "--gpu-architecture=sm_" + std::to_string(capability); }

// A program in the GPU's memory, once for all cameras of the process.
struct Loaded {
  explicit Loaded(std::string text) : source(std::move(text)) {
    // Without a GPU the driver says so here.
    if (cuda.init(0) != 0 || cuda.device_get(&device, 0) != 0) throw NoDevice("CUDA finds no GPU");
    int major = 0, minor = 0;
    cuda.check(cuda.device_attribute(&major, kCapabilityMajor, device), "cuDeviceGetAttribute");
    cuda.check(cuda.device_attribute(&minor, kCapabilityMinor, device), "cuDeviceGetAttribute");
    const int capability = 10 * major + minor;
    cuda.check(cuda.retain_context(&context, device), "cuDevicePrimaryCtxRetain");
    try {
      cuda.check(cuda.set_context(context), "cuCtxSetCurrent");
      load(capability);
    } catch (...) {
      cuda.release_context(device);
      throw;
    }
  }
  ~Loaded() {
    if (cuda.set_context(context) == 0) cuda.unload_module(module);
    cuda.release_context(device);
  }
  Loaded(const Loaded&) = delete;
  Loaded& operator=(const Loaded&) = delete;

  bool is_of(const std::string& text) const { return source == text; }

  // What was kept may be of a driver that is no more: then it is translated all the same.
  void load(int capability) {
    const KeptCode code_cache = KeptCode::of_user();
    const std::string key = architecture_of(capability) + "\n" + text_of(source);
    if (const auto code = code_cache.find(key); code && cuda.load_module(&module, code->data()) == 0) return;
    const std::vector<char> code = cuda_machine_code(source, capability);
    cuda.check(cuda.load_module(&module, code.data()), "cuModuleLoadData");
    code_cache.keep(key, code);
  }

  const Driver& cuda = Driver::get();
  std::string source;
  int device = 0;
  void* context = nullptr;
  void* module = nullptr;
};

// Memory of this side that the GPU reads and writes by itself, handed out piece by piece until all is given back.
// Copies from and to other memory would hold up the thread, and with it all threads that call the driver.
class Staging {
 public:
  explicit Staging(const Loaded& in) : cuda_(in.cuda), context_(in.context) {}
  ~Staging() { release(); }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  // Null when there is no room.
  std::byte* take(std::size_t bytes) {
    if (bytes > size_ - used_) return nullptr;
    std::byte* piece = memory_ + used_;
    used_ += (bytes + kAlign - 1) / kAlign * kAlign;
    return piece;
  }
  void give_back_all() { used_ = 0; }
  // Nothing may be in use.
  void grow(std::size_t bytes) {
    const std::size_t size = 2 * size_ + (bytes + kAlign - 1) / kAlign * kAlign;
    release();
    void* memory = nullptr;
    cuda_.check(cuda_.allocate_host(&memory, size), "cuMemAllocHost");
    memory_ = static_cast<std::byte*>(memory);
    size_ = size;
  }

 private:
  static constexpr std::size_t kAlign = 256;
  void release() {
    if (memory_ != nullptr && cuda_.set_context(context_) == 0) cuda_.release_host(memory_);
    memory_ = nullptr;
    size_ = used_ = 0;
  }

  const Driver& cuda_;
  void* context_;
  std::byte* memory_ = nullptr;
  std::size_t size_ = 0, used_ = 0;
};

class CudaDevice final : public Device {
 public:
  explicit CudaDevice(std::shared_ptr<const Loaded> loaded) : loaded_(std::move(loaded)) {
    enter();
    cuda_.check(cuda_.create_stream(&stream_, kNotWithDefaultStream), "cuStreamCreate");
  }
  ~CudaDevice() override {
    if (cuda_.set_context(loaded_->context) == 0) cuda_.destroy_stream(stream_);
  }
  CudaDevice(const CudaDevice&) = delete;
  CudaDevice& operator=(const CudaDevice&) = delete;

  std::string name() const override {
    std::array<char, 256> name{};
    cuda_.check(cuda_.device_name(name.data(), name.size() - 1, loaded_->device), "cuDeviceGetName");
    return std::string(name.data()) + " (CUDA)";
  }
  std::size_t group() const override { return kGroup; }

  Handle kernel(const char* name) const override {
    enter();
    void* function = nullptr;
    cuda_.check(cuda_.get_function(&function, loaded_->module, name), "cuModuleGetFunction");
    return {function, [](void*) {}};  // goes with the module
  }

  Handle memory(std::size_t bytes) const override {
    enter();
    Driver::Address address = 0;
    cuda_.check(cuda_.allocate(&address, bytes), "cuMemAlloc");
    return {reinterpret_cast<void*>(address), [loaded = loaded_](void* memory) {
              if (loaded->cuda.set_context(loaded->context) == 0)
                loaded->cuda.release(reinterpret_cast<Driver::Address>(memory));
            }};
  }

  void start_write(const Handle& to, std::size_t offset, const void* from, std::size_t bytes) override {
    std::byte* piece = staged(bytes);
    std::memcpy(piece, from, bytes);
    cuda_.check(cuda_.to_device(address(to) + offset, piece, bytes, stream_), "cuMemcpyHtoDAsync");
  }
  void start_read(const Handle& from, void* to, std::size_t bytes) override {
    std::byte* piece = staged(bytes);
    cuda_.check(cuda_.to_host(piece, address(from), bytes, stream_), "cuMemcpyDtoHAsync");
    reads_.push_back({piece, to, bytes});
  }
  void finish() override {
    enter();
    cuda_.check(cuda_.synchronize(stream_), "cuStreamSynchronize");
    for (const Read& r : reads_) std::memcpy(r.to, r.from, r.bytes);
    reads_.clear();
    staging_.give_back_all();
  }
  void wait() noexcept override {
    if (cuda_.set_context(loaded_->context) == 0) cuda_.synchronize(stream_);
  }

 private:
  struct Read {
    const std::byte* from;
    void* to;
    std::size_t bytes;
  };

  std::byte* staged(std::size_t bytes) {
    enter();
    std::byte* piece = staging_.take(bytes);
    if (piece != nullptr) return piece;
    finish();
    staging_.grow(bytes);
    return staging_.take(bytes);
  }

  static Driver::Address address(const Handle& memory) { return reinterpret_cast<Driver::Address>(memory.get()); }

  // A thread has one context at a time.
  void enter() const { cuda_.check(cuda_.set_context(loaded_->context), "cuCtxSetCurrent"); }

  void launch(const Handle& kernel, Items items, std::size_t group, std::span<const Argument> arguments) override {
    enter();
    std::array<void*, kMostArguments> data{};
    for (std::size_t i = 0; i < arguments.size(); ++i) data.at(i) = const_cast<void*>(arguments[i].data());
    cuda_.check(cuda_.launch(kernel.get(), static_cast<unsigned>(items.x / group), static_cast<unsigned>(items.y), 1,
                             static_cast<unsigned>(group), 1, 1, 0, stream_, data.data(), nullptr),
                "cuLaunchKernel");
  }

  static constexpr std::size_t kMostArguments = 16;
  const std::shared_ptr<const Loaded> loaded_;
  const Driver& cuda_ = loaded_->cuda;
  void* stream_ = nullptr;
  Staging staging_{*loaded_};
  std::vector<Read> reads_;
};

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

std::unique_ptr<Device> cuda_device(const std::string& program) {
  return std::make_unique<CudaDevice>(shared_of<Loaded>(program));
}

}  // namespace coslam
