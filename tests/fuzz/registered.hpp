// Any protocol of the registry as a fuzz target. Its header needs little, since a program for each
// protocol is compiled with it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fieldcast::fuzz {

// Input as in any_protocol.hpp. The protocol is made at the first call, for the unit 1 and with one
// option where `option` is not empty. REQUIRES: the same name, option and value at every call.
void run_registered(const char* name, const char* option, const char* value,
                    const std::uint8_t* data, std::size_t size);

}  // namespace fieldcast::fuzz
