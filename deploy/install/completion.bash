# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# Completion of coslam, coslam-agent, coslam-server and coslam-bridge in bash, from what their --help prints.

_coslam() {
  local current=${COMP_WORDS[COMP_CWORD]} program=${COMP_WORDS[0]} subcommand='' words
  if [[ ${program##*/} == coslam ]]; then
    if [[ $COMP_CWORD -eq 1 ]]; then
      words=$("$program" --help 2>/dev/null | awk '/^Subcommands:/ { on = 1; next } on && NF { print $1 }')
      mapfile -t COMPREPLY < <(compgen -W "$words --help --version" -- "$current")
      return
    fi
    subcommand=${COMP_WORDS[1]}
  fi
  if [[ $subcommand =~ ^(map|fleet)$ && $COMP_CWORD -eq 2 ]]; then
    words=$("$program" "$subcommand" --help 2>/dev/null | awk '/^Subcommands:/ { on = 1; next } on && NF { print $1 }')
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
    return
  fi
  if [[ ${COMP_WORDS[COMP_CWORD - 1]} == --format ]]; then
    words=$("$program" "$subcommand" --help 2>/dev/null | sed -n 's/^ *--format TEXT:{\(.*\)}.*/\1/p')
    mapfile -t COMPREPLY < <(compgen -W "${words//,/ }" -- "$current")
    return
  fi
  # Bash takes the colon for a word of its own.
  if [[ ${COMP_WORDS[COMP_CWORD - 1]}$current == sim: || ${COMP_WORDS[COMP_CWORD - 2]-}${COMP_WORDS[COMP_CWORD - 1]} == sim: ]]; then
    words=$("$program" render --help 2>/dev/null | sed -n 's/.*one of: //p')
    mapfile -t COMPREPLY < <(compgen -W "${words//,/ }" -- "${current#:}")
    return
  fi
  case $current in
    -*)
      words=$("$program" ${subcommand:+"$subcommand"} --help 2>/dev/null | grep --only-matching -E -e '^ +(-h,)?--[a-z-]+' | sed 's/.*--/--/')
      mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
      ;;
    *) mapfile -t COMPREPLY < <(compgen -f -- "$current") ;;
  esac
}
complete -o filenames -F _coslam coslam coslam-agent coslam-server coslam-bridge
