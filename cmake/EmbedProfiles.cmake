# Turns profiles/*.toml into one generated source file, so that the library needs no data files.
# Included by src/CMakeLists.txt it adds the file to the target `curlidar`; run with
# `cmake -DOUTPUT=... -DPROFILES=... -P` it writes the file.
if(CMAKE_SCRIPT_MODE_FILE)
  set(entries "")
  file(GLOB files ${PROFILES}/*.toml)
  list(SORT files)
  foreach(path ${files})
    get_filename_component(name ${path} NAME_WE)
    file(READ ${path} text)
    string(APPEND entries "    {\"${name}\", R\"toml(${text})toml\"},\n")
  endforeach()
  file(WRITE ${OUTPUT}
    "// Generated from profiles/*.toml; edit those.\n"
    "#include \"sensor/embedded_profiles.hpp\"\n\n"
    "namespace curlidar {\n"
    "namespace {\n"
    "constexpr EmbeddedProfile kProfiles[] = {\n${entries}};\n"
    "}  // namespace\n\n"
    "std::span<const EmbeddedProfile> embedded_profiles() { return kProfiles; }\n\n"
    "}  // namespace curlidar\n")
else()
  set(embedded_profiles ${CMAKE_CURRENT_BINARY_DIR}/embedded_profiles.cpp)
  file(GLOB profile_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/profiles/*.toml)
  add_custom_command(OUTPUT ${embedded_profiles}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${embedded_profiles} -DPROFILES=${PROJECT_SOURCE_DIR}/profiles
            -P ${CMAKE_CURRENT_LIST_FILE}
    DEPENDS ${profile_files} ${CMAKE_CURRENT_LIST_FILE}
    COMMENT "Embedding the sensor profiles" VERBATIM)
  target_sources(curlidar PRIVATE ${embedded_profiles})
endif()
