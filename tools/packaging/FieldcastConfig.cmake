# find_package(Fieldcast) gives Fieldcast::station; include <fieldcast/station.hpp>.
include(CMakeFindDependencyMacro)
find_dependency(fmt)
find_dependency(fastcdr)
find_dependency(fastrtps)
include(${CMAKE_CURRENT_LIST_DIR}/FieldcastTargets.cmake)
