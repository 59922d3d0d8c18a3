// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace coslam {

// CUDA driver's interface, as far as it is used, in the forms that all drivers since CUDA 4 have. Contexts, modules,
// functions and streams are opaque pointers; memory is a number of 64 bits.
struct CudaDriver {
  using Address = std::uint64_t;
  static constexpr int kCapabilityMajor = 75, kCapabilityMinor = 76;  // attributes of a device
  static constexpr unsigned kNotWithDefaultStream = 1;                // flag of a stream

  // The driver of this process. Throws NoDevice while there is none.
  static const CudaDriver& get();

  // Throws DeviceFailure, which names the call, unless the call's status is success.
  void check(int status, const char* call) const;

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

 private:
  CudaDriver();
};

}  // namespace coslam
