// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What program/*.cl take from OpenCL C, in CUDA C++: text for NVRTC, in front of them.
// The names with underscores, since __global__ is an attribute called global.
#define __kernel extern "C" __global__
#define __global
#define __local
#define __constant
#define GROUP_MEMORY __shared__
#define CLK_LOCAL_MEM_FENCE
#define barrier(fence) __syncthreads()
#define INFINITY __int_as_float(0x7f800000)
#define FLOAT2(x, y) make_float2(x, y)
#define FLOAT3(x, y, z) make_float3(x, y, z)
#define FLOAT4(x, y, z, w) make_float4(x, y, z, w)
#define INT3(x, y, z) make_int3(x, y, z)
#define sqrt sqrtf
#define fabs fabsf
#define rint rintf

typedef unsigned char uchar;

static int get_local_id(int) { return (int)threadIdx.x; }
static int get_group_id(int axis) { return (int)(axis == 0 ? blockIdx.x : blockIdx.y); }
static int get_global_id(int axis) {
  return (int)(axis == 0 ? blockIdx.x * blockDim.x + threadIdx.x : blockIdx.y * blockDim.y + threadIdx.y);
}

static int clamp(int v, int low, int high) { return min(max(v, low), high); }
static float clamp(float v, float low, float high) { return fminf(fmaxf(v, low), high); }

static float2 operator+(float2 a, float2 b) { return FLOAT2(a.x + b.x, a.y + b.y); }
static float2 operator-(float2 a, float2 b) { return FLOAT2(a.x - b.x, a.y - b.y); }
static float2 operator-(float2 a, float s) { return FLOAT2(a.x - s, a.y - s); }
static float2 operator*(float2 a, float s) { return FLOAT2(a.x * s, a.y * s); }
static float2 operator*(float s, float2 a) { return a * s; }
static float2 operator/(float2 a, float s) { return FLOAT2(a.x / s, a.y / s); }
static void operator-=(float2& a, float2 b) { a = a - b; }
static float dot(float2 a, float2 b) { return a.x * b.x + a.y * b.y; }
static float length(float2 a) { return sqrtf(dot(a, a)); }

static float3 operator/(float3 a, float s) { return FLOAT3(a.x / s, a.y / s, a.z / s); }

static float4 operator/(float4 a, float s) { return FLOAT4(a.x / s, a.y / s, a.z / s, a.w / s); }
static void operator/=(float4& a, float s) { a = a / s; }
static void operator*=(float4& a, float s) { a = FLOAT4(a.x * s, a.y * s, a.z * s, a.w * s); }

static int3 operator*(int s, int3 a) { return INT3(s * a.x, s * a.y, s * a.z); }
static int3 operator>>(int3 a, int bits) { return INT3(a.x >> bits, a.y >> bits, a.z >> bits); }
static void operator+=(int3& a, int3 b) { a = INT3(a.x + b.x, a.y + b.y, a.z + b.z); }
static void vstore3(int3 v, int at, int* to) {
  to[3 * at] = v.x;
  to[3 * at + 1] = v.y;
  to[3 * at + 2] = v.z;
}
