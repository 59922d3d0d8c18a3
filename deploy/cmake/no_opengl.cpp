// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0

// The functions of GLX that OpenCV's core asks for, where it is linked into a program that draws nothing. Without a
// context of OpenGL it leaves OpenGL alone.
extern "C" {
void* glXGetCurrentContext() { return nullptr; }
void* glXGetCurrentDisplay() { return nullptr; }
void* glXGetProcAddressARB(const unsigned char*) { return nullptr; }
}
