// Compresses a body as gzip (RFC 1952). Pure.
#pragma once

#include <string>

namespace fieldcast::forward {

[[nodiscard]] std::string gzipped(const std::string& text);

}  // namespace fieldcast::forward
