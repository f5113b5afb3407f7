// The keys for TLS and login that the sections of several engines have.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "config/document/map_reader.hpp"
#include "config/files/library.hpp"

namespace fieldcast::forward {

// Keys with the name of a file. The file must exist; the access to its content is checked when it
// is used.
void read_files(config::MapReader& map, config::Library& library,
                std::initializer_list<std::pair<std::string_view, std::string*>> files);

// Adds a fault for one of both keys without the second one.
void check_pair(config::MapReader& map, std::string_view first, const std::string& first_value,
                std::string_view second, const std::string& second_value, std::string_view allowed);

}  // namespace fieldcast::forward
