// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

namespace coslam {

// What OpenCL hands out, released when it goes.
template <class T, auto kRelease>
struct ClRelease {
  using pointer = T;
  void operator()(T handle) const { kRelease(handle); }
};
template <class T, auto kRelease>
using ClHandle = std::unique_ptr<std::remove_pointer_t<T>, ClRelease<T, kRelease>>;
using ClContext = ClHandle<cl_context, clReleaseContext>;
using ClQueue = ClHandle<cl_command_queue, clReleaseCommandQueue>;
using ClProgram = ClHandle<cl_program, clReleaseProgram>;
using ClKernel = ClHandle<cl_kernel, clReleaseKernel>;
using ClBuffer = ClHandle<cl_mem, clReleaseMemObject>;

struct ClRange {
  std::size_t x = 1, y = 1;
};

// One device with one program and one queue, in order. All calls throw DeviceFailure. Thread-compatible.
class ClDevice {
 public:
  // A GPU if there is one, else another device unless gpu_only.
  ClDevice(bool gpu_only, const std::string& source);

  std::string name() const;
  // How many items share a task: GROUP in the source. A CPU's threads have nothing to share.
  std::size_t group() const { return group_; }
  ClKernel kernel(const char* name) const;
  ClBuffer buffer(std::size_t bytes) const;
  void write(const ClBuffer& to, const void* from, std::size_t bytes) const;
  // `to` is filled, and must stay, until finish().
  void start_read(const ClBuffer& from, void* to, std::size_t bytes) const;
  void finish() const;
  void wait() const noexcept { clFinish(queue_.get()); }  // the same, whatever failed
  // The rows of an image, without gaps.
  void write_rows(const ClBuffer& to, const void* from, std::size_t cols, std::size_t rows, std::size_t stride) const;

  // Queues a kernel over `global` items, in groups of `group` along x.
  template <class... Arguments>
  void run(const ClKernel& kernel, ClRange global, std::size_t group, const Arguments&... arguments) const {
    cl_uint index = 0;
    (set(kernel, index++, arguments), ...);
    queue(kernel, global, group);
  }

 private:
  template <class T>
  static void set(const ClKernel& kernel, cl_uint index, const T& value) {
    if constexpr (std::is_same_v<T, ClBuffer>) {
      cl_mem memory = value.get();
      set_bytes(kernel, index, &memory, sizeof(memory));
    } else {
      set_bytes(kernel, index, &value, sizeof(value));
    }
  }
  static void set_bytes(const ClKernel& kernel, cl_uint index, const void* value, std::size_t bytes);
  void queue(const ClKernel& kernel, ClRange global, std::size_t group) const;

  cl_device_id device_ = nullptr;
  std::size_t group_ = 64;
  ClContext context_;
  ClQueue queue_;
  ClProgram program_;
};

}  // namespace coslam
