#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/test-field.sh [--scene NAME]... [--only FAULT]... [--list]
#
# Runs agents and server on hosts of their own (network namespaces) and breaks links, clocks and processes between them; the
# tables at the end are those of docs/field.md. Needs the right to make network namespaces. About 12 minutes a scene.
#   --scene NAME   walking-man unless given; may be repeated
#   --only FAULT   one fault of --list beside the run without; may be repeated
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

scenes=()
options=()
untriggered=yes  # cameras that are rendered at another rate, which takes as long again
while [[ $# -gt 0 ]]; do
  case $1 in
    --scene) need_value "$1" $# && scenes+=("$2") && shift ;;
    --only)
      need_value "$1" $#
      [[ ${#options[@]} -gt 0 ]] || untriggered=no
      [[ $2 != *"not triggered"* ]] || untriggered=yes
      options+=(--only "$2")
      shift
      ;;
    --list) exec python3 "$root/tests/field/field.py" --bin . --sequence . --list ;;
    -h | --help) show_help && exit 0 ;;
    *) die_usage "unknown option '$1'" ;;
  esac
  shift
done
[[ ${#scenes[@]} -gt 0 ]] || scenes=(walking-man)

cd -- "$root"
deploy/setup.sh
deploy/build.sh
bin=$(build_dir release)/bin
folder=${TMPDIR:-/tmp}/coslam-field-$UID
for scene in "${scenes[@]}"; do
  step "field: $scene"
  [[ -f $folder/$scene/sequence.yaml ]] || "$bin/coslam" render "$scene" "$folder/$scene"
  other=()
  if [[ $untriggered == yes ]]; then
    other=(--untriggered "$folder/$scene-29.3/sequence.yaml")
    [[ -f ${other[1]} ]] || "$bin/coslam" render "$scene" "$folder/$scene-29.3" --rate-hz 29.3
  fi
  python3 tests/field/field.py "${other[@]}" --bin "$bin" --sequence "$folder/$scene/sequence.yaml" --out "$folder/$scene-results" \
    "${options[@]}"
done
