# `cpack` in the build folder: alidade_<version>_<arch>.deb and libalidade-dev_<version>_<arch>.deb.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME alidade)
set(CPACK_PACKAGE_VENDOR "The Alidade authors")
set(CPACK_PACKAGE_CONTACT "The Alidade authors <alidade@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "bench for GNSS-visual-inertial odometry estimators")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
# Archives must not be executable, nor folders writable by a group, whatever the umask was.
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "An invariant Kalman filter and a sliding-window smoother share one library
of measurement models. Includes a simulator, readers of EuRoC, TUM-VI and
ROS 1 bags, metrics and a self-contained HTML report.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME alidade)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "bash-completion, libalidade-dev, librsvg2-bin")

set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "These are the libraries: headers, archives and the CMake package;
find_package(alidade CONFIG) gives alidade::core, gnss, frontend, estimator, filter, smoother and eval.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libalidade-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
# What alidadeConfig.cmake looks for; the program's package holds the configurations.
string(JOIN ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "alidade (= ${PROJECT_VERSION})" pkg-config libeigen3-dev libceres-dev libopenblas-pthread-dev liblapacke-dev libboost-dev
  libboost-math-dev libgoogle-glog-dev libgflags-dev libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev
  libopencv-video-dev libopencv-calib3d-dev libopencv-features2d-dev libgeographiclib-dev libyaml-cpp-dev libssl-dev
  libcurl4-openssl-dev zlib1g-dev libbz2-dev liblz4-dev)

set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/strip_archives.cmake)

include(CPack)
