// The descriptor of the library's shared-memory transport, which only a trial uses. Its header has
// another name in each release.
#pragma once

#include "bridge/dds/library/fastdds.hpp"

#if FASTDDS_VERSION_MAJOR >= 3
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.hpp>
#else
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#endif
