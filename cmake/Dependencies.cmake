# Debian packages only; ./dev installs them by name.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(nanoflann 1.4 REQUIRED)
find_package(fmt 9 REQUIRED)
# Only its headers, which then declare functions; src/base/fmt_once.cpp defines them, once.
add_library(curlidar_fmt INTERFACE)
target_include_directories(curlidar_fmt SYSTEM
  INTERFACE $<TARGET_PROPERTY:fmt::fmt-header-only,INTERFACE_INCLUDE_DIRECTORIES>)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(Threads REQUIRED)
find_path(TOMLPLUSPLUS_INCLUDE_DIR toml++/toml.h REQUIRED)

# Static archives of the compressed-bytes and PNG libraries, so that the executable runs when
# copied alone. Consumers of the installed library link what find_package gives them instead
# (cmake/curlidarConfig.cmake.in).
find_path(ZSTD_INCLUDE_DIR zstd.h REQUIRED)
find_library(ZSTD_STATIC_LIBRARY NAMES libzstd.a zstd REQUIRED)
find_path(PNG_INCLUDE_DIR png.h REQUIRED)
find_library(PNG_STATIC_LIBRARY NAMES libpng16.a libpng.a png REQUIRED)
find_library(ZLIB_STATIC_LIBRARY NAMES libz.a z REQUIRED)
mark_as_advanced(TOMLPLUSPLUS_INCLUDE_DIR ZSTD_INCLUDE_DIR ZSTD_STATIC_LIBRARY PNG_INCLUDE_DIR
                 PNG_STATIC_LIBRARY ZLIB_STATIC_LIBRARY)

if(CURLIDAR_BUILD_APP)
  find_package(CLI11 2.1 REQUIRED)
endif()
