# alidade_sources(<variable>): the sources of the current folder, in alphabetical order; a new one is found by itself.
macro(alidade_sources variable)
  file(GLOB ${variable} CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.cc)
endmacro()

# alidade_add_room(<folder> <room> [TEXT] [PUBLIC target ...] [PRIVATE target ...] [INTERNAL header ...]): the library of one room from the
# sources of its folder, target alidade_<folder>_<room>, exported as alidade::<folder>_<room>. What a room may include:
# scripts/layers.txt. TEXT: see alidade_compile_fast.
function(alidade_add_room folder room)
  cmake_parse_arguments(ARG "TEXT" "" "PUBLIC;PRIVATE;INTERNAL" ${ARGN})
  set(target alidade_${folder}_${room})
  alidade_sources(sources)
  add_library(${target} STATIC ${sources})
  add_library(alidade::${folder}_${room} ALIAS ${target})
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE $<BUILD_INTERFACE:alidade_options> ${ARG_PRIVATE})
  if(ARG_TEXT)
    alidade_compile_fast(${target} TEXT)
  else()
    alidade_compile_fast(${target})
  endif()
  alidade_install_library(${target} ${folder}_${room} INTERNAL ${ARG_INTERNAL})
endfunction()

# alidade_headers(<target> [LIBRARIES library ...] [HEADERS header ...]): precompiled headers for other targets to start from, those of
# core and these, which may belong to the libraries. ccache stays out of it: GCC knows the headers in a precompiled one by their times too,
# which a cached one has from another checkout, and would read them twice.
function(alidade_headers target)
  cmake_parse_arguments(ARG "" "" "LIBRARIES;HEADERS" ${ARGN})
  add_library(${target} OBJECT ${CMAKE_SOURCE_DIR}/core/cmake/precompiled.cc)
  target_link_libraries(${target} PRIVATE alidade_options ${ARG_LIBRARIES})
  target_precompile_headers(${target} PRIVATE ${ALIDADE_CORE_HEADERS} ${ARG_HEADERS})
  set_target_properties(${target} PROPERTIES CXX_COMPILER_LAUNCHER "")
endfunction()

# alidade_compile_fast(<target> [TEXT]): the target's sources start from the precompiled headers of the target ALIDADE_HEADERS, by default
# those of core. With ALIDADE_UNITY they are compiled in groups of eight, which parses headers and instantiates templates once a group:
# names in anonymous namespaces must differ within a target. TEXT: a room that reads, writes and arranges more than it computes; -O2
# compiles it faster than -O3, and it starts from alidade_text_headers.
function(alidade_compile_fast target)
  cmake_parse_arguments(ARG "TEXT" "" "" ${ARGN})
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${ALIDADE_UNITY} UNITY_BUILD_BATCH_SIZE 8)
  if(ARG_TEXT)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O2>)
    target_precompile_headers(${target} REUSE_FROM alidade_text_headers)
  elseif(DEFINED ALIDADE_HEADERS)
    target_precompile_headers(${target} REUSE_FROM ${ALIDADE_HEADERS})
  else()
    target_precompile_headers(${target} REUSE_FROM alidade_core_headers)
  endif()
endfunction()

# alidade_add_rooms(<folder> room ...): the rooms, lowest first, and alidade::<folder>, which is all of them.
function(alidade_add_rooms folder)
  set(targets "")
  foreach(room ${ARGN})
    add_subdirectory(${room})
    list(APPEND targets alidade_${folder}_${room})
  endforeach()
  add_library(alidade_${folder} INTERFACE)
  add_library(alidade::${folder} ALIAS alidade_${folder})
  target_link_libraries(alidade_${folder} INTERFACE ${targets})
  set_target_properties(alidade_${folder} PROPERTIES EXPORT_NAME ${folder})
  install(TARGETS alidade_${folder} EXPORT alidade_targets)
endfunction()

# alidade_install_library(<target> <export name> [INTERNAL header ...]) exports the target, and installs its archive and the
# headers of the folder. They go to include/alidade/<folder>/, and include/alidade is the path of consumers: the lines
# `#include "core/lie.h"` of the installed headers find their own kind there and clash with nobody's.
# INTERNAL: headers that include packages of which a consumer is to know nothing.
function(alidade_install_library target name)
  cmake_parse_arguments(ARG "" "" "INTERNAL" ${ARGN})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/alidade>)
  install(TARGETS ${target} EXPORT alidade_targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)

  file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.h)
  list(REMOVE_ITEM headers ${ARG_INTERNAL})
  file(RELATIVE_PATH folder ${CMAKE_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/alidade/${folder} COMPONENT development)
endfunction()
