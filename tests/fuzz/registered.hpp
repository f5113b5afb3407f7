// Has few dependencies, because a program for each protocol includes it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fieldcast::fuzz {

// Input as in any_protocol.hpp. Creates the protocol at the first call, for unit 1 and with one
// option unless `option` is empty. REQUIRES: the same name, option and value at every call.
void run_registered(const char* name, const char* option, const char* value,
                    const std::uint8_t* data, std::size_t size);

}  // namespace fieldcast::fuzz
