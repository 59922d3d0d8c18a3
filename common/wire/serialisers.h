// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "common/wire/participant_impl.h"

namespace coslam {

// Makes the serialiser of the type of kTopics[topic], safe against what strangers send; samples that it cannot decode
// are counted.
dds::TopicDataType* make_serialiser(std::size_t topic, RejectionCounts& rejections);

}  // namespace coslam
