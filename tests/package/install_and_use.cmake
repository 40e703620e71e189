# Installs the solver, moves it, configures the example against it, builds and runs that.
function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  message("== ${what}\n${output}")
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${what}: ${status}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run("install" ${CMAKE_COMMAND} --install ${BUILD} --config "${CONFIGURATION}" --component solver --prefix ${WORK}/first)
# A package that names the folder that it was installed to would not be found here.
file(RENAME ${WORK}/first ${WORK}/prefix)

file(GLOB_RECURSE compiler ${WORK}/prefix/gradus-compile)
if(NOT compiler)
  message(FATAL_ERROR "the package lacks gradus-compile, which compiles kernels for the library")
endif()

# What the renderer needs must not be asked for, nor found by a path of the build.
set(not_needed)
foreach(package IN ITEMS embree TBB OpenImageIO OpenEXR pugixml ZLIB CLI11 nlohmann_json GTest FFTW3)
  list(APPEND not_needed -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
run("configure" ${CMAKE_COMMAND} -S ${EXAMPLE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${WORK}/prefix "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror"
    ${not_needed})
run("build" ${CMAKE_COMMAND} --build ${WORK}/build)
run("run" ${WORK}/build/solver_example)

# Nothing of the package points back into the source or build tree.
file(GLOB_RECURSE texts ${WORK}/prefix/*.cmake ${WORK}/prefix/*.h)
get_filename_component(root ${EXAMPLE}/../../.. ABSOLUTE)
foreach(text IN LISTS texts)
  file(READ ${text} content)
  foreach(folder IN ITEMS ${root}/ ${BUILD})
    string(FIND "${content}" "${folder}" position)
    if(NOT position EQUAL -1)
      message(FATAL_ERROR "${text} names ${folder}")
    endif()
  endforeach()
endforeach()
