// The options that `write` and `acquire` share.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "bridge/base/command_line.hpp"
#include "tools/cli/connection.hpp"
#include "tools/cli/view/command_text.hpp"

namespace fieldcast::cli {

struct CommandOptions {
  ConnectionOptions connection;
  std::string at;    // an address in the PLC's own notation; empty: channels
  std::string type;  // of the values at the address; empty: what the address implies, or uint16
  std::string byte;  // of a wider item, for an 8-bit type
  bool json = false;
  Duration timeout = std::chrono::seconds{5};
};

// "Read" or "Write to" in the help of --at. REQUIRES: options live until the parse.
void add_command_options(CommandLine& line, CommandOptions& options, const std::string& verb);

struct AddressType {
  std::string text;  // as in --type
  Encoding encoding;
};
// What --at, --type and --byte say together. The error is one line.
[[nodiscard]] tl::expected<AddressType, std::string> address_type(const CommandOptions& options);

}  // namespace fieldcast::cli
