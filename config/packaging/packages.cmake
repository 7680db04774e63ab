# Debian packages: cmake --build --preset release --target package. They go to the folder `packages` of the build.
#
# A target of our own, because CPack's would first build all tests. What only packages have is installed with
# EXCLUDE_FROM_ALL, so that `cmake --install` leaves it out.
set(packaging ${CMAKE_CURRENT_LIST_DIR})

# ---- what tmcld is as a service ----------------------------------------------------------------

install(FILES ${packaging}/tmcld.toml DESTINATION /etc/tmcl COMPONENT tmcld EXCLUDE_FROM_ALL)
install(DIRECTORY DESTINATION /etc/tmcl/tmcld.d COMPONENT tmcld EXCLUDE_FROM_ALL)
install(FILES ${PROJECT_SOURCE_DIR}/config/systemd/tmcld.service ${PROJECT_SOURCE_DIR}/config/systemd/tmcld.socket
  DESTINATION lib/systemd/system COMPONENT tmcld EXCLUDE_FROM_ALL)
install(FILES ${PROJECT_SOURCE_DIR}/config/sysusers/tmcld.conf
  DESTINATION lib/sysusers.d COMPONENT tmcld EXCLUDE_FROM_ALL)
install(FILES ${PROJECT_SOURCE_DIR}/config/udev/60-tmcl.rules
  DESTINATION lib/udev/rules.d COMPONENT tmcld EXCLUDE_FROM_ALL)

# ---- the packages ------------------------------------------------------------------------------

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tmcl)
# A distributor of packages says here who they are.
set(TMCL_PACKAGE_MAINTAINER "The libtmcl authors <libtmcl@localhost>" CACHE STRING "Maintainer of the Debian packages")
set(CPACK_PACKAGE_CONTACT ${TMCL_PACKAGE_MAINTAINER})
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_PRE_BUILD_SCRIPTS ${packaging}/stage.cmake)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/libtmcl/package)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# Until version 1 the library of each version is another one.
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=")


# tmcl_package(COMPONENT NAME SECTION SYNOPSIS DESCRIPTION [DEPENDS ...] [RECOMMENDS ...] [EXTRA ...]):
# EXTRA are files of config/packaging for the package's control.
macro(tmcl_package component name section synopsis description)
  cmake_parse_arguments(package "" "" "DEPENDS;RECOMMENDS;EXTRA" ${ARGN})
  string(TOUPPER ${component} key)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${synopsis}\n${description}")
  list(JOIN package_DEPENDS ", " CPACK_DEBIAN_${key}_PACKAGE_DEPENDS)
  list(JOIN package_RECOMMENDS ", " CPACK_DEBIAN_${key}_PACKAGE_RECOMMENDS)
  list(TRANSFORM package_EXTRA PREPEND ${packaging}/${component}/ OUTPUT_VARIABLE CPACK_DEBIAN_${key}_PACKAGE_CONTROL_EXTRA)
endmacro()

tmcl_package(tools tmcl-tools electronics "command line for motors on TMCL modules"
  "tmclctl moves axes, reads and sets parameters, draws movements, loads
programs and firmware: through tmcld, or straight on a serial port, a CAN
interface or a TCP converter. TMCM modules by Trinamic (Analog Devices)
speak TMCL."
  RECOMMENDS tmcld)
tmcl_package(tmcld tmcld electronics "gateway to motors on TMCL modules, for many programs"
  "tmcld owns the buses that TMCM modules are on and lets many programs use
their axes safely: stops come first, nothing that moves a motor is repeated
on suspicion, and the holder of a lease has its axes alone. Members of
the group tmcl may use it."
  DEPENDS "systemd | systemd-standalone-sysusers" RECOMMENDS tmcl-tools
  EXTRA conffiles postinst prerm postrm)
if(TARGET tmcld-mqtt)
  install(FILES ${packaging}/mqtt.toml DESTINATION /etc/tmcl COMPONENT mqtt EXCLUDE_FROM_ALL)
  install(FILES ${PROJECT_SOURCE_DIR}/config/systemd/tmcld-mqtt.service
    DESTINATION lib/systemd/system COMPONENT mqtt EXCLUDE_FROM_ALL)
  install(FILES ${PROJECT_SOURCE_DIR}/config/sysusers/tmcld-mqtt.conf
    DESTINATION lib/sysusers.d COMPONENT mqtt EXCLUDE_FROM_ALL)
  tmcl_package(mqtt tmcld-mqtt electronics "puts a gateway to TMCL modules on an MQTT broker"
    "tmcld-mqtt says on an MQTT 5 broker how the axes of a tmcld are, and brings
calls and stops from there. No command is ever stored: what was held back
on its way is refused. Other clients of tmcld use the same axes beside it."
    DEPENDS "tmcld (= ${PROJECT_VERSION})" "systemd | systemd-standalone-sysusers" RECOMMENDS mosquitto-clients
    EXTRA conffiles postinst prerm postrm)
endif()
tmcl_package(sim tmcl-sim electronics "simulated TMCL modules, with the ramps of the real ones"
  "tmclsim stands in for TMCM modules on a pseudo terminal, a TCP port, a CAN
interface or as a USB device. Its ramps are those of the ramp generators of
the chips, tick by tick.")
tmcl_package(library libtmcl0 libs "library to move motors on TMCL modules"
  "The protocol of TMCM modules with what it does not say by itself, motions
planned and predicted, and the same axes through tmcld. C++20, on Boost.Asio
or blocking."
  EXTRA triggers postinst postrm)
# Each release of Debian has its own.
set(boost ${Boost_VERSION_MAJOR}.${Boost_VERSION_MINOR})
tmcl_package(dev libtmcl-dev libdevel "library to move motors on TMCL modules (development files)"
  "Headers, examples and what CMake and pkg-config want to know to build
programs with libtmcl."
  DEPENDS "libtmcl0 (= ${PROJECT_VERSION})" libboost${boost}-dev libboost-json${boost}-dev libexpected-dev libfmt-dev libusb-1.0-0-dev
  pkgconf)

tmcl_package(python python3-tmcl python "motors on TMCL modules, through tmcld, from Python"
  "Axes by name and in their units, over the socket of tmcld or over HTTPS;
blocking and with asyncio. Standard library only."
  DEPENDS python3:any RECOMMENDS tmcld EXTRA postinst prerm)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)

tmcl_package(tango tmcl-tango electronics "motors on TMCL modules as devices of Tango"
  "tmcl-tango is a Tango device server with one device for each axis of a
tmcld: states, units, limits and events. Other clients of tmcld use the
same axes beside it."
  DEPENDS python3:any "python3-tmcl (= ${PROJECT_VERSION})" python3-tango RECOMMENDS tmcld)
set(CPACK_DEBIAN_TANGO_PACKAGE_ARCHITECTURE all)
tmcl_package(hal tmcl-hal electronics "motors on TMCL modules as auxiliary axes of LinuxCNC"
  "tmcl-hal is a userspace component of LinuxCNC's HAL with pins for each axis
of a tmcld. Other clients of tmcld use the same axes beside it. It is not
for joints of the trajectory planner."
  DEPENDS python3:any "python3-tmcl (= ${PROJECT_VERSION})" linuxcnc-uspace RECOMMENDS tmcld)
set(CPACK_DEBIAN_HAL_PACKAGE_ARCHITECTURE all)
tmcl_package(secop tmcl-secop electronics "motors on TMCL modules as modules of Frappy (SECoP)"
  "A Drivable for Frappy, which Debian does not have, for each axis of a tmcld:
status, stop and errors with their causes. Other clients of tmcld use the
same axes beside it."
  DEPENDS python3:any "python3-tmcl (= ${PROJECT_VERSION})" RECOMMENDS tmcld EXTRA postinst prerm)
set(CPACK_DEBIAN_SECOP_PACKAGE_ARCHITECTURE all)
tmcl_package(epics tmcl-ioc electronics "motors on TMCL modules as motor records of EPICS"
  "tmcl-ioc is an EPICS IOC on caproto, which Debian does not have, with a
record like a motor record for each axis of a tmcld: moves, jogs, alarms
with their causes. Other clients of tmcld use the same axes beside it."
  DEPENDS python3:any "python3-tmcl (= ${PROJECT_VERSION})" RECOMMENDS tmcld EXTRA postinst prerm)
set(CPACK_DEBIAN_EPICS_PACKAGE_ARCHITECTURE all)
tmcl_package(ros2 tmcl-ros2 electronics "motors on TMCL modules as joints of ros2_control"
  "Sources of a package of ROS 2, which Debian does not have: a system of
ros2_control whose joints are axes of a tmcld. colcon builds it. Other
clients of tmcld see and stop the same axes beside it. It was not yet run
in ROS 2."
  DEPENDS "libtmcl-dev (= ${PROJECT_VERSION})" RECOMMENDS tmcld)
set(CPACK_DEBIAN_ROS2_PACKAGE_ARCHITECTURE all)

# Another name than CPackConfig.cmake, which would make CMake add its own target.
set(CPACK_OUTPUT_CONFIG_FILE ${PROJECT_BINARY_DIR}/PackagesConfig.cmake)
set(CPACK_SOURCE_OUTPUT_CONFIG_FILE ${PROJECT_BINARY_DIR}/SourcePackagesConfig.cmake)
configure_file(${packaging}/changelog.in ${PROJECT_BINARY_DIR}/packages/changelog @ONLY)
set(CPACK_TMCL_PACKAGING ${packaging})
include(CPack)
add_custom_target(package
  COMMAND ${CMAKE_CPACK_COMMAND} --config ${PROJECT_BINARY_DIR}/PackagesConfig.cmake
  COMMAND ${CMAKE_COMMAND} -DFOLDER=${CPACK_PACKAGE_DIRECTORY} -P ${packaging}/bridges.cmake
  WORKING_DIRECTORY ${PROJECT_BINARY_DIR} USES_TERMINAL VERBATIM
  COMMENT "Packing Debian packages into ${PROJECT_BINARY_DIR}/packages")
add_dependencies(package programs tmcl_shared)
if(TARGET tmcld-mqtt)
  add_dependencies(package tmcld-mqtt)
endif()
