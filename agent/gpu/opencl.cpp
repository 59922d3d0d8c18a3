// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/opencl.h"

#include <array>
#include <vector>

#include "agent/gpu/opencl_matcher.h"

namespace coslam {
namespace {

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

}  // namespace

ClDevice::ClDevice(bool gpu_only, const std::string& source) : device_(first_device(CL_DEVICE_TYPE_GPU)) {
  if (device_ == nullptr && !gpu_only) device_ = first_device(CL_DEVICE_TYPE_ALL);
  if (device_ == nullptr) throw NoDevice(gpu_only ? "OpenCL finds no GPU" : "OpenCL finds no device");
  cl_int status = CL_SUCCESS;
  context_.reset(clCreateContext(nullptr, 1, &device_, nullptr, nullptr, &status));
  check(status, "clCreateContext");
  queue_.reset(clCreateCommandQueue(context_.get(), device_, 0, &status));
  check(status, "clCreateCommandQueue");
  const char* text = source.c_str();
  program_.reset(clCreateProgramWithSource(context_.get(), 1, &text, nullptr, &status));
  check(status, "clCreateProgramWithSource");
  cl_device_type type = 0;
  check(clGetDeviceInfo(device_, CL_DEVICE_TYPE, sizeof(type), &type, nullptr), "clGetDeviceInfo");
  if ((type & CL_DEVICE_TYPE_CPU) != 0) group_ = 1;
  const std::string options = "-cl-std=CL1.2 -D GROUP=" + std::to_string(group_);
  if (clBuildProgram(program_.get(), 1, &device_, options.c_str(), nullptr, nullptr) != CL_SUCCESS) {
    throw DeviceFailure("clBuildProgram failed: " + build_log(program_.get(), device_));
  }
}

std::string ClDevice::name() const {
  std::array<char, 256> name{};
  check(clGetDeviceInfo(device_, CL_DEVICE_NAME, name.size() - 1, name.data(), nullptr), "clGetDeviceInfo");
  return name.data();
}

ClKernel ClDevice::kernel(const char* name) const {
  cl_int status = CL_SUCCESS;
  ClKernel kernel(clCreateKernel(program_.get(), name, &status));
  check(status, "clCreateKernel");
  return kernel;
}

ClBuffer ClDevice::buffer(std::size_t bytes) const {
  cl_int status = CL_SUCCESS;
  ClBuffer buffer(clCreateBuffer(context_.get(), CL_MEM_READ_WRITE, bytes, nullptr, &status));
  check(status, "clCreateBuffer");
  return buffer;
}

void ClDevice::write(const ClBuffer& to, const void* from, std::size_t bytes) const {
  check(clEnqueueWriteBuffer(queue_.get(), to.get(), CL_TRUE, 0, bytes, from, 0, nullptr, nullptr),
        "clEnqueueWriteBuffer");
}

void ClDevice::start_read(const ClBuffer& from, void* to, std::size_t bytes) const {
  check(clEnqueueReadBuffer(queue_.get(), from.get(), CL_FALSE, 0, bytes, to, 0, nullptr, nullptr),
        "clEnqueueReadBuffer");
}

void ClDevice::finish() const { check(clFinish(queue_.get()), "clFinish"); }

void ClDevice::write_rows(const ClBuffer& to, const void* from, std::size_t cols, std::size_t rows,
                          std::size_t stride) const {
  const std::array<std::size_t, 3> origin{}, region{cols, rows, 1};
  check(clEnqueueWriteBufferRect(queue_.get(), to.get(), CL_TRUE, origin.data(), origin.data(), region.data(), cols, 0,
                                 stride, 0, from, 0, nullptr, nullptr),
        "clEnqueueWriteBufferRect");
}

void ClDevice::set_bytes(const ClKernel& kernel, cl_uint index, const void* value, std::size_t bytes) {
  check(clSetKernelArg(kernel.get(), index, bytes, value), "clSetKernelArg");
}

void ClDevice::queue(const ClKernel& kernel, ClRange global, std::size_t group) const {
  const std::array<std::size_t, 2> items{global.x, global.y}, groups{group, 1};
  check(
      clEnqueueNDRangeKernel(queue_.get(), kernel.get(), 2, nullptr, items.data(), groups.data(), 0, nullptr, nullptr),
      "clEnqueueNDRangeKernel");
}

}  // namespace coslam
