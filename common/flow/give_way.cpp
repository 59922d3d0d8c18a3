// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/flow/give_way.h"

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

namespace coslam {

void give_way() {
  constexpr int kNice = 10;
  const sched_param usual{};
  sched_setscheduler(0, SCHED_BATCH, &usual);                     // woken, it waits for its turn
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);  // of this thread alone, on Linux
}

}  // namespace coslam
