# What the packages libtmcl0 and libtmcl-dev have, and nothing else: one shared library of all the static ones, and
# a tmcl::tmcl, tmcl::client, ... that are it. `cmake --install` without --component leaves these out.
set(package_libdir lib/${CMAKE_LIBRARY_ARCHITECTURE})
set(package_build ${CMAKE_CURRENT_BINARY_DIR}/package)

file(CONFIGURE OUTPUT ${package_build}/all.cpp CONTENT "// All of it comes from the static libraries.\n")
add_library(tmcl_shared SHARED EXCLUDE_FROM_ALL ${package_build}/all.cpp)
# Each before those that it needs, or they come twice.
target_link_libraries(tmcl_shared PRIVATE tmcl_client tmcl tmcl_motion tmcl_core)
set_target_properties(tmcl_shared PROPERTIES OUTPUT_NAME tmcl
  LINK_LIBRARY_OVERRIDE "WHOLE_ARCHIVE,tmcl_core,tmcl_motion,tmcl,tmcl_client" LINKER_LANGUAGE CXX
  SOVERSION ${PROJECT_VERSION_MAJOR} VERSION ${PROJECT_VERSION} LIBRARY_OUTPUT_DIRECTORY ${package_build})
install(TARGETS tmcl_shared EXCLUDE_FROM_ALL LIBRARY DESTINATION ${package_libdir}
  COMPONENT library NAMELINK_COMPONENT dev)

set(package_library libtmcl.so.${PROJECT_VERSION_MAJOR})
configure_file(tmcl-package-targets.cmake.in ${package_build}/tmcl-targets.cmake @ONLY)
install(FILES ${package_build}/tmcl-targets.cmake ${CMAKE_CURRENT_BINARY_DIR}/tmcl-config.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/tmcl-config-version.cmake
  DESTINATION ${package_libdir}/cmake/tmcl COMPONENT dev EXCLUDE_FROM_ALL)

set(tmcl_pc_requires)
set(tmcl_pc_libraries "-ltmcl -pthread")
set(tmcl_pc_client_libraries "-lboost_json")
set(include_from_pkgconfig ../../../include)
foreach(name tmcl tmcl-client)
  configure_file(${name}.pc.in ${package_build}/${name}.pc @ONLY)
  install(FILES ${package_build}/${name}.pc DESTINATION ${package_libdir}/pkgconfig COMPONENT dev EXCLUDE_FROM_ALL)
endforeach()
