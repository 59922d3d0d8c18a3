// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/cuda_driver.h"

#include <string>

#include "agent/gpu/cuda_library.h"
#include "agent/gpu/device.h"

namespace coslam {

CudaDriver::CudaDriver() {
  const CudaLibrary library("driver", {"libcuda.so.1"});
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

const CudaDriver& CudaDriver::get() {
  static const CudaDriver driver;  // constructed anew by the next call where it threw
  return driver;
}

void CudaDriver::check(int status, const char* call) const {
  if (status == 0) return;
  const char* text = nullptr;
  error_string(status, &text);
  throw DeviceFailure(std::string(call) + " failed: " + (text != nullptr ? text : std::to_string(status).c_str()));
}

}  // namespace coslam
