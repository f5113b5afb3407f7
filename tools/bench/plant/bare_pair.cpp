#include "tools/bench/plant/bare_pair.hpp"

#include <fstream>

namespace fieldcast::bench {
namespace {

const char* word(BareData data) { return data == BareData::kBlocks ? "blocks" : "samples"; }

std::uint64_t last_number(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t number = 0;
  for (std::uint64_t next = 0; file >> next;) number = next;
  return number;
}

}  // namespace

BarePair::BarePair(const ScratchFolder& folder, unsigned domain, BareData data,
                   const BareLoad& load)
    : reader_log_(folder.path() + "/bare-reader-" + word(data) + ".log"),
      writer_log_(folder.path() + "/bare-writer-" + word(data) + ".log"),
      reader_("bench_bare", {std::to_string(domain), word(data), "read"}, reader_log_),
      writer_(
          "bench_bare",
          {std::to_string(domain), word(data), "write", std::to_string(load.channels),
           std::to_string(load.rows), std::to_string(static_cast<int>(1e6 / load.blocks_a_second))},
          writer_log_) {}

BarePair::Spent BarePair::spent() const {
  return {last_number(writer_log_), last_number(reader_log_), writer_.cpu_seconds(),
          reader_.cpu_seconds()};
}

}  // namespace fieldcast::bench
