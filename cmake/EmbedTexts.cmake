# Turns text files into a generated source file, so that the library needs no data files: included, it
# offers curlidar_embed(); run with `cmake -DKIND=... -DFILES=... -DOUTPUT=... -P` it writes the file.
if(CMAKE_SCRIPT_MODE_FILE)
  set(entries "")
  file(GLOB files ${FILES})
  list(SORT files)
  foreach(path ${files})
    get_filename_component(name ${path} NAME_WE)
    file(READ ${path} text)
    # The length is given because compilers count no further than a million steps.
    string(LENGTH "${text}" length)
    string(APPEND entries "    {\"${name}\", {R\"text(${text})text\", ${length}}},\n")
  endforeach()
  file(WRITE ${OUTPUT}
    "// Generated from ${FILES}; edit those.\n"
    "#include \"base/embedded.hpp\"\n\n"
    "namespace curlidar {\n"
    "namespace {\n"
    "constexpr EmbeddedText kTexts[] = {\n${entries}};\n"
    "}  // namespace\n\n"
    "std::span<const EmbeddedText> embedded_${KIND}() { return kTexts; }\n\n"
    "}  // namespace curlidar\n")
  return()
endif()

set(curlidar_embed_script ${CMAKE_CURRENT_LIST_FILE})

# curlidar_embed(TARGET KIND PATTERN): adds embedded_KIND.cpp to the target, which defines
# embedded_KIND() (base/embedded.hpp) over the files of the project that match the pattern.
function(curlidar_embed target kind pattern)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/embedded_${kind}.cpp)
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${pattern})
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DKIND=${kind} -DFILES=${pattern} -DOUTPUT=${output}
            -P ${curlidar_embed_script}
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    DEPENDS ${files} ${curlidar_embed_script}
    COMMENT "Embedding ${pattern}" VERBATIM)
  # Texts may be longer than the 64 kB that every compiler must take; gcc and clang take them.
  set_source_files_properties(${output} PROPERTIES COMPILE_OPTIONS -Wno-overlength-strings)
  target_sources(${target} PRIVATE ${output})
endfunction()
