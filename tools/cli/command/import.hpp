// `fieldcast import`: converts channel lists of other programs to a configuration or to device
// templates. Needs no bridge and no device.
#pragma once

#include <iosfwd>
#include <mutex>
#include <string>
#include <vector>

#include "tools/cli/text/output.hpp"
#include "tools/import/importer.hpp"

namespace fieldcast::cli {

struct ImportCommandOptions {
  std::vector<std::string> files;
  std::string out;   // a file, or a directory: existing, or with '/' at its end
  std::string port;  // /dev/ttyUSB0 or HOST:PORT
  bool force = false;
  bool all = false;
  bool json = false;
  importing::ImportOptions import;
};

// `writing` is locked while files are written; lock it before the process exits.
[[nodiscard]] ExitCode import_files(const ImportCommandOptions& options, std::mutex& writing,
                                    std::ostream& out, std::ostream& err, const Screen& screen);

}  // namespace fieldcast::cli
