# Finishes the packages that CPack has made:
# - The library of stations gets its symbols file, checked against debian/symbols. A symbol that is missing or not listed is an error.
#   A trigger calls ldconfig, instead of CPack's scripts.
# - The times of files are at most the time of the last entry of debian/changelog, or $SOURCE_DATE_EPOCH, for reproducible packages.
# - Compression at the highest xz level, which CPack cannot set. The programs share code within its dictionary of 64 MiB.
set(debian ${CMAKE_CURRENT_LIST_DIR}/debian)
if(NOT DEFINED ENV{SOURCE_DATE_EPOCH})
  execute_process(COMMAND dpkg-parsechangelog -l ${debian}/changelog -S Timestamp OUTPUT_VARIABLE epoch
                  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  set(ENV{SOURCE_DATE_EPOCH} ${epoch})
endif()
foreach(package IN LISTS CPACK_PACKAGE_FILES)
  set(content ${package}.content)
  execute_process(COMMAND dpkg-deb --raw-extract ${package} ${content} COMMAND_ERROR_IS_FATAL ANY)
  if(package MATCHES "/((libfieldcast-station)([0-9]+))_[^/]*$")
    set(name ${CMAKE_MATCH_1})
    file(REMOVE ${content}/DEBIAN/postinst ${content}/DEBIAN/postrm)
    file(WRITE ${content}/DEBIAN/shlibs "${CMAKE_MATCH_2} ${CMAKE_MATCH_3} ${name} (>= ${CPACK_PACKAGE_VERSION})\n")
    execute_process(COMMAND dpkg-deb --field ${package} Architecture OUTPUT_VARIABLE architecture OUTPUT_STRIP_TRAILING_WHITESPACE)
    set(level 2)
    if(architecture MATCHES "^(armhf|i386)$")
      set(level 0)  # debian/symbols has the integer types of 64 bits
    endif()
    # dpkg-gensymbols of Debian 13 reads the source's control file in its working directory.
    file(MAKE_DIRECTORY ${content}.source/debian)
    file(WRITE ${content}.source/debian/control "Source: fieldcast\n\nPackage: ${name}\nArchitecture: any\n")
    # dpkg-gensymbols finds a missing symbol only if the version is above that of its row.
    execute_process(COMMAND dpkg-gensymbols -c${level} -p${name} -v${CPACK_PACKAGE_VERSION}+1 -a${architecture} -P${content}
                            -I${debian}/symbols -O${content}/DEBIAN/symbols
                    WORKING_DIRECTORY ${content}.source COMMAND_ERROR_IS_FATAL ANY)
    file(REMOVE_RECURSE ${content}.source)
    file(CHMOD ${content}/DEBIAN/shlibs ${content}/DEBIAN/symbols PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  endif()
  execute_process(COMMAND dpkg-deb --build --root-owner-group -Zxz -z9 -Sextreme ${content} ${package}
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  file(REMOVE_RECURSE ${content})
endforeach()
