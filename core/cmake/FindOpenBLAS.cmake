# Finds OpenBLAS, which carries LAPACK's routines too, and the C headers of both: imported target OpenBLAS::OpenBLAS.
# Debian keeps the header of LAPACK elsewhere (liblapacke-dev).
find_library(OpenBLAS_LIBRARY NAMES openblas DOC "OpenBLAS: Debian package libopenblas-pthread-dev")
find_path(OpenBLAS_INCLUDE_DIR NAMES cblas.h PATH_SUFFIXES openblas-pthread openblas x86_64-linux-gnu/openblas-pthread)
find_path(LAPACK_INCLUDE_DIR NAMES lapack.h DOC "lapack.h: Debian package liblapacke-dev")

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenBLAS
  REQUIRED_VARS OpenBLAS_LIBRARY OpenBLAS_INCLUDE_DIR LAPACK_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "install Debian's libopenblas-pthread-dev and liblapacke-dev")
if(OpenBLAS_FOUND AND NOT TARGET OpenBLAS::OpenBLAS)
  add_library(OpenBLAS::OpenBLAS UNKNOWN IMPORTED)
  set_target_properties(OpenBLAS::OpenBLAS PROPERTIES
    IMPORTED_LOCATION ${OpenBLAS_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES "${OpenBLAS_INCLUDE_DIR};${LAPACK_INCLUDE_DIR}")
endif()
mark_as_advanced(OpenBLAS_LIBRARY OpenBLAS_INCLUDE_DIR LAPACK_INCLUDE_DIR)
