# Embeds the page's template, style, scripts and the plot library into the program: report.html stays one offline file,
# and the library itself is never part of this repository.
find_file(ALIDADE_D3 d3.min.js PATHS /usr/share/javascript/d3 NO_DEFAULT_PATH
          DOC "Plot library of report.html, version 3 (Debian package libjs-d3)")
if(NOT ALIDADE_D3)
  message(FATAL_ERROR "d3.min.js (version 3) was not found in /usr/share/javascript/d3: "
                      "install the Debian package libjs-d3, or set -DALIDADE_D3=/path/to/d3.min.js")
endif()
file(READ ${ALIDADE_D3} d3_head LIMIT 200)
if(NOT d3_head MATCHES "version:\"3\\.")
  message(FATAL_ERROR "${ALIDADE_D3}: not D3 version 3, which the page's scripts are written for")
endif()

function(alidade_embed name)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${name}.cc)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DNAME=${name} "-DINPUTS=${ARGN}" -DOUTPUT=${output}
            -P ${CMAKE_CURRENT_SOURCE_DIR}/embed_file.cmake
    DEPENDS ${ARGN} ${CMAKE_CURRENT_SOURCE_DIR}/embed_file.cmake
    COMMENT "Embedding ${name}"
    VERBATIM)
  target_sources(alidade_eval_report PRIVATE ${output})
  set_property(GLOBAL APPEND PROPERTY ALIDADE_EMBEDDED ${output})
endfunction()

set(assets ${CMAKE_CURRENT_SOURCE_DIR}/assets)
alidade_embed(kReportHtml ${assets}/report.html)
alidade_embed(kReportCss ${assets}/report.css)
set(scripts "")
foreach(script data state frame words rank plots bars tables map pairs efficiency frontend sections runs)
  list(APPEND scripts ${assets}/report_${script}.js)
endforeach()
alidade_embed(kReportScript ${scripts} ${assets}/report.js)
alidade_embed(kReportD3 ${ALIDADE_D3})

# An own target, so that the files are made without the libraries that the report links: clang-tidy needs only their text.
get_property(embedded GLOBAL PROPERTY ALIDADE_EMBEDDED)
add_custom_target(alidade_report_assets DEPENDS ${embedded})
add_dependencies(alidade_eval_report alidade_report_assets)
