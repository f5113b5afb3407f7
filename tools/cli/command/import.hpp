// `fieldcast import`: makes a configuration or device templates of the lists that other programs
// have. Needs no bridge and no device; says of every value whether it moved, with which change, or
// why not.
#pragma once

#include <iosfwd>
#include <mutex>
#include <string>
#include <vector>

#include "tools/cli/exit_code.hpp"
#include "tools/cli/view/text_table.hpp"
#include "tools/import/importer.hpp"

namespace fieldcast::cli {

struct ImportCommandOptions {
  std::vector<std::string> files;
  std::string out;   // a file, or a folder: with '/' at its end, or there already
  std::string port;  // /dev/ttyUSB0 or HOST:PORT
  bool force = false;
  bool all = false;
  bool json = false;
  importing::ImportOptions import;
};

// `writing` is held while files are written: who ends the process takes it first.
[[nodiscard]] ExitCode import_files(const ImportCommandOptions& options, std::mutex& writing,
                                    std::ostream& out, std::ostream& err, const Screen& screen);

}  // namespace fieldcast::cli
