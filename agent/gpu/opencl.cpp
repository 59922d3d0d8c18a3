// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/opencl.h"

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <array>
#include <type_traits>
#include <vector>

#include "agent/gpu/gpu_node.h"
#include "agent/gpu/shared.h"

namespace coslam {
namespace {

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

void check(cl_int status, const char* call) {
  if (status != CL_SUCCESS) throw DeviceFailure(std::string(call) + " failed with " + std::to_string(status));
}

cl_device_id first_device(cl_device_type type) {
  cl_uint count = 0;
  if (clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS) return nullptr;  // the loader has no platform: an error to it
  std::vector<cl_platform_id> platforms(count);
  check(clGetPlatformIDs(count, platforms.data(), nullptr), "clGetPlatformIDs");
  for (cl_platform_id platform : platforms) {
    cl_device_id device = nullptr;
    if (clGetDeviceIDs(platform, type, 1, &device, nullptr) == CL_SUCCESS) return device;
  }
  return nullptr;
}

std::string build_log(cl_program program, cl_device_id device) {
  std::size_t bytes = 0;
  clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &bytes);
  std::string log(bytes, '\0');
  clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, bytes, log.data(), nullptr);
  return log;
}

// A program, built once for all cameras of the process.
struct Built {
  Built(cl_device_id id, std::string text) : device(id), source(std::move(text)) {
    cl_int status = CL_SUCCESS;
    context.reset(clCreateContext(nullptr, 1, &device, nullptr, nullptr, &status));
    check(status, "clCreateContext");
    const char* lines = source.c_str();
    program.reset(clCreateProgramWithSource(context.get(), 1, &lines, nullptr, &status));
    check(status, "clCreateProgramWithSource");
    cl_device_type type = 0;
    check(clGetDeviceInfo(device, CL_DEVICE_TYPE, sizeof(type), &type, nullptr), "clGetDeviceInfo");
    // A CPU's threads have nothing to share.
    if ((type & CL_DEVICE_TYPE_CPU) != 0) group = 1;
    const std::string options = "-cl-std=CL1.2 -D GROUP=" + std::to_string(group);
    if (clBuildProgram(program.get(), 1, &device, options.c_str(), nullptr, nullptr) != CL_SUCCESS) {
      throw DeviceFailure("clBuildProgram failed: " + build_log(program.get(), device));
    }
  }

  bool is_of(cl_device_id id, const std::string& text) const { return device == id && source == text; }

  cl_device_id device;
  std::string source;
  std::size_t group = 64;
  ClContext context;
  ClProgram program;
};

class OpenClDevice final : public Device {
 public:
  explicit OpenClDevice(std::shared_ptr<const Built> built) : built_(std::move(built)) {
    cl_int status = CL_SUCCESS;
    queue_.reset(clCreateCommandQueue(built_->context.get(), built_->device, 0, &status));
    check(status, "clCreateCommandQueue");
  }

  std::string name() const override {
    std::array<char, 256> name{};
    check(clGetDeviceInfo(built_->device, CL_DEVICE_NAME, name.size() - 1, name.data(), nullptr), "clGetDeviceInfo");
    return std::string(name.data()) + " (OpenCL)";
  }
  std::size_t group() const override { return built_->group; }

  Handle kernel(const char* name) const override {
    cl_int status = CL_SUCCESS;
    cl_kernel kernel = clCreateKernel(built_->program.get(), name, &status);
    check(status, "clCreateKernel");
    return {kernel, [](void* k) { clReleaseKernel(static_cast<cl_kernel>(k)); }};
  }

  Handle memory(std::size_t bytes) const override {
    cl_int status = CL_SUCCESS;
    cl_mem memory = clCreateBuffer(built_->context.get(), CL_MEM_READ_WRITE, bytes, nullptr, &status);
    check(status, "clCreateBuffer");
    return {memory, [](void* m) { clReleaseMemObject(static_cast<cl_mem>(m)); }};
  }

  void start_write(const Handle& to, std::size_t offset, const void* from, std::size_t bytes) override {
    check(clEnqueueWriteBuffer(queue_.get(), static_cast<cl_mem>(to.get()), CL_FALSE, offset, bytes, from, 0, nullptr,
                               nullptr),
          "clEnqueueWriteBuffer");
  }

  void start_read(const Handle& from, void* to, std::size_t bytes) override {
    check(
        clEnqueueReadBuffer(queue_.get(), static_cast<cl_mem>(from.get()), CL_FALSE, 0, bytes, to, 0, nullptr, nullptr),
        "clEnqueueReadBuffer");
  }

  void finish() override { check(clFinish(queue_.get()), "clFinish"); }
  void wait() noexcept override { clFinish(queue_.get()); }

 private:
  void launch(const Handle& kernel, Items items, std::size_t group, std::span<const Argument> arguments) override {
    auto* const k = static_cast<cl_kernel>(kernel.get());
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      check(clSetKernelArg(k, static_cast<cl_uint>(i), arguments[i].bytes, arguments[i].data()), "clSetKernelArg");
    }
    const std::array<std::size_t, 2> global{items.x, items.y}, local{group, 1};
    check(clEnqueueNDRangeKernel(queue_.get(), k, 2, nullptr, global.data(), local.data(), 0, nullptr, nullptr),
          "clEnqueueNDRangeKernel");
  }

  const std::shared_ptr<const Built> built_;
  ClQueue queue_;
};

}  // namespace

std::unique_ptr<Device> opencl_device(bool gpu_only, const std::string& program) {
  if (gpu_only && !has_gpu_node()) throw NoDevice("this machine has no GPU that OpenCL could use");
  cl_device_id device = first_device(CL_DEVICE_TYPE_GPU);
  if (device == nullptr && !gpu_only) device = first_device(CL_DEVICE_TYPE_ALL);
  if (device == nullptr) throw NoDevice(gpu_only ? "OpenCL finds no GPU" : "OpenCL finds no device");
  return std::make_unique<OpenClDevice>(shared_of<Built>(device, program));
}

}  // namespace coslam
