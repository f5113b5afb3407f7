# find_package(Fieldcast) defines Fieldcast::station; include <fieldcast/station.hpp>.
include(CMakeFindDependencyMacro)
find_dependency(fmt)
include(${CMAKE_CURRENT_LIST_DIR}/FieldcastTargets.cmake)
