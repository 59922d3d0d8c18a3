#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# manual_page.sh HELP2MAN FOLDER VERSION FILE PROGRAM [SUBCOMMAND]: writes a packed manual page from what --help prints.
set -euo pipefail
help2man=$1 folder=$2 version=$3 file=$4
shift 4
# The first line of the help says what the program does; a page without it would have no name.
what=$("$folder/$1" ${2:+"$2"} --help | sed -n '1s/; see .*//;1p')
page=$(printf '%s' "$*" | tr ' ' -)
"$help2man" --no-info --version-string="$version" --name="$what" --source="CoSLAM $version" "$folder/$*" |
  sed -e "s/^\.TH [^ ]*/.TH $(printf '%s' "$page" | tr '[:lower:]' '[:upper:]')/" -e "s/^$* \\\\-/$page \\\\-/" |
  gzip --best --no-name > "$file.new"
mv "$file.new" "$file"
