// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/map.h"

namespace coslam {

class ServerLoop;

// Somebody who watches a server at work. Called by the map's thread, which waits meanwhile.
class ServerObserver {
 public:
  ServerObserver() = default;
  virtual ~ServerObserver() = default;
  ServerObserver(const ServerObserver&) = delete;
  ServerObserver& operator=(const ServerObserver&) = delete;

  virtual void after_set(const FrameSet& set, const ServerLoop& loop) = 0;
  // Often, also while no frame set comes.
  virtual void in_between(const ServerLoop& loop) = 0;
  // No more frame sets come; the map is adjusted as a whole next.
  virtual void finishing(const ServerLoop& loop) = 0;
  virtual void finished(const ServerLoop& loop) = 0;
};

}  // namespace coslam
