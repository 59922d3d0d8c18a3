#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# run.sh FOLDER SCRIPT.mjs [ARGUMENT...]
#
# Runs a script of this folder in FOLDER, where npm installs what package.json names. Exit code 77, for CTest a test that
# was skipped: there is no node or npm, or the packages cannot be had.
set -euo pipefail

skip() {
  echo "skipped: $*"
  exit 77
}

source=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
folder=$1
script=$2
shift 2
command -v node >/dev/null || skip "there is no node"
command -v npm >/dev/null || skip "there is no npm"
[[ $(node -p 'process.versions.node.split(".")[0]') -ge 18 ]] || skip "node is older than 18: $(node --version)"

mkdir -p -- "$folder"
(
  flock 9
  if ! cmp --silent -- "$source/package-lock.json" "$folder/installed-lock.json"; then
    cp -- "$source/package.json" "$source/package-lock.json" "$source/.npmrc" "$folder/"
    (cd -- "$folder" && timeout 150 npm ci --ignore-scripts --prefer-offline --no-progress >npm.log 2>&1) ||
      skip "npm cannot install what package-lock.json names: $(grep -m 1 'npm error' "$folder/npm.log" || tail -n 1 "$folder/npm.log")"
    cp -- "$source/package-lock.json" "$folder/installed-lock.json"
  fi
  cp -- "$source"/*.mjs "$folder/"
) 9>"$folder/lock"
exec node "$folder/$script" "$@"
