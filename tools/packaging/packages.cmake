# Debian packages of the components, made by tools/package.sh.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME fieldcast)
set(CPACK_PACKAGE_VENDOR Fieldcast)
set(CPACK_PACKAGE_CONTACT "Fieldcast maintainers <maintainers@fieldcast.invalid>")
set(CPACK_PACKAGE_HOMEPAGE_URL "https://fieldcast.invalid")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL fieldcast fieldcast-dev fieldcast-forward fieldcast-sim ${runtime})
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE gzip)  # fast; finish.cmake compresses again
set(CPACK_POST_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/finish.cmake)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# Directory modes required by Debian, independent of the user's umask.
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_FIELDCAST_PACKAGE_NAME fieldcast)
set(CPACK_DEBIAN_FIELDCAST_PACKAGE_SECTION net)
set(CPACK_DEBIAN_FIELDCAST_PACKAGE_DEPENDS adduser)
set(CPACK_DEBIAN_FIELDCAST_PACKAGE_RECOMMENDS udev)
set(CPACK_DEBIAN_FIELDCAST_PACKAGE_SUGGESTS fieldcast-sim)
set(CPACK_COMPONENT_FIELDCAST_DESCRIPTION
  "bridge from PLCs on serial lines and TCP to DDS\nReads PLCs as fast and as evenly as the wire allows, publishes every value on\nDDS with the refresh period as a promise, and carries write commands back.")
set(CPACK_DEBIAN_FIELDCAST_PACKAGE_CONTROL_EXTRA
  "${CMAKE_CURRENT_LIST_DIR}/debian/postinst;${CMAKE_CURRENT_LIST_DIR}/debian/prerm;${CMAKE_CURRENT_LIST_DIR}/debian/postrm")

set(CPACK_DEBIAN_FIELDCAST-DEV_PACKAGE_NAME fieldcast-dev)
set(CPACK_DEBIAN_FIELDCAST-DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_FIELDCAST-DEV_PACKAGE_DEPENDS "${runtime} (= ${PROJECT_VERSION}), libfmt-dev")
set(CPACK_DEBIAN_FIELDCAST-DEV_PACKAGE_RECOMMENDS "g++, pkg-config")
set(CPACK_DEBIAN_FIELDCAST-DEV_PACKAGE_SUGGESTS "cmake, cyclonedds-dev, cyclonedds-tools")
set(CPACK_COMPONENT_FIELDCAST-DEV_DESCRIPTION
  "library for stations that listen to Fieldcast (development files)\nThe IDL of the topics, the headers of the library Fieldcast::station, and\nwhat find_package(Fieldcast) and pkg-config need.")

string(TOUPPER ${runtime} name)
set(CPACK_DEBIAN_${name}_PACKAGE_NAME ${runtime})
set(CPACK_DEBIAN_${name}_PACKAGE_SECTION libs)
set(CPACK_COMPONENT_${name}_DESCRIPTION
  "library for stations that listen to Fieldcast\nValues, catalogue, status and alarms of Fieldcast bridges on DDS, and\ncommands to them, for programs outside of Fieldcast.")
set(CPACK_DEBIAN_${name}_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/triggers)

set(CPACK_DEBIAN_FIELDCAST-FORWARD_PACKAGE_NAME fieldcast-forward)
set(CPACK_DEBIAN_FIELDCAST-FORWARD_PACKAGE_SECTION net)
set(CPACK_DEBIAN_FIELDCAST-FORWARD_PACKAGE_DEPENDS "fieldcast (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_FIELDCAST-FORWARD_DESCRIPTION
  "store and forward from Fieldcast to message engines\nSends the samples and alarms of a site to a central engine, by a durable\nqueue on the local disk and one outgoing connection.")
set(CPACK_DEBIAN_FIELDCAST-FORWARD_PACKAGE_CONTROL_EXTRA
  "${CMAKE_CURRENT_LIST_DIR}/debian/forward/postinst;${CMAKE_CURRENT_LIST_DIR}/debian/forward/prerm;${CMAKE_CURRENT_LIST_DIR}/debian/forward/postrm")

set(CPACK_DEBIAN_FIELDCAST-SIM_PACKAGE_NAME fieldcast-sim)
set(CPACK_DEBIAN_FIELDCAST-SIM_PACKAGE_SECTION net)
set(CPACK_DEBIAN_FIELDCAST-SIM_PACKAGE_RECOMMENDS fieldcast)
set(CPACK_COMPONENT_FIELDCAST-SIM_DESCRIPTION
  "simulated plant for a Fieldcast configuration\nEvery device of the configuration responds on a pseudo-terminal or a TCP\nport, at the speed of the wire, with faults where they are asked for.")

# Debian requires both files in every package.
find_program(GZIP gzip REQUIRED)
set(changelog ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz)
execute_process(COMMAND ${GZIP} -9nc ${CMAKE_CURRENT_LIST_DIR}/debian/changelog OUTPUT_FILE ${changelog} COMMAND_ERROR_IS_FATAL ANY)
foreach(component ${CPACK_COMPONENTS_ALL})
  install(FILES debian/copyright ${changelog} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${component} COMPONENT ${component})
endforeach()

include(CPack)
