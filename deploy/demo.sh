#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/demo.sh [--out DIR]
#
# From a fresh checkout to a map: installs what is missing, builds the programs, lets three cameras map a room together in
# which a man walks (deploy/demo, recorded in a simulation), measures the result against the simulation's truth and says
# where everything is.
#   --out DIR   where the result goes (default: result/ at the top of the source tree)
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

scene=$root/deploy/demo
out=$root/result
while [[ $# -gt 0 ]]; do
  case $1 in
    --out) need_value "$1" $# && out=$2 && shift ;;
    -h | --help) show_help && exit 0 ;;
    *) die_usage "unknown option '$1'" ;;
  esac
  shift
done
[[ -n $out ]] || die_usage "--out needs a folder"
[[ $out == /* ]] || out=$caller_dir/$out

start=$SECONDS
"$root/deploy/setup.sh" || exit
"$root/deploy/build.sh" --target coslam --target coslam-server --target coslam-agent || exit
coslam=$(build_dir release)/bin/coslam

step "run: three agents and a server on $scene"
"$coslam" run "$scene" --out "$out" --force || die "the run failed: the sentence above says why"

step "result: accuracy against the simulation's truth"
"$coslam" eval "$out" "$scene" || die "the evaluation failed: the sentence above says why"

# shown PATH WHAT: one line for what is there.
shown() { [[ ! -e $out/$1 ]] || printf '  %-24s %s\n' "$1" "$2"; }
printf '\nResult in %s (%d s in all):\n' "$out" $((SECONDS - start))
for picture in "$out"/*.png "$out"/*.svg; do
  shown "${picture#"$out"/}" 'picture'
done
shown map.ply 'static points, for any point cloud viewer'
shown trajectory 'one camera path an agent, TUM format'
shown dynamic.csv '3D paths of moving points'
shown report.json 'counts, times, bytes'
shown eval.json 'the accuracy figures above'
printf '\nNext: %s run SEQUENCE --out DIR on your own recording, see README.md.\n' "${coslam#"$caller_dir"/}"
