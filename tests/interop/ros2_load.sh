#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# tests/interop/ros2_load.sh [SECONDS] [RELIABLE] [LARGE]
#
# Three cameras of 640x480 (mono8) and LARGE (default 1) of 1920x1080 (bgr8), each at 30 Hz, from nodes made with Cyclone
# DDS on the loopback device (RELIABLE 1, the default, or 0), each heard for so long (default 60) as an agent does: a
# line each of what came. Build ros2_listener and cyclone_camera first.
set -euo pipefail
seconds=${1:-60}
reliable=${2:-1}
large=${3:-1}
programs=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../../build/test" && pwd)
domain=$((100 + $$ % 100))
export CYCLONEDDS_URI="<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1'/></Interfaces>
  <AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>
  <MaxAutoParticipantIndex>30</MaxAutoParticipantIndex><Peers><Peer address='127.0.0.1'/></Peers></Discovery>
  </Domain></CycloneDDS>"
cameras=()
trap 'kill "${cameras[@]}"' EXIT

camera() { # TOPIC WIDTH HEIGHT STEP ENCODING
  "$programs/cyclone_camera" domain="$domain" topic="$1" width="$2" height="$3" step="$4" encoding="$5" rate=30 \
    reliable="$reliable" &
  cameras+=($!)
  "$programs/ros2_listener" "ros2:$1?domain=$domain" "$seconds" "$2" "$3" "$5" &
  listeners+=($!)
}
listeners=()
for i in 1 2 3; do camera "/small_$i" 640 480 640 mono8; done
for ((i = 1; i <= large; ++i)); do camera "/large_$i" 1920 1080 5760 bgr8; done
for listener in "${listeners[@]}"; do wait "$listener"; done
