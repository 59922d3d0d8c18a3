// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/cuda.h"

#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "agent/gpu/cuda_compiler.h"
#include "agent/gpu/cuda_driver.h"
#include "agent/gpu/kept_code.h"
#include "agent/gpu/shared.h"

namespace coslam {
namespace {

// A program in the GPU's memory, once for all cameras of the process.
struct Loaded {
  explicit Loaded(std::string text) : source(std::move(text)) {
    // Without a GPU the driver says so here.
    if (cuda.init(0) != 0 || cuda.device_get(&device, 0) != 0) throw NoDevice("CUDA finds no GPU");
    int major = 0, minor = 0;
    cuda.check(cuda.device_attribute(&major, CudaDriver::kCapabilityMajor, device), "cuDeviceGetAttribute");
    cuda.check(cuda.device_attribute(&minor, CudaDriver::kCapabilityMinor, device), "cuDeviceGetAttribute");
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
    const std::string key = cuda_code_key(source, capability);
    if (const auto code = code_cache.find(key); code && cuda.load_module(&module, code->data()) == 0) return;
    const std::vector<char> code = cuda_machine_code(source, capability);
    cuda.check(cuda.load_module(&module, code.data()), "cuModuleLoadData");
    code_cache.keep(key, code);
  }

  const CudaDriver& cuda = CudaDriver::get();
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

  const CudaDriver& cuda_;
  void* context_;
  std::byte* memory_ = nullptr;
  std::size_t size_ = 0, used_ = 0;
};

class CudaDevice final : public Device {
 public:
  explicit CudaDevice(std::shared_ptr<const Loaded> loaded) : loaded_(std::move(loaded)) {
    enter();
    cuda_.check(cuda_.create_stream(&stream_, CudaDriver::kNotWithDefaultStream), "cuStreamCreate");
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
  std::size_t group() const override { return kCudaGroup; }

  Handle kernel(const char* name) const override {
    enter();
    void* function = nullptr;
    cuda_.check(cuda_.get_function(&function, loaded_->module, name), "cuModuleGetFunction");
    return {function, [](void*) {}};  // goes with the module
  }

  Handle memory(std::size_t bytes) const override {
    enter();
    CudaDriver::Address address = 0;
    cuda_.check(cuda_.allocate(&address, bytes), "cuMemAlloc");
    return {reinterpret_cast<void*>(address), [loaded = loaded_](void* memory) {
              if (loaded->cuda.set_context(loaded->context) == 0)
                loaded->cuda.release(reinterpret_cast<CudaDriver::Address>(memory));
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

  static CudaDriver::Address address(const Handle& memory) {
    return reinterpret_cast<CudaDriver::Address>(memory.get());
  }

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
  const CudaDriver& cuda_ = loaded_->cuda;
  void* stream_ = nullptr;
  Staging staging_{*loaded_};
  std::vector<Read> reads_;
};

}  // namespace

std::unique_ptr<Device> cuda_device(const std::string& program) {
  return std::make_unique<CudaDevice>(shared_of<Loaded>(program));
}

}  // namespace coslam
