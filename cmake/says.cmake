# A test of a program that ends with STATUS and writes what matches PATTERN; PASS_REGULAR_EXPRESSION alone looks at no status.
#
#   cmake -DSTATUS=N -DPATTERN=REGEX -P says.cmake -- PROGRAM ARGUMENT...

cmake_minimum_required(VERSION 3.21)

set(command)
set(begun FALSE)
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(i RANGE ${last})
  if(begun)
    string(REPLACE ";" "\\;" argument "${CMAKE_ARGV${i}}")
    list(APPEND command "${argument}")
  elseif(CMAKE_ARGV${i} STREQUAL "--")
    set(begun TRUE)
  endif()
endforeach()

execute_process(COMMAND ${command} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
message("${output}")
if(NOT status STREQUAL STATUS)
  message(FATAL_ERROR "it ended with ${status}; ${STATUS} is right")
endif()
if(NOT output MATCHES "${PATTERN}")
  message(FATAL_ERROR "it wrote nothing like '${PATTERN}'")
endif()
