// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Fast DDS under one set of names, whatever its version. What differs between 2.9 (Debian 12) and 3.1 (Debian 13)
// stands in the folders fastdds2 and fastdds3, which have the same headers with the same declarations; nothing else
// asks which version it is. Only for the sources of this folder and its tests: these headers are heavy.
#if __has_include(<fastdds/LibrarySettings.hpp>)
#include "common/wire/fastdds3/chained_transport.h"
#include "common/wire/fastdds3/discovery_listener.h"
#include "common/wire/fastdds3/message_cdr.h"
#include "common/wire/fastdds3/names.h"
#include "common/wire/fastdds3/sample_type.h"
#else
#include "common/wire/fastdds2/chained_transport.h"
#include "common/wire/fastdds2/discovery_listener.h"
#include "common/wire/fastdds2/message_cdr.h"
#include "common/wire/fastdds2/names.h"
#include "common/wire/fastdds2/sample_type.h"
#endif
