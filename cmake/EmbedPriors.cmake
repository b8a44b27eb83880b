# Turns docs/format/priors/*.txt into one generated source file, so that the library needs no data
# files. Included by src/CMakeLists.txt it adds the file to the target `curlidar`; run with
# `cmake -DOUTPUT=... -DPRIORS=... -P` it writes the file.
if(CMAKE_SCRIPT_MODE_FILE)
  set(entries "")
  file(GLOB files ${PRIORS}/*.txt)
  list(SORT files)
  foreach(path ${files})
    get_filename_component(name ${path} NAME_WE)
    file(READ ${path} text)
    string(APPEND entries "    {\"${name}\", R\"(${text})\"},\n")
  endforeach()
  file(WRITE ${OUTPUT}
    "// Generated from docs/format/priors; edit the files there.\n"
    "#include \"entropy/embedded_priors.hpp\"\n\n"
    "namespace curlidar {\n"
    "namespace {\n"
    "struct Table {\n  std::string_view name, text;\n};\n"
    "constexpr Table kTables[] = {\n${entries}};\n"
    "}  // namespace\n\n"
    "std::string_view embedded_priors(std::string_view name) {\n"
    "  for (const Table& table : kTables) {\n    if (table.name == name) return table.text;\n  }\n"
    "  return {};\n}\n\n"
    "}  // namespace curlidar\n")
else()
  set(embedded_priors ${CMAKE_CURRENT_BINARY_DIR}/embedded_priors.cpp)
  set(priors_folder ${PROJECT_SOURCE_DIR}/docs/format/priors)
  file(GLOB priors_files CONFIGURE_DEPENDS ${priors_folder}/*.txt)
  add_custom_command(OUTPUT ${embedded_priors}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${embedded_priors} -DPRIORS=${priors_folder}
            -P ${CMAKE_CURRENT_LIST_FILE}
    DEPENDS ${priors_files} ${CMAKE_CURRENT_LIST_FILE}
    COMMENT "Embedding the priors" VERBATIM)
  target_sources(curlidar PRIVATE ${embedded_priors})
endif()
