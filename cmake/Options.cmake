# Warnings, sanitizers and floating-point rules of our own targets; consumers inherit none of them.
add_library(curlidar_options INTERFACE)
target_compile_options(curlidar_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  -ffp-contract=off)  # the same bytes from every compiler
if(CURLIDAR_WERROR)
  target_compile_options(curlidar_options INTERFACE -Werror)
endif()
if(CURLIDAR_SANITIZE)
  target_compile_options(curlidar_options INTERFACE
    -fsanitize=${CURLIDAR_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(curlidar_options INTERFACE -fsanitize=${CURLIDAR_SANITIZE})
endif()
