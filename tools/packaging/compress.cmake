# Compresses the finished packages again, as small as xz can: CPack offers no level. Its dictionary of 64 MiB sees what the programs share.
foreach(package IN LISTS CPACK_PACKAGE_FILES)
  set(content ${package}.content)
  execute_process(COMMAND dpkg-deb --raw-extract ${package} ${content} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND dpkg-deb --build --root-owner-group -Zxz -z9 -Sextreme ${content} ${package}
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  file(REMOVE_RECURSE ${content})
endforeach()
