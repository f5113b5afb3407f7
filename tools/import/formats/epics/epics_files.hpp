// Reads startup scripts, databases and substitutions of an EPICS IOC. Pure. Limits: kMaxRecords
// records; expanded macros of kMaxExpanded bytes and 10 levels.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/formats/format.hpp"

namespace fieldcast::importing {

inline constexpr std::size_t kMaxRecords = 100'000;
inline constexpr std::size_t kMaxExpanded = 4096;

using Macros = std::map<std::string, std::string, std::less<>>;

// Expands "$(P)$(R=x)"; an unknown macro without a default stays unchanged.
[[nodiscard]] std::string expand(std::string_view text, const Macros& macros);
[[nodiscard]] Macros macros_from(std::string_view text);

struct EpicsRecord {
  std::string type, name;
  std::map<std::string, std::string, std::less<>> fields;
  Origin origin;
};

struct IocCall {
  std::string command;
  std::vector<std::string> arguments;
  Origin origin;
  [[nodiscard]] std::string_view argument(std::size_t index) const {
    return index < arguments.size() ? std::string_view(arguments[index]) : std::string_view();
  }
};

struct EpicsFiles {
  std::vector<IocCall> calls;  // in the order of the scripts, macros expanded
  std::vector<EpicsRecord> records;
  std::vector<Refusal> refusals;   // files that could not be loaded
  std::size_t driver_records = 0;  // of the module's templates about the driver itself
  bool has_script = false;
};

[[nodiscard]] EpicsFiles load_epics(std::span<const SourceText> sources);

[[nodiscard]] bool is_startup_script(std::string_view text);
[[nodiscard]] bool is_database(std::string_view text);
[[nodiscard]] bool is_substitutions(std::string_view text);

// Decimal, 0x.., or octal with a leading 0.
[[nodiscard]] std::optional<std::int64_t> c_number(std::string_view text,
                                                   std::int64_t least = INT64_MIN,
                                                   std::int64_t most = INT64_MAX);

}  // namespace fieldcast::importing
