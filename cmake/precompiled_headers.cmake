# A library of nothing but precompiled headers, which others take by target_precompile_headers(... REUSE_FROM NAME): they
# must be compiled with the same options. gradus_precompiled_headers(NAME [LIBRARIES ...] [OPTIONS ...] HEADERS <a> ...)
function(gradus_precompiled_headers name)
  cmake_parse_arguments(PARSE_ARGV 1 argument "" "" "LIBRARIES;OPTIONS;HEADERS")
  add_library(${name} OBJECT ${PROJECT_SOURCE_DIR}/cmake/precompiled_headers.cpp)
  target_compile_options(${name} PRIVATE ${argument_OPTIONS})
  target_link_libraries(${name} PRIVATE ${argument_LIBRARIES} Threads::Threads)
  target_precompile_headers(${name} PRIVATE ${argument_HEADERS})
endfunction()
