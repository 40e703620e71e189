# FFTW3::double, FFTW3::single, and FFTW3::single_threads, which is the latter with FFTW's threads. For tests and
# benchmarks only. Debian's package has no CMake configuration of its own.
find_path(FFTW3_INCLUDE_DIR fftw3.h)
find_library(FFTW3_LIBRARY fftw3)
find_library(FFTW3_SINGLE_LIBRARY fftw3f)
find_library(FFTW3_SINGLE_THREADS_LIBRARY fftw3f_threads)
mark_as_advanced(FFTW3_INCLUDE_DIR FFTW3_LIBRARY FFTW3_SINGLE_LIBRARY FFTW3_SINGLE_THREADS_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(FFTW3 REQUIRED_VARS FFTW3_LIBRARY FFTW3_SINGLE_LIBRARY FFTW3_SINGLE_THREADS_LIBRARY
                                                      FFTW3_INCLUDE_DIR)

if(FFTW3_FOUND AND NOT TARGET FFTW3::double)
  find_package(Threads REQUIRED)
  add_library(FFTW3::double UNKNOWN IMPORTED)
  set_target_properties(FFTW3::double PROPERTIES
    IMPORTED_LOCATION ${FFTW3_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${FFTW3_INCLUDE_DIR})
  add_library(FFTW3::single UNKNOWN IMPORTED)
  set_target_properties(FFTW3::single PROPERTIES
    IMPORTED_LOCATION ${FFTW3_SINGLE_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${FFTW3_INCLUDE_DIR})
  add_library(FFTW3::single_threads UNKNOWN IMPORTED)
  set_target_properties(FFTW3::single_threads PROPERTIES
    IMPORTED_LOCATION ${FFTW3_SINGLE_THREADS_LIBRARY} INTERFACE_LINK_LIBRARIES "FFTW3::single;Threads::Threads")
endif()
