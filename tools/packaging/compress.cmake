# Compresses the finished packages again at the highest xz level, which CPack cannot set. The programs share code within its
# dictionary of 64 MiB.
foreach(package IN LISTS CPACK_PACKAGE_FILES)
  set(content ${package}.content)
  execute_process(COMMAND dpkg-deb --raw-extract ${package} ${content} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND dpkg-deb --build --root-owner-group -Zxz -z9 -Sextreme ${content} ${package}
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  file(REMOVE_RECURSE ${content})
endforeach()
