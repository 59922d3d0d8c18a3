# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0

# Programs of another processor run in its emulator.
list(JOIN CMAKE_CROSSCOMPILING_EMULATOR " " emulator)

# manual_page(COMPONENT PROGRAM [SUBCOMMAND]): the page PROGRAM(1) or PROGRAM-SUBCOMMAND(1).
function(manual_page component program)
  set(words ${program} ${ARGN})
  list(JOIN words "-" page)
  list(JOIN words " " command)
  set(file ${CMAKE_CURRENT_BINARY_DIR}/${page}.1.gz)
  add_custom_command(
    OUTPUT ${file}
    COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/manual_page.sh ${COSLAM_HELP2MAN} "${emulator}" $<TARGET_FILE_DIR:${program}> ${PROJECT_VERSION} ${file} ${words}
    DEPENDS ${program} ${CMAKE_CURRENT_SOURCE_DIR}/manual_page.sh
    COMMENT "Writing the manual page of ${command}"
    VERBATIM)
  set_property(GLOBAL APPEND PROPERTY COSLAM_MANUAL_PAGES ${file})
  install(FILES ${file} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
endfunction()

manual_page(agent coslam-agent)
manual_page(server coslam-server)
manual_page(tools coslam)
manual_page(bridge coslam-bridge)
foreach(subcommand run replay render eval explain export map status doctor fleet view calibrate)
  manual_page(tools coslam ${subcommand})
endforeach()
get_property(pages GLOBAL PROPERTY COSLAM_MANUAL_PAGES)
add_custom_target(manual_pages ALL DEPENDS ${pages})
