# find_package(Fieldcast) defines Fieldcast::station; include <fieldcast/station.hpp>.
include(CMakeFindDependencyMacro)
find_dependency(fmt)
find_dependency(fastcdr)
find_dependency(fastrtps)
find_dependency(OpenSSL COMPONENTS Crypto)
include(${CMAKE_CURRENT_LIST_DIR}/FieldcastTargets.cmake)
