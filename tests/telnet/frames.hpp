// Frames of Telnet for tests: hexadecimal text with comments beside the call.
#pragma once

#include <gtest/gtest.h>

#include "core/telnet/line_client.hpp"
#include "core/telnet/line_server.hpp"

namespace fieldcast::telnet {

inline Bytes hex(std::string_view text) { return from_hex(text).value(); }

inline const Instant kStart{std::chrono::seconds{1}};

// IAC SB 44 kind value IAC SE, as text.
inline std::string option(std::string_view kind_and_value) {
  return "FF FA 2C " + std::string(kind_and_value) + " FF F0";
}

inline Bytes together(std::initializer_list<std::string> frames) {
  Bytes all;
  for (const auto& frame : frames) append(all, hex(frame));
  return all;
}

}  // namespace fieldcast::telnet
