# What a program outside this tree needs: headers, libraries, find_package(tmcl) and `pkg-config tmcl tmcl-client`.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tmcl)

install(TARGETS tmcl_core tmcl_motion tmcl tmcl_client EXPORT tmcl-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/tmcl DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
install(EXPORT tmcl-targets NAMESPACE tmcl:: DESTINATION ${package_dir})

configure_package_config_file(tmcl-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/tmcl-config.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/tmcl-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/tmcl-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/tmcl-config-version.cmake
  DESTINATION ${package_dir})

set(tmcl_pc_requires "Requires: fmt libusb-1.0")
set(tmcl_pc_libraries "-ltmcl -ltmcl_plan -ltmcl_core -pthread")
set(tmcl_pc_client_libraries "-ltmcl_client -lboost_json")
# Relative, so that the package works wherever it is installed or unpacked to.
file(RELATIVE_PATH include_from_pkgconfig ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_FULL_INCLUDEDIR})
foreach(name tmcl tmcl-client)
  configure_file(${name}.pc.in ${name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()
