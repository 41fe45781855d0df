# Writes OUTPUT, a C++ source that defines alidade::NAME as the concatenated text of INPUTS (';'-separated).
# Called at build time:  cmake -DNAME=... -DINPUTS=... -DOUTPUT=... -P embed_file.cmake
set(text "")
foreach(input IN LISTS INPUTS)
  file(READ "${input}" content)
  string(APPEND text "${content}")
endforeach()
if(text MATCHES "\\)EMBEDDED_TEXT\"")
  message(FATAL_ERROR "${INPUTS}: contains the end mark of the raw string it becomes")
endif()
file(WRITE "${OUTPUT}"
  "#include \"eval/report/report_assets.h\"\n\n"
  "const std::string_view alidade::${NAME} = R\"EMBEDDED_TEXT(${text})EMBEDDED_TEXT\";\n")
