// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// participant_child DOMAIN [KEY_FILE]: a participant on the loopback device that only listens, until it is killed.
#include <sys/resource.h>
#include <unistd.h>

#include <string>

#include "common/wire/participant.h"

int main(int argc, char** argv) {
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);  // it may be stopped on purpose
  coslam::WireConfig config = coslam::loopback_config(std::stoi(argv[1]));
  if (argc > 2) config.key_file = argv[2];
  const coslam::Participant participant(config, "child");
  while (true) pause();
}
