# With ALIDADE_DISTRIBUTE the program and the libraries are compiled for others: hardened, and without the folders of this machine, so
# that equal sources give equal bytes in any folder (scripts/packaging/reproducible.sh). Directory-wide: precompiled headers must have been
# compiled with the same flags. GCC takes the last prefix that fits: a build folder inside the sources has its own name.
if(ALIDADE_DISTRIBUTE)
  add_compile_options(
    "-ffile-prefix-map=${CMAKE_SOURCE_DIR}=alidade" "-ffile-prefix-map=${CMAKE_BINARY_DIR}=alidade/build"
    -fstack-protector-strong -fstack-clash-protection -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
  add_link_options(LINKER:-z,relro,-z,now)
endif()
