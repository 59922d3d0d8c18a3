// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace coslam {

// A device cannot be used, or failed.
struct DeviceFailure : std::runtime_error {
  using runtime_error::runtime_error;
};
struct NoDevice : DeviceFailure {
  using DeviceFailure::DeviceFailure;
};

// A processor beside the CPU, with one program and one queue that is worked off in order. Devices of one process share
// what can be shared. All calls throw DeviceFailure. Thread-compatible; two devices may work at once.
class Device {
 public:
  // Memory of the device, or a kernel of its program; given back when it goes, before the device does.
  using Handle = std::unique_ptr<void, std::function<void(void*)>>;
  struct Items {
    std::size_t x = 1, y = 1;
  };

  virtual ~Device() = default;
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  virtual std::string name() const = 0;
  // How many items share a task: GROUP in the program.
  virtual std::size_t group() const = 0;
  virtual Handle kernel(const char* name) const = 0;
  virtual Handle memory(std::size_t bytes) const = 0;
  // Start a copy; the memory on this side must stay as it is until finish().
  virtual void start_write(const Handle& to, std::size_t offset, const void* from, std::size_t bytes) = 0;
  virtual void start_read(const Handle& from, void* to, std::size_t bytes) = 0;
  virtual void finish() = 0;
  virtual void wait() noexcept = 0;  // like finish(), but ignores errors

  // Queues a kernel over `items`, in groups of `group` along x. Arguments: memory, or plain values by their bytes.
  template <class... Arguments>
  void run(const Handle& kernel, Items items, std::size_t group, const Arguments&... arguments) {
    const std::array<Argument, sizeof...(Arguments)> list{argument(arguments)...};
    launch(kernel, items, group, list);
  }

 protected:
  struct Argument {
    const void* value = nullptr;  // null: the argument is `handle`
    std::size_t bytes = sizeof(void*);
    void* handle = nullptr;
    const void* data() const { return value != nullptr ? value : &handle; }
  };

 private:
  virtual void launch(const Handle& kernel, Items items, std::size_t group, std::span<const Argument> arguments) = 0;
  template <class T>
  static Argument argument(const T& value) {
    if constexpr (std::is_same_v<T, Handle>) {
      return {.handle = value.get()};
    } else {
      static_assert(std::is_trivially_copyable_v<T>);
      return {.value = &value, .bytes = sizeof(T)};
    }
  }
};

}  // namespace coslam
