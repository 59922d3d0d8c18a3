#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# with_sample.sh PROGRAM FOLDER: has mcap_sample write a file and mcap_sample.mjs read it.
set -euo pipefail
file=$(mktemp --suffix=.mcap)
trap 'rm -f -- "$file"' EXIT
"$1" "$file"
bash "$(dirname -- "${BASH_SOURCE[0]}")/run.sh" "$2" mcap_sample.mjs "$file"
