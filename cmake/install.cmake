# What `cmake --install` puts where: the program, the pages, and the solver as a package that stands on its own. The
# package alone: cmake --install build --component solver --prefix DIR.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS gradus RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS gradus-compile RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/gradus COMPONENT solver)
install(TARGETS gradus-pictures LIBRARY DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/gradus)
install(FILES README.md CHANGELOG.md CONTRIBUTING.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
# Pages that these lead to.
install(FILES bench/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/bench)
install(FILES tests/references/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/tests/references)

# find_package(gradus), gradus::solver. Only what the solver needs is exported: an export that a library of the renderer
# got into would fail here, for it would name targets that are not in the set.
set(solver_targets gradus_solver gradus_device gradus_kernels)
set(solver_headers solver/poisson_solver.h solver/kernel_times.h runtime/device/buffer.h runtime/device/device.h
                   runtime/device/precision.h runtime/error.h)

# Users write <gradus/solver/poisson_solver.h>; the second folder is for the headers' own includes, which name files
# from the project's root.
target_include_directories(gradus_kernels INTERFACE
  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/gradus>)
target_compile_features(gradus_kernels INTERFACE cxx_std_20)
foreach(target IN LISTS solver_targets)
  string(REPLACE gradus_ "" exported_name ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${exported_name})
endforeach()
install(TARGETS ${solver_targets} EXPORT gradus_targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT solver)
foreach(header IN LISTS solver_headers)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/gradus/${folder} COMPONENT solver)
endforeach()

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/gradus)
install(EXPORT gradus_targets NAMESPACE gradus:: DESTINATION ${package_folder} COMPONENT solver)
configure_package_config_file(cmake/gradus-config.cmake.in ${PROJECT_BINARY_DIR}/gradus-config.cmake
                              INSTALL_DESTINATION ${package_folder})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/gradus-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/gradus-config.cmake ${PROJECT_BINARY_DIR}/gradus-config-version.cmake
        DESTINATION ${package_folder} COMPONENT solver)
