# alidade_install_library(core [INTERNAL header ...]) exports target alidade_core as alidade::core and installs its archive and
# the headers of the folder. They go to include/alidade/<folder>/, and include/alidade is the path of consumers: the lines
# `#include "core/lie.h"` of the installed headers find their own kind there and clash with nobody's.
# INTERNAL: headers that include packages of which a consumer is to know nothing.
function(alidade_install_library folder)
  cmake_parse_arguments(ARG "" "" "INTERNAL" ${ARGN})
  set(target alidade_${folder})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${folder})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/alidade>)
  install(TARGETS ${target} EXPORT alidade_targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)

  file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.h)
  list(REMOVE_ITEM headers ${ARG_INTERNAL})
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/alidade/${folder} COMPONENT development)
endfunction()
