// Fuzz target of `fieldcast import`: any bytes as a list, of the format that they are recognised as
// and of one that is named. What cannot be moved has a reason, and a fault is one line.
//
// Input: one byte that chooses the format, then the file.
#include <cstdlib>

#include "core/base/bytes.hpp"
#include "tools/import/importer.hpp"

namespace fieldcast::importing {
namespace {

void run_once(const std::string& bytes, const std::string& from, bool as_template) {
  ImportOptions options;
  options.from = from;
  options.as_template = as_template;
  const auto outcome = run_import({{"list", bytes}}, options);
  if (!outcome) {
    if (outcome.error().empty() || outcome.error().find('\n') != std::string::npos) std::abort();
    return;
  }
  for (const PointFate& row : outcome->rows) {
    if (row.fate == Fate::kRefused && row.words.empty()) std::abort();
  }
  if (outcome->files.empty() && outcome->count(Fate::kRefused) != outcome->rows.size())
    std::abort();
}

void run_import_bytes(ByteView data) {
  if (data.empty()) return;
  const std::string bytes(data.begin() + 1, data.end());
  const auto& format = formats()[data[0] % formats().size()];
  run_once(bytes, "", data[0] >= 128);
  run_once(bytes, std::string(format.name), data[0] >= 128);
}

}  // namespace
}  // namespace fieldcast::importing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fieldcast::importing::run_import_bytes({data, size});
  return 0;
}
