// Commands that use a line without a bridge, with a Modbus device at a pseudo-terminal.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/bridge/support/modbus_device.hpp"
#include "tools/cli/command/line/poke.hpp"
#include "tools/cli/command/line/read.hpp"
#include "tools/cli/command/line/scan.hpp"

namespace fieldcast::cli {

using testing::HasSubstr;

struct Ended {
  ExitCode code;
  std::string out, err;
};

struct DirectTest : testing::Test {
  LineOptions line() const {
    return {.port = pty.path(),
            .baud = 115200,
            .format = "8N1",
            .timeout = std::chrono::milliseconds{200}};
  }
  template <typename Run, typename Options>
  Ended run(Run command, const Options& options) {
    std::istringstream in;
    std::ostringstream out, err;
    const auto code = command(options, interrupt, Streams{in, out, err});
    return {code, out.str(), err.str()};
  }
  Ended read(ReadOptions options) { return run(cli::read, options); }
  Ended poke(PokeOptions options) { return run(cli::poke, options); }
  Ended scan(ScanOptions options) { return run(cli::scan, options); }

  test::Pty pty;
  test::ModbusDevice device{pty};
  Interrupt interrupt;
};

}  // namespace fieldcast::cli
