# Finds GeographicLib, whose own CMake package Debian ships outside CMake's search path: imported target
# GeographicLib::GeographicLib.
find_library(GeographicLib_LIBRARY NAMES GeographicLib DOC "GeographicLib: Debian package libgeographiclib-dev")
find_path(GeographicLib_INCLUDE_DIR NAMES GeographicLib/Geocentric.hpp)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(GeographicLib
  REQUIRED_VARS GeographicLib_LIBRARY GeographicLib_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "install Debian's libgeographiclib-dev")
if(GeographicLib_FOUND AND NOT TARGET GeographicLib::GeographicLib)
  add_library(GeographicLib::GeographicLib UNKNOWN IMPORTED)
  set_target_properties(GeographicLib::GeographicLib PROPERTIES
    IMPORTED_LOCATION ${GeographicLib_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${GeographicLib_INCLUDE_DIR})
endif()
mark_as_advanced(GeographicLib_LIBRARY GeographicLib_INCLUDE_DIR)
