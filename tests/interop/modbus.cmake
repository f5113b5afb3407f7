find_path(MODBUS_INCLUDE_DIR modbus/modbus.h REQUIRED)
find_library(MODBUS_LIBRARY modbus REQUIRED)
set(python /usr/bin/python3)  # Debian's Python: it has pymodbus

add_executable(libmodbus-server libmodbus_server.cpp)
target_include_directories(libmodbus-server SYSTEM PRIVATE ${MODBUS_INCLUDE_DIR})
target_link_libraries(libmodbus-server PRIVATE ${MODBUS_LIBRARY})
fieldcast_warnings(libmodbus-server)

fieldcast_test(pty_pair_test pty_pair_test.cpp LIBRARIES fieldcast_core util)

add_test(NAME Interop.ServersThatOthersWrote
  COMMAND ${python} ${CMAKE_CURRENT_SOURCE_DIR}/servers_test.py $<TARGET_FILE:libmodbus-server>)
add_test(NAME Interop.SimulatorBeforeForeignMasters
  COMMAND ${python} ${CMAKE_CURRENT_SOURCE_DIR}/sim_peers_test.py $<TARGET_FILE:fieldcast-sim>)
set_tests_properties(Interop.ServersThatOthersWrote Interop.SimulatorBeforeForeignMasters PROPERTIES
  TIMEOUT 300 LABELS interop ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1")
