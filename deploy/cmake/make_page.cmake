# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# cmake -D FROM=server/show/web/page -D TO=FOLDER -D OUT=FILE.cpp -D FALLBACK=no_page.cpp -D NODE=node -D NPM=npm -D TESTS=ON|OFF
#       -P make_page.cmake
#
# Bundles a copy of the page, so that nothing is written among the sources. Where the npm packages cannot be had, the
# server is built without it.
file(REMOVE ${TO}/left_out)
file(REMOVE_RECURSE ${TO}/src ${TO}/dev ${TO}/test)
file(COPY ${FROM}/ DESTINATION ${TO} PATTERN node_modules EXCLUDE PATTERN dist EXCLUDE)

set(omit --omit=dev)
if(TESTS)
  set(omit --include=dev)
endif()
# npm writes this file when it is done.
set(installed ${TO}/node_modules/.package-lock.json)
if(NOT EXISTS ${installed} OR ${TO}/package-lock.json IS_NEWER_THAN ${installed})
  message(NOTICE "page: npm ci")
  # Where there is no network, that is known after seconds.
  set(retries --fetch-retries=2 --fetch-retry-mintimeout=1000 --fetch-retry-maxtimeout=4000)
  execute_process(COMMAND ${NPM} ci ${omit} ${retries} --ignore-scripts --no-audit --no-fund WORKING_DIRECTORY ${TO} TIMEOUT 300
                  RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(failed)
    string(REGEX MATCH "npm (ERR!|error) code [A-Z0-9_]+" code "${said}")
    message(NOTICE "page: left out, because its npm packages cannot be had (${failed} ${code}): configure again to try again")
    file(REMOVE_RECURSE ${TO}/node_modules)
    file(TOUCH ${TO}/left_out)
    configure_file(${FALLBACK} ${OUT} COPYONLY)
    file(TOUCH ${OUT})
    return()
  endif()
  file(TOUCH ${installed})
endif()
execute_process(COMMAND ${NODE} build.mjs --cpp ${OUT} WORKING_DIRECTORY ${TO} COMMAND_ERROR_IS_FATAL ANY)
