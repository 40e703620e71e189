# Writes the names of a GoogleTest program's suites to a file, as a list of CMake: the variable `suites`.
#
#   cmake -D PROGRAM=... -D OUTPUT=... -P list_suites.cmake
cmake_minimum_required(VERSION 3.22)

execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE output RESULT_VARIABLE result TIMEOUT 60)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: ${result}\n${output}")
endif()
# Suites begin their line and end in a dot, after which the type may follow as a comment; tests are indented.
string(REGEX MATCHALL "(^|\n)[A-Za-z_][A-Za-z_0-9/]*\\.[ \n]" lines "${output}")
set(suites "")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "[\n. ]" "" suite "${line}")
  list(APPEND suites ${suite})
endforeach()
if(NOT suites)
  message(FATAL_ERROR "${PROGRAM} has no tests:\n${output}")
endif()
file(WRITE ${OUTPUT} "set(suites ${suites})\n")
