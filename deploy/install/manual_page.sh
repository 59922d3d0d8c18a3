#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# manual_page.sh HELP2MAN EMULATOR FOLDER VERSION FILE PROGRAM [SUBCOMMAND]: writes a packed manual page from what --help
# prints. EMULATOR, which may be empty, is the command that runs the programs.
set -euo pipefail
help2man=$1 emulator=$2 folder=$3 version=$4 file=$5
shift 5
# The first line of the help says what the program does; a page without it would have no name.
# shellcheck disable=SC2086  # a command of several words, or of none
what=$($emulator "$folder/$1" ${2:+"$2"} --help | sed -n '1s/; see .*//;1p')
page=$(printf '%s' "$*" | tr ' ' -)
# What --help does not say.
more() {
  printf '[EXIT STATUS]\n0: done. 1: it failed. 2: wrong usage. One sentence on standard error says why.\n'
  case $page in
    coslam-agent | coslam-server | coslam-bridge) printf '[FILES]\n/etc/coslam/%s.yaml: the configuration of its service\n' "${page#coslam-}" ;;
  esac
  printf '[SEE ALSO]\n.BR coslam (1),\n.BR coslam-agent (1),\n.BR coslam-server (1),\n.BR coslam-bridge (1).\n'
  printf 'Examples: /usr/share/doc/coslam/docs/quickstart.md. All options: /usr/share/doc/coslam/docs/configuration.md.\n'
}
"$help2man" --no-info --include=<(more) --version-string="$version" --name="$what" --source="CoSLAM $version" "${emulator:+$emulator }$folder/$*" |
  sed -e "s/^\.TH [^ ]*/.TH $(printf '%s' "$page" | tr '[:lower:]' '[:upper:]')/" -e "s/^$* \\\\-/$page \\\\-/" |
  gzip --best --no-name > "$file.new"
mv "$file.new" "$file"
