// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

namespace coslam::test {

// Programs made with Cyclone DDS that are started from now on talk on the loopback device alone, as nodes do with
// ROS_LOCALHOST_ONLY=1: Cyclone leaves that device out unless told.
inline void keep_cyclone_here() {
  setenv("CYCLONEDDS_URI",
         "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1'/></Interfaces>"
         "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
         "<MaxAutoParticipantIndex>30</MaxAutoParticipantIndex><Peers><Peer address='127.0.0.1'/></Peers></Discovery>"
         "</Domain></CycloneDDS>",
         1);
}

}  // namespace coslam::test
