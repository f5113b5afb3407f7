// The serial port of this computer that the programming software opens, or the other end of its
// pair: a new pseudo-terminal on Linux, an existing COM port on Windows. Lives on one io thread.
#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "bridge/net/byte_stream.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::port {

// The option of the command line that names the port.
struct LocalPortOption {
  const char* name;  // "--link"
  const char* help;
  const char* ready;  // reported after pairing
};
extern const LocalPortOption kLocalPortOption;

class LocalPort {
 public:
  virtual ~LocalPort() = default;
  // A stream of the open port, null if the port is not usable. One stream at a time.
  [[nodiscard]] virtual std::unique_ptr<ByteStream> stream(boost::asio::io_context& io) = 0;
  // A difference from the wanted settings that does not prevent the use, or empty.
  [[nodiscard]] virtual std::string remark() const { return {}; }
  // Baud rate and stop bits that the software has set at its end. Empty if this end cannot read
  // them.
  [[nodiscard]] virtual std::optional<program::LineSettings> settings() const = 0;
};

// `line`: settings of this end, if it has any; a part with the value 0 keeps its present value. The
// error is one line that names the port.
[[nodiscard]] tl::expected<std::unique_ptr<LocalPort>, std::string> open_local_port(
    const std::string& name, const program::LineSettings& line);

}  // namespace fieldcast::port
