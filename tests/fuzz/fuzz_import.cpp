// Fuzzes `fieldcast import`: any bytes as a list, in a recognised or selected format, with
// addresses from a guessed base, 0 or 1. Each refused point must have a reason, and a fault is one
// line.
//
// Input: one byte that selects format, base and templates; then the file. One import for each
// input, because an import is slow.
#include <cstdlib>

#include "core/base/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tools/import/importer.hpp"

namespace fieldcast::importing {
namespace {

void run_import_bytes(ByteView data) {
  if (data.empty()) return;
  const std::string bytes(data.begin() + 1, data.end());
  const std::size_t choices = formats().size() + 1;  // the last one: recognised
  const std::size_t choice = data[0] % 128;
  ImportOptions options;
  if (choice % choices < formats().size()) options.from = formats()[choice % choices].name;
  if (const std::size_t base = choice / choices % 3; base > 0)
    options.base = static_cast<unsigned>(base - 1);
  options.as_template = data[0] >= 128;
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

}  // namespace
}  // namespace fieldcast::importing

FIELDCAST_FUZZ_TARGET(fieldcast::importing::run_import_bytes)
