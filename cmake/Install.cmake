# `cmake --install` and CPack. Two components: runtime (the command) and development (the library).
if(NOT CURLIDAR_INSTALL)
  return()
endif()
include(CMakePackageConfigHelpers)

set(CURLIDAR_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/curlidar)
install(TARGETS curlidar EXPORT curlidarTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  COMPONENT development FILES_MATCHING PATTERN "*.hpp")
install(EXPORT curlidarTargets NAMESPACE curlidar:: DESTINATION ${CURLIDAR_CMAKE_DIR}
  COMPONENT development)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/curlidarConfig.cmake.in
  ${PROJECT_BINARY_DIR}/curlidarConfig.cmake INSTALL_DESTINATION ${CURLIDAR_CMAKE_DIR})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/curlidarConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/curlidarConfig.cmake
              ${PROJECT_BINARY_DIR}/curlidarConfigVersion.cmake
  DESTINATION ${CURLIDAR_CMAKE_DIR} COMPONENT development)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libcurlidar-dev
  RENAME copyright COMPONENT development)

if(CURLIDAR_BUILD_APP)
  install(TARGETS curlidar_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/curlidar
    RENAME copyright COMPONENT runtime)
  # A rule for file(1): file -m PREFIX/share/curlidar/curlidar.magic scan.curl
  if(EXISTS ${PROJECT_SOURCE_DIR}/share/curlidar.magic)
    install(FILES ${PROJECT_SOURCE_DIR}/share/curlidar.magic
      DESTINATION ${CMAKE_INSTALL_DATADIR}/curlidar COMPONENT runtime)
  endif()
endif()

# `curlidar report`: scripts and measuring programs, where the benchmarks are built.
if(CURLIDAR_BUILD_APP AND CURLIDAR_BUILD_BENCH)
  set(report_folders report common peers rate_distortion raw)  # the last three: for their scripts
  list(TRANSFORM report_folders PREPEND ${PROJECT_SOURCE_DIR}/bench/)
  install(DIRECTORY ${report_folders}
    DESTINATION ${CMAKE_INSTALL_DATADIR}/curlidar COMPONENT report
    FILES_MATCHING PATTERN "*.py" PATTERN "published.toml"
    PATTERN "__pycache__" EXCLUDE PATTERN "measure" EXCLUDE)
  install(TARGETS report_measure rate_distortion
    RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/curlidar COMPONENT report)
  if(TARGET density)  # fits profiles for the section on upsampling
    install(TARGETS density
      RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/curlidar COMPONENT report)
  endif()
endif()

if(NOT PROJECT_IS_TOP_LEVEL)
  return()
endif()
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR "The curlidar authors")
set(CPACK_PACKAGE_CONTACT "The curlidar authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL development)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
if(CURLIDAR_BUILD_APP)
  list(PREPEND CPACK_COMPONENTS_ALL runtime)
endif()
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
"The command curlidar turns a LiDAR scan into a small file from which clouds of any
density are reconstructed; it also measures, converts, simulates and draws clouds.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME curlidar)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
"Static library, headers and CMake package of curlidar, which turns a LiDAR scan into a
small file from which clouds of any density are reconstructed.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libcurlidar-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libpng-dev, libzstd-dev, zlib1g-dev")
include(CPack)
